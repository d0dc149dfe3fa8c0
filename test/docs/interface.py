# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that docs/interface.md names exactly the public functions: those of the headers outside parts/; and that the
functions which docs/design.md names exist.

    interface.py

Exit status: 0 no difference, 1 differences, which are printed.
"""

import re
import sys

from documents import ROOT

# Only for use inside the library: these access several bytes at once.
NOT_PUBLIC = {"tmini_word", "tmini_copy_pair", "tmini_store_two"}


def declared():
    """The declared functions: their declarations begin in the first column."""
    for header in ROOT.glob("lib/include/tmini/*.h"):
        text = re.sub(r"/\*.*?\*/|^typedef[^;]*;", "", header.read_text(encoding="utf-8"), flags=re.S | re.M)
        text = re.sub(r"^#.*(\\\n.*)*", "", text, flags=re.M)
        yield from re.findall(r"^(?:TMINI_\w+\s+)?[a-z][\w *]*?\b(tmini_\w+)\(", text, flags=re.M)


def main():
    document = (ROOT / "docs/interface.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(tmini_\w+)\(\)`", document))
    wanted = set(declared()) - NOT_PUBLIC
    for name in sorted(wanted - named):
        print(f"docs/interface.md does not name {name}()")
    for name in sorted(named - wanted):
        print(f"there is no public function {name}()")
    sources = "".join(path.read_text(encoding="utf-8") for path in ROOT.glob("lib/**/*.[ch]"))
    design = (ROOT / "docs/design.md").read_text(encoding="utf-8")
    gone = [name for name in re.findall(r"`(\w+)\(\)`", design) if f"{name}(" not in sources]
    for name in gone:
        print(f"docs/design.md names {name}(), which does not exist")
    print(f"{len(wanted)} public functions")
    sys.exit(named != wanted or len(wanted) < 40 or gone != [])


main()
