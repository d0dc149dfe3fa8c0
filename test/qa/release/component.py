# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Compares the ESP-IDF component that we have packed with what ESP-IDF's own packer makes.

    component.py SOURCES ARCHIVE WORK

SOURCES is the archive of all sources, which is what theirs is made from. Run by the Python that has
the package idf-component-manager. Exit status: 0 the same files, 1 not.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile

PREFIX = "tmini/"


def names_of_ours(archive):
    with zipfile.ZipFile(archive) as file:
        names = [name for name in file.namelist() if not name.endswith("/")]
    assert all(name.startswith(PREFIX) for name in names), names
    return sorted(name[len(PREFIX):] for name in names)


def unpack(archive, folder):
    """Returns the only folder in it."""
    with tarfile.open(archive) as file:
        file.extractall(folder)
    (name,) = os.listdir(folder)
    return os.path.join(folder, name)


def names_of_theirs(sources, work):
    root = unpack(sources, os.path.join(work, "sources"))
    packed = os.path.join(work, "packed")
    subprocess.run([os.path.join(os.path.dirname(sys.executable), "compote"), "component", "pack",
                    "--name", "tmini", "--project-dir", root, "--dest-dir", packed], check=True)
    (archive,) = [name for name in os.listdir(packed) if name.endswith(".tgz")]
    with tarfile.open(os.path.join(packed, archive)) as file:
        return sorted(os.path.normpath(member.name) for member in file if member.isfile())


def main():
    sources, archive, work = sys.argv[1:]
    shutil.rmtree(work, ignore_errors=True)
    ours, theirs = names_of_ours(archive), names_of_theirs(sources, work)
    for name in sorted(set(ours) ^ set(theirs)):
        print(name, "is in", "ours" if name in ours else "theirs", "only")
    sys.exit(0 if ours == theirs else 1)


main()
