/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Receiving over the interrupt-driven UART API. */

#include <zephyr/drivers/uart.h>

#include "tmini_zephyr_reception.h"

#define CHUNK 32

/* The result of `call`; 0 in versions of Zephyr in which the function returns nothing. All
 * compilers of Zephyr have GCC's built-ins. */
#ifdef __GNUC__
#define RESULT_OR_0(call) \
    __builtin_choose_expr(__builtin_types_compatible_p(__typeof__(call), void), ((call), 0), (call))
#else
#define RESULT_OR_0(call) (call)
#endif

/* uart_err_check() is negative if the driver does not report errors. A loss is reported to the
 * lidar at once, because with some drivers clearing the error also removes the byte. After a loss
 * the other bytes of this interrupt are not used. */
static bool report_losses(tmini_zephyr_t *port, bool lost_before)
{
    const int errors = uart_err_check(port->uart);
    const bool lost = (errors > 0 && tmini_zephyr_count_errors(port, errors)) || lost_before;
    if (lost) {
        tmini_feed_gap(port->lidar);
    }
    return lost;
}

/* Checks for lost bytes before reading, because with some drivers reading clears the error, and
 * again after it, because bytes may have been lost among those just read. */
static void empty_fifo(tmini_zephyr_t *port)
{
    uint8_t chunk[CHUNK];
    bool lost = report_losses(port, false);
    while (uart_irq_rx_ready(port->uart) > 0) {
        const int count = uart_fifo_read(port->uart, chunk, sizeof chunk);
        if (count <= 0) {
            break;
        }
        lost = report_losses(port, lost);
        tmini_zephyr_take(port, chunk, (size_t)count);
    }
}

static void on_interrupt(const struct device *uart, void *user_data)
{
    tmini_zephyr_t *const port = user_data;
    const k_spinlock_key_t key = k_spin_lock(&port->lock);
    (void)uart_irq_update(uart); /* It has no result since 4.5, and had no meaningful one before. */
    if (port->lidar != NULL) {
        empty_fifo(port);
    }
    k_spin_unlock(&port->lock, key);
}

/* Since Zephyr 3.3 the result shows whether the driver has interrupts. */
int tmini_zephyr_begin_reception(tmini_zephyr_t *port)
{
    uart_irq_rx_disable(port->uart);
    uart_irq_tx_disable(port->uart);
    const int error = RESULT_OR_0(uart_irq_callback_user_data_set(port->uart, on_interrupt, port));
    if (error == 0) {
        (void)uart_err_check(port->uart); /* Clears errors of earlier bytes. */
        uart_irq_rx_enable(port->uart);
    }
    return error;
}

/* Once this has held the lock, no callback feeds the lidar any more, on any core. */
void tmini_zephyr_end_reception(tmini_zephyr_t *port)
{
    uart_irq_rx_disable(port->uart);
    const k_spinlock_key_t key = k_spin_lock(&port->lock);
    port->lidar = NULL;
    k_spin_unlock(&port->lock, key);
}

/* An error does not end reception by interrupts. */
void tmini_zephyr_keep_receiving(tmini_zephyr_t *port)
{
    (void)port;
}
