/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_port_template.h"

/* FILL IN 1: hands one byte to the transmitter, without waiting for it to leave. Returns 1 when the
 * transmitter has taken it, 0 when it is busy (the driver offers the byte again at the next
 * tmini_poll()), or a negative number when it has failed. */
static int transmit(void *uart, uint8_t byte)
{
    (void)uart;
    (void)byte;
    return -1; /* There is no transmitter yet. */
}

static int send_bytes(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_port_template_t *const port = context;
    int taken = 0;
    while ((size_t)taken < count) {
        const int result = transmit(port->uart, bytes[taken]);
        if (result < 0) {
            return result;
        }
        if (result == 0) {
            break;
        }
        taken++;
    }
    return taken;
}

/* FILL IN 2 (or leave as it is): your system's milliseconds, if it counts them already. If reading
 * 32 bits takes more than one access, an interrupt may change them in between: two equal readings
 * show that none has. */
static uint32_t time_now_ms(void *context)
{
    const tmini_port_template_t *const port = context;
    uint32_t time_ms = port->time_ms;
    for (uint32_t again = port->time_ms; again != time_ms; again = port->time_ms) {
        time_ms = again;
    }
    return time_ms;
}

/* FILL IN 3: switches the UART's receive interrupt on and off. First clears everything that is
 * pending, above all an overrun: this controller may have been reset while the lidar was
 * sending. */
static void enable_receive_interrupt(void *uart, bool enable)
{
    (void)uart;
    (void)enable;
}

/* The lidar is lost: starts the receiver again, whatever has stopped it. */
static void restart(void *context)
{
    const tmini_port_template_t *const port = context;
    if (port->lidar != NULL) {
        enable_receive_interrupt(port->uart, false);
        enable_receive_interrupt(port->uart, true);
    }
}

/* FILL IN 4 (optional): `wait`, a function that lets other work run for about a millisecond: an
 * RTOS delay, or a sleep until the next interrupt. Only the functions of tmini_blocking.h call it,
 * while they wait; with NULL they poll without a pause. */
const tmini_port_t tmini_port_template = {
    .write = send_bytes, .now_ms = time_now_ms, .wait = NULL, .restart = restart};

tmini_status_t tmini_port_template_init(tmini_port_template_t *port, void *uart)
{
    if (port == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *port = (tmini_port_template_t){.uart = uart};
    return TMINI_OK;
}

tmini_status_t tmini_port_template_start(tmini_port_template_t *port, tmini_t *lidar)
{
    if (port == NULL || lidar == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    port->lidar = lidar;
    enable_receive_interrupt(port->uart, true);
    return TMINI_OK;
}

void tmini_port_template_stop(tmini_port_template_t *port)
{
    enable_receive_interrupt(port->uart, false);
    port->lidar = NULL;
}

void tmini_port_template_counters(const tmini_port_template_t *port,
                                  tmini_port_template_counters_t *counters)
{
    *counters = (tmini_port_template_counters_t){.line_errors = port->line_errors};
}

void tmini_port_template_tick(tmini_port_template_t *port)
{
    port->time_ms = port->time_ms + 1;
}

/* A byte with an error is stored, too: the parser's checks decide whether it is used. */
void tmini_port_template_receive(tmini_port_template_t *port, uint8_t byte, bool is_error)
{
    if (is_error) {
        port->line_errors = port->line_errors + 1;
    }
    if (port->lidar != NULL) {
        tmini_feed_byte(port->lidar, byte);
    }
}
