/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The obstacle stop of the examples: when may the robot move? test_fields.c has the fields. */

#include "obstacle.h"

#include "rows.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define DEGREE_Q6 64u

static obstacle_t obstacle;
static uint32_t now_ms;

void setUp(void)
{
    obstacle = (obstacle_t){.moves = false};
    now_ms = 1000;
}

/* Three scans, 100 ms apart, with something ten degrees wide at this distance and angle, and 2 m
 * all around. */
static void see(uint16_t distance_mm, unsigned degrees)
{
    static tmini_point_t points[40];
    tmini_scan_t scan = {.points = points, .count = 40, .complete = true};
    for (uint16_t i = 0; i < 40; i++) {
        points[i] =
            (tmini_point_t){.angle_q6 = (uint16_t)(i * 9u * DEGREE_Q6), .distance_mm = 2000};
    }
    for (unsigned i = 0; i < 2; i++) {
        const unsigned place = (degrees + 9 * i) / 9 % 40;
        points[place].angle_q6 = (uint16_t)((degrees + 5 * i) % 360 * DEGREE_Q6);
        points[place].distance_mm = distance_mm;
    }
    for (unsigned i = 0; i < 3; i++) {
        now_ms += 100;
        scan.end_ms = now_ms;
        obstacle_see(&obstacle, &scan);
    }
}

/* MM@DEGREES: that is seen; wait:MS; blind: the lidar is; go, stop: whether it may move then. */
static void tell(char *word)
{
    const row_number_t nearest_mm[] = {
        {"front", obstacle.sectors[0].nearest_mm},
        {"right", obstacle.sectors[2].nearest_mm},
    };
    if (strchr(word, '@') != NULL) {
        see((uint16_t)atoi(word), (unsigned)atoi(strchr(word, '@') + 1));
    } else if (row_is(word, "wait")) {
        now_ms += row_number(word);
    } else if (row_is(word, "blind")) {
        obstacle_blind(&obstacle);
    } else if (!row_expects(word, nearest_mm)) {
        TEST_ASSERT_EQUAL_STRING(obstacle_may_move(&obstacle, now_ms) ? "go" : "stop", word);
    }
}

static const row_t rows[] = {
    ROW(it_may_move_when_complete_scans_have_seen_that_the_way_is_free, "stop 2000@0 go"),
    ROW(what_is_before_it_stops_it, "290@0 stop 290@20 stop 290@335 stop"),
    ROW(what_is_beside_it_does_not, "200@50 go 100@180 go 200@305 go"),
    ROW(once_stopped_it_needs_more_room_to_go_on,
        "360@0 go 310@0 go 290@0 stop 340@0 stop 360@0 go"),
    ROW(it_stops_when_three_turns_bring_no_complete_scan, "2000@0 go wait:300 go wait:1 stop"),
    ROW(a_blind_robot_may_not_move, "2000@0 go blind stop"),
    ROW(each_sector_knows_its_nearest_point, "700@90 right:700 front:2000"),
};

void test_rows(void)
{
    tell_rows(rows, tell);
}
