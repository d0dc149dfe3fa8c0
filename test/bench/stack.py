# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Worst-case stack: the compiler's frame sizes summed along the deepest path of calls.

Frames and calls come from the compiler (-fcallgraph-info=su,da), calls that it adds itself (memcpy,
division) and their frames from the disassembly. The port's functions are the user's and not
included. A caller whose last act is a call has given its frame back by then, which is not taken
into account: the bound is never too low.
"""

import functools
import re

from targets import ROOT, BenchError, run

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \((\w+)\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]+)")?')
RELOCATED_CALL = re.compile(r"R_(?:ARM_THM_(?:CALL|JUMP24)|RISCV_CALL(?:_PLT)?)\s+(\w+)")
DIRECT_CALL = re.compile(r"\t(?:bl|blx|b|b\.n|b\.w|jal|j)\s+(?:ra,)?[0-9a-f]+ <(\w+)>")
FUNCTION = re.compile(r"^[0-9a-f]+ <([^>]+)>:$")

# What the interrupt calls; everything else is called where the user polls.
INTERRUPT = ("tmini_ring_put", "tmini_ring_write", "tmini_ring_publish")


def is_port_call(place):
    """True if the source at file:line:column calls one of the port's functions."""
    name, line, _ = place.rsplit(":", 2)
    path = ROOT / name.removeprefix("./")
    lines = path.read_text().splitlines()
    return "port->" in lines[int(line) - 1]


def read_graph(objects):
    """Frames and calls of the library: {function: bytes}, {function: {functions}}."""
    frames, calls = {}, {}
    for item in objects:
        text = item.with_suffix(".ci").read_text()
        for name, size, kind in NODE.findall(text):
            if kind != "static":
                raise BenchError(f"{name} has a stack frame that is not of constant size")
            frames[name] = int(size)
        for caller, callee, place in EDGE.findall(text):
            if callee != "__indirect_call":
                calls.setdefault(caller, set()).add(callee)
            elif not is_port_call(place):
                raise BenchError(f"{place}: a call through a pointer that is not the port's")
    return frames, calls


def add_hidden_calls(target, objects, frames, calls):
    """Calls that only the disassembly shows, of functions outside the library. Returns them."""
    support = set()
    names = {name.rsplit(":", 1)[-1]: name for name in frames}
    for item in objects:
        caller = None
        for line in run(target.tool("objdump"), "-dr", item).splitlines():
            start = FUNCTION.match(line)
            if start:
                caller = names.get(start[1])
            call = RELOCATED_CALL.search(line)
            if call and caller and call[1] not in names:
                calls.setdefault(caller, set()).add(call[1])
                support.add(call[1])
    return support


def adjusts_stack_by(line):
    """Bytes of stack that an instruction takes."""
    saved = re.search(r"\t(?:push|stmdb\s+sp!,|stmfd\s+sp!,)\s*\{(.*)\}", line)
    if saved:
        count = 0
        for part in saved[1].split(","):
            ends = re.fullmatch(r"\s*r(\d+)-r(\d+)\s*", part)
            count += int(ends[2]) - int(ends[1]) + 1 if ends else 1
        return 4 * count
    down = re.search(r"\tsub(?:\.w|w)?\s+sp,(?: sp,)? ?#(\d+)", line)
    if down:
        return int(down[1])
    down = re.search(r"\t(?:c\.)?addi(?:16sp)?\s+sp,(?:sp,)?-(\d+)", line)
    return int(down[1]) if down else 0


def add_support(target, program, support, frames, calls):
    """Frames of the C library's functions, and what they call in turn."""
    bodies = {}
    for line in run(target.tool("objdump"), "-d", program).splitlines():
        start = FUNCTION.match(line)
        if start:
            body = bodies.setdefault(start[1], [])
        elif line.startswith(" "):
            body.append(line)
    queue = sorted(support)
    while queue:
        name = queue.pop()
        if name in frames:
            continue
        if name not in bodies:
            frames[name] = 0  # Not in this program, so not called in it.
            continue
        text = "\n".join(bodies[name])
        frames[name] = sum(adjusts_stack_by(line) for line in bodies[name])
        called = set(DIRECT_CALL.findall(text))
        calls[name] = called - {name}
        queue.extend(calls[name])


def measure(target, objects, program):
    """The deepest stack of the interrupt and of polling, with the path that leads there."""
    frames, calls = read_graph(objects)
    support = add_hidden_calls(target, objects, frames, calls)
    add_support(target, program, support, frames, calls)

    @functools.cache
    def deepest(name):
        below = max((deepest(callee) for callee in sorted(calls.get(name, ()))),
                    default=(0, ()))
        return frames[name] + below[0], (name.rsplit(":", 1)[-1], *below[1])

    public = sorted(name for name in frames if name.startswith("tmini_"))
    try:
        depths = {name: deepest(name) for name in public}
    except RecursionError as error:
        raise BenchError("the library calls itself: its stack has no bound") from error
    return {"interrupt": max(depths[name] for name in INTERRUPT),
            "polling": max(depths[name] for name in public if name not in INTERRUPT)}
