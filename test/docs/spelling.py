# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks the spelling: of the documents and of the public headers' comments by hunspell (British English and the
words in words.txt), and of all sources by codespell, which finds common misspellings. Exit status 77: neither is
installed."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from documents import ROOT, documents, name, parse

WORDS = Path(__file__).with_name("words.txt")
SOURCES = ("lib", "port", "examples", "test", "docs", "README.md", "CONTRIBUTING.md", "CHANGELOG.md")
# Names, for example of registers, and words of other languages.
NOT_SLIPS = "hsi,ordner,ore,paeth,pre-empted,te,ue"


def plain(line):
    """A line of a document without code, addresses and tags."""
    line = re.sub(r"`[^`]*`|<[^>]*>|\]\([^)]*\)|https?:\S+", " ", line)
    return re.sub(r"\S*[/\\_=@]\S*|\b0x\w+|[A-Za-z]*\d\w*|['’]s\b|Wi-Fi|(?<!\w)-\w+", " ", line)


def comments(path):
    """The lines of a header's comments, without code and names."""
    text = path.read_text(encoding="utf-8")
    for comment in re.finditer(r"/\*.*?\*/", text, re.DOTALL):
        first = text.count("\n", 0, comment.start()) + 1
        for number, line in enumerate(comment[0].splitlines(), first):
            if not re.match(r" \* {5}", line):
                yield number, plain(re.sub(r"[\w.]+\(\)|\w+_\w+|@\w+", " ", line))


def text_of(path):
    if path.suffix == ".md":
        return [(number, plain(line)) for number, line in parse(path)[1]]
    return list(comments(path))


def known_words():
    lines = WORDS.read_text(encoding="utf-8").splitlines()
    return [word for line in lines if not line.startswith("#") for word in line.split()]


def misspelt(lines):
    with tempfile.NamedTemporaryFile("w", suffix=".txt", encoding="utf-8") as words:
        words.write("\n".join(known_words()) + "\n")
        words.flush()
        result = subprocess.run(["hunspell", "-l", "-i", "utf-8", "-d", "en_GB", "-p", words.name],
                                input="\n".join(lines), text=True, encoding="utf-8",
                                env={**os.environ, "LC_ALL": "C.UTF-8"},
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=True)
    return set(result.stdout.split())


def check_documents():
    paths = [*documents(), *sorted(ROOT.glob("lib/include/tmini/**/*.h")), *sorted(ROOT.glob("port/*/*.h"))]
    lines = {path: text_of(path) for path in paths}
    complaints = []
    for word in sorted(misspelt([line for path in paths for _, line in lines[path]])):
        places = [f"{name(path)}:{number}" for path in paths for number, line in lines[path]
                  if re.search(rf"(?<![\w]){re.escape(word)}(?![\w])", line)]
        complaints.append(f"{word}: {', '.join(places[:5])}")
    used = set(re.findall(r"\w+", " ".join(line for path in paths for _, line in lines[path])))
    return complaints + [f"{word}: in {WORDS.name}, but used nowhere" for word in known_words()
                         if not used.issuperset(re.findall(r"\w+", word))]


def check_sources():
    result = subprocess.run(
        ["codespell", "-L", NOT_SLIPS, "--skip", "*.svg,*.png,*.tmini,*.bin,words.txt,build*", *SOURCES],
        cwd=ROOT, text=True, stdout=subprocess.PIPE, check=False)
    return result.stdout.splitlines()


def main():
    complaints, words = [], shutil.which("hunspell") and subprocess.run(
        ["hunspell", "-l", "-d", "en_GB"], input=b"", capture_output=True, check=False).returncode == 0
    checks = {check_documents: words, check_sources: shutil.which("codespell")}
    for check, is_there in checks.items():
        if is_there:
            complaints += check()
        else:
            print(f"not done, for its tool is not installed: {check.__name__}")
    print("\n".join(complaints) or "no misspelt words")
    sys.exit(1 if complaints else 0 if any(checks.values()) else 77)


main()
