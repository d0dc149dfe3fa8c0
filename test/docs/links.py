# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that every link in a document leads to a file of the project, and to a heading in that file, and that
every path named in documents and headers exists.

    links.py

Exit status: 0 no mistake, 1 mistakes, which are printed. Web addresses are not checked.
"""

import re
import sys

from documents import ROOT, anchors, documents, name, parse

LINK = re.compile(r"\[(?:[^][]|\[[^]]*\])*\]\(([^()\s]*)(?:\s+\"[^\"]*\")?\)")
REFERENCE = re.compile(r"^\[[^]]+\]:\s*(\S+)")
TAG = re.compile(r"<[^>]* (?:src|href)=\"([^\"]*)\"")
PATH = re.compile(r"(?<![\w/.-])((?:docs|examples|lib|port|test)/[\w./-]*\w)")

# Recordings of real units, which each user has to make.
NOT_OURS = ("test/recordings/real",)

# A placeholder for a name, such as PLATFORM or X.
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]+(?=/|\.|$)")


def without_code(line):
    return re.sub(r"`[^`]*`", "", line)


def check_link(path, number, target):
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return None
    file, _, anchor = target.partition("#")
    goal = (path.parent / file).resolve() if file else path
    if not goal.exists():
        return f"{name(path)}:{number}: no such file: {target}"
    if ROOT not in goal.parents and goal != ROOT:
        return f"{name(path)}:{number}: leads out of the project: {target}"
    if anchor and (goal.suffix != ".md" or anchor not in anchors(goal)):
        return f"{name(path)}:{number}: no such heading: {target}"
    return None


def links(path):
    for number, line in parse(path)[1]:
        for target in [*LINK.findall(without_code(line)), *REFERENCE.findall(line),
                       *TAG.findall(line)]:
            yield number, target


def named_paths(path):
    """Finds paths relative to the project's folder, in prose, code and comments."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        for named in PATH.findall(re.sub(r"\]\([^)]*\)", "]", line)):
            yield number, named


def check_path(path, number, named):
    if PLACEHOLDER.search(named.removesuffix("/README.md")) or named.startswith(NOT_OURS):
        return None
    for folder in (ROOT, path.parent):
        if (folder / named).exists() or list(folder.glob(named + ".*")):
            return None
    return f"{name(path)}:{number}: no such file: {named}"


def main():
    complaints, count = [], 0
    for path in [*documents(), *documents("zh-CN.")]:
        for number, target in links(path):
            count += 1
            complaints.append(check_link(path, number, target))
    sources = [*documents(), *sorted(ROOT.glob("lib/include/tmini/**/*.h")),
               *sorted(ROOT.glob("port/*/*.[ch]"))]
    for path in sources:
        for number, named in named_paths(path):
            count += 1
            complaints.append(check_path(path, number, named))
    complaints = [complaint for complaint in complaints if complaint]
    if count < 100:
        complaints.append("hardly any links have been found: is this check still one?")
    print("\n".join(complaints) or f"all of {count} links and paths lead somewhere")
    sys.exit(1 if complaints else 0)


main()
