/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "pico_model.h"

#include <stdlib.h>
#include <string.h>

#include "hardware/sync.h"
#include "irq_lines.h"
#include "pico/stdlib.h"

#define TIMEOUT_US 139u /* 32 bits at 230400 baud. */
#define DREQ_UART1_RX 23u
#define COUNT_MAX 0x0FFFFFFFu /* RP2350's count has 28 bits; the higher bits are a mode. */

struct uart_inst {
    unsigned index;
};

static struct uart_inst uarts[2] = {{0}, {1}};
uart_inst_t *const pico_uarts[2] = {&uarts[0], &uarts[1]};

chip_t chip;

/* ------------------------------------------------------------------------------------------ DMA */

static bool is_of_uart(const channel_t *channel)
{
    return channel->busy && channel->config.dreq == DREQ_UART1_RX;
}

static void trigger(channel_t *channel)
{
    if (channel->enabled && !channel->busy) {
        channel->count = channel->reload;
        channel->busy = channel->count > 0;
    }
}

static void count_down(channel_t *channel, uint32_t bytes)
{
    channel->count -= bytes;
    if (channel->count == 0) {
        channel->busy = false;
        if (&chip.channels[channel->config.chain_to] != channel) {
            chip.changes_of_channel++;
            trigger(&chip.channels[channel->config.chain_to]);
        }
    }
}

static void write_byte(channel_t *channel, uint8_t byte)
{
    const uintptr_t mask = ((uintptr_t)1 << channel->config.ring_bits) - 1;
    const uintptr_t address = (uintptr_t)channel->write;
    *channel->write = byte;
    channel->write = (uint8_t *)((address & ~mask) | ((address + 1) & mask));
}

static void run_dma(void)
{
    for (unsigned i = 0; i < CHANNELS && !chip.dma_blocked; i++) {
        channel_t *const channel = &chip.channels[i];
        while (is_of_uart(channel) && machine.count > 0) {
            write_byte(channel, (uint8_t)machine_take());
            count_down(channel, 1);
        }
    }
}

int dma_claim_unused_channel(bool required)
{
    for (unsigned i = 0; i < CHANNELS; i++) {
        if (!chip.channels[i].claimed) {
            chip.channels[i].claimed = true;
            return (int)i;
        }
    }
    if (required) {
        abort();
    }
    return -1;
}

void dma_channel_unclaim(uint channel)
{
    chip.channels[channel].claimed = false;
}

dma_channel_config dma_channel_get_default_config(uint channel)
{
    return (dma_channel_config){.chain_to = channel, .data_size = 2, .read_increment = true};
}

/* The model supports only what a ring fed by a UART needs. Anything else is a bug of the port. */
void dma_channel_configure(uint channel, const dma_channel_config *config, volatile void *write,
                           const volatile void *read, uint32_t transfer_count, bool begin)
{
    channel_t *const it = &chip.channels[channel];
    if (!it->claimed || it->busy || config->data_size != DMA_SIZE_8 || config->read_increment ||
        !config->write_increment || !config->ring_on_write || transfer_count > COUNT_MAX ||
        read != &chip.uart.hw.taken[0]) {
        abort();
    }
    it->config = *config;
    it->write = (uint8_t *)(uintptr_t)write;
    it->reload = transfer_count;
    it->enabled = true;
    if (begin) {
        trigger(it);
    }
}

/* Time may pass after the count is read: only the next reading shows the change. */
dma_channel_hw_t *dma_channel_hw_addr(uint channel)
{
    channel_t *const it = &chip.channels[channel];
    it->shown.transfer_count = it->count;
    if (chip.pass_after > 0 && --chip.pass_after == 0) {
        machine_pass(chip.pass_us);
    }
    return &it->shown;
}

void dma_channel_cleanup(uint channel)
{
    chip.channels[channel].enabled = false;
    chip.channels[channel].busy = false;
    chip.channels[channel].config.chain_to = channel;
}

void pico_model_move_on(uint32_t bytes)
{
    for (unsigned i = 0; i < CHANNELS; i++) {
        if (is_of_uart(&chip.channels[i])) {
            for (uint32_t j = 0; j < (bytes & 0xFFFFu); j++) {
                write_byte(&chip.channels[i], 0);
            }
            count_down(&chip.channels[i], bytes);
            return;
        }
    }
}

void pico_model_break_dma(void)
{
    for (unsigned i = 0; i < CHANNELS; i++) {
        chip.channels[i].busy = false;
        chip.channels[i].enabled = false;
        chip.channels[i].count = 0;
    }
}

unsigned pico_model_claimed_channels(void)
{
    unsigned claimed = 0;
    for (unsigned i = 0; i < CHANNELS; i++) {
        claimed += chip.channels[i].claimed;
    }
    return claimed;
}

void pico_model_take_channels(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        (void)dma_claim_unused_channel(true);
    }
}

/* ----------------------------------------------------------------------------------------- UART */

/* The UART interrupts at 1/8, 1/4, 1/2, 3/4 or 7/8 of the FIFO's size. */
static unsigned interrupt_level(void)
{
    static const unsigned levels[8] = {4, 8, 16, 24, 28, 28, 28, 28};
    return levels[chip.uart.hw.ifls >> UART_UARTIFLS_RXIFLSEL_LSB & 7u];
}

static bool line_is_up(void)
{
    return chip.irq_enabled[UART_IRQ_NUM(uart1)] && chip.uart.receive_irq &&
           machine_must_read(interrupt_level(), TIMEOUT_US);
}

static void serve_line(void)
{
    chip.handlers[UART_IRQ_NUM(uart1)]();
}

/* Bits written as 1 to ICR are cleared. The model sees this store only at the next access. */
static void clear_status(void)
{
    chip.uart.hw.ris &= ~chip.uart.hw.icr;
    chip.uart.hw.icr = 0;
}

static void arrive(uint32_t flags, uint8_t byte)
{
    uart_model_t *const uart = &chip.uart;
    uart->hw.ris |= (flags & 0xF00u) >> 1;
    if (machine_put(flags | (uart->overrun ? UART_UARTDR_OE_BITS : 0) | byte)) {
        uart->overrun = false;
    } else {
        uart->overrun = true;
        uart->hw.ris |= UART_UARTRIS_OERIS_BITS;
    }
}

void pico_model_begin(const sim_observer_t *observer)
{
    const machine_uart_t uart = {.fifo_size = FIFO_SIZE,
                                 .arrive = arrive,
                                 .move = run_dma,
                                 .is_up = line_is_up,
                                 .serve = serve_line};
    machine_begin(observer, &uart);
    memset(&chip, 0, sizeof chip);
    chip.uart.places_to_send = FIFO_SIZE;
    for (unsigned i = 0; i < PICO_PINS; i++) {
        chip.functions[i] = -1;
        chip.levels[i] = -1;
    }
}

uint uart_init(uart_inst_t *uart, uint baud_rate)
{
    if (uart != uart1) {
        return baud_rate; /* No lidar is on this UART. */
    }
    machine.count = 0;
    chip.uart.hw = (uart_hw_t){.ifls = 2u << UART_UARTIFLS_RXIFLSEL_LSB};
    chip.baud_rate = (unsigned)((int)baud_rate + (int)baud_rate * chip.baud_error_permille / 1000);
    return chip.baud_rate;
}

uint uart_get_index(uart_inst_t *uart)
{
    return uart->index;
}

uart_hw_t *uart_get_hw(uart_inst_t *uart)
{
    if (uart != uart1) {
        abort();
    }
    clear_status();
    return &chip.uart.hw;
}

unsigned pico_model_take_entry(void)
{
    irq_access();
    clear_status();
    if (machine.count > 0) {
        chip.uart.hw.taken[0] = machine_take();
    }
    return 0;
}

bool uart_is_readable(uart_inst_t *uart)
{
    irq_access();
    return uart == uart1 && machine.count > 0;
}

bool uart_is_writable(uart_inst_t *uart)
{
    return uart == uart1 && chip.uart.places_to_send > 0;
}

void uart_putc_raw(uart_inst_t *uart, char byte)
{
    const uint8_t sent = (uint8_t)byte;
    if (!uart_is_writable(uart)) {
        abort(); /* The real function would wait. */
    }
    sim_receive(&machine.lidar, &sent, 1, machine.now_us);
    if (chip.uart.places_to_send < FIFO_SIZE) {
        chip.uart.places_to_send--;
    }
}

void uart_set_irqs_enabled(uart_inst_t *uart, bool rx_has_data, bool tx_needs_data)
{
    (void)tx_needs_data;
    if (uart == uart1) {
        chip.uart.receive_irq = rx_has_data;
    }
    if (rx_has_data) {
        chip.uart.hw.ifls = 0; /* The SDK sets the lowest level. */
    }
    irq_access();
}

uint uart_get_dreq(uart_inst_t *uart, bool is_tx)
{
    return 20u + 2 * uart->index + (is_tx ? 0u : 1u);
}

void hw_write_masked(volatile uint32_t *address, uint32_t values, uint32_t mask)
{
    *address = (*address & ~mask) | (values & mask);
}

/* ----------------------------------------------------------------------------------- interrupts */

bool irq_has_handler(uint number)
{
    return chip.handlers[number] != NULL;
}

void irq_set_exclusive_handler(uint number, irq_handler_t handler)
{
    if (chip.handlers[number] != NULL && chip.handlers[number] != handler) {
        abort(); /* The SDK panics. */
    }
    chip.handlers[number] = handler;
}

void irq_remove_handler(uint number, irq_handler_t handler)
{
    if (chip.handlers[number] == handler) {
        chip.handlers[number] = NULL;
    }
}

void irq_set_enabled(uint number, bool enabled)
{
    chip.irq_enabled[number] = enabled;
    irq_access();
}

void __dmb(void) {}

/* ----------------------------------------------------------------------------------------- time */

absolute_time_t get_absolute_time(void)
{
    return machine.now_us;
}

void sleep_ms(uint32_t ms)
{
    machine_sleep_us(ms * 1000u);
}

uint32_t to_ms_since_boot(absolute_time_t time)
{
    return (uint32_t)(time / 1000u);
}

/* ----------------------------------------------------------------------------- pins and console */

void gpio_init(uint gpio)
{
    chip.levels[gpio] = -1;
    chip.values[gpio] = false;
}

/* A new output has the level that was set even before it was an output. */
void gpio_set_dir(uint gpio, bool out)
{
    chip.levels[gpio] = out ? chip.values[gpio] : -1;
}

void gpio_put(uint gpio, bool value)
{
    chip.values[gpio] = value;
    if (chip.levels[gpio] >= 0) {
        chip.levels[gpio] = value ? 1 : 0;
    }
}

void gpio_set_function(uint gpio, uint function)
{
    chip.functions[gpio] = (int)function;
}

void gpio_pull_up(uint gpio)
{
    chip.pulled_up[gpio] = true;
}

bool stdio_init_all(void)
{
    return true;
}
