/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "turning_lidar.h"

#include <string.h>

#include "reference_decoder.h"
#include "simulator.h"

#define REVOLUTIONS 8192u /* As many as marks can tell apart. */
#define RECEIVED_MAX 49152u
#define PACKET_US 10000u
#define FAR_US 1000000u
#define HIDDEN_Q6 256u /* A hole of less than 4 degrees may be jitter. */

static struct {
    sim_t sim;
    uint64_t now_us;
    uint16_t counts[REVOLUTIONS]; /* The samples of each revolution sent so far. */
    uint8_t received[RECEIVED_MAX];
    size_t received_count;
    const char *wrong;
} lidar;

static sim_config_t config_of(bool ct_information)
{
    sim_config_t config = sim_default_config();
    config.ct_information = ct_information;
    config.marked = true;
    config.first_packet_ms = 10;
    config.spin_up_percent = 100;
    config.wobble_permille = 0;
    config.angle_jitter_q6 = 0;
    config.lone_packet_permille = 0;
    return config;
}

void turning_begin(bool ct_information)
{
    static sim_t fresh; /* To build the room takes long, and nobody looks at it. */
    const sim_config_t config = config_of(ct_information);
    if (fresh.mode != SIM_IDLE) {
        sim_init(&fresh, &config);
    }
    lidar.sim = fresh;
    lidar.sim.config = config;
    lidar.now_us = 0;
    lidar.counts[0] = 0;
    lidar.received_count = 0;
    lidar.wrong = NULL;
}

void turning_command(uint8_t code)
{
    const uint8_t command[] = {0xA5, code};
    sim_receive(&lidar.sim, command, sizeof command, lidar.now_us);
}

static void pass_until(uint64_t us, uint32_t *now_ms)
{
    *now_ms += (uint32_t)(us / 1000u - lidar.now_us / 1000u);
    lidar.now_us = us;
}

size_t turning_frame(uint8_t *out, bool *is_packet, uint32_t *now_ms)
{
    const uint64_t end_us = lidar.now_us + PACKET_US;
    sim_run_t run;
    if (sim_next_us(&lidar.sim) > end_us) {
        pass_until(end_us, now_ms);
        return 0;
    }
    if (!sim_next_run(&lidar.sim, lidar.now_us + FAR_US, &run)) { /* It has only booted. */
        pass_until(lidar.now_us + FAR_US, now_ms);
        return 0;
    }
    const uint64_t left_us = sim_byte_us(run.start_us, run.length - 1);
    pass_until(left_us > lidar.now_us ? left_us : lidar.now_us, now_ms);
    *is_packet = run.packet != NULL;
    if (*is_packet) {
        uint16_t *const count = &lidar.counts[run.packet->revolution % REVOLUTIONS];
        *count = (uint16_t)((run.packet->starts_revolution ? 0 : *count) + run.packet->bytes[3]);
    }
    memcpy(out, run.bytes, run.length);
    return run.length;
}

bool turning_received(const uint8_t *bytes, size_t count)
{
    if (RECEIVED_MAX - lidar.received_count < count) {
        return false;
    }
    memcpy(&lidar.received[lidar.received_count], bytes, count);
    lidar.received_count += count;
    return true;
}

/* ---- Checks of the delivered scans ---- */

static void complain(bool is_wrong, const char *what)
{
    if (is_wrong && lidar.wrong == NULL) {
        lidar.wrong = what;
    }
}

/* Returns false if no such sample was sent. */
static bool identify(encode_sample_t sample, uint32_t *revolution, uint32_t *number)
{
    sim_read_mark(&lidar.sim, sample, revolution, number);
    return *revolution <= lidar.sim.revolution && *number < lidar.counts[*revolution];
}

static bool is_seen_hole(unsigned from_q6, unsigned to_q6)
{
    return (to_q6 + ENCODE_FULL_TURN_Q6 - from_q6) % ENCODE_FULL_TURN_Q6 > HIDDEN_Q6;
}

void turning_judge(const tmini_scan_t *scan)
{
    uint32_t revolution = 0;
    uint32_t first = 0;
    uint32_t number = 0;
    uint32_t next = 0;
    bool lacks = false;
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const encode_sample_t sample = {point->distance_mm, point->intensity, point->flag};
        complain(!identify(sample, &revolution, &number), "a point that was never sent");
        first = i == 0 ? revolution : first;
        complain(revolution != first, "points of two revolutions");
        complain(number < next, "points out of order");
        lacks = lacks ||
                (number != next && (i == 0 || is_seen_hole(point[-1].angle_q6, point->angle_q6)));
        next = number + 1;
    }
    const bool is_cut = first >= lidar.sim.revolution || next < lidar.counts[first];
    lacks = lacks || (is_cut && scan->dropped == 0 &&
                      is_seen_hole(scan->points[scan->count - 1].angle_q6, 0));
    complain(scan->complete && (lacks || scan->dropped > 0), "complete, but something is missing");
    complain(lacks && scan->gaps == 0, "something is missing, and no gap says so");
}

/* Sets `context` if this packet was never sent: remains of others look like one by chance. */
static void look_for_chance(void *context, const reference_item_t *item)
{
    bool *const by_chance = context;
    uint32_t revolution = 0;
    uint32_t before = 0;
    for (unsigned i = 0; i < item->lsn; i++) {
        const reference_point_t point = reference_point(item->bytes, i);
        uint32_t number;
        const uint32_t last = revolution;
        *by_chance |= !identify((encode_sample_t){point.distance_mm, point.intensity, point.flag},
                                &revolution, &number) ||
                      (i > 0 && (number != before + 1 || revolution != last));
        before = number;
    }
}

const char *turning_verdict(void)
{
    const reference_options_t options = {.max_samples = 80};
    bool by_chance = false;
    if (lidar.wrong != NULL) {
        (void)reference_decode(lidar.received, lidar.received_count, &options, look_for_chance,
                               &by_chance);
    }
    return by_chance ? NULL : lidar.wrong;
}
