/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A port to start yours from: copy this file and its source, rename, and fill in the places that
 * the source marks FILL IN. ../README.md explains the steps.
 *
 *     tmini_port_template_init(&port, uart);
 *     config.port = &tmini_port_template;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_port_template_start(&port, &lidar); from now on bytes come in
 *     tmini_start(&lidar); …                    commands, polling
 *     tmini_port_template_stop(&port);
 *
 * It compiles as it is. Until you fill it in, it has no UART: every command ends with
 * TMINI_EVENT_COMMAND_FAILED and TMINI_ERROR_WRITE, so that a port left unfinished is noticed. */

#ifndef TMINI_PORT_TEMPLATE_H
#define TMINI_PORT_TEMPLATE_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Running totals, for diagnostics. Split them up where your UART does. */
typedef struct {
    uint32_t line_errors; /**< Framing, noise and overrun errors. */
} tmini_port_template_counters_t;

/** The connection of one lidar. You allocate one for each lidar; its address is the `port_context`
 * of tmini_config_t. */
typedef struct {
    tmini_t *lidar; /**< Where received bytes go; NULL: nowhere. */
    void *uart;     /**< The UART as your board names it: a handle, a number, a register address. */
    volatile uint32_t time_ms;     /**< Milliseconds counted by tmini_port_template_tick(). */
    volatile uint32_t line_errors; /**< As in tmini_port_template_counters_t. */
} tmini_port_template_t;

/** The `port` of tmini_config_t. */
extern const tmini_port_t tmini_port_template;

/** Sets the UART. It must be set up (230400 baud, 8 data bits, no parity, 1 stop bit), with its
 * receive interrupt still disabled. Call it once. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null
 * pointer. */
tmini_status_t tmini_port_template_init(tmini_port_template_t *port, void *uart);

/** Begins to pass received bytes to `lidar`, which tmini_init() has set up. Not from an interrupt.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer. */
tmini_status_t tmini_port_template_start(tmini_port_template_t *port, tmini_t *lidar);

/** Stops passing bytes to the lidar. Not from an interrupt; may be started again. */
void tmini_port_template_stop(tmini_port_template_t *port);

/** Copies the counters. */
void tmini_port_template_counters(const tmini_port_template_t *port,
                                  tmini_port_template_counters_t *counters);

/** Call from an interrupt every millisecond. */
void tmini_port_template_tick(tmini_port_template_t *port);

/** Call from the UART's receive interrupt with each byte; `is_error` if the UART reported a
 * framing, noise or overrun error with it. */
void tmini_port_template_receive(tmini_port_template_t *port, uint8_t byte, bool is_error);

#ifdef __cplusplus
}
#endif

#endif
