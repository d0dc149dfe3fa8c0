# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A lidar is found by its serial number, with care for what else is plugged in."""

import contextlib
import os
import re
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

import tmini
import tmini._find
from conftest import ROOT, Simulator

SERIAL = "2026031700012345"


@pytest.fixture
def plugged(monkeypatch, tmp_path):
    """plugged(*options) plugs in a simulated lidar; its adapter has a chip that lidars come with."""
    simulators, adapters = [], []
    monkeypatch.setattr(tmini._find, "comports", lambda: adapters)

    def plug(*options):
        folder = tmp_path / str(len(simulators))
        folder.mkdir()
        simulators.append(Simulator(folder))
        adapters.append(SimpleNamespace(device=simulators[-1].start(*options), vid=0x10C4, pid=0xEA60))
        return simulators[-1]

    plug.adapters = adapters
    yield plug
    for simulator in simulators:
        simulator.stop()


def commands(simulator):
    return re.findall(r"command (A5 ..)", simulator.log.read_text() if simulator.log.exists() else "")


def test_a_silent_lidar_is_asked_who_it_is_and_nothing_else(plugged):
    lidar = plugged()
    for end in ("", "2345", SERIAL):
        begun = time.monotonic()
        assert tmini.find(end) == lidar.port
        assert time.monotonic() - begun < 3
    assert set(commands(lidar)) == {"A5 90"}


def test_of_two_lidars_the_one_that_is_meant_scans_also_when_its_port_has_another_name(plugged, tmp_path):
    report = tmp_path / "report"
    report.write_text("serial = 2026031700098765\n")
    plugged()
    other = plugged("--like", report)
    assert tmini.find("8765") == other.port
    with pytest.raises(OSError, match=f"several lidars at all: .*{SERIAL}.*98765"):
        tmini.find()
    with pytest.raises(OSError, match=f"no lidar whose serial number ends with 7: .*{SERIAL}.*98765"):
        tmini.Lidar("serial:7")
    with tmini.Lidar("serial:8765") as lidar:
        assert lidar.info.serial == "2026031700098765"
        other.stop()
        plugged.adapters.pop()
        plugged("--like", report)
        begun = time.monotonic()
        while (scan := lidar.read(30)).start_s < begun:
            pass


def test_a_lidar_that_scans_is_recognised_if_it_can_be_and_never_stopped(plugged):
    slow, fast = plugged(), plugged("--frequency", "12", "--no-ct")
    with contextlib.ExitStack() as stack:
        for simulator in (slow, fast):  # Started by somebody else, through descriptors that are closed again.
            line = stack.enter_context(open(simulator.port, "r+b", buffering=0))
            line.write(b"\xa5\x60")
    assert tmini.find("2345") == slow.port
    with pytest.raises(OSError, match=f"{fast.port}: sends already, and was not asked"):
        tmini.find("9")
    assert commands(slow) == commands(fast) == ["A5 60"]


def test_a_port_that_a_program_holds_is_left_alone(plugged):
    lidar = plugged()
    holder = subprocess.Popen([sys.executable, "-c", "import sys; file = open(sys.argv[1]); print(flush=True); "
                               "sys.stdin.read()", lidar.port], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    holder.stdout.readline()
    try:
        with pytest.raises(OSError, match="in use by another program"):
            tmini.find()
    finally:
        holder.communicate()
    assert commands(lidar) == []


def test_only_known_chips_are_asked_unless_a_port_is_named(plugged):
    lidar = plugged()
    plugged.adapters[0].pid = 1
    with pytest.raises(OSError, match="there is no USB adapter of a kind that lidars come with"):
        tmini.find()
    assert commands(lidar) == []
    assert tmini.find(ports=[lidar.port]) == lidar.port


def test_a_device_that_is_no_lidar_is_named(tmp_path):
    controller, device = os.openpty()
    name = os.ttyname(device)
    os.close(device)

    def echo():
        while True:
            with contextlib.suppress(OSError):  # Nobody has opened the other end.
                os.write(controller, b"?" + os.read(controller, 100))
            time.sleep(0.01)

    threading.Thread(target=echo, daemon=True).start()
    with pytest.raises(OSError, match=f"{name}: answers, but not as a lidar"):
        tmini.find(ports=[name])
    with pytest.raises(OSError, match="could not open port"):
        tmini.find(ports=[str(tmp_path / "nothing")])


def test_the_known_chips_are_those_of_the_tool():
    sources = (ROOT / "examples" / "host").glob("*.c")
    text = "".join(path.read_text() for path in sources)
    chips = {tuple(int(number, 16) for number in chip)
             for chip in re.findall(r'"([0-9a-f]{4}):([0-9a-f]{4})"', text)}
    assert chips == tmini._find._CHIPS
