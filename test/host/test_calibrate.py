# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`tmini calibrate` in the simulated room: the robot looks at a wall 2.3 m ahead; behind it, 0.8 m away, are two faces
with a gap between them, which look like a wall. tmini-sim turns the lidar on the robot (--turned), the robot in the
room (--turning), and gives it a mast."""

import math
import re

import pytest

SKIP, ENTER = "s\r", "\r"


@pytest.fixture
def calibrate(lidar, terminal):
    """calibrate(options of tmini-sim, options of the tool, answers): the screen at the end, and the exit status."""
    def run(sim_options, options, answers):
        screen = terminal("calibrate", "-p", lidar(*sim_options).port, *options, columns=150, rows=60)
        for asked, answer in enumerate(answers):
            screen.wait_until(lambda: len(re.findall(r"^>", screen.text, re.M)) > asked)
            screen.press(answer)
        return screen, screen.finish()
    return run


def number(pattern, text):
    return float(re.search(pattern, text).group(1))


@pytest.mark.parametrize("turned", [87.4, 213.9])
def test_the_front_is_found_within_0_3_degrees_and_the_offset_within_5_mm(calibrate, turned):
    screen, status = calibrate(["--turned", str(turned), "--longer", "69"], ["--front", str(turned - 12)],
                               [ENTER, SKIP, "2300\r"])
    assert status == 0
    found = number(r"front_q6 = (-?\d+)", screen.text) / 64
    assert abs((found - turned + 180) % 360 - 180) < 0.3
    assert abs(number(r"offset_mm = (-?\d+)", screen.text) + 69) <= 5
    assert abs(number(r"front=([\d.]+)", screen.text) - found) < 1e-4
    yaw = number(r"--yaw (-?[\d.]+)", screen.text)
    assert abs((yaw - math.radians(found) + math.pi) % (2 * math.pi) - math.pi) < 1e-4


def test_what_turns_with_the_robot_is_masked(calibrate):
    sim = ["--turning", "40", "--turned", "30", "--mast", "100:112:180"]
    screen, status = calibrate(sim, ["--seconds", "10"], [SKIP, ENTER, SKIP])
    assert status == 0
    assert re.search(r"masked\[\] = \{\{9[789], 11[345]\}\};", screen.text)
    assert re.search(r"--mask 9[789]:11[345]", screen.text)
    screen, status = calibrate(sim, ["--seconds", "10", "--upside-down", "--front", "30"], [SKIP, ENTER, SKIP])
    assert status == 0
    assert re.search(r"mask=\[\(27[567], 29[123]\)\]", screen.text)  # 30 - 112 and 30 - 100, two wider.
    assert "upside_down = true" in screen.text and "--roll 3.14159" in screen.text


@pytest.mark.parametrize("sim, options, answers, reason", [
    (["--turning", "20"], [], [ENTER], "Not good: "),
    (["--turned", "40"], [], [ENTER], "straight towards the nearest wall, at 220 degrees, is another thing"),
    (["--covered"], [], [ENTER], "there is no straight wall"),
    ([], ["--front", "135"], [ENTER], "no straight wall of 0.6 m within 30 degrees of --front"),
    (["--mast", "100:112:180"], ["--seconds", "6"], [SKIP, ENTER], "too little has moved: the robot was not turned"),
    (["--turning", "90"], ["--seconds", "1"], [SKIP, ENTER], "not enough scans"),
    ([], [], [SKIP, SKIP, "two metres\r"], "type the distance in mm"),
    ([], [], [SKIP, SKIP, "20\r"], "type the distance in mm"),
    ([], [], [SKIP, SKIP, "1500\r"], "mm straight ahead: that is another thing"),
    ([], ["--front", "155"], [SKIP, SKIP, "1000\r"], "not flat and square"),
    (["--covered"], [], [SKIP, SKIP, "1000\r"], "not enough ranges straight ahead"),
], ids=["turning", "two_faces", "covered", "no_wall", "standing", "too_short", "words", "too_near", "another_thing",
        "not_flat", "no_ranges"])
def test_what_does_not_fit_is_refused_with_the_reason_and_asked_again(calibrate, sim, options, answers, reason):
    screen, status = calibrate(sim, options, [*answers, "\x04"])
    assert reason in screen.text, screen.text.strip()
    asked = re.findall(r"\d of 3", screen.text)
    assert asked[-1] == asked[-2]
    assert "the questions were not answered: nothing is calibrated" in screen.text
    assert status == 1


def test_a_refused_step_can_be_repeated(calibrate):
    screen, status = calibrate([], ["--front", "10"], [ENTER, SKIP, "1500\r", "2310\r"])
    assert status == 0
    assert abs(number(r"offset_mm = (-?\d+)", screen.text) - 10) <= 5


def test_each_turning_is_judged_alone(calibrate):
    screen, _ = calibrate(["--turning", "90"], ["--seconds", "1"], [SKIP, *6 * [ENTER], "\x04"])
    assert screen.text.count("not enough scans") == 6


def test_a_lidar_that_goes_away_ends_it(lidar, terminal):
    device = lidar()
    screen = terminal("calibrate", "-p", device.port)
    screen.wait_for("1 of 3")
    device.unplug()
    assert screen.finish() == 1
    assert "tmini: " in screen.text
