/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: wishes and queries that wait for their result, for start-up code and tools. A thin
 * layer over tmini_poll().
 *
 * Each function polls until its result has come or `timeout_ms` has passed on the port's clock.
 * When there is nothing to do it calls the port's `wait`, if there is one. Meanwhile bytes must
 * come in from an interrupt, from another task, or from the port's `wait`. Other events, scans
 * included, are dropped. A query that has not ended in time is given up; the lidar's state is then
 * unknown, and the next command stops it first. A wish remains when the waiting ends.
 *
 * Context: the one that polls. All return
 *
 *     TMINI_OK                                           done
 *     TMINI_ERROR_ARGUMENT, _STATE, _BUSY, _LISTEN_ONLY  not begun; tmini.h gives the reasons
 *     TMINI_ERROR_TIMEOUT, _WRITE, _REPLY                the command's error, or too late
 *
 * and write their result only if they return TMINI_OK. */

#ifndef TMINI_BLOCKING_H
#define TMINI_BLOCKING_H

#include "tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A time-out for the functions below, in milliseconds: enough for three attempts of any query with
 * the default timing. */
#define TMINI_BLOCKING_TIMEOUT_MS 8000u

/** Asks for the device information and copies it to `info` (sections 3 and 4). Waits `timeout_ms`
 * at most. Returns what is listed above; TMINI_ERROR_ARGUMENT also if `info` is null. */
tmini_status_t tmini_blocking_read_info(tmini_t *lidar, tmini_info_t *info, uint32_t timeout_ms);

/** Asks for the health status and copies it to `health` (sections 3 and 4). Waits `timeout_ms` at
 * most. Returns what is listed above; TMINI_ERROR_ARGUMENT also if `health` is null. */
tmini_status_t tmini_blocking_read_health(tmini_t *lidar, tmini_health_t *health,
                                          uint32_t timeout_ms);

/** Asks for the scan frequency that is set and writes it to `frequency_chz`, in 0.01 Hz (sections 3
 * and 4). Waits `timeout_ms` at most. Returns what is listed above; TMINI_ERROR_ARGUMENT also if
 * `frequency_chz` is null. */
tmini_status_t tmini_blocking_read_frequency(tmini_t *lidar, uint16_t *frequency_chz,
                                             uint32_t timeout_ms);

/** States the wish for a scan frequency, in 0.01 Hz, as tmini_set_frequency() does, and waits until
 * it has been set or has failed, at most `timeout_ms`. Allow 2 s more than for a question: up to 15
 * steps may be needed. Returns what is listed above; TMINI_ERROR_STATE at once if the lidar already
 * scans without this wish fulfilled, or is lost with TMINI_RECOVERY_OFF. The wish remains. */
tmini_status_t tmini_blocking_set_frequency(tmini_t *lidar, uint16_t frequency_chz,
                                            uint32_t timeout_ms);

/** States the wish to scan and waits for the first scan (without a scan buffer, for the first
 * packet), at most `timeout_ms`. Attempts that fail meanwhile do not end the waiting, except with
 * TMINI_RECOVERY_OFF. The scan is valid as described at tmini_scan(). Returns what is listed above;
 * after TMINI_ERROR_TIMEOUT the wish to scan remains. */
tmini_status_t tmini_blocking_start(tmini_t *lidar, uint32_t timeout_ms);

/** Stops the lidar and waits until the line is quiet, `timeout_ms` at most (section 9.10). In any
 * state. Returns what is listed above. */
tmini_status_t tmini_blocking_stop(tmini_t *lidar, uint32_t timeout_ms);

#ifdef __cplusplus
}
#endif

#endif
