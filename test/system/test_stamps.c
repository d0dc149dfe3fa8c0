/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The accuracy of start_ms of scans and of tmini_point_time_us() of their points, for programs that
 * poll every 1, 10 and 38 ms. The figures in tmini_units.h and docs/results.md come from the rows
 * that these tests print. */

#include "bed.h"
#include "judge_scan.h"

#include "tmini/tmini_units.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define TURNS 60u
#define SAMPLE_US 250

static bed_t bed;
static watch_t watch;
static sim_judge_t judge;
static random_t random;
static uint64_t measures_us; /* When the first sample is begun. */

/* Errors in milliseconds, positive if later than the truth. */
typedef struct {
    double least;
    double most;
    unsigned count;
} errors_t;

static errors_t starts;
static errors_t inside;
static unsigned parts; /* Scans without a start packet. */

/* ---- The lidar ---- */

static void see_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    (void)sim_judge_sent(&judge, packet);
}

static void see_command(void *context, uint8_t code, uint64_t now_us)
{
    const sim_config_t *const lidar = &bed.sim.config;
    (void)context;
    if (code == SIM_COMMAND_START) {
        measures_us = now_us + (lidar->reply_latency_ms + lidar->first_packet_ms) * 1000u;
    }
}

/* A tenth of the packets is lost, and every tenth turn. */
static bool loses(void *context, const sim_run_t *run, size_t i)
{
    static bool is_lost;
    (void)context;
    if (run->offset + i == 0) {
        is_lost = run->packet != NULL &&
                  (random_below(&random, 10) == 0 || run->packet->revolution % 10 == 9);
    }
    return is_lost;
}

/* Turns differ by up to 0.6 % (section 9.8). */
static void start(uint16_t frequency_chz)
{
    static const sim_observer_t observer = {.on_packet = see_packet, .on_command = see_command};
    sim_config_t lidar = bed_quiet_lidar();
    lidar.marked = true;
    lidar.frequency_chz = frequency_chz;
    lidar.spin_up_percent = 100;
    lidar.wobble_permille = 6;
    TEST_ASSERT_TRUE(bed_init(&bed, &lidar));
    sim_observe(&bed.sim, &observer);
    sim_judge_begin(&judge);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, bed_start(&bed));
}

/* ---- The program ---- */

static void note(errors_t *errors, double error_ms)
{
    errors->least = errors->count == 0 || error_ms < errors->least ? error_ms : errors->least;
    errors->most = errors->count == 0 || error_ms > errors->most ? error_ms : errors->most;
    errors->count++;
}

/* A point is measured in the middle of its sample's 250 us. */
static void judge_times(const void *data, tmini_scan_t *scan)
{
    const uint32_t clock_ms = bed.port.now_ms(&bed) - bed_ms(&bed); /* When the test began. */
    const double start_ms = scan->start_ms - clock_ms;
    sim_reading_t reading = {0};
    (void)data;
    for (unsigned i = 0; i < scan->count; i++) {
        judge_point(&judge, &reading, &scan->points[i]);
        note(&inside, tmini_point_time_us(scan, i) / 1000.0 -
                          (reading.last - reading.first) * SAMPLE_US / 1000.0);
    }
    TEST_ASSERT_EQUAL_UINT(0, reading.lies);
    parts += sim_judge_sample(&judge, reading.first)->starts ? 0 : 1;
    note(&starts, start_ms - (measures_us + (reading.first + 0.5) * SAMPLE_US) / 1000);
}

/* The polls are aligned neither with the clock's milliseconds nor with the packets. */
static void play(uint16_t frequency_chz, uint32_t poll_ms, bool is_damaged)
{
    starts = inside = (errors_t){0, 0, 0};
    parts = 0;
    memset(&watch, 0, sizeof watch);
    watch.line = sim_link_default_config();
    watch.loses = is_damaged ? loses : NULL;
    random_seed(&random, 1);
    bed_prepare(&bed);
    bed.watch = &watch;
    bed.poll_ms = poll_ms;
    bed.config.step = judge_times;
    bed.later_us = 1 + poll_ms * 3 % 7;
    start(frequency_chz);
    while (bed.sim.revolution < TURNS) {
        bed_step(&bed);
    }
    TEST_ASSERT_NULL(watch.wrong);
    printf("%2u Hz, polls of %2u ms, %s: start_ms %+5.1f to %+5.1f ms, points %+4.2f to %+4.2f ms; "
           "%u scans, %u of them parts\n",
           frequency_chz / 100u, (unsigned)poll_ms, is_damaged ? "damaged" : "healthy",
           starts.least, starts.most, inside.least, inside.most, starts.count, parts);
}

/* `latest_ms`: the most that start_ms may be late. */
static void play_all(bool is_damaged, double latest_ms)
{
    static const uint32_t polls_ms[] = {1, 10, 38};
    static const uint16_t frequencies_chz[] = {600, 1200};
    static const double most_ms[] = {1.5, 1.0};
    for (unsigned i = 0; i < 6; i++) {
        play(frequencies_chz[i % 2], polls_ms[i / 2], is_damaged);
        TEST_ASSERT_TRUE(inside.least >= -most_ms[i % 2] && inside.most <= most_ms[i % 2]);
        TEST_ASSERT_TRUE(starts.least >= -1 && starts.most <= latest_ms);
        TEST_ASSERT_TRUE(starts.count > TURNS / 2);
        TEST_ASSERT_EQUAL(is_damaged, parts > 5);
        TEST_ASSERT_TRUE(is_damaged || parts == 0);
    }
}

void test_points_of_whole_scans_have_the_right_times(void)
{
    play_all(false, 12);
}

void test_points_of_partial_scans_have_the_right_times_relative_to_the_first(void)
{
    play_all(true, 24);
}
