# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`tmini decode` prints what a plain reading of the protocol finds in intact and in damaged recordings. Also: how the
tool takes options, and what it says when there is nothing to decode."""

import concurrent.futures
import json
import os
import random
import re
import resource
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import HERE, TMINI, TMINI_SIM
from lidar_bytes import MAGIC, damaged, decode, packet, points, timed

HEADER = "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n"
ROOM = "recordings/sim-6hz.bin"
RECORDINGS = sorted(path.name for path in (Path(__file__).parents[1] / "recordings").glob("*.bin"))
COMMANDS = ("info", "health", "frequency", "reboot", "scan", "record", "decode", "plot", "view", "ports", "check")

START = packet([(1000, 10, 0)], 0, 0, ct=121)
THREE = packet([(1000, 10, 0), (0, 0, 0), (3000, 30, 2)], 224, 22912)  # 3.5 degrees to 358.
ONE_SCAN = START + THREE + START


# ---- Rows, checked by another reading of the protocol


def rows(packets):
    """The table, as the tool prints it. 4000 samples per second give the time."""
    scan = samples = 0
    frequency = ""
    for number, content in enumerate(packets):
        if content[2] & 1:
            scan += 1
            frequency = f"{(content[2] >> 1) / 10:.2f}" if content[2] >> 1 else ""
        for i, (angle, distance, intensity, flag) in enumerate(points(content)):
            degrees = f"{angle * 15625 // 1000000}.{angle * 15625 % 1000000:06}"  # 1/64 degree is 0.015625 degrees.
            yield f"{scan},{number},{i},{degrees},{distance},{intensity},{flag},{samples // 4},{frequency}\n"
        samples += content[3]


def expect_rows(tmini, content, max_samples=80):
    Path("some.bin").write_bytes(content)
    run = tmini("decode", "some.bin", "--csv", "--stats", "stats.json", "--max-samples", max_samples)
    packets, counts = decode(content, max_samples)
    assert run.status == (0 if packets else 1)
    assert run.out == HEADER + "".join(rows(packets))
    assert json.loads(Path("stats.json").read_text(encoding="ascii")) == counts


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_recording_is_decoded_as_the_protocol_says(tmini, name):
    expect_rows(tmini, Path("recordings", name).read_bytes())


@pytest.mark.parametrize("seed", range(1, 41))
def test_a_damaged_recording_is_decoded_as_the_protocol_says(tmini, seed):
    expect_rows(tmini, damaged(Path(ROOM).read_bytes()[:12000], seed, seed), (39, 80, 255)[seed % 3])


def test_a_recording_cut_anywhere_is_examined_to_its_last_byte(tmini):
    content = Path(ROOM).read_bytes()
    for cut in range(300, 440, 3):
        expect_rows(tmini, content[:cut])


# The false header claims 80 samples, but the recording ends earlier: the bytes after the header are parsed again.
def test_a_packet_after_a_false_header_at_the_end_is_found(tmini):
    expect_rows(tmini, bytes.fromhex("AA550050010001000000") + Path("recordings/manual-packet.bin").read_bytes())


# The manual's packet: 339.15625 degrees to 0.765625 degrees.
def test_a_recording_can_come_from_standard_input(tmini):
    with open("recordings/manual-packet.bin", "rb") as stdin:
        run = tmini("decode", "-", "--csv", stdin=stdin)
    assert run.status == 0
    assert run.out.startswith(HEADER + "0,0,0,339.156250,11842,1,0,0,\n0,0,1,340.359375,11819,1,0,0,\n")
    assert run.out.endswith("\n0,0,18,0.765625,11135,1,2,0,\n")
    assert run.err == "packets 1, start packets 0, points 19, checksum errors 0, bytes 67, bytes skipped 0\n"


# ---- Scans


# Packets, start packets, points, skipped bytes, wrong checksums; and the scans as points/packets/frequency in 0.1 Hz,
# or as a part with its gaps. Known from tmini-sim's own report and, for a real unit, from the recording's description.
RECORDED = {
    "manual-packet.bin": ((1, 0, 19, 0, 0), ""),
    "sim-6hz.bin": ((190, 9, 7133, 101, 0),
                    "873/23/46 699/19/57 665/18/60 669/18/60 667/18/60 666/18/60 667/18/60 669/18/60"),
    "sim-10hz-plain.bin": ((143, 11, 5132, 99, 0),
                           "725/20/55 561/15/71 475/13/84 419/12/95 402/12/100 401/11/100 400/11/100 399/11/100 "
                           "402/12/100 401/11/100"),
    "sim-12hz.bin": ((149, 13, 5149, 19, 0),
                     "553/15/72 457/13/88 398/11/101 358/10/112 335/10/119 334/10/120 332/11/120 334/10/120 "
                     "334/10/120 332/10/120 333/10/120 332/10/120"),
    # Each of the 266 of 299 packets that arrived intact is decoded. No revolution arrived intact.
    "sim-6hz-damaged.bin": ((266, 15, 9832, 4214, 32), "part:3 part:1 part:2 part:2 part:1 part:3 part:1 part:1 part:3 "
                                                       "part:2 part:3 part:1 part:3 part:1"),
    "t-mini-plus-room.bin": ((89, 5, 3278, 0, 0), "624/17/63 624/17/64 626/17/65 630/17/64"),
}


@pytest.mark.parametrize("name", RECORDED)
def test_a_recording_has_the_scans_that_were_sent(tmini, folder, name):
    path = Path("recordings", name)
    if name.startswith("t-mini"):
        path = Path(os.environ.get("TMINI_RECORDINGS_DIR", "recordings/real"), name)
    if not path.exists():
        pytest.skip("no recording of a real unit in TMINI_RECORDINGS_DIR")
    run = tmini("decode", path, "--json", "--stats", "stats")
    counts, ended = json.loads(Path("stats").read_text()), [json.loads(line) for line in run.out.splitlines()][:-1]
    assert tuple(counts[key] for key in ("packets", "start_packets", "points", "bytes_skipped", "checksum_errors")) == \
        RECORDED[name][0]
    assert " ".join(f"{len(scan['points'])}/{scan['packets']}/{10 * scan['frequency_hz']:.0f}" if scan["complete"]
                    else f"part:{scan['gaps']}" for scan in ended) == RECORDED[name][1]
    assert {scan["faults"] for scan in ended} <= {0 if name in ("sim-6hz.bin", "sim-12hz.bin") else None}


@pytest.fixture(scope="module")
def sent(tmp_path_factory):
    """A folder with the simulated lidar's recordings, made anew, which must not have changed; and all that was sent."""
    folder = tmp_path_factory.mktemp("sent")
    subprocess.run([HERE.parent / "recordings/make.sh", TMINI_SIM, folder, HERE.parent / "recordings"], check=True)
    return folder


@pytest.mark.parametrize("name", ("sim-6hz", "sim-10hz-plain", "sim-12hz", "sim-6hz-damaged"))
def test_every_sample_of_an_intact_packet_is_as_it_was_sent(tmini, sent, name):
    truth = [row.split(",") for row in (sent / f"{name}.csv").read_text(encoding="ascii").splitlines()[1:]]
    rows = [row.split(",") for row in tmini("decode", f"recordings/{name}.bin", "--csv").out.splitlines()[1:]]
    assert [[index, f"{float(degrees) * 64:g}", *sample] for _, _, index, degrees, *sample, _, _ in rows] == \
        [sample for _, _, *sample, intact in truth if intact == "1"]


def line_of(scan):
    """What examples/decoder_only prints."""
    near = min((point for point in scan["points"] if point[1] > 0), key=lambda point: point[1], default=None)
    return (f"{len(scan['points'])} points, {'complete' if scan['complete'] else 'incomplete'}"
            + (f", nearest {near[1]} mm at {near[0]:.2f} degrees" if near else ""))


@pytest.mark.parametrize("name", RECORDINGS)
def test_the_decoder_without_the_driver_finds_the_same_scans(tmini, name):
    content = Path("recordings", name).read_bytes()
    alone = subprocess.run([os.environ["TMINI_DECODER_ONLY"]], input=content, capture_output=True, check=True)
    run = tmini("decode", f"recordings/{name}", "--json", "--quiet")
    ended = [line_of(json.loads(line)) for line in run.out.splitlines()][:-1]  # The last one goes on.
    assert alone.stdout.decode().splitlines() == ended


def test_json_is_an_object_per_line_for_each_scan(tmini, folder):
    (folder / "one.bin").write_bytes(ONE_SCAN)
    run = tmini("decode", "one.bin", "--json", "--quiet")
    assert (run.status, run.err) == (0, "")
    assert run.out == (
        '{"scan":1,"time_ms":0,"frequency_hz":6.00,"complete":true,"packets":2,'
        '"gaps":0,"dropped":0,"checksum_errors":0,"faults":null,"points":['
        '[0.000000,1000,10,0],[3.500000,1000,10,0],[180.750000,0,0,0],[358.000000,3000,30,2]]}\n'
        '{"scan":2,"time_ms":1,"frequency_hz":6.00,"complete":false,"packets":1,'
        '"gaps":0,"dropped":0,"checksum_errors":0,"faults":null,"points":['
        '[0.000000,1000,10,0]]}\n')


def test_json_reports_the_health_bits_when_the_unit_does(tmini):
    assert '"faults":0,' in tmini("decode", ROOM, "--json").out


def test_a_dash_is_standard_output_for_the_counters(tmini, folder):
    (folder / "one.bin").write_bytes(ONE_SCAN)
    assert '\n{"packets":3,"start_packets":2,' in tmini("decode", "one.bin", "--stats", "-").out


# A turn's packets, and a turn: the start packet (6 Hz), and four quarters of 40 points each.
QUARTERS = [START, *(packet([(0, quarter, 0), *39 * [(0, 0, 0)]], (quarter - 1) * 5760 + 144, quarter * 5760 % 23040)
                     for quarter in (1, 2, 3, 4))]
TURN = b"".join(QUARTERS)
S, Q = QUARTERS[:2]


def played(*told):
    """A timed recording of turns (TURN) and of packets by their numbers, one every 42 ms; "+MS": more time passes."""
    chunks, after_us = [], 0
    for one in told:
        if isinstance(one, str):
            after_us += int(one) * 1000 - 42000
            continue
        for content in QUARTERS if one == TURN else [QUARTERS[one]]:
            chunks.append((after_us + 42000, content))
            after_us = 0
    return timed(*chunks)


# What is recorded; the scans: number, whether it is complete, points, packets; and what the summary says of the rest.
STREAMS = {
    "what precedes the first packet is no damage": (
        bytes(300) + Q, [], [" 0 stray bytes between packets\n", " 300 bytes before the first packet"]),
    "one byte before a start packet is LastCRC": (
        TURN + bytes(1) + TURN, [(1, True, 161, 5), (2, False, 161, 5)], [" 0 stray bytes", " 1 LastCRC bytes,"]),
    "two bytes before a start packet are damage": (
        TURN + bytes(2) + TURN, [(1, False, 161, 5), (2, False, 161, 5)], [" 2 stray bytes", " 0 LastCRC bytes,"]),
    "a pause may be longer than a minute": (
        played("+0", TURN, "+66000", TURN), [(1, False, 161, 5), (2, False, 161, 5)], [" in 66.336 s: "]),
    "the time before the first packet is no pause": (
        played("+66000", TURN, "+70", TURN), [(1, True, 161, 5), (2, False, 161, 5)], []),
    "before a whole turn it is unknown what a unit reports": (
        TURN, [(1, False, 161, 5)], ["health      unknown"]),
    "a unit may report nothing in the stream": (
        TURN + S, [(1, True, 161, 5), (2, False, 1, 1)], ["health      not reported"]),
    "after LastCRC a report may follow": (
        TURN + TURN + bytes(1) + S, [(1, True, 161, 5), (2, True, 161, 5), (3, False, 1, 1)],
        [" 1 LastCRC bytes,", "health      unknown"]),
    "points before the first start packet are of no scan": (
        QUARTERS[4] + TURN + S, [(1, True, 161, 5), (2, False, 1, 1)], ["; 40 before the first start packet"]),
    "a start packet and then a pause is no scan": (
        played(TURN, 0, "+1001", TURN, TURN), [(1, True, 161, 5), (3, True, 161, 5), (4, False, 161, 5)], []),
    "a start packet is not joined with what comes after a pause": (played(0, "+1001", 1), [(1, False, 40, 1)], []),
    "a scan goes on after a second": (played(0, 1, "+1000", 2), [(1, False, 81, 3)], []),
    # The angles fit together, but whole turns may be missing in the pause.
    "a scan does not go on after a longer pause": (
        played(0, 1, "+1001", 2), [(1, False, 41, 2), (1, False, 40, 1)], []),
    # The packets before and after them must not be joined; how many are lost is unknown.
    "a scan does not go on after unreadable bytes": (
        bytes(70000).join([S + Q, QUARTERS[2], QUARTERS[3]]), [(1, False, 41, 2), (1, False, 40, 1)], [": 4 packets,"]),
}


@pytest.mark.parametrize("content, scans, said", STREAMS.values(), ids=[name.replace(" ", "_") for name in STREAMS])
def test_a_stream(tmini, folder, content, scans, said):
    (folder / "some").write_bytes(content)
    found = [json.loads(line) for line in tmini("decode", "some", "--json", "-q").out.splitlines()]
    assert [(scan["scan"], scan["complete"], len(scan["points"]), scan["packets"]) for scan in found] == scans
    summary = tmini("decode", "some").out
    assert [words for words in said if words not in summary] == []


# Computed backwards from the packets, the first sample would be before it.
def test_no_scan_begins_before_the_recording(tmini, folder):
    (folder / "some").write_bytes(S + bytes(600) + QUARTERS[1] + QUARTERS[2])
    scans = [json.loads(line) for line in tmini("decode", "some", "--json", "-q").out.splitlines()]
    assert (scans[-1]["packets"], scans[-1]["time_ms"]) == (2, 0)


# Each read of such a pipe returns what one write has written.
@pytest.mark.parametrize("block", [3 ** power for power in range(9)])
@pytest.mark.parametrize("content", [30 * TURN, played(*30 * [TURN])], ids=["raw", "timed"])
def test_blocks_of_any_size_give_the_same(tmini, folder, content, block):
    (folder / "whole").write_bytes(content)
    output, entry = os.pipe2(os.O_DIRECT)
    with os.fdopen(output) as stdin, concurrent.futures.ThreadPoolExecutor() as writer:
        blocks = [content[at:at + block] for at in range(0, len(content), block)]
        writer.submit(lambda: ([os.write(entry, one) for one in blocks], os.close(entry)))
        run = tmini("decode", "-", stdin=stdin)
    assert run.out == tmini("decode", "whole").out
    assert "29 complete" in run.out and ": 150 packets," in run.out


# ---- Summary


@pytest.mark.parametrize("name, lines", [
    ("sim-6hz.bin", [
        "scans       8 complete; the next one has begun\n",  # Nothing is "cut short".
        "points      7133, 6934 of them with a distance; 1037 before the first start",
        "frequency   3.9 Hz to 6.0 Hz\n", " deg, behind right (scan 8)\n",
        "0 wrong checksums, 0 stray bytes between packets\n", "health      healthy\n",
        "made on 2026-03-17, serial 2026031700012345\n"]),
    # The unit reports its health, but no turn is complete.
    ("sim-6hz-damaged.bin", ["health      unknown: no revolution arrived whole\n", " packets damaged ("]),
    ("sim-10hz-plain.bin", ["health      not reported: this unit sends no information within the stream\n"]),
])
def test_without_a_format_a_person_gets_a_summary(tmini, name, lines):
    run = tmini("decode", "recordings/" + name)
    assert run.status == 0
    for line in lines:
        assert line in run.out


# A gap counts as one damaged packet per 130 bytes, rounded, but at least as one. A small share is rounded, but never to
# nothing.
@pytest.mark.parametrize("packets, gap, words", [
    (3, 1, ", 1 stray byte between packets: about 1 packet damaged (25.0 %)\n"),
    (3, 194, ", 194 stray bytes between packets: about 1 packet damaged (25.0 %)\n"),
    (3, 195, ", 195 stray bytes between packets: about 2 packets damaged (40.0 %)\n"),
    (3, 324, ": about 2 packets damaged (40.0 %)\n"), (3, 325, ": about 3 packets damaged (50.0 %)\n"),
    (665, 1, ": about 1 packet damaged (0.2 %)\n"),        # 1 of 666 is 0.1502 %.
    (666, 1, ": about 1 packet damaged (0.1 %)\n"),        # 1 of 667 is 0.1499 %.
    (1999, 1, ": about 1 packet damaged (0.1 %)\n"),       # 1 of 2000 is 0.05 %.
    (2000, 1, ": about 1 packet damaged (under 0.1 %)\n"), (2000, 0, ", 0 stray bytes between packets\n"),
])
def test_the_bytes_of_a_gap_show_how_many_packets_are_damaged(tmini, folder, packets, gap, words):
    one = packet([(1000, 10, 0)], 224, 224)
    (folder / "gap.bin").write_bytes(one + bytes(gap) + (packets - 1) * one)
    assert words in tmini("decode", "gap.bin").out


def test_a_frequency_that_was_not_reported_is_unknown(tmini, folder):
    start = packet([(1000, 10, 0)], 0, 0, ct=1)
    (folder / "one.bin").write_bytes(start + THREE + start)
    run = tmini("decode", "one.bin")
    assert "frequency   unknown\n" in run.out and "0.0 Hz" not in run.out


# ---- Timed recordings


# Three packets, at 0.5, 70.5 and 70.7 seconds, the second one in two chunks.
TIMED = timed((500000, START), (20000, THREE[:5]), (69980000, THREE[5:]), (200000, START), version=1)


def test_a_timed_recording_reports_when_its_packets_came(tmini, folder):
    (folder / "timed.tmini").write_bytes(TIMED)
    run = tmini("decode", "timed.tmini", "--csv")
    assert run.status == 0
    for row in ("1,0,0,0.000000,1000,10,0,500,6.00\n", "1,1,2,358.000000,3000,30,2,70500,6.00\n",
                "2,2,0,0.000000,1000,10,0,70700,6.00\n"):
        assert "\n" + row in run.out
    assert run.err == "packets 3, start packets 2, points 5, checksum errors 0, bytes 45, bytes skipped 0\n"


@pytest.mark.parametrize("version", (1, 2))
def test_a_timed_recording_that_ends_anywhere_is_not_damaged(tmini, folder, version):
    """The program that wrote it was ended."""
    bytes_of = [START, THREE[:5], THREE[5:] + START]
    content = timed(*((10000, part) for part in bytes_of), version=version)
    head = (6, 10)[version - 1]
    for cut in range(len(MAGIC), len(content) + 1):
        (folder / "timed.tmini").write_bytes(content[:cut])
        run = tmini("decode", "timed.tmini", "--csv", "--stats", "stats.json")
        begins = [len(MAGIC) + head * (i + 1) + len(b"".join(bytes_of[:i])) for i in range(3)]
        there = b"".join(part[:max(0, cut - begin)] for part, begin in zip(bytes_of, begins))
        packets, counts = decode(there)
        assert (run.status, "damaged" in run.err) == (0 if packets else 1, False)
        assert json.loads(Path("stats.json").read_text(encoding="ascii")) == counts


# While the next chunk is looked for, the lidar's bytes are passed on, down to the last.
def test_a_recording_may_end_in_a_damaged_place(tmini, folder):
    (folder / "timed.tmini").write_bytes(timed(version=1) + bytes(4) + Q)
    run = tmini("decode", "timed.tmini")
    assert "damaged in 1 place" in run.err
    assert "134 bytes in " in run.out and ": 1 packets," in run.out


# Version 1 cannot detect a changed pause.
@pytest.mark.parametrize("version", (1, 2))
def test_a_damaged_byte_is_noticed_and_costs_a_recording_a_hundredth_at_most(tmini, folder, version):
    sent = subprocess.run([TMINI_SIM, "--write", "-", "--seconds", "10"], capture_output=True, check=True).stdout
    draw, chunks = random.Random(version), []
    while sent:
        size = draw.randint(40, 90)
        chunks.append((size * 76, sent[:size]))  # The lidar sends a byte every 76 us.
        sent = sent[size:]
    content = timed(*chunks, version=version)

    def decoded(content):
        Path("some").write_bytes(content)
        run = subprocess.run([TMINI, "decode", "some", "--stats", "stats"], capture_output=True, text=True, check=True)
        seconds = float(re.search(r" bytes in ([\d.]+) s:", run.stdout)[1])
        return json.loads(Path("stats").read_text(encoding="ascii"))["packets"], seconds, "damaged in" in run.stderr

    packets, seconds, is_damaged = decoded(content)
    assert packets > 900 and not is_damaged
    for at in range(150, len(content), 1531):
        other = bytes([content[at] ^ 0x55])
        for damage in (b"", other, other + content[at:at + 1]):  # A byte is lost, changed, added.
            left, lasting, is_noticed = decoded(content[:at] + damage + content[at + 1:])
            assert packets * 99 <= left * 100 <= packets * 100, (at, damage)
            if version == 2:
                assert abs(lasting - seconds) <= 0.02 and (is_noticed or at + 600 > len(content)), (at, damage)


# ---- Nothing to decode, nowhere to print


def test_what_cannot_be_read_or_written_is_named(fails, tmini, folder):
    (folder / "empty").touch()
    fails(1, "nowhere.bin: No such file", "decode", "nowhere.bin")
    fails(1, "nowhere.bin: No such file", "plot", "nowhere.bin", "-o", "x.svg")
    fails(1, "is empty", "decode", "empty")
    fails(1, "Is a directory", "decode", "recordings")
    fails(1, "no lidar packet", "plot", "recordings/README.md", "-o", "x.svg")
    for reason, *words in (("no lidar packet", "recordings/README.md"),
                           ("cannot write /nowhere/stats", ROOM, "--stats", "/nowhere/stats")):
        run = tmini("decode", *words, "--csv")
        assert run.status == 1 and run.out.startswith(HEADER) and reason in run.err


# `head` closes the pipe early. A program that ignores SIGPIPE ends as one that it has ended, for the shell.
@pytest.mark.parametrize("is_ignored", [False, True])
def test_a_closed_pipe_ends_the_program_at_once_and_silently(folder, is_ignored):
    (folder / "big.bin").write_bytes(2500 * Path(ROOM).read_bytes()[:26000])
    tool = subprocess.Popen([TMINI, "decode", "big.bin", "--csv"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            restore_signals=not is_ignored)
    assert tool.stdout.readline().decode() == HEADER
    tool.stdout.close()
    assert tool.stderr.read() == b""
    assert tool.wait(60) == -signal.SIGPIPE
    (folder / "big.bin").unlink()


def test_closed_output_is_a_failure_and_not_another_file(folder):
    run = subprocess.run(["/bin/sh", "-c", f"'{TMINI}' decode {ROOM} >&-"], stderr=subprocess.PIPE, check=False)
    assert (run.returncode, run.stderr) == (1, b"tmini: cannot write to standard output\n")


# The recording is larger than the memory that the tool may have.
@pytest.mark.skipif(b"__asan_init" in Path(TMINI).read_bytes(), reason="a sanitizer reserves more than it uses")
def test_a_long_recording_is_decoded_in_constant_memory(folder):
    content = Path(ROOM).read_bytes()
    with open("big.bin", "wb") as file:
        for _ in range(100000000 // len(content) + 1):
            file.write(content)
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (60000000, 60000000))
    with open("big.bin", "rb") as file:
        run = subprocess.run([TMINI, "decode", "-"], stdin=file, stdout=subprocess.PIPE, preexec_fn=limit, check=True)
    Path("big.bin").unlink()
    assert b" 812060 packets," in run.stdout


# ---- Words and options


@pytest.mark.parametrize("words, reason", [
    (["decode"], "decode what?"), (["decode", "--speed"], "speed"), (["decode", "--speed"], "See tmini decode --help"),
    (["--speed"], "See tmini COMMAND --help"), (["decode", "-qx"], "x"), (["decode", "--stats"], "stats"),
    (["decode", "--csv=1"], "csv"), (["decode", "--s"], "s"), (["decode", "--port", "x"], "no option --port"),
    (["decode", "a", "b"], 'unexpected "b"'), (["decode", "a", "b", "c"], 'unexpected "b"'),
    (["decode", "a", "--csv", "--json"], "not both"),
    (["decode", "a", "--max-samples", "0"], '"0" is not a number from 1 to 255'),
    (["decode", "a", "--max-samples=256"], '"256" is not a number'), (["scna"], "did you mean tmini scan?"),
    (["scan", "--cuont"], "did you mean --count?"), (["help", "walk"], 'no command "walk"'),
    (["fly"], 'there is no command "fly"'), (["fly"], "`tmini help` lists them all"),
    (["record", "x"], "-p /dev/ttyUSB0"),
    *(([command], "-p /dev/ttyUSB0") for command in ("info", "health", "frequency", "reboot", "scan", "view")),
    (["record", "-p", "x"], "record into which file?"), (["view", "-p", "x", "file"], "view what?"),
    *((["frequency", typed, "-p", "/dev/none"], "6 to 12 Hz") for typed in ("5.9", "12.1", "7.55", "nan", "7Hz")),
    (["scan", "--mask", "a:1"], '"a:1" is not FROM:TO'), (["scan", "--mask", "1:"], '"1:" is not FROM:TO'),
    (["scan", "--front", "361"], '"361" is not'), (["decode", "--mask", "1:2"], "decode has no option --mask"),
    (["plot", ROOM, "-o", "picture.jpg"], "must end in .svg, .png or .pdf"),
    (["plot", ROOM], "plot what, and into which picture"),
    (["plot", ROOM, "-o", "x.svg", "--all", "--scan", "1"], "not both"),
])
def test_wrong_usage_ends_with_2_and_says_why(fails, words, reason):
    fails(2, reason, *words)


def test_without_a_word_the_tool_lists_its_commands(tmini):
    run = tmini()
    assert run.status == 2 and "tmini record" in run.err


@pytest.mark.parametrize("words", [
    ["decode", ROOM, "--stats", "stats", "-q"], ["decode", "-q", "--sta", "stats", ROOM],
    ["-q", "--stats", "stats", "decode", ROOM], ["--quiet", "decode", "--stat", "stats", "--", ROOM],
])
def test_options_may_be_short_joined_abbreviated_and_anywhere(tmini, environment, monkeypatch, words):
    monkeypatch.setenv("POSIXLY_CORRECT", "1")  # Makes getopt() stop at the first operand.
    assert tmini(*words).status == 0
    assert Path("stats").read_text(encoding="ascii").startswith('{"packets":190,')


def test_two_dashes_end_the_options(fails):
    fails(1, "cannot open -q", "decode", "--", "-q")


@pytest.mark.parametrize("words, beginning", [
    (["--version"], "tmini 1."), (["-V"], "tmini 1."), (["scan", "-V"], "tmini 1."), (["check", "--vers"], "tmini 1."),
    (["version"], "tmini 1."), (["help", "scan"], "tmini scan "),
])
def test_version_and_help_work_with_and_without_a_command(tmini, words, beginning):
    run = tmini(*words)
    assert run.status == 0 and run.out.startswith(beginning)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(tmini, command):
    own = tmini(command, "--help")
    assert own.status == 0 and own.out.startswith(f"tmini {command} ") and "--help" in own.out
    for words in (["--help"], ["help"]):
        run = tmini(*words)
        assert run.status == 0 and f"tmini {command} " in run.out


# ---------------------------------------------------------------------------------------------------- other forms

def xxd(data):
    return "".join(f"{at:08x}: {data[at:at + 16].hex(' ', 2):39}  {'.' * len(data[at:at + 16])}\n"
                   for at in range(0, len(data), 16))


def hexdump_c(data):
    return "".join(f"{at:08x}  {data[at:at + 8].hex(' ')}  {data[at + 8:at + 16].hex(' '):23}  |{'U|' * 8}|\n"
                   for at in range(0, len(data), 16)) + f"{len(data):08x}\n"


def hexdump_words(data):
    words = [f"{data[i + 1]:02x}{data[i]:02x}" for i in range(0, len(data), 2)]
    return "".join(f"{2 * i:07x} {' '.join(words[i:i + 8])}\n" for i in range(0, len(words), 8)) + f"{len(data):07x}\n"


def od(data):
    return "".join(f"{at:07o} {data[at:at + 16].hex(' ')}\n" for at in range(0, len(data), 16)) + f"{len(data):07o}\n"


@pytest.mark.parametrize("form", (xxd, hexdump_c, hexdump_words, od, bytes.hex, lambda data: data.hex(" ").upper(),
                                  lambda data: ", ".join(f"0x{byte:02X}" for byte in data)),
                         ids=("xxd", "hexdump -C", "hexdump", "od", "plain", "spaced", "C"))
def test_a_hex_dump_is_decoded_as_one(tmini, folder, form):
    data = (folder / "recordings/sim-6hz.bin").read_bytes()
    (folder / "dump.txt").write_text(form(data))
    run = tmini("decode", "dump.txt", "-q")
    assert (run.status, run.out) == (0, tmini("decode", "recordings/sim-6hz.bin", "-q").out)
    assert "dump.txt is a hex dump\n" in tmini("decode", "dump.txt").err


@pytest.mark.parametrize("convert, said", (
    (lambda data: data.decode("latin-1").encode(), "the bytes above 7F have become UTF-8"),
    (lambda data: data.decode("utf-8", "replace").encode(), "the bytes above 7F have become UTF-8"),
    (lambda _: b"nothing of interest\n" * 9, 'it holds no lidar packet, but text: "nothing of interest"'),
    (lambda _: bytes(range(256)) * 9, "it is not a recording of a T-mini Plus")),
                         ids=("latin", "lost", "text", "noise"))
def test_what_is_no_recording_is_named(tmini, folder, convert, said):
    (folder / "file").write_bytes(convert((folder / "recordings/sim-6hz.bin").read_bytes()))
    run = tmini("decode", "file")
    assert run.status == 1 and said in run.err


@pytest.mark.parametrize("options, said", (("--samples 2", "they fit two-byte samples: another YDLIDAR"),
                                           ("--samples 4", "they fit four-byte samples: perhaps a T-mini Plus SH"),
                                           ("--bridge telnet", "each byte FF comes twice")))
def test_a_stream_of_another_kind_is_named(tmini, start, options, said):
    start("--write", "file", "--seconds", "10", *options.split(), program=TMINI_SIM).finish()
    assert said in tmini("decode", "file").err


@pytest.mark.parametrize("eaten, more, is_named", ((3, b"", True), (2, b"", False), (3, b"\x11\x13", False),
                                                   (3, b"\x11", False), (3, b"\x13", False)))
def test_packets_that_lack_11_or_13_are_named_if_nothing_else_has_them(tmini, eaten, more, is_named):
    packets = [content for content in decode(Path(ROOM).read_bytes())[0] if not {0x11, 0x13} & set(content[2:4])]
    counts = [sum(content.count(byte) for byte in (0x11, 0x13)) for content in packets]
    plain = [content for content, count in zip(packets, counts) if count == 0]
    lacking = [content.translate(None, b"\x11\x13") for content, count in zip(packets, counts) if count == 1]
    Path("some").write_bytes(b"".join(one + plain[0] for one in [*plain[:20], *lacking[:eaten], more]))
    assert ("the bytes 11 and 13 are missing" in tmini("decode", "some").err) == is_named
