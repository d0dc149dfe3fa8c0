# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that ESP-IDF's own packer accepts our packed component, and packs exactly the same files.

    component.py ARCHIVE WORK

Needs a Python with the package idf-component-manager. Exit status: 0 the same files, 1 not.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile

PREFIX = "tmini/"


def unpack(archive, work):
    with zipfile.ZipFile(archive) as file:
        file.extractall(work)
        names = file.namelist()
    assert all(name.startswith(PREFIX) for name in names), names
    return sorted(name[len(PREFIX):] for name in names)


def names_of_theirs(work):
    packed = os.path.join(work, "packed")
    compote, project = os.path.join(os.path.dirname(sys.executable), "compote"), os.path.join(work, PREFIX)
    subprocess.run([compote, "manifest", "lint"], cwd=project, check=True)
    subprocess.run([compote, "component", "pack", "--name", "tmini", "--project-dir", project, "--dest-dir", packed],
                   check=True)
    (archive,) = [name for name in os.listdir(packed) if name.endswith(".tgz")]
    with tarfile.open(os.path.join(packed, archive)) as file:
        return sorted(os.path.normpath(member.name) for member in file if member.isfile())


def main():
    archive, work = sys.argv[1:]
    shutil.rmtree(work, ignore_errors=True)
    ours, theirs = unpack(archive, work), names_of_theirs(work)
    for name in sorted(set(ours) ^ set(theirs)):
        print(name, "is in", "ours" if name in ours else "theirs", "only")
    sys.exit(0 if ours == theirs else 1)


main()
