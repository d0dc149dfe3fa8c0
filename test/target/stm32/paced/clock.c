/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Linked into the firmware with --wrap, so that the firmware and the simulated lidar share one
 * clock, however slow the computer is. Each millisecond the firmware sends a byte through USART3.
 * run.py then runs the lidar for one millisecond, sends the lidar's bytes to USART1, and their
 * number to USART3. The firmware's time stands still until all these bytes are received. */

#include "stm32f405.h"
#include "tmini_stm32_usart.h"

#define USART3_SR REGISTER(0x40004800u)
#define USART3_DR REGISTER(0x40004804u)
#define USART3_CR1 REGISTER(0x4000480Cu)

static uint32_t received;
static uint32_t sent; /* Bytes sent by the lidar. */
static bool is_asking;

void __real_SysTick_Handler(void);
void __wrap_SysTick_Handler(void);
void __real_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);
void __wrap_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);

void __wrap_SysTick_Handler(void)
{
    USART3_CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE;
    if (is_asking && (USART3_SR & USART_SR_RXNE) != 0) {
        sent += USART3_DR;
        is_asking = false;
    }
    if (!is_asking && received == sent) {
        __real_SysTick_Handler();
        USART3_DR = 0;
        is_asking = true;
    }
}

#ifdef LOSSY
/* A deliberate fault, which the test must find: one in 5000 bytes that the interrupt has received
 * and counted is removed from the library's ring. */
static void harm(tmini_stm32_usart_t *port)
{
    if (received % 5000u == 0) {
        port->lidar->ring.head--;
        port->lidar->ring.stop = port->lidar->ring.head;
    }
}
#endif

void __wrap_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port)
{
    const uint32_t before = port->counters.bytes;
    __real_tmini_stm32_usart_interrupt(port);
    if (port->counters.bytes != before) {
        received++;
#ifdef LOSSY
        harm(port);
#endif
    }
}
