# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures what the library costs, and checks the budgets.

    bench.py FOLDER [--update | --current]

Writes figures and programs to FOLDER; --update rewrites the documents' tables, --current fails if they have other
figures. Exit status: 0 within the budgets, 1 if one is exceeded or something failed. Usually called by run.sh, which
finds the tools.
"""

import concurrent.futures
import pathlib
import platform
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "host"))  # lidar_bytes

# pylint: disable=wrong-import-position
import flash
import host
import instructions
import optional
import python_package
import stack
import streams
import tables
from targets import HERE, LEVELS, LIB_SOURCES, ROOT, TARGETS, BenchError, other_compilers, run, target_named

FOOTPRINT = ROOT / "docs" / "footprint.md"
READMES = [ROOT / "README.md", ROOT / "README.zh-CN.md"]
README_TABLES = ["footprint"]
FOOTPRINT_TABLES = [name for name in tables.BLOCKS if name not in (*README_TABLES, "budgets")]

# The limits are for the compilers of the committed tables. With others, the library may cost this much more.
OTHER_TOOLS_PERCENT = 10


class Budget:
    """A limit in budgets.txt, and the measured value."""

    def __init__(self, name, limit, title, measured):
        self.name, self.limit, self.title, self.measured = name, limit, title, measured

    def is_exceeded(self, more_percent):
        return self.measured > self.limit * (1 + more_percent / 100)

    def shown(self):
        return f"{self.measured:.1f}".removesuffix(".0")

    def margin(self):
        return 100 * (self.limit - self.measured) / self.limit


def measure_target(name, level, folder, made):
    target = target_named(name)
    place = folder / (name + level)
    objects = target.compile_library(level, place)
    weights = flash.measure(target, level, objects, place)
    depth = stack.measure(target, objects, place)
    counts = instructions.measure(target, level, objects, place, made)
    if counts["stack seen"] > depth["polling"][0]:
        raise BenchError(f"{name} {level}: {counts['stack seen']} bytes of stack are used, "
                         f"more than the bound of {depth['polling'][0]}")
    return {"flash": weights, "stack": depth, "counts": counts,
            "optional": optional.measure(target, level, objects, place)}


def measure_compiler(name, folder, made):
    """The full driver at -Os, by a compiler or with an option that is not in the documents' tables."""
    target = other_compilers()[name]
    place = folder / name
    objects = [target.compile(source, "-Os", place) for source in LIB_SOURCES]
    return {"driver": flash.weigh(target, objects, place / "driver.elf", flash.DRIVER),
            "blocks": instructions.by_blocks(target, "-Os", objects, place, made)}


def library_version(target, header, macro):
    """The C library's version, from its own header."""
    probe = ["-dM", "-E", "-include", header, "-x", "c", "/dev/null"]
    found = re.search(rf"#define {macro} \"(.*)\"", run(target.tool("gcc"), *target.machine, *probe))
    return found[1] if found else "unknown"


def tool_versions():
    """Figures are comparable only with the same compilers and C libraries."""
    arm, riscv = target_named("cortex-m4"), target_named("rv32imc")
    return [("Cortex-M", arm.version()),
            ("newlib", library_version(arm, "newlib.h", "_NEWLIB_VERSION")),
            ("rv32imc", riscv.version()),
            ("picolibc", library_version(riscv, "picolibc.h", "__PICOLIBC_VERSION__")),
            ("Clang", run("clang", "--version").splitlines()[0].strip()),
            (platform.machine(), run("cc", "--version").splitlines()[0].strip())]


def measure_all(folder):
    made = streams.make(folder)
    figures = {"versions": tool_versions(), "targets": {}}
    with concurrent.futures.ProcessPoolExecutor(max_workers=2) as pool:
        jobs = {(target.name, level): pool.submit(measure_target, target.name, level, folder, made)
                for target in TARGETS for level in LEVELS}
        others = {name: pool.submit(measure_compiler, name, folder, made) for name in other_compilers()}
        figures["host"] = host.measure(folder, made["clean"], made["clean packets"], instructions.BYTES_PER_POLL)
        figures["python"] = python_package.measure(folder, made["clean"])
        for key, job in jobs.items():
            figures["targets"][key] = job.result()
        figures["compilers"] = {name: job.result() for name, job in others.items()}
    figures["budgets"] = read_budgets(figures)
    return figures


def measured_for_budgets(figures):
    m0 = figures["targets"]["cortex-m0", "-Os"]
    m4 = [figures["targets"]["cortex-m4", level] for level in LEVELS]
    each = {count: f["bytes"] for count, f in m4[0]["counts"]["per poll"].items()}

    def cost(f, name):
        return sum(f["counts"]["costs"][name])

    return {
        "feed_byte_m4": max(f["counts"]["feed worst"] for f in m4),
        "idle_poll_m4": m4[0]["counts"]["idle poll"][0],
        "tick_poll_m4": m4[0]["counts"]["idle poll"][1],
        "longest_poll_m4": m4[0]["counts"]["longest poll"][0],
        "blocks_m4_os": cost(m4[0], "blocks"),
        "bytes_m4_os": cost(m4[0], "bytes"),
        "bytes_m4_o2": cost(m4[1], "bytes"),
        "each_ms_m4_os": each[13],
        "each_byte_m4_os": each[1],
        "corrupted_m4_os": cost(m4[0], "corrupted"),
        "blocks_m0_os": cost(m0, "blocks"),
        **{f"blocks_{name}": f["blocks"] for name, f in figures["compilers"].items()},
        "decode_x86": figures["host"]["decode"],
        "blocks_x86": figures["host"]["blocks"],
        "bytes_x86": figures["host"]["bytes"],
        "python_hour_x86": figures["python"]["hour"],
        "python_live_x86": figures["python"]["percent"],
        "flash_parser_m4": m4[0]["flash"]["parser"]["own"],
        "flash_points_m4": m4[0]["flash"]["points"]["own"],
        "flash_driver_m4": m4[0]["flash"]["driver"]["own"],
        **{f"flash_{name}": f["driver"]["own"] for name, f in figures["compilers"].items()},
        "flash_no_ct_m4": m4[0]["flash"]["no_ct"]["own"],
        "ram": max(f["counts"]["tmini_t"] + f["flash"]["everything"]["writable"]
                   for f in figures["targets"].values()),
        "stack_m4": max(f["stack"]["polling"][0] for f in m4),
        "stack_set_up_m4": max(f["stack"]["set-up"][0] for f in m4),
    }


def read_budgets(figures):
    measured = measured_for_budgets(figures)
    budgets = []
    for line in (HERE / "budgets.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            name, limit, title = line.split(None, 2)
            budgets.append(Budget(name, float(limit), title, measured.pop(name)))
    if measured:
        raise BenchError(f"budgets.txt has no limit for {sorted(measured)}")
    return budgets


def check_budgets(figures):
    """Prints the budgets that are exceeded; returns True if none is."""
    more = 0 if same_tools(figures) else OTHER_TOOLS_PERCENT
    exceeded = [budget for budget in figures["budgets"] if budget.is_exceeded(more)]
    if platform.machine() != "x86_64":
        print("This computer is not an x86-64: the budgets for x86-64 are not checked.")
        exceeded = [budget for budget in exceeded if not budget.name.endswith("x86")]
    for budget in exceeded:
        print(f"OVER BUDGET: {budget.title}: {budget.shown()}, the limit is {budget.limit:g}" +
              (f" and {more} %" if more else ""))
    return not exceeded


def same_tools(figures):
    """True if the committed tables were made with these tools."""
    committed = tables.block_in(FOOTPRINT.read_text(), "versions")
    return committed == tables.versions(figures)


def outdated_documents(figures):
    """Yields the documents whose tables have other figures, with the text that they should have."""
    for document, names in ((FOOTPRINT, FOOTPRINT_TABLES), *((readme, README_TABLES) for readme in READMES)):
        absent = [name for name in names if tables.block_in(document.read_text(), name) is None]
        if absent:
            raise BenchError(f"{document.name} has no markers for: {', '.join(absent)}")
        text = tables.renew(document, names, figures)
        if text != document.read_text():
            yield document, text


def show(figures):
    """Prints all tables, and some figures that are in no table."""
    for name, render in tables.BLOCKS.items():
        print(f"\n{name}\n\n{render(figures)}")
    print()
    for (name, level), f in figures["targets"].items():
        depth, path = f["stack"]["polling"]
        print(f"{name} {level}: {depth} bytes of stack in {' > '.join(path)}")
    cost, mix = figures["targets"]["cortex-m4", "-Os"]["counts"]["longest poll"]
    print(f"the longest poll found, {cost} instructions: {mix}")


def main(words):
    if len(words) not in (1, 2) or words[1:] not in ([], ["--update"], ["--current"]):
        print(__doc__)
        return 2
    folder = pathlib.Path(words[0])
    folder.mkdir(parents=True, exist_ok=True)
    figures = measure_all(folder)
    show(figures)
    good = check_budgets(figures)
    for document, text in outdated_documents(figures) if words[1:] else ():
        if words[1] == "--update":
            document.write_text(text)
        good = good and words[1] == "--update"
        print(f"{words[1]}: {document.name} had other figures")
    return 0 if good else 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        sys.exit(f"bench: {error}")
