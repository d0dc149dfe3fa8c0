#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The viewer, opened from its file in a real browser and used as a person uses it.

    test_viewer.py PAGE TMINI [unittest's options …]

PAGE is tmini.html, TMINI the tool that it is compared with. Exit status 77: no browser is available.
"""

import functools
import http.server
import json
import math
import os
import pathlib
import random
import signal
import struct
import subprocess
import sys
import threading
import unittest

import browser

HERE = pathlib.Path(__file__).resolve().parent
RECORDINGS = HERE.parent / "recordings"
STAND_IN = (HERE / "serial_stand_in.js").read_text(encoding="utf-8")
SIZE_MAX = 150_000

# Makes the page's time run faster than real time, so that the tests take less time. The page is not
# painted more often. If the page is too slow, its time and the simulated lidar's time wait.
FASTER = """{
    const [now, timeout, interval] = [performance.now.bind(performance), setTimeout, setInterval];
    let [ms, last] = [0, now()];
    performance.now = () => {
        const time = now();
        ms += Math.min(SPEED * (time - last), 100);
        last = time;
        return ms;
    };
    window.setTimeout = (action, delay) => timeout(action, delay / SPEED);
    window.setInterval = (action, delay) => interval(action, delay / SPEED);
    window.requestAnimationFrame = (paint) => timeout(paint, 50);
}
"""

POLICY = sorted(["base-uri", "connect-src", "font-src", "form-action", "frame-src", "img-src", "media-src",
                 "object-src", "script-src-elem", "style-src-elem"])

PAGE = None
TMINI = None
BROWSER = None


def real_recording():
    """The recording of a real unit, or None."""
    path = pathlib.Path(os.environ.get("TMINI_RECORDINGS_DIR") or RECORDINGS / "real") / "t-mini-plus-room.bin"
    return path if path.exists() else None


def luminance(colour):
    parts = [part / 255 for part in colour]
    parts = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(one, other):
    """The contrast ratio of the Web Content Accessibility Guidelines: 1 to 21."""
    bright, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (bright + 0.05) / (dark + 0.05)


class Viewer(unittest.TestCase):
    """Each test opens the page again, in the same browser."""

    width, height, before, speed, light = 1000, 600, "", 10, False

    @classmethod
    def setUpClass(cls):
        cls.page = BROWSER
        cls.page.resize(cls.width, cls.height)
        cls.page.prepare(FASTER.replace("SPEED", str(cls.speed)) + cls.before)
        cls.colours("light" if cls.light else "dark")

    @classmethod
    def colours(cls, scheme):
        """The system's colours: light or dark."""
        cls.page.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def setUp(self):
        self.page.log("browser")
        self.page.log("performance")
        self.page.go(PAGE.as_uri())
        self.page.wait_text("#state", "not connected")

    def tearDown(self):
        complaints = [entry for entry in self.page.log("browser") if entry["level"] in ("SEVERE", "WARNING")]
        self.assertEqual([], complaints)

    def open_recording(self, path):
        self.page.type("#file", str(path))

    def simulate(self):
        self.page.press("#simulate")
        self.page.wait_text("#state", "scanning")
        self.wait_scans(1)

    def wait_scans(self, count):
        """Waits for this many more complete revolutions."""
        before = self.number("#scans")
        self.page.wait(f"{count} revolutions", lambda: self.number("#scans") >= before + count)

    def number(self, selector):
        text = self.page.text(selector)
        return 0 if text == "–" else int(text)

    def saved(self, button):
        """Clicks; returns name and content of the file that was saved, once it is complete."""
        def finished():
            return [file for file in self.page.downloads.glob("tmini-*") if file.suffix != ".crdownload"]
        self.page.click(button)
        (path,) = self.page.wait("a file", finished)
        content = path.read_bytes()
        path.unlink()
        return path.name, content

    def place_at(self, x, y):
        """What the page shows for this pixel: (metres to the right of the lidar, metres ahead of it)."""
        self.page.run("""const at = document.querySelector('#picture').getBoundingClientRect();
            document.querySelector('#picture').dispatchEvent(new PointerEvent('pointermove', {
                clientX: at.left + 1 + arguments[0], clientY: at.top + 1 + arguments[1] }))""", x, y)
        distance, angle = self.page.text("#pointer").removesuffix("°").split(" m at ")
        angle = math.radians(float(angle))
        return float(distance) * math.sin(angle), float(distance) * math.cos(angle)

    def look(self, condition):
        """Finds pixels (r, g, b) of the picture that fulfil the condition. Returns their number and their middle
        in metres: to the right of the lidar, and ahead of it. Waits for painting; leaves out the legend."""
        count, x, y = self.page.run("""const fulfils = new Function('r', 'g', 'b', 'return ' + arguments[0]);
            return new Promise(requestAnimationFrame).then(() => {
                const canvas = document.querySelector('#picture');
                const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
                copy.drawImage(canvas, 0, 0);
                const { data, width } = copy.getImageData(0, 0, canvas.width, canvas.height - 80);
                let [count, x, y] = [0, 0, 0];
                for (let i = 0; i < data.length; i += 4) {
                    if (fulfils(data[i], data[i + 1], data[i + 2])) {
                        count++;
                        x += i / 4 % width;
                        y += Math.floor(i / 4 / width);
                    }
                }
                return [count, x / count, y / count];
            })""", condition)
        return count, *(self.place_at(x, y) if count else (0, 0))

    def coloured(self):
        """How many pixels of the picture are neither black, white nor grey: points and marks."""
        return self.look("Math.max(r, g, b) - Math.min(r, g, b) > 80")[0]


def decode(path):
    """The tool's rows and counters of a recording."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        stats = BROWSER.folder / "stats.json"
        rows = subprocess.run([TMINI, "decode", path, "--csv", "--stats", stats], check=True,
                              stdout=subprocess.PIPE, stderr=nowhere, text=True).stdout
    return rows, json.loads(stats.read_text())


class Recordings(Viewer):
    """The page shows of a recording what the tool decodes."""

    def check(self, path):
        rows, stats = decode(path)
        self.open_recording(path)
        self.page.wait_text("#source", path.name)
        name, content = self.saved("#save-csv")
        self.assertRegex(name, r"^tmini-points-[\d-]+\.csv$")
        self.assertEqual(rows, content.decode())
        self.page.run("""const position = document.querySelector('#position');
            position.value = position.max; position.dispatchEvent(new Event('input'))""")
        self.page.wait_text("#packets", str(stats["packets"]))
        self.assertEqual([stats[key] for key in ("bytes", "packets", "start_packets", "checksum_errors")],
                         [self.number(key) for key in ("#bytes", "#packets", "#scans", "#checksums")])
        self.assertEqual(stats["bytes_skipped"], self.number("#skipped") + self.number("#last-crc-bytes"))

    def test_clean(self):
        self.check(RECORDINGS / "sim-6hz.bin")
        self.assertEqual("6.00 Hz", self.page.text("#frequency"))
        self.assertEqual("complete", self.page.text("#quality"))
        self.assertEqual("2026031700012345", self.page.text("#ct-serial"))
        self.assertEqual("no faults", self.page.text("#faults"))
        self.assertGreater(self.coloured(), 500)

    def test_damaged(self):
        self.check(RECORDINGS / "sim-6hz-damaged.bin")
        self.assertEqual("bad", self.page.run("return document.querySelector('#checksums').className"))

    def test_without_ct_information(self):
        self.check(RECORDINGS / "sim-10hz-plain.bin")
        self.assertEqual("not sent by this unit", self.page.text("#ct-version"))
        self.assertEqual("not sent", self.page.text("#ct-health"))
        self.assertEqual("–", self.page.text("#faults"))

    def test_of_a_real_unit(self):
        path = real_recording()
        if path is None:
            self.skipTest("no real unit's recording here")
        self.check(path)
        self.assertGreater(self.coloured(), 500)

    def test_that_is_long(self):
        path = self.page.folder / "long.bin"
        path.write_bytes((RECORDINGS / "sim-6hz-damaged.bin").read_bytes() * 30)
        self.check(path)

    def test_dropped_on_the_page_plays_to_its_end(self):
        content = list((RECORDINGS / "sim-12hz.bin").read_bytes())
        self.page.run("""const data = new DataTransfer();
            data.items.add(new File([Uint8Array.from(arguments[0])], 'dropped.bin'));
            document.body.dispatchEvent(
                new DragEvent('drop',
                {dataTransfer: data, bubbles: true, cancelable: true}))""",
                      content)
        self.page.wait_text("#source", "dropped.bin")
        self.assertEqual("Pause", self.page.text("#play"))
        self.page.wait_text("#log", "end of the recording")
        stats = decode(RECORDINGS / "sim-12hz.bin")[1]
        seconds = f"{stats['points'] / 4000:.1f}"  # The lidar takes 4000 samples per second.
        self.assertEqual(f"{seconds} of {seconds} s", self.page.text("#time"))
        self.page.wait_text("#packets", str(stats["packets"]))
        self.page.click("#play")
        self.page.wait("the recording to play again", lambda: 0 < self.number("#packets") < 100)
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")

    def test_that_ends_with_a_start_packet_is_played_to_its_end(self):
        content = (RECORDINGS / "sim-6hz.bin").read_bytes()
        path = self.page.folder / "short.bin"
        last = content.rindex(bytes.fromhex("aa5579"))  # A start packet: AA 55 and its CT at 6.0 Hz.
        path.write_bytes(content[:last + 13])
        self.check(path)

    def test_with_a_wrong_last_crc_has_a_scan_that_is_not_complete(self):
        content = bytearray((RECORDINGS / "sim-6hz.bin").read_bytes())
        last = content.rindex(bytes.fromhex("aa5579"))  # A start packet: AA 55 and its CT at 6.0 Hz.
        content[last - 1] ^= 0x10
        path = self.page.folder / "refuted.bin"
        path.write_bytes(content)
        self.check(path)
        self.assertEqual("gaps: 1, wrong checksums: 0, points dropped: 0", self.page.text("#quality"))

    def test_of_one_packet_has_no_revolution(self):
        self.open_recording(RECORDINGS / "manual-packet.bin")
        self.page.wait_text("#problem", "1 packets, but no whole revolution")
        self.assertEqual(decode(RECORDINGS / "manual-packet.bin")[0], self.saved("#save-csv")[1].decode())

    def test_that_is_damaged_loses_a_packet_and_says_so(self):
        """A byte is missing in the head of a chunk; the file has chunks of 100 bytes (version 1)."""
        content = (RECORDINGS / "sim-6hz.bin").read_bytes()
        chunks = [content[i:i + 100] for i in range(0, len(content), 100)]
        file = b"\x89tmini\x01\n" + b"".join(struct.pack("<IH", 8000, len(chunk)) + chunk for chunk in chunks)
        path = self.page.folder / "damaged.tmini"
        path.write_bytes(file[:5000] + file[5001:])
        self.check(path)
        self.page.wait_text("#problem", "damaged.tmini is damaged in 1 place")

    def test_that_is_none_is_said(self):
        path = self.page.folder / "letter.txt"
        path.write_bytes(random.Random(1).randbytes(5000))
        self.open_recording(path)
        self.page.wait_text("#problem", "letter.txt holds no lidar packet in 5000 bytes.")
        path.write_bytes(b"")
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.open_recording(path)
        self.page.wait_text("#problem", "letter.txt is empty")


class Simulated(Viewer):
    """The simulated lidar, and its faults."""

    def setUp(self):
        super().setUp()
        self.simulate()

    def switch(self, name):
        self.page.press(f"#sim-{name}")

    def test_is_asked_and_scans(self):
        self.assertEqual(
            ["151 T-mini Plus", "1.2", "1", "2026031700012345", "no faults"],
            [self.page.text(f"#{key}") for key in ("model", "firmware", "hardware", "serial-number", "health-reply")])
        self.wait_scans(8)
        self.assertRegex(self.page.text("#frequency"), r"^(5\.9|6\.0)\d Hz$")
        self.assertRegex(self.page.text("#points"), r"^6\d\d, 6\d\d with a distance$")
        self.assertEqual("complete", self.page.text("#quality"))
        self.page.wait_text("#ct-version", "firmware 1.2, hardware 1, protocol 1.0")
        self.assertEqual("2026031700012345", self.page.text("#ct-serial"))
        # The room is 5 m x 4 m; the lidar is 2.2 m from the left wall and 1.7 m from the wall behind it.
        self.assertRegex(self.page.text("#sector6"), r"^2\.(19|20)\d m$")
        self.assertRegex(self.page.text("#sector4"), r"^1\.(69|70)\d m$")
        self.assertEqual([0] * 4, [self.number(key) for key in ("#checksums", "#skipped", "#overrun", "#losses")])
        self.assertGreater(self.number("#last-crc-bytes"), 6)  # One for each revolution.
        self.assertGreater(self.coloured(), 500)

    def test_rotor_blocked(self):
        self.switch("blocked")
        self.page.wait_text("#faults", "encoder")
        self.page.wait_text("#fault", "Is the rotor blocked?")
        self.page.wait_text("#log", "encoder")
        self.assertTrue(self.page.is_shown("#fault"))
        self.wait_scans(4)
        self.assertEqual(["–", "none: the rotor is blocked", "–"],
                         [self.page.text(f"#{key}") for key in ("frequency", "quality", "nearest")])
        self.page.wait_text("#summary", "Not turning, ")
        self.assertLess(self.coloured(), 20)
        self.switch("blocked")
        self.page.wait_text("#faults", "no faults")
        self.assertFalse(self.page.is_shown("#fault"))

    def test_window_covered(self):
        self.switch("covered")
        self.page.wait_text("#fault", "Is the window covered?")
        self.page.wait_text("#quality", "none: no point has a distance")
        self.page.wait_text("#frequency", "Hz")
        self.assertEqual("data", self.page.text("#faults"))
        self.switch("covered")
        self.page.wait_text("#faults", "no faults")

    def test_each_health_bit(self):
        names = ["sensor", "encoder", "wireless power", "PD", "LD", "data"]
        for i, name in enumerate(names):
            self.switch(f"health-{1 << i}")
            self.page.wait_text("#faults", ", ".join(names[:i + 1]))
            self.page.wait_text("#fault", name)

    def test_each_fault_of_the_wire(self):
        for name, sign in (("drop", "#checksums"), ("flip", "#checksums"), ("insert", "#checksums"),
                           ("burst", "#skipped"), ("cut", "#skipped")):
            before = self.number(sign)
            self.switch(f"wire-{name}")
            self.page.wait(f"{name} in {sign}", lambda at=sign, was=before: self.number(at) > was + 2)
            self.page.wait_text("#quality", "gap")
            self.switch(f"wire-{name}")
        self.switch("wire-stall")
        scans = self.number("#scans")
        self.page.wait("stalled bytes to arrive", lambda: self.number("#scans") > scans + 6)
        self.assertEqual("0", self.page.text("#overrun"))

    def test_wrong_baud_rate(self):
        self.switch("wire-garble")
        self.page.wait_text("#problem", "Bytes come, but no valid packets any more")
        self.page.wait_text("#state", "recovering")
        self.switch("wire-garble")
        self.page.wait_text("#state", "scanning", 15)
        self.assertFalse(self.page.is_shown("#problem"))
        self.page.wait("a recovery", lambda: self.number("#recoveries") >= 1)

    def test_without_power(self):
        self.switch("unplugged")
        self.page.wait_text("#problem", "The lidar has fallen silent")
        self.page.wait_text("#log", "lost")
        self.switch("unplugged")
        self.page.wait_text("#state", "scanning", 15)
        self.page.wait_text("#log", "recovered")
        self.page.wait_text("#losses", "1")

    def test_commands(self):
        self.page.clear("#frequency-wanted")
        self.page.type("#frequency-wanted", "12")
        self.page.click("#set-frequency")
        self.page.wait_text("#frequency-set", "set: 12.00 Hz")
        self.page.wait_text("#state", "scanning")
        self.page.wait_text("#frequency", "12.0")
        self.page.click("#start-stop")
        self.page.wait_text("#state", "idle")
        self.page.click("#ask-health")
        self.page.wait_text("#log", "health: no faults")
        self.page.click("#ask-info")
        self.page.wait_text("#state", "idle")
        self.page.click("#start-stop")
        self.page.wait_text("#state", "scanning")
        self.page.click("#reboot")
        self.page.wait_text("#log", "rebooted", 10)
        self.page.wait_text("#state", "scanning")
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.assertTrue(self.page.is_shown("#welcome"))

    def show_visitor_alone(self):
        """Shows only the nearest metre, in which there is only the visitor. Returns where he is drawn."""
        self.page.run("""const range = document.querySelector('#range');
            range.append(new Option('0.9 m', 900, true, true)); range.dispatchEvent(new Event('change'))""")
        self.switch("visitor")
        self.page.wait_text("#sector0", "0.6")
        return self.visitor()

    def visitor_now(self):
        return self.look("Math.max(r, g, b) - Math.min(r, g, b) > 80")

    def visitor(self):
        self.wait_scans(2)
        return self.visitor_now()

    def test_points_are_drawn_where_they_are(self):
        count, right, ahead = self.show_visitor_alone()
        self.assertGreater(count, 100)
        self.assertAlmostEqual(0, right, delta=0.03)
        self.assertAlmostEqual(0.7, ahead, delta=0.04)
        self.front_at("-90")
        _, right, ahead = self.visitor()
        self.assertAlmostEqual(0.7, right, delta=0.04)
        self.assertAlmostEqual(0, ahead, delta=0.03)

    def persist(self, revolutions):
        self.page.run("""const slider = document.querySelector('#persistence');
            slider.value = arguments[0]; slider.dispatchEvent(new Event('input'))""", revolutions)

    def test_earlier_revolutions_stay_as_long_as_wanted(self):
        self.persist(20)
        self.assertEqual("20 revolutions", self.page.text("#persistence-value"))
        self.show_visitor_alone()
        self.switch("visitor")
        self.page.wait_text("#sector0", "1.3")
        self.assertGreater(self.visitor_now()[0], 50) # Few remain on a slow computer.
        self.persist(1)
        self.assertEqual(0, self.visitor()[0])

    def test_flagged_points_are_marked(self):
        self.persist(20)
        self.page.wait("marks in the picture", lambda: self.look("r > 240 && g > 80 && g < 110 && b > 60")[0] > 5)

    def test_picture_is_as_light_as_the_system_or_as_chosen(self):
        white = "r === 255 && g === 255 && b === 255"
        self.assertEqual(0, self.look(white)[0])
        self.page.press("#light")
        self.page.wait("a light picture", lambda: self.look(white)[0] > 10000)
        self.page.press("#light")
        self.page.wait("a dark picture", lambda: self.look(white)[0] == 0)
        self.colours("light")
        self.page.wait("a light picture", lambda: self.look(white)[0] > 10000)
        self.colours("dark")
        self.page.wait("a dark picture", lambda: self.look(white)[0] == 0)

    def test_lidar_that_is_lost_does_not_look_live(self):
        self.switch("unplugged")
        self.page.wait_text("#age", "No scan for 2 s")
        keys = ("frequency", "points", "nearest", "sector0", "faults")
        self.assertEqual(["–"] * 5, [self.page.text(f"#{key}") for key in keys])
        self.page.wait("grey points", lambda: self.coloured() == 0)
        self.switch("unplugged")
        self.page.wait("a scan", lambda: not self.page.is_shown("#age"), 15)
        self.page.wait("coloured points", lambda: self.coloured() > 500)

    def test_place_under_the_pointer_is_shown_and_the_picture_enlarged(self):
        """Up is ahead, right is right. In an enlarged picture the same pixels are fewer metres."""
        below, above = self.place_at(275, 300), self.place_at(275, 100)
        self.assertAlmostEqual(0, above[0] - below[0], delta=0.02)
        self.assertGreater(above[1], below[1] + 1)
        self.assertGreater(self.place_at(400, 300)[0], below[0] + 1)
        self.page.click("#zoom-in")
        self.assertAlmostEqual((above[1] - below[1]) / 1.5,
                               self.place_at(275, 100)[1] - self.place_at(275, 300)[1], delta=0.02)
        self.page.click("#zoom-whole")
        self.assertEqual(above, self.place_at(275, 100))

    def test_enlarged_picture_is_moved_by_the_pointer(self):
        self.page.click("#zoom-in")
        before = self.place_at(200, 200)
        self.page.run("""const picture = document.querySelector('#picture');
            picture.setPointerCapture = () => {};
            const at = picture.getBoundingClientRect();
            for (const [kind, x] of [['down', 200], ['move', 250], ['up', 250]]) {
                picture.dispatchEvent(new PointerEvent(`pointer${kind}`, { pointerId: 1,
                    clientX: at.left + 1 + x, clientY: at.top + 201 }));
            }""")
        self.assertEqual(before, self.place_at(250, 200))

    def reload(self):
        self.page.run("location.reload()")
        self.page.wait_text("#state", "not connected")
        self.simulate()

    def test_mounting_outlives_a_reload(self):
        self.switch("visitor")
        self.front_at("-90")
        self.page.type("#mount-mask", "10:80")
        self.page.press("#mount-upside-down")
        self.reload()
        self.assertEqual(["-90", "10:80", True], self.page.run("""return [document.querySelector('#mount-front').value,
            document.querySelector('#mount-mask').value, document.querySelector('#mount-upside-down').checked]"""))
        self.switch("visitor")
        self.page.wait_text("#sector6", "0.6")
        self.assertEqual("–", self.page.text("#sector1"))
        self.front_at("0")
        self.page.clear("#mount-mask")
        self.page.press("#mount-upside-down")
        self.assertEqual("", self.page.run("return location.hash"))

    def test_mounting_that_is_wrong_is_not_applied(self):
        self.switch("visitor")
        self.page.wait_text("#sector0", "0.6")
        for field, wrong, good in (("front", ("900", "-360.5", "1e2", ""), "0"),
                                   ("mask", ("-20:361", "-20", "-20:20:30", ", ".join(["-20:20"] * 9)), "")):
            for text in wrong:
                self.page.run("""const field = document.querySelector(`#mount-${arguments[0]}`);
                    field.value = arguments[1]; field.dispatchEvent(new Event('input'))""", field, text)
                self.assertEqual("true", self.page.run(
                    "return document.querySelector(`#mount-${arguments[0]}`).ariaInvalid", field), text)
                self.assertRegex(self.page.text("#mount-wrong"), r"^Not applied\. (Degrees, -360|Like this: 170)")
                self.wait_scans(1)
                self.assertRegex(self.page.text("#sector0"), "^0.6")
            self.page.run("""const field = document.querySelector(`#mount-${arguments[0]}`);
                field.value = arguments[1]; field.dispatchEvent(new Event('input'))""", field, good)
            self.assertEqual("", self.page.text("#mount-wrong"))

    def test_what_is_masked_is_not_seen(self):
        self.switch("visitor")
        self.page.wait_text("#sector0", "0.6")
        self.page.type("#mount-mask", "-20:20")
        self.page.wait("nothing there", lambda: self.page.text("#sector0") != "–" and
                       float(self.page.text("#sector0").split()[0]) > 1)
        self.page.type("#mount-mask", ", x")
        self.assertEqual("true", self.page.run("return document.querySelector('#mount-mask').ariaInvalid"))

    def test_what_is_being_recorded_is_saved_when_the_lidar_goes(self):
        self.page.click("#record")
        self.wait_scans(2)
        self.assertGreaterEqual(decode(self.saved_recording("#disconnect"))[1]["start_packets"], 2)

    def test_recording_is_opened_instead_and_last_of_several_stays(self):
        for name in ("sim-6hz.bin", "sim-12hz.bin"):
            self.open_recording(RECORDINGS / name)
        self.page.wait_text("#source", "sim-12hz.bin")
        self.assertFalse(self.page.is_shown("#panel-lidar"))
        self.assertEqual(decode(RECORDINGS / "sim-12hz.bin")[0], self.saved("#save-csv")[1].decode())
        self.page.wait_text("#log", "end of the recording")
        self.assertEqual(1, self.page.text("#log").count("end of the recording"))

    def front_at(self, degrees):
        self.page.clear("#mount-front")
        self.page.type("#mount-front", degrees)

    def test_visitor_and_mounting(self):
        """The visitor stands at the lidar's 0 degrees and is about 25 degrees wide."""
        self.switch("visitor")
        self.page.wait_text("#nearest", "ahead")
        self.page.wait_text("#sector0", "0.6")
        self.front_at("-90")
        self.page.wait_text("#sector2", "0.6")
        self.page.wait_text("#nearest", ", right")
        self.front_at("90")
        self.page.wait_text("#sector6", "0.6")
        self.page.wait_text("#nearest", ", left")
        self.page.click("#mount-upside-down")
        self.page.wait_text("#sector2", "0.6")
        self.page.wait_text("#nearest", ", right")

    def saved_recording(self, button):
        """Clicks; returns the path of the recording that was saved."""
        name, content = self.saved(button)
        self.assertRegex(name, r"^tmini-recording-[\d-]+\.tmini$")
        path = self.page.folder / "saved.tmini"
        path.write_bytes(content)
        return path

    def test_recording_is_saved_with_its_times(self):
        self.page.click("#record")
        self.wait_scans(3)
        path = self.saved_recording("#record")
        rows, stats = decode(path)
        self.assertGreaterEqual(stats["start_packets"], 3)
        self.assertEqual(0, stats["checksum_errors"])
        times = [int(row.split(",")[7]) for row in rows.splitlines()[1:]]
        measured_ms, recorded_ms = stats["points"] / 4, times[-1] - times[0]
        self.assertGreater(recorded_ms, measured_ms - 120)
        self.assertLess(recorded_ms, 2 * measured_ms)  # If the page is slow, the simulated lidar waits.
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.open_recording(path)
        self.page.wait_text("#source", "saved.tmini")
        self.assertEqual(rows, self.saved("#save-csv")[1].decode())

    def test_points_of_the_last_seconds_are_saved(self):
        self.wait_scans(3)
        points = int(self.page.text("#points").split(",")[0])
        self.page.click("#start-stop")
        self.page.wait_text("#state", "idle")
        rows = [row.split(",") for row in self.saved("#save-csv")[1].decode().splitlines()]
        self.assertEqual(["scan", "packet", "point", "angle_deg", "distance_mm", "intensity", "flag", "time_ms",
                          "frequency_hz"], rows[0])
        scans = [row[0] for row in rows[1:]]
        counts = {scans.count(scan) for scan in set(scans)}
        self.assertIn(points, counts)
        self.page.click("#start-stop")
        self.page.wait_text("#state", "scanning")
        self.wait_scans(2)

class WithStandIn(Viewer):
    """With the stand-in for Web Serial."""

    before = STAND_IN

    def connect(self):
        self.page.click("#connect")

    def bench(self, script):
        return self.page.run(script)

    def note_qualities(self):
        """Records what the page says of the scans' quality from now on."""
        self.page.run("""const place = document.querySelector('#quality');
            window.qualities = [];
            window.observer?.disconnect();
            window.observer = new MutationObserver(() => qualities.push(place.textContent));
            observer.observe(place, { childList: true, characterData: true, subtree: true })""")


class Serial(WithStandIn):
    """A serial port: opened, unplugged, in use."""

    def test_stand_in_has_the_members_of_the_real_thing(self):
        members = self.page.run("""return Object.fromEntries(Object.entries(bench.members).map(([name, mine]) =>
            [name, Object.getOwnPropertyNames(window[name].prototype).filter((member) => !member.startsWith('on'))
                .filter((member) => !(member in mine))]))""")
        self.assertEqual({"Serial": [], "SerialPort": []}, members)

    def test_connects_scans_is_unplugged_and_comes_back(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.page.wait_text("#source", "USB adapter 10c4:ea60")
        self.wait_scans(2)
        self.assertEqual(230400, self.bench("return bench.opened[0].baudRate"))
        self.assertEqual("2026031700012345", self.page.text("#serial-number"))
        self.bench("bench.unplug()")
        self.page.wait_text("#problem", "The adapter has gone")
        self.page.wait_text("#state", "unplugged")
        self.bench("bench.plug()")
        self.page.wait_text("#state", "scanning", 15)
        self.assertFalse(self.page.is_shown("#problem"))
        self.wait_scans(2)
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.assertIsNone(self.bench("return bench.port.readable"))
        self.assertEqual([0xA5, 0x65], self.bench("return bench.written.slice(-2)"))
        self.connect()
        self.page.wait_text("#state", "scanning")

    def test_scans_again_with_connect_after_it_was_unplugged(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.bench("bench.unplug()")
        self.page.wait_text("#state", "unplugged")
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.bench("bench.plug()")
        self.connect()
        self.page.wait_text("#state", "scanning", 15)

    def test_lidar_that_was_left_scanning(self):
        self.bench("return bench.leaveScanning()")
        self.connect()
        self.page.wait_text("#serial-number", "2026031700012345")
        self.page.wait_text("#state", "scanning")

    def test_line_errors_do_not_end_it(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        for name in ("BufferOverrunError", "FramingError", "ParityError", "BreakError"):
            self.page.wait_text("#quality", "complete")
            self.note_qualities()
            self.bench(f"bench.lineError('{name}')")
            self.page.wait_text("#log", name)
            self.page.wait("a scan that is not complete", lambda: self.page.run(
                "return qualities.some((quality) => !quality.includes('complete'))"))
        self.wait_scans(2)
        self.assertEqual("scanning", self.page.text("#state"))

    def test_write_that_fails_once_is_repeated(self):
        self.bench("bench.writeError()")
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.page.wait_text("#serial-number", "2026031700012345")

    def test_lidar_that_does_not_report_its_health_scans(self):
        self.bench("bench.answers = (code) => code !== 0x92")
        self.connect()
        self.page.wait_text("#state", "scanning", 15)
        self.page.wait_text("#log", "command failed: timeout")
        self.assertFalse(self.page.is_shown("#problem"))

    def test_command_that_fails_later_is_no_silence(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.page.click("#start-stop")
        self.page.wait_text("#state", "idle")
        self.bench("bench.answers = (code) => code !== 0x90")
        self.page.click("#ask-info")
        self.page.wait_text("#problem", "The lidar has answered before, but now “info” failed: timeout.")
        self.bench("bench.answers = () => true")
        self.page.click("#ask-info")
        self.page.wait("the problem to go", lambda: not self.page.is_shown("#problem"))

    def test_lidar_that_starts_by_itself_is_stopped_again(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.page.click("#start-stop")
        self.page.wait_text("#state", "idle")
        self.bench("return bench.leaveScanning()")
        self.page.wait_text("#log", "unwanted scanning")
        self.page.wait_text("#state", "idle")

    def test_lidar_that_does_not_hear_at_first(self):
        self.bench("let asked = 0; bench.answers = (code) => code !== 0x90 || ++asked > 4")
        self.connect()
        self.page.wait_text("#state", "scanning", 15)

    def test_page_that_goes_away_stops_the_lidar(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.bench("dispatchEvent(new Event('pagehide'))")
        self.page.wait("a stop", lambda: self.bench("return bench.written.slice(-2)") == [0xA5, 0x65])

    def test_port_in_use(self):
        self.bench("bench.opening = 'NetworkError'")
        self.connect()
        self.page.wait_text("#problem", "another program or tab is using it")
        self.assertTrue(self.page.is_shown("#problem"))
        self.bench("bench.opening = null")
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.assertFalse(self.page.is_shown("#problem"))

    def test_no_port_chosen(self):
        self.bench("bench.choice = 'none'")
        self.connect()
        self.assertFalse(self.page.is_shown("#problem"))
        self.assertTrue(self.page.is_shown("#welcome"))

    def test_no_answer(self):
        self.bench("bench.line = 'dead'")
        self.connect()
        self.page.wait_text("#problem", "No answer: not one byte came.")

    def test_wrong_baud_rate(self):
        self.bench("bench.line = 'garbled'")
        self.connect()
        self.page.wait_text("#problem", "nothing that a T-mini Plus sends: a wrong baud rate", 15)

    def test_lidar_that_does_not_hear(self):
        self.bench("return bench.leaveScanning()")
        self.bench("bench.line = 'deaf'")
        self.connect()
        self.page.wait_text("#problem", "does not do what it is asked", 15)


class SerialInTime(WithStandIn):
    """Tests in real time: a scan that takes too long is not complete."""

    speed = 1

    def test_page_that_is_busy_for_a_while_loses_nothing(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.wait_scans(2)
        self.page.run("""bench.line = 'held';  // Bytes that come meanwhile arrive a little after the page is back.
            const end = performance.now() + 1080;  // Longer than the lidar may be silent.
            while (performance.now() < end) { /* Busy. */ }
            setTimeout(() => { bench.line = 'good'; }, 120)""")
        self.wait_scans(3)
        self.assertEqual([0, 0, 0], [self.number(key) for key in ("#losses", "#checksums", "#overrun")])
        self.assertEqual("complete", self.page.text("#quality"))

    def test_bytes_that_come_late_and_in_portions_are_no_gap(self):
        self.connect()
        self.page.wait_text("#state", "scanning")
        self.wait_scans(2)
        self.note_qualities()
        self.bench("bench.line = 'late'")
        self.wait_scans(3)
        self.assertEqual([], self.page.run("return qualities.filter((quality) => quality !== 'complete')"))


class Served(Viewer):
    """The page from `python -m tmini serve`, on a phone, in real time: the lidar there, live."""

    width, height, speed = 390, 844, 1

    @classmethod
    def setUpClass(cls):
        cls.python = os.environ.get("TMINI_PYTHON", sys.executable)
        if subprocess.run([cls.python, "-c", "import tmini, websockets"], stderr=subprocess.DEVNULL,
                          check=False).returncode != 0:
            raise unittest.SkipTest(f"{cls.python} has no tmini[serve] (the test `python` brings it)")
        super().setUpClass()

    def setUp(self):
        self.page.log("browser")
        self.page.log("performance")
        self.sim = subprocess.Popen([os.environ["TMINI_SIM"], "--pty"], stdout=subprocess.PIPE, text=True)
        self.port = self.sim.stdout.readline().strip()
        self.serve(0)
        self.page.go(self.url)
        self.page.wait_text("#state", "scanning", 15)

    def tearDown(self):
        super().tearDown()
        self.page.go("about:blank")
        self.sim.send_signal(signal.SIGCONT)
        for process in (self.server, self.sim):
            process.terminate()
            process.communicate()

    def serve(self, number):
        self.server = subprocess.Popen(
            [self.python, "-m", "tmini", "serve", self.port, "--page", PAGE, "--tcp", str(number)],
            stdout=subprocess.PIPE, text=True)
        self.url = self.server.stdout.readline().strip()

    def test_room_is_seen_and_nothing_can_be_commanded(self):
        self.page.wait_text("#quality", "complete")
        self.wait_scans(5)
        self.assertRegex(self.page.text("#sector6"), r"^2\.(19|20)\d m$")
        self.assertGreater(self.coloured(), 300)
        self.assertEqual([0] * 3, [self.number(key) for key in ("#checksums", "#overrun", "#losses")])
        self.assertFalse(self.page.is_shown("#panel-lidar"))
        self.assertFalse(self.page.is_shown("#panel-unit"))
        urls = {url for url in OneFile.requests(self) if not url.startswith("data:")}
        self.assertEqual({f"{self.url}/", f"{self.url}/live"}, urls)

    def test_page_goes_on_when_the_server_is_back(self):
        self.server.terminate()
        self.server.communicate()
        self.page.wait_text("#problem", "The connection to the lidar’s server is lost.")
        self.page.wait_text("#state", "unplugged")
        self.serve(self.url.rpartition(":")[2])
        self.page.wait_text("#state", "scanning", 15)
        self.wait_scans(3)
        self.page.wait("the problem to go", lambda: not self.page.is_shown("#problem"))
        self.page.log("browser")  # The browser complains of refused connections.

    def test_lidar_without_power_is_missed(self):
        self.wait_scans(1)
        self.sim.send_signal(signal.SIGSTOP)
        self.page.wait_text("#problem", "Nothing comes from the lidar yet.", 15)
        self.assertTrue(self.page.is_shown("#age"))
        self.sim.send_signal(signal.SIGCONT)
        self.wait_scans(3)
        self.page.wait("the problem to go", lambda: not self.page.is_shown("#problem"))

    def test_who_has_left_can_watch_again(self):
        self.page.click("#disconnect")
        self.page.wait_text("#state", "not connected")
        self.page.click("#watch")
        self.page.wait_text("#state", "scanning", 15)
        self.wait_scans(1)


class WithoutSerial(Viewer):
    """A browser without Web Serial."""

    before = "delete Navigator.prototype.serial"

    def test_says_so_and_simulates(self):
        self.page.click("#connect")
        self.page.wait_text("#problem", "This browser cannot reach a serial port.")
        self.page.wait_text("#problem", "Chrome, Edge or Opera")
        self.simulate()
        self.assertFalse(self.page.is_shown("#problem"))


class RealSerial(Viewer):
    """Chromium's own Web Serial, without a port: a page opened from a file can use it."""

    def test_is_there(self):
        self.assertTrue(self.page.run("return isSecureContext && navigator.serial instanceof Serial"))
        self.assertEqual([], self.page.run("return navigator.serial.getPorts()"))


class Appearance(Viewer):
    """The dark theme on a wide screen."""

    grounds = ((15, 26, 46), (10, 15, 31))

    def test_no_word_is_cut_off_and_nothing_lies_beside_the_page(self):
        self.simulate()
        self.page.click("#sim-blocked")
        self.page.wait_text("#fault", "encoder")
        self.assertEqual([], self.page.run("""return [...document.querySelectorAll('body *')]
            .filter((item) => item.checkVisibility() && item.getBoundingClientRect().right > innerWidth + 1)
            .map((item) => item.outerHTML.slice(0, 80))"""))

    def test_picture_has_the_theme_and_the_points(self):
        self.simulate()
        ground = " || ".join(f"r === {r} && g === {g} && b === {b}" for r, g, b in self.grounds)
        share = self.look(ground)[0] / self.page.run("""const { width, height } = document.querySelector('#picture');
            return width * (height - 80)""")
        self.assertGreater(share, 0.5)
        self.page.wait("points", lambda: self.coloured() > 300)

    def test_words_stand_out(self):
        colours = self.page.run("""const probe = document.createElement('canvas')
                .getContext('2d', {willReadFrequently: true});
            const style = getComputedStyle(document.documentElement);
            return Object.fromEntries([
                'ground', 'page', 'text', 'dim', 'accent', 'on-accent', 'nearest', 'alarm', 'alarm-ground']
                .map((name) => {
                    probe.fillStyle = style.getPropertyValue('--' + name);
                    probe.fillRect(0, 0, 1, 1);
                    return [name, [...probe.getImageData(0, 0, 1, 1).data].slice(0, 3)];
                }))""")
        for one, other in (("text", "ground"), ("text", "page"), ("dim", "ground"), ("dim", "page"),
                           ("accent", "ground"), ("nearest", "ground"), ("on-accent", "accent"), ("alarm", "ground"),
                           ("alarm", "alarm-ground"), ("text", "alarm-ground")):
            self.assertGreaterEqual(contrast(colours[one], colours[other]), 4.5, f"{one} on {other}")


class AppearanceLight(Appearance):
    """The light theme on a wide screen."""

    light = True
    grounds = ((255, 255, 255), (243, 244, 246))


class AppearancePhone(Appearance):
    """On a screen as wide as a phone."""

    width, height = 360, 740

    def test_switches_of_the_simulated_lidar_are_near(self):
        self.simulate()
        self.assertLess(self.page.run("return document.querySelector('#sim-blocked').getBoundingClientRect().top"),
                        1.2 * self.height)

    def test_buttons_are_large_enough_to_touch(self):
        self.assertEqual([], self.page.run("""return [...document.querySelectorAll('button')]
            .filter((item) => item.checkVisibility() && item.getBoundingClientRect().height < 44)
            .map((item) => item.id)"""))


class Accessibility(Viewer):
    """Use with a keyboard and with a screen reader."""

    controls = ("button", "checkbox", "slider", "spinbutton", "combobox", "textbox")

    def tree(self):
        nodes = self.page.devtools("Accessibility.getFullAXTree")["nodes"]
        return [(node["role"]["value"], node.get("name", {}).get("value", ""))
                for node in nodes if not node["ignored"]]

    def test_each_control_has_a_name_of_its_own(self):
        self.simulate()
        controls = [(role, name) for role, name in self.tree() if role in self.controls]
        self.assertGreater(len(controls), 25)
        self.assertEqual([], [control for control in controls if not control[1].strip()])
        self.assertEqual(len(controls), len(set(controls)))

    def test_picture_is_described_in_words(self):
        self.simulate()
        self.page.wait_text("#summary", "Nearest obstacle: 1.0")
        roles = [role for role, _ in self.tree()]
        for role in ("image", "log", "status", "main", "heading"):
            self.assertIn(role, roles)
        self.page.click("#sim-covered")
        self.page.wait_text("#fault", "data")
        self.assertIn("alert", [role for role, _ in self.tree()])

    def test_each_control_is_reached_and_used_by_keyboard(self):
        tab = "\ue004"
        reached = set()
        for _ in range(40):
            self.press(tab)
            reached.add(self.page.run("return document.activeElement.id"))
        wanted = set(self.page.run("""return [...document.querySelectorAll('button, input, select')]
            .filter((item) => item.checkVisibility() && !item.disabled).map((item) => item.id)"""))
        self.assertEqual(set(), wanted - reached)
        self.page.run("document.querySelector('#simulate').focus()")
        self.press("\ue007")
        self.page.wait_text("#state", "scanning")
        self.assertNotEqual("BODY", self.page.run("return document.activeElement.tagName"))

    def press(self, key):
        self.page.press_key(key)


class Axe(Viewer):
    """The page breaks no rule of axe-core, including best practices. test/run.sh installs axe-core."""

    def check(self, program):
        self.page.run("document.head.append(Object.assign(document.createElement('script'), {text: arguments[0]}))",
                      program)
        passed, broken = self.page.run("""return axe.run().then(({ violations, passes }) => [passes.length,
            violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`))])""")
        self.assertEqual([], broken)
        self.assertGreater(passed, 20)

    def check_each_state(self, program):
        """Checks the welcome page, a fault, and a lost lidar."""
        self.check(program)
        self.simulate()
        self.page.press("#sim-blocked")
        self.page.wait_text("#fault", "encoder")
        self.check(program)
        self.page.press("#sim-unplugged")
        self.page.wait_text("#age", "No scan for")
        self.check(program)

    def test_finds_nothing(self):
        folder = pathlib.Path(os.environ.get("TMINI_AXE", ""))
        path = next(folder.glob("lib/python*/site-packages/*/axe.min.js"), None)
        if path is None:
            self.skipTest("axe-core is not here (test/run.sh --all brings it)")
        program = path.read_text(encoding="utf-8")
        self.check_each_state(program)
        self.setUp()
        self.page.resize(390, 844)
        self.colours("light")
        self.check_each_state(program)


class OneFile(Viewer):
    """The page needs no other file and requests nothing from a server."""

    def requests(self):
        """The requested URLs, without those of the browser's own pages: its new tab may still be loading."""
        messages = [json.loads(entry["message"])["message"] for entry in self.page.log("performance")]
        sent = [message["params"] for message in messages if message["method"] == "Network.requestWillBeSent"]
        return [request["request"]["url"] for request in sent
                if not request["documentURL"].startswith("chrome:")]

    def test_is_small(self):
        self.assertLessEqual(PAGE.stat().st_size, SIZE_MAX)

    def test_asks_for_nothing(self):
        self.simulate()
        self.assertEqual({PAGE.as_uri()}, {url for url in self.requests() if not url.startswith("data:")})

    def test_policy_forbids_all_that_the_page_does_not_need(self):
        """Even a page that runs a stranger's script can load nothing, and send nothing anywhere."""
        forbidden = self.page.run("""return new Promise((resolve) => {
                const seen = new Set();
                addEventListener('securitypolicyviolation', ({ effectiveDirective }) => {
                    seen.add(effectiveDirective);
                    if (seen.size === arguments[0].length) { resolve([...seen].sort()); }
                });
                setTimeout(() => resolve([...seen].sort()), 50000);
                const away = 'http://127.0.0.1:9/x';
                const add = (name, has) => document.body.append(Object.assign(document.createElement(name), has));
                for (const name of ['img', 'iframe', 'audio', 'embed']) { add(name, { src: away }); }
                add('script', { src: away });
                add('link', { rel: 'stylesheet', href: away });
                add('base', { href: away });
                add('form', { action: away });
                document.forms[document.forms.length - 1].submit();
                fetch(away).catch(() => {});
                new FontFace('x', `url(${away})`).load().catch(() => {});
            })""", POLICY)
        self.page.log("browser")  # The browser's complaints are what is wanted.
        self.assertEqual(POLICY, forbidden)

    def test_works_from_a_server(self):
        seen = []

        class Handler(http.server.SimpleHTTPRequestHandler):
            def log_message(self, *_):
                seen.append(self.path)

        handler = functools.partial(Handler, directory=str(PAGE.parent))
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            self.page.go(f"http://127.0.0.1:{server.server_port}/{PAGE.name}")
            self.simulate()
        finally:
            server.shutdown()
            server.server_close()
        self.assertEqual([f"/{PAGE.name}"], seen)


def main():
    global PAGE, TMINI, BROWSER
    PAGE, TMINI = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("terminated"))  # So that the browser is ended, too.
    try:
        BROWSER = browser.Page()
    except browser.Missing as why:
        print(f"SKIPPED: {why}")
        return 77
    try:
        program = unittest.main(argv=[sys.argv[0], *sys.argv[3:]], exit=False, verbosity=2)
        return 0 if program.result.wasSuccessful() else 1
    finally:
        BROWSER.close_all()


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main())
