#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Builds the release's archive for ROS 2 with colcon and runs its node with the simulated lidar:

    run_node.py PACKAGE ARCHIVE WORK TMINI TMINI_SIM [TEST …]

PACKAGE is port/ros2. Exit status 77: no ROS 2 is set up here.
"""

import atexit
import csv
import math
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import threading
import time
import tty
import unittest
from pathlib import Path

PATIENCE = 60  # Seconds; a test waits for events, not for times.


def build(package, archive, work):
    """Unpacks the archive into a workspace and builds it; returns the script that sets it up."""
    shutil.rmtree(work, ignore_errors=True)
    shutil.unpack_archive(archive, work / "src")
    for folder in (package, work / "src"):
        listed = subprocess.run(["colcon", "--log-base", os.devnull, "list", "--names-only", "--base-paths", folder],
                                check=True, stdout=subprocess.PIPE, text=True).stdout.split()
        if listed != ["tmini_ros"]:
            sys.exit(f"colcon finds {listed} in {folder}")
    subprocess.run(["colcon", "build", "--event-handlers", "console_direct+", "--cmake-args",
                    "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_C_FLAGS=-Werror", "-DCMAKE_CXX_FLAGS=-Werror"],
                   cwd=work, check=True)
    return work / "install/local_setup.sh"


# ---- The lidar ----

class Lidar:
    """The simulated lidar behind a pseudo-terminal that keeps what the lidar sends."""

    def __init__(self, *options):
        self.log = Path("lidar.log")
        self.simulator = subprocess.Popen([TMINI_SIM, "--pty", "--log", self.log, *options], stdout=subprocess.PIPE,
                                          text=True)
        self.lidar = os.open(self.simulator.stdout.readline().strip(), os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.lidar)
        self.host, self.users = pty.openpty()
        tty.setraw(self.users)
        self.port = os.ttyname(self.users)
        self.bytes = bytearray()
        self.ends = False
        self.thread = threading.Thread(target=self.pass_on)
        self.thread.start()

    def pass_on(self):
        while not self.ends:
            for end in select.select([self.lidar, self.host], [], [], 0.1)[0]:
                data = os.read(end, 4096)
                if end == self.lidar:
                    self.bytes += data
                os.write(self.host if end == self.lidar else self.lidar, data)

    def close(self):
        self.ends = True
        self.thread.join()
        self.simulator.terminate()
        self.simulator.communicate()
        for end in (self.lidar, self.host, self.users):
            os.close(end)

    def is_idle(self):
        modes = re.findall(r"mode \w+ -> (\w+)", self.log.read_text(encoding="utf-8"))
        return modes[-1:] in ([], ["idle"])

    def turns(self):
        """The points of each turn, as `tmini decode` reads what was sent: (degrees, mm, intensity)."""
        Path("sent.bin").write_bytes(self.bytes)
        decoded = subprocess.run([TMINI, "decode", "sent.bin", "--csv"], check=True, stdout=subprocess.PIPE,
                                 text=True).stdout
        turns = {}
        for row in csv.DictReader(decoded.splitlines()):
            turns.setdefault(int(row["scan"]), []).append(
                (float(row["angle_deg"]), int(row["distance_mm"]), int(row["intensity"])))
        return turns


def rays_of(points):
    """The message that a turn should become: the nearest point of each degree, counter-clockwise; NaN without. Where
    the turn begins and ends, a ray prefers the points of its own end."""
    own, other = {}, {}
    for index, (degrees, mm, intensity) in enumerate(points):
        ray = math.floor(0.5 - degrees) % 360
        is_other = (ray < 4 or ray >= 356) and (ray >= 180) != (index < len(points) // 2)
        rays = other if is_other else own
        if 50 <= mm <= 12000 and (ray not in rays or mm < rays[ray][0]):
            rays[ray] = (mm, intensity)
    return [own.get(ray) or other.get(ray) or (None, 0) for ray in range(360)]


def rays_in(message):
    return [(None if math.isnan(metres) else round(metres * 1000), round(intensity))
            for metres, intensity in zip(message.ranges, message.intensities)]


def points_in(cloud):
    """(1/64 degree counter-clockwise, mm, intensity, microseconds) of each point."""
    for x, y, _, intensity, seconds in struct.iter_unpack("<5f", bytes(cloud.data)):
        yield (round(math.degrees(math.atan2(y, x)) * 64) % 23040, round(math.hypot(x, y) * 1000), round(intensity),
               seconds * 1e6)


# ---- The node ----

class Program:
    """A command of ROS, with all its processes; its output goes to a file."""
    count = 0

    def __init__(self, *command):
        Program.count += 1
        self.output = Path(f"output{Program.count}.txt")
        with open(self.output, "w", encoding="utf-8") as output:
            self.process = subprocess.Popen([str(part) for part in command], stdout=output, stderr=output,
                                            start_new_session=True)

    def end(self, number=signal.SIGINT):
        """As a terminal does: to all processes of the command."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, number)
        return self.process.wait(PATIENCE)

    def says(self, text):
        return text in self.output.read_text(encoding="utf-8")


def ros2(*words):
    return subprocess.run(["ros2", *words], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=PATIENCE).stdout


class Node(unittest.TestCase):
    def setUp(self):
        import rclpy
        from diagnostic_msgs.msg import DiagnosticArray
        from rclpy.qos import QoSProfile, DurabilityPolicy, qos_profile_sensor_data
        from sensor_msgs.msg import LaserScan, PointCloud2
        from tf2_msgs.msg import TFMessage
        rclpy.init()
        self.addCleanup(rclpy.shutdown)
        self.lidar = Lidar("--frequency", "6")
        self.addCleanup(self.lidar.close)
        self.listener = rclpy.create_node("listener")
        self.heard = {}
        self.subscriptions = {}
        latched = QoSProfile(depth=9, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.topics = {"scan": (LaserScan, qos_profile_sensor_data),
                       "point_cloud": (PointCloud2, qos_profile_sensor_data),
                       "/diagnostics": (DiagnosticArray, 9), "/tf_static": (TFMessage, latched)}
        for topic in self.topics:
            self.subscribe(topic)

    def subscribe(self, topic):
        kind, qos = self.topics[topic]
        heard = self.heard[topic] = []
        self.subscriptions[topic] = self.listener.create_subscription(kind, topic, heard.append, qos)

    def until(self, happened, what):
        import rclpy
        end = time.monotonic() + PATIENCE
        while not happened():
            self.assertLess(time.monotonic(), end, what)
            rclpy.spin_once(self.listener, timeout_sec=0.1)

    def scans(self, count):
        wanted = len(self.heard["scan"]) + count
        self.until(lambda: len(self.heard["scan"]) >= wanted, "scans")

    def run_node(self, *words):
        program = Program("ros2", "run", "tmini_ros", "tmini_node", "--ros-args", "-p", f"port:={self.lidar.port}",
                          *words)
        self.addCleanup(program.end)
        return program

    def launch(self, file, *words):
        program = Program("ros2", "launch", "tmini_ros", file, f"port:={self.lidar.port}", *words)
        self.addCleanup(program.end)
        return program

    def expect_turns(self, found, expected, what):
        """What was received is what was sent, in the same order, without a gap."""
        numbers = list(expected)
        first = next((at for at, number in enumerate(numbers) if expected[number] == found[0]), None)
        self.assertIsNotNone(first, what)
        for at, one in enumerate(found):
            self.assertEqual(one, expected[numbers[first + at]], f"{what} {at}")

    def test_scans_are_what_tmini_decode_gives_and_sigint_stops_the_lidar(self):
        program = self.launch("tmini.launch.xml", "x:=0.25", "frame_id:=scanner")
        self.scans(30)
        program.end()
        self.assertTrue(self.lidar.is_idle())
        messages = self.heard["scan"]
        self.expect_turns([rays_in(message) for message in messages],
                          {number: rays_of(points) for number, points in self.lidar.turns().items()}, "scan")
        self.assertEqual(messages[0].angle_min, 0.0)
        self.assertEqual(messages[0].header.frame_id, "scanner")
        for one in messages[5:]:
            self.assertAlmostEqual(one.scan_time, 0.1, delta=0.004)
            self.assertAlmostEqual(one.time_increment * 360, -one.scan_time, places=5)
        place = self.heard["/tf_static"][0].transforms[0]
        self.assertEqual((place.header.frame_id, place.child_frame_id, place.transform.translation.x),
                         ("base_link", "scanner", 0.25))

    def test_points_are_what_tmini_decode_gives_with_their_times(self):
        Path("own.yaml").write_text("/**:\n  ros__parameters:\n    point_cloud: true\n    frequency: 10\n",
                                    encoding="utf-8")
        program = self.launch("tmini.launch.py", "params_file:=own.yaml")
        self.until(lambda: len(self.heard["point_cloud"]) >= 20, "clouds")
        program.end()
        self.assertTrue(self.lidar.is_idle())
        clouds = [list(points_in(cloud)) for cloud in self.heard["point_cloud"]]
        expected = {number: [(round(-degrees * 64) % 23040, mm, intensity) for degrees, mm, intensity in points
                             if 50 <= mm <= 12000] for number, points in self.lidar.turns().items()}
        self.expect_turns([[point[:3] for point in cloud] for cloud in clouds], expected, "cloud")
        for cloud in clouds[5:]:
            times = [point[3] for point in cloud]
            self.assertEqual(times, sorted(times))
            self.assertAlmostEqual(times[-1], 100000, delta=5000)

    def test_services_and_the_frequency_act(self):
        self.run_node()
        self.scans(5)
        self.assertIn("successful", ros2("param", "set", "/tmini", "frequency", "8"))
        self.until(lambda: abs(self.heard["scan"][-1].scan_time - 0.125) < 0.003, "8 Hz")
        for name, value in (("frequency", "20.0"), ("frequency", "fast"), ("rays", "720"), ("port", "/dev/null")):
            self.assertNotIn("successful", ros2("param", "set", "/tmini", name, value))
        ros2("service", "call", "/stop_scan", "std_srvs/srv/Empty")
        self.until(self.lidar.is_idle, "stop")
        self.until(lambda: self.heard["/diagnostics"][-1].status[0].message == "stopped, as wished", "diagnosis")
        ros2("service", "call", "/start_scan", "std_srvs/srv/Empty")
        self.scans(5)
        self.until(lambda: self.heard["/diagnostics"][-1].status[0].message == "scans at 8.0 Hz", "diagnosis")
        status = self.heard["/diagnostics"][-1].status[0]
        self.assertEqual(status.level, b"\0")
        self.assertRegex(status.hardware_id, r"^tmini \d{16}$")

    def test_sigterm_stops_the_lidar(self):
        program = self.run_node()
        self.scans(3)
        program.end(signal.SIGTERM)
        self.until(self.lidar.is_idle, "idle")

    def test_a_component_scans_and_stops_when_it_is_unloaded(self):
        container = Program("ros2", "run", "rclcpp_components", "component_container")
        self.addCleanup(container.end)
        ros2("component", "load", "/ComponentManager", "tmini_ros", "tmini_ros::Node", "-p", f"port:={self.lidar.port}")
        self.scans(5)
        ros2("component", "unload", "/ComponentManager", "1")
        self.until(self.lidar.is_idle, "idle")

    def test_in_standby_the_lidar_stands_until_somebody_subscribes(self):
        for topic in ("scan", "point_cloud"):
            self.listener.destroy_subscription(self.subscriptions[topic])
        program = self.run_node("-p", "standby:=true")
        self.until(lambda: program.says(": ok"), "an open port")
        self.until(lambda: self.heard["/diagnostics"] and self.heard["/diagnostics"][-1].status[0].message ==
                   "stopped, as wished" and self.lidar.is_idle(), "standing")
        self.assertLess(len(self.lidar.bytes), 130)  # Not even a packet.
        self.subscribe("scan")
        self.scans(3)
        self.listener.destroy_subscription(self.subscriptions["scan"])
        self.until(self.lidar.is_idle, "standing again")

    def test_wrong_parameters_are_named(self):
        program = self.run_node("-p", "frequency:=20", "-p", "baudrate:=115200")
        self.assertEqual(program.process.wait(PATIENCE), 1)
        self.assertTrue(program.says("frequency must be hertz, from 6 to 12"))
        program = self.run_node("-p", "baudrate:=115200", "-p", "frequenzy:=7")
        self.scans(1)
        self.assertTrue(program.says("parameter baudrate has no effect") and program.says("frequenzy is unknown"))

    def test_a_file_for_another_node_is_not_ignored_in_silence(self):
        Path("other.yaml").write_text("another:\n  ros__parameters:\n    port: /dev/none\n", encoding="utf-8")
        program = self.launch("tmini.launch.xml", "params_file:=other.yaml")
        self.until(lambda: program.says("other.yaml has nothing for this node: let it begin with /tmini: or /**:"),
                   "a warning")
        self.scans(1)


def main():
    global TMINI, TMINI_SIM
    package, archive, work = (Path(name).resolve() for name in sys.argv[1:4])
    TMINI, TMINI_SIM = sys.argv[4:6]
    if not shutil.which("colcon") or not shutil.which("ros2"):
        print("SKIPPED: no ROS 2 is set up here, or no colcon")
        sys.exit(77)
    if "TMINI_ROS_BUILT" not in os.environ:
        script = build(package, archive, work)
        os.environ.update(TMINI_ROS_BUILT="1", ROS_LOCALHOST_ONLY="1", ROS_DOMAIN_ID=str(os.getpid() % 100 + 1))
        python = Path(shutil.which("ros2")).read_text(encoding="utf-8").splitlines()[0][2:].strip()
        os.execlp("sh", "sh", "-c", '. "$0" && exec "$@"', script, python, *sys.argv)
    os.chdir(work)
    atexit.register(ros2, "daemon", "stop")
    unittest.main(argv=sys.argv[:1] + sys.argv[6:], verbosity=2)


main()
