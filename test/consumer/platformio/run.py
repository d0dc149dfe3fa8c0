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

# A platform for each that a project names. Programs are built for this computer: for `espressif32` over the tests'
# stand-in for Arduino (arduino.py).
PLATFORMS = {
    "native": {},
    "espressif32": {"frameworks": {"arduino": {"script": "builder/arduino.py"}}},
}
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


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def describe(folder, kind, name, version):
    """Writes the file that PlatformIO stores in each package that it has installed."""
    spec = {"owner": "platformio", "id": None, "name": name, "requirements": None, "uri": None}
    about = {"type": kind, "name": name, "version": version, "spec": spec}
    write(os.path.join(folder, ".piopm"), json.dumps(about))


def install_scons(core):
    """Installs the Python package scons in place of the tool that PlatformIO would download."""
    version = get_core_dependencies()["tool-scons"].strip("~^=")
    folder = os.path.join(core, "packages", "tool-scons")
    os.makedirs(folder)
    write(os.path.join(folder, "scons.py"), SCONS.format(os.path.dirname(SCons.__path__[0])))
    write(os.path.join(folder, "package.json"),
          json.dumps({"name": "tool-scons", "version": version}))
    describe(folder, "tool", "tool-scons", version)


def install_platforms(core):
    for name, more in PLATFORMS.items():
        folder = os.path.join(core, "platforms", name)
        for part in ("builder", "boards"):
            os.makedirs(os.path.join(folder, part))
        write(os.path.join(folder, "builder", "main.py"), BUILDER)
        shutil.copy(os.path.join(HERE, "arduino.py"), os.path.join(folder, "builder"))
        write(os.path.join(folder, "boards", "esp32dev.json"), json.dumps(BOARD))
        write(os.path.join(folder, "platform.json"),
              json.dumps({"name": name, "title": name, "description": name, "license": "MIT",
                          "engines": {"platformio": "^6"}, "version": "1.0.0", **more}))
        describe(folder, "platform", name, "1.0.0")


def environment(root, work):
    core = os.path.join(work, "core")
    install_scons(core)
    install_platforms(core)
    return dict(
        os.environ,
        PLATFORMIO_CORE_DIR=core,
        PLATFORMIO_WORKSPACE_DIR=os.path.join(work, "workspace"),
        PLATFORMIO_SETTING_ENABLE_TELEMETRY="no",
        PLATFORMIO_SETTING_CHECK_PLATFORMIO_INTERVAL="9999",
        PLATFORMIO_SETTING_CHECK_PRUNE_SYSTEM_THRESHOLD="0",
        TMINI_TESTS=os.path.join(root, "test"),
    )


def build(project, name, env):
    subprocess.run([sys.executable, "-m", "platformio", "run", "-d", project, "-e", name],
                   env=env, check=True)
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
    folder = unpack(archive, os.path.join(work, "unpacked"))
    ours, theirs = names_in(archive), names_in(pack(folder, work))
    assert ours == theirs, sorted(set(ours) ^ set(theirs))
    check_native(folder, env)


def unpack(archive, folder):
    with tarfile.open(archive) as file:
        file.extractall(folder)
    return folder


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
