# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Calculates the worst-case stack: the sum of the frames along the deepest path of calls.

The compiler reports the frames (-fcallgraph-info=su,da). The calls are read from the object code, which also has
the calls that the compiler itself adds (memcpy, division); the frames of these support functions are read from
the disassembly. Before a tail call, which is a branch at the caller's end, the caller has freed its frame. The
port's functions belong to the user and are not included.
"""

import functools
import re

from targets import ROOT, BenchError, run

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \((\w+)\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]+)")?')
FUNCTION = re.compile(r"^[0-9a-f]+ <([^.>][^>]*)>:$")  # Not a local label.
RELOCATED = re.compile(r"(R_ARM_THM_CALL|R_ARM_THM_JUMP24|R_RISCV_CALL(?:_PLT)?)\s+(\S+)")
DIRECT_CALL = re.compile(r"\t(?:bl|blx|b|b\.n|b\.w|jal|j)\s+(?:ra,)?[0-9a-f]+ <(\w+)>")

# Called once, before anything is received: their depth has a budget of its own.
SET_UP = ("tmini_fields_init",)

# Called from the interrupt; everything else is called from the thread that polls.
INTERRUPT = ("tmini_ring_put_at_stop", "tmini_ring_write", "tmini_ring_room", "tmini_ring_publish",
             "tmini_ring_gap")


class Graph:
    """Functions with their frames and calls. Static functions are named file:function."""

    def __init__(self):
        self.frames = {}
        self.calls = {}       # {caller: {callees}}
        self.tail_calls = {}  # The same for tail calls: the caller's frame is freed before.

    def add_call(self, caller, callee, is_tail):
        calls = self.tail_calls if is_tail else self.calls
        calls.setdefault(caller, set()).add(callee)

    def callees(self, caller):
        return self.calls.get(caller, set()) | self.tail_calls.get(caller, set())

    def deepest(self, name):
        """The bytes of stack that a call of the function needs, and the deepest path."""
        @functools.cache
        def depth_of(function):
            frame = self.frames[function]
            paths = [(frame, ())]
            for callee in sorted(self.calls.get(function, ())):
                depth, path = depth_of(callee)
                paths.append((frame + depth, path))
            for callee in sorted(self.tail_calls.get(function, ())):
                paths.append(depth_of(callee))
            depth, path = max(paths, key=lambda found: found[0])
            return depth, (function.rsplit(":", 1)[-1], *path)

        try:
            return depth_of(name)
        except RecursionError as error:
            raise BenchError("the library calls itself: its stack has no bound") from error


def is_port_call(place):
    """True if the source at file:line:column calls a function of the user: the port's, or a step."""
    name, line, _ = place.rsplit(":", 2)
    path = ROOT / name.removeprefix("./")
    code = path.read_text().splitlines()[int(line) - 1]
    return "port->" in code or ".step(" in code


def add_frames(graph, text):
    """Adds the frames of one object file. Returns its functions' names in the graph by their symbols."""
    names = {}
    for name, size, kind in NODE.findall(text):
        if kind != "static":
            raise BenchError(f"{name} has a stack frame that is not of constant size")
        graph.frames[name] = int(size)
        names[name.rsplit(":", 1)[-1]] = name
    return names


def is_tail(relocation, instruction):
    return relocation == "R_ARM_THM_JUMP24" or "auipc\tt1" in instruction


def add_calls(graph, names, disassembly):
    """Adds the calls in one object file. Returns the symbols of other objects that it calls."""
    foreign = set()
    caller = instruction = None
    for line in disassembly.splitlines():
        start = FUNCTION.match(line)
        call = RELOCATED.search(line)
        if start:
            caller = names.get(start[1])
        elif call and caller:
            callee = names.get(call[2], call[2])
            graph.add_call(caller, callee, is_tail(call[1], instruction))
            if call[2] not in names:
                foreign.add(call[2])
        else:
            instruction = line
    return foreign


def check_calls(graph, text):
    """Checks that the object code shows every call in the compiler's list, and that only the port and the step are
    called through a pointer: other depths would be unknown."""
    for caller, callee, place in EDGE.findall(text):
        if callee == "__indirect_call":
            if not is_port_call(place):
                raise BenchError(f"{place}: a call through a pointer that is not the port's")
        elif callee in graph.frames and callee not in graph.callees(caller):
            raise BenchError(f"{caller} calls {callee}, which the object code does not show")


def stack_taken(line):
    saved = re.search(r"\t(?:push|stmdb\s+sp!,|stmfd\s+sp!,)\s*\{(.*)\}", line)
    if saved:
        count = 0
        for part in saved[1].split(","):
            ends = re.fullmatch(r"\s*r(\d+)-r(\d+)\s*", part)
            count += int(ends[2]) - int(ends[1]) + 1 if ends else 1
        return 4 * count
    down = re.search(r"\tsub(?:\.w|w)?\s+sp,(?: sp,)? ?#(\d+)", line) or \
        re.search(r"\t(?:c\.)?addi(?:16sp)?\s+sp,(?:sp,)?-(\d+)", line)
    return int(down[1]) if down else 0


def add_support(graph, names, disassembly):
    """Adds the C library's functions: their frames and their own calls."""
    bodies = {}
    for line in disassembly.splitlines():
        start = FUNCTION.match(line)
        if start:
            body = bodies.setdefault(start[1], [])
        elif line.startswith(" "):
            body.append(line)
    queue = sorted(names)
    while queue:
        name = queue.pop()
        if name in graph.frames:
            continue
        body = bodies.get(name, [])  # A function that was not linked is never called.
        graph.frames[name] = sum(stack_taken(line) for line in body)
        for callee in set(DIRECT_CALL.findall("\n".join(body))) - {name}:
            graph.add_call(name, callee, False)
            queue.append(callee)


def measure(target, objects, program):
    """The deepest stack of the interrupt and of polling, each with its path of calls."""
    graph = Graph()
    foreign = set()
    accounts = [item.with_suffix(".ci").read_text() for item in objects]
    for item, text in zip(objects, accounts):
        names = add_frames(graph, text)
        foreign |= add_calls(graph, names, run(target.tool("objdump"), "-dr", item))
    for text in accounts:
        check_calls(graph, text)
    add_support(graph, foreign, run(target.tool("objdump"), "-d", program))
    public = sorted(name for name in graph.frames if name.startswith("tmini_"))
    return {"interrupt": max(graph.deepest(name) for name in INTERRUPT),
            "set-up": max(graph.deepest(name) for name in SET_UP),
            "polling": max(graph.deepest(name) for name in public if name not in INTERRUPT + SET_UP)}
