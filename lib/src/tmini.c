/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini.h"

#include "tmini_driver.h"

const tmini_timing_t tmini_timing_default = {
    .silence_ms = 100, /* A line at work: 5 ms; but a task or bridge may hold bytes back. */
    .quiet_ms = 50,
    .stop_ms = 600, /* Twice the longest tail seen after a stop (section 9.10). */
    .reply_ms = 2000,
    .write_ms = 100,
    .spin_up_ms = 3000,
    .data_ms = 1000,
    .turn_ms = 3000,
    .reboot_ms = 5000,
    .back_off_ms = 500,
    .back_off_max_ms = 4000,
    .attempts = 3,
};

void tmini_driver_look(tmini_t *lidar)
{
    const size_t received = tmini_ring_stored(&lidar->ring);
    lidar->now_ms = lidar->port->now_ms(lidar->port_context);
    if (received != lidar->received) {
        lidar->received = received;
        lidar->received_ms = lidar->now_ms;
        lidar->heard = true;
    }
}

/* A candidate that has stopped coming is given up, so that what it hides is looked at. */
static tmini_frame_t next_frame(tmini_t *lidar)
{
    tmini_parser_t *const parser = &lidar->parser;
    tmini_frame_t frame = tmini_parser_next(parser);
    if (driver_elapsed(lidar, lidar->received_ms, lidar->timing->silence_ms)) {
        while (frame == TMINI_FRAME_NONE && tmini_parser_pending(parser) > 0 &&
               driver_is_up_to_date(lidar)) {
            tmini_parser_abandon(parser);
            frame = tmini_parser_next(parser);
        }
    }
    return frame;
}

/* Handles frames until one raises an event or none is left. */
static void receive(tmini_t *lidar)
{
    if (lidar->held) {
        lidar->held = false;
        tmini_scan_add(&lidar->builder, &lidar->latest.packet, lidar->phase_ms);
    }
    while (lidar->pending == 0) {
        const tmini_frame_t frame = next_frame(lidar);
        if (frame == TMINI_FRAME_NONE) {
            return;
        }
        if (frame == TMINI_FRAME_PACKET) {
            tmini_driver_packet(lidar);
        } else {
            tmini_driver_reply(lidar);
        }
    }
}

/* Of the events that are pending, the first in the order of tmini_event_t. Scan and packet are
 * last: they are valid until parsing goes on. */
static tmini_event_t take_event(tmini_t *lidar)
{
    if (lidar->pending == 0) {
        return TMINI_EVENT_NONE;
    }
    unsigned event = TMINI_EVENT_STARTED;
    while ((lidar->pending >> event & 1u) == 0) {
        event++;
    }
    lidar->pending = (uint16_t)(lidar->pending & ~(1u << event));
    return (tmini_event_t)event;
}

static bool has_required_members(const tmini_config_t *config)
{
    return config != NULL && config->port != NULL && config->port->write != NULL &&
           config->port->now_ms != NULL;
}

/* Ring, parser and builder check their own parts of the configuration. */
static bool init_modules(tmini_t *lidar, const tmini_config_t *config)
{
    const bool streaming = config->points == NULL && config->max_points == 0;
    return tmini_ring_init(&lidar->ring, config->rx_buffer, config->rx_size, config->rx_dma) ==
               TMINI_OK &&
           tmini_parser_init(&lidar->parser, &lidar->ring, config->max_samples) == TMINI_OK &&
           (streaming || tmini_scan_init(&lidar->builder, config->points, config->max_points,
                                         config->filter) == TMINI_OK);
}

tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config)
{
    if (lidar == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *lidar = (tmini_t){0}; /* Also phase, goal and turn: unknown, none and nothing known. */
    if (!has_required_members(config) || !init_modules(lidar, config)) {
        return TMINI_ERROR_ARGUMENT;
    }
    lidar->port = config->port; /* From now on the lidar is set up. */
    lidar->port_context = config->port_context;
    lidar->timing = config->timing != NULL ? config->timing : &tmini_timing_default;
    lidar->no_recovery = config->no_recovery;
    return TMINI_OK;
}

tmini_event_t tmini_poll(tmini_t *lidar)
{
    if (!driver_is_set_up(lidar)) {
        return TMINI_EVENT_NONE;
    }
    tmini_driver_look(lidar);
    if (lidar->pending == 0) {
        receive(lidar);
    }
    if (lidar->pending == 0) {
        tmini_driver_keep_time(lidar);
    }
    return take_event(lidar);
}

tmini_state_t tmini_state(const tmini_t *lidar)
{
    if (!driver_is_set_up(lidar)) {
        return TMINI_STATE_UNKNOWN;
    }
    if (lidar->recovering) {
        return TMINI_STATE_RECOVERING;
    }
    switch (lidar->goal) {
    case GOAL_NONE:
        return driver_is_idle(lidar) ? TMINI_STATE_IDLE : TMINI_STATE_UNKNOWN;
    case GOAL_STOP:
        return TMINI_STATE_STOPPING;
    case GOAL_START:
        return lidar->phase == PHASE_SCANNING ? TMINI_STATE_SCANNING : TMINI_STATE_STARTING;
    default:
        return TMINI_STATE_BUSY;
    }
}

const tmini_scan_t *tmini_scan(const tmini_t *lidar)
{
    return &lidar->builder.scan;
}

const tmini_packet_t *tmini_packet(const tmini_t *lidar)
{
    return &lidar->latest.packet;
}

const tmini_info_t *tmini_info(const tmini_t *lidar)
{
    return &lidar->latest.info;
}

const tmini_health_t *tmini_health(const tmini_t *lidar)
{
    return &lidar->latest.health;
}

uint16_t tmini_frequency_chz(const tmini_t *lidar)
{
    return lidar->frequency_chz;
}

tmini_status_t tmini_failure(const tmini_t *lidar)
{
    return (tmini_status_t)lidar->failure;
}

uint8_t tmini_faults(const tmini_t *lidar)
{
    return lidar->faults;
}

void tmini_turn(const tmini_t *lidar, tmini_turn_info_t *info)
{
    tmini_turn_info(&lidar->turn, info);
}

void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters)
{
    counters->parser = lidar->parser.counters;
    counters->bytes_pending =
        driver_is_set_up(lidar) ? (uint32_t)tmini_parser_pending(&lidar->parser) : 0;
    counters->scans = lidar->scans;
    counters->timeouts = lidar->timeouts;
    counters->losses = lidar->losses;
    counters->recoveries = lidar->recoveries;
    counters->restarts = lidar->restarts;
    counters->reboots = lidar->reboots;
}
