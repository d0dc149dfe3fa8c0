# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A lidar is found by its serial number, with care for what else is plugged in."""

import functools
import re
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

import tmini
import tmini._find
from conftest import ROOT, SIM, Simulator
from lidar_bytes import INFORMATION

SERIAL = "2026031700012345"


@pytest.fixture
def plugged(monkeypatch, tmp_path):
    """plugged(*options) plugs in a simulated lidar; its adapter has a chip that lidars come with."""
    simulators, adapters = [], []
    monkeypatch.setattr(tmini._find, "comports", lambda: adapters)
    monkeypatch.setattr(tmini._find, "_ASK_S", 30)  # The answer ends the wait; a busy computer's lidar may be slow.

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
        assert tmini.find(end) == lidar.port
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
    with tmini.Lidar("serial:8765", timeout=60) as lidar:
        assert lidar.info.serial == "2026031700098765"
        other.stop()
        plugged.adapters.pop()
        plugged("--like", report)
        begun = time.monotonic()
        while lidar.read(60).start_s < begun:
            pass


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


def test_a_port_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OSError, match="could not open port"):
        tmini.find(ports=[str(tmp_path / "nothing")])


class Played:
    """A line, and its clock: bytes come at their times, and answers 20 ms after each question."""

    def __init__(self, comes, answers, nap_s):
        self.coming = list(comes)  # (when, bytes), by time.
        self.answers, self.nap_s = list(answers), nap_s
        self.now_s, self.asked, self.is_open = 0.0, 0, True

    def monotonic(self):
        return self.now_s

    def sleep(self, seconds):
        self.now_s += max(seconds, self.nap_s)

    def read(self):
        came = [data for when_s, data in self.coming if when_s <= self.now_s]
        self.coming = self.coming[len(came):]
        if None in came:
            raise OSError("unplugged")
        yield from came

    def write(self, data):
        assert data == b"\xa5\x90"
        self.asked += 1
        self.coming += [(self.now_s + 0.02, answer) for answer in self.answers[:1]]
        del self.answers[:1]

    def close(self):
        self.is_open = False


@functools.cache
def scanning(*options):
    """What a lidar sends in four seconds, from the middle of a scan: each packet when it is complete."""
    command = [SIM, "--write", "-", "--seconds", "6", *options]
    room = subprocess.run(command, check=True, capture_output=True).stdout
    return tuple(((i + 1) / 100, room[5000 + 131 * i:][:131]) for i in range(400))


def gappy(stream, until_s):
    """Of each 0.1 s half is lost, as if the computer were too busy to read."""
    return [(when_s, data) for when_s, data in stream if when_s > until_s or when_s % 0.1 < 0.05]


SILENT, NO_CT, DAMAGED = [], ("--frequency", "12", "--no-ct"), INFORMATION[:-1] + b"\x0a"
NOT_ASKED, NO_LIDAR = "sends already, and was not asked", "answers, but not as a lidar"


@pytest.mark.parametrize("comes, answers, nap_s, said, asked, within_s", [
    pytest.param(*row, id=claim) for claim, row in {
        "an_answer_ends_the_wait": (SILENT, [INFORMATION], 0, SERIAL, 1, 0.5),
        "an_answer_may_come_in_pieces": (SILENT, [INFORMATION[:9], INFORMATION[9:]], 0, SERIAL, 2, 2),
        "after_a_damaged_answer_it_is_asked_again": (SILENT, [DAMAGED, INFORMATION], 0, SERIAL, 2, 1.3),
        "an_answer_counts_that_came_while_the_computer_was_busy": (SILENT, [INFORMATION], 1, SERIAL, 1, 9),
        "silence_is_no_answer": (SILENT, [], 0, "no answer", 3, 3),
        "another_answer_is_named": (SILENT, [b"?"], 0, NO_LIDAR, 3, 3),
        "who_scans_is_recognised": (scanning, [], 0, SERIAL, 0, 0.5),
        "who_scans_is_not_asked_though_the_computer_was_busy": (scanning, [], 0.5, SERIAL, 0, 9),
        "who_scans_is_recognised_though_bytes_were_lost": (
            lambda: gappy(scanning(), 0.8), [], 0, SERIAL, 0, 1.7),
        "who_reports_no_serial_number_is_not_asked": (lambda: scanning(*NO_CT), [], 0, NOT_ASKED, 0, 1.7),
        "who_has_just_been_stopped_is_asked_after_the_tail": (
            lambda: scanning(*NO_CT)[:30], [INFORMATION], 0, SERIAL, 1, 1),
        "the_tail_is_no_answer": (lambda: scanning(*NO_CT)[:30], [], 0, "no answer", 3, 4),
        "who_sends_at_times_is_not_asked": ([(0.1, b"$GPGGA"), (1.1, b"$GPGGA")], [], 0, NOT_ASKED, 0, 1.7),
        "who_is_unplugged_is_named": ([(0.2, None)], [], 0, "unplugged", 0, 1),
    }.items()])
def test_a_line_is_judged_with_care_however_busy_the_computer(
        monkeypatch, caplog, comes, answers, nap_s, said, asked, within_s):
    caplog.set_level("INFO", "tmini")
    line = Played(comes() if callable(comes) else comes, answers, nap_s)
    monkeypatch.setattr(tmini._find, "open_line", lambda _: line)
    monkeypatch.setattr(tmini._find, "time", line)
    if said == SERIAL:
        assert tmini.find("2345", ["x"]) == "x"
    else:
        with pytest.raises(OSError, match=f"no lidar whose serial number ends with 2345: x: {said}$"):
            tmini.find("2345", ["x"])
    assert caplog.messages == [f"looked for a lidar: x: {said}"]
    assert (line.asked, line.now_s < within_s, line.is_open) == (asked, True, False)


def test_the_known_chips_are_those_of_the_tool():
    sources = (ROOT / "examples" / "host").glob("*.c")
    text = "".join(path.read_text() for path in sources)
    chips = {tuple(int(number, 16) for number in chip) for chip in re.findall(r'"([0-9a-f]{4}):([0-9a-f]{4})"', text)}
    assert chips == tmini._find._CHIPS
