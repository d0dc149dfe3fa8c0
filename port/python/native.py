# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Describes to cffi the module tmini._native: the library's sources, compiled here, and those of
its functions that the package calls (native.cdef). The C compiler checks each declaration."""

import pathlib

import cffi

ffi = cffi.FFI()
ffi.cdef(pathlib.Path("native.cdef").read_text(encoding="utf-8"))
ffi.set_source(
    "tmini._native",
    pathlib.Path("native.c").read_text(encoding="utf-8"),
    sources=sorted(path.as_posix() for path in pathlib.Path("lib/src").glob("*.c")),
    include_dirs=["lib/include", "lib/src"],
)
