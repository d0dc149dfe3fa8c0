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

/* Interrupt at half a FIFO: 820 a second while scanning, and each may come 0.7 ms late. */
#define FIFO_HALF 2u

#define FRAMING_ERROR UART_UARTDR_FE_BITS
#define BREAK_ERROR UART_UARTDR_BE_BITS
#define OVERRUN_ERROR UART_UARTDR_OE_BITS
#define DR_ERRORS (FRAMING_ERROR | BREAK_ERROR | OVERRUN_ERROR)

/* Raw interrupt status has the same three in the same order, one bit further down. */
#define RIS_TO_DR (UART_UARTDR_OE_LSB - UART_UARTRIS_OERIS_LSB)
#define RIS_ERRORS (UART_UARTRIS_OERIS_BITS | UART_UARTRIS_BERIS_BITS | UART_UARTRIS_FERIS_BITS)

/* What one DMA channel transfers before the other takes over: a multiple of every ring's size, so
 * that the other begins where the ring began, and below the 2^28 that RP2350 can count. */
#define TURN 0x08000000u
#define COUNT_MASK (2 * TURN - 1)

/* So many bytes may be on their way through the DMA controller, written but not counted yet. */
#define IN_FLIGHT 16u

#define CHUNK 64u

/* ---------------------------------------------------------------------------------- line errors */

/* Counts errors by the bits of the data register. */
static void count_errors(tmini_pico_t *board, uint32_t errors)
{
    tmini_pico_counters_t *const counters = &board->counters;
    counters->framing_errors += (errors & (FRAMING_ERROR | BREAK_ERROR)) == FRAMING_ERROR;
    counters->breaks += (errors & BREAK_ERROR) != 0;
    counters->overruns += (errors & OVERRUN_ERROR) != 0;
}

/* ----------------------------------------------------------------------- receiving by interrupt */

/* One for each UART: an interrupt handler has no argument. */
static tmini_pico_t *receivers[2];

/* A byte that comes with an error is stored as well: the parser's checks decide what it is worth.
 * The UART marks the first byte behind an overrun: the lidar is told of the gap before it gets that
 * one. */
static void empty_fifo(tmini_pico_t *board)
{
    while (uart_is_readable(board->uart)) {
        const uint32_t entry = uart_get_hw(board->uart)->dr;
        if ((entry & DR_ERRORS) != 0) {
            count_errors(board, entry);
        }
        if ((entry & OVERRUN_ERROR) != 0) {
            tmini_feed_gap(board->lidar);
        }
        tmini_feed_byte(board->lidar, (uint8_t)entry);
        board->counters.bytes++;
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

static irq_handler_t handler_of(const tmini_pico_t *board)
{
    return uart_get_index(board->uart) == 0 ? receive_uart0 : receive_uart1;
}

static tmini_status_t start_interrupt(tmini_pico_t *board)
{
    const uint irq = UART_IRQ_NUM(board->uart);
    if (irq_has_handler(irq)) {
        return TMINI_ERROR_STATE;
    }
    receivers[uart_get_index(board->uart)] = board;
    irq_set_exclusive_handler(irq, handler_of(board));
    irq_set_enabled(irq, true);
    uart_set_irqs_enabled(board->uart, true, false);
    hw_write_masked(&uart_get_hw(board->uart)->ifls, FIFO_HALF << UART_UARTIFLS_RXIFLSEL_LSB,
                    UART_UARTIFLS_RXIFLSEL_BITS);
    return TMINI_OK;
}

static void stop_interrupt(tmini_pico_t *board)
{
    const uint irq = UART_IRQ_NUM(board->uart);
    uart_set_irqs_enabled(board->uart, false, false);
    irq_set_enabled(irq, false);
    irq_remove_handler(irq, handler_of(board));
}

/* ----------------------------------------------------------------------------- receiving by DMA */

static uint32_t left_to_transfer(uint8_t channel)
{
    return dma_channel_hw_addr(channel)->transfer_count;
}

/* Bytes that DMA has written since the start, modulo 2 TURN: whole laps of the ring included. The
 * channel whose turn it is counts down to 0, and the other one stands at 0. Both do only for the
 * moment between two turns; should that last, because DMA has been stopped, there is no telling. */
static bool read_written(const tmini_pico_t *board, uint32_t *written)
{
    for (unsigned attempt = 0; attempt < 4; attempt++) {
        const uint32_t first = left_to_transfer(board->channels[0]);
        if (first != 0) {
            *written = TURN - first;
            return true;
        }
        const uint32_t second = left_to_transfer(board->channels[1]);
        if (second != 0) {
            *written = 2 * TURN - second;
            return true;
        }
    }
    return false;
}

/* False if it cannot be told. */
static bool read_unread(const tmini_pico_t *board, uint32_t *unread)
{
    uint32_t written;
    if (!read_written(board, &written)) {
        return false;
    }
    *unread = (written - board->taken) & COUNT_MASK;
    return true;
}

/* Whether DMA has not come round yet to the oldest of `unread` bytes. */
static bool is_intact(const tmini_pico_t *board, uint32_t unread)
{
    return unread + IN_FLIGHT <= board->ring_size;
}

/* Passes over all unread bytes but the newest `kept`. The lidar is told, and takes nothing more
 * before it has dealt with what it had from before the gap: the next polls go on. */
static void pass_over(tmini_pico_t *board, uint32_t unread, uint32_t kept)
{
    board->taken += unread - kept;
    board->counters.bytes_lost += unread - kept;
    tmini_feed_gap(board->lidar);
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Copies the oldest unread bytes, up to CHUNK; returns how many. None are certain until DMA's
 * position has been read once more behind the copy: we may have been held up meanwhile, for any
 * length of time. */
static size_t copy_oldest(const tmini_pico_t *board, uint32_t unread, uint8_t *chunk)
{
    const size_t at = board->taken & (board->ring_size - 1);
    const size_t to_end = board->ring_size - at;
    const size_t room = tmini_feed_room(board->lidar);
    const size_t count = least(least(unread, room), least(to_end, CHUNK));
    memcpy(chunk, &board->ring[at], count);
    __dmb();
    return read_unread(board, &unread) && is_intact(board, unread) ? count : 0;
}

/* Hands on what has come, as far as the lidar has room for it; the rest stays in the ring. Where
 * DMA has come round, the newer half of what the ring holds is kept. */
static size_t empty_ring(tmini_pico_t *board)
{
    uint8_t chunk[CHUNK];
    uint32_t unread;
    size_t received = 0;
    while (read_unread(board, &unread)) {
        if (!is_intact(board, unread)) {
            pass_over(board, unread, board->ring_size / 2);
            break;
        }
        __dmb();
        const size_t count = copy_oldest(board, unread, chunk);
        if (count == 0) {
            break;
        }
        tmini_feed(board->lidar, chunk, count);
        board->taken += (uint32_t)count;
        received += count;
    }
    board->counters.bytes += (uint32_t)received;
    return received;
}

/* DMA does not see the errors that come with a byte, but the UART remembers that there were some.
 * An overrun is somewhere among the unread bytes, and nobody knows where: none of them is used. */
static void look_at_errors(tmini_pico_t *board)
{
    uart_hw_t *const hw = uart_get_hw(board->uart);
    const uint32_t errors = hw->ris & RIS_ERRORS;
    uint32_t unread;
    if (errors != 0) {
        hw->icr = errors;
        count_errors(board, errors << RIS_TO_DR);
    }
    if ((errors & UART_UARTRIS_OERIS_BITS) != 0 && read_unread(board, &unread)) {
        pass_over(board, unread, 0);
    }
}

static bool claim_channels(tmini_pico_t *board)
{
    const int first = dma_claim_unused_channel(false);
    const int second = dma_claim_unused_channel(false);
    if (second < 0) {
        if (first >= 0) {
            dma_channel_unclaim((uint)first);
        }
        return false;
    }
    board->channels[0] = (uint8_t)first;
    board->channels[1] = (uint8_t)second;
    return true;
}

/* When its turn ends, the other channel begins. */
static void configure_channel(const tmini_pico_t *board, unsigned index, bool begins)
{
    const uint channel = board->channels[index];
    dma_channel_config config = dma_channel_get_default_config(channel);
    channel_config_set_transfer_data_size(&config, DMA_SIZE_8);
    channel_config_set_read_increment(&config, false);
    channel_config_set_write_increment(&config, true);
    channel_config_set_ring(&config, true, (uint)__builtin_ctz((unsigned)board->ring_size));
    channel_config_set_dreq(&config, uart_get_dreq(board->uart, false));
    channel_config_set_chain_to(&config, board->channels[1 - index]);
    dma_channel_configure(channel, &config, board->ring, &uart_get_hw(board->uart)->dr, TURN,
                          begins);
}

static tmini_status_t start_dma(tmini_pico_t *board)
{
    if (!claim_channels(board)) {
        return TMINI_ERROR_STATE;
    }
    board->taken = 0;
    configure_channel(board, 1, false);
    configure_channel(board, 0, true);
    return TMINI_OK;
}

/* dma_channel_cleanup() unchains a channel before it aborts it: an abort must not start the
 * other. */
static void stop_dma(tmini_pico_t *board)
{
    for (unsigned i = 0; i < 2; i++) {
        dma_channel_cleanup(board->channels[i]);
        dma_channel_unclaim(board->channels[i]);
    }
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

tmini_status_t tmini_pico_init(tmini_pico_t *board, const tmini_pico_wiring_t *wiring)
{
    if (board == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *board = (tmini_pico_t){0};
    if (wiring == NULL || !is_good_wiring(wiring)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const uint baud_rate = uart_init(wiring->uart, BAUD_RATE); /* 8N1, with FIFOs. */
    if (baud_rate < BAUD_RATE - BAUD_TOLERANCE || baud_rate > BAUD_RATE + BAUD_TOLERANCE) {
        return TMINI_ERROR_STATE;
    }
    gpio_set_function(wiring->tx_pin, UART_FUNCSEL_NUM(wiring->uart, wiring->tx_pin));
    gpio_set_function(wiring->rx_pin, UART_FUNCSEL_NUM(wiring->uart, wiring->rx_pin));
    gpio_pull_up(wiring->rx_pin); /* The line is idle, not noisy, while no lidar is plugged in. */
    board->ring = wiring->ring;
    board->ring_size = (uint32_t)wiring->ring_size;
    board->uart = wiring->uart;
    return TMINI_OK;
}

static void drop_received(tmini_pico_t *board)
{
    uart_hw_t *const hw = uart_get_hw(board->uart);
    for (unsigned i = 0; i < FIFO_SIZE && uart_is_readable(board->uart); i++) {
        (void)hw->dr;
    }
    hw->icr = RIS_ERRORS;
}

tmini_status_t tmini_pico_start(tmini_pico_t *board, tmini_t *lidar)
{
    if (board == NULL || lidar == NULL || board->uart == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (board->lidar != NULL) {
        return TMINI_ERROR_STATE;
    }
    board->counters = (tmini_pico_counters_t){0};
    drop_received(board);
    board->lidar = lidar;
    const tmini_status_t status = board->ring == NULL ? start_interrupt(board) : start_dma(board);
    if (status != TMINI_OK) {
        board->lidar = NULL;
    }
    return status;
}

size_t tmini_pico_receive(tmini_pico_t *board)
{
    if (board == NULL || board->lidar == NULL || board->ring == NULL) {
        return 0;
    }
    look_at_errors(board);
    return empty_ring(board);
}

void tmini_pico_stop(tmini_pico_t *board)
{
    if (board == NULL || board->lidar == NULL) {
        return;
    }
    if (board->ring == NULL) {
        stop_interrupt(board);
    } else {
        stop_dma(board);
    }
    board->lidar = NULL;
}

void tmini_pico_counters(const tmini_pico_t *board, tmini_pico_counters_t *counters)
{
    *counters = board->counters;
}

/* ------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_pico_t *const board = context;
    if (board->uart == NULL) {
        return -1;
    }
    int taken = 0;
    while ((size_t)taken < count && uart_is_writable(board->uart)) {
        uart_putc_raw(board->uart, (char)bytes[taken]);
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
    sleep_ms(1);
    (void)tmini_pico_receive(context);
}

const tmini_port_t tmini_pico_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait};
