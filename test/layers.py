#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that the library's files call only files below them, also by inline functions, that each of them reads and
writes only the members of tmini_t that it may, and that ports and examples use no member.

    layers.py
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "lib" / "src"
HEADERS = ROOT / "lib" / "include" / "tmini"

# The functions of a file begin with its name. Any file may call tmini_atomic.h and tmini_types.h.
CALLS = {
    "ring": "",
    "frame": "ring",
    "parser": "ring frame",
    "packet": "ring frame",
    "reply": "",
    "ct": "packet",
    "builder": "ring packet frame",
    "decoder": "parser packet ct builder",
    "line": "ring parser",
    "command": "ring parser reply line",
    "recovery": "command",
    "monitor": "packet ct",
    "tmini": "ring parser frame packet ct decoder command recovery monitor line builder",
    "blocking": "tmini command recovery",
    "sectors": "packet frame",
    "ranges": "units",
    "fields": "cartesian",
    "units": "", "cartesian": "", "mount": "", "names": "", "isolated": "", "steps": "",
}

# Members of tmini_t that a file may read; those before the bar it may write as well. Configuration may be read by all.
CONFIGURATION = "link is_recovery_off is_listen_only"
MEMBERS = {
    "line": "line | ring decoder held_to",
    "command": "command info health | line ring decoder",
    "recovery": "recovery | command",
    "blocking": "| recovery command monitor decoder",
    "tmini": "link is_recovery_off is_listen_only command_error idle_ms pending scan scans points_withheld complete_ms "
             "held_to ring decoder monitor info health | command recovery line",
}

EVERYBODY = re.compile(r"tmini_(load|store|fence|memcpy|copy|clockwise|has_elapsed|config|timing|port|filter)\w*$")
IN_TMINI = ("poll", "next", "start", "stop", "set", "request", "reboot", "feed", "state", "scan", "info", "health",
            "frequency", "faults", "counters", "init", "withdraw", "rx")


def code_of(path):
    """The file without comments and preprocessor lines."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.sub(r"^#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.MULTILINE)


def owner_of(function):
    word = function.split("_")[1]
    if function.startswith("tmini_scan_period") or function.startswith("tmini_point_time"):
        return "units"
    if word in CALLS:
        return word
    return "tmini" if word in IN_TMINI else None


def functions(code):
    """Name and body of each function."""
    for match in re.finditer(r"^[A-Za-z][^;{}()]*?\b(\w+)\([^;{}]*\)\s*\{(.*?)^\}", code, re.MULTILINE | re.DOTALL):
        yield match.group(1), match.group(2)


def check_calls(module, name, body):
    allowed = {module, *CALLS[module].split()}
    for called in set(re.findall(r"\b(tmini_\w+)\(", body)):
        owner = None if EVERYBODY.match(called) else owner_of(called)
        if owner is not None and owner not in allowed:
            yield f"{module}: {name}() must not call {called}()"


def check_members(module, name, body):
    if module not in MEMBERS and "lidar->" not in body:
        return
    written, _, read = MEMBERS.get(module, "|").partition("|")
    may_write = set(written.split())
    may_read = may_write | set(read.split()) | set(CONFIGURATION.split())
    for member in set(re.findall(r"\blidar->(\w+)", body)) - may_read:
        yield f"{module}: {name}() must not read lidar->{member}"
    writes = re.findall(r"\blidar->(\w+)(?:(?:\.|\[)[\w.\]\[]+)*\s*(?:[-+|&^]?=(?!=)|\+\+|--)", body)
    writes += re.findall(r"(?<!const )tmini_\w+_t \*const \w+ =\s*&lidar->(\w+)[;.]", body)
    for member in set(writes) - may_write:
        yield f"{module}: {name}() must not write lidar->{member}"


def check_file(path, module=None):
    for other in re.findall(r"\btmini_t \*(?:const )?(?!lidar\b)(\w+)", code_of(path)):
        yield f"{path.name}: a lidar is named lidar, not {other}: else its members would not be found"
    for name, body in functions(code_of(path)):
        where = module or owner_of(name)
        if where is None:
            continue
        yield from check_calls(where, name, body)
        yield from check_members(where, name, body)


def check_users():
    """Ports and examples use no member. A name followed by ( is a method of a class."""
    struct = re.search(r"^struct tmini_lidar \{(.*?)^\};", code_of(HEADERS / "tmini.h"), re.MULTILINE | re.DOTALL)
    members = "|".join(re.findall(r"(\w+);", struct.group(1)))
    access = re.compile(rf"(?:lidar|driver)_?(?:\[[a-z0-9]+\])?(?:\.|->)({members})(?![\w(])")
    for folder in ("port", "examples"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".c", ".h", ".cpp", ".ino"):
                for match in access.finditer(path.read_text(encoding="utf-8")):
                    yield f"{path.relative_to(ROOT)}: {match.group(0)}: members of tmini_t are private"


def main():
    faults = []
    for path in sorted(SOURCES.glob("*.c")):
        module = path.stem if path.stem == "tmini" else path.stem[len("tmini_"):]
        if module not in CALLS:
            faults.append(f"not in the table of layers: {path.name}")
            continue
        faults += check_file(path, module)
    for path in [SOURCES / "tmini_driver.h", *sorted(HEADERS.rglob("*.h"))]:
        faults += check_file(path, "tmini" if path.name == "tmini.h" else None)
    faults += check_users()
    if faults:
        sys.exit("\n".join(faults))
    print("calls go downwards, members are read and written where they may be, and ports and examples use none")


if __name__ == "__main__":
    main()
