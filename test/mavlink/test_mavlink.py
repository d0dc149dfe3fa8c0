# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""examples/mavlink, built with headers that pymavlink generates; pymavlink's parser reads what it sends.

    test_mavlink.py FOLDER MAVLINK_PROXIMITY TMINI_SIM COMPILER…

FOLDER is for the headers and programs. The compiler's options are those for the library.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tty
import unittest

import pymavlink
from pymavlink.dialects.v20 import common
from pymavlink.generator import mavgen

ROOT = pathlib.Path(__file__).resolve().parents[2]
UNKNOWN, BEYOND = 65535, 1201


def generate(folder):
    dialect = pathlib.Path(pymavlink.__file__).parent / "dialects" / "v20" / "common.xml"
    options = mavgen.Opts(str(folder), wire_protocol="2.0", language="C", validate=False, strict_units=False)
    sys.stdout.flush()
    assert mavgen.mavgen(options, [str(dialect)])


def compile_program(name, sources, libraries):
    command = [*COMPILER, "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror", "-std=c99",
               "-isystem", str(FOLDER / "headers"), "-I", str(ROOT / "examples/mavlink"), *sources, *libraries, "-o",
               str(FOLDER / name)]
    subprocess.run(command, check=True, cwd=ROOT)


def messages(data):
    """All messages of the bytes, none of which may be left over; their sequence numbers have no gap."""
    parser = common.MAVLink(None)
    found = parser.parse_buffer(bytearray(data)) or []
    assert sum(len(message.get_msgbuf()) for message in found) + parser.buf_len() == len(data)
    assert all(message.get_type() != "BAD_DATA" for message in found)
    assert all((after.get_seq() - before.get_seq()) % 256 == 1 for before, after in zip(found, found[1:]))
    return found


def of_kind(found, kind):
    return [message for message in found if message.get_type() == kind]


def story(*words):
    return messages(subprocess.run([FOLDER / "story", *words], check=True, stdout=subprocess.PIPE).stdout)


class Mavlink(unittest.TestCase):
    def test_a_message_says_who_sends_and_how_it_counts(self):
        heartbeat, obstacles = story("points", "0:1000")
        self.assertEqual((7, common.MAV_COMP_ID_OBSTACLE_AVOIDANCE),
                         (heartbeat.get_srcSystem(), heartbeat.get_srcComponent()))
        self.assertEqual((common.MAV_TYPE_ONBOARD_CONTROLLER, common.MAV_AUTOPILOT_INVALID, common.MAV_STATE_ACTIVE),
                         (heartbeat.type, heartbeat.autopilot, heartbeat.system_status))
        self.assertEqual((5, 1200, 5, 5.0, 0.0),
                         (obstacles.min_distance, obstacles.max_distance, obstacles.increment, obstacles.increment_f,
                          obstacles.angle_offset))
        self.assertEqual((common.MAV_FRAME_BODY_FRD, common.MAV_DISTANCE_SENSOR_LASER, 5000000),
                         (obstacles.frame, obstacles.sensor_type, obstacles.time_usec))

    def test_each_sector_has_its_nearest_distance_and_no_range_is_unknown(self):
        _, obstacles = story("points", "0:3019", "2.4:2000", "357.6:1999", "90:709", "92.6:600", "180:40", "270:12009",
                             "275:12010", "280:16383", "100:0")
        wanted = {0: 199, 18: 70, 19: 60, 36: 5, 54: 1200, 55: BEYOND, 56: BEYOND}
        self.assertEqual([wanted.get(i, UNKNOWN) for i in range(72)], list(obstacles.distances))

    def story_of_a_lidar(self, bytes_per_ms):
        found = story("lidar", "20", bytes_per_ms)
        self.assertIn(len(of_kind(found, "HEARTBEAT")), (19, 20))
        return of_kind(found, "OBSTACLE_DISTANCE")

    def test_a_scanning_lidar_sends_ten_times_per_second_and_one_without_power_nothing(self):
        obstacles = self.story_of_a_lidar("11")  # 115200 baud.
        times_s = [message.time_usec / 1e6 for message in obstacles]
        before = [time for time in times_s if 4 <= time < 6]
        self.assertIn(len(before), (19, 20, 21))
        self.assertFalse([time for time in times_s if 6.2 < time < 9])
        self.assertIn(len([time for time in times_s if 18 <= time < 20]), (19, 20, 21))
        for message in obstacles[10:50]:
            self.assertTrue(all(69 <= distance <= 71 for distance in message.distances[17:20]))
            self.assertLess(message.distances.count(UNKNOWN), 5)

    def test_a_slow_uart_gets_whole_messages_less_often(self):
        obstacles = self.story_of_a_lidar("1")
        self.assertIn(len([message for message in obstacles if 4e6 <= message.time_usec < 6e6]), range(8, 12))
        self.assertTrue(all(69 <= message.distances[18] <= 71 for message in obstacles))

    def test_the_program_for_a_companion_computer_sends_the_same(self):
        lidar = subprocess.Popen([TMINI_SIM, "--pty"], stdout=subprocess.PIPE, text=True)
        controller, its_port = os.openpty()
        tty.setraw(its_port)
        program = subprocess.Popen([FOLDER / "mavlink_proximity", lidar.stdout.readline().strip(),
                                    os.ttyname(its_port), "9"])
        data = b""
        while len(of_kind(messages_so_far(data), "OBSTACLE_DISTANCE")) < 3:
            data += os.read(controller, 4096)
        program.send_signal(signal.SIGINT)
        self.assertEqual(0, program.wait())
        lidar.terminate()
        lidar.communicate()
        last = of_kind(messages_so_far(data), "OBSTACLE_DISTANCE")[-1]
        self.assertEqual(9, last.get_srcSystem())
        self.assertIn(min(last.distances), (98, 99, 100, 101))  # The nearest point of the room is 1 m away.

    def test_its_usage_and_a_wrong_port(self):
        wrong = ([], 2, "usage: "), (["a", "b", "0"], 2, "usage: "), (["a", "/none"], 1, "/none: ")
        for words, status, text in wrong:
            run = subprocess.run([FOLDER / "mavlink_proximity", *words], stderr=subprocess.PIPE, text=True)
            self.assertEqual((status, text), (run.returncode, run.stderr[:len(text)]))


def messages_so_far(data):
    return common.MAVLink(None).parse_buffer(bytearray(data)) or []


FOLDER, TMINI_SIM, COMPILER = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3].split("|")
LIBRARIES = sys.argv[4].split("|")
FOLDER.mkdir(parents=True, exist_ok=True)
generate(FOLDER / "headers")
INCLUDES = ["-Ilib/include", "-Iport/posix", "-Itest/simulator", "-Itest/support"]
compile_program("story", [*INCLUDES, "test/mavlink/story.c", "examples/mavlink/proximity.c"], LIBRARIES)
compile_program("mavlink_proximity", [*INCLUDES, "examples/mavlink/main.c", "examples/mavlink/proximity.c"], LIBRARIES)
unittest.main(argv=sys.argv[:1], verbosity=2)
