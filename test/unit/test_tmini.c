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

/* ---- Setting up ---- */

void test_a_lidar_just_set_up_is_in_the_unknown_state_and_nothing_has_been_sent(void)
{
    is_in(TMINI_STATE_UNKNOWN);
    passes(10000);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_command_error(&rig.lidar));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&rig.lidar));
}

/* The set-up is refused; later commands are refused too, which is reported once. */
static void is_refused(const tmini_config_t *config)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(&rig.lidar, config));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_start(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_command_error(&rig.lidar));
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_UNKNOWN);
}

void test_no_configuration_is_refused(void)
{
    is_refused(NULL);
}

void test_no_lidar_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(NULL, &rig.config));
}

void test_no_port_is_refused(void)
{
    rig.config.port = NULL;
    is_refused(&rig.config);
}

void test_a_port_without_write_is_refused(void)
{
    rig.port.write = NULL;
    is_refused(&rig.config);
}

void test_a_port_without_a_clock_is_refused(void)
{
    rig.port.now_ms = NULL;
    is_refused(&rig.config);
}

void test_a_port_without_wait_is_enough(void)
{
    rig.port.wait = NULL;
    rig_init();
}

void test_no_receive_buffer_is_refused(void)
{
    rig.config.rx_buffer = NULL;
    is_refused(&rig.config);
}

void test_a_receive_buffer_that_is_no_power_of_two_is_refused(void)
{
    rig.config.rx_size = 255;
    is_refused(&rig.config);
}

void test_a_receive_buffer_too_small_for_the_largest_packet_is_refused(void)
{
    rig.config.rx_size = 128; /* 80 samples are 250 bytes. */
    is_refused(&rig.config);
}

void test_a_smaller_receive_buffer_will_do_for_smaller_packets(void)
{
    rig.config.rx_size = 128;
    rig.config.max_samples = 39; /* Packets of up to 127 bytes. */
    rig_init();
}

void test_with_dma_half_the_buffer_must_hold_the_largest_packet(void)
{
    rig.config.rx_dma = true;
    is_refused(&rig.config);
    rig.config.max_samples = 39;
    rig_init();
}

void test_points_without_room_are_refused(void)
{
    rig.config.max_points = 0;
    is_refused(&rig.config);
}

void test_room_without_points_is_refused(void)
{
    rig.config.points = NULL;
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

void test_one_buffer_for_two_scans_is_refused(void)
{
    rig.config.spare_points = rig.config.points;
    is_refused(&rig.config);
}

void test_a_line_that_is_quiet_only_after_a_stop_has_timed_out_is_refused(void)
{
    tmini_timing_t timing = tmini_timing_default;

    rig.config.timing = &timing;
    timing.quiet_line_ms = 599;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&rig.lidar, &rig.config));
    timing.quiet_line_ms = 600;
    is_refused(&rig.config);
}

void test_an_undefined_filter_is_refused(void)
{
    rig.config.filter = 1;
    is_refused(&rig.config);
}

/* ---- Wrong use ---- */

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

void test_a_null_pointer_is_refused_by_every_command(void)
{
    refuses_all_commands(NULL);
}

void test_a_lidar_never_set_up_is_refused_by_every_command(void)
{
    static tmini_t untouched;

    refuses_all_commands(&untouched);
}

void test_a_lidar_never_set_up_takes_bytes_without_harm_and_has_empty_results(void)
{
    static tmini_t untouched;
    const uint8_t bytes[4] = {1, 2, 3, 4};
    tmini_counters_t seen;
    tmini_ct_info_t turn;

    tmini_feed_byte(&untouched, 0xAA);
    tmini_feed(&untouched, bytes, sizeof bytes);
    tmini_feed_dma(&untouched, 0);
    tmini_counters(&untouched, &seen);
    tmini_ct_info(&untouched, &turn);
    TEST_ASSERT_EQUAL_UINT32(0, seen.bytes_pending);
    TEST_ASSERT_EQUAL_UINT32(0, seen.packets);
    TEST_ASSERT_EQUAL_HEX16(0, turn.known);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&untouched)->count);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&untouched));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_command_error(&untouched));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&untouched));
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

void test_every_byte_is_accounted_for(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed_byte(0x11);         /* 1 skipped */
    rig_feed_health(0, 0);       /* 10 in a reply */
    rig_feed_byte(0x22);         /* 1 skipped */
    rig_feed_point_packet(1000); /* 22 in a packet */
    rig_feed_byte(0xAA);         /* 1 pending */
    (void)rig_drain();
    const tmini_counters_t seen = rig_counters();
    TEST_ASSERT_EQUAL_UINT32(35, rig.fed);
    TEST_ASSERT_EQUAL_UINT32(22, seen.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT32(10, seen.bytes_in_replies);
    TEST_ASSERT_EQUAL_UINT32(2, seen.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(1, seen.bytes_pending);
    TEST_ASSERT_EQUAL_UINT32(0, seen.bytes_overrun);
}

void test_bytes_that_find_the_buffer_full_are_counted(void)
{
    static const uint8_t zeros[RIG_RX_SIZE] = {0};

    rig_feed(zeros, sizeof zeros);
    rig_feed(zeros, 7);
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(7, rig_counters().bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(RIG_RX_SIZE, rig_counters().bytes_skipped);
}

void test_bytes_of_a_second_overflow_are_counted_with_the_first_ones(void)
{
    static const uint8_t zeros[RIG_RX_SIZE] = {0};

    rig_feed(zeros, sizeof zeros);
    rig_feed(zeros, 7);
    (void)rig_drain();
    rig_feed(zeros, sizeof zeros);
    rig_feed(zeros, 5);
    TEST_ASSERT_EQUAL_UINT32(12, rig_counters().bytes_overrun);
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

void test_packets_in_the_unknown_state_are_counted_but_are_no_event(void)
{
    rig_feed_start_packet(1000);
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(1, rig_counters().packets);
    is_in(TMINI_STATE_UNKNOWN);
}

/* The stop was lost on the wire during spin-up, when the line was quiet anyway. */
void test_an_idle_lidar_that_streams_is_reported_and_stopped_again(void)
{
    rig_go_idle();
    passes(500); /* Earlier packets may have been held by a layer below. */
    rig_feed_start_packet(1000);
    sends(STOP);
    polls_to(TMINI_EVENT_UNWANTED_SCANNING);
    was_sent();
    is_in(TMINI_STATE_STOPPING);
    rig_feed_point_packet(1000); /* The tail is not reported. */
    polls_to(TMINI_EVENT_NONE);
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE);
    passes(500);
    rig_feed_point_packet(1000);
    sends(STOP);
    polls_to(TMINI_EVENT_UNWANTED_SCANNING);
}

/* Some units may scan after power-up. */
void test_a_lidar_that_streams_after_a_reboot_is_stopped(void)
{
    rig_go_idle();
    sends(REBOOT);
    begins(tmini_reboot(&rig.lidar));
    passes(1000);
    polls_and_sends(GET_FREQUENCY);
    rig_feed_frequency(600);
    polls_to(TMINI_EVENT_REBOOTED);
    passes(500);
    rig_feed_point_packet(1000);
    sends(STOP);
    polls_to(TMINI_EVENT_UNWANTED_SCANNING);
}

void test_a_port_that_cannot_send_the_stop_is_asked_twice_a_second(void)
{
    unsigned events = 0;
    rig_go_idle();
    port_write_IgnoreAndReturn(-1);
    for (unsigned i = 0; i < 1000; i++) {
        passes(10);
        rig_feed_point_packet(1000);
        while (tmini_poll(&rig.lidar) != TMINI_EVENT_NONE) {
            events++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(2 * 19, events); /* UNWANTED_SCANNING and COMMAND_FAILED. */
}

void test_a_lidar_that_streams_after_a_query_is_stopped_too(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed_health(0, 0);
    polls_to(TMINI_EVENT_HEALTH);
    passes(500);
    rig_feed_point_packet(1000);
    sends(STOP);
    polls_to(TMINI_EVENT_UNWANTED_SCANNING);
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

void test_bytes_that_come_while_a_poll_looks_for_news_are_not_given_up(void)
{
    bytes_are_not_given_up_that_come_at(1);
}

void test_bytes_that_come_while_the_clock_is_read_are_not_given_up(void)
{
    bytes_are_not_given_up_that_come_at(2);
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

void test_a_line_on_which_bytes_come_while_a_poll_looks_for_news_is_not_quiet(void)
{
    line_is_not_quiet_with_bytes_at(1);
}

void test_a_line_on_which_bytes_come_while_the_clock_is_read_is_not_quiet(void)
{
    line_is_not_quiet_with_bytes_at(2);
}

/* Two pauses of 60 ms between polls count as 100 ms of silence; the byte is abandoned after 101. */
void test_the_time_between_two_polls_is_silence_for_50_ms_at_most(void)
{
    rig.timing.frame_timeout_ms = 101;
    rig_feed_byte(0xAA);
    polls_to(TMINI_EVENT_NONE);
    for (unsigned i = 0; i < 2; i++) {
        rig.now_ms += 60;
        polls_to(TMINI_EVENT_NONE);
    }
    TEST_ASSERT_EQUAL_UINT32(1, rig_counters().bytes_pending);
    rig.now_ms += 1;
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
}

void test_a_frame_timeout_may_be_longer_than_256_ms(void)
{
    rig.timing.frame_timeout_ms = 300;
    rig_feed_byte(0xAA);
    polls_to(TMINI_EVENT_NONE);
    for (unsigned i = 0; i < 6; i++) {
        TEST_ASSERT_EQUAL_UINT32(1, rig_counters().bytes_pending);
        rig.now_ms += 50;
        polls_to(TMINI_EVENT_NONE);
    }
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
}

void test_a_command_that_the_port_refuses_is_offered_again_a_millisecond_later(void)
{
    rig_go_idle();
    polls_to(TMINI_EVENT_NONE); /* The driver settles. */
    rig.now_ms += 1;
    sends_both_taking(GET_HEALTH, -1);
    begins(tmini_request_health(&rig.lidar));
    rig.now_ms += 1;
    polls_and_sends(GET_HEALTH);
}

void test_without_a_frame_timeout_a_reply_in_two_parts_is_taken(void)
{
    static const uint8_t begin[] = {0xA5, 0x5A, 0x03, 0x00, 0x00};
    static const uint8_t rest[] = {0x00, 0x06, 0x00, 0x00, 0x00};

    rig.timing.frame_timeout_ms = 0;
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed(begin, sizeof begin);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += 1;
    rig_feed(rest, sizeof rest);
    polls_to(TMINI_EVENT_HEALTH);
}

void test_without_a_frame_timeout_a_silent_poll_gives_up_a_reply(void)
{
    static const uint8_t begin[] = {0xA5, 0x5A, 0x03, 0x00, 0x00};

    rig.timing.frame_timeout_ms = 0;
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed(begin, sizeof begin);
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(sizeof begin, rig_counters().bytes_pending);
    rig.now_ms += 1;
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
}

/* The header claims more bytes than come, so it hides the packet after it. */
static void feed_false_header_and_packet(void)
{
    static const uint8_t header[] = {0xAA, 0x55, 0x00, 0x50, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};

    rig_feed(header, sizeof header);
    rig_feed_start_packet(1000);
}

void test_silence_gives_a_candidate_up_so_that_the_packet_it_hides_is_delivered(void)
{
    rig_go_scanning();
    rig_feed_start_packet(1000);
    (void)rig_drain();
    feed_false_header_and_packet();
    passes_to(100, TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
}

void test_silence_gives_up_one_candidate_after_the_other(void)
{
    rig_go_scanning();
    rig_feed_start_packet(1000);
    (void)rig_drain();
    feed_false_header_and_packet();
    feed_false_header_and_packet();
    passes(100);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_SCAN), rig_drain());
    TEST_ASSERT_EQUAL_UINT32(2, rig_counters().scans);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
}

void test_silence_gives_up_a_single_byte_too(void)
{
    rig_feed_byte(0xAA);
    passes_to(100, TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
    TEST_ASSERT_EQUAL_UINT32(1, rig_counters().bytes_skipped);
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

void test_silence_gives_up_what_hides_a_reply_too(void)
{
    static const uint8_t header[] = {0xAA, 0x55, 0x00, 0x28, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};

    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    rig_feed(header, sizeof header);
    rig_feed_info();
    passes_to(100, TMINI_EVENT_INFO);
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

void test_a_scan_is_delivered_after_the_fault_that_came_with_it(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    rig_feed_plain_turn(0);
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(17, tmini_scan(&rig.lidar)->count);
    polls_to(TMINI_EVENT_NONE);
}

void test_a_scan_that_waits_after_a_fault_is_no_loss_however_late_the_next_poll(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    rig_feed_plain_turn(0);
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
    rig.now_ms += 1500;
    polls_to(TMINI_EVENT_SCAN);
    rig_feed_point_packet(0);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_SCANNING);
}

void test_a_scan_with_more_points_than_the_buffer_holds_says_how_many_were_dropped(void)
{
    rig.config.max_points = 30;
    rig_init();
    rig_go_scanning();
    rig_feed_start_packet(1000);
    rig_feed_packet(0, 40, 1000);
    rig_feed_start_packet(1000);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(30, tmini_scan(&rig.lidar)->count);
    TEST_ASSERT_EQUAL_UINT16(11, tmini_scan(&rig.lidar)->dropped);
    TEST_ASSERT_FALSE(tmini_scan(&rig.lidar)->complete);
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

void test_a_stop_does_not_take_back_a_scan_that_waits_after_a_fault(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    rig_feed_plain_turn(0);
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
    begins_with(STOP, tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(17, tmini_scan(&rig.lidar)->count);
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_new_start_does_not_continue_the_scan_before_the_stop(void)
{
    rig_go_scanning();
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    answers_and_gets(600, START);
    rig_feed_scan_reply();
    feed_turn(800);
    polls_to(TMINI_EVENT_STARTED);
    polls_to(TMINI_EVENT_NONE);
    feed_turn(900);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(800, tmini_scan(&rig.lidar)->points[0].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&rig.lidar)->gaps);
}

/* A byte of garbage per millisecond, then a packet. Half a turn at 6 Hz is 83 ms, and the packet's
 * 22 bytes take 1 ms. */
static void packet_after_garbage(uint32_t ms, uint16_t gap)
{
    for (uint32_t i = 0; i < ms; i++) {
        rig.now_ms += 1;
        if (i < ms - 1) {
            rig_feed_byte(0);
            polls_to(TMINI_EVENT_NONE);
        }
    }
    rig_feed_point_packet(1000);
    (void)rig_drain();
    TEST_ASSERT_EQUAL_UINT16(gap, tmini_packet(&rig.lidar)->gap);
}

static void begin_scan(void)
{
    rig.timing.max_pause_ms = 30;
    rig_go_scanning();
    for (unsigned i = 0; i < 2; i++) {
        feed_turn(700);
        (void)rig_drain();
        rig.now_ms += 1;
    }
    rig_feed_point_packet(1000);
    (void)rig_drain();
}

void test_a_packet_that_comes_in_time_has_a_gap_of_the_bytes_before_it(void)
{
    begin_scan();
    packet_after_garbage(84, 83);
}

void test_a_packet_that_comes_too_late_has_an_unknown_gap_though_the_line_was_never_silent(void)
{
    begin_scan();
    packet_after_garbage(85, TMINI_GAP_UNKNOWN);
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

void test_streaming_reports_faults_and_losses_as_well(void)
{
    go_streaming();
    for (unsigned i = 0; i < 3; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
    passes_to(1000, TMINI_EVENT_LOST);
}

/* ---- Results ---- */

void test_the_reply_to_another_query_does_not_change_the_health(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed_health(2, 0x1234);
    polls_to(TMINI_EVENT_HEALTH);
    passes_to(50, TMINI_EVENT_NONE);
    begins_with(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(600);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_HEX8(0x02, tmini_health(&rig.lidar)->faults);
    TEST_ASSERT_EQUAL_HEX16(0x1234, tmini_health(&rig.lidar)->error_code);
}

/* Both turns are incomplete, but have a range. */
void test_ranges_in_two_incomplete_turns_clear_a_data_fault(void)
{
    rig_go_scanning();
    rig_plain_turns(3, 0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_byte(0);
        rig_feed_byte(0);
        rig_feed_point_packet(1000);
        rig_feed_start_packet(0);
        (void)rig_drain();
    }
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_ct_information_is_known_once_a_turn_was_trusted(void)
{
    tmini_ct_info_t turn;

    rig_go_scanning();
    rig_feed_turn(TMINI_FAULT_LD, 1000);
    (void)rig_drain();
    tmini_ct_info(&rig.lidar, &turn);
    TEST_ASSERT_EQUAL_HEX16(0, turn.known);
    rig_feed_turn(TMINI_FAULT_LD, 1000);
    (void)rig_drain();
    tmini_ct_info(&rig.lidar, &turn);
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE,
                            turn.known);
    TEST_ASSERT_EQUAL_UINT8(1, turn.user_major);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_LD, turn.faults);
}

void test_setting_up_again_clears_everything(void)
{
    rig_go_recovering();
    rig_init();
    is_in(TMINI_STATE_UNKNOWN);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().losses);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().packets);
    passes(60000);
}

void test_a_configured_timing_is_used(void)
{
    rig.timing.quiet_line_ms = 7;
    rig_init();
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(7, TMINI_EVENT_STOPPED);
}

void test_a_quiet_line_may_have_to_be_silent_for_longer_than_256_ms(void)
{
    rig.timing.quiet_line_ms = 300;
    begins_with(STOP, tmini_stop(&rig.lidar));
    for (unsigned i = 0; i < 6; i++) {
        polls_to(TMINI_EVENT_NONE);
        rig.now_ms += 50;
    }
    polls_to(TMINI_EVENT_STOPPED);
}

/* ---- The wraparound of the clock, in every wait ---- */

/* Sets the clock so that the next `ms` milliseconds cross its wraparound. */
static void begin_near_the_end(uint32_t ms)
{
    rig.now_ms = UINT32_MAX - ms / 2;
}

void test_waiting_for_a_quiet_line_survives_the_clocks_wrap_around(void)
{
    begin_near_the_end(50);
    begins_with(STOP, tmini_stop(&rig.lidar));
    rig_feed_byte(0x00);
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_waiting_for_a_stop_survives_the_clocks_wrap_around(void)
{
    begin_near_the_end(600);
    begins_with(STOP, tmini_stop(&rig.lidar));
    for (unsigned ms = 0; ms < 600; ms += 20) {
        rig_feed_byte(0x00);
        passes(20);
    }
    polls_and_sends(STOP);
}

void test_waiting_for_a_reply_survives_the_clocks_wrap_around(void)
{
    rig_go_idle();
    begin_near_the_end(2000);
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
    passes(2000);
    polls_and_sends(STOP);
}

void test_waiting_for_the_transmitter_survives_the_clocks_wrap_around(void)
{
    begin_near_the_end(100);
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 99;
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += 1;
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_COMMAND_FAILED);
}

void test_waiting_for_the_first_packet_survives_the_clocks_wrap_around(void)
{
    rig_go_starting();
    begin_near_the_end(3000);
    rig_feed_scan_reply();
    passes_to(3000, TMINI_EVENT_COMMAND_FAILED);
}

void test_waiting_between_steps_survives_the_clocks_wrap_around(void)
{
    rig_go_idle();
    begin_near_the_end(50);
    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 700));
    rig_feed_frequency(600);
    finds_quiet_and_sends(FASTER_ONE);
}

void test_waiting_for_a_reboot_survives_the_clocks_wrap_around(void)
{
    rig_go_idle();
    begin_near_the_end(1000);
    begins_with(REBOOT, tmini_reboot(&rig.lidar));
    passes(1000);
    polls_and_sends(GET_FREQUENCY);
}

void test_waiting_for_data_survives_the_clocks_wrap_around(void)
{
    rig_go_scanning();
    begin_near_the_end(1000);
    rig_feed_point_packet(1000);
    passes_to(1000, TMINI_EVENT_LOST);
}

void test_the_pause_between_attempts_survives_the_clocks_wrap_around(void)
{
    rig_go_backing_off();
    const uint32_t took_ms = rig.now_ms - 1000;
    rig.now_ms = 0 - took_ms - 250;
    rig_init();
    rig_go_backing_off();
    passes(500);
    polls_and_sends(STOP);
}

void test_silence_survives_the_clocks_wrap_around(void)
{
    rig_go_scanning();
    begin_near_the_end(100);
    rig_feed_start_packet(1000);
    (void)rig_drain();
    feed_false_header_and_packet();
    passes_to(100, TMINI_EVENT_SCAN);
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

/* ---- Pauses of the line ---- */

static void judge_pauses(void)
{
    rig.timing = tmini_timing_default;
    rig_init();
    rig_go_scanning();
    feed_turn(700);
    polls_to(TMINI_EVENT_NONE);
}

/* 8 point packets of 22 bytes. Half a turn at 6 Hz is 83 ms. */
static void comes_after(uint32_t pause_ms)
{
    rig.now_ms += pause_ms;
    for (unsigned i = 0; i < 8; i++) {
        rig_feed_point_packet(1000);
    }
}

void test_a_scan_goes_on_after_a_pause_that_cannot_hold_half_a_turn(void)
{
    judge_pauses();
    comes_after(83 + 12); /* The first packet came 12 ms before the end of the last. */
    polls_to(TMINI_EVENT_NONE);
}

void test_pauses_longer_than_a_quarter_of_a_second_can_be_allowed(void)
{
    judge_pauses();
    rig.timing.max_pause_ms = 300;
    comes_after(250);
    polls_to(TMINI_EVENT_NONE);
}

void test_a_longer_pause_ends_the_scan(void)
{
    judge_pauses();
    comes_after(83 + 13);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(9, tmini_scan(&rig.lidar)->count);
    TEST_ASSERT_FALSE(tmini_scan(&rig.lidar)->complete);
    TEST_ASSERT_EQUAL_UINT32(1, rig_counters().late_scans);
    feed_turn(800); /* Packets without a pause continue the scan. */
    feed_turn(900);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(32, tmini_scan(&rig.lidar)->count);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(9, tmini_scan(&rig.lidar)->count);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&rig.lidar)->gaps);
}

void test_what_is_fed_before_a_lidar_is_set_up_is_counted_as_refused(void)
{
    rig.lidar = (tmini_t){0};
    tmini_feed_byte(&rig.lidar, 0xAA);
    tmini_feed_byte(&rig.lidar, 0x55);
    TEST_ASSERT_EQUAL_UINT32(2, rig_counters().bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().bytes_pending);
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

void test_a_pause_counts_from_poll_to_poll_however_often_it_is_polled(void)
{
    judge_pauses();
    for (unsigned i = 0; i < 95; i++) {
        rig.now_ms++;
        polls_to(TMINI_EVENT_NONE);
    }
    comes_after(1);
    polls_to(TMINI_EVENT_SCAN);
}

/* Only five bytes of each packet arrive, every 10 ms, for more than half a turn. */
void test_packets_cut_to_a_few_bytes_for_too_long_end_the_scan(void)
{
    static const uint8_t rest[5] = {0x11, 0x22, 0x33, 0x44, 0x55};
    judge_pauses();
    for (unsigned i = 0; i < 9; i++) {
        rig.now_ms += 10;
        rig_feed(rest, sizeof rest);
        polls_to(TMINI_EVENT_NONE);
    }
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(9, tmini_scan(&rig.lidar)->count);
}

void test_pauses_are_ignored_if_the_limit_is_0(void)
{
    judge_pauses();
    rig.timing.max_pause_ms = 0;
    comes_after(10000);
    polls_to(TMINI_EVENT_NONE);
}
