# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Debian's Arduino core.

from SCons.Script import DefaultEnvironment

env = DefaultEnvironment()
board = env.BoardConfig()
avr = "/usr/share/arduino/hardware/arduino/avr"
core = avr + "/cores/arduino"
env.Append(
    CPPPATH=[core, avr + "/variants/" + board.get("build.variant")],
    CPPDEFINES=[
        ("F_CPU", board.get("build.f_cpu")),
        ("ARDUINO", 10819),
        "ARDUINO_AVR_MEGA2560",
        "ARDUINO_ARCH_AVR",
        # GCC before 6 does not name this in C++, but the core expects it.
        ("DECIMAL_DIG", "__DECIMAL_DIG__"),
    ],
)
env.Prepend(LIBS=[env.BuildLibrary("$BUILD_DIR/core", core)])
