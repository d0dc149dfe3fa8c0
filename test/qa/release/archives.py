# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that every archive can be used alone:

    archives.py FOLDER WORK

Unpacks each archive in FOLDER to WORK. It must contain the licence and every file that its commands name, have no
dead link, and agree with SHA256SUMS. Exit status: 0 no mistake, 1 mistakes, which are printed.
"""

import hashlib
import os
import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))
from documents import ROOT, links, parse, wrong_link  # noqa: E402


def folder_of(archive, work):
    """Unpacks an archive; returns its top folder, if there is only one, or else the folder of all its files."""
    folder = work / archive.name
    shutil.unpack_archive(archive, folder)
    inside = list(folder.iterdir())
    return inside[0] if len(inside) == 1 else folder


def steps(path):
    """The lines that a reader is asked to type, each as (number, line)."""
    blocks, prose = parse(path)
    for block in blocks:
        if block.language in ("sh", "console", "ini", "cmake", "yaml"):
            for number, line in enumerate(block.text.splitlines(), block.number):
                yield number, re.sub(r"\s#.*", "", line)
    for number, line in prose:
        for code in re.findall(r"`([^`]+ [^`]+)`", line):
            yield number, code


def check_steps(folder, path):
    for number, line in steps(path):
        for word in re.findall(r"[\w.][\w./-]*/[\w./-]*\w", line):
            word = word.removeprefix("./")
            if word.startswith("build/"):
                missing = word.startswith("build/bin/") and not (folder / "examples/host").exists()
            else:
                missing = (ROOT / word).exists() and not any(
                    (place / word).exists() for place in (folder, path.parent))
            if missing:
                yield f"{path}:{number}: needs the repository: {word}"


def check(folder):
    if not (folder / "LICENSE").exists():
        yield f"{folder}: no licence"
    for path in sorted(folder.rglob("*.md")):
        for number, target in links(path):
            if wrong := wrong_link(path, target, folder):
                yield f"{path}:{number}: {wrong}: {target}"
        if path.name != "CHANGELOG.md":
            yield from check_steps(folder, path)


def check_sums(folder):
    for line in (folder / "SHA256SUMS").read_text(encoding="utf-8").splitlines():
        wanted, name = line.split("  ")
        if hashlib.sha256((folder / name).read_bytes()).hexdigest() != wanted:
            yield f"{name} is not what SHA256SUMS says"


def main():
    released, work = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    archives = sorted([*released.glob("*.zip"), *released.glob("*.gz")])
    complaints = list(check_sums(released))
    if len(archives) < 5:
        complaints.append(f"only {len(archives)} archives")
    for archive in archives:
        complaints += check(folder_of(archive, work))
    print("\n".join(complaints).replace(f"{work}/", "") or f"{len(archives)} archives stand alone")
    sys.exit(1 if complaints else 0)


main()
