#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the viewer costs: frames, time and memory while the simulated lidar scans at 12 Hz.

    measure.py PAGE [SECONDS [WIDTH HEIGHT]]

Prints, besides the browser's processor time as the system counts it, what the page itself used of it.
Headless Chromium draws without a graphics card, so a desktop does better.
"""

import os
import pathlib
import sys
import time

import webdriver

# Counts what the page paints and how long that takes, and how evenly the browser gives it frames.
COUNTER = """{
    const seen = window.seen = { frames: 0, paints: 0, longest: 0, paintMs: 0, last: null, from: null };
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (paint) => request((time) => {
        const begun = performance.now();
        paint(time);
        seen.paints++;
        seen.paintMs += performance.now() - begun;
    });
    const watch = (time) => {
        seen.frames++;
        seen.longest = Math.max(seen.longest, seen.last === null ? 0 : time - seen.last);
        seen.last = time;
        request(watch);
    };
    request(watch);
}"""


def family(process_id):
    """The process and all that it has started."""
    children = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue  # It has ended meanwhile.
        children.setdefault(int(fields[1]), []).append(int(path.parent.name))
    found, wanted = [], [process_id]
    while wanted:
        found.append(wanted.pop())
        wanted += children.get(found[-1], [])
    return found


def processor_seconds(process_id):
    """Processor time that the browser's processes have used so far."""
    ticks = 0
    for member in family(process_id):
        try:
            fields = pathlib.Path(f"/proc/{member}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def megabytes(process_id):
    """Memory of the browser's processes, what they share counted once."""
    total = 0
    for member in family(process_id):
        try:
            lines = pathlib.Path(f"/proc/{member}/smaps_rollup").read_text().splitlines()
        except OSError:
            continue
        total += sum(int(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return total / 1000


def page_metrics(page):
    return {metric["name"]: metric["value"] for metric in page.devtools("Performance.getMetrics")["metrics"]}


def scan_at_12_hz(page, url):
    page.devtools("Performance.enable")
    page.go(url)
    page.wait_text("#state", "not connected")
    page.click("#simulate")
    page.wait_text("#state", "scanning")
    page.clear("#frequency-wanted")
    page.type("#frequency-wanted", "12")
    page.click("#set-frequency")
    page.wait_text("#frequency", "12.0", 20)


def snapshot(page):
    scans = int(page.text("#scans"))
    seen = page.run("const now = { ...seen }; seen.longest = 0; return now")
    return time.monotonic(), scans, seen, page_metrics(page), processor_seconds(page.process_id)


def report(before, after, memory, heap):
    seconds = after[0] - before[0]
    seen = {key: after[2][key] - before[2][key] for key in ("frames", "paints", "paintMs")}
    page = {key: after[3][key] - before[3][key] for key in ("TaskDuration", "ScriptDuration")}
    print(f"{seconds:.1f} s at 12 Hz: {after[1] - before[1]} revolutions, {seen['paints']} pictures painted")
    print(f"frames: {seen['frames'] / seconds:.1f} per second, the longest {after[2]['longest']:.0f} ms")
    print(f"painting: {seen['paintMs'] / max(seen['paints'], 1):.2f} ms per picture")
    print(f"page's main thread: {100 * page['TaskDuration'] / seconds:.1f} % of one core, "
          f"of that JavaScript and library {100 * page['ScriptDuration'] / seconds:.1f} %")
    print(f"whole browser, drawing without a graphics card: {after[4] - before[4]:.1f} s of processor time, "
          f"{100 * (after[4] - before[4]) / seconds:.1f} % of one core")
    print(f"memory: page's heap {heap / 1e6:.1f} MB, all of the browser's processes {memory:.0f} MB")


def main(path, seconds=60, width=1280, height=800):
    driver = webdriver.Driver()
    try:
        page = webdriver.Page(driver, int(width), int(height))
        page.prepare(COUNTER)
        scan_at_12_hz(page, pathlib.Path(path).resolve().as_uri())
        before = snapshot(page)
        time.sleep(float(seconds))
        after = snapshot(page)
        report(before, after, megabytes(page.process_id), after[3]["JSHeapUsedSize"])
        page.close()
    finally:
        driver.close()


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
