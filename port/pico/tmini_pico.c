/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_pico.h"

#include <string.h>

#include "hardware/dma.h"
#include "hardware/gpio.h"
#include "hardware/irq.h"
#include "hardware/sync.h"
#include "pico/time.h"

/* The protocol's section 1. */
#define BAUD_RATE 230400u
#define BAUD_TOLERANCE (BAUD_RATE / 50u)

#define FIFO_SIZE 32u

/* Interrupt at half a FIFO: 820 per second while scanning, and each may come 0.7 ms late. */
#define FIFO_HALF 2u

#define FRAMING_ERROR UART_UARTDR_FE_BITS
#define BREAK_ERROR UART_UARTDR_BE_BITS
#define OVERRUN_ERROR UART_UARTDR_OE_BITS
#define DR_ERRORS (FRAMING_ERROR | BREAK_ERROR | OVERRUN_ERROR)

/* The raw interrupt status has the same three bits in the same order, one bit lower. */
#define RIS_TO_DR (UART_UARTDR_OE_LSB - UART_UARTRIS_OERIS_LSB)
#define RIS_ERRORS (UART_UARTRIS_OERIS_BITS | UART_UARTRIS_BERIS_BITS | UART_UARTRIS_FERIS_BITS)

/* Bytes that one DMA channel transfers before the other takes over: a multiple of every ring's
 * size, so that each turn begins at the ring's beginning; below 2^28, the RP2350's limit. */
#define TURN 0x08000000u

/* This many bytes may be on their way through the DMA controller, written but not counted yet. */
#define IN_FLIGHT 16u

#define CHUNK 64u

/* ---------------------------------------------------------------------------------- line errors */

static void count_errors(tmini_pico_t *port, uint32_t errors)
{
    tmini_pico_counters_t *const counters = &port->counters;
    counters->framing_errors += (errors & (FRAMING_ERROR | BREAK_ERROR)) == FRAMING_ERROR;
    counters->breaks += (errors & BREAK_ERROR) != 0;
    counters->overruns += (errors & OVERRUN_ERROR) != 0;
}

/* ----------------------------------------------------------------------- receiving by interrupt */

/* One for each UART: an interrupt handler has no argument. */
static tmini_pico_t *receivers[2];

/* A byte that comes with an error is stored as well: the parser's checks decide whether it is used.
 * The UART marks the first byte after an overrun: the gap is reported before that byte. */
static void empty_fifo(tmini_pico_t *port)
{
    while (uart_is_readable(port->uart)) {
        const uint32_t entry = uart_get_hw(port->uart)->dr;
        if ((entry & DR_ERRORS) != 0) {
            count_errors(port, entry);
        }
        if ((entry & OVERRUN_ERROR) != 0) {
            tmini_feed_gap(port->lidar);
        }
        tmini_feed_byte(port->lidar, (uint8_t)entry);
        port->counters.bytes++;
    }
}

static void receive_uart0(void)
{
    empty_fifo(receivers[0]);
}

static void receive_uart1(void)
{
    empty_fifo(receivers[1]);
}

static irq_handler_t handler_of(const tmini_pico_t *port)
{
    return uart_get_index(port->uart) == 0 ? receive_uart0 : receive_uart1;
}

static void ask_for_interrupts(const tmini_pico_t *port)
{
    uart_set_irqs_enabled(port->uart, true, false);
    hw_write_masked(&uart_get_hw(port->uart)->ifls, FIFO_HALF << UART_UARTIFLS_RXIFLSEL_LSB,
                    UART_UARTIFLS_RXIFLSEL_BITS);
}

static tmini_status_t start_interrupt(tmini_pico_t *port)
{
    const uint irq = UART_IRQ_NUM(port->uart);
    if (irq_has_handler(irq)) {
        return TMINI_ERROR_STATE;
    }
    receivers[uart_get_index(port->uart)] = port;
    irq_set_exclusive_handler(irq, handler_of(port));
    irq_set_enabled(irq, true);
    ask_for_interrupts(port);
    return TMINI_OK;
}

static void stop_interrupt(tmini_pico_t *port)
{
    const uint irq = UART_IRQ_NUM(port->uart);
    uart_set_irqs_enabled(port->uart, false, false);
    irq_set_enabled(irq, false);
    irq_remove_handler(irq, handler_of(port));
}

/* ----------------------------------------------------------------------------- receiving by DMA */

static uint32_t left_to_transfer(uint8_t channel)
{
    return dma_channel_hw_addr(channel)->transfer_count;
}

/* Bytes that DMA has written since the start, modulo TURN. The active channel counts down to 0; the
 * other one is at 0. Between two turns both are at 0 for a moment. If they stay there, DMA has been
 * stopped, and the number is unknown. */
static bool read_written(const tmini_pico_t *port, uint32_t *written)
{
    for (unsigned attempt = 0; attempt < 8; attempt++) {
        const uint32_t left = left_to_transfer(port->channels[attempt % 2]);
        if (left != 0) {
            *written = TURN - left;
            return true;
        }
    }
    return false;
}

/* Reads how many bytes DMA has written that were not taken yet. False if this is unknown. */
static bool read_unread(const tmini_pico_t *port, uint32_t *unread)
{
    uint32_t written;
    if (!read_written(port, &written)) {
        return false;
    }
    *unread = (written - port->taken) & (TURN - 1);
    return true;
}

/* True if DMA has not yet overwritten the oldest of `unread` bytes. */
static bool is_intact(const tmini_pico_t *port, uint32_t unread)
{
    return unread + IN_FLIGHT <= port->ring_size;
}

/* Skips all unread bytes except the newest `kept`, and reports the gap to the lidar. The lidar
 * takes nothing more until it has processed its bytes from before the gap; later calls pass on the
 * rest. */
static void pass_over(tmini_pico_t *port, uint32_t unread, uint32_t kept)
{
    port->taken += unread - kept;
    port->counters.bytes_lost += unread - kept;
    tmini_feed_gap(port->lidar);
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Copies the oldest unread bytes, up to CHUNK; returns how many. Then reads DMA's position again,
 * because this function may have been interrupted for any length of time; returns 0 if the bytes
 * may have been overwritten. */
static size_t copy_oldest(const tmini_pico_t *port, uint32_t unread, uint8_t *chunk)
{
    const size_t at = port->taken & (port->ring_size - 1);
    const size_t to_end = port->ring_size - at;
    const size_t room = tmini_feed_room(port->lidar);
    const size_t count = least(least(unread, room), least(to_end, CHUNK));
    memcpy(chunk, &port->ring[at], count);
    __dmb();
    return read_unread(port, &unread) && is_intact(port, unread) ? count : 0;
}

/* Passes on the bytes that the lidar has room for; the rest stays in the ring. If DMA has
 * overwritten unread bytes, the newer half of the ring is kept. */
static size_t empty_ring(tmini_pico_t *port)
{
    uint8_t chunk[CHUNK];
    uint32_t unread;
    size_t received = 0;
    while (read_unread(port, &unread)) {
        if (!is_intact(port, unread)) {
            pass_over(port, unread, port->ring_size / 2);
            break;
        }
        __dmb();
        const size_t count = copy_oldest(port, unread, chunk);
        if (count == 0) {
            tmini_feed_held(port->lidar, unread);
            break;
        }
        tmini_feed(port->lidar, chunk, count);
        port->taken += (uint32_t)count;
        received += count;
    }
    port->counters.bytes += (uint32_t)received;
    return received;
}

/* DMA does not store the error bits of a byte, but the UART remembers that there were errors. An
 * overrun is at an unknown place among the unread bytes, so none of them is used. */
static void look_at_errors(tmini_pico_t *port)
{
    uart_hw_t *const hw = uart_get_hw(port->uart);
    const uint32_t errors = hw->ris & RIS_ERRORS;
    uint32_t unread;
    if (errors != 0) {
        hw->icr = errors;
        count_errors(port, errors << RIS_TO_DR);
    }
    if ((errors & UART_UARTRIS_OERIS_BITS) != 0 && read_unread(port, &unread)) {
        pass_over(port, unread, 0);
    }
}

static bool claim_channels(tmini_pico_t *port)
{
    const int first = dma_claim_unused_channel(false);
    const int second = dma_claim_unused_channel(false);
    if (second < 0) {
        if (first >= 0) {
            dma_channel_unclaim((uint)first);
        }
        return false;
    }
    port->channels[0] = (uint8_t)first;
    port->channels[1] = (uint8_t)second;
    return true;
}

static void configure_channel(const tmini_pico_t *port, unsigned index, bool begins)
{
    const uint channel = port->channels[index];
    dma_channel_config config = dma_channel_get_default_config(channel);
    channel_config_set_transfer_data_size(&config, DMA_SIZE_8);
    channel_config_set_read_increment(&config, false);
    channel_config_set_write_increment(&config, true);
    channel_config_set_ring(&config, true, (uint)__builtin_ctz((unsigned)port->ring_size));
    channel_config_set_dreq(&config, uart_get_dreq(port->uart, false));
    channel_config_set_chain_to(&config, port->channels[1 - index]);
    dma_channel_configure(channel, &config, port->ring, &uart_get_hw(port->uart)->dr, TURN, begins);
}

static void begin_dma(tmini_pico_t *port)
{
    port->taken = 0;
    configure_channel(port, 1, false);
    configure_channel(port, 0, true);
}

static tmini_status_t start_dma(tmini_pico_t *port)
{
    if (!claim_channels(port)) {
        return TMINI_ERROR_STATE;
    }
    begin_dma(port);
    return TMINI_OK;
}

/* dma_channel_cleanup() unchains a channel before it aborts it: an abort must not start the
 * other. */
static void end_dma(const tmini_pico_t *port)
{
    dma_channel_cleanup(port->channels[0]);
    dma_channel_cleanup(port->channels[1]);
}

static void stop_dma(const tmini_pico_t *port)
{
    end_dma(port);
    dma_channel_unclaim(port->channels[0]);
    dma_channel_unclaim(port->channels[1]);
}

/* After a bus error a channel does not continue by itself. */
static void restart_dma(tmini_pico_t *port)
{
    end_dma(port);
    begin_dma(port);
    tmini_feed_gap(port->lidar);
}

/* ------------------------------------------------------------------------------- start and stop */

/* GPIO 0 to 3 are UART0's, 4 to 11 UART1's, 12 to 19 UART0's, and so on. Of each four the first two
 * are TX and RX; RP2350 can have them on the other two as well. */
static bool has_pin(uart_inst_t *uart, uint pin, uint place)
{
    const bool is_of_uart = ((pin + 4) / 8) % 2 == uart_get_index(uart);
#if PICO_RP2040
    return pin < NUM_BANK0_GPIOS && is_of_uart && pin % 4 == place;
#else
    return pin < NUM_BANK0_GPIOS && is_of_uart && pin % 2 == place;
#endif
}

static bool is_good_ring(const uint8_t *ring, size_t size)
{
    return size >= TMINI_PICO_RING_MIN && size <= TMINI_PICO_RING_MAX && (size & (size - 1)) == 0 &&
           ((uintptr_t)ring & (size - 1)) == 0;
}

static bool is_good_wiring(const tmini_pico_wiring_t *wiring)
{
    return wiring->uart != NULL && has_pin(wiring->uart, wiring->tx_pin, 0) &&
           has_pin(wiring->uart, wiring->rx_pin, 1) &&
           (wiring->ring == NULL || is_good_ring(wiring->ring, wiring->ring_size));
}

tmini_status_t tmini_pico_init(tmini_pico_t *port, const tmini_pico_wiring_t *wiring)
{
    if (port == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *port = (tmini_pico_t){0};
    if (wiring == NULL || !is_good_wiring(wiring)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const uint baud_rate = uart_init(wiring->uart, BAUD_RATE); /* 8N1, with FIFOs. */
    if (baud_rate < BAUD_RATE - BAUD_TOLERANCE || baud_rate > BAUD_RATE + BAUD_TOLERANCE) {
        return TMINI_ERROR_STATE;
    }
    gpio_set_function(wiring->tx_pin, UART_FUNCSEL_NUM(wiring->uart, wiring->tx_pin));
    gpio_set_function(wiring->rx_pin, UART_FUNCSEL_NUM(wiring->uart, wiring->rx_pin));
    gpio_pull_up(wiring->rx_pin); /* Without a lidar the line is idle, not noisy. */
    port->ring = wiring->ring;
    port->ring_size = (uint32_t)wiring->ring_size;
    port->uart = wiring->uart;
    return TMINI_OK;
}

static void drop_received(tmini_pico_t *port)
{
    uart_hw_t *const hw = uart_get_hw(port->uart);
    for (unsigned i = 0; i < FIFO_SIZE && uart_is_readable(port->uart); i++) {
        (void)hw->dr;
    }
    hw->icr = RIS_ERRORS;
}

tmini_status_t tmini_pico_start(tmini_pico_t *port, tmini_t *lidar)
{
    if (port == NULL || lidar == NULL || port->uart == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (port->lidar != NULL) {
        return TMINI_ERROR_STATE;
    }
    port->counters = (tmini_pico_counters_t){0};
    port->taken = 0;
    drop_received(port);
    port->lidar = lidar;
    const tmini_status_t status = port->ring == NULL ? start_interrupt(port) : start_dma(port);
    if (status != TMINI_OK) {
        port->lidar = NULL;
    }
    return status;
}

/* Only counts bytes: the interrupt has already handed them to the lidar. */
static size_t stored_by_interrupt(tmini_pico_t *port)
{
    const uint32_t bytes = port->counters.bytes;
    const size_t stored = bytes - port->taken;
    port->taken = bytes;
    return stored;
}

static size_t receive(tmini_pico_t *port)
{
    if (port->ring == NULL) {
        return stored_by_interrupt(port);
    }
    look_at_errors(port);
    return empty_ring(port);
}

size_t tmini_pico_wait(tmini_pico_t *port, uint32_t timeout_ms)
{
    if (port == NULL || port->lidar == NULL) {
        return 0;
    }
    size_t received = receive(port);
    for (uint32_t waited_ms = 0; received == 0 && waited_ms < timeout_ms; waited_ms++) {
        sleep_ms(1);
        received = receive(port);
    }
    return received;
}

void tmini_pico_stop(tmini_pico_t *port)
{
    if (port == NULL || port->lidar == NULL) {
        return;
    }
    if (port->ring == NULL) {
        stop_interrupt(port);
    } else {
        stop_dma(port);
    }
    port->lidar = NULL;
}

void tmini_pico_counters(const tmini_pico_t *port, tmini_pico_counters_t *counters)
{
    *counters = port->counters;
}

/* ------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_pico_t *const port = context;
    if (port->uart == NULL) {
        return -1;
    }
    int taken = 0;
    while ((size_t)taken < count && uart_is_writable(port->uart)) {
        uart_putc_raw(port->uart, (char)bytes[taken]);
        taken++;
    }
    return taken;
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return to_ms_since_boot(get_absolute_time());
}

static void port_wait(void *context)
{
    (void)tmini_pico_wait(context, 1);
}

static void port_restart(void *context)
{
    tmini_pico_t *const port = context;
    if (port->lidar == NULL) {
        return;
    }
    if (port->ring == NULL) {
        ask_for_interrupts(port);
    } else {
        restart_dma(port);
    }
}

const tmini_port_t tmini_pico_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait, .restart = port_restart};
