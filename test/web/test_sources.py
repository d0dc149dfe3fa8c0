# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the viewer shows of recordings, and of a lidar on a serial port."""

import os
import random
import re

import pytest
from conftest import HERE, RECORDINGS, decode, stories
from lidar_bytes import timed, turn

STAND_IN = (HERE / "serial_stand_in.js").read_text(encoding="utf-8")
START_PACKET = bytes.fromhex("aa5579")  # Its beginning at 6.0 Hz: AA 55 and its CT.
ROOM = (RECORDINGS / "sim-6hz.bin").read_bytes()


# ------------------------------------------------------------------------------------------------------ recordings

def refuted():
    """With a wrong LastCRC before the last start packet."""
    content = bytearray(ROOM)
    content[content.rindex(START_PACKET) - 1] ^= 0x10
    return content


def real():
    """The recording of a real unit, or None."""
    folder = os.environ.get("TMINI_RECORDINGS_DIR") or str(RECORDINGS / "real")
    path = os.path.join(folder, "t-mini-plus-room.bin")
    return open(path, "rb").read() if os.path.exists(path) else None


def damaged():
    """A byte is missing in the head of a chunk of 100 bytes."""
    file = timed(*((8000, ROOM[at:at + 100]) for at in range(0, len(ROOM), 100)), version=1)
    return file[:5000] + file[5001:]


RECORDED = [
    ("clean.bin", lambda: ROOM, "frequency = 6.00 Hz; quality = complete; ct-serial = 2026031700012345; "
     "faults = no faults; 500 coloured"),
    ("damaged.bin", (RECORDINGS / "sim-6hz-damaged.bin").read_bytes, "shown checksums"),
    ("plain.bin", (RECORDINGS / "sim-10hz-plain.bin").read_bytes,
     "ct-version = not sent by this unit; ct-health = not sent; faults = –"),
    ("no-frequency.bin", lambda: turn([(900, 100, 0)] * 4, ct=1), "frequency = –; summary: –, 4 points"),
    ("one-packet.bin", (RECORDINGS / "manual-packet.bin").read_bytes, "problem: 1 packets, but no whole revolution"),
    ("real.bin", real, "500 coloured"),
    ("long.bin", lambda: (RECORDINGS / "sim-6hz-damaged.bin").read_bytes() * 30, "shown checksums"),
    ("ends-with-a-start-packet.bin", lambda: ROOM[:ROOM.rindex(START_PACKET) + 13], "not problem"),
    ("refuted.bin", refuted, "quality = gaps: 1, wrong checksums: 0, points dropped: 0"),
    ("damaged.tmini", damaged, "problem: damaged.tmini is damaged in 1 place"),
]


@pytest.mark.parametrize("name, content, then", RECORDED, ids=[name for name, *_ in RECORDED])
def test_of_a_recording_is_shown_what_the_tool_decodes(page, tmp_path, name, content, then):
    path, content = tmp_path / name, content()
    if content is None:
        pytest.skip("no real unit's recording here")
    path.write_bytes(content)
    rows, stats = decode(path)
    page.type("file", path)
    page.wait_text("source", name)
    saved, table = page.save("save-csv")
    assert re.fullmatch(r"tmini-points-\d{4}-\d\d-\d\d-\d{6}\.csv", saved) and table.decode() == rows
    page.set("position", page.run("return document.querySelector('#position').max"))
    page.play(f"packets = {stats['packets']}; bytes = {stats['bytes']}; scans = {stats['start_packets']}; "
              f"checksums = {stats['checksum_errors']}; {then}")
    assert page.number("skipped") + page.number("last-crc-bytes") == stats["bytes_skipped"]
    assert page.run("return document.querySelector('#checksums').className") == "bad" * (stats["checksum_errors"] > 0)


def test_a_file_that_is_no_recording_is_called_so(page, tmp_path):
    path = tmp_path / "letter.txt"
    for content, said in ((random.Random(1).randbytes(5000), "letter.txt holds no lidar packet in 5000 bytes."),
                          (b"", "letter.txt is empty")):
        path.write_bytes(content)
        page.type("file", path)
        page.play(f"problem: {said}; disconnect; state: not connected")


def note(page, name):
    """Records in `noted` what this element says from now on, also what it says for a moment only."""
    page.run("""const place = document.getElementById(arguments[0]);
        window.noted = [];
        window.observer?.disconnect();
        window.observer = new MutationObserver(() => noted.push(place.textContent));
        observer.observe(place, { childList: true, characterData: true, subtree: true })""", name)


def test_a_recording_dropped_on_the_page_plays_to_its_end_and_again(page):
    path = RECORDINGS / "sim-12hz.bin"
    note(page, "play")
    page.run("""const data = new DataTransfer();
        data.items.add(new File([Uint8Array.from(arguments[0])], 'dropped.bin'));
        document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true}))""",
             list(path.read_bytes()))
    stats = decode(path)[1]
    seconds = f"{stats['points'] / 4000:.1f}"  # The lidar takes 4000 samples per second.
    page.play(f"source: dropped.bin; log: end of the recording; time = {seconds} of {seconds} s; "
              f"packets = {stats['packets']}; play")
    page.wait("the recording to play again", lambda: page.run("return noted").count("Pause") == 2)
    page.play("disconnect; state: not connected")


def test_a_recording_is_opened_instead_of_a_lidar_and_the_last_of_several_stays(simulated):
    for name in ("sim-6hz.bin", "sim-12hz.bin"):
        simulated.type("file", RECORDINGS / name)
    simulated.play("source: sim-12hz.bin; not panel-lidar")
    assert simulated.save("save-csv")[1].decode() == decode(RECORDINGS / "sim-12hz.bin")[0]
    simulated.wait_text("log", "end of the recording")
    assert simulated.text("log").count("end of the recording") == 1


# ----------------------------------------------------------------------------- a serial port, with the stand-in for it

@pytest.mark.parametrize("settings", [{"before": STAND_IN}], ids=["stand-in"])
class TestSerial:
    def test_the_stand_in_has_only_what_web_serial_has(self, page):
        assert page.run("""return [[bench.port, SerialPort], [navigator.serial, Serial]].flatMap(([standIn, real]) =>
            Object.getOwnPropertyNames(Object.getPrototypeOf(standIn)).filter((name) => !(name in real.prototype))
            )""") == []

    def test_a_lidar_is_connected_scans_is_unplugged_and_comes_back(self, page):
        page.play("connect; state: scanning; source: USB adapter 10c4:ea60; 2 scans; serial-number = 2026031700012345; "
                  "bench.unplug(); problem: The adapter has gone; state: unplugged; bench.plug(); state: scanning; "
                  "not problem; 2 scans; disconnect; state: not connected")
        assert page.run("return [bench.baudRate, bench.port.readable, ...bench.written.slice(-2)]") == [
            230400, None, 0xA5, 0x65]
        page.play("connect; state: scanning")

    @pytest.mark.parametrize("other, opened", ((0xEA60, [0xEA60, 0xEA60]), (0x7523, [0xEA60])))
    def test_only_the_same_kind_of_adapter_takes_over(self, page, other, opened):
        page.play(f"connect; state: scanning; bench.unplug(); state: unplugged; bench.plugAnother({other})")
        assert page.run("return bench.opened") == opened

    @stories({
        "it scans again with Connect after it was unplugged":
            "connect; state: scanning; bench.unplug(); state: unplugged; disconnect; state: not connected; "
            "bench.plug(); connect; state: scanning",
        "a lidar that was left scanning scans":
            "return bench.leaveScanning(); connect; serial-number: 2026031700012345; state: scanning",
        "a write that fails once is repeated":
            "bench.writeError(); connect; state: scanning; serial-number: 2026031700012345",
        "a lidar that does not report its health scans":
            "bench.answers = (code) => code !== 0x92; connect; state: scanning; log: command failed: timeout; "
            "not problem",
        "a command that fails later is no silence":
            "connect; state: scanning; start-stop; state: idle; bench.answers = (code) => code !== 0x90; ask-info; "
            "problem: The lidar has answered before, but now “info” failed: timeout.; "
            "bench.answers = () => true; ask-info; not problem",
        "a lidar that starts by itself is stopped again":
            "connect; state: scanning; start-stop; state: idle; return bench.leaveScanning(); log: unwanted scanning; "
            "state: idle",
        "a lidar that does not hear at first scans":
            "bench.asked = 0; bench.answers = (code) => code !== 0x90 || ++bench.asked > 4; connect; state: scanning",
        "a port in use is called so":
            "bench.opening = 'NetworkError'; connect; problem: another program or tab is using it; shown problem; "
            "bench.opening = null; connect; state: scanning; not problem; shown zoom",
        "no port chosen is no problem":
            "bench.choice = 'none'; connect; not problem; not zoom; shown welcome",
        "a lidar that does not answer is called so":
            "bench.answers = () => false; connect; problem: No answer: not one byte came.",
        "a wrong baud rate is called so":
            "bench.line = 'garbled'; connect; problem: nothing that a T-mini Plus sends: a wrong baud rate",
        "a lidar that does not hear is called so":
            "return bench.leaveScanning(); bench.answers = () => false; connect; problem: does not do what it is asked",
    })
    def test_a_serial_port(self, page, story):
        page.play(story)

    def test_errors_of_the_line_do_not_end_it(self, page):
        page.play("connect; state: scanning")
        for name in ("BufferOverrunError", "FramingError", "ParityError", "BreakError"):
            page.wait_text("quality", "complete")
            note(page, "quality")
            page.play(f"bench.lineError('{name}'); log: {name}")
            page.wait("a scan that is not complete", lambda: page.run(
                "return noted.some((quality) => !quality.includes('complete'))"))
        page.play("2 scans; state = scanning")

    def test_a_page_that_goes_away_stops_the_lidar(self, page):
        page.play("connect; state: scanning")
        assert page.run("""return (async () => {
            dispatchEvent(new Event('pagehide'));
            for (let i = 0; i < 50; i++) { await null; }  // Before any timer runs: there will be none.
            return bench.written.slice(-2);
        })()""") == [0xA5, 0x65]


@pytest.mark.parametrize("settings", [{"before": STAND_IN, "speed": 1}], ids=["stand-in"])
class TestSerialInTime:
    """In real time: a scan that takes too long is not complete."""

    def test_a_page_that_is_busy_for_a_while_loses_nothing(self, page):
        page.play("connect; state: scanning; 2 scans")
        page.run("""bench.line = 'held';  // Bytes that come meanwhile arrive a little after the page is back.
            const end = performance.now() + 1080;  // Longer than the lidar may be silent.
            while (performance.now() < end) { /* Busy. */ }
            setTimeout(() => { bench.line = 'good'; }, 120)""")
        page.play("3 scans; losses = 0; checksums = 0; overrun = 0; quality = complete")

    def test_bytes_that_come_late_and_in_portions_are_no_gap(self, page):
        page.play("connect; state: scanning; 2 scans")
        note(page, "quality")
        page.play("bench.line = 'late'; 3 scans")
        assert page.run("return noted.filter((quality) => quality !== 'complete')") == []


@pytest.mark.parametrize("settings", [{"before": "delete Navigator.prototype.serial"}], ids=["none"])
def test_a_browser_without_web_serial_is_told_so_and_simulates(page):
    page.play("connect; problem: This browser cannot reach a serial port.; problem: Chrome, Edge or Opera; "
              "simulate; state: scanning; not problem")


def test_a_page_opened_from_a_file_can_use_the_browsers_own_web_serial(page):
    assert page.run("return isSecureContext && navigator.serial instanceof Serial")
    assert page.run("return navigator.serial.getPorts()") == []
