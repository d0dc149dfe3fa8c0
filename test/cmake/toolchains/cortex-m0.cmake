# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Cortex-M0, emulated: a processor that faults on unaligned access and has neither a division nor
# exclusive access. The board gets more memory than it really has, for the tests.

set(CORTEX_M cortex-m0)
set(CORTEX_M_MACHINE -M microbit
    -global nrf51-soc.flash-size=0x100000 -global nrf51-soc.sram-size=0x1000000)
set(CORTEX_M_RAM 0x20000000)
include(${CMAKE_CURRENT_LIST_DIR}/../../target/cortex_m.cmake)

set(TMINI_TEST_MACHINE cortex-m0)

# An STM32F0, L0 or G0 has such a one.
set(TMINI_TEST_PORTS stm32)
