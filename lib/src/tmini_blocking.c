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

/* A clock that has stepped back to before `begun_ms` shows no time. */
static bool is_time_left(const tmini_t *lidar, uint32_t begun_ms, uint32_t timeout_ms)
{
    const uint32_t passed_ms = now_ms(lidar) - begun_ms;
    return passed_ms < timeout_ms || passed_ms > UINT32_MAX / 2;
}

/* A start that follows a query waits for data, and the wish stands. */
static bool is_query(tmini_event_t wanted)
{
    return wanted < TMINI_EVENT_COMMAND_FAILED;
}

/* Polls until `wanted` comes, or a command has failed that nothing follows, or time is up; then a
 * query is given up. What could not be begun has ended already. */
static tmini_status_t wait_for(tmini_t *lidar, tmini_status_t begun, tmini_event_t wanted,
                               uint32_t timeout_ms)
{
    if (begun != TMINI_OK) {
        return begun;
    }
    const uint32_t begun_ms = now_ms(lidar);
    do {
        const tmini_event_t event = tmini_poll(lidar);
        if (event == wanted) {
            return TMINI_OK;
        }
        if (event == TMINI_EVENT_COMMAND_FAILED && tmini_state(lidar) <= TMINI_STATE_IDLE) {
            return tmini_command_error(lidar);
        }
        if (event == TMINI_EVENT_NONE) {
            idle(lidar);
        }
    } while (is_time_left(lidar, begun_ms, timeout_ms));
    if (is_query(wanted) && tmini_state(lidar) == TMINI_STATE_BUSY) {
        tmini_cancel(lidar);
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

tmini_status_t tmini_blocking_set_frequency(tmini_t *lidar, uint16_t frequency_chz,
                                            uint32_t timeout_ms)
{
    const tmini_status_t begun = tmini_set_frequency(lidar, frequency_chz);
    if (begun == TMINI_OK && tmini_state(lidar) == TMINI_STATE_SCANNING &&
        tmini_command_has_frequency(lidar)) {
        return TMINI_OK; /* It was wanted before: nothing is to be done. */
    }
    return wait_for(lidar, begun, TMINI_EVENT_FREQUENCY, timeout_ms);
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
