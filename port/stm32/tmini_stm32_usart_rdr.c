/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The USART with registers ISR and RDR: all STM32 families except F1, F2, F4 and L1. */

#include "tmini_stm32_usart.h"

/* Registers, as indices of 32-bit words. */
enum { CR1 = 0, CR2 = 1, CR3 = 2, BRR = 3, STATUS = 7, ICR = 8, DATA_IN = 9, DATA_OUT = 10 };

#define CR1_UE (1u << 0)

#include "tmini_stm32_usart_common.h"

/* ICR has the same bits. An overrun that is not cleared would interrupt endlessly. */
static inline void clear_flags(volatile uint32_t *registers, uint32_t status)
{
    write_register(&registers[ICR], status & (STATUS_ERRORS | STATUS_IDLE));
}
