# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Builds the package from the sources of lib/, those of the tool that read recordings, and the viewer. A
source distribution contains them. In the checkout they are two folders up, and are copied here while
setuptools works, because it accepts only files below this folder. (So two installations must not
use one checkout at the same time.)"""

import pathlib
import shutil

from setuptools import setup

HERE = pathlib.Path(__file__).resolve().parent
CARRIED = HERE / "lib"
PAGE = HERE / "tmini" / "tmini.html"
CHECKOUT = HERE.parents[1]
SOURCES = ["examples/host/" + name for name in ("causes", "chunk", "stream", "tape", "traits", "witness")]
SOURCES += ["port/posix/tmini_timed", "port/ros2/src/tmini_laser"]
IS_DISTRIBUTION = (HERE / "PKG-INFO").exists()

if not IS_DISTRIBUTION:
    if not (CHECKOUT / "lib" / "include" / "tmini").is_dir():
        raise SystemExit(f"no library in {CHECKOUT}/lib: install from the whole checkout "
                         "(pip install ./port/python), with pip 21.3 or later")
    shutil.copytree(CHECKOUT / "lib", CARRIED, dirs_exist_ok=True)
    for place in SOURCES:
        for suffix in (".c", ".h"):
            shutil.copy(CHECKOUT / (place + suffix), CARRIED / "src")
    shutil.copy(CHECKOUT / "LICENSE", HERE)
    shutil.copy(CHECKOUT / "examples" / "web" / "tmini.html", PAGE)
try:
    setup(cffi_modules=["native.py:ffi"])
finally:
    if not IS_DISTRIBUTION:
        shutil.rmtree(CARRIED)
        shutil.rmtree(HERE / "build", ignore_errors=True)
        (HERE / "LICENSE").unlink()
        PAGE.unlink()
