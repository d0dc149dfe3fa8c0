#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Packs the files that users download, with the same bytes on every machine:

    pack.py [--tag vX.Y.Z] [--page FILE] [--sdist FILE] [--allow-placeholder] FOLDER

    tmini-X.Y.Z-source.tar.gz       the project: library, ports, examples, documents, tests
    tmini-X.Y.Z-single.zip          the library as one file, tmini_all.c, and its headers
    tmini-X.Y.Z-arduino.zip         Arduino IDE: Sketch > Include Library > Add .ZIP Library
    tmini-X.Y.Z-esp-idf.zip         a component, to be unpacked in a project's folder components
    tmini-X.Y.Z-platformio.tar.gz   a library for lib_deps
    tmini-X.Y.Z-ros2.tar.gz         a ROS 2 package, to be unpacked in a workspace's folder src
    tmini-X.Y.Z.html                the viewer (--page: the one built from these sources)
    tmini-X.Y.Z.tar.gz              the Python package (--sdist: as the package `build` makes it)
    SHA256SUMS, notes.md

Refused, unless --allow-placeholder: an address that is a placeholder, a version in development, changes
that are not committed, a page that is not the committed one, a tag of another version.
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

from archive import Files
from notes import notes
from single import single
from version import ROOT, address, disagreements, is_placeholder, pep440, version

PAGE = ROOT / "examples/web/tmini.html"
NOT_OURS = ("build", "build-*", ".git", ".pio", "*.egg-info", "managed_components", "__pycache__", "sdkconfig",
            "sdkconfig.old*", "dependencies.lock")


def git(*arguments):
    """Git's answer, also if the clone belongs to another user; None in an unpacked archive, and without Git."""
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        return None
    return subprocess.run(["git", "-c", "safe.directory=*", "-C", ROOT, *arguments],
                          check=True, stdout=subprocess.PIPE, text=True).stdout


def project_files():
    """The names of all files; in an unpacked archive, all except those that builds leave there."""
    listed = git("ls-files", "-z")
    if listed:
        return [name for name in listed.split("\0") if name and (ROOT / name).exists()]
    return [path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*") if path.is_file() and
            not any(fnmatchcase(part, pattern) for part in path.relative_to(ROOT).parts for pattern in NOT_OURS)]


def date():
    """The time of the commit, which the files of the source archive also have."""
    given = os.environ.get("SOURCE_DATE_EPOCH") or git("log", "-1", "--format=%ct")
    return int(given or (ROOT / "CHANGELOG.md").stat().st_mtime)


# ---- What is in each ----

def take(names, rename):
    """Files of the project under the names that `rename` returns; a file without such a name is left out."""
    files = Files()
    for name in names:
        if rename(name):
            path = ROOT / name
            files.add(rename(name), path.read_bytes(), name, bool(path.stat().st_mode & 0o100))
    return files


def matches(name, patterns):
    """Whether a pattern names this file or a folder that contains it; a star matches no slash."""
    return any(re.match(re.escape(pattern).replace(r"\*", "[^/]*") + "(/|$)", name) for pattern in patterns)


def included_by_esp_idf():
    manifest = (ROOT / "idf_component.yml").read_text(encoding="utf-8").split("  include:\n")[1]
    return [line.strip()[2:] for line in manifest.splitlines()]


def exported_by_platformio():
    export = json.loads((ROOT / "library.json").read_text(encoding="utf-8"))["export"]
    return export["include"] + ["library.json"], export.get("exclude", [])


def arduino_name(name):
    """The name of a file in the archive for the Arduino IDE, which needs sources below src/ and sketches below
    examples/."""
    path = PurePosixPath(name)
    if name.startswith("lib/include/"):
        return "tmini/src/" + name[len("lib/include/"):]
    if matches(name, ["lib/src", "port/arduino/*.h", "port/arduino/*.cpp"]):
        return "tmini/src/" + path.name
    if matches(name, ["LICENSE", "port/arduino"]):
        return "tmini/" + path.name
    is_sketch = path.parts[0] == "examples" and path.suffix == ".ino"
    return "tmini/examples/" + "/".join(path.parts[2:]) if is_sketch else None


def ros2_name(name):
    """The name of a file in the archive for ROS 2: the package, with the library and its port beside it."""
    if name.startswith("port/ros2/"):
        return "tmini_ros/" + name[len("port/ros2/"):]
    return "tmini_ros/" + name if matches(name, ["LICENSE", "lib", "port/posix"]) else None


def single_name(name):
    if name.startswith("lib/include/"):
        return name[len("lib/include/"):]
    return name if name in ("LICENSE", "README.md") else None


def of_single(names):
    files = take(names, single_name)
    sources = {Path(name).name: (ROOT / name).read_text(encoding="utf-8")
               for name in names if name.startswith("lib/src/")}
    files.add("tmini_all.c", single(sources, version()).encode())
    return files


def of_sdist(archive):
    """The files of Python's source distribution, to be packed again with our dates."""
    files, top = Files(), f"tmini-{pep440(version())}/"
    with tarfile.open(archive) as sdist:
        for member in sdist:
            if member.isfile():
                name = member.name[len(top):]
                place = name if name.startswith("lib/") or name == "LICENSE" else "port/python/" + name
                files.add(member.name, sdist.extractfile(member).read(), place)
    return files


def archives(names, sdist):
    """Yields (ending, files) of each archive."""
    include, exclude = exported_by_platformio()
    component = included_by_esp_idf()
    top = f"tmini-{version()}/"
    yield "-source.tar.gz", take(names, lambda name: top + name)
    yield "-single.zip", of_single(names)
    yield "-arduino.zip", take(names, arduino_name)
    yield "-esp-idf.zip", take(names, lambda name: matches(name, component) and "tmini/" + name)
    yield "-platformio.tar.gz", take(
        names, lambda name: matches(name, include) and not matches(name, exclude) and name)
    yield "-ros2.tar.gz", take(names, ros2_name)
    if sdist:
        yield "python", of_sdist(sdist)


# ---- The release ----

def refusals(arguments):
    yield from disagreements()
    if is_placeholder(address()):
        yield f"{address()} is a placeholder: put the project's address into CMakeLists.txt, then " \
            ".ci/version.py --write"
    if version().endswith("-dev"):
        yield f"{version()} is a version in development: .ci/version.py --write VERSION"
    if git("status", "--porcelain"):
        yield "there are changes that are not committed"
    if arguments.tag and arguments.tag != "v" + version():
        yield f"the tag {arguments.tag} is not v{version()}"
    if arguments.page and Path(arguments.page).read_bytes() != PAGE.read_bytes():
        yield f"{PAGE} is not what these sources build: copy {arguments.page} there, and commit it"


def empty(folder):
    """Deletes an earlier release; exits if the folder contains other files."""
    folder.mkdir(parents=True, exist_ok=True)
    others = [path.name for path in folder.iterdir()
              if not path.name.startswith("tmini-") and path.name not in ("SHA256SUMS", "notes.md")]
    if others:
        sys.exit(f"{folder} holds other things than a release: {', '.join(others)}")
    for path in folder.iterdir():
        path.unlink()


def pack(arguments):
    folder = Path(arguments.folder)
    empty(folder)
    for ending, files in archives(project_files(), arguments.sdist):
        name = f"tmini-{pep440(version())}.tar.gz" if ending == "python" else f"tmini-{version()}{ending}"
        if ending != "-source.tar.gz":
            files.link_outside(address(), "v" + version())
        write = files.zip if name.endswith(".zip") else files.tar_gz
        write(folder / name, date())
    shutil.copyfile(arguments.page or PAGE, folder / f"tmini-{version()}.html")
    (folder / "notes.md").write_text(notes(), encoding="utf-8")
    sums = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(folder.iterdir())]
    (folder / "SHA256SUMS").write_text("".join(sums), encoding="utf-8")
    print("".join(sums), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder")
    for option in ("--tag", "--page", "--sdist"):
        parser.add_argument(option)
    parser.add_argument("--allow-placeholder", action="store_true")
    arguments = parser.parse_args()
    complaints = [] if arguments.allow_placeholder else list(refusals(arguments))
    if complaints:
        sys.exit("no release:\n" + "\n".join(complaints))
    pack(arguments)


if __name__ == "__main__":
    main()
