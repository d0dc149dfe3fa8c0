# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`tmini view` in a terminal: what the screen shows, what keys and sizes do, and that the terminal is restored, however
the program ends."""

import os
import pty
import re
import signal
import termios

import pyte
import pytest
from conftest import HERE, TMINI
from lidar_bytes import packet, timed, turn

LIDAR, NEAREST, RIGHT, BACK = "▲", "◆", "⠁", "⠈"
ROOM = "recordings/sim-6hz.bin"  # Two seconds: somewhat more than 8 scans.
ROOM_BYTES, DAMAGED_BYTES = ((HERE.parent / f"recordings/sim-6hz{name}.bin").read_bytes() for name in ("", "-damaged"))

# A point every 90 degrees: 1 m in front, 2 m to the right, 3 m behind, 4 m to the left.
CROSS = turn([(1000, 10, 0), (2000, 20, 0), (3000, 30, 0), (4000, 40, 0)])


@pytest.fixture
def cross(folder):
    (folder / "cross.bin").write_bytes(CROSS)
    return "cross.bin"


@pytest.fixture
def see(terminal):
    """Shows a recording to its end."""
    def show(*words, columns=80, rows=24, **options):
        view = terminal("view", *words, columns=columns, rows=rows, **options)
        view.wait_for("end of the recording" if columns > 20 else "q quit")
        return view
    return show


def assert_as_before(view):
    master, line = pty.openpty()
    assert view.settings() == termios.tcgetattr(line)
    os.close(master), os.close(line)
    assert not view.is_other_screen and pyte.modes.DECTCEM in view.screen.mode
    assert view.screen.misunderstood == 0


def assert_ends(view, status=0):
    assert view.finish() == status
    assert_as_before(view)


def quit_(view):
    view.press("q")
    assert_ends(view)


def play(view, story, device=None):
    """Does and sees what the story tells; between two steps is " | ". A step of these words:

        press KEYS; wait MS; ends STATUS (0), as before it began
        shows TEXT, lacks TEXT      on the screen, now; any other text is awaited
        freeze, thaw, unplug        the lidar; idle: it is awaited that it has stopped"""
    for step in story.split(" | "):
        word, _, rest = step.partition(" ")
        if word == "press":
            view.press(rest)
        elif word == "wait":
            view.wait(int(rest))
        elif word == "ends":
            assert_ends(view, int(rest or 0))
        elif word in ("shows", "lacks"):
            assert (rest in view.text) == (word == "shows"), step
        elif step in ("freeze", "thaw", "unplug"):
            getattr(device, step)()
        elif step == "idle":
            device.wait_for_log("stopping -> idle")
        else:
            view.wait_for(step)


def stories(told):
    """Each is a test, whose name is a claim."""
    return pytest.mark.parametrize("told", told.values(), ids=[name.replace(" ", "_") for name in told])


def colours(view):
    return len(re.findall(rb"\x1b\[38;5;", view.raw))


# ---- Picture


def cell(view, row, column):
    return view.screen.display[row][column]


def test_points_are_where_they_should_be(see, cross):
    view = see(cross)
    # The panel takes 27 of 80 columns, so the picture has 53. Two of 24 lines are text, which leaves 22, or 88 rows of
    # dots. So 4 m are 43 dots. The centre is between the dots 52 and 53 of a row, and between the rows 47 and 48.
    assert cell(view, 11, 26) == LIDAR
    assert cell(view, 9, 26) == NEAREST  # In front: dot 53, 37.
    assert cell(view, 12, 37) == RIGHT   # Dot 74, 48: its cell's first.
    assert cell(view, 20, 26) == BACK    # Dot 53, 80.
    assert cell(view, 12, 5) == RIGHT    # To the left: dot 10, 48.


def test_the_panel_reports_what_is_seen(see, cross):
    text = see(cross).text
    for part in (" cross.bin ", "  incomplete scan 1  6.0 Hz\n", "nearest   1.000 m\n", "at 0 deg,\n", " ahead\n",
                 "points    4, 4 valid\n", "range     4 m, auto\n", "packets   3\n", "damaged   0.0 %\n",
                 "4.00        ▲         2.00\n"):  # To the left and to the right.
        assert part in text


def test_a_room_looks_as_it_did_when_a_person_looked_at_it(see):
    assert see(ROOM).text == (HERE / "view_80x24.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("value, is_coloured", [(None, True), ("", True), ("1", False)])
def test_colours_are_left_out_when_asked(see, cross, environment, monkeypatch, value, is_coloured):
    if value is not None:
        monkeypatch.setenv("NO_COLOR", value)
    assert (colours(see(cross)) > 10) == is_coloured


# The colour scale keeps its range when the brightest point has gone.
def test_the_colour_scale_does_not_shrink(see, folder):
    start = packet([(1000, 10, 0)], 0, 0, ct=121)
    right = [packet([(2000, intensity, 0)], 5760, 5760) for intensity in (250, 20)]
    (folder / "steady.bin").write_bytes(start + right[0] + start + right[1] + start)
    view = see("steady.bin")
    colour = view.screen.buffer[12][48].fg  # 2 m to the right: in scan 2 intensity 20, on a scale of 10 to 250.
    view.press(",")
    view.wait_for("scan 1 ")
    assert view.screen.buffer[12][48].fg != colour  # In scan 1 it is the brightest.


# ---- Keys and size


def test_q_ends(see, cross):
    view = see(cross)
    assert view.is_other_screen and pyte.modes.DECTCEM not in view.screen.mode
    quit_(view)


def test_the_picture_follows_the_terminals_size(see, cross):
    view = see(cross)
    for columns, rows, row, column in ((60, 18, 8, 16), (120, 40, 19, 46)):
        view.resize(columns, rows)
        view.wait_until(lambda: cell(view, rows - 1, 1) == "q" and cell(view, row, column) == LIDAR)
    quit_(view)


def test_a_tiny_terminal_does_no_harm(terminal, cross):
    view = terminal("view", cross, columns=7, rows=3)
    view.wait(500)
    view.resize(1, 1)
    view.wait(500)
    quit_(view)


def test_a_small_terminal_has_the_picture_the_state_and_the_way_out(see):
    view = see(ROOM, columns=30, rows=10)
    assert "\n q quit  end of the recording\n" in view.text
    assert " sim-6hz.bin   scan 8  6.0 Hz\n" in view.text
    assert LIDAR in view.text
    view.resize(18, 5)
    view.wait_until(lambda: view.text.startswith("   scan 8  6.0 Hz\n"))
    assert view.text.endswith("\n q quit  end of th\n")
    quit_(view)


# ---- Recordings


@stories({
    "keys zoom": (
        CROSS, "end of | range     4 m, auto\n | press + | range     3 m\n | press + | range     2 m\n | press --- | "
        "range     6 m\n | press a | range     4 m, auto\n"),
    "escape ends and an arrow does not": (
        CROSS, "end of | press \033[A | press + | range     3 m\n | press \033 | ends"),
    "ctrl c gives the terminal back": (CROSS, "end of | press \x03 | ends"),
    "a recording can be paused stepped through and played again": (  # Paused, it stays.
        ROOM_BYTES, "end of | press , | scan 7 | shows paused | press , | scan 6 | shows paused | press . | scan 7 | "
        "shows paused | wait 1000 | shows scan 7 | press   | end of the recording | shows scan 8 | press \033[D | "
        "playing | scan 2 | press > | end of the recording"),  # Five seconds back is the beginning.
    "after a pause a recording goes on where it was": (  # 2 s would be 12 scans.
        3 * ROOM_BYTES, "scan 2 | press   | paused | wait 2000 | shows scan 2 | press   | scan 3 | press q | ends"),
    "a damaged recording says so": (  # 32 of 298.
        DAMAGED_BYTES, "end of | shows   incomplete scan  | shows damaged   10.7 %\n | shows health    unknown\n"),
    "a file that is no recording is reported at once": (
        b"nothing of interest", "ends 1 | shows holds no lidar packet"),
})
def test_a_recording(terminal, folder, told):
    content, story = told
    (folder / "some").write_bytes(content)
    play(terminal("view", "some"), story)


def test_an_arrow_goes_five_seconds(see, folder):
    ends_ms = (0, 1000, 1001, 5999, 6000, 6001)  # Scan 1 ends at 1000 ms.
    pauses_ms = (after - before for before, after in zip((0, *ends_ms), ends_ms))
    (folder / "slow.tmini").write_bytes(timed(*((1000 * pause, CROSS[:-13]) for pause in pauses_ms)))
    view = see("slow.tmini")
    for key, shown in ((",", "scan 4 "), (",", "scan 3 "), (",", "scan 2 "), (",", "scan 1 "), (">", "scan 4 "),
                       ("<", "scan 1 ")):
        view.press(key)
        view.wait_for(shown)


# The cross, whose scan ends two seconds after its beginning.
def test_a_timed_recording_is_played_at_its_own_pace(terminal, folder, clock):
    (folder / "slow.tmini").write_bytes(timed((0, CROSS[:13]), (2000000, CROSS[13:])))
    view = terminal("view", "slow.tmini")
    view.wait_for("playing")
    assert "scan 1 " not in view.text
    begun = clock.now_ms()
    view.wait_for("scan 1 ")
    assert 1900 <= clock.now_ms() - begun <= 2100
    quit_(view)


def test_keys_come_from_the_terminal_also_when_the_recording_comes_through_a_pipe(terminal):
    play(terminal(shell=f"cat {ROOM} | '{TMINI}' view -"),
         "end of the recording | shows scan 8 | press + | range     4 m\n | press q | ends")


def test_without_a_terminal_there_is_no_view(tmini, cross):
    run = tmini("view", cross)
    assert (run.status, run.out) == (1, "") and "there is none" in run.err


# `decode` and `plot` show it, but only on a terminal.
def test_reading_a_long_recording_shows_its_progress(terminal, folder):
    (folder / "long.bin").write_bytes(1024 * ROOM_BYTES)
    run = terminal(shell=f"'{TMINI}' decode long.bin | tail -n 1")
    run.wait_for("100 % of long.bin")
    run.wait_for("LastCRC bytes")
    os.unlink("long.bin")


# ---- Other terminals


def test_a_locale_without_utf_8_gets_ascii_characters(see, cross, environment, monkeypatch):
    monkeypatch.setenv("LC_ALL", "C")
    view = see(cross)
    assert view.text.isascii()
    assert [cell(view, *place) for place in ((11, 26), (9, 26), (12, 37), (20, 26), (12, 5))] == list("AX***")
    quit_(view)


# The first of the three variables that is not empty counts. The locale is not installed here.
def test_the_locale_is_the_one_that_the_variables_say(see, cross, environment, monkeypatch):
    for name, value in (("LC_ALL", ""), ("LC_CTYPE", ""), ("LANG", "xy_ZZ.utf8")):
        monkeypatch.setenv(name, value)
    assert cell(see(cross), 11, 26) == LIDAR


def test_a_dumb_terminal_gets_one_picture_below_the_other(see, cross, environment, monkeypatch):
    monkeypatch.setenv("TERM", "dumb")
    view = see(cross)
    assert "nearest   1.000 m\n" in view.text
    view.press("q")
    assert view.finish() == 0
    assert b"\x1b" not in view.raw


# ---- Other ways to end


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_signals_give_the_terminal_back(see, cross, number):
    view = see(cross)
    view.process.kill(number)
    assert_ends(view)


def test_ctrl_z_gives_the_terminal_back_and_fg_takes_it_again(terminal):
    view = terminal(shell=f"set -m; '{TMINI}' view {ROOM}; fg >/dev/null")
    view.wait_for("end of the recording")
    view.press("\x1a")
    view.wait_until(lambda: view.raw.count(b"\x1b[?1049h") == 2)  # The shell continues it in the foreground.
    view.wait_for("end of the recording")
    quit_(view)


def test_a_signal_gives_a_terminal_back_whose_output_is_stopped(see, cross, clock):
    view = see(cross)
    view.press("\x13")  # Ctrl-S stops the terminal's output.
    view.resize(60, 18)  # It must draw again, and blocks in the write.
    clock.wait_for_block(view.process.pid)
    view.process.kill(signal.SIGTERM)
    assert_ends(view)


def test_a_second_signal_gives_the_terminal_back_and_stops_the_lidar(terminal, lidar, clock):
    device = lidar()
    view = terminal("view", "-p", device.port)
    view.wait_for("scan 2 ")
    clock.stop(view.process.pid)
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGCONT):  # Both pend before it goes on.
        view.process.kill(number)
    assert view.finish() < 0
    assert_as_before(view)
    device.wait_for_log("stopping -> idle")


# ---- Live


@stories({
    "a lidar is shown live and stopped at the end":
        ("", "scan 5 | shows scanning | shows behind right | press q | ends | idle"),
    "a lidar that falls silent is called so until it is back":
        ("", "scan 2 | freeze | SILENT: starting it again\n | thaw | scanning\n | lacks SILENT | press q | ends"),
    "a blocked rotor is shown":  # Its name has a separate line.
        ("--blocked", "health    FAULTY | faulty: encoder (is the rotor blocked?)\n | \n q quit   + - zoom   a auto "),
    "a pulled cable ends the view with a message":
        ("", "scan 2 | unplug | ends 1 | shows has gone: the adapter was unplugged"),
})
def test_a_lidar_live(terminal, lidar, told):
    options, story = told
    device = lidar(*options.split())
    view = terminal("view", "-p", device.port)
    play(view, story, device)
    assert b"fallen silent" not in view.raw  # A remark would spoil the picture.
