/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the port and its example use of the Pico SDK, with the SDK's names, on the model of the chip
 * (../pico_model.h). Written for the tests from the SDK's public documentation and the data
 * sheets. */

#ifndef PICO_SDK_H
#define PICO_SDK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h> /* uint */

#if PICO_RP2350
#define NUM_BANK0_GPIOS 48u
#else
#define PICO_RP2040 1
#define NUM_BANK0_GPIOS 30u
#endif

/* ----------------------------------------------------------------------------------------- UART */

typedef struct uart_inst uart_inst_t;
extern uart_inst_t *const pico_uarts[2];
#define uart0 (pico_uarts[0])
#define uart1 (pico_uarts[1])

/* Reading the data register takes an entry out of the FIFO: naming the member does so here. */
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

void hw_write_masked(volatile uint32_t *address, uint32_t values, uint32_t mask);

/* ----------------------------------------------------------------------------------- interrupts */

typedef void (*irq_handler_t)(void);
bool irq_has_handler(uint number);
void irq_set_exclusive_handler(uint number, irq_handler_t handler);
void irq_remove_handler(uint number, irq_handler_t handler);
void irq_set_enabled(uint number, bool enabled);

void __dmb(void);

/* ------------------------------------------------------------------------------------------ DMA */

#define DMA_SIZE_8 0

typedef struct {
    uint chain_to;
    uint dreq;
    uint ring_bits;
    uint data_size;
    bool ring_on_write;
    bool read_increment;
    bool write_increment;
} dma_channel_config;

typedef struct {
    volatile uint32_t transfer_count;
} dma_channel_hw_t;

int dma_claim_unused_channel(bool required);
void dma_channel_unclaim(uint channel);
dma_channel_config dma_channel_get_default_config(uint channel);
void channel_config_set_transfer_data_size(dma_channel_config *config, int size);
void channel_config_set_read_increment(dma_channel_config *config, bool increment);
void channel_config_set_write_increment(dma_channel_config *config, bool increment);
void channel_config_set_ring(dma_channel_config *config, bool write, uint size_bits);
void channel_config_set_dreq(dma_channel_config *config, uint dreq);
void channel_config_set_chain_to(dma_channel_config *config, uint chain_to);
void dma_channel_configure(uint channel, const dma_channel_config *config, volatile void *write,
                           const volatile void *read, uint32_t transfer_count, bool trigger);
dma_channel_hw_t *dma_channel_hw_addr(uint channel);
void dma_channel_cleanup(uint channel);

/* ----------------------------------------------------------------------------------------- pins */

enum { GPIO_FUNC_UART = 2, GPIO_FUNC_UART_AUX = 11 };
#if PICO_RP2350
#define UART_FUNCSEL_NUM(uart, gpio) (((gpio)&2u) != 0 ? GPIO_FUNC_UART_AUX : GPIO_FUNC_UART)
#else
#define UART_FUNCSEL_NUM(uart, gpio) GPIO_FUNC_UART
#endif

#define GPIO_OUT true
void gpio_init(uint gpio);
void gpio_set_dir(uint gpio, bool out);
void gpio_put(uint gpio, bool value);
void gpio_set_function(uint gpio, uint function);
void gpio_pull_up(uint gpio);

/* ----------------------------------------------------------------------------------------- time */

typedef uint64_t absolute_time_t;
absolute_time_t get_absolute_time(void);
uint32_t to_ms_since_boot(absolute_time_t time);
void sleep_ms(uint32_t ms);

bool stdio_init_all(void);

#endif
