/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Writes what examples/mavlink/proximity.c sends to standard output:
 *
 *     story lidar SECONDS BYTES_PER_MS     over the simulated lidar, in virtual time
 *     story points DEGREES:MM …            one scan of these points
 *
 * Something 20 degrees wide is 0.7 m to the lidar's right. From 6 to 9 s it has no power. */

#include "proximity.h"
#include "simulator.h"

#include "tmini/tmini.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static sim_t sim;
static uint64_t now_us;
static tmini_t lidar;
static tmini_port_t port;
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static proximity_t proximity;
static size_t bytes_per_ms;

static int write_lidar(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    sim_receive(&sim, bytes, count, now_us);
    return (int)count;
}

static uint32_t now_ms(void *context)
{
    (void)context;
    return (uint32_t)(now_us / 1000u);
}

static int write_uart(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    return (int)fwrite(bytes, 1, count < bytes_per_ms ? count : bytes_per_ms, stdout);
}

static void pass_ms(void)
{
    uint8_t bytes[64];
    now_us += 1000;
    const size_t count = sim_transmit(&sim, now_us, bytes, sizeof bytes);
    (void)tmini_feed(&lidar, bytes, count);
    for (tmini_event_t event; (event = tmini_poll(&lidar)) != TMINI_EVENT_NONE;) {
        if (event == TMINI_EVENT_SCAN && tmini_faults(&lidar) == 0) {
            proximity_see(&proximity, tmini_scan(&lidar));
        }
    }
    proximity_poll(&proximity, now_ms(NULL));
}

static int play_lidar(unsigned seconds)
{
    const sim_config_t config = sim_default_config();
    port = (tmini_port_t){.write = write_lidar, .now_ms = now_ms};
    const tmini_config_t driver = {.port = &port,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = TMINI_SCAN_POINTS_TYPICAL,
                                   .frequency_chz = 1000};
    sim_init(&sim, &config);
    sim_place_obstacle(&sim, 90 * 64, 20 * 64, 700);
    if (tmini_init(&lidar, &driver) != TMINI_OK) {
        return 1;
    }
    (void)tmini_start(&lidar);
    for (unsigned ms = 0; ms < seconds * 1000u; ms++) {
        if (ms == 6000 || ms == 9000) {
            sim_power(&sim, ms == 9000, now_us);
        }
        pass_ms();
    }
    return 0;
}

static int send_points(int count, char **words)
{
    for (int i = 0; i < count; i++) {
        points[i] = (tmini_point_t){.angle_q6 = (uint16_t)(atof(words[i]) * 64),
                                    .distance_mm = (uint16_t)atoi(strchr(words[i], ':') + 1)};
    }
    const tmini_scan_t scan = {.points = points, .count = (uint16_t)count, .end_ms = 5000};
    proximity_see(&proximity, &scan);
    proximity_poll(&proximity, 5000);
    proximity_poll(&proximity, 5001);
    return 0;
}

int main(int argc, char **argv)
{
    bytes_per_ms = argc == 4 && strcmp(argv[1], "lidar") == 0 ? (size_t)atoi(argv[3]) : 1000;
    proximity_init(&proximity, write_uart, NULL, 7);
    return argc == 4 && strcmp(argv[1], "lidar") == 0 ? play_lidar((unsigned)atoi(argv[2]))
           : argc > 2                                 ? send_points(argc - 2, argv + 2)
                                                      : 2;
}
