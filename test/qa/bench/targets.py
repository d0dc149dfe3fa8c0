# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The measured processors, and the commands that compile and link the library for them."""

import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[3]
HERE = ROOT / "test" / "qa" / "bench"
LIB_SOURCES = sorted((ROOT / "lib" / "src").glob("*.c"))
LEVELS = ("-Os", "-O2")


class BenchError(Exception):
    """An error that the user must correct; its message explains it."""


def run(*command):
    """Runs a command and returns what it printed."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BenchError(f"{' '.join(words)}\nfailed:\n{done.stdout}{done.stderr}")
    return done.stdout


class Target:
    """One processor: its compiler and options."""

    def __init__(self, name, title, prefix, machine, link, compiler=()):
        self.name = name
        self.title = title
        self.prefix = prefix
        self.machine = machine
        self.link_options = link
        self.compiler = compiler or (prefix + "gcc", *machine)

    def tool(self, name):
        return self.prefix + name

    def version(self):
        """The compiler's version line: figures are comparable only with the same compiler."""
        return run(self.tool("gcc"), "--version").splitlines()[0].strip()

    def compile(self, source, level, folder, *extra):
        folder.mkdir(parents=True, exist_ok=True)
        target = folder / (source.stem + ".o")
        # The length of the checkout's path must not change the figures.
        run(*self.compiler, "-std=c99", level, "-Wall", "-Wextra", "-Werror",
            "-ffunction-sections", "-fdata-sections", f"-ffile-prefix-map={ROOT}=.",
            "-I", ROOT / "lib" / "include", *extra, "-c", source, "-o", target)
        return target

    def compile_library(self, level, folder):
        """Compiles all of lib/src, with call graphs and stack sizes in *.ci files beside the objects."""
        return [self.compile(source, level, folder, "-fcallgraph-info=su,da") for source in LIB_SOURCES]

    def link(self, objects, program, functions=()):
        """Links without start-up code. Keeps only these functions, bench_… and interrupt_…, and what they need.
        Returns the map."""
        map_file = program.with_suffix(".map")
        run(self.tool("gcc"), *self.machine, *self.link_options, "-nostartfiles",
            "-Wl,--entry=0", "-Wl,--gc-sections", *(f"-Wl,--undefined={name}" for name in functions),
            "-Xlinker", f"-Map={map_file}", "-T", HERE / "program.ld",
            *objects, "-o", program)
        return map_file


def cortex(name, title):
    return Target(name, title, "arm-none-eabi-", (f"-mcpu={name}", "-mthumb"),
                  ("--specs=nano.specs", "--specs=nosys.specs"))


PICOLIBC = ("-march=rv32imc", "-mabi=ilp32", "--specs=picolibc.specs")

TARGETS = (
    cortex("cortex-m0", "Cortex-M0"),
    cortex("cortex-m3", "Cortex-M3"),
    cortex("cortex-m4", "Cortex-M4"),
    Target("rv32imc", "rv32imc", "riscv64-unknown-elf-", PICOLIBC, ()),
)


def headers(target):
    """The folder of the target's C library, which another compiler does not find by itself."""
    text = run(target.compiler[0], *target.machine, "-E", "-include", "string.h", "-x", "c", "/dev/null")
    return re.search(r'^# 1 "(.*)/string\.h"', text, re.MULTILINE)[1]


def with_clang(target, *machine):
    """The same processor with Clang as the compiler; the other tools stay."""
    compiler = ("clang", *machine, "-isystem", headers(target))
    return Target(target.name, target.title + " Clang", target.prefix, target.machine, target.link_options, compiler)


def freestanding(target):
    return Target(target.name, target.title + " `-ffreestanding`", target.prefix, target.machine,
                  target.link_options, (*target.compiler, "-ffreestanding"))


def other_compilers():
    """What else users compile with, measured briefly."""
    m0, _, m4, riscv = TARGETS
    return {
        "freestanding_m4": freestanding(m4),
        "clang_m0": with_clang(m0, "--target=armv6m-none-eabi", "-mcpu=cortex-m0"),
        "clang_m4": with_clang(m4, "--target=thumbv7em-none-eabi", "-mcpu=cortex-m4"),
        "clang_rv32imc": with_clang(riscv, "--target=riscv32-unknown-elf", "-march=rv32imc", "-mabi=ilp32"),
    }


def target_named(name):
    return next(target for target in TARGETS if target.name == name)


SECTION = re.compile(
    r"^ \.(text|rodata|data|bss)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S.*)$", re.MULTILINE)


def contributions(map_file):
    """The parts of a linked program, each as (section, bytes, object file)."""
    text = map_file.read_text()
    text = text[text.index("Linker script and memory map"):]
    text = re.sub(r"\n( \.\S+)\n\s+", r"\n\1 ", text)  # Join the line of a long name with the next one.
    return [(section, int(size, 16), file) for section, size, file in SECTION.findall(text) if int(size, 16) > 0]
