/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Linked into the firmware by the linker's --wrap: its clock and the simulated lidar's are one,
 * however slow the computer is. Each millisecond the firmware sends a byte through USART3. run.py
 * lets the lidar go on for a millisecond, sends what left it to USART1, and then how many bytes
 * those are to USART3. Until all of them have been received, time stands still. */

#include "stm32f405.h"
#include "tmini_stm32_usart.h"

#define USART3_SR REGISTER(0x40004800u)
#define USART3_DR REGISTER(0x40004804u)
#define USART3_CR1 REGISTER(0x4000480Cu)

static uint32_t received;
static uint32_t sent; /* By the lidar. */
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
/* A deliberate fault, which the test must find: of the bytes that the interrupt receives and
 * counts, one now and then is taken out of the library's ring again. */
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
