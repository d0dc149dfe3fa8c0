/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The accuracy of start_ms of scans and of tmini_point_time_us() of their points, for programs that
 * poll every 1, 10 and 38 ms. The figures in tmini_units.h and docs/results.md come from the rows
 * that these tests print. */

#include "encoder.h"
#include "random.h"

#include "tmini/tmini.h"
#include "tmini/tmini_units.h"
#include "unity.h"

#include <stdio.h>

#define TURNS 60u
#define STREAM_MAX (TURNS * 2300u)
#define SAMPLE_US 250
#define BYTE_US 43.4

static uint8_t line[STREAM_MAX];
static double at_us[STREAM_MAX]; /* When the last bit of each byte was on the wire. */
static size_t line_size;
static uint32_t first_sample[TURNS]; /* Of each turn, counted from the beginning. */

static tmini_t lidar;
static uint8_t rx[1024];
static tmini_point_t points[800];
static double now_us;
static random_t random;

/* Errors in milliseconds, positive if later than the truth. */
typedef struct {
    double least;
    double most;
    unsigned count;
} errors_t;

static errors_t starts;
static errors_t inside;
static unsigned parts; /* Scans without a start packet. */

void setUp(void)
{
    random_seed(&random, 1);
}

void tearDown(void) {}

/* ---- The lidar ---- */

/* The distance of a sample is its index in its turn; its intensity is the number of the turn. A
 * packet is sent when its last sample has been measured. */
static void send_packet(unsigned turn, unsigned first, unsigned count, unsigned of, uint8_t ct)
{
    encode_sample_t samples[40];
    const encode_packet_t packet = {ct, (uint8_t)count, (uint16_t)(first * 23040u / of),
                                    (uint16_t)((first + count - 1) * 23040u / of), samples};
    const double measured_us = (double)(first_sample[turn] + first + count) * SAMPLE_US;
    const double free_us = line_size > 0 ? at_us[line_size - 1] : 0;
    const double begun_us = measured_us > free_us ? measured_us : free_us;

    for (unsigned i = 0; i < count; i++) {
        samples[i] = (encode_sample_t){(uint16_t)(first + i), (uint8_t)turn, 0};
    }
    const size_t size = encode_packet(&line[line_size], &packet);
    for (size_t i = 0; i < size; i++) {
        at_us[line_size++] = begun_us + (double)(i + 1) * BYTE_US;
    }
}

/* One packet in `one_in` is lost on the line; 0: none. */
static bool is_lost(unsigned one_in)
{
    return one_in > 0 && random_below(&random, one_in) == 0;
}

/* Turns differ by up to 0.6 % (section 9.8); the start packet reports the frequency of the turn
 * before, in 0.1 Hz. If packets are lost, every tenth turn is lost too. */
static void send_turns(uint32_t frequency_dhz, unsigned lost_one_in)
{
    uint32_t sample = 0;
    uint32_t before = 40000 / frequency_dhz;

    line_size = 0;
    for (unsigned turn = 0; turn < TURNS; turn++) {
        const uint32_t mean = 40000 / frequency_dhz;
        const uint32_t of = mean - mean / 300 + random_below(&random, mean / 150 + 1);
        const encode_turn_t frequency = {.frequency_dhz =
                                             (uint16_t)((40000 + before / 2) / before)};

        first_sample[turn] = sample;
        for (unsigned first = 0; first < of;) {
            const unsigned count = first == 0 ? 1 : of - first < 40 ? of - first : 40;

            if (!is_lost(lost_one_in) && (lost_one_in == 0 || turn % 10 != 9)) {
                send_packet(turn, first, count, of, first == 0 ? encode_ct(&frequency, 0) : 0);
            }
            first += count;
        }
        sample += of;
        before = of;
    }
}

/* ---- The program ---- */

static int take_command(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    (void)bytes;
    return (int)count;
}

#define BEGIN_US 1e6

static uint32_t read_clock(void *context)
{
    (void)context;
    return (uint32_t)(now_us / 1000);
}

static const tmini_port_t port = {.write = take_command, .now_ms = read_clock};

static const tmini_config_t config = {
    .port = &port, .rx_buffer = rx, .rx_size = sizeof rx, .points = points, .max_points = 800};

static void note(errors_t *errors, double error_ms)
{
    errors->least = errors->count == 0 || error_ms < errors->least ? error_ms : errors->least;
    errors->most = errors->count == 0 || error_ms > errors->most ? error_ms : errors->most;
    errors->count++;
}

/* When a point was measured: in the middle of its sample's 250 us. */
static double measured_us(const tmini_point_t *point)
{
    return (first_sample[point->intensity] + point->distance_mm + 0.5) * SAMPLE_US;
}

static void judge(const tmini_scan_t *scan)
{
    const double start_us = measured_us(&scan->points[0]);

    parts += scan->points[0].distance_mm > 0 ? 1 : 0;
    note(&starts, scan->start_ms - (BEGIN_US + start_us) / 1000);
    for (unsigned i = 0; i < scan->count; i++) {
        const double apart_us = measured_us(&scan->points[i]) - start_us;

        note(&inside, (tmini_point_time_us(scan, i) - apart_us) / 1000);
    }
}

static void poll(void)
{
    tmini_event_t event;

    while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
        if (event == TMINI_EVENT_SCAN) {
            judge(tmini_scan(&lidar));
        }
    }
}

static void start(void)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
    now_us = BEGIN_US - 100e3;
    (void)tmini_start(&lidar);
    for (; now_us < BEGIN_US; now_us += 1000) {
        poll();
    }
    (void)tmini_feed(&lidar, reply, encode_scan_reply(reply));
    poll();
}

/* The polls are aligned neither with the clock's milliseconds nor with the packets. */
static void play(uint32_t frequency_dhz, double poll_us, unsigned lost_one_in)
{
    size_t fed = 0;

    starts = inside = (errors_t){0, 0, 0};
    parts = 0;
    send_turns(frequency_dhz, lost_one_in);
    start();
    while (fed < line_size) {
        now_us += poll_us;
        for (; fed < line_size && BEGIN_US + at_us[fed] <= now_us; fed++) {
            tmini_feed_byte(&lidar, line[fed]);
        }
        poll();
    }
    printf("%2u Hz, polls of %2u ms, %s: start_ms %+5.1f to %+5.1f ms, points %+4.2f to %+4.2f ms; "
           "%u scans, %u of them parts\n",
           (unsigned)frequency_dhz / 10, (unsigned)(poll_us / 1000),
           lost_one_in > 0 ? "damaged" : "healthy", starts.least, starts.most, inside.least,
           inside.most, starts.count, parts);
}

static void play_all(unsigned lost_one_in)
{
    static const double polls_us[] = {1000.7, 10001.3, 38003.1};

    for (unsigned i = 0; i < 3; i++) {
        play(60, polls_us[i], lost_one_in);
        TEST_ASSERT_TRUE(inside.least >= -1.5 && inside.most <= 1.5);
        play(120, polls_us[i], lost_one_in);
        TEST_ASSERT_TRUE(inside.least >= -1.0 && inside.most <= 1.0);
    }
}

void test_points_of_whole_scans_have_the_right_times(void)
{
    play_all(0);
    TEST_ASSERT_TRUE(starts.least >= -1 && starts.most <= 12); /* With polls every 38 ms. */
    TEST_ASSERT_EQUAL_UINT(0, parts);
}

void test_points_of_partial_scans_have_the_right_times_relative_to_the_first(void)
{
    play_all(10);
    TEST_ASSERT_TRUE(starts.least >= -1 && starts.most <= 24);
    TEST_ASSERT_TRUE(parts > 5);
}
