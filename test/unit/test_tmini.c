/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The driver as a whole: set-up, feeding, events and results, the clock, and wrong use. */

#include "invariants.h"
#include "known_packets.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

#include <string.h>

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

/* ---- Setting up, and wrong use ---- */

static void refuses_all_commands(tmini_t *lidar)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_start(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_stop(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_request_info(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_request_health(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_request_frequency(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_set_frequency(lidar, 700));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_reboot(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_UNKNOWN, tmini_state(lidar));
}

void test_a_null_pointer_and_a_lidar_never_set_up_refuse_every_command(void)
{
    static tmini_t untouched;

    refuses_all_commands(NULL);
    refuses_all_commands(&untouched);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&untouched));
    TEST_ASSERT_EQUAL_UINT32(0, tmini_next_poll_ms(&untouched));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(NULL, &rig.config));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_decoder_init(NULL, &rig.lidar.ring, 0));
}

static void is_refused(const tmini_config_t *config)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(&rig.lidar, config));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_start(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    tmini_feed_byte(&rig.lidar, 1);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed(&rig.lidar, (const uint8_t *)"12", 2));
}

void test_a_lidar_that_was_refused_stores_nothing(void)
{
    is_refused(NULL);
    rig.config.spare_points = rig.config.points; /* One buffer for two scans. */
    is_refused(&rig.config);
}

void test_more_points_than_can_be_counted_are_refused(void)
{
    if (SIZE_MAX > 65535u) {
        rig.config.max_points = (size_t)65535u + 1;
        is_refused(&rig.config);
        rig.config.max_points = (size_t)65535u + 2; /* In 16 bits it would be 1. */
        is_refused(&rig.config);
    }
}

void test_a_lidar_never_set_up_counts_bytes_as_refused_and_has_empty_results(void)
{
    static tmini_t untouched;
    const uint8_t bytes[4] = {1, 2, 3, 4};
    size_t size = 1;
    tmini_counters_t seen;
    tmini_ct_info_t turn;

    tmini_feed_byte(&untouched, 0xAA);
    tmini_feed(&untouched, bytes, sizeof bytes);
    tmini_feed_dma(&untouched, 0);
    tmini_counters(&untouched, &seen);
    tmini_ct_info(&untouched, &turn);
    TEST_ASSERT_EQUAL_UINT32(5, seen.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(0, seen.bytes_pending);
    TEST_ASSERT_EQUAL_UINT32(0, seen.packets);
    TEST_ASSERT_EQUAL_HEX16(0, turn.known);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&untouched)->count);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&untouched));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_command_error(&untouched));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&untouched));
    TEST_ASSERT_NULL(tmini_rx_buffer(&untouched, &size));
    TEST_ASSERT_EQUAL_size_t(0, size);
}

void test_a_port_that_restarts_dma_finds_buffer_and_position(void)
{
    size_t size = 0;
    rig.config.rx_dma = true;
    rig.config.max_samples = 39;
    rig_init();
    TEST_ASSERT_EQUAL_PTR(rig.config.rx_buffer, tmini_rx_buffer(&rig.lidar, &size));
    TEST_ASSERT_EQUAL_size_t(rig.config.rx_size, size);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed_position(&rig.lidar));
    tmini_feed_dma(&rig.lidar, 100);
    TEST_ASSERT_EQUAL_size_t(100, tmini_feed_position(&rig.lidar));
    tmini_feed_dma(&rig.lidar, 30); /* A position in the next lap. */
    TEST_ASSERT_EQUAL_size_t(rig.config.rx_size + 30, tmini_feed_position(&rig.lidar));
    tmini_feed_gap(&rig.lidar);
    TEST_ASSERT_EQUAL_size_t(2 * rig.config.rx_size + 30, tmini_feed_position(&rig.lidar));
}

void test_without_dma_no_port_gets_the_receive_buffer(void)
{
    size_t size = 1;
    rig_init();
    TEST_ASSERT_NULL(tmini_rx_buffer(&rig.lidar, &size));
    TEST_ASSERT_EQUAL_size_t(0, size);
}

/* ---- Feeding ---- */

void test_single_bytes_blocks_and_dma_bring_the_same_packet(void)
{
    for (unsigned way = 0; way < 3; way++) {
        rig.config.points = NULL;
        rig.config.max_points = 0;
        rig.config.rx_dma = way == 2;
        rig.config.max_samples = 39;
        rig_init();
        rig_go_idle();
        begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
        size_t position = encode_frequency_reply(rig.rx, 600);
        if (way == 2) {
            tmini_feed_dma(&rig.lidar, position);
        } else {
            rig_feed_frequency(600);
        }
        polls_and_sends(START);
        if (way == 0) {
            for (size_t i = 0; i < sizeof start_packet; i++) {
                tmini_feed_byte(&rig.lidar, start_packet[i]);
            }
        } else if (way == 1) {
            tmini_feed(&rig.lidar, start_packet, sizeof start_packet);
        } else {
            memcpy(&rig.rx[position], start_packet, sizeof start_packet);
            position += sizeof start_packet;
            tmini_feed_dma(&rig.lidar, position);
        }
        polls_to(TMINI_EVENT_STARTED);
        polls_to(TMINI_EVENT_PACKET);
        tmini_point_t point;
        TEST_ASSERT_TRUE(tmini_packet_point(tmini_packet(&rig.lidar), 0, &point));
        TEST_ASSERT_EQUAL_UINT16(31, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT16(149, point.distance_mm);
        TEST_ASSERT_EQUAL_UINT8(21, point.intensity);
        polls_to(TMINI_EVENT_NONE);
    }
}

/* Bytes are not read before a poll, so the memory need not exist. */
void test_pending_bytes_may_be_more_than_16_bits_count(void)
{
    if (SIZE_MAX > 65535u) {
        rig.config.rx_size = (size_t)0x10000u * 4;
        rig.config.rx_dma = true;
        rig_init();
        tmini_feed_dma(&rig.lidar, (size_t)0x10000u + 300);
        TEST_ASSERT_EQUAL_UINT32(65836u, rig_counters().bytes_pending);
        rig_open();
    }
}

/* As after weeks: each counter has a different value near the end of its range. */
void test_counters_count_to_the_end_of_their_ranges(void)
{
    tmini_parser_counters_t *const parser = &rig.lidar.decoder.parser.counters;
    parser->packets = 4294967290u;
    parser->checksum_errors = 4294967291u;
    parser->bytes_in_packets = 4294967292u;
    parser->bytes_in_replies = 4294967293u;
    parser->bytes_skipped = 4294967294u;
    parser->bytes_overrun = 4294967280u;
    rig.lidar.scans = 4294967281u;
    rig.lidar.decoder.builder.late_scans = 4294967282u;
    rig.lidar.command.timeouts = 65531u;
    rig.lidar.recovery.losses = 65532u;
    rig.lidar.recovery.recoveries = 65533u;
    rig.lidar.recovery.restarts = 65534u;
    rig.lidar.recovery.reboots = 65530u;
    const tmini_counters_t seen = rig_counters();
    TEST_ASSERT_EQUAL_UINT32(4294967290u, seen.packets);
    TEST_ASSERT_EQUAL_UINT32(4294967291u, seen.checksum_errors);
    TEST_ASSERT_EQUAL_UINT32(4294967292u, seen.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT32(4294967293u, seen.bytes_in_replies);
    TEST_ASSERT_EQUAL_UINT32(4294967294u, seen.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(4294967280u, seen.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(4294967281u, seen.scans);
    TEST_ASSERT_EQUAL_UINT32(4294967282u, seen.late_scans);
    TEST_ASSERT_EQUAL_UINT16(65531u, seen.timeouts);
    TEST_ASSERT_EQUAL_UINT16(65532u, seen.losses);
    TEST_ASSERT_EQUAL_UINT16(65533u, seen.recoveries);
    TEST_ASSERT_EQUAL_UINT16(65534u, seen.restarts);
    TEST_ASSERT_EQUAL_UINT16(65530u, seen.reboots);
}

/* ---- Silence ---- */

/* Reading this clock takes so long that bytes come meanwhile. A poll reads it to check for work
 * and, at the latest every 10 ms, a second time to examine the line. */
static unsigned readings_left;
static void (*feed_meanwhile)(void);

static uint32_t slow_clock(void *context)
{
    (void)context;
    readings_left--;
    if (readings_left == 0) {
        feed_meanwhile();
    }
    return rig.now_ms;
}

static void feed_half_a_health_reply(void)
{
    static const uint8_t reply[] = {0xA5, 0x5A, 0x03, 0x00, 0x00};

    rig_feed(reply, sizeof reply);
}

static void polls_with_bytes_at(unsigned reading)
{
    readings_left = reading;
    feed_meanwhile = feed_half_a_health_reply;
    rig.now_ms += 10;
    rig.port.now_ms = slow_clock;
    polls_to(TMINI_EVENT_NONE);
    rig.port.now_ms = port_now_ms;
    TEST_ASSERT_EQUAL_UINT(reading < 2 ? (unsigned)-1 : 0, readings_left);
}

/* According to the clock, the line has been silent for the frame timeout of 100 ms. */
static void bytes_are_not_given_up_that_come_at(unsigned reading)
{
    static const uint8_t rest[] = {0x00, 0x06, 0x00, 0x00, 0x00};

    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    passes(100);
    polls_with_bytes_at(reading);
    rig_feed(rest, sizeof rest);
    polls_to(TMINI_EVENT_HEALTH);
}

void test_bytes_that_come_while_a_poll_reads_the_clock_are_not_given_up(void)
{
    bytes_are_not_given_up_that_come_at(1); /* It looks for news. */
    rig_verify();
    rig_init();
    bytes_are_not_given_up_that_come_at(2); /* It examines the line. */
}

static void feed_health_reply(void)
{
    rig_feed_health(0, 0);
}

/* The next poll must not treat the reply's bytes as new. */
void test_a_reply_that_comes_while_the_clock_is_read_leaves_the_lidar_idle(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    polls_to(TMINI_EVENT_NONE);
    readings_left = 2;
    feed_meanwhile = feed_health_reply;
    rig.now_ms += 10;
    rig.port.now_ms = slow_clock;
    polls_to(TMINI_EVENT_HEALTH);
    rig.port.now_ms = port_now_ms;
    rig.now_ms += 1;
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_IDLE);
}

/* A poll reads the clock once to check for work, and again to examine the line. */
static void reads_the_clock(unsigned times, uint32_t later_ms)
{
    readings_left = 0;
    rig.now_ms += later_ms;
    rig.port.now_ms = slow_clock;
    polls_to(TMINI_EVENT_NONE);
    rig.port.now_ms = port_now_ms;
    TEST_ASSERT_EQUAL_UINT(times, 0 - readings_left);
}

void test_bytes_that_complete_nothing_are_looked_at_every_10_ms(void)
{
    static const uint8_t begin[] = {0xAA, 0x55, 0x00, 0x28};

    rig_go_scanning();
    rig_feed(begin, sizeof begin);
    polls_to(TMINI_EVENT_NONE);
    rig_feed_byte(0x01);
    reads_the_clock(1, 9);
    reads_the_clock(2, 1);
    rig_feed_byte(0x01);
    reads_the_clock(1, 9);
    reads_the_clock(2, 1);
}

static void line_is_not_quiet_with_bytes_at(unsigned reading)
{
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes(49);
    polls_with_bytes_at(reading);
    is_in(TMINI_STATE_STOPPING);
    rig.now_ms += reading - 1; /* Bytes at the second reading are noticed by the next poll. */
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_line_on_which_bytes_come_while_a_poll_reads_the_clock_is_not_quiet(void)
{
    line_is_not_quiet_with_bytes_at(1);
    rig_verify();
    rig_init();
    line_is_not_quiet_with_bytes_at(2);
}

void test_a_byte_that_comes_in_time_keeps_the_candidate(void)
{
    uint8_t bytes[64];
    static const encode_sample_t samples[10] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 10, 640, 1280, samples};
    const size_t size = encode_packet(bytes, &packet);

    for (size_t i = 0; i < size; i++) {
        const uint32_t before = rig_counters().packets;
        rig_feed_byte(bytes[i]);
        passes(99);
        TEST_ASSERT_EQUAL_UINT32(before + (i == size - 1 ? 1 : 0), rig_counters().packets);
    }
}

/* ---- Scans ---- */

/* A turn of a start packet and two point packets, of this distance, 1000 and 1001 mm. */
static void feed_turn(uint16_t start_distance_mm)
{
    rig_feed_start_packet(start_distance_mm);
    rig_feed_point_packet(1000);
    rig_feed_point_packet(1001);
}

void test_a_scan_is_delivered_with_the_start_packet_that_follows_it(void)
{
    rig_go_scanning();
    rig.now_ms = 70000;
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms = 70166;
    feed_turn(800);
    polls_to(TMINI_EVENT_SCAN);
    const tmini_scan_t *const scan = tmini_scan(&rig.lidar);
    TEST_ASSERT_EQUAL_PTR(rig.points, scan->points);
    TEST_ASSERT_EQUAL_UINT16(9, scan->count);
    TEST_ASSERT_EQUAL_UINT16(3, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(600, scan->frequency_chz);
    TEST_ASSERT_EQUAL_UINT32(69997, scan->start_ms); /* 44 bytes have come after it: 3 ms. */
    TEST_ASSERT_EQUAL_UINT32(70163, scan->end_ms);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    TEST_ASSERT_EQUAL_UINT16(700, scan->points[0].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(1000, scan->points[1].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(1001, scan->points[8].distance_mm);
    TEST_ASSERT_EQUAL_UINT32(1, rig_counters().scans);
}

static void feed_start_packet(void)
{
    rig_feed_start_packet(800);
}

/* The packet is the last thing that came before the reading. */
void test_a_packet_that_comes_while_the_clock_is_read_has_the_time_of_that_reading(void)
{
    rig_go_scanning();
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms = 5166;
    readings_left = 2;
    feed_meanwhile = feed_start_packet;
    rig.port.now_ms = slow_clock;
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT32(5166, tmini_scan(&rig.lidar)->end_ms);
}

static uint32_t clock_that_goes_on(void *context)
{
    (void)context;
    rig.now_ms += 5;
    return rig.now_ms;
}

/* The packet has the time of the second reading, when the line is examined. */
void test_a_packet_has_the_time_of_the_poll_however_long_that_takes(void)
{
    rig_go_scanning();
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms = 5166;
    rig_feed_start_packet(800);
    rig.port.now_ms = clock_that_goes_on;
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT32(5176, tmini_scan(&rig.lidar)->end_ms);
}

void test_a_scan_is_valid_until_the_next_poll_whatever_is_fed(void)
{
    rig_go_scanning();
    feed_turn(700);
    feed_turn(800);
    polls_to(TMINI_EVENT_SCAN);
    feed_turn(900);
    TEST_ASSERT_EQUAL_UINT16(9, tmini_scan(&rig.lidar)->count);
    TEST_ASSERT_EQUAL_UINT16(700, tmini_scan(&rig.lidar)->points[0].distance_mm);
    polls_to(TMINI_EVENT_SCAN); /* The next scan begins with the packet that ended this one. */
    TEST_ASSERT_EQUAL_UINT16(9, tmini_scan(&rig.lidar)->count);
    TEST_ASSERT_EQUAL_UINT16(800, tmini_scan(&rig.lidar)->points[0].distance_mm);
}

void test_the_packet_that_ended_a_scan_keeps_its_time_however_late_the_next_poll(void)
{
    rig_go_scanning();
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms = 7000;
    feed_turn(800);
    polls_to(TMINI_EVENT_SCAN);
    rig.now_ms = 7077;
    polls_to(TMINI_EVENT_NONE);
    feed_turn(900);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT32(6997, tmini_scan(&rig.lidar)->start_ms);
}

void test_the_filter_of_the_configuration_is_applied(void)
{
    static const encode_sample_t samples[2] = {{1000, 50, 2}, {2000, 50, 3}};
    const encode_packet_t packet = {0, 2, 640, 672, samples};
    uint8_t bytes[16];

    rig.config.filter = TMINI_FILTER_SPECULAR;
    rig_init();
    rig_go_scanning();
    rig_feed_start_packet(1000);
    rig_feed(bytes, encode_packet(bytes, &packet));
    rig_feed_start_packet(1000);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&rig.lidar)->points[1].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(2000, tmini_scan(&rig.lidar)->points[2].distance_mm);
}

/* ---- Streaming ---- */

static void go_streaming(void)
{
    rig.config.points = NULL;
    rig.config.max_points = 0;
    rig_init();
    rig_go_starting();
}

void test_streaming_brings_an_event_for_each_packet_and_none_for_scans(void)
{
    go_streaming();
    feed_turn(700);
    feed_turn(800);
    polls_to(TMINI_EVENT_STARTED);
    polls_to(TMINI_EVENT_PACKET);
    TEST_ASSERT_TRUE(tmini_packet_is_start(tmini_packet(&rig.lidar)));
    polls_to(TMINI_EVENT_PACKET);
    TEST_ASSERT_FALSE(tmini_packet_is_start(tmini_packet(&rig.lidar)));
    TEST_ASSERT_EQUAL_UINT8(4, tmini_packet(&rig.lidar)->count);
    for (unsigned i = 0; i < 4; i++) {
        polls_to(TMINI_EVENT_PACKET);
    }
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().scans);
}

void test_a_streamed_packet_is_valid_until_the_next_poll_though_its_event_came_second(void)
{
    tmini_point_t points[2];

    go_streaming();
    rig_feed_packet(0x79, 1, 700);
    rig_feed_packet(0, 2, 800);
    polls_to(TMINI_EVENT_STARTED);
    polls_to(TMINI_EVENT_PACKET);
    TEST_ASSERT_EQUAL_UINT(1, tmini_packet_points(tmini_packet(&rig.lidar), 0, points, 2));
    TEST_ASSERT_EQUAL_UINT16(700, points[0].distance_mm);
    polls_to(TMINI_EVENT_PACKET);
    TEST_ASSERT_EQUAL_UINT(2, tmini_packet_points(tmini_packet(&rig.lidar), 0, points, 2));
    TEST_ASSERT_EQUAL_UINT16(800, points[1].distance_mm);
}

/* ---- Results ---- */

void test_setting_up_again_clears_everything(void)
{
    rig_go_recovering();
    rig_init();
    is_in(TMINI_STATE_UNKNOWN);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().losses);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().packets);
    passes(60000);
}

/* ---- Several lidars ---- */

static uint32_t now_of_any(void *context, int calls)
{
    (void)context;
    (void)calls;
    return rig.now_ms;
}

void test_three_lidars_at_once_do_not_affect_each_other(void)
{
    static tmini_t lidars[3];
    static uint8_t rx[3][RIG_RX_SIZE];
    static const uint8_t commands[3][2] = {{0xA5, 0x65}, {0xA5, 0x65}, {0xA5, 0x65}};
    static const uint8_t ask[2] = {0xA5, 0x0D};
    static const uint8_t start[2] = {0xA5, 0x60};
    static const uint8_t info[2] = {0xA5, 0x90};
    uint8_t reply[ENCODE_REPLY_MAX];

    port_now_ms_StubWithCallback(now_of_any);
    for (unsigned i = 0; i < 3; i++) {
        rig.config.rx_buffer = rx[i];
        rig.config.port_context = rx[i];
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidars[i], &rig.config));
        port_write_ExpectAndReturn(rx[i], commands[i], 2, 2);
    }
    begins(tmini_stop(&lidars[0]));
    begins(tmini_start(&lidars[1]));
    begins(tmini_request_info(&lidars[2]));

    rig.now_ms += 50;
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_STOPPED, tmini_poll(&lidars[0]));
    port_write_ExpectAndReturn(rx[1], ask, 2, 2);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[1]));
    port_write_ExpectAndReturn(rx[2], info, 2, 2);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[2]));
    tmini_feed(&lidars[1], reply, encode_frequency_reply(reply, 600));
    port_write_ExpectAndReturn(rx[1], start, 2, 2);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[0]));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[1]));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[2]));

    tmini_feed(&lidars[1], reply, encode_scan_reply(reply));
    tmini_feed(&lidars[2], reply, encode_health_reply(reply, 0, 0)); /* Not the awaited reply. */
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidars[i]));
    }
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_IDLE, tmini_state(&lidars[0]));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_STARTING, tmini_state(&lidars[1]));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_BUSY, tmini_state(&lidars[2]));
}

/* Seven events end a command: STARTED (bit 1) to COMMAND_FAILED (bit 7). The other six, up to SCAN
 * (bit 13), stay. */
void test_a_question_drops_its_own_last_end_and_a_failure_and_nothing_else(void)
{
    rig_go_idle();
    rig.lidar.pending = 0x7FFE;
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX16(0x7F76, rig.lidar.pending);
}

void test_events_are_returned_in_their_order(void)
{
    rig.lidar.pending = 0x7FFE;
    for (unsigned event = TMINI_EVENT_STARTED; event <= TMINI_EVENT_LOST; event++) {
        polls_to(event);
    }
    polls_to(TMINI_EVENT_NONE);
}
