/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The USART with registers SR and DR: STM32F1, F2, F4, L1. */

#include "tmini_stm32_usart.h"

/* Registers, as indices of 32-bit words. */
enum { STATUS = 0, DATA_IN = 1, DATA_OUT = 1, BRR = 2, CR1 = 3, CR2 = 4, CR3 = 5 };

#define CR1_UE (1u << 13)

#include "tmini_stm32_usart_common.h"

/* SR has been read; reading DR after it clears the errors and the idle flag. This includes an
 * overrun without a byte, which would otherwise interrupt endlessly. If there is a byte, reading it
 * clears the flags, also when the DMA reads it. */
static inline void clear_flags(volatile uint32_t *registers, uint32_t status)
{
    if ((status & (STATUS_ERRORS | STATUS_IDLE)) != 0 && (status & STATUS_RXNE) == 0) {
        (void)read_register(&registers[DATA_IN]);
    }
}
