/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The commands in a form that waits: for start-up code and for tools. A thin layer over
 * tmini_poll().
 *
 * Each function polls until the command has ended or `timeout_ms` has passed on the port's clock,
 * calling the port's `wait`, if there is one, whenever there is nothing to do. Meanwhile bytes must
 * come in from an interrupt, from another task, or from the port's `wait`. Events that do not
 * belong to the command, scans among them, are swallowed. A command that has not ended in time is
 * aborted; the lidar's state is then unknown, which the next command mends.
 *
 * Context: the one that polls. All return
 *   TMINI_OK                                  done
 *   TMINI_ERROR_ARGUMENT, _STATE, _BUSY       not begun, as the command in tmini.h says
 *   TMINI_ERROR_TIMEOUT, _WRITE, _REPLY       failed, as tmini_command_error() says, or not in time
 * and write their result only with TMINI_OK. */

#ifndef TMINI_BLOCKING_H
#define TMINI_BLOCKING_H

#include "tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Enough for three attempts of any query with the default timing, in milliseconds. */
#define TMINI_BLOCKING_TIMEOUT_MS 8000u

tmini_status_t tmini_read_info(tmini_t *lidar, tmini_info_t *info, uint32_t timeout_ms);
tmini_status_t tmini_read_health(tmini_t *lidar, tmini_health_t *health, uint32_t timeout_ms);
tmini_status_t tmini_read_frequency(tmini_t *lidar, uint16_t *frequency_chz, uint32_t timeout_ms);

/* Sets the scan frequency; allow 2 s more than for a query, for up to a dozen steps. */
tmini_status_t tmini_write_frequency(tmini_t *lidar, uint16_t frequency_chz, uint32_t timeout_ms);

/* Starts scanning and waits for the first scan, or for the first packet when streaming. The scan is
 * valid until the next tmini_poll(). If it does not come in time, the lidar may turn all the same:
 * stop it. */
tmini_status_t tmini_start_and_wait(tmini_t *lidar, uint32_t timeout_ms);

/* Stops the lidar and waits until the line is quiet. */
tmini_status_t tmini_stop_and_wait(tmini_t *lidar, uint32_t timeout_ms);

#ifdef __cplusplus
}
#endif

#endif
