/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares the simulated lidar's bytes with docs/protocol.md. The check `recordings` compares those
 * of a healthy one with test/recordings. */

#include "reference_decoder.h"
#include "simulator.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define SECOND UINT64_C(1000000)
#define STREAM_MAX 2000000u
#define PACKETS_MAX 20000u

static sim_t sim;
static sim_config_t config;
static uint64_t now;
static uint8_t stream[STREAM_MAX];
static size_t size;
static reference_item_t packets[PACKETS_MAX];
static size_t packet_count;
static reference_counts_t counts;

/* ---- Helpers ---- */

static void power_up(void)
{
    sim_init(&sim, &config);
    now = 0;
    size = 0;
}

static void run_ms(uint32_t milliseconds)
{
    for (; milliseconds > 0; milliseconds--) {
        now += 1000;
        size += sim_transmit(&sim, now, stream + size, STREAM_MAX - size);
    }
}

static void send(uint8_t code)
{
    const uint8_t command[2] = {0xA5, code};
    sim_receive(&sim, command, 2, now);
}

static void forget_stream(void)
{
    size = 0;
}

static void collect(void *context, const reference_item_t *item)
{
    (void)context;
    if (item->is_packet && packet_count < PACKETS_MAX) {
        packets[packet_count++] = *item;
    }
}

static void decode(void)
{
    static const reference_reply_t start_reply = {1, 0x81, 0};
    const reference_options_t options = {80, &start_reply};
    packet_count = 0;
    counts = reference_decode(stream, size, &options, collect, NULL);
    TEST_ASSERT_EQUAL_UINT32(0, sim_lost_frames(&sim));
}

/* Scans for some seconds, after the spin-up. */
static void scan_seconds(uint32_t seconds)
{
    send(0x60);
    run_ms(3000);
    forget_stream();
    run_ms(seconds * 1000u);
    decode();
}

static size_t next_start(size_t from)
{
    while (from < packet_count && !packets[from].starts_revolution) {
        from++;
    }
    TEST_ASSERT_TRUE_MESSAGE(from < packet_count, "no more start packets");
    return from;
}

static unsigned points_between(size_t from, size_t to)
{
    unsigned points = 0;
    for (; from < to; from++) {
        points += packets[from].lsn;
    }
    return points;
}

/* Within 10 ms exactly these bytes come, given in hexadecimal. */
static void expect_stream(const char *hex)
{
    char text[200] = "";
    run_ms(10);
    for (size_t i = 0; i < size && i < sizeof text / 3; i++) {
        (void)snprintf(&text[3 * i], 4, i + 1 < size ? "%02X " : "%02X", stream[i]);
    }
    TEST_ASSERT_EQUAL_STRING(hex, text);
    forget_stream();
}

static void expect_frequency(unsigned chz)
{
    char hex[40];
    (void)snprintf(hex, sizeof hex, "A5 5A 04 00 00 00 04 %02X %02X 00 00", chz & 0xFF, chz >> 8);
    expect_stream(hex);
}

/* Sends the command; the reply is this frequency. */
static void expect_step(uint8_t code, unsigned chz)
{
    send(code);
    expect_frequency(chz);
}

static void power_up_at(uint16_t frequency_chz)
{
    config.frequency_chz = frequency_chz;
    power_up();
}

void setUp(void)
{
    config = sim_default_config();
    power_up();
}

void tearDown(void) {}

/* ---- Idle and its commands ---- */

void test_it_is_idle_and_silent_after_power_up(void)
{
    run_ms(5000);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    TEST_ASSERT_EQUAL_UINT16(600, sim_frequency_chz(&sim));
    TEST_ASSERT_EQUAL_UINT64(SIM_NEVER, sim_next_us(&sim));
}

void test_device_information_has_the_minor_firmware_version_first(void)
{
    send(0x90);
    expect_stream(
        "A5 5A 14 00 00 00 04 97 02 01 01 02 00 02 06 00 03 01 07 00 00 00 01 02 03 04 05");
}

void test_health_is_all_clear_at_first_and_reports_the_bits_that_are_set(void)
{
    send(0x92);
    expect_stream("A5 5A 03 00 00 00 06 00 00 00");
    sim_set_health(&sim, SIM_HEALTH_PD | SIM_HEALTH_LD);
    send(0x92);
    expect_stream("A5 5A 03 00 00 00 06 18 18 00");
}

void test_frequency_steps_are_a_tenth_and_a_whole_hertz(void)
{
    expect_step(0x0D, 600);
    expect_step(0x09, 610);
    expect_step(0x0B, 710);
    expect_step(0x0A, 700);
    expect_step(0x0C, 600);
}

void test_a_step_beyond_a_limit_changes_nothing_and_says_so(void)
{
    power_up_at(1150);
    expect_step(0x0B, 1150);
    power_up_at(500);
    expect_step(0x0A, 500);
}

void test_the_limits_themselves_can_be_reached(void)
{
    power_up_at(1190);
    expect_step(0x09, 1200);
    power_up_at(600);
    expect_step(0x0C, 500);
}

void test_stop_and_unknown_commands_have_no_reply(void)
{
    send(0x65);
    send(0x61);
    send(0x00);
    run_ms(100);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL_UINT32(1, sim.counts.commands);
    TEST_ASSERT_EQUAL_UINT32(2, sim.counts.unknown_commands);
}

void test_a_command_may_arrive_in_two_parts_and_among_garbage(void)
{
    static const uint8_t first[] = {0x0D, 0x60, 0xA5, 0xA5};
    static const uint8_t second[] = {0x0D, 0x60, 0x90};
    sim_receive(&sim, first, sizeof first, now);
    run_ms(50);
    sim_receive(&sim, second, sizeof second, now);
    expect_frequency(600);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
}

void test_a_reply_comes_after_the_latency_at_the_lines_speed(void)
{
    config.reply_latency_ms = 20;
    power_up();
    send(0x92);
    /* 20 ms and ten bytes of 43.403 us are 20434.03 us. */
    static const struct {
        uint64_t us;
        size_t size;
    } rows[] = {{20043, 0}, {20044, 1}, {20434, 9}, {20435, 10}};
    for (size_t i = 0; i < 4; i++) {
        size += sim_transmit(&sim, rows[i].us, stream + size, STREAM_MAX);
        TEST_ASSERT_EQUAL_size_t(rows[i].size, size);
    }
}

void test_one_reply_can_be_delayed_and_the_next_one_waits_for_it(void)
{
    sim_delay_next_reply(&sim, 3000);
    send(0x92);
    run_ms(1000);
    send(0x0D);
    run_ms(1990);
    TEST_ASSERT_EQUAL_size_t(0, size);
    run_ms(20);
    TEST_ASSERT_EQUAL_size_t(21, size);
    TEST_ASSERT_EQUAL_HEX8(0x06, stream[6]);
    TEST_ASSERT_EQUAL_HEX8(0x04, stream[16]);
    forget_stream();
    expect_step(0x0D, 600);
}

/* The health reply (10 bytes) at 3003 ms, then the start command's reply (7), then the stream. */
void test_a_stream_waits_for_its_own_late_reply(void)
{
    sim_delay_next_reply(&sim, 3000);
    send(0x92);
    run_ms(1000);
    send(0x60);
    run_ms(2200);
    TEST_ASSERT_EQUAL_size_t(17, size);
    TEST_ASSERT_EQUAL_HEX8(0x81, stream[16]);
    run_ms(1000);
    decode();
    TEST_ASSERT_TRUE(counts.packets > 50);
}

void test_one_reply_can_be_lost(void)
{
    sim_lose_next_reply(&sim);
    send(0x0D);
    run_ms(100);
    TEST_ASSERT_EQUAL_size_t(0, size);
    expect_step(0x0D, 600);
}

/* ---- Scanning ---- */

void test_lone_point_packets_end_slightly_before_they_begin(void)
{
    unsigned lone = 0;
    config.lone_packet_permille = 200;
    power_up();
    scan_seconds(10);
    for (size_t i = 0; i < packet_count; i++) {
        if (packets[i].lsn == 1u && !packets[i].starts_revolution && packets[i].fsa > 20u) {
            TEST_ASSERT_EQUAL_UINT16(packets[i].fsa - 14u, packets[i].lsa);
            lone++;
        }
    }
    TEST_ASSERT_TRUE(lone > 100);
}

void test_start_packets_are_at_the_start_angle(void)
{
    config.start_angle_q6 = 7424; /* 116 degrees */
    power_up();
    scan_seconds(5);
    for (size_t i = next_start(0); i < packet_count; i++) {
        if (packets[i].starts_revolution) {
            TEST_ASSERT_UINT_WITHIN(40, 7440, packets[i].fsa >> 1);
        }
    }
}

void test_bytes_never_come_faster_than_the_line(void)
{
    uint8_t chunk[1000];
    send(0x60);
    for (uint32_t i = 0; i < 30000; i++) {
        now += 100;
        TEST_ASSERT_TRUE(sim_transmit(&sim, now, chunk, sizeof chunk) <= 3);
    }
}

/* 5 s in steps of 1 ms, and at once, in portions of this size. */
static void expect_the_same_bytes_by(size_t portion)
{
    static uint8_t other[STREAM_MAX];
    size_t other_size = 0;
    size_t more;
    send(0x60);
    run_ms(5000);
    sim_init(&sim, &config);
    now = 0;
    send(0x60);
    do {
        more = sim_transmit(&sim, 5 * SECOND, other + other_size, portion);
        other_size += more;
    } while (more > 0);
    TEST_ASSERT_EQUAL_size_t(size, other_size);
    TEST_ASSERT_EQUAL_MEMORY(stream, other, size);
}

void test_one_late_call_gives_the_same_bytes_as_many_early_ones(void)
{
    expect_the_same_bytes_by(STREAM_MAX);
}

void test_a_small_buffer_loses_nothing(void)
{
    expect_the_same_bytes_by(7);
}

/* The stream begins at 329.7 degrees and passes 0 degrees without a start packet. */
void test_the_first_packets_may_pass_the_start_packets_place_without_one(void)
{
    config.beginning = SIM_BEGINS_UNMARKED;
    config.first_angle_q6 = 21101;
    power_up();
    send(0x60);
    run_ms(1500);
    decode();
    const size_t first = next_start(0);
    TEST_ASSERT_UINT_WITHIN(config.angle_jitter_q6, 21101, packets[0].fsa >> 1);
    TEST_ASSERT_TRUE(points_between(0, first) > 667); /* Part of a slow turn, and a whole one. */
    TEST_ASSERT_TRUE(packets[first].fsa >> 1 <= 64 || packets[first].fsa >> 1 >= 22976);
}

/* The very first packet begins a revolution at 85.7 degrees; its frequency is 2.4 Hz. */
void test_the_first_packet_may_be_a_start_packet_anywhere(void)
{
    config.beginning = SIM_BEGINS_WITH_A_START;
    config.first_angle_q6 = 5485;
    power_up();
    send(0x60);
    run_ms(1500);
    decode();
    TEST_ASSERT_TRUE(packets[0].starts_revolution);
    TEST_ASSERT_EQUAL_HEX8(24 << 1 | 1, packets[0].ct);
    TEST_ASSERT_UINT_WITHIN(config.angle_jitter_q6, 5485, packets[0].fsa >> 1);
    const size_t second = next_start(1);
    TEST_ASSERT_TRUE(packets[second].fsa >> 1 <= 64 || packets[second].fsa >> 1 >= 22976);
}

void test_an_undocumented_command_is_answered_with_four_zeros(void)
{
    send(0x98);
    expect_stream("A5 5A 04 00 00 00 10 00 00 00 00");
}

/* ---- Turn information ---- */

void test_the_ct_bytes_carry_what_section_7_says(void)
{
    static const struct {
        uint8_t index, ct;
    } rows[] = {
        {1, 0x40},  /* user version 1.0 */
        {3, 0x00},  /* healthy */
        {4, 0x22},  /* hardware 1, firmware 1. */
        {5, 0x04},  /* .2 */
        {9, 0x30},  /* 2026 */
        {10, 0x30}, /* March */
        {11, 0x88}, /* 17th */
        {12, 0xC0}, /* 12345 = 0x60 << 7 */
        {13, 0x72}, /*         + 0x39 */
    };
    scan_seconds(5);
    const size_t start = next_start(0);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        TEST_ASSERT_EQUAL_HEX8(rows[i].ct, packets[start + rows[i].index].ct);
    }
}

void test_last_crc_guards_the_ct_bytes_of_every_revolution(void)
{
    scan_seconds(20);
    for (size_t start = next_start(0), turn = 0; turn < 100; turn++) {
        const size_t next = next_start(start + 1u);
        uint8_t crc = 0;
        for (size_t i = start; i < next; i++) {
            crc = encode_crc8(crc, packets[i].ct);
        }
        TEST_ASSERT_EQUAL_HEX8(crc, stream[packets[next].offset - 1u]);
        start = next;
    }
}

void test_last_crc_is_sometimes_aa(void)
{
    unsigned seen = 0;
    config.frequency_chz = 1200;
    power_up();
    scan_seconds(120);
    for (size_t i = 1; i < packet_count; i++) {
        if (packets[i].starts_revolution && stream[packets[i].offset - 1u] == 0xAA) {
            seen++;
        }
    }
    TEST_ASSERT_TRUE(seen > 0);
    TEST_ASSERT_EQUAL_UINT64(0, counts.checksum_errors);
}

void test_a_unit_without_ct_information_sends_neither_ct_nor_last_crc(void)
{
    config.ct_information = false;
    power_up();
    scan_seconds(10);
    for (size_t i = 1; i < packet_count; i++) {
        TEST_ASSERT_EQUAL_size_t(packets[i - 1u].offset + packets[i - 1u].length,
                                 packets[i].offset);
        if (packets[i].starts_revolution) {
            TEST_ASSERT_UINT_WITHIN(1, 60, packets[i].ct >> 1);
        } else {
            TEST_ASSERT_EQUAL_HEX8(0, packets[i].ct);
        }
    }
}

/* ---- Faults of the device ---- */

static unsigned ranges_from(size_t first)
{
    unsigned ranges = 0;
    for (size_t i = first; i < packet_count; i++) {
        for (unsigned s = 0; s < packets[i].lsn; s++) {
            ranges += reference_point(packets[i].bytes, s).distance_mm != 0u ? 1u : 0u;
        }
    }
    return ranges;
}

void test_a_covered_window_gives_no_ranges_and_the_data_fault(void)
{
    size_t start;
    sim_cover_window(&sim, true);
    scan_seconds(3);
    TEST_ASSERT_EQUAL_UINT(0, ranges_from(0));
    start = next_start(0);
    TEST_ASSERT_EQUAL_HEX8(0x40, packets[start + 3u].ct);
    sim_cover_window(&sim, false);
    run_ms(1000);
    forget_stream();
    run_ms(1000);
    decode();
    TEST_ASSERT_TRUE(ranges_from(0) > 3000);
    TEST_ASSERT_EQUAL_HEX8(0x00, packets[next_start(0) + 3u].ct);
}

void test_a_blocked_rotor_gives_no_ranges_and_the_encoder_fault(void)
{
    sim_block_rotor(&sim, true);
    scan_seconds(3);
    TEST_ASSERT_TRUE(packet_count > 250);
    TEST_ASSERT_EQUAL_UINT(0, ranges_from(0));
    TEST_ASSERT_EQUAL_HEX8(0x04, packets[next_start(0) + 3u].ct);
}

void test_a_blocked_rotor_may_stop_the_start_packets(void)
{
    config.blocked_sends_starts = false;
    power_up();
    sim_block_rotor(&sim, true);
    scan_seconds(3);
    TEST_ASSERT_TRUE(packet_count > 250);
    TEST_ASSERT_EQUAL_UINT64(0, counts.start_packets);
    TEST_ASSERT_EQUAL_UINT16(packets[0].fsa, packets[packet_count - 1u].lsa);
    sim_block_rotor(&sim, false);
    run_ms(2000);
    decode();
    TEST_ASSERT_TRUE(counts.start_packets > 5);
}

void test_a_fatal_fault_ends_the_stream_until_it_is_gone_and_start_is_sent(void)
{
    config.fatal_health = SIM_HEALTH_LD;
    power_up();
    scan_seconds(1);
    sim_set_health(&sim, SIM_HEALTH_LD);
    TEST_ASSERT_EQUAL(SIM_FAULT, sim_mode(&sim));
    run_ms(20);
    forget_stream();
    send(0x60);
    run_ms(2000);
    TEST_ASSERT_EQUAL_size_t(7, size);
    sim_set_health(&sim, 0);
    send(0x60);
    run_ms(2000);
    TEST_ASSERT_EQUAL(SIM_SCANNING, sim_mode(&sim));
    TEST_ASSERT_TRUE(size > 10000);
}

/* ---- Scene ---- */

static reference_point_t nearest_to(uint16_t angle_q6)
{
    for (size_t i = next_start(0); i < packet_count; i++) {
        for (unsigned s = 0; s < packets[i].lsn; s++) {
            const reference_point_t point = reference_point(packets[i].bytes, s);
            if (point.angle_q6 + 20u > angle_q6 && point.angle_q6 < angle_q6 + 20u &&
                point.distance_mm != 0u) {
                return point;
            }
        }
    }
    TEST_FAIL_MESSAGE("no point there");
    return reference_point(packets[0].bytes, 0);
}

/* The lidar is 2.2 m from the left wall, 2.8 m from the right one, 1.7 m from the back one and 2.3
 * m from the front one. 90 degrees are to the right: clockwise seen from above. */
void test_the_room_is_seen_clockwise_from_straight_ahead(void)
{
    scan_seconds(1);
    TEST_ASSERT_UINT_WITHIN(15, 2300, nearest_to(64).distance_mm);
    TEST_ASSERT_UINT_WITHIN(15, 2800, nearest_to(5760).distance_mm);
    TEST_ASSERT_UINT_WITHIN(15, 1700, nearest_to(11520).distance_mm);
    TEST_ASSERT_UINT_WITHIN(15, 2200, nearest_to(17280).distance_mm);
}

/* The nearest side of the pillar: its centre is sqrt(300^2 + 1500^2) = 1529.7 mm away at
 * -11.31 degrees, its radius 150 mm. */
void test_a_round_pillar_stands_ahead_to_the_left(void)
{
    scan_seconds(1);
    TEST_ASSERT_UINT_WITHIN(15, 1380, nearest_to(22316).distance_mm);
}

void test_an_obstacle_appears_where_it_is_placed_and_can_be_removed(void)
{
    sim_place_obstacle(&sim, 0, 640, 400);
    TEST_ASSERT_EQUAL_UINT16(400, sim_scene_distance(&sim.scene, 23039));
    scan_seconds(1);
    TEST_ASSERT_UINT_WITHIN(10, 400, nearest_to(64).distance_mm);
    TEST_ASSERT_UINT_WITHIN(10, 400, nearest_to(23000).distance_mm);
    TEST_ASSERT_TRUE(nearest_to(400).distance_mm > 2000);
    sim_clear_obstacles(&sim);
    forget_stream();
    run_ms(1000);
    decode();
    TEST_ASSERT_UINT_WITHIN(15, 2300, nearest_to(64).distance_mm);
}

void test_flags_2_and_3_occur_as_often_as_configured(void)
{
    unsigned flags[4] = {0, 0, 0, 0};
    config.flagged_permille = 100;
    power_up();
    scan_seconds(10);
    for (size_t i = 0; i < packet_count; i++) {
        for (unsigned s = 0; s < packets[i].lsn; s++) {
            flags[reference_point(packets[i].bytes, s).flag]++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, flags[1]);
    TEST_ASSERT_UINT_WITHIN(300, 2000, flags[2]);
    TEST_ASSERT_UINT_WITHIN(300, 2000, flags[3]);
}

/* ---- Stop, reboot, power ---- */

void test_stop_has_a_tail_of_whole_packets(void)
{
    config.stop_tail_ms = 100;
    power_up();
    scan_seconds(1);
    forget_stream();
    send(0x65);
    TEST_ASSERT_EQUAL(SIM_STOPPING, sim_mode(&sim));
    run_ms(90);
    TEST_ASSERT_TRUE(size > 1000);
    run_ms(30);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    forget_stream();
    run_ms(1000);
    TEST_ASSERT_EQUAL_size_t(0, size);
}

void test_a_stop_before_the_first_packet_leaves_silence(void)
{
    send(0x60);
    run_ms(100);
    send(0x65);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    forget_stream();
    run_ms(1000);
    TEST_ASSERT_EQUAL_size_t(0, size);
}

void test_commands_while_scanning_are_counted_and_answered_between_packets(void)
{
    size_t stray;
    scan_seconds(1);
    forget_stream();
    send(0x0D);
    send(0x60);
    run_ms(1000);
    decode();
    TEST_ASSERT_EQUAL_UINT32(2, sim.counts.commands_while_scanning);
    TEST_ASSERT_EQUAL_UINT64(0, counts.checksum_errors);
    stray = size - (size_t)counts.bytes_in_packets - (size_t)counts.start_packets;
    TEST_ASSERT_TRUE(stray >= 18 && stray < 18 + 260);
    send(0x65);
    TEST_ASSERT_EQUAL_UINT32(2, sim.counts.commands_while_scanning);
    send(0x0D);
    TEST_ASSERT_EQUAL_UINT32(2, sim.counts.commands_while_scanning);
    TEST_ASSERT_EQUAL_UINT32(1, sim.counts.commands_in_tail);
}

void test_a_lost_start_reply_does_not_stop_the_stream(void)
{
    sim_lose_next_reply(&sim);
    send(0x60);
    run_ms(2000);
    decode();
    TEST_ASSERT_EQUAL_UINT64(0, counts.replies);
    TEST_ASSERT_TRUE(counts.packets > 100);
}

void test_nothing_is_answered_during_a_reboot_and_the_frequency_is_reset(void)
{
    send(0x0B);
    run_ms(10);
    send(0x40);
    TEST_ASSERT_EQUAL(SIM_BOOTING, sim_mode(&sim));
    forget_stream();
    run_ms(2490);
    send(0x0D);
    run_ms(100);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    expect_step(0x0D, 600);
}

void test_a_reboot_forgets_a_reply_that_is_due(void)
{
    send(0x90);
    send(0x40);
    run_ms(5000);
    TEST_ASSERT_EQUAL_size_t(0, size);
}

void test_losing_power_cuts_a_packet_in_the_middle(void)
{
    scan_seconds(1);
    do {
        forget_stream();
        run_ms(1);
    } while (size != 23);
    forget_stream();
    sim_power(&sim, false, now);
    run_ms(5000);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL(SIM_OFF, sim_mode(&sim));
    sim_power(&sim, true, now);
    TEST_ASSERT_EQUAL(SIM_BOOTING, sim_mode(&sim));
    run_ms(2500);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    expect_step(0x0D, 600);
}

void test_what_left_before_power_was_lost_can_still_be_read(void)
{
    uint32_t before;
    sim_run_t run;
    scan_seconds(1);
    while (!sim_next_run(&sim, now, &run) || run.packet == NULL || run.offset > 0) {
        now += 100;
    }
    before = sim.counts.packets;
    sim_power(&sim, false, now + 1000); /* 23.04 bytes later */
    TEST_ASSERT_UINT_WITHIN(1, 23, sim_transmit(&sim, now + 5000, stream, STREAM_MAX));
    TEST_ASSERT_EQUAL_UINT32(before, sim.counts.packets);
}

/* 10 bits at 230400 baud are 43.403 us; a byte is there when all of it has left. */
void test_the_time_of_a_byte_is_when_it_has_left(void)
{
    TEST_ASSERT_EQUAL_UINT64(1044, sim_byte_us(1000, 0));
    TEST_ASSERT_EQUAL_UINT64(1087, sim_byte_us(1000, 1));
    TEST_ASSERT_EQUAL_UINT64(4125, sim_byte_us(1000, 71));
}

/* ---- Ground truth ---- */

static struct {
    uint32_t packets;
    uint32_t starts;
    sim_mode_t modes[10];
    size_t mode_count;
    uint8_t codes[10];
    size_t code_count;
} seen;

/* The packets' bytes may not yet be in the stream: they are compared by position later. */
static sim_packet_t truths[PACKETS_MAX];

static void see_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    TEST_ASSERT_EQUAL_UINT32(seen.packets, packet->number);
    truths[seen.packets++] = *packet;
    seen.starts += packet->starts_revolution ? 1u : 0u;
    TEST_ASSERT_EQUAL_UINT32(seen.starts, packet->revolution);
}

static void see_mode(void *context, sim_mode_t from, sim_mode_t to, uint64_t at_us)
{
    (void)context;
    (void)from;
    (void)at_us;
    seen.modes[seen.mode_count++] = to;
}

static void see_command(void *context, uint8_t code, uint64_t at_us)
{
    (void)context;
    (void)at_us;
    seen.codes[seen.code_count++] = code;
}

static void observe(void)
{
    const sim_observer_t observer = {
        .on_packet = see_packet, .on_command = see_command, .on_mode = see_mode};

    memset(&seen, 0, sizeof seen);
    sim_observe(&sim, &observer);
}

void test_the_observer_gets_every_packet_and_its_place(void)
{
    observe();
    send(0x60);
    run_ms(5000);
    decode();
    TEST_ASSERT_EQUAL_UINT64(counts.packets, seen.packets);
    TEST_ASSERT_EQUAL_UINT64(counts.start_packets, seen.starts);
    TEST_ASSERT_EQUAL_UINT32(counts.packets, sim.counts.packets);
    TEST_ASSERT_EQUAL_UINT64(counts.points, sim.counts.samples);
    for (size_t i = 0; i < packet_count; i++) {
        TEST_ASSERT_EQUAL_UINT64(packets[i].offset, truths[i].position);
        TEST_ASSERT_EQUAL_size_t(packets[i].length, truths[i].length);
    }
}

void test_the_observer_gets_commands_and_modes(void)
{
    static const uint8_t codes[] = {0x60, 0x77, 0x65};
    observe();
    send(0x60);
    run_ms(1000);
    send(0x77);
    send(0x65);
    run_ms(1000);
    TEST_ASSERT_EQUAL_size_t(3, seen.code_count);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(codes, seen.codes, 3);
    TEST_ASSERT_EQUAL_size_t(3, seen.mode_count);
    TEST_ASSERT_EQUAL(SIM_SCANNING, seen.modes[0]);
    TEST_ASSERT_EQUAL(SIM_STOPPING, seen.modes[1]);
    TEST_ASSERT_EQUAL(SIM_IDLE, seen.modes[2]);
}

/* 500 ms are 50 packets; the line's queue holds 16. */
void test_frames_that_are_not_taken_in_time_are_lost_and_counted(void)
{
    scan_seconds(1);
    now += 500000;
    send(0x65);
    TEST_ASSERT_UINT_WITHIN(8, 50 + 3 - 16, sim_lost_frames(&sim));
}

void test_modes_have_names(void)
{
    TEST_ASSERT_EQUAL_STRING("off", sim_mode_name(SIM_OFF));
    TEST_ASSERT_EQUAL_STRING("fault", sim_mode_name(SIM_FAULT));
}

/* ---- Unkind behaviour ---- */

/* What spoils the event with that number, counted per kind from 0. */
static struct {
    sim_event_t event;
    unsigned number;
    sim_trouble_t trouble;
    uint32_t ms;
    unsigned counts[SIM_EVENT_START + 1];
} spoil;

static sim_trouble_t spoil_event(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms)
{
    const unsigned number = spoil.counts[event]++;
    (void)context;
    (void)now_us;
    *ms = spoil.ms;
    return event == spoil.event && number == spoil.number ? spoil.trouble : SIM_SOUND;
}

static void unkind(sim_event_t event, unsigned number, sim_trouble_t trouble, uint32_t ms)
{
    const sim_observer_t observer = {.on_event = spoil_event};
    power_up();
    memset(&spoil, 0, sizeof spoil);
    spoil.event = event;
    spoil.number = number;
    spoil.trouble = trouble;
    spoil.ms = ms;
    sim_observe(&sim, &observer);
}

static unsigned starts_sent(void)
{
    unsigned starts = 0;
    decode();
    for (size_t i = 0; i < packet_count; i++) {
        starts += packets[i].starts_revolution ? 1 : 0;
    }
    return starts;
}

/* A step of the frequency is spoilt, then the frequency is asked for. A reply has 11 bytes. */
void test_a_command_or_reply_is_spoilt_as_decided(void)
{
    static const struct {
        sim_event_t event;
        sim_trouble_t trouble;
        uint16_t frequency_chz;
        size_t bytes_soon, bytes_later; /* In 100 ms; until 6 s later, with the question's reply. */
    } rows[] = {
        {SIM_EVENT_COMMAND, SIM_SOUND, 700, 11, 22},
        {SIM_EVENT_COMMAND, SIM_LOST, 600, 0, 11},
        {SIM_EVENT_COMMAND, SIM_LATE, 700, 0, 22},
        {SIM_EVENT_COMMAND, SIM_DOUBLED, 800, 22, 33},
        {SIM_EVENT_COMMAND, SIM_DEAF, 600, 0, 11},
        {SIM_EVENT_COMMAND, SIM_SILENT, 700, 0, 11},
        {SIM_EVENT_COMMAND, SIM_POWER_CUT, 600, 0, 11},
        {SIM_EVENT_COMMAND, SIM_REBOOTS, 600, 0, 11},
        {SIM_EVENT_REPLY, SIM_LOST, 700, 0, 11},
        {SIM_EVENT_REPLY, SIM_LATE, 700, 0, 22},
        {SIM_EVENT_REPLY, SIM_DOUBLED, 700, 22, 33},
        {SIM_EVENT_REPLY, SIM_DEAF, 700, 11, 22},
        {SIM_EVENT_REPLY, SIM_SILENT, 700, 0, 11},
        {SIM_EVENT_REPLY, SIM_POWER_CUT, 600, 0, 11},
        {SIM_EVENT_REPLY, SIM_REBOOTS, 600, 0, 11},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char text[40];
        (void)snprintf(text, sizeof text, "event %u, trouble %u", rows[i].event, rows[i].trouble);
        unkind(rows[i].event, 0, rows[i].trouble, 1000);
        send(0x0B);
        run_ms(100);
        TEST_ASSERT_EQUAL_size_t_MESSAGE(rows[i].bytes_soon, size, text);
        run_ms(5000);
        send(0x0D);
        run_ms(1000);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(rows[i].frequency_chz, sim_frequency_chz(&sim), text);
        TEST_ASSERT_EQUAL_size_t_MESSAGE(rows[i].bytes_later, size, text);
    }
}

void test_commands_and_replies_wait_for_a_late_one_and_keep_their_order(void)
{
    unkind(SIM_EVENT_COMMAND, 0, SIM_LATE, 700);
    send(0x0B);
    send(0x0A);
    run_ms(699);
    TEST_ASSERT_EQUAL_size_t(0, size);
    run_ms(20);
    TEST_ASSERT_EQUAL_size_t(22, size);
    TEST_ASSERT_EQUAL_HEX8(700 & 0xFF, stream[7]);
    TEST_ASSERT_EQUAL_HEX8(690 & 0xFF, stream[18]);
    unkind(SIM_EVENT_REPLY, 0, SIM_LATE, 700);
    send(0x0B);
    send(0x0A);
    run_ms(700);
    TEST_ASSERT_EQUAL_size_t(0, size);
    run_ms(20);
    TEST_ASSERT_EQUAL_size_t(22, size);
}

void test_a_scan_that_loses_its_beginning_does_not_begin_and_another_start_is_obeyed(void)
{
    unkind(SIM_EVENT_BEGINNING, 0, SIM_LOST, 0);
    send(0x60);
    run_ms(2000);
    TEST_ASSERT_EQUAL_size_t(7, size);
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&sim));
    scan_seconds(1);
    TEST_ASSERT_TRUE(packet_count > 90);
}

void test_start_packets_are_lost_doubled_or_missing_until_it_boots(void)
{
    unsigned starts[3];
    for (unsigned i = 0; i < 3; i++) {
        unkind(SIM_EVENT_START, 0, i == 0 ? SIM_SOUND : i == 1 ? SIM_LOST : SIM_DOUBLED, 0);
        send(0x60);
        run_ms(3000);
        starts[i] = starts_sent();
    }
    TEST_ASSERT_EQUAL_UINT(starts[0] - 1, starts[1]);
    TEST_ASSERT_EQUAL_UINT(starts[0] + 1, starts[2]);
    unkind(SIM_EVENT_START, 1, SIM_NO_STARTS, 0);
    send(0x60);
    run_ms(4000);
    TEST_ASSERT_EQUAL_UINT(1, starts_sent());
    TEST_ASSERT_TRUE(packet_count > 200);
    TEST_ASSERT_EQUAL_UINT64(SIM_NEVER, sim_sound_us(&sim));
    send(0x65);
    run_ms(500);
    scan_seconds(1);
    TEST_ASSERT_EQUAL_UINT(0, starts_sent());
    send(0x40);
    TEST_ASSERT_EQUAL_UINT64(now + config.boot_ms * 1000u, sim_sound_us(&sim));
    run_ms(config.boot_ms + 1u);
    scan_seconds(1);
    TEST_ASSERT_TRUE(starts_sent() > 0);
}

void test_a_lidar_that_answers_and_does_not_scan_needs_a_reboot(void)
{
    sim_befall(&sim, SIM_NO_SCANS, 0, now);
    send(0x60);
    run_ms(2000);
    TEST_ASSERT_EQUAL_size_t(7, size);
    send(0x40);
    run_ms(config.boot_ms + 1u);
    scan_seconds(1);
    TEST_ASSERT_TRUE(packet_count > 90);
}

void test_a_stream_that_is_silent_or_late_goes_on_afterwards(void)
{
    static const sim_trouble_t troubles[] = {SIM_SILENT, SIM_LATE};
    for (size_t i = 0; i < 2; i++) {
        unkind(SIM_EVENT_START, 0, troubles[i], 800);
        send(0x60);
        do {
            run_ms(1);
        } while (spoil.counts[SIM_EVENT_START] == 0);
        run_ms(30); /* What is on the line already. */
        forget_stream();
        run_ms(760);
        TEST_ASSERT_EQUAL_size_t(0, size);
        run_ms(1000);
        decode();
        TEST_ASSERT_TRUE(packet_count > 90);
    }
}

void test_a_lidar_that_never_answers_obeys(void)
{
    config.never_answers = true;
    power_up();
    send(0x0B);
    run_ms(100);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL_UINT16(700, sim_frequency_chz(&sim));
    scan_seconds(1);
    TEST_ASSERT_TRUE(packet_count > 90);
}

/* ---- Marks ---- */

void test_a_mark_shows_its_sample_and_revolution_and_no_data_fault(void)
{
    config.marked = true;
    power_up();
    scan_seconds(2);
    size_t at = next_start(1);
    const size_t end = next_start(at + 1);
    uint32_t revolution, sample;
    uint32_t first = 0;
    unsigned count = 0;
    for (; at < end; at++) {
        for (unsigned i = 0; i < packets[at].lsn; i++) {
            const reference_point_t point = reference_point(packets[at].bytes, i);
            sim_read_mark(&sim, (encode_sample_t){point.distance_mm, point.intensity, point.flag},
                          &revolution, &sample);
            first = count == 0 ? revolution : first;
            TEST_ASSERT_EQUAL_UINT32(first, revolution);
            TEST_ASSERT_EQUAL_UINT32(count++, sample);
        }
    }
    TEST_ASSERT_TRUE(first > 0 && count > 600);
    TEST_ASSERT_EQUAL_HEX8(0, sim_health(&sim));
}
