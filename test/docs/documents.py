# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Finds and parses the project's documents, for the checks in this folder. Debian's link checkers read HTML, and know
nothing of the anchors of headings."""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

BLOCK = re.compile(r"^( *)(`{3,}|~{3,}) *([^`\n]*)\n(.*?)(?:^ *\2[`~]* *$|(\Z))", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#+ +(.*?) *#*$")
LINK = re.compile(r"\]\(([^()\s]*)(?:\s+\"[^\"]*\")?\)|^\[[^]]+\]:\s*(\S+)|\b(?:src|href)=\"([^\"]*)\"")


def documents(language=""):
    """The paths of all documents in one language (English by default), except in build folders."""
    not_ours = re.compile(r"(.*/)?(build[^/]*|\.git|\.pio|managed_components)/")
    return [path for path in sorted(ROOT.rglob("*.md"))
            if path.name.partition(".")[2] == language + "md" and not not_ours.match(name(path))]


def name(path):
    return path.relative_to(ROOT).as_posix()


@dataclass
class Block:
    """A block of code, with the number of its first line."""
    path: Path
    section: str
    number: int
    language: str
    text: str

    def __str__(self):
        return f"{name(self.path)}:{self.number}"


def parse(path):
    """A document's blocks of code, and its lines as (number, line), where those of blocks are empty."""
    blocks, text = [], path.read_text(encoding="utf-8")
    prose = list(enumerate(BLOCK.sub(lambda match: "\n" * match[0].count("\n"), text).splitlines(), 1))
    for match in BLOCK.finditer(text):
        before = text.count("\n", 0, match.start(4))
        headings = [heading[1] for _, line in prose[:before] if (heading := HEADING.match(line))]
        language = "unclosed" if match[5] is not None else match[3].strip()
        code = re.sub(f"^ {{0,{len(match[1])}}}", "", match[4], flags=re.MULTILINE)
        blocks.append(Block(path, headings[-1] if headings else "", before + 1, language, code))
    return blocks, prose


def anchors(path):
    """The anchors that links to the document's headings use, and those that it sets itself."""
    found = []
    for _, line in parse(path)[1]:
        if heading := HEADING.match(line):
            text = re.sub(r"\[([^]]*)\]\([^)]*\)|[`*]", r"\1", heading[1]).strip().lower()
            plain = re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", text))
            count = sum(re.fullmatch(re.escape(plain) + r"(-\d+)?", other) is not None for other in found)
            found.append(f"{plain}-{count}" if count else plain)
        found += re.findall(r'<a (?:id|name)="([^"]+)"', line)
    return found


def links(path):
    """The document's links, each as (number of line, target)."""
    for number, line in parse(path)[1]:
        for found in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            yield number, "".join(found)


def wrong_link(path, target, root=ROOT):
    """What is wrong with a link in a document of this folder, or None. Web addresses are not checked."""
    file, _, anchor = target.partition("#")
    goal = (path.parent / file).resolve() if file else path
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return None
    if not goal.exists():
        return "no such file"
    if root not in goal.parents and goal != root:
        return "leads out of the project"
    return "no such heading" if anchor and (goal.suffix != ".md" or anchor not in anchors(goal)) else None


def report(complaints, count, least, what):
    """Ends a check of `count` things: it fails with complaints, or if there were fewer things than it has to find."""
    if count < least:
        complaints.append(f"only {count} {what} have been found: is this check still one?")
    print("\n".join(complaints) or f"{count} {what}: all in order")
    sys.exit(1 if complaints else 0)
