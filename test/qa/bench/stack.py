# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Calculates the worst-case stack: the sum of the frames along the deepest path of calls.

Frames and calls are read from the disassembled program, which also has what the compiler itself adds (memcpy,
division). What the compiler reports (-fcallgraph-info=su,da) must agree, and shows the calls through pointers. Before
a tail call, which is a branch at the caller's end, the caller has freed its frame. The port's functions belong to the
user and are not included.
"""

import functools
import re

from targets import ROOT, BenchError, run

NODE = re.compile(r'node: \{ title: "(?:[^"]+:)?([^":]+)" label: "[^"]*?(\d+) bytes \((\w+)\)')
EDGE = re.compile(r'edge: \{ sourcename: "(?:[^"]+:)?([^":]+)" targetname: "(?:[^"]+:)?([^":]+)"(?: label: "([^"]+)")?')
FUNCTION = re.compile(r"^([0-9a-f]+) <(.+)>:$")
CALL = re.compile(r"\t(bl|jal|b\w*(?:\.[nw])?|j)\s+(?:ra,)?[0-9a-f]+ <([^+>]+)>")
PUSHED = re.compile(r"\t(?:push|stmdb\s+sp!,|stmfd\s+sp!,)\s*\{(.*)\}")
TAKEN = re.compile(r"\t(?:sub(?:\.w|w)?\s+sp,(?: sp,)? ?#|add\s+sp,sp,-)(\d+)")

# Called once, before anything is received: their depth has a budget of its own.
SET_UP = ("tmini_fields_init",)

# Called from the interrupt; everything else is called from the thread that polls.
INTERRUPT = ("tmini_ring_put_at_stop", "tmini_ring_write", "tmini_ring_room", "tmini_ring_publish", "tmini_ring_gap")


class Function:
    def __init__(self):
        self.frame, self.calls, self.tail_calls = 0, set(), set()


def stack_taken(line):
    """The bytes by which an instruction makes the frame larger."""
    if pushed := PUSHED.search(line):
        count = 0
        for part in pushed[1].split(","):
            ends = re.fullmatch(r"\s*r(\d+)-r(\d+)\s*", part)
            count += int(ends[2]) - int(ends[1]) + 1 if ends else 1
        return 4 * count
    taken = TAKEN.search(line)
    return int(taken[1]) if taken else 0


def functions_of(target, program):
    """All functions by name. What comes after a function may be data."""
    symbols = [line.split() for line in run(target.tool("nm"), "-S", program).splitlines()]
    sizes = {words[3]: int(words[1], 16) for words in symbols if len(words) == 4}
    functions = {}
    for line in run(target.tool("objdump"), "-d", program).splitlines():
        if start := FUNCTION.match(line):
            name = start[2]
            if name in functions:
                raise BenchError(f"two functions are named {name}")
            functions[name] = function = Function()
            end = int(start[1], 16) + sizes.get(name, 1 << 32)
        elif functions and line.startswith(" ") and int(line.split(":")[0], 16) < end:
            function.frame += stack_taken(line)
            call = CALL.search(line)
            if call and call[2] != name:
                (function.calls if call[1] in ("bl", "jal") else function.tail_calls).add(call[2])
    return functions


def is_port_call(place):
    """True if the source at file:line:column calls a function of the user: the port's, or a step."""
    name, line, _ = place.rsplit(":", 2)
    path = ROOT / name.removeprefix("./")
    code = path.read_text().splitlines()[int(line) - 1]
    return "port->" in code or ".step(" in code


def check(functions, account):
    """Compares with what the compiler reports of one source. Frames of other than constant size, and calls through
    other pointers than the user's, would make depths unknown."""
    for name, size, kind in NODE.findall(account):
        if kind != "static" or functions[name].frame != int(size):
            raise BenchError(f"{name} has a frame of {size} bytes ({kind}), which the program does not show")
    for caller, callee, place in EDGE.findall(account):
        if callee == "__indirect_call":
            if not is_port_call(place):
                raise BenchError(f"{place}: a call through a pointer that is not the port's")
        elif callee in functions and callee not in functions[caller].calls | functions[caller].tail_calls:
            raise BenchError(f"{caller} calls {callee}, which the program does not show")


def measure(target, objects, folder):
    """The deepest stack of the interrupt, of setting up and of polling, each with its path of calls."""
    accounts = [item.with_suffix(".ci").read_text() for item in objects]
    program = folder / "whole.elf"
    target.link(objects, program, [name for account in accounts for name, _, _ in NODE.findall(account)
                                   if name.startswith("tmini_")])
    functions = functions_of(target, program)
    for account in accounts:
        check(functions, account)

    @functools.cache
    def deepest(name):
        """The bytes of stack that a call of the function needs, and the deepest path."""
        function = functions[name]
        paths = [(function.frame, ())]
        for callee in sorted(function.calls):
            depth, path = deepest(callee)
            paths.append((function.frame + depth, path))
        paths += [deepest(callee) for callee in sorted(function.tail_calls)]
        depth, path = max(paths, key=lambda found: found[0])
        return depth, (name, *path)

    def deepest_of(names):
        return max(deepest(name) for name in names)

    try:
        return {"interrupt": deepest_of(INTERRUPT), "set-up": deepest_of(SET_UP),
                "polling": deepest_of(name for name in functions
                                      if name.startswith("tmini_") and name not in INTERRUPT + SET_UP)}
    except RecursionError as error:
        raise BenchError("the library calls itself: its stack has no bound") from error
