#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the STM32F405 firmware in QEMU against the simulated lidar and checks the firmware's output.

QEMU's first UART is the lidar's line, the second is the firmware's console, and the third requests the next
millisecond (paced/clock.c): lidar, firmware and this script share one clock, however busy the computer is. The
script lets the firmware scan, stops it, and then compares the console's text with what test/host/lidar_bytes.py
finds in the same bytes:

  - device information, health and frequency are those of the simulated device;
  - every valid packet was parsed, and after the first start packet each is in exactly one scan, which holds its points
    unchanged;
  - a scan ends where a revolution ends or where bytes were lost; it is complete if none was lost;
  - every byte is accounted for.

The console has no room for the points, only for their number and checksum: sim_judge.h, which looks for points, cannot
judge them.

Exit status: 0 as expected, 1 not.
"""

import argparse
import collections
import os
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", folder) for folder in (".", "../host")]
from lidar import Lidar  # pylint: disable=wrong-import-position
from lidar_bytes import decode, points  # pylint: disable=wrong-import-position

# The simulated device's data (test/simulator), in the firmware's wording.
INFO = "info model 151 firmware 1.2 hardware 1 serial 2026031700012345"
HEALTH = "health faults 0 code 0"
FREQUENCY = "frequency hz 10.00"

# Most points that the firmware stores per scan. A revolution may have more while the rotor spins up.
MOST_POINTS = 800

# Revolutions lost at a stop (the driver also stops the lidar before each new start): the scan in progress, and one
# more, because the lidar continues to send for about 100 ms.
MOST_CUT_OFF = 2

# The console has 115200 baud and a buffer of this size.
CONSOLE_BYTES_PER_MS = 11
CONSOLE_HOLDS = 2048

# The most time that this computer may need for one millisecond of the firmware.
PATIENCE_S = 120


def values(line):
    """The named numbers of a line: "word a 1 b 2" gives {"a": "1", "b": "2"}."""
    words = line.split()
    return dict(zip(words[1::2], words[2::2]))


def scan_lines(texts):
    return [text for text in texts if text.startswith("scan ")]


def complete_scans(texts):
    return [text for text in scan_lines(texts) if " complete 1 " in text]


def is_scanning(texts):
    """True if the last event was a scan, not a loss."""
    events = [text for text in texts if text.startswith("scan ") or text in ("lost", "recovered")]
    return bool(events) and events[-1].startswith("scan ")


# ------------------------------------------------------------------------------------ running


class Board:
    """The emulated controller with its lidar, and the clock of both."""

    def __init__(self, args, lidar):
        self.lidar = lidar
        self.now_ms = 0
        self.lines = []  # The console's lines, each as (time in ms, text).
        self.rest = b""
        with tempfile.TemporaryDirectory() as folder:  # Its path is short enough for a socket.
            listeners = [self._listen(os.path.join(folder, name)) for name in ("lidar", "clock")]
            # With -icount, emulated time follows the number of executed instructions.
            self.process = subprocess.Popen(
                [args.qemu, "-M", "netduinoplus2", "-icount", "shift=3", "-display", "none",
                 "-monitor", "none", "-serial", f"unix:{folder}/lidar", "-serial", "stdio",
                 "-serial", f"unix:{folder}/clock", "-kernel", args.firmware],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            self.line, self.clock = [listener.accept()[0] for listener in listeners]
        self.clock.settimeout(PATIENCE_S)
        os.set_blocking(self.process.stdout.fileno(), False)

    @staticmethod
    def _listen(path):
        listener = socket.socket(socket.AF_UNIX)
        listener.settimeout(PATIENCE_S)
        listener.bind(path)
        listener.listen()
        return listener

    def _read_console(self):
        *lines, self.rest = (self.rest + (self.process.stdout.read() or b"")).split(b"\n")
        self.lines += [(self.now_ms, line.decode("ascii", "replace").strip()) for line in lines]

    def _read_line(self):
        try:
            return self.line.recv(4096, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return b""

    def step(self):
        if not self.clock.recv(1):
            raise TimeoutError("the emulator has ended")
        self.now_ms += 1
        self._read_console()
        sent = self.lidar.exchange(1000 * self.now_ms, self._read_line())
        self.line.sendall(sent)
        self.clock.sendall(bytes([len(sent)]))

    def wait(self, what, condition, seconds):
        """Runs until condition(texts) is true; fails if that takes more than `seconds`."""
        end_ms = self.now_ms + 1000 * seconds
        known = -1
        while known == len(self.lines) or not condition(self.texts()):
            known = len(self.lines)
            if self.now_ms >= end_ms:
                raise TimeoutError(f"the firmware did not say: {what}")
            self.step()

    def press(self, key):
        self.process.stdin.write(key.encode())
        self.process.stdin.flush()

    def texts(self):
        return [text for _, text in self.lines]

    def end(self):
        self.process.terminate()
        self.process.wait()


def starts(word):
    return lambda texts: any(text.startswith(word) for text in texts)


def operate(board, args):
    """Does what a user would do at the console."""
    board.wait("its greeting", starts("tmini on STM32F405"), 5)
    board.press("d")
    board.wait("started", starts("started"), 20)
    # If bytes are lost often, perhaps no scan is ever complete.
    counted = scan_lines if args.lossy else complete_scans
    board.wait(f"{args.scans} scans", lambda texts: len(counted(texts)) >= args.scans, 60)
    while board.now_ms < 1000 * args.seconds:
        board.step()
    if args.fault:  # Wait until the lidar has been unplugged once: the time of that fault is random.
        board.wait("lost and recovered", starts("recovered"), 600)
    board.wait("that it scans again", is_scanning, 60)
    for _ in range(3):  # The lidar may be unplugged during the stop: try again.
        failures = board.texts().count("failed: timeout")
        board.press("s")
        board.wait("stopped, or failed", lambda texts, known=failures: starts("counters")(texts) or
                   texts.count("failed: timeout") > known, 10)


def run(args):
    os.makedirs(args.work, exist_ok=True)
    log = os.path.join(args.work, "sim.log")
    options = ["--log", log, "--seed", str(args.seed)]
    for fault in args.fault:
        options += ["--fault", fault]
    lidar = Lidar(args.sim, *options)
    board = Board(args, lidar)
    try:
        operate(board, args)
    finally:
        board.end()
        lidar.end()
        with open(os.path.join(args.work, "console.log"), "w", encoding="ascii") as file:
            file.writelines(f"{at / 1000:9.3f} {text}\n" for at, text in board.lines)
        print("\n".join(text for text in board.texts() if not text.startswith("scan ")))
    with open(log, encoding="ascii") as file:
        return board.lines, file.read(), lidar.sent


# ------------------------------------------------------------------------------------ the truth


class Packet:
    """A valid packet, and the number of bytes between it and the one before."""

    def __init__(self, content, gap):
        self.size, self.starts, self.gap = len(content), content[2] & 1, gap
        self.points = b"".join(struct.pack("<HHBB", *point) for point in points(content))


def packets_in(stream):
    end = 0
    for content in decode(stream)[0]:
        at = stream.index(content, end)
        yield Packet(content, at - end)
        end = at + len(content)


Piece = collections.namedtuple("Piece", "end is_whole points crc")


def pieces_from(packets, first):
    """What a scan may be that begins with packets[first]: it ends before the next start packet, or where bytes were
    lost. LastCRC, a byte, may precede a start packet."""
    for end in range(first + 1, len(packets) + 1):
        starts, gap = (packets[end].starts, packets[end].gap) if end < len(packets) else (0, 1)
        if starts or gap:
            kept = b"".join(packet.points for packet in packets[first:end])
            is_whole = packets[first].starts and not any(packet.gap for packet in packets[first + 1:end]) and \
                starts and gap <= 1 and len(kept) <= 6 * MOST_POINTS
            kept = kept[:6 * MOST_POINTS]
            yield Piece(end, bool(is_whole), str(len(kept) // 6), f"{zlib.crc32(kept):08x}")
        if starts:
            return


# ------------------------------------------------------------------------------------- checking


class Findings(list):
    """The problems found."""

    def check(self, right, problem):
        if not right:
            self.append(problem)

    def equal(self, what, is_value, should):
        print(f"{what}: {is_value} (should be {should})")
        self.check(is_value == should, f"{what} is {is_value}, should be {should}")


def scans_in(findings, texts, packets):
    """Finds the packets of each scan on the console. Yields whether it is whole, and whether it is called complete."""
    place, may_skip = 0, 1  # The next scan begins at `place`; unless this is 0, at one of the next start packets.
    for text in texts:
        if text in ("started", "recovered") and place > 0:
            may_skip = 1 + MOST_CUT_OFF  # The scan in progress was discarded.
        if text.startswith("scan "):
            said = values(text)
            starts = [i for i in range(place, len(packets)) if packets[i].starts][:may_skip] if may_skip else [place]
            scan = next((piece for first in starts for piece in pieces_from(packets, first)
                         if piece[2:] == (said["points"], said["crc"])), None)
            if scan:
                place, may_skip = scan.end, 0
                yield scan.is_whole, said["complete"] == "1"
            else:
                may_skip = 1 + MOST_CUT_OFF
                findings.append(f"these are not the points of a revolution, or of a part to a loss: {text}")
    left = sum(packet.starts for packet in packets[place:])
    findings.check(left <= MOST_CUT_OFF, f"the last {left} revolutions became no scans")


def check_scans(findings, args, texts, log, packets, counters):
    judged = collections.Counter(scans_in(findings, texts, packets))
    complete, doubted, false = judged[True, True], judged[True, False], judged[False, True]
    print(f"scans: {len(scan_lines(texts))}, complete: {complete}, doubted: {doubted}")
    findings.check(false == 0, f"{false} scans are said to be complete and are not")
    findings.check(args.lossy or complete >= args.scans, f"only {complete} scans are complete")
    # Where the cable was pulled, bytes are missing between two whole packets.
    findings.check(doubted <= log.count("fault unplug begins"), f"{doubted} complete scans are said to have gaps")
    findings.equal("scans counted", counters["scans"], len(scan_lines(texts)))


def check_console(findings, lines):
    """Checks that the console's buffer never overflows; it holds the text that the UART has not sent yet."""
    waiting = most = before = 0
    for at, text in lines:
        waiting = max(0, waiting - CONSOLE_BYTES_PER_MS * (at - before)) + len(text) + len("\r\n")
        most, before = max(most, waiting), at
    print(f"bytes waiting for the console's UART: up to {most}")
    findings.check(most <= CONSOLE_HOLDS, "the firmware prints more than its console holds")


def check_clean_line(findings, packets, counters):
    """Without faults, the only bytes skipped are the LastCRC before each start packet except the first."""
    findings.equal("bytes skipped", counters["skipped"], sum(packet.starts for packet in packets) - 1)
    findings.equal("checksum errors", counters["checksum_errors"], 0)
    findings.equal("losses", counters["losses"], 0)


def check_recoveries(findings, lines, counters, log):
    lost, recovered = ([at for at, text in lines if text == word] for word in ("lost", "recovered"))
    times = [f"{(after - before) / 1000:.1f}" for before, after in zip(lost, recovered)]
    print(f"seconds from loss to recovery: {' '.join(times)}")
    findings.check("fault unplug begins" in log, "the lidar was never unplugged")
    findings.check(len(lost) > 0, "no loss was noticed")
    findings.equal("recoveries", counters["recoveries"], len(lost))


def check(args, lines, log, sent):
    texts = [text for _, text in lines]
    findings = Findings()
    packets = list(packets_in(sent))
    counters = {name: int(value) for name, value in
                values([text for text in texts if text.startswith("counters ")][-1]).items()}
    for line in (INFO, HEALTH, FREQUENCY, "started", "stopped"):
        findings.check(line in texts, f'the console does not say "{line}"')
    findings.equal("packets parsed", counters["packets"], len(packets))
    findings.equal("bytes in packets", counters["in_packets"], sum(packet.size for packet in packets))
    parts = ("in_packets", "in_replies", "skipped", "overrun", "pending")
    findings.equal("bytes in " + " + ".join(parts), sum(counters[part] for part in parts), counters["bytes"])
    findings.equal("bytes received", counters["bytes"], len(sent))
    findings.equal("bytes overrun", counters["overrun"], 0)
    check_console(findings, lines)
    check_scans(findings, args, texts, log, packets, counters)
    if args.fault:
        check_recoveries(findings, lines, counters, log)
    else:
        check_clean_line(findings, packets, counters)
    findings.check(" 0 forbidden while scanning" in log, "a forbidden command was sent")
    return findings


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sim", required=True, help="tmini-sim")
    parser.add_argument("--qemu", default="qemu-system-arm")
    parser.add_argument("--firmware", required=True)
    parser.add_argument("--work", required=True, help="folder for logs")
    parser.add_argument("--fault", action="append", default=[], help="KIND=RATE, as tmini-sim's")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scans", type=int, default=20,
                        help="at least this many complete ones; with --lossy, of any kind")
    parser.add_argument("--seconds", type=float, default=0, help="at least this long")
    parser.add_argument("--lossy", action="store_true",
                        help="the firmware loses bytes: pass if, and only if, that is found")
    return parser.parse_args()


def main():
    args = parse_arguments()
    try:
        problems = check(args, *run(args))
    except TimeoutError as error:
        problems = [str(error)]
    for problem in problems:
        print(f"PROBLEM: {problem}")
    if args.lossy:
        found = [problem for problem in problems if problem.startswith(("packets", "bytes in in_"))]
        print("The deliberate fault was " + ("found." if len(found) == 2 else "NOT found."))
        return 0 if len(found) == 2 else 1
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
