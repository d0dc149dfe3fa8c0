# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs PlatformIO without a network, with small platforms of our own.

    run.py native|scan ROOT WORK
    run.py archive ROOT WORK ARCHIVE

Needs a Python with the packages platformio and scons. `native` builds and runs the consumer's program, `scan` the
sketch Scan. `archive` repacks our archive with PlatformIO's packer, which must leave nothing out, and builds the
program with it. Exit status: 0 success, 1 failure.
"""

import json
import os
import shutil
import subprocess
import sys
import tarfile

import SCons
from platformio.dependencies import get_core_dependencies

HERE = os.path.dirname(os.path.abspath(__file__))

# A platform for each that a project names. Programs are built for this computer: with the framework, over the tests'
# stand-in for Arduino (arduino.py).
PLATFORMS = ("native", "espressif32")
BOARD = {"name": "ESP32 dev module", "vendor": "Espressif", "url": "", "frameworks": ["arduino"],
         "build": {"mcu": "esp32", "f_cpu": "240000000L"},
         "upload": {"maximum_ram_size": 1 << 18, "maximum_size": 1 << 20}}
BUILDER = """\
from SCons.Script import Default, DefaultEnvironment
env = DefaultEnvironment()
env.Tool("gcc")
env.Tool("g++")
Default(env.BuildProgram())
"""

SCONS = """\
import sys
sys.path.insert(0, {!r})
from SCons.Script.Main import main
sys.exit(main())
"""


def install(folder, kind, name, version, **files):
    """Writes a package of PlatformIO, with the file that it stores in each that it has installed."""
    spec = {"owner": "platformio", "id": None, "name": name, "requirements": None, "uri": None}
    about = {"name": name, "version": version}
    files |= {".piopm": {"type": kind, "spec": spec, **about},
              f"{'package' if kind == 'tool' else kind}.json": {**about, **files.pop("manifest", {})}}
    for path, content in files.items():
        path = os.path.join(folder, path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(content if isinstance(content, str) else json.dumps(content))


def install_scons(core):
    """Installs the Python package scons in place of the tool that PlatformIO would download."""
    install(os.path.join(core, "packages", "tool-scons"), "tool", "tool-scons",
            get_core_dependencies()["tool-scons"].strip("~^="),
            **{"scons.py": SCONS.format(os.path.dirname(SCons.__path__[0]))})


def install_platforms(core):
    with open(os.path.join(HERE, "arduino.py"), encoding="utf-8") as file:
        framework = file.read()
    for name in PLATFORMS:
        install(os.path.join(core, "platforms", name), "platform", name, "1.0.0",
                manifest={"title": name, "description": name, "license": "MIT", "engines": {"platformio": "^6"},
                          "frameworks": {"arduino": {"script": "builder/arduino.py"}}},
                **{"builder/main.py": BUILDER, "builder/arduino.py": framework, "boards/esp32dev.json": BOARD})


def environment(root, work):
    core = os.path.join(work, "core")
    install_scons(core)
    install_platforms(core)
    settings = {"ENABLE_TELEMETRY": "no", "CHECK_PLATFORMIO_INTERVAL": "9999", "CHECK_PRUNE_SYSTEM_THRESHOLD": "0"}
    return {**os.environ, "PLATFORMIO_CORE_DIR": core, "PLATFORMIO_WORKSPACE_DIR": os.path.join(work, "workspace"),
            "TMINI_TESTS": os.path.join(root, "test"),
            **{f"PLATFORMIO_SETTING_{name}": value for name, value in settings.items()}}


def build(project, name, env):
    subprocess.run([sys.executable, "-m", "platformio", "run", "-d", project, "-e", name], env=env, check=True)
    folder = os.path.join(env["PLATFORMIO_WORKSPACE_DIR"], "build", name)
    return os.path.join(folder, "program")


def check_native(package, env):
    env["TMINI_PACKAGE"] = package
    program = build(os.path.join(HERE, "project"), "consumer", env)
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert output == "ok\n", output


def pack(root, work):
    """Does the same as `pio pkg pack`, but without its download of the list of licences."""
    from platformio.package.manifest.schema import ManifestSchema
    from platformio.package.pack import PackagePacker
    ManifestSchema.load_spdx_licenses = staticmethod(
        lambda: {"licenses": [{"licenseId": "MIT"}]})
    return PackagePacker(root).pack(os.path.join(work, "tmini.tar.gz"))


def names_in(archive):
    with tarfile.open(archive) as file:
        return sorted(member.name for member in file if member.isfile())


def check_archive(archive, work, env):
    folder = os.path.join(work, "unpacked")
    shutil.unpack_archive(archive, folder)
    ours, theirs = names_in(archive), names_in(pack(folder, work))
    assert ours == theirs, sorted(set(ours) ^ set(theirs))
    check_native(folder, env)


def main():
    part, root, work = sys.argv[1], os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3])
    shutil.rmtree(work, ignore_errors=True)
    env = environment(root, work)
    if part == "native":
        check_native(root, env)
    elif part == "archive":
        check_archive(sys.argv[4], work, env)
    elif part == "scan":
        program = build(os.path.join(root, "examples", "esp32_arduino"), "scan", env)
        subprocess.run([program], check=True)


main()
