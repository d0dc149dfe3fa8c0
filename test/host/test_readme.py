# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The tool's commands in README.md, unchanged and in order, with the simulated lidar instead of a real one."""

import sys
from pathlib import Path

from conftest import HERE, TMINI

sys.path.insert(0, str(HERE.parent / "docs"))
from documents import ROOT, parse  # noqa: E402

COMMANDS = [line.split(" #")[0].split() for block in parse(ROOT / "README.md")[0] if block.language == "sh"
            for line in block.text.splitlines() if line.startswith("build/bin/tmini ")]


def test_each_command_of_the_readme_works(lidar, tmini, terminal, environment, monkeypatch):
    monkeypatch.setenv("TMINI_PORT", lidar().port)
    assert {words[1] for words in COMMANDS} >= {"check", "view", "record", "plot", "decode"}
    for words in COMMANDS:
        if words[1] == "view":
            view = terminal(*words[1:])
            view.wait_for("scan 2 ")
            view.press("q")
            assert view.finish() == 0
        elif words[1] != "plot" or b"built without cairo" not in Path(TMINI).read_bytes():
            run = tmini(*words[1:])
            assert run.status == 0, f"{words}: {run.err}"
