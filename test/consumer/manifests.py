# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that the manifests of several ecosystems agree: compares their description, licence, author and keywords
(.ci/version.py compares version and address), and checks that each list of sources contains every source of the
library, and that all files exist that a manifest names. Exit status: 0 they agree, 1 differences, which are printed."""

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {path.name for path in ROOT.glob("lib/src/*.c")}
complaints = []


def demand(is_so, text):
    if not is_so:
        complaints.append(text)


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def find(name, pattern):
    """What the pattern's group matches in the file, without quotes; a list of matches, sorted, if it ends with *."""
    if pattern.endswith("*"):
        return sorted(re.findall(pattern[:-1], read(name), re.MULTILINE))
    match = re.search(pattern, read(name), re.MULTILINE)
    return match[1].strip().strip('"') if match else None


PLATFORMIO = json.loads(read("library.json"))

# Where each manifest states each fact.
SAID = {
    "name": {"library.json": PLATFORMIO.get("name"),
             "port/arduino/library.properties": "^name=(.*)$",
             "port/python/pyproject.toml": "^name = (.*)$",
             "zephyr/module.yml": "^name: (.*)$"},
    "description": {"CMakeLists.txt": 'DESCRIPTION\\s+("[^"]*")',
                    "library.json": PLATFORMIO.get("description"),
                    "port/arduino/library.properties": r"^sentence=(.*)\.$",
                    "idf_component.yml": "^description: (.*)$",
                    "port/ros2/package.xml": "<description>(.*)</description>"},
    "licence": {"LICENSE": "^(.*) License$",
                "library.json": PLATFORMIO.get("license"),
                "idf_component.yml": "^license: (.*)$",
                "port/ros2/package.xml": "<license>(.*)</license>",
                "port/python/pyproject.toml": "^license = (.*)$",
                "README.md": r"^(\w+) licence\."},
    "author": {"LICENSE": r"^Copyright \(c\) [0-9-]+ (.*)$",
               "library.json": ", ".join(author["name"] for author in PLATFORMIO.get("authors", [])),
               "port/arduino/library.properties": "^author=(.*)$",
               "port/ros2/package.xml": "<author>(.*)</author>"},
    "keywords": {"library.json": sorted(PLATFORMIO.get("keywords", [])),
                 "idf_component.yml": "^  - (.*)$*"},
}


def check_facts():
    for fact, places in SAID.items():
        said = {name: value if name == "library.json" else find(name, value) for name, value in places.items()}
        for name, value in said.items():
            demand(value, f"{name} says nothing of {fact}")
        if len(set(map(str, said.values()))) > 1:
            complaints.extend([f"{fact} differs:", *(f"    {name}: {value}" for name, value in said.items())])


def code_of(name):
    return re.sub(r"#.*", "", read(name))


def check_sources():
    """A build file that names one of the library's sources names all of them."""
    listed = set(re.findall(r"src/(\w+\.c)", read("lib/CMakeLists.txt")))
    demand(listed == SOURCES, f"lib/CMakeLists.txt does not list what lib/src holds: {listed ^ SOURCES}")
    for path in (path for folder in ("", "cmake/", "examples/**/", "lib/**/", "port/**/", "zephyr/")
                 for ending in ("CMakeLists.txt", "*.cmake", "*.mk") for path in ROOT.glob(folder + ending)):
        name = path.relative_to(ROOT).as_posix()
        named = set(re.findall(r"lib/src/(\w+\.c)", code_of(name)))
        demand(named in (set(), SOURCES), f"{name} names some of lib/src, but not {SOURCES - named}")
    for name in ("esp32/component.cmake", "pico/CMakeLists.txt", "ros2/CMakeLists.txt", "zephyr/CMakeLists.txt"):
        demand("/lib/src/*.c" in code_of(f"port/{name}"), f"port/{name} does not take lib/src/*.c")


INCLUDED = re.findall("^    - (.*)$", read("idf_component.yml").partition("\n  include:\n")[2], re.MULTILINE)
SKETCHES = [f"{example['base']}/{file}" for example in PLATFORMIO["examples"] for file in example["files"]]

# What a manifest names, at least this many, and where that must be: {} is the name.
NAMED = [
    ("library.json", PLATFORMIO["headers"], 1, ("lib/include/{}", "port/*/{}")),
    ("library.json", PLATFORMIO["export"]["include"], 1, ("{}",)),
    ("library.json", SKETCHES, 1, ("{}",)),
    ("examples/esp32_arduino/platformio.ini", 'SKETCH="(.*?)"*', 1, ("examples/esp32_arduino/platformio/{}",)),
    ("port/arduino/library.properties", (find("port/arduino/library.properties", "^includes=(.*)$") or "?").split(","),
     1, ("port/arduino/{}",)),
    ("idf_component.yml", INCLUDED, 1, ("{}",)),
    ("zephyr/module.yml", "^ +(?:cmake:|kconfig:|dts_root:|-) (.*)$*", 4, ("{}",)),
]

# What lists must contain.
LISTED = [
    ("library.json", PLATFORMIO["build"]["srcFilter"], ["+<lib/src/*.c>"]),
    ("library.json", SKETCHES, [path.relative_to(ROOT).as_posix()
                                for path in ROOT.glob("examples/esp32_arduino/*/*.ino")]),
    ("idf_component.yml", INCLUDED, ["lib/src/*.c", "lib/src/*.h", "lib/include/tmini/*.h",
                                     "lib/include/tmini/parts/*.h"]),
]


def check_files():
    for manifest, names, least, places in NAMED:
        names = find(manifest, names) if isinstance(names, str) else names
        demand(len(names) >= least, f"{manifest} names only {names}")
        for name in names:
            demand(any(any(ROOT.glob(place.format(name))) for place in places), f"{manifest}: no such file: {name}")
    for manifest, names, needed in LISTED:
        for name in needed:
            demand(name in names, f"{manifest} does not list {name}")
    name = "examples/esp32_idf/main/idf_component.yml"
    where = find(name, r"^dependencies:\n  tmini:\n(?:    .*\n)*    override_path: (.*)$")
    demand(where and (ROOT / name).parent.joinpath(where).resolve() == ROOT, f"{name} does not lead to the component")


def check_keywords():
    """keywords.txt lists each public method, and no name that does not exist."""
    header = read("port/arduino/TMiniLidar.h")
    known = re.findall(r"^(\w+)\t", read("port/arduino/keywords.txt"), re.MULTILINE)
    names = header + read("lib/include/tmini/tmini.h") + read("lib/include/tmini/tmini_types.h")
    for name in known:
        demand(re.search(rf"\b{name}\b", names), f"keywords.txt: there is no {name}")
    for part in re.split(r"^(?=struct|  (?:public|private|protected):)", header, flags=re.MULTILINE):
        if part.startswith(("struct", "  public:")):
            for name in re.findall(r"^    [a-z].*[ *&]([a-z][A-Za-z]+)\(", part, re.MULTILINE):
                demand(name in known, f"keywords.txt: {name} is missing")


check_facts()
check_sources()
check_files()
check_keywords()
print("\n".join(complaints) or "the manifests agree")
sys.exit(1 if complaints else 0)
