/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A robot drives at 1 m/s towards a wall, and its field stops it: with each K (points), N (scans),
 * frequency and noise of the table in docs/robotics.md. */

#include "rover.h"

#include <stdio.h>

#include "unity.h"

#define BEGIN_MM 3000.0
#define SPEED_MM_MS 1.0    /* 1 m/s. */
#define BRAKE_MM_MS2 0.002 /* 2 m/s². */
#define LOOP_MS 20u        /* How often the program looks. */

typedef struct {
    double gap_mm;  /* From the lidar to the wall in the end; it touches at 0. */
    double fastest; /* In mm per ms. */
    bool has_stood; /* It stands in the end. */
} drive_t;

/* docs/robotics.md, "Safety": two turns, the loop, and the way to brake. */
static int16_t length_mm(uint16_t frequency_chz)
{
    const double seen_ms = 2 * 100000.0 / frequency_chz + LOOP_MS;
    return (int16_t)(SPEED_MM_MS * seen_ms + SPEED_MM_MS * SPEED_MM_MS / (2 * BRAKE_MM_MS2));
}

static drive_t drive(const rover_config_t *config, unsigned points, unsigned scans)
{
    const tmini_xy_t box[] = {{0, -300}, {length_mm(config->frequency_chz), 300}};
    tmini_field_t field = {.corners = box,
                           .corner_count = 2,
                           .points = (uint8_t)points,
                           .scans = (uint8_t)scans,
                           .max_age_ms = (uint16_t)(300000u / config->frequency_chz)};
    const tmini_fields_t fields = {.list = &field, .count = 1};
    drive_t result = {.gap_mm = BEGIN_MM};
    double speed = 0;
    bool may_drive = false;
    rover_init(config, &fields);
    for (unsigned ms = 0; ms < 9000 && result.gap_mm > 0; ms++) {
        const rover_hall_t hall = {.wall_mm = result.gap_mm};
        if (ms % 10 == 0 && (ms == 0 || speed > 0)) {
            rover_furnish(&hall);
        }
        (void)rover_pass();
        if (ms % LOOP_MS == 0) {
            may_drive = tmini_field_state(&field, rover_now_ms()) == TMINI_FIELD_FREE;
        }
        speed += may_drive ? BRAKE_MM_MS2 : -BRAKE_MM_MS2;
        speed = speed < 0 ? 0 : speed > SPEED_MM_MS ? SPEED_MM_MS : speed;
        result.fastest = speed > result.fastest ? speed : result.fastest;
        result.gap_mm -= speed;
    }
    result.has_stood = speed == 0;
    return result;
}

static void drive_with_each_figure(unsigned random_percent)
{
    static const uint16_t frequencies_chz[] = {600, 1000};
    static const unsigned scans[] = {1, 3, 5};
    for (unsigned i = 0; i < 24; i++) {
        const rover_config_t config = {frequencies_chz[i / 12], random_percent, 7 + i};
        const unsigned points = 1 + i % 4;
        const drive_t end = drive(&config, points, scans[i / 4 % 3]);
        char name[80];
        (void)snprintf(name, sizeof name, "%u Hz, K %u, N %u: %d mm", config.frequency_chz / 100u,
                       points, scans[i / 4 % 3], (int)end.gap_mm);
        TEST_ASSERT_TRUE_MESSAGE(end.gap_mm > 0, name);
        if (random_percent == 0) {
            TEST_ASSERT_TRUE_MESSAGE(end.has_stood, name);
            TEST_ASSERT_TRUE_MESSAGE(end.fastest == SPEED_MM_MS, name);
            TEST_ASSERT_TRUE_MESSAGE(end.gap_mm < length_mm(config.frequency_chz), name);
        }
    }
}

void test_a_robot_at_1_m_s_stops_before_a_wall(void)
{
    drive_with_each_figure(0);
}

void test_it_does_so_when_5_percent_of_the_points_are_random(void)
{
    drive_with_each_figure(5);
}

/* The check can fail: more points than the wall has. */
void test_a_robot_whose_field_is_never_occupied_hits_the_wall(void)
{
    const rover_config_t config = {1000, 0, 7};
    TEST_ASSERT_TRUE(drive(&config, 255, 3).gap_mm <= 0);
}
