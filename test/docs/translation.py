# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that each section of README.zh-CN.md has the same blocks of code, figures, links and names as in
README.md."""

import re
from itertools import zip_longest

from documents import HEADING, ROOT, parse, report

ENGLISH, CHINESE = ROOT / "README.md", ROOT / "README.zh-CN.md"
THE_OTHER = ("README.md", "README.zh-CN.md")


def sections(path):
    """The document's text without blocks of code, split at the headings."""
    texts = [""]
    for _, line in parse(path)[1]:
        if HEADING.match(line):
            texts.append("")
        texts[-1] += line + "\n"
    return texts


def facts(text):
    """What must be equal in all languages, sorted."""
    links = [link for link in re.findall(r"\]\(([^)]*)\)", text) if link not in THE_OTHER]
    code = re.findall(r"`([^`]*)`", text)
    plain = re.sub(r"\]\([^)]*\)|`[^`]*`|<!--.*?-->", " ", text)
    figures = re.findall(r"(?<![A-Za-z\d.])\d+(?:[.,]\d+)*(?![A-Za-z\d])", plain)
    names = re.findall(r"[A-Z][A-Za-z]*\d+[A-Za-z\d]*", plain)
    return {"links": sorted(links), "code": sorted(set(code)), "figures": sorted(figures), "names": sorted(set(names))}


def differences():
    blocks = [[block.language + "\n" + block.text for block in parse(path)[0]] for path in (ENGLISH, CHINESE)]
    for number, (ours, theirs) in enumerate(zip_longest(*blocks), 1):
        if ours != theirs:
            yield f"block of code {number} differs"
    for ours, theirs in zip_longest(sections(ENGLISH), sections(CHINESE), fillvalue=""):
        title = f"{ours.splitlines()[0]} / {theirs.splitlines()[0]}" if ours and theirs else "one more section"
        english, chinese = facts(ours), facts(theirs)
        for kind, values in english.items():
            if values != chinese[kind]:
                yield f"{title}: {kind}: {values} / {chinese[kind]}"


report(list(differences()), len(sections(ENGLISH)), 5, "sections")
