/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_zephyr.h"

#include <errno.h>
#include <stdbool.h>

#include <zephyr/drivers/uart.h>

#include "tmini_zephyr_reception.h"

/* The protocol's section 1. */
#define BAUD_RATE 230400

/* UART_ERROR_NOISE, which older versions of Zephyr do not have. */
#define ERROR_NOISE (1 << 5)

/* While bytes come, the polling thread wakes after this time at the latest, so that a packet's end
 * need not wait for the next packet. */
#define PATIENCE_MS 10u

/* --------------------------------------------------------------------------------- the callback */

bool tmini_zephyr_count_errors(tmini_zephyr_t *port, int errors)
{
    port->counters.overruns += (errors & UART_ERROR_OVERRUN) != 0;
    port->counters.framing_errors += (errors & UART_ERROR_FRAMING) != 0;
    port->counters.noise_errors += (errors & ERROR_NOISE) != 0;
    port->counters.breaks += (errors & UART_BREAK) != 0;
    return (errors & UART_ERROR_OVERRUN) != 0;
}

void tmini_zephyr_take(tmini_zephyr_t *port, const uint8_t *bytes, size_t count)
{
    tmini_feed(port->lidar, bytes, count);
    port->counters.bytes += (uint32_t)count;
    port->unannounced += (uint32_t)count;
    port->has_received = true;
    if (port->wakes_at_once || port->unannounced >= CONFIG_TMINI_WAKE_BYTES) {
        port->unannounced = 0;
        port->wakes_at_once = false;
        k_sem_give(&port->received);
    }
}

/* ------------------------------------------------------------------------- init, start and stop */

int tmini_zephyr_init(tmini_zephyr_t *port, const struct device *uart)
{
    const struct uart_config line = {
        .baudrate = BAUD_RATE,
        .parity = UART_CFG_PARITY_NONE,
        .stop_bits = UART_CFG_STOP_BITS_1,
        .data_bits = UART_CFG_DATA_BITS_8,
        .flow_ctrl = UART_CFG_FLOW_CTRL_NONE,
    };
    if (port == NULL) {
        return -EINVAL;
    }
    *port = (tmini_zephyr_t){0};
    k_sem_init(&port->received, 0, 1);
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
    port->uart = uart;
    return 0;
}

int tmini_zephyr_start(tmini_zephyr_t *port, tmini_t *lidar)
{
    if (port == NULL || lidar == NULL || port->uart == NULL) {
        return -EINVAL;
    }
    if (port->lidar != NULL) {
        return -EALREADY;
    }
    port->counters = (tmini_zephyr_counters_t){0};
    port->unannounced = 0;
    port->has_received = false;
    port->wakes_at_once = false;
    port->lidar = lidar;
    const int error = tmini_zephyr_begin_reception(port);
    if (error != 0) {
        port->lidar = NULL;
    }
    return error;
}

void tmini_zephyr_stop(tmini_zephyr_t *port)
{
    if (port != NULL && port->lidar != NULL) {
        tmini_zephyr_end_reception(port);
    }
}

void tmini_zephyr_wait(tmini_zephyr_t *port, k_timeout_t timeout)
{
    (void)k_sem_take(&port->received, timeout);
    tmini_zephyr_keep_receiving(port);
}

/* If no byte has come since the last sleep, the next one ends this sleep. Else bytes are flowing:
 * the thread waits for several, but not long. The callback holds the same lock while it feeds the
 * lidar. So each byte has come before this, and the sleep is short, or it comes later and gives the
 * semaphore, which also counts before the wait: none is slept over. */
static uint32_t sleep_ms(tmini_zephyr_t *port, uint32_t due_ms)
{
    const k_spinlock_key_t key = k_spin_lock(&port->lock);
    const bool is_flowing = port->has_received;
    port->has_received = false;
    port->wakes_at_once = !is_flowing;
    k_spin_unlock(&port->lock, key);
    return is_flowing && due_ms > PATIENCE_MS ? PATIENCE_MS : due_ms;
}

void tmini_zephyr_sleep(tmini_zephyr_t *port, uint32_t due_ms)
{
    if (due_ms > 0) {
        tmini_zephyr_wait(port, K_MSEC(sleep_ms(port, due_ms)));
    }
}

void tmini_zephyr_counters(const tmini_zephyr_t *port, tmini_zephyr_counters_t *counters)
{
    *counters = port->counters;
}

/* ------------------------------------------------------------------------------------- the port */

/* uart_poll_out() waits while the transmitter is busy: at most for the byte before, 43 µs. */
static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_zephyr_t *const port = context;
    if (port->uart == NULL) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        uart_poll_out(port->uart, bytes[i]);
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

static void port_restart(void *context)
{
    tmini_zephyr_t *const port = context;
    tmini_t *const lidar = port->lidar;
    if (lidar != NULL) {
        tmini_zephyr_end_reception(port);
        port->lidar = lidar;
        (void)tmini_zephyr_begin_reception(port);
    }
}

const tmini_port_t tmini_zephyr_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait, .restart = port_restart};
