# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""All options of all commands (but `ports`, which would ask real adapters), and random command lines, recordings and
reports: no signal ever ends the tool or tmini-sim, and exit status and message are the right ones. What a command
accepts is read from its help, as a person does.

TMINI_FUZZ: how many command lines; SEED: of all that is random, the date unless given: each day tries others."""

import json
import os
import random
import re
import subprocess
import time
from pathlib import Path

import pytest
from conftest import TMINI, TMINI_SIM
from lidar_bytes import damaged

LINES = int(os.environ.get("TMINI_FUZZ", 2000))
SEED = int(os.environ.get("SEED", time.strftime("%Y%m%d")))

# Values of options, by their names in the help: right ones and wrong ones.
VALUES = {
    "": ([""], []), "N": (["1", "7", "80"], ["", "-1", "x", "1.5", "1e1", "0x7", "7 ", "99999999999999999999"]),
    "DEG": (["0", "90", "-90", "359.5"], ["", "x", "nan", "90x", "1e9"]),
    "MM": (["0", "12", "-12"], ["", "x", "1e9"]), "FROM:TO": (["10:20", "350:10"], ["", "10", "a:b", "10:20:30"]),
    "PORT": (["/dev/none"], []), "FILE": (["y.svg"], []),
}

# The words with which a command is complete; it then fails, because neither device nor file exist.
COMPLETE = {
    "info": [], "health": [], "frequency": ["7.5"], "reboot": [], "scan": [], "check": [], "record": ["x.bin"],
    "decode": ["nowhere.bin"], "plot": ["-o", "x.svg"], "view": [], "survey": ["x.txt"], "calibrate": [],
}
NEVER = {"help", "version", "wait"}  # Would end well, or never end.


def call(program, words, **options):
    return subprocess.run([program, *words], stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=False,
                          **options)


@pytest.fixture
def ends(environment, monkeypatch):
    """ends(statuses, message, words): fails unless the tool ends like this."""
    monkeypatch.setenv("TMINI_PORT", "/dev/none")
    settings = {name: value for name, value in environment().items() if name != "LD_PRELOAD"}

    def check(statuses, message, words):
        run = call(TMINI, words, env=settings)
        errors = run.stderr.decode(errors="replace")
        what = f"{words}: {run.returncode}, {errors}"
        assert run.returncode in statuses, what
        assert run.returncode == 0 or errors.startswith("tmini: ") and message in errors, what
        assert run.returncode != 2 or run.stdout == b"", what
    return check


def options_of(command):
    """Of a command: name, letter (or ""), and the name of the value (or "")."""
    text = call(TMINI, ["help", command]).stdout.decode()
    return [(name, letter, value or "") for letter, name, value in
            re.findall(r"^  (?:-(\w),|   ) --([a-z-]+)(?: ([A-Z:]+))? ", text, re.MULTILINE)]


@pytest.fixture(scope="module")
def known():
    return {command: [option for option in options_of(command) if option[2] in VALUES] for command in COMPLETE}


@pytest.fixture(scope="module")
def names():
    """Of all options: they may be shortened as long as they stay different."""
    commands = re.findall(r"^  tmini (\w+)", call(TMINI, ["help"]).stdout.decode(), re.MULTILINE)
    return {option[0] for command in commands for option in options_of(command)}


def ways(option, value, names):
    """All ways to write an option."""
    name, letter, kind = option
    shortened = [name[:end] for end in range(1, len(name)) if sum(other.startswith(name[:end]) for other in names) == 1]
    for long in ["--" + word for word in [*shortened, name]]:
        yield from ([long, value], [f"{long}={value}"]) if kind else ([long],)
    if letter:
        yield from (["-" + letter, value], ["-" + letter + value]) if kind else (["-" + letter],)


@pytest.mark.parametrize("command", COMPLETE)
def test_each_option_is_taken_in_each_way_to_write_it(ends, known, names, command):
    complete = [command, *COMPLETE[command]]
    for option in known[command]:
        for value in VALUES[option[2]][0] if option[0] not in NEVER else ():
            for way in ways(option, value, names):
                ends((1,), "", [*complete, *way])
                ends((1,), "", [*way, *complete])


@pytest.mark.parametrize("command", COMPLETE)
def test_each_wrong_option_is_named(ends, known, command):
    wrong = [("--frobnicate", "--frobnicate"), ("-Z", "-Z"), ("words", "unexpected")]
    for name, _, kind in known[command]:
        wrong += [(f"--{name}={value}", f"--{name}") for value in VALUES[kind][1]]
        wrong += [(f"--{name}", f"--{name} needs a value")] * bool(kind)
    own = {option[0] for option in known[command]}
    wrong += [(f"--{name}={VALUES[kind][0][0]}".rstrip("="), f"no option --{name}")
              for options in known.values() for name, _, kind in options if name not in own]
    for word, message in wrong:
        ends((2,), message, [command, *COMPLETE[command], *[word] * (2 if word == "words" else 1)])


PIECES = ["scan", "decode", "record", "plot", "help", "version", "-", "--", "-p", "/dev/none", "-n", "--csv", "--json",
          "--stats", "--", "=", "x.svg", "-o", "-q", "-qqq", "--quiet", "1", "-1", "recordings/sim-6hz.bin", "%n%s", "",
          "--mask", "1:2", "--front", "-V", "-h", "ports", "A" * 300, "\udcff\udcc3", "--max-samples", "ü", "\x1b[2J"]


def test_any_command_line_ends_with_a_status_and_a_message(ends):
    draw = random.Random(SEED)
    for _ in range(LINES):
        words = ["".join(draw.choices(PIECES, k=draw.choice([1, 1, 1, 2]))) for _ in range(draw.randint(0, 7))]
        ends((0, 1, 2), "", [word for word in words if not word.startswith("--w")])  # To wait would not end.


# ---- Recordings


def test_any_recording_is_read_to_its_end(lidar, tmini, folder):
    port = lidar().port
    for name in ("two.tmini", "raw.bin"):
        assert tmini("record", "-p", port, name, "--seconds", "2", "-q").status == 0
    for seed in range(SEED * LINES, SEED * LINES + LINES // 40):
        draw = random.Random(seed)
        content = Path(draw.choice(["two.tmini", "raw.bin"])).read_bytes()
        kept = draw.choice([0, 0, 8])  # So that many still begin as a timed recording does.
        rest = content[kept:draw.randint(40, 9000)]
        (folder / "some").write_bytes(content[:kept] + damaged(rest, 1 + seed % 30, seed))
        table = call(TMINI, ["decode", "some", "--csv", "--stats", "stats"])
        assert table.returncode in (0, 1), f"seed {seed}: {table}"
        rows = [line.split(",") for line in table.stdout.decode("ascii").splitlines()[1:]]
        assert len(rows) == json.loads(Path("stats").read_text(encoding="ascii"))["points"], f"seed {seed}"
        assert all(0 <= float(row[3]) < 360 and int(row[4]) < 16384 for row in rows), f"seed {seed}"
        scans = call(TMINI, ["decode", "some", "--json", "-q"])
        assert scans.returncode in (0, 1) and all(map(json.loads, scans.stdout.splitlines())), f"seed {seed}: {scans}"
        for words in (["decode", "some"], ["plot", "some", "--all", "-o", "some.svg"]):
            assert call(TMINI, words).returncode in (0, 1), f"seed {seed}: {words}"


# ---- Reports


def test_any_report_is_played_or_refused(lidar, tmini, folder):
    port = lidar().port
    report = tmini("survey", "-p", port, "report.txt")
    text = Path("report.txt").read_text(encoding="utf-8") if Path("report.txt").exists() else report.out
    assert len(text) > 500
    for seed in range(SEED * LINES, SEED * LINES + LINES // 20):
        draw = random.Random(seed)
        words = re.split(r"(\s+)", text)
        for _ in range(draw.randint(1, 12)):
            odd = ["", "-1", "nan", "1e300", "65536", "x" * 200, "\0", "\n", "0"]
            words[draw.randrange(len(words))] = draw.choice(odd)
        (folder / "report").write_text("".join(words), encoding="utf-8")
        run = call(TMINI_SIM, ["--like", "report", "--write", "/dev/null", "--seconds", "0.3"])
        assert run.returncode in (0, 1, 2), f"seed {seed}: {run}"
        assert run.returncode == 0 or run.stderr.startswith(b"tmini-sim: "), f"seed {seed}: {run}"
