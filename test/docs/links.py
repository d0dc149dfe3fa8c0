# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that every link in a document leads to a file of the project, and to a heading in that file, and that
every path named in documents and headers exists.

    links.py

Exit status: 0 no mistake, 1 mistakes, which are printed. Web addresses are not checked.
"""

import re
import sys

from documents import ROOT, documents, links, name, wrong_link

PATH = re.compile(r"(?<![\w/.-])((?:docs|examples|lib|port|test)/[\w./-]*\w)")

# Recordings of real units, which each user has to make.
NOT_OURS = ("test/recordings/real",)

# A placeholder for a name, such as PLATFORM or X.
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]+(?=/|\.|$)")


def wrong_path(path, named):
    """What is wrong with a path in prose, code or a comment, relative to the project's folder or to the file's."""
    if PLACEHOLDER.search(named.removesuffix("/README.md")) or named.startswith(NOT_OURS):
        return None
    return None if any((folder / named).exists() or list(folder.glob(named + ".*"))
                       for folder in (ROOT, path.parent)) else "no such file"


def found_in(paths):
    """All links and paths, each with the check for it."""
    for path in [*documents(), *documents("zh-CN.")]:
        for number, target in links(path):
            yield path, number, target, wrong_link
    for path in paths:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            for named in PATH.findall(re.sub(r"\]\([^)]*\)", "]", line)):
                yield path, number, named, wrong_path


def main():
    found = list(found_in([*documents(), *sorted(ROOT.glob("lib/include/tmini/**/*.h")),
                           *sorted(ROOT.glob("port/*/*.[ch]"))]))
    complaints = [f"{name(path)}:{number}: {wrong}: {what}" for path, number, what, check in found
                  if (wrong := check(path, what))]
    if len(found) < 100:
        complaints.append("hardly any links have been found: is this check still one?")
    print("\n".join(complaints) or f"all of {len(found)} links and paths lead somewhere")
    sys.exit(1 if complaints else 0)


main()
