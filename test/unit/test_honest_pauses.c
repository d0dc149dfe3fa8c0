/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar at 12 Hz of which one turn is missing, from the end of a packet on; the packets before
 * and after it fit together. With earlier versions, the programs here (played in virtual time) got
 * complete scans of two revolutions. */

#include "encoder.h"

#include "tmini/tmini.h"
#include "unity.h"

#include <string.h>

#define PACKETS 10u /* Per turn: a start packet, eight of 40 samples and one of 12. */
#define POINTS 333u /* Per turn. */
#define TURN_US (POINTS * 250u)
#define TURNS 8u
#define STREAM_MAX (TURNS * 1200u)

/* The properties of a program, and where the turn is missing. */
typedef struct {
    size_t ring;
    uint32_t poll_us;
    uint32_t phase_us;  /* Time of the first poll. */
    int32_t clock_ppm;  /* The clock is too fast by this much. */
    uint16_t limit_ms;  /* max_pause_ms. */
    unsigned missing;   /* A turn is missing after this packet. */
    uint32_t hold_us;   /* Bytes are held up for this time. */
    uint32_t before_us; /* The hold-up begins this time before the missing turn. */
    uint32_t pause_us;  /* The program does not poll for this time. */
    uint32_t pause_at_us;
    bool reports; /* A layer below keeps bytes that find no room, and reports them. */
} program_t;

static uint8_t line[STREAM_MAX];
static uint32_t at_us[STREAM_MAX];
static size_t line_size;
static uint32_t silent_us; /* When the missing turn begins. */

static tmini_t lidar;
static tmini_timing_t timing;
static uint8_t rx[65536];
static tmini_point_t points[800];
static const program_t *program;
static uint64_t now_us;

static unsigned scans;
static unsigned complete;
static unsigned mixed; /* Scans with points of two turns. */
static unsigned lies;  /* Mixed scans that are called complete. */

void setUp(void)
{
    scans = complete = mixed = lies = 0;
}

void tearDown(void) {}

/* ---- The lidar ---- */

static void send_packet(uint32_t sent_us, unsigned index, uint16_t turn)
{
    static const encode_turn_t frequency = {.frequency_dhz = 120};
    const unsigned count = index == 0 ? 1 : index == PACKETS - 1 ? 12 : 40;
    const unsigned before = index == 0 ? 0 : 1 + 40 * (index - 1);
    encode_sample_t samples[40];
    const encode_packet_t packet = {index == 0 ? encode_ct(&frequency, 0) : 0, (uint8_t)count,
                                    (uint16_t)(before * 69), (uint16_t)((before + count - 1) * 69),
                                    samples};

    for (unsigned i = 0; i < count; i++) {
        samples[i] = (encode_sample_t){turn, 9, 0};
    }
    const size_t size = encode_packet(&line[line_size], &packet);
    for (size_t i = 0; i < size; i++) {
        at_us[line_size++] = sent_us + (uint32_t)(i + 1) * 43u;
    }
}

/* Turns 1 to TURNS; packets of the third and the fourth are missing. */
static void send_turns(unsigned missing)
{
    uint32_t measured_us = 0;

    line_size = 0;
    for (unsigned packet = 0; packet < TURNS * PACKETS; packet++) {
        const unsigned index = packet % PACKETS;

        measured_us += 250u * (index == 0 ? 1 : index == PACKETS - 1 ? 12 : 40);
        if (packet <= 2 * PACKETS + missing || packet > 3 * PACKETS + missing) {
            send_packet(measured_us, index, (uint16_t)(1 + packet / PACKETS));
        } else if (packet == 2 * PACKETS + missing + 1) {
            silent_us = at_us[line_size - 1];
        }
    }
}

/* ---- The program ---- */

static int take_command(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    (void)bytes;
    return (int)count;
}

static uint32_t read_clock(void *context)
{
    (void)context;
    return (uint32_t)(now_us * (uint64_t)(1000000 + program->clock_ppm) / 1000000000u);
}

static const tmini_port_t port = {.write = take_command, .now_ms = read_clock};

static void judge(const tmini_scan_t *scan)
{
    bool is_mixed = false;

    for (unsigned i = 1; i < scan->count; i++) {
        is_mixed |= scan->points[i].distance_mm != scan->points[0].distance_mm;
    }
    scans++;
    complete += scan->complete ? 1 : 0;
    mixed += is_mixed ? 1 : 0;
    lies += is_mixed && scan->complete ? 1 : 0;
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

    timing = tmini_timing_default;
    timing.max_pause_ms = program->limit_ms;
    const tmini_config_t config = {.port = &port,
                                   .rx_buffer = rx,
                                   .rx_size = program->ring,
                                   .points = points,
                                   .max_points = 800,
                                   .timing = &timing};

    now_us = 1000000;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
    (void)tmini_start(&lidar);
    for (unsigned ms = 0; ms < 100; ms++, now_us += 1000) {
        poll();
    }
    (void)tmini_feed(&lidar, reply, encode_frequency_reply(reply, 600));
    poll();
    (void)tmini_feed(&lidar, reply, encode_scan_reply(reply));
    poll();
}

static bool is_held_up(uint32_t us)
{
    const uint32_t from_us = silent_us - program->before_us;

    return us >= from_us && us < from_us + program->hold_us;
}

static bool is_away(uint32_t us)
{
    return us >= program->pause_at_us && us < program->pause_at_us + program->pause_us;
}

/* Feeds the bytes that have arrived, from the byte `fed` on, as far as there is room. */
static size_t feed_arrived(size_t fed, uint32_t us)
{
    size_t arrived = fed;

    while (arrived < line_size && at_us[arrived] <= us) {
        arrived++;
    }
    fed += tmini_feed(&lidar, &line[fed],
                      arrived - fed < tmini_feed_room(&lidar) || !program->reports
                          ? arrived - fed
                          : tmini_feed_room(&lidar));
    if (program->reports) {
        tmini_feed_held(&lidar, arrived - fed);
    }
    return fed;
}

/* Feeds the line's bytes in steps of half a millisecond, with polls until after its end. */
static void play(const program_t *to_play)
{
    size_t fed = 0;

    program = to_play;
    send_turns(program->missing);
    start();
    const uint64_t since_us = now_us;
    uint32_t next_poll_us = program->phase_us;
    for (uint32_t us = 0; us < at_us[line_size - 1] + 2 * program->poll_us; us += 500) {
        now_us = since_us + us;
        if (!is_held_up(us)) {
            fed = feed_arrived(fed, us);
        }
        if (us >= next_poll_us && !is_away(us)) {
            next_poll_us = us + program->poll_us;
            poll();
        }
    }
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
}

/* ---- The receiving task is held up before the silence ---- */

void test_a_receiver_that_is_held_up_before_a_silence_mixes_no_turns(void)
{
    program_t held = {.ring = 1024, .poll_us = 1000, .limit_ms = 30};

    for (held.missing = 1; held.missing < PACKETS; held.missing++) {
        for (held.hold_us = 60000; held.hold_us <= 100000; held.hold_us += 5000) {
            for (held.before_us = 0; held.before_us <= 40000; held.before_us += 4000) {
                play(&held);
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, mixed);
}

/* ---- A silence of a turn between two polls ---- */

static void play_at_all_moments(program_t rare)
{
    for (rare.missing = 0; rare.missing < PACKETS; rare.missing++) {
        for (uint32_t i = 0; i < 50; i++) {
            rare.phase_us = rare.poll_us / 50 * i;
            play(&rare);
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, lies);
}

void test_rare_polls_mix_no_turns_even_with_a_slow_clock(void)
{
    static const program_t rare[] = {
        {.ring = 8192, .poll_us = 350000, .clock_ppm = -30000, .limit_ms = 30},
        {.ring = 8192, .poll_us = 350000, .clock_ppm = -25000, .limit_ms = 30},
        {.ring = 8192, .poll_us = 350000, .clock_ppm = -20000, .limit_ms = 30},
        {.ring = 8192, .poll_us = 500000, .limit_ms = 30},
        {.ring = 16384, .poll_us = 700000, .limit_ms = 30},
        {.ring = 65536, .poll_us = 1100000, .limit_ms = 30},
    };

    for (unsigned i = 0; i < sizeof rare / sizeof rare[0]; i++) {
        play_at_all_moments(rare[i]);
    }
}

/* ---- A limit that does not detect a silence of a turn ---- */

void test_a_raised_or_switched_off_limit_makes_no_scan_of_two_turns_complete(void)
{
    static const uint16_t limits_ms[] = {70, 100, 250, 0};

    for (unsigned i = 0; i < 4; i++) {
        for (uint32_t poll_us = 1000; poll_us <= 38000; poll_us = poll_us * 3) {
            play_at_all_moments(
                (program_t){.ring = 2048, .poll_us = poll_us, .limit_ms = limits_ms[i]});
        }
    }
    TEST_ASSERT_TRUE(mixed > 0); /* The silence was not detected. */
}

/* ---- Bytes that a port holds while the ring is full ---- */

/* A port's buffer of 2048 bytes lasts somewhat longer than 127 ms; 300 ms are possible with 8192
 * bytes. */
void test_a_pause_of_the_program_that_the_port_bridges_costs_no_scan(void)
{
    static const uint32_t pauses_us[] = {60000, 110000, 127000, 300000};

    for (unsigned i = 0; i < 4; i++) {
        program_t bridged = {.ring = 1024,
                             .poll_us = 2000,
                             .limit_ms = 30,
                             .missing = TURNS * PACKETS,
                             .pause_us = pauses_us[i],
                             .reports = true};

        for (uint32_t us = 0; us < TURN_US; us += 4000) {
            complete = 0;
            bridged.pause_at_us = TURN_US + us;
            play(&bridged);
            TEST_ASSERT_EQUAL_UINT(TURNS - 1, complete);
        }
    }
}

/* The ring takes the first bytes that came during the pause. The silence may be among the rest,
 * which comes into the ring after the pause has been judged. */
void test_a_silence_among_bytes_that_the_port_holds_mixes_no_turns(void)
{
    static const uint16_t limits_ms[] = {30, 250, 0};

    for (unsigned i = 0; i < 3; i++) {
        program_t bridged = {.ring = 1024,
                             .poll_us = 1000,
                             .limit_ms = limits_ms[i],
                             .pause_us = 300000,
                             .reports = true};

        for (bridged.missing = 0; bridged.missing < PACKETS; bridged.missing++) {
            for (uint32_t us = 0; us < 2 * TURN_US; us += 4000) {
                bridged.pause_at_us = TURN_US + us;
                play(&bridged);
            }
        }
        TEST_ASSERT_EQUAL_UINT(0, lies);
    }
}
