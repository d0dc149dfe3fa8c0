# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures flash and RAM of small linked programs, each of which uses a part of the library."""

import pathlib

from targets import HERE, LIB_SOURCES, BenchError, contributions, run

# The order of the tables. Each entry has a file name and a title.
CONFIGURATIONS = (
    ("parser", "parser + decoding"),
    ("points", "ring, parser and scan builder"),
    ("streaming", "streaming, no scan buffer"),
    ("driver", "full driver"),
    ("no_ct", "the same without CT information"),
    ("everything", "full driver + blocking helpers + sectors"),
)


def module_of(file):
    """The name of the library's module for an object file, or None."""
    stem = pathlib.Path(file).stem
    return stem if stem in {source.stem for source in LIB_SOURCES} else None


def is_support(file):
    """True for a file in the C library or the compiler's own library, for example memcpy."""
    return file.endswith(")")


def weigh(map_file):
    """The bytes of flash per module, of flash from other libraries, and of writable data."""
    modules = {}
    support = 0
    writable = 0
    for section, size, file in contributions(map_file):
        module = module_of(file)
        if module and section in ("data", "bss"):
            writable += size
        elif module:
            modules[module] = modules.get(module, 0) + size
        elif is_support(file) and section in ("text", "rodata"):
            support += size
    if not modules:
        raise BenchError(f"{map_file} names no file of the library")
    return {"modules": modules, "own": sum(modules.values()), "support": support,
            "writable": writable}


def weigh_without_ct(target, level, folder):
    sources = [*LIB_SOURCES, HERE / "flash" / "driver.c"]
    objects = [target.compile(source, level, folder / "no_ct", "-DTMINI_NO_CT") for source in sources]
    _, map_file = target.link(objects, folder / "no_ct.elf")
    return weigh(map_file)


def weigh_program(name, target, level, objects, folder):
    main = target.compile(HERE / "flash" / f"{name}.c", level, folder / "flash")
    _, map_file = target.link([*objects, main], folder / f"{name}.elf")
    return weigh(map_file)


def measure(target, level, objects, folder):
    weights = {"no_ct": weigh_without_ct(target, level, folder)}
    for name in ("parser", "points", "streaming", "driver", "everything"):
        weights[name] = weigh_program(name, target, level, objects, folder)
    return weights


def sizes_of_types(target, folder):
    """The size of each type that a user allocates: {"tmini_t": …}."""
    item = target.compile(HERE / "ram.c", "-Os", folder)
    sizes = {}
    for line in run(target.tool("nm"), "-S", item).splitlines():
        _, size, _, name = line.split()
        sizes[name.removeprefix("ram_")] = int(size, 16)
    return sizes
