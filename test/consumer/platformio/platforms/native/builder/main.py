# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
env.Tool("gcc")
env.Tool("g++")
Default(env.BuildProgram())
