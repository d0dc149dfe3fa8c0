/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Receiving over the async UART API: two buffers in turn, by DMA where the chip has it. */

#include <zephyr/drivers/uart.h>

#include "tmini_zephyr_reception.h"

/* Silence after which bytes are handed over: 46 byte times. */
#define TIMEOUT_US 2000

/* How long the driver may take to end reception: longer than the time-out. */
#define END_MS 20

/* After a failure the polling thread sleeps for a short time only, as if bytes had come, and tries
 * again. */
static int begin(tmini_zephyr_t *port)
{
    port->buffer = 0;
    port->is_enabled = true; /* Set first: events may come at once. */
    const int error =
        uart_rx_enable(port->uart, port->buffers[0], sizeof port->buffers[0], TIMEOUT_US);
    if (error != 0) {
        port->is_enabled = false;
        port->has_received = true;
    }
    return error;
}

static void give_next_buffer(tmini_zephyr_t *port)
{
    port->buffer ^= 1u;
    (void)uart_rx_buf_rsp(port->uart, port->buffers[port->buffer], sizeof port->buffers[0]);
}

static void take(tmini_zephyr_t *port, const struct uart_event_rx *received)
{
    const k_spinlock_key_t key = k_spin_lock(&port->lock);
    if (port->lidar != NULL) {
        tmini_zephyr_take(port, &received->buf[received->offset], received->len);
    }
    k_spin_unlock(&port->lock, key);
}

/* The driver ends reception after any error. This callback does not start it again, because a line
 * that is held low would cause an error each time; it wakes the polling thread, which starts it
 * again. */
static void on_event(const struct device *uart, struct uart_event *event, void *user_data)
{
    tmini_zephyr_t *const port = user_data;
    (void)uart;
    switch (event->type) {
    case UART_RX_RDY:
        take(port, &event->data.rx);
        break;
    case UART_RX_BUF_REQUEST:
        give_next_buffer(port);
        break;
    case UART_RX_STOPPED:
        (void)tmini_zephyr_count_errors(port, (int)event->data.rx_stop.reason);
        break;
    case UART_RX_DISABLED:
        port->is_enabled = false;
        k_sem_give(&port->received);
        break;
    default:
        break;
    }
}

/* A driver without the async API returns an error here. */
int tmini_zephyr_begin_reception(tmini_zephyr_t *port)
{
    const int error = uart_callback_set(port->uart, on_event, port);
    return error == 0 ? begin(port) : error;
}

void tmini_zephyr_end_reception(tmini_zephyr_t *port)
{
    const k_spinlock_key_t key = k_spin_lock(&port->lock);
    port->lidar = NULL;
    k_spin_unlock(&port->lock, key);
    (void)uart_rx_disable(port->uart);
    for (unsigned i = 0; i < END_MS && port->is_enabled; i++) {
        (void)k_sleep(K_MSEC(1));
    }
}

/* While reception is off there is no callback, so this thread may report the gap. */
void tmini_zephyr_keep_receiving(tmini_zephyr_t *port)
{
    if (port->lidar != NULL && !port->is_enabled) {
        tmini_feed_gap(port->lidar);
        (void)begin(port);
    }
}
