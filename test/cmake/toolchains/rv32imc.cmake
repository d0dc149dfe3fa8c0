# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# rv32imc, the instruction set of the ESP32-C3 and its relatives, on QEMU's bare `virt` machine.
# Output and exit status go through semihosting, which picolibc's start-up code uses.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_C_FLAGS_INIT "--specs=picolibc.specs -march=rv32imc -mabi=ilp32 \
-ffunction-sections -fdata-sections -DTMINI_TEST_RV32IMC")
# The RAM of `virt` begins at 0x80000000, where execution starts. The first 16 MB serve as flash,
# the next 16 MB as RAM.
set(CMAKE_EXE_LINKER_FLAGS_INIT "--oslib=semihost --crt0=semihost -Wl,--gc-sections \
-Wl,--defsym=__flash=0x80000000 -Wl,--defsym=__flash_size=0x1000000 \
-Wl,--defsym=__ram=0x81000000 -Wl,--defsym=__ram_size=0x1000000")
# CMake's trial program is not linked.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

find_program(TMINI_QEMU_RISCV32 qemu-system-riscv32)
set(CMAKE_CROSSCOMPILING_EMULATOR ${TMINI_QEMU_RISCV32} -M virt -bios none -display none
    -serial none -monitor none -semihosting-config enable=on,target=native -kernel)

set(TMINI_TEST_MACHINE rv32imc)

set(TMINI_TEST_PORTS esp32)
