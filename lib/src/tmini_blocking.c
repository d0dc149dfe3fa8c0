/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_blocking.h"

#include "tmini_driver.h"

static void idle(const tmini_t *lidar)
{
    if (lidar->link.port->wait != NULL) {
        lidar->link.port->wait(lidar->link.port_context);
    }
}

static uint32_t now_ms(const tmini_t *lidar)
{
    return lidar->link.port->now_ms(lidar->link.port_context);
}

/* True until `timeout_ms` have passed since `begun_ms`. If the clock is set back to before that,
 * the time begins again. */
static bool is_time_left(const tmini_t *lidar, uint32_t *begun_ms, uint32_t timeout_ms)
{
    const uint32_t passed_ms = now_ms(lidar) - *begun_ms;
    if ((int32_t)passed_ms < 0) {
        *begun_ms += passed_ms;
        return true;
    }
    return passed_ms < timeout_ms;
}

/* True if the wish that `wanted` ends has failed: it no longer stands. A start ends with its first
 * scan or packet. */
static bool has_failed(const tmini_t *lidar, tmini_event_t wanted)
{
    const tmini_event_t wish = wanted <= TMINI_EVENT_REBOOTED ? wanted : TMINI_EVENT_STARTED;
    return tmini_state(lidar) < TMINI_STATE_STARTING && !tmini_recovery_wishes(lidar, wish);
}

/* What `event` means for a caller that waits for `wanted`. A failed command ends the waiting if no
 * other attempt follows. Waiting for a frequency also ends when the lidar scans without it. */
static int result_of(const tmini_t *lidar, tmini_event_t event, tmini_event_t wanted)
{
    const bool is_without =
        wanted == TMINI_EVENT_FREQUENCY && tmini_state(lidar) == TMINI_STATE_SCANNING;
    if (event == wanted) {
        return TMINI_OK;
    }
    if (event == TMINI_EVENT_COMMAND_FAILED && (is_without || has_failed(lidar, wanted))) {
        return tmini_command_error(lidar);
    }
    return TMINI_UNDER_WAY;
}

/* Polls until `wanted` comes or cannot come any more, or time is up. When time is up, a query is
 * withdrawn. If the command could not be begun, returns its error. */
static tmini_status_t wait_for(tmini_t *lidar, tmini_status_t begun, tmini_event_t wanted,
                               uint32_t timeout_ms)
{
    if (begun != TMINI_OK) {
        return begun;
    }
    uint32_t begun_ms = now_ms(lidar);
    do {
        const tmini_event_t event = tmini_poll(lidar);
        const int result = result_of(lidar, event, wanted);
        if (result != TMINI_UNDER_WAY) {
            return (tmini_status_t)result;
        }
        if (event == TMINI_EVENT_NONE) {
            idle(lidar);
        }
    } while (is_time_left(lidar, &begun_ms, timeout_ms));
    if (wanted >= TMINI_EVENT_INFO && wanted <= TMINI_EVENT_FREQUENCY) {
        tmini_withdraw(lidar, wanted);
    }
    return TMINI_ERROR_TIMEOUT;
}

tmini_status_t tmini_blocking_read_info(tmini_t *lidar, tmini_info_t *info, uint32_t timeout_ms)
{
    if (info == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_status_t status =
        wait_for(lidar, tmini_request_info(lidar), TMINI_EVENT_INFO, timeout_ms);
    if (status == TMINI_OK) {
        *info = *tmini_info(lidar);
    }
    return status;
}

tmini_status_t tmini_blocking_read_health(tmini_t *lidar, tmini_health_t *health,
                                          uint32_t timeout_ms)
{
    if (health == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_status_t status =
        wait_for(lidar, tmini_request_health(lidar), TMINI_EVENT_HEALTH, timeout_ms);
    if (status == TMINI_OK) {
        *health = *tmini_health(lidar);
    }
    return status;
}

tmini_status_t tmini_blocking_read_frequency(tmini_t *lidar, uint16_t *frequency_chz,
                                             uint32_t timeout_ms)
{
    if (frequency_chz == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_status_t status =
        wait_for(lidar, tmini_request_frequency(lidar), TMINI_EVENT_FREQUENCY, timeout_ms);
    if (status == TMINI_OK) {
        *frequency_chz = tmini_frequency_chz(lidar);
    }
    return status;
}

/* What is known at once about a wish for a frequency that was stated in the state `before`. An idle
 * lidar is always asked. */
static int result_of_wish(const tmini_t *lidar, tmini_state_t before)
{
    const tmini_state_t state = tmini_state(lidar);
    if (before < TMINI_STATE_STARTING) {
        return TMINI_UNDER_WAY;
    }
    if (tmini_command_has_frequency(lidar)) {
        return TMINI_OK;
    }
    const bool is_lost = state == TMINI_STATE_RECOVERING && lidar->is_recovery_off;
    const bool is_refused = state == TMINI_STATE_SCANNING && lidar->monitor.turns_to_still == 0;
    return is_lost || is_refused ? TMINI_ERROR_STATE : TMINI_UNDER_WAY;
}

tmini_status_t tmini_blocking_set_frequency(tmini_t *lidar, uint16_t frequency_chz,
                                            uint32_t timeout_ms)
{
    const tmini_state_t before = tmini_state(lidar);
    const tmini_status_t begun = tmini_set_frequency(lidar, frequency_chz);
    const int result = begun == TMINI_OK ? result_of_wish(lidar, before) : (int)begun;
    if (result != TMINI_UNDER_WAY) {
        return (tmini_status_t)result;
    }
    return wait_for(lidar, TMINI_OK, TMINI_EVENT_FREQUENCY, timeout_ms);
}

tmini_status_t tmini_blocking_start(tmini_t *lidar, uint32_t timeout_ms)
{
    const tmini_status_t begun = tmini_start(lidar);
    const bool by_packets = begun == TMINI_OK && lidar->decoder.builder.capacity == 0;
    return wait_for(lidar, begun, by_packets ? TMINI_EVENT_PACKET : TMINI_EVENT_SCAN, timeout_ms);
}

tmini_status_t tmini_blocking_stop(tmini_t *lidar, uint32_t timeout_ms)
{
    return wait_for(lidar, tmini_stop(lidar), TMINI_EVENT_STOPPED, timeout_ms);
}
