/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Unity's and CMock's settings: the same on every machine, except for where the output goes. Also
 * checks that a machine chosen for a property has that property. */

#ifndef UNITY_CONFIG_H
#define UNITY_CONFIG_H

#include <limits.h>
#include <stdint.h>

/* Of an emulated controller (test/target): prints a character; what comes before the first and
 * after the last. */
void board_put(char character);
void board_start(void);
void board_stop(void);

/* 64-bit assertions also on machines with narrower registers. */
#define UNITY_SUPPORT_64

#ifdef __AVR__

#define UNITY_OUTPUT_START() board_start()
#define UNITY_OUTPUT_CHAR(c) board_put((char)(c))
#define UNITY_OUTPUT_COMPLETE() board_stop()

/* 8 KB of RAM hold everything, including texts, so CMock's memory is small. */
#define CMOCK_MEM_STATIC
#define CMOCK_MEM_SIZE 1024
#define CMOCK_MEM_ALIGN 0
#define CMOCK_MEM_INDEX_TYPE uint16_t
#define CMOCK_MEM_PTR_AS_INT uint16_t

#endif

#ifdef TMINI_TEST_SEMIHOSTING

#define UNITY_OUTPUT_CHAR(c) board_put((char)(c))

#endif

#if defined(TMINI_TEST_INT16) && INT_MAX != 0x7FFF
#error "this machine was chosen for its 16-bit int, which it has not"
#endif

#if defined(TMINI_TEST_RV32IMC) && (__riscv_xlen != 32 || !defined(__riscv_compressed))
#error "this machine was chosen for being rv32imc, which it is not"
#endif

#if defined(TMINI_TEST_BIG_ENDIAN) && __BYTE_ORDER__ != __ORDER_BIG_ENDIAN__
#error "this machine was chosen for being big-endian, which it is not"
#endif

#endif
