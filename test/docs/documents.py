# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Finds and parses the project's documents, for the checks in this folder."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

FENCE = re.compile(r"^( *)(`{3,}|~{3,}) *([^`]*)$")
HEADING = re.compile(r"^#+ +(.*?) *#*$")
LINK = re.compile(r"\]\(([^()\s]*)(?:\s+\"[^\"]*\")?\)|^\[[^]]+\]:\s*(\S+)|\b(?:src|href)=\"([^\"]*)\"")


def documents(language=""):
    """The paths of all documents in one language (English by default), except in build folders."""
    not_ours = re.compile(r"(.*/)?(build[^/]*|\.git|\.pio|managed_components)/")
    return [path for path in sorted(ROOT.rglob("*.md"))
            if path.name.partition(".")[2] == language + "md" and not not_ours.match(name(path))]


def name(path):
    return path.relative_to(ROOT).as_posix()


class Block:
    """A block of code: its language (or ""), its section in the document, the number of its first line,
    and its text."""

    def __init__(self, path, section, number, language, lines):
        self.path, self.section, self.number, self.language = path, section, number, language
        self.text = "\n".join(lines) + "\n"

    def __str__(self):
        return f"{name(self.path)}:{self.number}"


def parse(path):
    """A document's blocks of code, and its other lines as (number, line)."""
    blocks, prose = [], []
    section, opened = "", None
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        fence = FENCE.match(line)
        if opened is None:
            if fence:
                opened, lines, first = fence, [], number + 1
                continue
            heading = HEADING.match(line)
            section = heading[1] if heading else section
            prose.append((number, line))
        elif fence and fence[2].startswith(opened[2]) and not fence[3]:
            blocks.append(Block(path, section, first, opened[3].strip(), lines))
            opened = None
        else:
            indent = len(opened[1])
            lines.append(line[indent:] if not line[:indent].strip() else line)
    if opened is not None:
        blocks.append(Block(path, section, first, "unclosed", lines))
    return blocks, prose


def indented_blocks(prose):
    """The numbers of lines that begin an indented block of code."""
    found, before, in_list = [], "", False
    for number, line in prose:
        if re.match(r" {0,3}([-*+]|\d+\.) ", line):
            in_list = True
        elif line.strip() and not line.startswith(" "):
            in_list = False
        follows = not before.strip() or HEADING.match(before)
        if line.startswith("    ") and line.strip() and follows and not in_list:
            found.append(number)
        before = line
    return found


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
