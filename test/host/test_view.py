# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`tmini view` in a terminal: what the screen shows, what keys and sizes do, and that the terminal is restored, however
the program ends."""

import os
import pty
import re
import signal
import termios
from pathlib import Path

import pyte
import pytest
from conftest import HERE, TMINI
from lidar_bytes import packet, timed, turn

LIDAR, NEAREST, RIGHT, BACK = "▲", "◆", "⠁", "⠈"
ROOM = "recordings/sim-6hz.bin"  # Two seconds: somewhat more than 8 scans.

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


def test_keys_zoom(see, cross):
    view = see(cross)
    for keys, shown in (("", "4 m, auto\n"), ("+", "3 m\n"), ("+", "2 m\n"), ("---", "6 m\n"), ("a", "4 m, auto\n")):
        view.press(keys)
        view.wait_for("range     " + shown)


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


def test_escape_ends_and_an_arrow_does_not(see, cross):
    view = see(cross)
    view.press("\033[A")  # The key "up" has no function.
    view.press("+")
    view.wait_for("range     3 m\n")
    view.press("\033")
    assert_ends(view)


# ---- Recordings


def test_a_recording_can_be_paused_stepped_through_and_played_again(see):
    view = see(ROOM)
    for key, shown in ((",", "scan 7 "), (",", "scan 6 "), (".", "scan 7 ")):
        view.press(key)
        view.wait_for(shown)
        assert "paused" in view.text
    view.wait(1000)  # It stays paused.
    assert "scan 7 " in view.text
    view.press(" ")
    view.wait_for("end of the recording")
    assert "scan 8 " in view.text
    view.press("\033[D")  # Five seconds back is the beginning.
    view.wait_for("playing")
    view.wait_for("scan 2 ")
    view.press(">")
    view.wait_for("end of the recording")


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


# The recording's time stands still during the pause: 2 s would be 12 scans.
def test_after_a_pause_a_recording_goes_on_where_it_was(terminal, folder):
    (folder / "room.bin").write_bytes(4 * Path(ROOM).read_bytes())
    view = terminal("view", "room.bin")
    view.wait_for("scan 2 ")
    view.press(" ")
    view.wait_for("paused")
    view.wait(2000)
    assert "scan 2 " in view.text
    view.press(" ")
    view.wait_until(lambda: "scan 2 " not in view.text)
    assert "scan 3 " in view.text
    quit_(view)


def test_keys_come_from_the_terminal_also_when_the_recording_comes_through_a_pipe(terminal):
    view = terminal(shell=f"cat {ROOM} | '{TMINI}' view -")
    view.wait_for("end of the recording")
    assert "scan 8 " in view.text
    view.press("+")
    view.wait_for("range     4 m\n")
    quit_(view)


def test_a_damaged_recording_says_so(see):
    text = see("recordings/sim-6hz-damaged.bin").text
    assert "  incomplete scan " in text
    assert "damaged   10.7 %\n" in text  # 32 of 298.
    assert "health    unknown\n" in text


def test_a_file_that_is_no_recording_is_reported_at_once(terminal):
    view = terminal("view", "recordings/README.md")
    assert_ends(view, 1)
    assert "holds no lidar packet" in view.text


def test_without_a_terminal_there_is_no_view(tmini, cross):
    run = tmini("view", cross)
    assert (run.status, run.out) == (1, "") and "there is none" in run.err


# `decode` and `plot` show it, but only on a terminal.
def test_reading_a_long_recording_shows_its_progress(terminal, folder):
    (folder / "long.bin").write_bytes(1024 * Path(ROOM).read_bytes())
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


def test_ctrl_c_gives_the_terminal_back(see, cross):
    view = see(cross)
    view.press("\x03")
    assert_ends(view)


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


def test_a_lidar_is_shown_live_and_stopped_at_the_end(terminal, lidar):
    device = lidar()
    view = terminal("view", "-p", device.port)
    view.wait_for("scan 5 ")
    assert "scanning" in view.text and "behind right" in view.text
    quit_(view)
    device.wait_for_log("stopping -> idle")


def test_a_lidar_that_falls_silent_is_called_so_until_it_is_back(terminal, lidar):
    device = lidar()
    view = terminal("view", "-p", device.port)
    view.wait_for("scan 2 ")
    device.freeze()
    view.wait_for("SILENT: starting it again\n")
    device.thaw()
    view.wait_for("scanning\n")
    assert "SILENT" not in view.text
    assert b"fallen silent" not in view.raw  # A remark would spoil the picture.
    quit_(view)


def test_a_blocked_rotor_is_shown(terminal, lidar):
    view = terminal("view", "-p", lidar("--blocked").port)
    view.wait_for("health    FAULTY")
    view.wait_for("faulty: encoder (is the rotor blocked?)\n")  # It has a separate line.
    view.wait_for("\n q quit   + - zoom   a auto ")


def test_a_pulled_cable_ends_the_view_with_a_message(terminal, lidar):
    device = lidar()
    view = terminal("view", "-p", device.port)
    view.wait_for("scan 2 ")
    device.unplug()
    assert_ends(view, 1)
    assert "has gone: the adapter was unplugged" in view.text
