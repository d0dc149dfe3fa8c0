# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Emulated Cortex-M0: it faults on unaligned access, and has neither a divide instruction nor
# exclusive access. The emulated board has more memory than the real one: the tests need it.

set(CORTEX_M cortex-m0)
set(CORTEX_M_MACHINE -M microbit
    -global nrf51-soc.flash-size=0x100000 -global nrf51-soc.sram-size=0x1000000)
set(CORTEX_M_RAM 0x20000000)
include(${CMAKE_CURRENT_LIST_DIR}/../../target/cortex_m.cmake)

set(TMINI_TEST_MACHINE cortex-m0)

# STM32F0, L0 and G0 have such a processor.
set(TMINI_TEST_PORTS stm32)
