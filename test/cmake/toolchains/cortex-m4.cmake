# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Emulated Cortex-M4: the processor of STM32F4, G4 and L4.

set(CORTEX_M cortex-m4)
set(CORTEX_M_MACHINE -M mps2-an386)
set(CORTEX_M_RAM 0x21000000)
include(${CMAKE_CURRENT_LIST_DIR}/../../target/cortex_m.cmake)

set(TMINI_TEST_MACHINE cortex-m4)
