# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures the flash of programs that use parts of the library.

A program is a list of the functions that it calls, with those that inline functions call. The linker keeps these and
what they need."""

import pathlib

from targets import LIB_SOURCES, ROOT, BenchError, contributions

PARSER = ["tmini_ring_init", "tmini_ring_put_at_stop", "tmini_parser_init", "tmini_parser_next_after",
          "tmini_packet_open", "tmini_packet_points"]
STREAMING = ["tmini_init", "tmini_ring_put_at_stop", "tmini_poll", "tmini_start", "tmini_packet_points"]
WITHOUT_CT = ["tmini_init", "tmini_ring_put_at_stop", "tmini_poll", "tmini_start", "tmini_stop", "tmini_reboot",
              "tmini_request_info", "tmini_request_health", "tmini_request_frequency", "tmini_set_frequency",
              "tmini_state", "tmini_counters"]
DRIVER = [*WITHOUT_CT, "tmini_ct_read"]
EVERYTHING = [*DRIVER, "tmini_blocking_start", "tmini_blocking_stop", "tmini_blocking_read_info",
              "tmini_blocking_read_health", "tmini_blocking_read_frequency", "tmini_blocking_set_frequency",
              "tmini_sectors_init", "tmini_sectors_add_scan", "tmini_sectors_add_packet", "tmini_sectors_at"]
DECODER_ONLY = ROOT / "examples" / "decoder_only" / "lidar_points.c"

# The programs in the order of the tables: name, title, functions.
PROGRAMS = (
    ("parser", "parser + decoding", PARSER),
    ("points", "ring, parser and scan builder", ["lidar_points_init", "lidar_points_next", "lidar_points_byte"]),
    ("streaming", "streaming, no scan buffer", STREAMING), ("driver", "full driver", DRIVER),
    ("no_ct", "the same without CT information", WITHOUT_CT),
    ("everything", "full driver + blocking helpers + sectors", EVERYTHING),
)


def module_of(file):
    """The name of the library's module for an object file, or None."""
    stem = pathlib.Path(file).stem
    return stem if stem in {source.stem for source in LIB_SOURCES} else None


def is_support(file):
    """True for a file in the C library or the compiler's own library, for example memcpy."""
    return file.endswith(")")


def weigh(target, objects, program, functions=()):
    """The bytes of flash per module, of flash from other libraries, and of writable data."""
    modules = {}
    support = 0
    writable = 0
    for section, size, file in contributions(target.link(objects, program, functions)):
        module = module_of(file)
        if module and section in ("data", "bss"):
            writable += size
        elif module:
            modules[module] = modules.get(module, 0) + size
        elif is_support(file) and section in ("text", "rodata"):
            support += size
    if not modules:
        raise BenchError(f"{program} has nothing of the library")
    return {"modules": modules, "own": sum(modules.values()), "support": support, "writable": writable}


def measure(target, level, objects, folder):
    example = target.compile(DECODER_ONLY, level, folder)
    without_ct = [target.compile(source, level, folder / "no_ct", "-DTMINI_NO_CT") for source in LIB_SOURCES]
    return {name: weigh(target, without_ct if name == "no_ct" else [*objects, example], folder / f"{name}.elf",
                        functions) for name, _, functions in PROGRAMS}
