# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks the uses of tmini and tmini-sim in documents: --help must list every command and option."""

import re
import subprocess

from documents import documents, name, parse

USE = re.compile(r"(?<![\w/.-])(?:build(?:-demo)?/bin/)?(tmini-sim|tmini) +([^`|;&#\n]*)")

# In documents, this word stands for any command: `tmini COMMAND --help`.
PLACEHOLDERS = ("COMMAND",)


def help_of(build, *words):
    result = subprocess.run([build / "bin" / words[0], *words[1:], "--help"], text=True,
                            stdout=subprocess.PIPE, check=True)
    return result.stdout


def spans(path):
    """Everything in a document that the user may type: lines of blocks and spans of code."""
    blocks, prose = parse(path)
    for block in blocks:
        if block.language == "sh":
            for number, line in enumerate(block.text.splitlines(), block.number):
                yield number, line.split(" #")[0]
    for number, line in prose:
        yield from ((number, span) for span in re.findall(r"`([^`]+)`", line) if USE.match(span))


def unknown_options(text, words):
    """The options in `words` that the help does not list. Short options may be joined: -n3, -qn1."""
    known = set(re.findall(r"(?<![\w-])(--[a-z][a-z-]*|-[a-zA-Z])\b", text))
    return [word for word in (word.split("=")[0].strip("[]") for word in words)
            if re.match(r"--?[a-zA-Z]", word) and word not in known
            and not (re.match(r"-[a-zA-Z]", word) and word[:2] in known)]


def check_use(helps, program, words):
    command = words[0] if words else ""
    if program != "tmini" or not command or command.startswith("-") or command in PLACEHOLDERS:
        return unknown_options(helps[program] + " --version" * (program == "tmini"), words)
    return unknown_options(helps[command], words[1:]) if command in helps else [command]


def check(build):
    """Returns complaints about commands and options that the programs in `build` do not know."""
    helps = {"tmini": help_of(build, "tmini"), "tmini-sim": help_of(build, "tmini-sim")}
    helps |= {command: help_of(build, "tmini", command)
              for command in re.findall(r"^  tmini (\w+) ", helps["tmini"], re.MULTILINE)}
    complaints, uses = [], 0
    for path in documents():
        for number, span in spans(path):
            for program, rest in USE.findall(span):
                uses += 1
                complaints += [f"{name(path)}:{number}: {program} does not know {word}: {span.strip()}"
                               for word in check_use(helps, program, rest.split())]
    if uses < 30:
        complaints.append(f"only {uses} uses of the tool have been found: is this check still one?")
    return complaints
