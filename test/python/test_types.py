# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A user's program with types, and the package itself, pass mypy --strict."""

import re
import sys

import pytest

from conftest import ROOT

PACKAGE = ROOT / "port" / "python"

RIGHT = '''
import numpy as np
import tmini

def nearest(scan: tmini.Scan) -> float:
    ahead: tmini.Sector = scan.sectors(8)[0]
    return float(np.nanmin(scan.ranges_m)) if ahead.is_free(0.5) else ahead.nearest_m

with tmini.Lidar(tmini.find("2345"), frequency_hz=10, mask=[(170, 190)]) as lidar:
    lidar.set_frequency(8.5)
    for scan in lidar:
        rate: float | None = scan.frequency_hz
        bins: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = scan.bins(360)
        print(nearest(scan), rate, bins, scan.faults == tmini.Fault.DATA, lidar.scan_age_s)
    newest = lidar.read(timeout=0.3)
    if newest is not None:
        print(newest.complete)

for recorded in tmini.read("room.tmini", front=90):
    print(recorded.times_s)
'''

WRONG = '''
import tmini

lidar = tmini.Lidar("COM3", frequency_hz="10")
print(lidar.read().complete)
lidar.set_speed(3)
'''


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    """mypy(words): exit status, and where errors are."""
    run, folder = pytest.importorskip("mypy.api").run, tmp_path_factory.mktemp("mypy")

    def check(*words):
        out, errors, status = run(["--strict", "--cache-dir", str(folder / "cache"), "--python-executable",
                                   sys.executable, *map(str, words)])
        return status, errors, re.findall(r"(\w+\.py:\d+): error", out)
    return check


def test_a_program_with_types_passes_and_mistakes_are_found(mypy, tmp_path):
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(WRONG)
    assert mypy(tmp_path / "right.py", tmp_path / "wrong.py") == (1, "", ["wrong.py:4", "wrong.py:5", "wrong.py:6"])


def test_the_package_itself_passes(mypy):
    assert mypy("--config-file", PACKAGE / "pyproject.toml", PACKAGE / "tmini") == (0, "", [])
