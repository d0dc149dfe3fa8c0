# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""examples/obstacle_stop on a PC, with the simulated lidar. In its room the nearest object in the front sector is a
pillar, 1.37 m away."""

import os
import signal

import pytest
from conftest import plug_in

PROGRAM = os.environ["TMINI_OBSTACLE_STOP"]


@pytest.fixture
def robot(start):
    return lambda *words: start(*words, program=PROGRAM)


def wait_for_last(robot, beginning):
    """Waits until the newest whole line begins with this."""
    robot.wait_until(lambda: (["", *robot.out.split("\n")[:-1]])[-1].startswith(beginning))


@pytest.mark.parametrize("number", (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
def test_a_robot_in_a_free_room_may_go_until_a_signal_stops_the_lidar(lidar, robot, number):
    device = lidar()
    run = robot(device.port)
    run.wait_for("\ngo     13")
    assert run.end(number).status == 0
    device.wait_for_log("stopping -> idle")


def test_a_robot_that_has_lost_its_lidar_must_stop_until_it_is_back(lidar, robot):
    device = lidar()
    plug_in(device.port)
    run = robot("adapter")
    run.wait_for("\ngo ")
    device.unplug()
    plug_in(None)
    run.wait_for("fallen silent")
    wait_for_last(run, "STOP ")
    plug_in(lidar().port)
    wait_for_last(run, "go ")
    assert run.end().status == 0


def test_all_eight_sectors_are_shown(lidar, robot):
    run = robot(lidar().port)
    run.wait_for("\ngo ")
    assert run.end().status == 0
    assert run.out.startswith("mm    front    45")
    row = next(line for line in run.out.splitlines() if line.startswith("go "))
    # At 12 Hz a scan takes 83 ms. On a UART of 115200 baud (87 us per byte) printing its line must take at most half.
    assert len(row) <= 83000 // 87 // 2
    sectors = [int(word) for word in row.split()[1:9]]
    assert len(sectors) == 8 and all(900 < mm < 3500 for mm in sectors)  # The room is 5 m x 4 m, with boxes.


@pytest.mark.parametrize("options, fault", [
    (["--covered"], "data"), (["--covered", "--no-ct"], "data"),
    (["--blocked"], "encoder"), (["--health", "0x10"], "LD"),
], ids=["covered", "covered_and_not_reported", "blocked", "ranges_come"])
def test_a_robot_whose_lidar_is_faulty_stands(lidar, robot, options, fault):
    run = robot(lidar(*options).port)
    run.wait_for(f"faults: {fault}")
    before = len(run.out)
    run.wait_until(lambda: run.out.count("STOP ", before) >= 5)
    assert run.end(signal.SIGTERM).status == 0
    assert "go " not in run.out[before:]
    if fault != "LD":  # Never: there are no ranges.
        assert "go " not in run.out


def test_a_lidar_that_does_not_answer_is_reported_and_started_again(talker, robot):
    run = robot(talker(b""))
    run.wait_for("the lidar does not start: timeout; trying again\n")
    assert run.end().status == 0
    assert (run.out.count("STOP "), run.out.count("go ")) == (1, 0)


@pytest.mark.parametrize("words, status, output, errors", [
    ([], 2, "", "usage: obstacle_stop PORT, or obstacle_stop -p PORT\n"),
    (["a", "b"], 2, "", "usage: obstacle_stop PORT"), (["--vers"], 0, "obstacle_stop 1.", ""),
    (["-h"], 0, "usage: obstacle_stop PORT", ""), (["-p/dev/none"], 1, "", "/dev/none: no such device\n"),
    (["/dev/none"], 1, "", "/dev/none: no such device\n"),
])
def test_its_usage_and_a_wrong_port(robot, words, status, output, errors):
    run = robot(*words).finish()
    assert run.status == status
    assert run.out.startswith(output) and run.err.startswith(errors)
