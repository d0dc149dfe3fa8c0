# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Formats figures as Markdown tables, and puts them between the markers in documents."""

import re

import load
from flash import PROGRAMS
from targets import LEVELS, TARGETS


def table(head, rows):
    """A Markdown table; all columns but the first are right-aligned."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def one(value):
    """The value with one decimal."""
    return f"{value:.1f}"


def small(figures):
    """(title, figures) of each processor for -Os, the usual level of firmware."""
    return [(f"{target.title} `-Os`", figures["targets"][target.name, "-Os"]) for target in TARGETS]


def versions(figures):
    return table(["tool", "version"], [[name, text] for name, text in figures["versions"]]).replace("---:", "---")


def memory(figures):
    rows = [[title, *(f["flash"][part]["own"] for part, _, _ in PROGRAMS), f["flash"]["everything"]["support"],
             f["counts"]["tmini_t"], f["stack"]["polling"][0], f["counts"]["stack seen"], f["stack"]["interrupt"][0]]
            for title, f in small(figures)]
    return table(["bytes", *(title for _, title, _ in PROGRAMS), "C library", "RAM: `tmini_t`",
                  "stack, polling, at most", "seen", "interrupt, at most"], rows)


def optional(figures):
    rows = []
    m0, m4 = (figures["targets"][name, "-Os"]["optional"] for name in ("cortex-m0", "cortex-m4"))
    for module, (size, costs) in m4.items():
        rows.append([f"`{module}.h`", m0[module][0], size,
                     *("; ".join(one(cost) for cost in f[module][1]) for f in (m0, m4))])
    return table(["`-Os`", "flash, Cortex-M0", "Cortex-M4", "instructions per point, Cortex-M0", "Cortex-M4"], rows)


def instructions(figures):
    feeds = ("bytes", "blocks", "dma", "streaming", "corrupted")
    rows = [[title, f["counts"]["feed worst"], *(one(sum(f["counts"]["costs"][name])) for name in feeds),
             *f["counts"]["idle poll"].values()] for title, f in small(figures)]
    return table(["instructions", "`tmini_feed_byte()`, worst", "per byte, by bytes",
                  "per byte, by blocks", "per byte, by DMA", "per byte, streaming",
                  "per byte, corrupted", "idle `tmini_poll()`", "the same, 1 ms later"], rows)


def per_poll(figures):
    m4 = figures["targets"]["cortex-m4", "-Os"]["counts"]["per poll"]
    m0 = figures["targets"]["cortex-m0", "-Os"]["counts"]["per poll"]
    x86 = figures["host"]["per poll"]
    rows = [[count, *(one(f[count][feed]) for f in (m0, m4, x86) for feed in ("bytes", "blocks"))] for count in m4]
    return table(["bytes per poll", *(f"{title}, by {feed}" for title in
                                      ("Cortex-M0", "Cortex-M4", "x86-64")
                                      for feed in ("bytes", "blocks"))], rows)


def compared(figures):
    """Instructions of the library and the program: on x86-64 with its loop, on Cortex-M4 with its interrupt."""
    host = figures["host"]
    m4 = [figures["targets"]["cortex-m4", level]["counts"] for level in LEVELS]
    rows = [["ring to scan, by blocks", one(host["decode"]), "–", "–"]]
    rows += [[f"full driver, by {feed}", one(host[feed]),
              *(one(sum(f["costs"][feed]) + (f["caller"] if feed == "bytes" else 0)) for f in m4)]
             for feed in ("blocks", "bytes")]
    return table(["instructions per byte", "x86-64 `-O2`", "Cortex-M4 `-Os`", "Cortex-M4 `-O2`"], rows)


def cpu(figures):
    rows = []
    for title, name, megahertz in load.BOARDS:
        f = figures["targets"][name, "-Os"]["counts"]
        rows.append([title, *(one(load.percent(f, megahertz, feed)) + " %" for feed in ("bytes", "dma"))])
    return table(["load, library at `-Os`", "interrupt per byte", "DMA"], rows)


def pauses(_figures):
    def text(ring, dma):
        pause = load.longest_pause_ms(ring, dma)
        return f"{int(pause)} ms" if pause >= 1 else "–"

    rows = [[f"{ring} bytes", text(ring, False), text(ring, True)] for ring in load.RINGS]
    return table(["receive buffer", "interrupt or blocks", "DMA"], rows)


def budgets(figures):
    rows = [[budget.title, f"{budget.limit:g}", f"{budget.shown()}", f"{budget.margin():.0f} %"]
            for budget in figures["budgets"]]
    return table(["budget", "limit", "measured", "to spare"], rows)


def summary(figures):
    m4 = figures["targets"]["cortex-m4", "-Os"]
    m0 = figures["targets"]["cortex-m0", "-Os"]
    rows = [
        ["flash, full driver, bytes", *(f["flash"]["driver"]["own"] for f in (m0, m4))],
        ["RAM per lidar, bytes, excluding your buffers",
         *(f["counts"]["tmini_t"] for f in (m0, m4))],
        ["stack, bytes, at most", *(f["stack"]["polling"][0] for f in (m0, m4))],
        ["instructions in the receive interrupt's call, at most",
         *(f["counts"]["feed worst"] for f in (m0, m4))],
        ["instructions per byte, from byte to point, fed by blocks",
         *(one(sum(f["counts"]["costs"]["blocks"])) for f in (m0, m4))],
        ["load at full data rate, 8 and 168 MHz, an interrupt per byte",
         *(one(load.percent(f["counts"], megahertz, "bytes")) + " %"
           for f, megahertz in ((m0, 8), (m4, 168)))],
    ]
    return table(["`-Os`", "Cortex-M0", "Cortex-M4"], rows)


BLOCKS = {"versions": versions, "budgets": budgets, "memory": memory, "optional": optional,
          "instructions": instructions, "per-poll": per_poll,
          "compared": compared, "load": cpu, "pauses": pauses, "footprint": summary}


def between(name):
    return re.compile(rf"(<!-- {name}:begin[^>]*-->\n)(.*?)(<!-- {name}:end -->)", re.DOTALL)


def block_in(text, name):
    """The text between a block's markers, or None."""
    found = between(name).search(text)
    return found[2].strip("\n") if found else None


def with_titles_of(old, new):
    """The new table with the old one's titles of rows, which are in another language."""
    return "\n".join("|".join(["", before.split("|")[1], *now.split("|")[2:]])
                     for before, now in zip(old.splitlines(), new.splitlines(), strict=True))


def renew(document, names, figures):
    """The document's text with the new figures in its blocks."""
    text = document.read_text()
    for name in names:
        new = BLOCKS[name](figures)
        new = with_titles_of(block_in(text, name), new) if document.suffixes[:-1] else new
        text = between(name).sub(lambda found, new=new: f"{found[1]}\n{new}\n\n{found[3]}", text)
    return text
