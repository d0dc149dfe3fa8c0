# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that the manifests of several ecosystems agree.

    manifests.py [ROOT]

Compares their description, licence, author and keywords (.ci/version.py compares version and address), and
checks that each list of sources contains every source of the library. Exit status: 0 they agree, 1 differences,
which are printed.
"""

import glob
import json
import os
import re
import sys

ROOT = os.path.abspath(sys.argv[1] if len(sys.argv) > 1
                       else os.path.join(os.path.dirname(__file__), "..", ".."))
complaints = []


def complain(text):
    complaints.append(text)


def path(name):
    return os.path.join(ROOT, name)


def read(name):
    with open(path(name), encoding="utf-8") as file:
        return file.read()


def find(name, pattern):
    match = re.search(pattern, read(name), re.MULTILINE)
    return match and match.group(1).strip().strip('"')


def without_comments(text):
    return re.sub(r"#.*", "", text)


# ---- What each manifest says ----

def of_cmake():
    name = "CMakeLists.txt"
    return {"description": find(name, r'DESCRIPTION\s+("[^"]*")')}


def of_platformio():
    manifest = json.loads(read("library.json"))
    return {
        "name": manifest.get("name"),
        "description": manifest.get("description"),
        "licence": manifest.get("license"),
        "author": ", ".join(author["name"] for author in manifest.get("authors", [])),
        "keywords": sorted(manifest.get("keywords", [])),
    }


def of_arduino():
    name = "port/arduino/library.properties"
    return {
        "name": find(name, r"^name=(.*)$"),
        "description": (find(name, r"^sentence=(.*)$") or "").rstrip("."),
        "author": find(name, r"^author=(.*)$"),
    }


def of_ros2():
    name = "port/ros2/package.xml"
    return {
        "description": find(name, r"<description>(.*)</description>"),
        "licence": find(name, r"<license>(.*)</license>"),
        "author": find(name, r"<author>(.*)</author>"),
    }


def of_esp_idf():
    name = "idf_component.yml"
    tags = re.search(r"^tags:\n((?:  - .*\n)+)", read(name), re.MULTILINE)
    return {
        "description": find(name, r"^description: (.*)$"),
        "licence": find(name, r"^license: (.*)$"),
        "keywords": sorted(re.findall(r"- (.*)", tags.group(1))) if tags else None,
    }


def of_licence():
    return {
        "licence": (find("LICENSE", r"^(.*)$") or "").replace(" License", ""),
        "author": find("LICENSE", r"^Copyright \(c\) [0-9-]+ (.*)$"),
    }


def of_python():
    name = "port/python/pyproject.toml"
    return {"name": find(name, r"^name = (.*)$"), "licence": find(name, r"^license = (.*)$")}


def of_readme():
    return {"licence": find("README.md", r"^(\w+) licence\.")}


# The facts that each manifest must state.
SAID = {
    "CMakeLists.txt": (of_cmake, "description"),
    "library.json": (of_platformio, "name description licence author keywords"),
    "library.properties": (of_arduino, "name description author"),
    "idf_component.yml": (of_esp_idf, "description licence keywords"),
    "package.xml": (of_ros2, "description licence author"),
    "LICENSE": (of_licence, "licence author"),
    "README.md": (of_readme, "licence"),
    "pyproject.toml": (of_python, "name licence"),
}


def check_facts():
    said = {}
    for manifest, (facts_of, needed) in SAID.items():
        facts = facts_of()
        for fact in needed.split():
            if not facts.get(fact):
                complain("%s says nothing of %s" % (manifest, fact))
        for fact, value in facts.items():
            if value:
                said.setdefault(fact, {}).setdefault(str(value), []).append(manifest)
    for fact, values in said.items():
        if len(values) > 1:
            complain("%s differs:" % fact)
            for value, manifests in values.items():
                complain("    %s: %s" % (", ".join(manifests), value))


# ---- Lists of sources ----

SOURCES = sorted(os.path.basename(name) for name in glob.glob(path("lib/src/*.c")))


def build_files():
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders
                      if name not in ("test", ".git") and not name.startswith("build")]
        for file in files:
            if file == "CMakeLists.txt" or file.endswith((".cmake", ".mk")):
                yield os.path.relpath(os.path.join(folder, file), ROOT)


def check_sources():
    """Checks that a build file that names one of the library's sources names all of them."""
    listed = re.findall(r"src/(\w+\.c)", read("lib/CMakeLists.txt"))
    if sorted(listed) != SOURCES:
        complain("lib/CMakeLists.txt does not list what lib/src holds: %s"
                 % ", ".join(sorted(set(listed) ^ set(SOURCES))))
    for name in build_files():
        named = set(re.findall(r"lib/src/(\w+\.c)", without_comments(read(name))))
        if named and named != set(SOURCES):
            complain("%s names some of lib/src, but not %s"
                     % (name, ", ".join(sorted(set(SOURCES) - named))))


# Build files that compile all sources in lib/src, by a pattern.
TAKERS = ["port/esp32/component.cmake", "port/pico/CMakeLists.txt",
          "port/ros2/CMakeLists.txt", "port/zephyr/CMakeLists.txt"]


def check_takers():
    for name in TAKERS:
        if "/lib/src/*.c" not in without_comments(read(name)):
            complain("%s does not take lib/src/*.c" % name)


def check_platformio_lists():
    manifest = json.loads(read("library.json"))
    if "+<lib/src/*.c>" not in manifest["build"]["srcFilter"]:
        complain("library.json does not build lib/src/*.c")
    for header in manifest["headers"]:
        if not glob.glob(path("lib/include/" + header)) + glob.glob(path("port/*/" + header)):
            complain("library.json: no such header: %s" % header)
    for name in manifest["export"]["include"]:
        if not os.path.exists(path(name)):
            complain("library.json: nothing to export: %s" % name)
    for example in manifest["examples"]:
        for file in example["files"]:
            if not os.path.exists(path(os.path.join(example["base"], file))):
                complain("library.json: no such example: %s" % file)
    folder = "examples/esp32_arduino"
    for sketch in glob.glob(path(folder + "/*/*.ino")):
        if os.path.basename(sketch) not in sum((example["files"] for example in manifest["examples"]), []):
            complain("library.json: no example: %s" % os.path.basename(sketch))
    for sketch in re.findall(r'SKETCH="(.*?)"', read(folder + "/platformio.ini")):
        if not os.path.exists(path(os.path.join(folder, "platformio", sketch))):
            complain("platformio.ini: no such sketch: %s" % sketch)


def check_arduino_lists():
    for header in (find("port/arduino/library.properties", r"^includes=(.*)$") or "").split(","):
        if not os.path.exists(path("port/arduino/" + header)):
            complain("library.properties: no such header: %s" % header)


def check_esp_idf_lists():
    included = re.search(r"\n  include:\n(.*)", read("idf_component.yml"), re.DOTALL)
    patterns = re.findall(r"    - (.*)", included.group(1)) if included else []
    for pattern in patterns:
        if not glob.glob(path(pattern)):
            complain("idf_component.yml: nothing to include: %s" % pattern)
    for needed in ("lib/src/*.c", "lib/src/*.h", "lib/include/tmini/*.h",
                   "lib/include/tmini/parts/*.h"):
        if needed not in patterns:
            complain("idf_component.yml does not include %s" % needed)


def check_esp_idf_example():
    folder = "examples/esp32_idf/main"
    name = folder + "/idf_component.yml"
    where = os.path.exists(path(name)) and find(
        name, r"^dependencies:\n  tmini:\n(?:    .*\n)*    override_path: (.*)$")
    if not where or not os.path.samefile(path(os.path.join(folder, where)), path(".")):
        complain("%s does not lead to the component" % name)


def check_zephyr_lists():
    name = "zephyr/module.yml"
    if find(name, r"^name: (.*)$") != of_platformio()["name"]:
        complain("%s has another name" % name)
    places = re.findall(r"(?:cmake|kconfig|dts_root): (.*)", read(name))
    places += re.findall(r"^  - (.*)$", read(name), re.MULTILINE)
    if len(places) < 4:
        complain("%s names only %s" % (name, places))
    for place in places:
        if not os.path.exists(path(place)):
            complain("%s: no such place: %s" % (name, place))


check_facts()
check_sources()
check_takers()
check_zephyr_lists()
check_platformio_lists()
check_arduino_lists()
check_esp_idf_lists()
check_esp_idf_example()
print("\n".join(complaints) or "the manifests agree")
sys.exit(1 if complaints else 0)
