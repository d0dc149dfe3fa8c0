# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Simulated ATmega2560: int has 16 bits, and there are 8 KB of RAM.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
set(CMAKE_C_COMPILER avr-gcc)
# With the macro AVR defined, Unity would put its texts into flash but read them from RAM addresses.
set(CMAKE_C_FLAGS_INIT
    "-mmcu=atmega2560 -ffunction-sections -fdata-sections -UAVR -DTMINI_TEST_INT16")
# The linker refuses static data that would leave less than 1.5 KB for the stack.
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-mmcu=atmega2560 -Wl,--gc-sections -Wl,--defsym=__DATA_REGION_LENGTH__=6656")
# CMake's trial program is not linked: there is no start-up code.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

find_program(TMINI_SIMAVR simavr)
set(CMAKE_CROSSCOMPILING_EMULATOR ${TMINI_SIMAVR} -m atmega2560 -f 16000000)

set(TMINI_TEST_MACHINE int16)
set(TMINI_TEST_SHORT_NAMES ON)
set(TMINI_TEST_BOARD_SOURCES ${CMAKE_CURRENT_LIST_DIR}/../../target/avr_board.c)
# There is no exit status: Unity's last line decides whether the test passed.
set(TMINI_TEST_PASS_PATTERN " Tests 0 Failures ")
set(TMINI_TEST_FAIL_PATTERN "STACK OVERFLOW")
