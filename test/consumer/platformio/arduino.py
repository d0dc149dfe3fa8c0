# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Compiles the sketch with the tests' stand-in for the Arduino core for ESP32.

import os

from SCons.Script import DefaultEnvironment

TESTS = os.environ["TMINI_TESTS"]

env = DefaultEnvironment()
env.Append(
    CPPPATH=[os.path.join(TESTS, "port/arduino/arduino_stub")],
    CPPDEFINES=[("ARDUINO", 10819), "ESP32", ("ESP_ARDUINO_VERSION_MAJOR", 3)],
    CXXFLAGS=["-std=gnu++11"],
)
env.Append(LIBS=[env.BuildLibrary("$BUILD_DIR/core", os.path.join(TESTS, "consumer/platformio/core"))])
