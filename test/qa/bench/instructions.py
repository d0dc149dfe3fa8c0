# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Counts instructions on one processor while the library decodes streams and exchanges commands and replies."""

import re

import flash
import load
import worst
from emulator import Machine
from lidar_bytes import INFORMATION
from targets import HERE, ROOT, BenchError

RX_SIZE = 1024
TICK_MS = 10        # How often is polled: about once per packet.
BYTES_PER_TICK = 131  # At the lidar's mean data rate (section 1).
BYTES_PER_MS = 13
STOP_AGAIN_MS = 500  # The library waits this long between two stops.
BYTES_PER_POLL = (1, 4, 13, 64, 131, 512)
FALSE_HEADERS = bytes([0xAA, 0x55, 0, 80, 1, 1, 1, 1, 1, 1]) * 102
SCAN_REPLY = bytes.fromhex("A5 5A 05 00 00 40 81")
START, STOP, INFO, HEALTH, REBOOT = 0x60, 0x65, 0x90, 0x92, 0x40
REPLIES = {START: SCAN_REPLY, INFO: INFORMATION, HEALTH: bytes.fromhex("A5 5A 03 00 00 00 06 00 00 00")}
STEPS_CHZ = {0x09: 10, 0x0A: -10, 0x0B: 100, 0x0C: -100}


def event_names():
    """The names of the events in tmini.h, in the order of their values."""
    header = (ROOT / "lib/include/tmini/tmini.h").read_text()
    body = re.search(r"typedef enum \{([^}]*)\} tmini_event_t;", header)[1]
    return re.findall(r"^\s+TMINI_EVENT_(\w+)", body, re.MULTILINE)


class FakeLidar:
    """Replies to commands as in section 4, at once, and sends no packet: each session is fed a stream of its own,
    which the simulated lidar's time and rotor would change."""

    def __init__(self):
        self.frequency_chz = 600
        self.answers = True

    def reply_to(self, command):
        if not self.answers or command in (0, STOP, REBOOT):
            return b""
        if command in REPLIES:
            return REPLIES[command]
        self.frequency_chz += STEPS_CHZ.get(command, 0)
        return bytes.fromhex("A5 5A 04 00 00 00 04") + self.frequency_chz.to_bytes(4, "little")

FILTER_BOTH = 12  # TMINI_FILTER_BOTH: each option that costs time is set where the longest poll is searched.


class Session:
    """One lidar after tmini_init(), and the cost of its calls."""

    def __init__(self, target, program, feed="bytes", streaming=False, rx_size=RX_SIZE, filters=0):
        self.machine = Machine(target.name, program)
        self.machine.paint_stack()
        self.at = self.machine.addresses["bench_lidar"]
        self.names = event_names()
        self.lidar = FakeLidar()
        self.now_ms = 0
        self.position = 0
        self.rx_size = rx_size
        self.feed = getattr(self, "_feed_" + feed)
        self.feed_total = self.feed_worst = self.poll_total = 0
        self.worst_poll = {}
        self.machine.call("bench_begin", feed == "dma", streaming, rx_size, filters)

    def _fed(self, cost):
        self.feed_total += cost
        self.feed_worst = max(self.feed_worst, cost)

    def _feed_bytes(self, data):
        nothing = self.machine.cost("interrupt_nothing")[1]
        for byte in data:
            self._fed(self.machine.cost("interrupt_feed_byte", byte)[1] - nothing)

    def _feed_blocks(self, data):
        self.machine.write("bench_block", data)
        self._fed(self.machine.cost("bench_feed", len(data))[1])

    def _feed_dma(self, data):
        """Writes the bytes as DMA does, then makes the one call that reports them."""
        first = data[:self.rx_size - self.position]
        self.machine.write("bench_rx", first, self.position)
        self.machine.write("bench_rx", data[len(first):])
        self.position = (self.position + len(data)) % self.rx_size
        self._fed(self.machine.cost("bench_feed_dma", self.position)[1])

    def poll(self):
        value, cost = self.machine.cost("tmini_poll", self.at)
        name = self.names[value]
        self.worst_poll[name] = max(self.worst_poll.get(name, 0), cost)
        self.poll_total += cost
        if name == "PACKET":
            self.poll_total += self.machine.cost("bench_decode")[1]
        return name

    def receive(self, data, milliseconds):
        """Lets time pass and `data` arrive, without a poll."""
        self.now_ms += milliseconds
        self.machine.write_word("bench_now_ms", self.now_ms)
        if data:
            self.feed(data)

    def tick(self, data=b"", milliseconds=TICK_MS):
        """Lets time pass and `data` arrive; polls until there is no event, and returns the events."""
        self.receive(data, milliseconds)
        events = []
        while not events or events[-1] != "NONE":
            events.append(self.poll())
        return events

    def answer(self):
        """The lidar's reply to the last command."""
        command = self.machine.read(self.machine.addresses["bench_sent"], 1)[0]
        self.machine.write("bench_sent", b"\0")
        return self.lidar.reply_to(command)

    def until(self, wanted, limit_ms=20000):
        """Exchanges commands and replies until the event comes."""
        end_ms = self.now_ms + limit_ms
        while wanted not in self.tick(self.answer()):
            if self.now_ms > end_ms:
                raise BenchError(f"the event {wanted} does not come")

    def command(self, function, *arguments):
        if self.machine.call(function, self.at, *arguments) != 0:
            raise BenchError(f"{function}() is refused")

    def reach_scanning(self):
        """Exchanges commands and replies until the lidar has replied to the start."""
        reply = b""
        while reply != SCAN_REPLY:
            reply = self.answer()
            self.tick(reply)

    def spin_up(self):
        self.command("tmini_start")
        self.reach_scanning()

    def run(self, stream, bytes_per_tick=BYTES_PER_TICK):
        for at in range(0, len(stream), bytes_per_tick):
            self.tick(stream[at:at + bytes_per_tick])

    def counters(self):
        """Returns packets, checksum errors, bytes in packets, in replies, skipped, overrun."""
        address = self.machine.addresses["bench_counters"]
        self.machine.call("tmini_counters", self.at, address)
        data = self.machine.read(address, 24)
        return [int.from_bytes(data[i:i + 4], "little") for i in range(0, 24, 4)]

    def idle_poll(self, milliseconds):
        """The cost of a poll without an event, this long after the poll before."""
        before = self.poll_total
        self.now_ms += milliseconds
        self.machine.write_word("bench_now_ms", self.now_ms)
        if self.poll() != "NONE":
            raise BenchError("there is something to do in a poll that should be idle")
        return self.poll_total - before


def through(target, program, stream, feed, streaming=False, packets=None):
    """A stream's cost per byte as (feeding, polling), and the session."""
    session = Session(target, program, feed, streaming)
    session.spin_up()
    session.feed_total = session.poll_total = session.feed_worst = 0
    session.run(stream)
    if packets is not None and session.counters()[0] != packets:
        raise BenchError(f"{session.counters()[0]} packets arrive instead of {packets}")
    return (session.feed_total / len(stream), session.poll_total / len(stream)), session


def full_ring(target, program):
    """The highest cost of tmini_feed_byte(), also when the buffer is full and bytes are refused."""
    session = Session(target, program)
    session.feed(bytes(2 * RX_SIZE))
    return session.feed_worst


def per_poll(target, program, stream, feed, count):
    """A stream's cost per byte with a poll after every `count` bytes."""
    session = Session(target, program, feed)
    session.spin_up()
    session.run(stream)
    session.feed_total = session.poll_total = 0
    begin_ms = session.now_ms
    for at in range(0, len(stream), count):
        part = stream[at:at + count]
        now_ms = begin_ms + (at + len(part)) // BYTES_PER_MS
        session.tick(part, now_ms - session.now_ms)
    return (session.feed_total + session.poll_total) / len(stream)


def longest_poll(target, program, clean):
    """Searches for the most expensive poll while a scan is in progress; returns its cost and the content of the
    ring."""
    session = Session(target, program, "blocks", rx_size=worst.SIZE, filters=FILTER_BOTH)
    session.spin_up()
    session.run(clean)
    saved = session.machine.save(), session.now_ms

    def cost(mix):
        session.machine.restore(saved[0])
        session.now_ms = saved[1]
        session.tick(bytes(mix[0]))
        session.worst_poll = {}
        session.tick(worst.stream_of(mix), mix[1])
        return max(session.worst_poll.values())

    return worst.search(cost)


def conversation(target, program, clean, faulty):
    """Makes every event occur; returns the deepest stack."""
    session = Session(target, program)
    if "MORE" not in session.tick(FALSE_HEADERS):
        raise BenchError("a full ring of false headers is not too much for one poll")
    for function, event in (("stop", "STOPPED"), ("request_info", "INFO"), ("request_health", "HEALTH"),
                            ("request_frequency", "FREQUENCY"), ("reboot", "REBOOTED")):
        session.command("tmini_" + function)
        session.until(event)
    session.command("tmini_set_frequency", 730)
    session.until("FREQUENCY")
    session.lidar.answers = False
    session.command("tmini_request_info")
    session.until("COMMAND_FAILED")
    session.lidar.answers = True
    session.command("tmini_stop")
    session.until("STOPPED")
    if "UNWANTED_SCANNING" not in session.tick(clean[:BYTES_PER_TICK], STOP_AGAIN_MS):
        raise BenchError("an idle lidar that streams is not noticed")
    session.until("STOPPED")
    session.spin_up()
    session.run(clean)
    session.command("tmini_set_frequency", 800)
    for _ in range(4):
        session.run(clean)
    session.reach_scanning()
    session.run(clean)
    session.run(faulty)
    session.until("LOST")
    session.reach_scanning()
    session.run(clean)
    missing = set(session.names) - set(session.worst_poll) - {"PACKET"}
    if missing:
        raise BenchError(f"events that were not seen: {sorted(missing)}")
    return session.machine.stack_used()


def overrun(target, program, stream, rx_size, dma, pause_ms):
    """The bytes lost if the line never pauses, with one poll every `pause_ms`."""
    session = Session(target, program, "dma" if dma else "blocks", rx_size=rx_size)
    session.spin_up()
    begin, at = session.now_ms, 0
    while at < len(stream):
        end = int((session.now_ms + 1 - begin) * load.LINE_BYTES_PER_MS)
        session.receive(stream[at:end], 1)
        at = end
        if session.now_ms % pause_ms == 0:
            session.tick(milliseconds=0)
    return session.counters()[5]


def check_pauses(target, program, stream):
    """Checks that the longest pauses between polls in the tables lose no byte, and that much longer ones do."""
    for rx_size in load.RINGS:
        for dma in (False, True):
            pause_ms = int(load.longest_pause_ms(rx_size, dma))
            if pause_ms < 1:
                continue
            if overrun(target, program, stream, rx_size, dma, pause_ms) > 0:
                raise BenchError(f"{rx_size} bytes do not last for {pause_ms} ms")
            if overrun(target, program, stream, rx_size, dma, 2 * pause_ms + 20) == 0:
                raise BenchError(f"{rx_size} bytes last longer than they can")


def check_counting(target, program, clean):
    """Counting by blocks must agree with single steps. A Cortex-M3 or M4 skips some instructions in a block (IT):
    they take a cycle, but only counting by blocks includes them."""
    fast = Session(target, program)
    slow = Session(target, program)
    for session in (fast, slow):
        session.spin_up()
        session.feed(clean[:1000])
    _, blocks = fast.machine.cost("tmini_poll", fast.at)
    _, steps = slow.machine.single_steps("tmini_poll", slow.at)
    may_skip = target.name in ("cortex-m3", "cortex-m4")
    if not (steps <= blocks <= 1.2 * steps if may_skip else steps == blocks):
        raise BenchError(f"{target.title}: {blocks} instructions by blocks, {steps} by steps")


def link(target, level, objects, folder):
    extra = target.compile(HERE / "emulated" / "main.c", level, folder / "emulated")
    program = folder / "emulated.elf"
    target.link([*objects, extra], program, [*flash.DRIVER, "bench_counters"])
    return program


def by_blocks(target, level, objects, folder, streams):
    """The cost per byte, fed by blocks."""
    program = link(target, level, objects, folder)
    return sum(through(target, program, streams["clean"], "blocks", False, streams["clean packets"])[0])


def measure(target, level, objects, folder, streams):
    program = link(target, level, objects, folder)
    clean = streams["clean"]
    check_counting(target, program, clean)
    costs = {}
    for name, feed, streaming in (("bytes", "bytes", False), ("blocks", "blocks", False),
                                  ("dma", "dma", False), ("streaming", "blocks", True)):
        costs[name], session = through(target, program, clean, feed, streaming, streams["clean packets"])
        if name == "bytes":
            idle = {ms: session.idle_poll(ms) for ms in (0, 1)}
            feed_worst = max(session.feed_worst, full_ring(target, program))
            caller = session.machine.cost("interrupt_nothing")[1]
    costs["corrupted"], _ = through(target, program, streams["corrupted"], "blocks")
    figures = {"costs": costs, "feed worst": feed_worst, "idle poll": idle, "caller": caller,
               "tmini_t": session.machine.sizes["bench_lidar"],
               "per poll": {count: {feed: per_poll(target, program, streams["turn"], feed, count)
                                    for feed in ("bytes", "blocks")} for count in BYTES_PER_POLL},
               "stack seen": conversation(target, program, streams["turn"], streams["faulty"])}
    if (target.name, level) == ("cortex-m4", "-Os"):
        check_pauses(target, program, clean)
        figures["longest poll"] = longest_poll(target, program, streams["turn"])
    return figures
