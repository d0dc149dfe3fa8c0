# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Describes the module tmini._native to cffi: it is compiled from the library's sources, and
native.cdef declares the functions that the package calls. The C compiler checks each
declaration."""

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
