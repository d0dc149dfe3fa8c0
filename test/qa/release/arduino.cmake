# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The Arduino library: all of src compiles with nothing but src and Arduino's interface to include,
# and so do the sketches; each sketch has a folder of its name.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

unpack(-arduino.zip)
expect_nothing_named(test_*.c *.png CMakeLists.txt)
if(NOT EXISTS ${WORK}/tmini/library.properties)
    message(FATAL_ERROR "there is no library.properties")
endif()
build(${CMAKE_CURRENT_LIST_DIR}/arduino -DLIBRARY=${WORK}/tmini
    -DARDUINO_STUB=${ROOT}/test/port/arduino/arduino_stub)
