#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Joins the page's files to one: bundle.py PAGE_DIR LIBRARY.wasm VERSION OUT.html

A browser loads no modules from file:, so all modules become one script, each after those that it imports. If two
modules declare the same name, the script has a syntax error. Comments stay behind. The library is included as base64.
"""

import base64
import pathlib
import re
import sys

IMPORT = re.compile(r"^import\s[^;]*?from '\./([\w.]+)';\n", re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async )?(?:class|const|function)\b)", re.MULTILINE)
COMMENT = re.compile(r"^ *// .*\n", re.MULTILINE)
STYLE_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


def modules_in_order(folder, name, seen):
    """The texts of the modules that this module imports, then its own."""
    if name in seen:
        return []
    seen.add(name)
    text = (folder / name).read_text(encoding="utf-8")
    before = [part for other in IMPORT.findall(text) for part in modules_in_order(folder, other, seen)]
    body = EXPORT.sub("", IMPORT.sub("", COMMENT.sub("", text)))
    if re.search(r"^\s*(import|export)\b", body, re.MULTILINE):
        sys.exit(f"{name}: an import or export of a form that this script does not know")
    return before + [f"// {name}\n{body.strip()}\n"]


def main(folder, library, version, out):
    folder = pathlib.Path(folder)
    program = "\n".join(modules_in_order(folder, "main.js", set()))
    if "</script" in program:
        sys.exit("the program contains the end of a script element")
    parts = {
        "@STYLE@": STYLE_COMMENT.sub("", (folder / "style.css").read_text(encoding="utf-8")).strip(),
        "@LIBRARY@": base64.b64encode(pathlib.Path(library).read_bytes()).decode("ascii"),
        "@PROGRAM@": program.strip(),
        "@VERSION@": version,
    }
    page = (folder / "page.html").read_text(encoding="utf-8")
    for place, text in parts.items():
        if page.count(place) != 1:
            sys.exit(f"page.html: {place} must be there once")
        page = page.replace(place, text)
    pathlib.Path(out).write_text(page, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
