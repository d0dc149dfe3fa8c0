/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_zephyr.h"

#include <errno.h>
#include <stdbool.h>

#include <zephyr/drivers/uart.h>

/* The protocol's section 1. */
#define BAUD_RATE 230400

#define CHUNK 32

/* The result of a function that has none in old versions of Zephyr: there 0. Whatever compiles so
 * old a Zephyr knows GCC's built-ins. */
#ifdef __GNUC__
#define RESULT_OR_0(call) \
    __builtin_choose_expr(__builtin_types_compatible_p(__typeof__(call), void), ((call), 0), (call))
#else
#define RESULT_OR_0(call) (call)
#endif

/* ------------------------------------------------------------------------------------ receiving */

/* Counts the errors since the last call; true if bytes were lost. Negative: the driver cannot
 * tell. */
static bool has_lost_bytes(tmini_zephyr_t *board)
{
    const int errors = uart_err_check(board->uart);
    if (errors <= 0) {
        return false;
    }
    board->counters.overruns += (errors & UART_ERROR_OVERRUN) != 0;
    board->counters.framing_errors += (errors & UART_ERROR_FRAMING) != 0;
    board->counters.breaks += (errors & UART_BREAK) != 0;
    return (errors & UART_ERROR_OVERRUN) != 0;
}

/* Tells the lidar at once: with some drivers clearing an error takes the byte away as well, and
 * there is nothing left to read. Once bytes were lost, the rest of this interrupt's is not used. */
static bool tell_losses(tmini_zephyr_t *board, bool lost_before)
{
    const bool lost = has_lost_bytes(board) || lost_before;
    if (lost) {
        tmini_feed_gap(board->lidar);
    }
    return lost;
}

/* Whether bytes were lost is asked before reading, because reading clears the error with some
 * drivers, and again behind it, because they may have been lost among those just read. */
static uint32_t empty_fifo(tmini_zephyr_t *board)
{
    uint8_t chunk[CHUNK];
    uint32_t received = 0;
    bool lost = tell_losses(board, false);
    while (uart_irq_rx_ready(board->uart) > 0) {
        const int count = uart_fifo_read(board->uart, chunk, sizeof chunk);
        if (count <= 0) {
            break;
        }
        lost = tell_losses(board, lost);
        tmini_feed(board->lidar, chunk, (size_t)count);
        received += (uint32_t)count;
    }
    return received;
}

static void receive(tmini_zephyr_t *board)
{
    const uint32_t received = empty_fifo(board);
    board->counters.bytes += received;
    board->unannounced += received;
    if (board->unannounced >= CONFIG_TMINI_WAKE_BYTES) {
        board->unannounced = 0;
        k_sem_give(&board->received);
    }
}

static void on_interrupt(const struct device *uart, void *user_data)
{
    tmini_zephyr_t *const board = user_data;
    const k_spinlock_key_t key = k_spin_lock(&board->lock);
    (void)uart_irq_update(uart); /* Its result has never meant anything; since 4.5 it has none. */
    if (board->lidar != NULL) {
        receive(board);
    }
    k_spin_unlock(&board->lock, key);
}

/* ------------------------------------------------------------------------- init, start and stop */

int tmini_zephyr_init(tmini_zephyr_t *board, const struct device *uart)
{
    const struct uart_config line = {
        .baudrate = BAUD_RATE,
        .parity = UART_CFG_PARITY_NONE,
        .stop_bits = UART_CFG_STOP_BITS_1,
        .data_bits = UART_CFG_DATA_BITS_8,
        .flow_ctrl = UART_CFG_FLOW_CTRL_NONE,
    };
    if (board == NULL) {
        return -EINVAL;
    }
    *board = (tmini_zephyr_t){0};
    if (uart == NULL) {
        return -EINVAL;
    }
    if (!device_is_ready(uart)) {
        return -ENODEV;
    }
    const int error = uart_configure(uart, &line);
    if (error != 0 && error != -ENOSYS && error != -ENOTSUP) {
        return error;
    }
    k_sem_init(&board->received, 0, 1);
    board->uart = uart;
    return 0;
}

/* Zephyr has said since 3.3 whether the driver has interrupts. */
static int take_callback(tmini_zephyr_t *board)
{
    return RESULT_OR_0(uart_irq_callback_user_data_set(board->uart, on_interrupt, board));
}

int tmini_zephyr_start(tmini_zephyr_t *board, tmini_t *lidar)
{
    if (board == NULL || lidar == NULL || board->uart == NULL) {
        return -EINVAL;
    }
    if (board->lidar != NULL) {
        return -EALREADY;
    }
    uart_irq_rx_disable(board->uart);
    uart_irq_tx_disable(board->uart);
    const int error = take_callback(board);
    if (error != 0) {
        return error;
    }
    board->counters = (tmini_zephyr_counters_t){0};
    board->unannounced = 0;
    board->lidar = lidar;
    (void)uart_err_check(board->uart); /* Of bytes from before. */
    uart_irq_rx_enable(board->uart);
    return 0;
}

/* Behind the lock no callback is under way any more, on another core either. */
void tmini_zephyr_stop(tmini_zephyr_t *board)
{
    if (board == NULL || board->lidar == NULL) {
        return;
    }
    uart_irq_rx_disable(board->uart);
    const k_spinlock_key_t key = k_spin_lock(&board->lock);
    board->lidar = NULL;
    k_spin_unlock(&board->lock, key);
}

void tmini_zephyr_wait(tmini_zephyr_t *board, k_timeout_t timeout)
{
    (void)k_sem_take(&board->received, timeout);
}

void tmini_zephyr_counters(const tmini_zephyr_t *board, tmini_zephyr_counters_t *counters)
{
    *counters = board->counters;
}

/* ------------------------------------------------------------------------------------- the port */

/* uart_poll_out() waits while the transmitter is busy: at most for the byte before, 43 µs. */
static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_zephyr_t *const board = context;
    if (board->uart == NULL) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        uart_poll_out(board->uart, bytes[i]);
    }
    return (int)count;
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return k_uptime_get_32();
}

static void port_wait(void *context)
{
    tmini_zephyr_wait(context, K_MSEC(1));
}

const tmini_port_t tmini_zephyr_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait};
