#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""CMakeLists.txt defines the version and the address of the project; every place that repeats them is in the list
below.

    version.py                    prints each place that differs
    version.py --write [VERSION]  corrects them: after an edit of CMakeLists.txt, or with a new
                                  version, such as 1.1.0-dev after 1.0.0 has been released

Exit status: 0 all are equal, 1 some differ, 2 wrong usage.
"""

import datetime
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VERSION = re.compile(r"(\d+)\.(\d+)\.(\d+)(-rc\.\d+)?(-dev)?")
NUMBER_IN_CMAKE = r"^project\(tmini VERSION ([0-9.]+)"
SUFFIX_IN_CMAKE = r'^set\(TMINI_VERSION_SUFFIX "(.*)"\)'
ADDRESS_IN_CMAKE = r'^    HOMEPAGE_URL "(.*)"'


def pep440(version):
    """The version in Python's form: 1.0.0-rc.1 is 1.0.0rc1, 1.1.0-dev is 1.1.0.dev0."""
    return version.replace("-rc.", "rc").replace("-dev", ".dev0")


def number(index):
    return lambda version, address: VERSION.fullmatch(version)[index]


def page(path=""):
    """A page at the project's address."""
    return lambda version, address: address + path


def whole(version, address):
    return version


# (file, pattern whose only group is the repeated text, function that returns the right text)
PLACES = [
    ("CMakeLists.txt", NUMBER_IN_CMAKE, lambda version, address: version.partition("-")[0]),
    ("CMakeLists.txt", SUFFIX_IN_CMAKE, lambda version, address: version.lstrip("0123456789.")),
    ("lib/include/tmini/tmini.h", r"^#define TMINI_VERSION_MAJOR (\d+)", number(1)),
    ("lib/include/tmini/tmini.h", r"^#define TMINI_VERSION_MINOR (\d+)", number(2)),
    ("lib/include/tmini/tmini.h", r"^#define TMINI_VERSION_PATCH (\d+)", number(3)),
    ("lib/include/tmini/tmini.h", r'^#define TMINI_VERSION_TEXT "(.*)"', whole),
    ("library.json", r'"version": "(.*)"', whole),
    ("library.json", r'"homepage": "(.*)"', page()),
    ("library.json", r'"url": "(.*)"', page(".git")),
    ("port/arduino/library.properties", r"^version=(.*)$", whole),
    ("port/arduino/library.properties", r"^url=(.*)$", page()),
    ("idf_component.yml", r'^version: "(.*)"', whole),
    ("idf_component.yml", r"^url: (.*)$", page()),
    ("idf_component.yml", r"^repository: (.*)$", page(".git")),
    ("idf_component.yml", r"^issues: (.*)$", page("/issues")),
    ("port/ros2/package.xml", r"^  <version>(.*)</version>", lambda version, address: version.partition("-")[0]),
    ("port/ros2/package.xml", r'email="(.*)"', lambda version, address: "noreply@" + address.split("/")[2]),
    ("port/ros2/package.xml", r'^  <url type="website">(.*)</url>', page()),
    ("port/python/pyproject.toml", r'^version = "(.*)"', lambda version, address: pep440(version)),
    ("port/python/pyproject.toml", r'^Homepage = "(.*)"', page()),
    ("port/python/pyproject.toml", r'^Issues = "(.*)"', page("/issues")),
    ("examples/web/tmini.html", r"<h1>tmini viewer <small>([^<]+)<", whole),
    ("examples/host/share/tmini.1", r'^\.TH .* "tmini ([^"]+)"', whole),
    ("README.md", r"^Version (\S+) ", whole),
    ("README.zh-CN.md", r"^版本 ([0-9a-z.-]+)", whole),
    ("CONTRIBUTING.md", r"Report bugs at <(\S+)>", page("/issues")),
    ("SECURITY.md", r"<(https:\S+)>", page("/security/advisories/new")),
    ("CHANGELOG.md", r"^## (.*)$", lambda version, address: version),
]


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def find(name, pattern):
    match = re.search(pattern, read(name), re.MULTILINE)
    if not match:
        sys.exit(f"{name}: nothing like {pattern}")
    return match


def version():
    return find("CMakeLists.txt", NUMBER_IN_CMAKE)[1] + find("CMakeLists.txt", SUFFIX_IN_CMAKE)[1]


def address():
    return find("CMakeLists.txt", ADDRESS_IN_CMAKE)[1]


def is_placeholder(url):
    """The top-level domain "example" is reserved for placeholders."""
    return url.split("/")[2].endswith(".example")


def found(name, pattern):
    """The text at that place; in the list of changes without the date that follows a release."""
    text = find(name, pattern)[1]
    return re.sub(r"(?<!-dev) \(\d{4}-\d\d-\d\d\)$", "", text) if name == "CHANGELOG.md" else text


def disagreements():
    for name, pattern, wanted in PLACES:
        should = wanted(version(), address())
        if found(name, pattern) != should:
            yield f"{name}: {found(name, pattern)} should be {should}"


def write_changes(new):
    """Begins a section for a version in development, or writes a release's number and date into the heading of its
    section."""
    text = read("CHANGELOG.md")
    heading = find("CHANGELOG.md", r"^## (.*)$")
    title = new if new.endswith("-dev") else f"{new} ({datetime.date.today()})"
    after = "" if heading[1].endswith("-dev") else "\n\n" + heading[0]
    (ROOT / "CHANGELOG.md").write_text(
        text[:heading.start()] + "## " + title + after + text[heading.end():], encoding="utf-8")


def write(new):
    home = address()
    for name, pattern, wanted in PLACES:
        match = find(name, pattern)
        if found(name, pattern) == wanted(new, home):
            continue
        if name == "CHANGELOG.md":
            write_changes(new)
            continue
        text = match.string[:match.start(1)] + wanted(new, home) + match.string[match.end(1):]
        (ROOT / name).write_text(text, encoding="utf-8")


def main(arguments):
    if arguments[:1] == ["--write"] and len(arguments) <= 2:
        new = arguments[1] if len(arguments) == 2 else version()
        if VERSION.fullmatch(new):
            write(new)
            return 0
    if arguments:
        print(__doc__, file=sys.stderr)
        return 2
    complaints = list(disagreements())
    print("\n".join(complaints) or f"version {version()}, at {address()}, everywhere")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
