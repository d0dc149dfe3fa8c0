# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The package is built from the sources of lib/. A source distribution carries them; in the
checkout they lie two folders up, and are here while setuptools works, which takes no others."""

import pathlib
import shutil

from setuptools import setup

HERE = pathlib.Path(__file__).resolve().parent
CARRIED = HERE / "lib"
CHECKOUT = HERE.parents[1] / "lib"
IS_DISTRIBUTION = (HERE / "PKG-INFO").exists()

if not IS_DISTRIBUTION:
    if not (CHECKOUT / "include" / "tmini").is_dir():
        raise SystemExit(f"no library in {CHECKOUT}: install from the whole checkout "
                         "(pip install ./port/python), with pip 21.3 or later")
    shutil.copytree(CHECKOUT, CARRIED, dirs_exist_ok=True)
    shutil.copy(CHECKOUT.parent / "LICENSE", HERE)
try:
    setup(cffi_modules=["native.py:ffi"])
finally:
    if not IS_DISTRIBUTION:
        shutil.rmtree(CARRIED)
        (HERE / "LICENSE").unlink()
