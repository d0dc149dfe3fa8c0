# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The common part of the toolchain files for emulated Cortex-M machines. Each file sets CORTEX_M
# (the compiler's name of the processor), CORTEX_M_MACHINE (the emulator's options for a board with
# that processor) and CORTEX_M_RAM (the address of 16 MB of RAM on that board).

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_C_FLAGS_INIT "-mcpu=${CORTEX_M} -mthumb -ffunction-sections -fdata-sections \
-DTMINI_TEST_SEMIHOSTING")
set(CMAKE_EXE_LINKER_FLAGS_INIT "--specs=nano.specs --specs=nosys.specs -nostartfiles \
-Wl,--gc-sections -Wl,--defsym=RAM_START=${CORTEX_M_RAM} \
-T\"${CMAKE_CURRENT_LIST_DIR}/cortex_m.ld\"")
# CMake's trial program is not linked: there is no start-up code.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

find_program(TMINI_QEMU_ARM qemu-system-arm)
set(CMAKE_CROSSCOMPILING_EMULATOR ${TMINI_QEMU_ARM} ${CORTEX_M_MACHINE}
    -display none -monitor none -serial null -semihosting-config enable=on,target=native -kernel)

set(TMINI_TEST_BOARD_SOURCES ${CMAKE_CURRENT_LIST_DIR}/cortex_m_start.c)
