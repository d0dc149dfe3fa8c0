/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "pico_model.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console.h"
#include "hardware/dma.h"
#include "hardware/sync.h"
#include "irq_lines.h"
#include "pico/stdlib.h"
#include "random.h"

#define STEP_US 20u
#define FIFO_SIZE 32u
#define CHANNELS 12u
#define IRQS 64u
#define TIMEOUT_US 139u /* 32 bits at 230400 baud. */
#define DREQ_UART1_RX 23u
#define COUNT_MAX 0x0FFFFFFFu /* RP2350's count has 28 bits; the higher bits are a mode. */

struct uart_inst {
    unsigned index;
};

typedef struct {
    uint16_t entries[FIFO_SIZE];
    unsigned count;
    bool overrun; /* The next entry gets the overrun flag. */
    uint64_t last_us;
    bool receive_irq;
    unsigned places_to_send;
    uart_hw_t hw;
} uart_model_t;

typedef struct {
    bool claimed;
    bool busy;
    bool enabled;
    dma_channel_config config;
    uint8_t *write;
    const volatile void *read;
    uint32_t reload;
    uint32_t count;
    dma_channel_hw_t shown;
} channel_t;

static struct uart_inst uarts[2] = {{0}, {1}};
uart_inst_t *const pico_uarts[2] = {&uarts[0], &uarts[1]};

static struct {
    sim_t lidar;
    uint64_t now_us;
    uart_model_t uart;
    channel_t channels[CHANNELS];
    bool dma_blocked;
    irq_handler_t handlers[IRQS];
    bool irq_enabled[IRQS];
    uint32_t line_bytes;
    unsigned baud_rate;
    int baud_error_permille;
    unsigned reads;
    unsigned changes_of_channel;
    unsigned pass_after;
    uint32_t pass_us;
    bool erratic;
    random_t random;
    int functions[PICO_PINS];
    int levels[PICO_PINS];
    bool values[PICO_PINS]; /* Bits of the output registers. */
    bool pulled_up[PICO_PINS];
    void (*on_sleep)(void);
} chip;

static bool line_is_up(void);
static void serve_line(void);
static void fail(unsigned line);

void pico_model_begin(const sim_observer_t *observer)
{
    console_begin();
    memset(&chip, 0, sizeof chip);
    const sim_config_t config = sim_default_config();
    sim_init(&chip.lidar, &config);
    sim_observe(&chip.lidar, observer);
    chip.uart.places_to_send = FIFO_SIZE;
    irq_reset(fail);
    irq.lines[0] = (irq_line_t){.is_up = line_is_up, .handler = serve_line};
    for (unsigned i = 0; i < PICO_PINS; i++) {
        chip.functions[i] = -1;
        chip.levels[i] = -1;
    }
}

sim_t *pico_model_lidar(void)
{
    return &chip.lidar;
}

uint64_t pico_model_now_us(void)
{
    return chip.now_us;
}

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

static uint16_t take_entry(void)
{
    const uint16_t entry = chip.uart.entries[0];
    chip.uart.count--;
    memmove(chip.uart.entries, &chip.uart.entries[1], chip.uart.count * sizeof(uint16_t));
    return entry;
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
        while (is_of_uart(channel) && chip.uart.count > 0) {
            write_byte(channel, (uint8_t)take_entry());
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

void channel_config_set_transfer_data_size(dma_channel_config *config, int size)
{
    config->data_size = (uint)size;
}

void channel_config_set_read_increment(dma_channel_config *config, bool increment)
{
    config->read_increment = increment;
}

void channel_config_set_write_increment(dma_channel_config *config, bool increment)
{
    config->write_increment = increment;
}

void channel_config_set_ring(dma_channel_config *config, bool write, uint size_bits)
{
    config->ring_on_write = write;
    config->ring_bits = size_bits;
}

void channel_config_set_dreq(dma_channel_config *config, uint dreq)
{
    config->dreq = dreq;
}

void channel_config_set_chain_to(dma_channel_config *config, uint chain_to)
{
    config->chain_to = chain_to;
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

static void pass_erratically(void)
{
    if (random_below(&chip.random, 100) != 0) {
        pico_model_pass(random_below(&chip.random, 4) * 100u);
    } else {
        pico_model_pass(random_below(&chip.random, 250000)); /* Up to 5 laps of 1024 bytes. */
    }
}

/* Time may pass after the count is read: only the next reading shows the change. */
dma_channel_hw_t *dma_channel_hw_addr(uint channel)
{
    channel_t *const it = &chip.channels[channel];
    it->shown.transfer_count = it->count;
    chip.reads++;
    if (chip.pass_after > 0 && --chip.pass_after == 0) {
        pico_model_pass(chip.pass_us);
    } else if (chip.erratic) {
        pass_erratically();
    }
    return &it->shown;
}

void dma_channel_cleanup(uint channel)
{
    chip.channels[channel].enabled = false;
    chip.channels[channel].busy = false;
    chip.channels[channel].config.chain_to = channel;
}

void pico_model_pass_after_read(unsigned reads, uint32_t us)
{
    chip.pass_after = reads;
    chip.pass_us = us;
}

void pico_model_be_erratic(uint64_t seed)
{
    chip.erratic = true;
    random_seed(&chip.random, seed);
}

unsigned pico_model_changes_of_channel(void)
{
    return chip.changes_of_channel;
}

unsigned pico_model_reads(void)
{
    return chip.reads;
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

void pico_model_block_dma(bool blocked)
{
    chip.dma_blocked = blocked;
}

unsigned pico_model_claimed_channels(void)
{
    unsigned claimed = 0;
    for (unsigned i = 0; i < CHANNELS; i++) {
        claimed += chip.channels[i].claimed;
    }
    return claimed;
}

bool pico_model_is_claimed(unsigned channel)
{
    return chip.channels[channel].claimed;
}

void pico_model_take_channels(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        (void)dma_claim_unused_channel(true);
    }
}

/* ----------------------------------------------------------------------------------------- UART */

static void receive_byte(uint32_t flags, uint8_t byte)
{
    uart_model_t *const uart = &chip.uart;
    chip.line_bytes++;
    uart->last_us = chip.now_us;
    uart->hw.ris |= (flags & 0xF00u) >> 1;
    if (uart->count == FIFO_SIZE) {
        uart->overrun = true;
        uart->hw.ris |= UART_UARTRIS_OERIS_BITS;
        return;
    }
    if (uart->overrun) {
        flags |= UART_UARTDR_OE_BITS;
        uart->overrun = false;
    }
    uart->entries[uart->count++] = (uint16_t)(flags | byte);
}

void pico_model_receive(uint32_t flags, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        receive_byte(flags, bytes[i]);
        run_dma();
    }
}

uint32_t pico_model_line_bytes(void)
{
    return chip.line_bytes;
}

/* The UART interrupts at 1/8, 1/4, 1/2, 3/4 or 7/8 of the FIFO's size. */
static unsigned interrupt_level(void)
{
    static const unsigned levels[8] = {4, 8, 16, 24, 28, 28, 28, 28};
    return levels[chip.uart.hw.ifls >> UART_UARTIFLS_RXIFLSEL_LSB & 7u];
}

static bool wants_interrupt(void)
{
    const uart_model_t *const uart = &chip.uart;
    const bool timed_out = uart->count > 0 && chip.now_us - uart->last_us >= TIMEOUT_US;
    return uart->receive_irq && (uart->count >= interrupt_level() || timed_out);
}

static bool line_is_up(void)
{
    return chip.irq_enabled[UART_IRQ_NUM(uart1)] && wants_interrupt();
}

static void serve_line(void)
{
    chip.handlers[UART_IRQ_NUM(uart1)]();
}

static void fail(unsigned line)
{
    (void)line;
    abort(); /* The handler left its flag set: a lock-up. */
}

/* Interrupts also come at accesses to the library's indices. */
void interrupt(void)
{
    irq_access();
}

/* Bits written as 1 to ICR are cleared. The model sees this store only at the next access. */
static void clear_status(void)
{
    chip.uart.hw.ris &= ~chip.uart.hw.icr;
    chip.uart.hw.icr = 0;
}

uint uart_init(uart_inst_t *uart, uint baud_rate)
{
    if (uart != uart1) {
        return baud_rate; /* No lidar is on this UART. */
    }
    chip.uart.count = 0;
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
    if (chip.uart.count > 0) {
        chip.uart.hw.taken[0] = take_entry();
    }
    return 0;
}

bool uart_is_readable(uart_inst_t *uart)
{
    irq_access();
    return uart == uart1 && chip.uart.count > 0;
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
    sim_receive(&chip.lidar, &sent, 1, chip.now_us);
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

void pico_model_set_baud_error(int permille)
{
    chip.baud_error_permille = permille;
}

void pico_model_fill_transmitter(unsigned places_left)
{
    chip.uart.places_to_send = places_left;
}

unsigned pico_model_baud_rate(void)
{
    return chip.baud_rate;
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

static void handle_for_somebody_else(void) {}

void pico_model_take_interrupt(unsigned number)
{
    chip.handlers[number] = handle_for_somebody_else;
}

bool pico_model_is_interrupt_enabled(unsigned number)
{
    return chip.irq_enabled[number];
}

bool pico_model_has_handler(void)
{
    return chip.handlers[UART_IRQ_NUM(uart1)] != NULL;
}

bool pico_model_asks_for_interrupts(void)
{
    return chip.uart.receive_irq;
}

unsigned pico_model_interrupts(void)
{
    return irq.lines[0].served;
}

/* ----------------------------------------------------------------------------------------- time */

void pico_model_pass(uint32_t us)
{
    const uint64_t end_us = chip.now_us + us;
    while (chip.now_us < end_us) {
        uint8_t byte;
        chip.now_us += end_us - chip.now_us < STEP_US ? end_us - chip.now_us : STEP_US;
        while (sim_transmit(&chip.lidar, chip.now_us, &byte, 1) == 1) {
            receive_byte(0, byte);
            run_dma();
            irq_serve();
        }
        run_dma();
        irq_serve();
    }
}

void pico_model_pass_held_up(uint32_t us)
{
    irq.masked = true;
    pico_model_pass(us);
    irq.masked = false;
    irq_serve();
}

absolute_time_t get_absolute_time(void)
{
    return chip.now_us;
}

uint32_t to_ms_since_boot(absolute_time_t time)
{
    return (uint32_t)(time / 1000u);
}

void sleep_ms(uint32_t ms)
{
    pico_model_pass(ms * 1000u);
    if (chip.on_sleep != NULL) {
        chip.on_sleep();
    }
}

void pico_model_on_sleep(void (*callback)(void))
{
    chip.on_sleep = callback;
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

int pico_model_function(unsigned pin)
{
    return chip.functions[pin];
}

bool pico_model_is_pulled_up(unsigned pin)
{
    return chip.pulled_up[pin];
}

int pico_model_level(unsigned pin)
{
    return chip.levels[pin];
}

bool stdio_init_all(void)
{
    return true;
}

int pico_model_printf(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = console_print(pico_model_now_us(), format, arguments);
    va_end(arguments);
    return length;
}
