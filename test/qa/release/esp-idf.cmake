# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The ESP-IDF component, in a project's folder components, by a model of the functions of ESP-IDF's
# build.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

unpack(-esp-idf.zip)
expect_nothing_named(test_*.c *.png *.ino tmini_stm32* tmini_posix*)
build(${CMAKE_CURRENT_LIST_DIR}/esp_idf -DCOMPONENT=${WORK}/tmini
    -DESP_IDF=${ROOT}/test/port/esp32/esp_idf)
