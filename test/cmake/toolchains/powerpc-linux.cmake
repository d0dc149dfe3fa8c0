# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Emulated 32-bit PowerPC under Linux: a big-endian machine.

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR powerpc)
set(CMAKE_C_COMPILER powerpc-linux-gnu-gcc)
set(CMAKE_C_FLAGS_INIT "-DTMINI_TEST_BIG_ENDIAN")
# A static program needs none of PowerPC's shared libraries.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")

find_program(TMINI_QEMU_PPC NAMES qemu-ppc qemu-ppc-static)
set(CMAKE_CROSSCOMPILING_EMULATOR ${TMINI_QEMU_PPC})

set(TMINI_TEST_MACHINE bigendian)
