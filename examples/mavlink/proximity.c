/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "proximity.h"

#include <common/mavlink.h> /* https://mavlink.io: C headers of the dialect "common", version 2. */

#define HEARTBEAT_MS 1000u
#define PERIOD_MS 90u /* A turn at 10 Hz, which may be somewhat short. */
#define OLD_MS 300u
#define STEP_DEG 5
#define MIN_CM ((uint16_t)(TMINI_RANGE_MIN_MM / 10u))
#define MAX_CM ((uint16_t)(TMINI_RANGE_MAX_MM / 10u))

void proximity_init(proximity_t *proximity, proximity_write_t write, void *context,
                    uint8_t system_id)
{
    *proximity = (proximity_t){.write = write, .context = context, .system_id = system_id};
    (void)tmini_sectors_init(&proximity->sectors, proximity->memory, PROXIMITY_SECTORS,
                             TMINI_FILTER_NONE);
}

/* Scans that could not be sent are sent together. */
void proximity_see(proximity_t *proximity, const tmini_scan_t *scan)
{
    if (!proximity->has_news || scan->end_ms - proximity->seen_ms > OLD_MS) {
        tmini_sectors_clear(&proximity->sectors);
    }
    for (size_t i = 0; i < scan->count; i++) {
        tmini_sectors_add(&proximity->sectors, &scan->points[i]);
    }
    proximity->has_news = true;
    proximity->seen_ms = scan->end_ms;
}

/* No range is unknown, never free. What is too near is sent as the minimum, because a flight
 * controller ignores what is below. */
static uint16_t to_cm(const tmini_sector_t *sector)
{
    const uint16_t cm = (uint16_t)(sector->nearest_mm / 10u);
    if (tmini_sector_is_blind(sector)) {
        return UINT16_MAX;
    }
    return cm < MIN_CM ? MIN_CM : cm > MAX_CM ? (uint16_t)(MAX_CM + 1u) : cm;
}

static void begin(proximity_t *proximity, const mavlink_message_t *message)
{
    proximity->length = mavlink_msg_to_send_buffer(proximity->bytes, message);
    proximity->taken = 0;
}

static void send_heartbeat(proximity_t *proximity, uint32_t now_ms)
{
    mavlink_message_t message;
    (void)mavlink_msg_heartbeat_pack(proximity->system_id, MAV_COMP_ID_OBSTACLE_AVOIDANCE, &message,
                                     MAV_TYPE_ONBOARD_CONTROLLER, MAV_AUTOPILOT_INVALID, 0, 0,
                                     MAV_STATE_ACTIVE);
    begin(proximity, &message);
    proximity->heartbeat_ms = now_ms;
}

static void send_sectors(proximity_t *proximity, uint32_t now_ms)
{
    mavlink_message_t message;
    uint16_t distances_cm[PROXIMITY_SECTORS];
    for (size_t i = 0; i < PROXIMITY_SECTORS; i++) {
        distances_cm[i] = to_cm(&proximity->memory[i]);
    }
    (void)mavlink_msg_obstacle_distance_pack(proximity->system_id, MAV_COMP_ID_OBSTACLE_AVOIDANCE,
                                             &message, (uint64_t)proximity->seen_ms * 1000u,
                                             MAV_DISTANCE_SENSOR_LASER, distances_cm, STEP_DEG,
                                             MIN_CM, MAX_CM, STEP_DEG, 0, MAV_FRAME_BODY_FRD);
    begin(proximity, &message);
    proximity->sent_ms = now_ms;
    proximity->has_news = false;
}

static void choose(proximity_t *proximity, uint32_t now_ms)
{
    if (proximity->has_news && now_ms - proximity->seen_ms > OLD_MS) {
        proximity->has_news = false;
    }
    if (proximity->heartbeat_ms == 0 || now_ms - proximity->heartbeat_ms >= HEARTBEAT_MS) {
        send_heartbeat(proximity, now_ms != 0 ? now_ms : 1);
    } else if (proximity->has_news && now_ms - proximity->sent_ms >= PERIOD_MS) {
        send_sectors(proximity, now_ms);
    }
}

void proximity_poll(proximity_t *proximity, uint32_t now_ms)
{
    if (proximity->taken == proximity->length) {
        choose(proximity, now_ms);
    }
    if (proximity->taken < proximity->length) {
        const int taken = proximity->write(proximity->context, &proximity->bytes[proximity->taken],
                                           proximity->length - proximity->taken);
        proximity->taken += taken > 0 ? (size_t)taken : 0;
    }
}
