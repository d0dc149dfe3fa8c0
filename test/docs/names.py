# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that what documents name exists: the files and headings of links, the paths in prose and in headers, the
functions. docs/interface.md names all public ones: those of the headers outside parts/. Web addresses are not checked.
"""

import re

from documents import ROOT, documents, links, name, report, wrong_link

PATH = re.compile(r"(?<![\w/.-])((?:docs|examples|lib|port|test)/[\w./-]*\w)")

# Recordings of real units, which each user has to make.
NOT_OURS = ("test/recordings/real",)

# A placeholder for a name, such as PLATFORM or X.
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]+(?=/|\.|$)")

# Only for use inside the library: these access several bytes at once.
NOT_PUBLIC = {"tmini_word", "tmini_copy_pair", "tmini_store_two"}


def wrong_path(path, named):
    """What is wrong with a path in prose, code or a comment, relative to the project's folder or to the file's."""
    if PLACEHOLDER.search(named.removesuffix("/README.md")) or named.startswith(NOT_OURS):
        return None
    return None if any((folder / named).exists() or list(folder.glob(named + ".*"))
                       for folder in (ROOT, path.parent)) else "no such file"


def links_and_paths():
    """Each with the check for it."""
    for path in [*documents(), *documents("zh-CN.")]:
        for number, target in links(path):
            yield path, number, target, wrong_link
    for path in [*documents(), *ROOT.glob("lib/include/tmini/**/*.h"), *ROOT.glob("port/*/*.[ch]")]:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            for named in PATH.findall(re.sub(r"\]\([^)]*\)", "]", line)):
                yield path, number, named, wrong_path


def declared():
    """The public functions: their declarations begin in the first column."""
    for header in ROOT.glob("lib/include/tmini/*.h"):
        text = re.sub(r"/\*.*?\*/|^typedef[^;]*;", "", header.read_text(encoding="utf-8"), flags=re.S | re.M)
        text = re.sub(r"^#.*(\\\n.*)*", "", text, flags=re.M)
        yield from re.findall(r"^(?:TMINI_\w+\s+)?[a-z][\w *]*?\b(tmini_\w+)\(", text, flags=re.M)


def functions_in(document):
    return set(re.findall(r"`(\w+)\(\)`", (ROOT / document).read_text(encoding="utf-8")))


found, public = list(links_and_paths()), set(declared()) - NOT_PUBLIC
listed = {function for function in functions_in("docs/interface.md") if function.startswith("tmini_")}
sources = "".join(path.read_text(encoding="utf-8") for path in ROOT.glob("lib/**/*.[ch]"))
report([f"{name(path)}:{number}: {wrong}: {what}" for path, number, what, check in found
        if (wrong := check(path, what))]
       + [f"docs/interface.md does not name {function}()" for function in sorted(public - listed)]
       + [f"docs/interface.md: no public function {function}()" for function in sorted(listed - public)]
       + [f"docs/design.md: no function {function}()" for function in functions_in("docs/design.md")
          if f"{function}(" not in sources],
       len(found) if len(public) > 40 else 0, 100, "links and paths")
