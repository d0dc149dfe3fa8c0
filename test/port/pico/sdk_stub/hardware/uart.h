/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_UART_H
#define HARDWARE_UART_H

#include "hardware/address_mapped.h"
#include "pico.h"

typedef struct uart_inst uart_inst_t;
extern uart_inst_t *const pico_uarts[2];
#define uart0 (pico_uarts[0])
#define uart1 (pico_uarts[1])

/* Reading the data register, the member `dr`, removes an entry from the FIFO. */
typedef struct {
    volatile uint32_t taken[1];
    volatile uint32_t ris;
    volatile uint32_t icr;
    volatile uint32_t ifls;
} uart_hw_t;
unsigned pico_model_take_entry(void);
#define dr taken[pico_model_take_entry()]

#define UART_UARTDR_OE_LSB 11
#define UART_UARTDR_OE_BITS 0x800u
#define UART_UARTDR_BE_BITS 0x400u
#define UART_UARTDR_PE_BITS 0x200u
#define UART_UARTDR_FE_BITS 0x100u
#define UART_UARTRIS_OERIS_LSB 10
#define UART_UARTRIS_OERIS_BITS 0x400u
#define UART_UARTRIS_BERIS_BITS 0x200u
#define UART_UARTRIS_FERIS_BITS 0x080u
#define UART_UARTIFLS_RXIFLSEL_LSB 3
#define UART_UARTIFLS_RXIFLSEL_BITS 0x38u

uint uart_init(uart_inst_t *uart, uint baud_rate);
uint uart_get_index(uart_inst_t *uart);
uart_hw_t *uart_get_hw(uart_inst_t *uart);
bool uart_is_readable(uart_inst_t *uart);
bool uart_is_writable(uart_inst_t *uart);
void uart_putc_raw(uart_inst_t *uart, char byte);
void uart_set_irqs_enabled(uart_inst_t *uart, bool rx_has_data, bool tx_needs_data);
uint uart_get_dreq(uart_inst_t *uart, bool is_tx);
#define UART_IRQ_NUM(uart) (20u + uart_get_index(uart))

/* gpio.h defines the names of these functions. */
#if PICO_RP2350
#define UART_FUNCSEL_NUM(uart, gpio) (((gpio)&2u) != 0 ? GPIO_FUNC_UART_AUX : GPIO_FUNC_UART)
#else
#define UART_FUNCSEL_NUM(uart, gpio) GPIO_FUNC_UART
#endif

#endif
