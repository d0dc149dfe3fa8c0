/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The USART with registers SR and DR: STM32F1, F2, F4, L1. */

#include "tmini_stm32_usart.h"

#define BAUD_RATE 230400u /* Section 1. */

/* Registers, as indices of 32-bit words. */
enum { SR = 0, DR = 1, BRR = 2, CR1 = 3, CR2 = 4, CR3 = 5 };

#define SR_FE (1u << 1)
#define SR_NE (1u << 2)
#define SR_ORE (1u << 3)
#define SR_RXNE (1u << 5)
#define SR_TXE (1u << 7)
#define CR1_RE (1u << 2)
#define CR1_TE (1u << 3)
#define CR1_RXNEIE (1u << 5) /* Also for overruns. */
#define CR1_UE (1u << 13)

static void count_errors(tmini_stm32_usart_t *port, uint32_t status)
{
    port->overruns = port->overruns + ((status & SR_ORE) != 0);
    port->framing_errors = port->framing_errors + ((status & SR_FE) != 0);
    port->noise_errors = port->noise_errors + ((status & SR_NE) != 0);
}

static int write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_stm32_usart_t *const port = context;
    int taken = 0;
    while ((size_t)taken < count && (port->registers[SR] & SR_TXE) != 0) {
        port->registers[DR] = bytes[taken];
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
    registers[CR1] = 0;
    registers[CR2] = 0;
    registers[CR3] = 0;
    /* With 16-fold oversampling BRR is the divider in sixteenths: the clock by the baud rate. */
    registers[BRR] = (clock_hz + BAUD_RATE / 2) / BAUD_RATE;
    registers[CR1] = CR1_UE | CR1_TE | CR1_RE | CR1_RXNEIE;
}

void tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port)
{
    const uint32_t status = port->registers[SR];
    if ((status & (SR_ORE | SR_FE | SR_NE)) != 0) {
        count_errors(port, status);
    } else if ((status & SR_RXNE) == 0) {
        return;
    }
    /* Reading DR after SR takes the byte and clears the errors: also an overrun that shows up without
     * a byte, which would otherwise interrupt for ever. */
    const uint8_t byte = (uint8_t)port->registers[DR];
    if ((status & SR_RXNE) != 0) {
        port->bytes = port->bytes + 1;
        tmini_feed_byte(port->lidar, byte);
    }
}
