/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "bed.h"

#include "tmini/tmini_names.h"

#include <stdlib.h>
#include <string.h>

#define CLOCK_AT_THE_BEGINNING 0xFFFFE000u /* It wraps around after eight seconds. */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    bed_t *const bed = context;
    const size_t room = sizeof bed->outbox - bed->outbox_count;
    const size_t most = bed->write_max == 0 || bed->write_max > room ? room : bed->write_max;
    const size_t taken = count < most ? count : most;

    memcpy(bed->outbox + bed->outbox_count, bytes, taken);
    bed->outbox_count += taken;
    return (int)taken;
}

static uint32_t port_now_ms(void *context)
{
    const bed_t *const bed = context;

    return bed_ms(bed) + CLOCK_AT_THE_BEGINNING;
}

void bed_prepare(bed_t *bed)
{
    memset(bed, 0, sizeof *bed);
    bed->poll_ms = 1;
    bed->timing = tmini_timing_default;
    bed->config.rx_size = 1024;
    bed->config.max_points = sizeof bed->points / sizeof bed->points[0];
}

bool bed_init(bed_t *bed, const sim_config_t *sim)
{
    bed->port.write = port_write;
    bed->port.now_ms = port_now_ms;
    bed->config.port = &bed->port;
    bed->config.port_context = bed;
    bed->config.rx_buffer = bed->rx;
    bed->config.points = bed->points;
    bed->config.timing = &bed->timing;
    sim_init(&bed->sim, sim);
    return tmini_init(&bed->lidar, &bed->config) == TMINI_OK;
}

uint32_t bed_ms(const bed_t *bed)
{
    return (uint32_t)(bed->now_us / 1000u);
}

unsigned bed_event_named(const char *name)
{
    unsigned event = 0;

    while (event < BED_EVENTS - 1u && strcmp(tmini_event_name((tmini_event_t)event), name) != 0) {
        event++;
    }
    return event;
}

/* ---- What the program sees ---- */

static void note_scan(bed_t *bed)
{
    const tmini_scan_t *const scan = tmini_scan(&bed->lidar);

    bed->scan = *scan;
    if (!scan->complete) {
        bed->complete_in_a_row = 0;
        return;
    }
    bed->row_chz[bed->complete_in_a_row++ % BED_ROW] = scan->frequency_chz;
    if (bed->complete++ > 0 && bed->now_us - bed->complete_us > bed->longest_gap_us) {
        bed->longest_gap_us = bed->now_us - bed->complete_us;
    }
    bed->complete_us = bed->now_us;
}

static void note_rate(bed_t *bed)
{
    uint32_t in_second = 0;

    bed->recent_us[bed->recent++ % BED_RECENT] = bed->now_us;
    for (uint32_t i = 0; i < BED_RECENT && i < bed->recent; i++) {
        in_second += bed->now_us - bed->recent_us[i] < 1000000u ? 1u : 0u;
    }
    bed->most_per_second = in_second > bed->most_per_second ? in_second : bed->most_per_second;
}

static void note(bed_t *bed, tmini_event_t event)
{
    if (event == TMINI_EVENT_MORE) {
        return;
    }
    bed->events[event]++;
    bed->event_us[event] = bed->now_us;
    if (event == TMINI_EVENT_SCAN) {
        note_scan(bed);
    } else if (event != TMINI_EVENT_PACKET) {
        note_rate(bed);
    }
}

/* ---- Time ---- */

static void carry_bytes(bed_t *bed)
{
    uint8_t bytes[1024];
    size_t count = bed->outbox_count;

    bed->outbox_count = 0;
    if (count > 0) {
        sim_receive(&bed->sim, bed->outbox, count, bed->now_us);
    }
    bed->now_us += bed->poll_ms * 1000u;
    count = sim_transmit(&bed->sim, bed->now_us, bytes, sizeof bytes);
    if (count > 0) {
        (void)tmini_feed(&bed->lidar, bytes, count);
    }
}

void bed_step(bed_t *bed)
{
    tmini_event_t event;

    carry_bytes(bed);
    while ((event = tmini_poll(&bed->lidar)) != TMINI_EVENT_NONE) {
        note(bed, event);
    }
}

void bed_run_ms(bed_t *bed, uint32_t ms)
{
    const uint64_t end_us = bed->now_us + ms * 1000u;

    while (bed->now_us < end_us) {
        bed_step(bed);
    }
}

/* ---- Whether a wish is fulfilled ---- */

static bool is_row_near(const bed_t *bed, uint16_t frequency_chz, uint32_t scans)
{
    for (uint32_t i = 1; i <= scans; i++) {
        const int off = bed->row_chz[(bed->complete_in_a_row - i) % BED_ROW] - frequency_chz;

        if (abs(off) > frequency_chz / 20) {
            return false;
        }
    }
    return true;
}

bool bed_scans_at(const bed_t *bed, uint16_t frequency_chz, uint32_t scans)
{
    if (bed->complete_in_a_row < scans || tmini_state(&bed->lidar) != TMINI_STATE_SCANNING ||
        sim_mode(&bed->sim) != SIM_SCANNING) {
        return false;
    }
    return frequency_chz == 0 || (sim_frequency_chz(&bed->sim) == frequency_chz &&
                                  tmini_frequency_chz(&bed->lidar) == frequency_chz &&
                                  is_row_near(bed, frequency_chz, scans));
}

bool bed_is_idle(const bed_t *bed)
{
    const tmini_state_t state = tmini_state(&bed->lidar);

    return sim_mode(&bed->sim) == SIM_IDLE &&
           (state == TMINI_STATE_IDLE || state == TMINI_STATE_UNKNOWN);
}
