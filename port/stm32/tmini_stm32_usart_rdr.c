/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The USART with registers ISR and RDR: all STM32 families but F1, F2, F4 and L1. */

#include "tmini_stm32_usart.h"

#define BAUD_RATE 230400u /* Section 1. */

/* Registers, as indices of 32-bit words. */
enum { CR1 = 0, CR2 = 1, CR3 = 2, BRR = 3, ISR = 7, ICR = 8, RDR = 9, TDR = 10 };

#define ISR_FE (1u << 1)
#define ISR_NE (1u << 2)
#define ISR_ORE (1u << 3)
#define ISR_RXNE (1u << 5)
#define ISR_TXE (1u << 7)
#define ISR_ERRORS (ISR_FE | ISR_NE | ISR_ORE) /* The same bits in ICR clear them. */
#define CR1_UE (1u << 0)
#define CR1_RE (1u << 2)
#define CR1_TE (1u << 3)
#define CR1_RXNEIE (1u << 5) /* Also for overruns. */

static void count_errors(tmini_stm32_usart_t *port, uint32_t status)
{
    port->overruns = port->overruns + ((status & ISR_ORE) != 0);
    port->framing_errors = port->framing_errors + ((status & ISR_FE) != 0);
    port->noise_errors = port->noise_errors + ((status & ISR_NE) != 0);
}

static int write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_stm32_usart_t *const port = context;
    int taken = 0;
    while ((size_t)taken < count && (port->registers[ISR] & ISR_TXE) != 0) {
        port->registers[TDR] = bytes[taken];
        taken++;
    }
    return taken;
}

static uint32_t now_ms(void *context)
{
    const tmini_stm32_usart_t *const port = context;
    return *port->time_ms;
}

const tmini_port_t tmini_stm32_usart_port = {.write = write, .now_ms = now_ms, .wait = NULL};

void tmini_stm32_usart_begin(tmini_stm32_usart_t *port, tmini_t *lidar, volatile void *usart,
                             const volatile uint32_t *time_ms)
{
    *port = (tmini_stm32_usart_t){.registers = usart, .lidar = lidar, .time_ms = time_ms};
}

void tmini_stm32_usart_open(tmini_stm32_usart_t *port, uint32_t clock_hz)
{
    volatile uint32_t *const registers = port->registers;
    registers[CR1] = 0; /* The other registers may be written only while the USART is off. */
    registers[CR2] = 0;
    registers[CR3] = 0;
    /* With 16-fold oversampling BRR is the clock by the baud rate. */
    registers[BRR] = (clock_hz + BAUD_RATE / 2) / BAUD_RATE;
    registers[ICR] = ISR_ERRORS;
    registers[CR1] = CR1_UE | CR1_TE | CR1_RE | CR1_RXNEIE;
}

void tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port)
{
    const uint32_t status = port->registers[ISR];
    if ((status & ISR_ERRORS) != 0) {
        count_errors(port, status);
        port->registers[ICR] = status & ISR_ERRORS; /* Else an overrun interrupts for ever. */
    }
    if ((status & ISR_RXNE) != 0) {
        port->bytes = port->bytes + 1;
        tmini_feed_byte(port->lidar, (uint8_t)port->registers[RDR]);
    }
}
