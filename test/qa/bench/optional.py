# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures the optional modules: flash, and instructions per point of a scan of 400."""

import flash
from emulator import Machine
from targets import HERE

POINTS = 400
# Modules of the table, what they need besides, and the functions of optional.c that use them.
MODULES = (
    ("tmini_mount", (), ("bench_mount",)), ("tmini_steps", (), ("bench_steps",)),
    ("tmini_fields", ("tmini_cartesian",), ("bench_fields", "bench_fields_near")),
    ("tmini_isolated", (), ("bench_isolated",)), ("tmini_cartesian", (), ("bench_cartesian",)),
    ("tmini_sectors", (), ("bench_sectors",)), ("tmini_ranges", (), ("bench_ranges",)),
    ("tmini_units", (), ("bench_units",)),
)


def measure(target, level, objects, folder):
    """{module: (flash, instructions per point for each use)}; flash with what the module needs."""
    program = folder / "optional.elf"
    uses = target.compile(HERE / "optional.c", level, folder)
    weights = flash.weigh(target, [*objects, uses], program, ["tmini_field_state"])["modules"]
    machine = Machine(target.name, program)
    machine.call("bench_fill")
    figures = {}
    for module, needs, uses in MODULES:
        costs = [machine.cost(use)[1] / POINTS for use in uses]
        figures[module] = (sum(weights[name] for name in (module, *needs)), costs)
    steps_flash, steps_costs = figures["tmini_steps"]
    figures["tmini_steps"] = steps_flash, [max(0, steps_costs[0] - figures["tmini_mount"][1][0])]
    return figures
