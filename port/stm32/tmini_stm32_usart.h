/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A tmini port for STM32 without the HAL: an interrupt a byte, on the USART's registers. Compile the one
 * source that fits the family:
 *
 *   tmini_stm32_usart_dr.c    registers SR and DR: F1, F2, F4, L1
 *   tmini_stm32_usart_rdr.c   registers ISR and RDR: all others (C0, F0, F3, F7, G0, G4, H5, H7, L0,
 *                             L4, L5, U0, U5, WB, WL, …)
 *
 * Yours: the clocks of USART and pins, the pins' alternate function, the USART's interrupt in the NVIC,
 * and a count of milliseconds. Order of calls: tmini_stm32_usart_begin(), tmini_init(),
 * tmini_stm32_usart_open(), then commands.
 *
 *     void USART1_IRQHandler(void) { tmini_stm32_usart_interrupt(&port); } */

#ifndef TMINI_STM32_USART_H
#define TMINI_STM32_USART_H

#include <stdint.h>

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One lidar's USART; the counters may be read, the rest is private. */
typedef struct {
    volatile uint32_t *registers;
    tmini_t *lidar;
    const volatile uint32_t *time_ms;
    volatile uint32_t bytes; /* Received; compare with tmini_counters(). */
    volatile uint32_t overruns;
    volatile uint32_t framing_errors;
    volatile uint32_t noise_errors;
} tmini_stm32_usart_t;

/* The `port` of tmini_config_t; its `port_context` is the address of a tmini_stm32_usart_t. Never
 * waits: takes what the transmitter has room for. */
extern const tmini_port_t tmini_stm32_usart_port;

/* Names the ends that the port connects. `usart` is the USART's base address (USART1 of ST's headers
 * will do). `time_ms` is a count of milliseconds, kept by an interrupt of yours. */
void tmini_stm32_usart_begin(tmini_stm32_usart_t *port, tmini_t *lidar, volatile void *usart,
                             const volatile uint32_t *time_ms);

/* Sets the USART to 230400 8N1 and lets it receive. `clock_hz` is the clock that feeds the USART,
 * at least 3.7 MHz. */
void tmini_stm32_usart_open(tmini_stm32_usart_t *port, uint32_t clock_hz);

/* To be called from the USART's interrupt. No loop, no wait. A byte that came with a framing or noise
 * error is counted and stored all the same: the packet's checksum decides what it is worth. */
void tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);

#ifdef __cplusplus
}
#endif

#endif
