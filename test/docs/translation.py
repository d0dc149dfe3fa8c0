# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that each section of README.zh-CN.md has the same blocks of code, figures, links and names as in
README.md.

    translation.py             prints the differences
    translation.py --write     copies README.md's blocks of code first

Exit status: 0 no difference, 1 differences.
"""

import re
import sys
from itertools import zip_longest

from documents import HEADING, ROOT, parse

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
    return {"links": sorted(links), "code": sorted(set(code)), "figures": sorted(figures),
            "names": sorted(set(names))}


def write():
    """Replaces the Chinese document's blocks of code by the English ones, in order."""
    blocks = iter(re.findall(r"^```.*?^```$", ENGLISH.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL))
    text = re.sub(r"^```.*?^```$", lambda match: next(blocks), CHINESE.read_text(encoding="utf-8"),
                  flags=re.MULTILINE | re.DOTALL)
    CHINESE.write_text(text, encoding="utf-8")


def differences():
    blocks = [[block.language + "\n" + block.text for block in parse(path)[0]] for path in (ENGLISH, CHINESE)]
    for number, (ours, theirs) in enumerate(zip_longest(*blocks), 1):
        if ours != theirs:
            yield f"block of code {number} differs: translation.py --write"
    for ours, theirs in zip_longest(sections(ENGLISH), sections(CHINESE), fillvalue=""):
        title = f"{ours.splitlines()[0]} / {theirs.splitlines()[0]}" if ours and theirs else "one more section"
        english, chinese = facts(ours), facts(theirs)
        for kind, values in english.items():
            if values != chinese[kind]:
                yield f"{title}: {kind}: {values} / {chinese[kind]}"


def main():
    if sys.argv[1:] == ["--write"]:
        write()
    complaints = list(differences())
    print("\n".join(complaints) or "the Chinese README has the English one's code, figures and links")
    sys.exit(1 if complaints else 0)


main()
