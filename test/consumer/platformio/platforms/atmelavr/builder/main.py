# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
machine = ["-mmcu=" + env.BoardConfig().get("build.mcu")]
env.Replace(
    AR="avr-gcc-ar",
    AS="avr-gcc",
    CC="avr-gcc",
    CXX="avr-g++",
    LINK="avr-g++",
    RANLIB="avr-gcc-ranlib",
    PROGSUFFIX=".elf",
)
env.Append(
    ASFLAGS=["-x", "assembler-with-cpp"] + machine,
    CCFLAGS=["-Os", "-ffunction-sections", "-fdata-sections"] + machine,
    CFLAGS=["-std=gnu11"],
    CXXFLAGS=["-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics"],
    LINKFLAGS=["-Os", "-Wl,--gc-sections"] + machine,
    LIBS=["m"],
)
Default(env.BuildProgram())
