# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the table of docs/ecosystems.md claims: the tests that it names exist.

    ecosystems.py BUILD

BUILD is a configured build folder. Exit status: 0 all is true, 1 not; every mistake is told.
"""

import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
DOCUMENT = os.path.join(ROOT, "docs", "ecosystems.md")

complaints = []


def tests_of(build):
    """Asked from another folder: ctest begins a new log where it is asked, also for a mere list."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "CTestTestfile.cmake"), "w", encoding="utf-8") as file:
            file.write("subdirs([==[%s]==])\n" % os.path.abspath(build))
        listing = subprocess.run(["ctest", "-N"], cwd=folder, text=True, stdout=subprocess.PIPE,
                                 check=True).stdout
    return set(re.findall(r"Test +#\d+: (\S+)", listing))


def check_table(text, tests):
    rows = re.findall(r"^\| \[.*\|$", text, re.MULTILINE)
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    linked = [re.match(r"\| \[[^]]*\]\(#([^)]*)\)", row).group(1) for row in rows]
    anchors = [heading.lower().replace(" ", "-") for heading in headings]
    if linked != anchors:
        complaints.append("the table's links are %s, the sections %s" % (linked, anchors))
    for row in rows:
        named = re.findall(r"`([^`]*)`", row.split("|")[3])
        if not named:
            complaints.append("no test: %s" % row)
        for name in named:
            if name not in tests:
                complaints.append("there is no test %s" % name)


def main():
    with open(DOCUMENT, encoding="utf-8") as file:
        text = file.read()
    check_table(text, tests_of(sys.argv[1]))
    print("\n".join(complaints) or "docs/ecosystems.md is right")
    sys.exit(1 if complaints else 0)


main()
