/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The faulty wire: it makes the faults asked for, and reports them correctly. */

#include "link.h"
#include "reference_decoder.h"

#include "unity.h"

#include <string.h>

#define STREAM_MAX 4000000u
#define FATES_MAX 20000u

static sim_t sim;
static sim_link_t wire;
static sim_link_config_t config;
static uint64_t now;
static uint8_t stream[STREAM_MAX];
static size_t size;

static struct {
    sim_link_packet_t packet;
    uint8_t bytes[SIM_FRAME_MAX];
} fates[FATES_MAX];
static size_t fate_count;

static struct {
    unsigned begun[SIM_LINK_KINDS];
    unsigned ended[SIM_LINK_KINDS];
    uint64_t last_us;
} heard;

static void hear_packet(void *context, const sim_link_packet_t *packet)
{
    (void)context;
    fates[fate_count].packet = *packet;
    memcpy(fates[fate_count].bytes, packet->sent.bytes, packet->sent.length);
    fate_count++;
}

static void hear_fault(void *context, sim_link_kind_t kind, bool begins, uint64_t at_us)
{
    (void)context;
    heard.begun[kind] += begins ? 1u : 0u;
    heard.ended[kind] += begins ? 0u : 1u;
    heard.last_us = at_us;
}

static void connect(void)
{
    static const sim_link_observer_t observer = {NULL, hear_packet, hear_fault};
    const sim_config_t device = sim_default_config();
    sim_init(&sim, &device);
    sim_link_init(&wire, &sim, &config);
    sim_link_observe(&wire, &observer);
    memset(&heard, 0, sizeof heard);
    fate_count = 0;
    now = 0;
    size = 0;
}

static void run_us(uint32_t microseconds)
{
    now += microseconds;
    size += sim_link_read(&wire, now, stream + size, STREAM_MAX - size);
}

static void run_ms(uint32_t milliseconds)
{
    for (; milliseconds > 0; milliseconds--) {
        run_us(1000);
    }
}

static void send(uint8_t code)
{
    const uint8_t command[2] = {0xA5, code};
    sim_link_write(&wire, command, 2, now);
}

static void scan_with(sim_link_kind_t kind, uint32_t mean_gap, uint32_t seconds)
{
    config.mean_gap[kind] = mean_gap;
    connect();
    send(0x60);
    run_ms(seconds * 1000u);
}

static void scan_into_a_packet(void)
{
    scan_with(SIM_LINK_UNPLUG, 0, 3);
    do {
        run_ms(1);
    } while (!wire.packet_open);
}

static size_t intact_packets(void)
{
    size_t intact = 0;
    for (size_t i = 0; i < fate_count; i++) {
        intact += fates[i].packet.intact ? 1u : 0u;
    }
    return intact;
}

static bool is_in_stream(const sim_link_packet_t *packet)
{
    return packet->intact && packet->offset + packet->sent.length <= size;
}

/* Every packet reported as intact has arrived. An independent decoder finds hardly any others (for
 * example, after two flips in one column of the checksum). */
static void expect_the_truth_about_every_packet(void)
{
    const reference_options_t options = {80, NULL};
    uint64_t found;
    size_t there = 0;
    for (size_t i = 0; i < fate_count; i++) {
        const sim_link_packet_t *packet = &fates[i].packet;
        if (is_in_stream(packet)) {
            TEST_ASSERT_EQUAL_MEMORY(fates[i].bytes, stream + packet->offset, packet->sent.length);
            there++;
        }
    }
    found = reference_decode(stream, size, &options, NULL, NULL).packets;
    TEST_ASSERT_TRUE(found >= there && found <= there + fate_count / 1000u);
    TEST_ASSERT_EQUAL_size_t(fate_count, wire.counts.packets);
    TEST_ASSERT_EQUAL_size_t(intact_packets(), wire.counts.intact_packets);
}

static void expect_faults(sim_link_kind_t kind, unsigned least, unsigned most)
{
    TEST_ASSERT_TRUE(heard.begun[kind] >= least);
    TEST_ASSERT_TRUE(heard.begun[kind] <= most);
    TEST_ASSERT_UINT_WITHIN(1, heard.begun[kind], heard.ended[kind]);
    TEST_ASSERT_EQUAL_UINT(heard.begun[kind], wire.counts.faults[kind]);
}

void setUp(void)
{
    config = sim_link_default_config();
    connect();
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, sim_lost_frames(&sim));
}

void test_a_faultless_wire_passes_every_byte_in_its_time(void)
{
    static uint8_t direct[STREAM_MAX];
    const sim_config_t device = sim_default_config();
    static const uint8_t start[2] = {0xA5, 0x60};
    size_t direct_size = 0;
    send(0x60);
    run_ms(5000);
    sim_init(&sim, &device);
    sim_receive(&sim, start, 2, 0);
    direct_size = sim_transmit(&sim, now, direct, STREAM_MAX);
    TEST_ASSERT_EQUAL_size_t(direct_size, size);
    TEST_ASSERT_EQUAL_MEMORY(direct, stream, size);
}

void test_without_faults_every_packet_is_intact(void)
{
    send(0x60);
    run_ms(10000);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_EQUAL_size_t(fate_count, intact_packets());
    TEST_ASSERT_EQUAL_UINT32(sim.counts.packets, fate_count);
    TEST_ASSERT_FALSE(sim_link_is_faulty(&wire));
}

/* 60 s are about 780,000 bytes and 6400 packets. */
void test_dropped_bytes_cost_the_packets_they_were_in(void)
{
    scan_with(SIM_LINK_DROP, 1000, 60);
    expect_faults(SIM_LINK_DROP, 680, 880);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_UINT_WITHIN(200, 6400 - 740, intact_packets());
    TEST_ASSERT_EQUAL_size_t(wire.passed - heard.begun[SIM_LINK_DROP], size);
}

void test_flipped_bits_cost_the_packets_they_were_in(void)
{
    scan_with(SIM_LINK_FLIP, 1000, 60);
    expect_faults(SIM_LINK_FLIP, 680, 880);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_EQUAL_size_t(wire.passed, size);
}

void test_inserted_bytes_cost_only_packets_that_they_split(void)
{
    scan_with(SIM_LINK_INSERT, 1000, 60);
    expect_faults(SIM_LINK_INSERT, 680, 880);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_EQUAL_size_t(wire.passed + heard.begun[SIM_LINK_INSERT], size);
}

void test_bursts_spoil_the_packets_they_touch(void)
{
    scan_with(SIM_LINK_BURST, 500, 60);
    expect_faults(SIM_LINK_BURST, 80, 160);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_TRUE(intact_packets() < fate_count);
    TEST_ASSERT_EQUAL_size_t(wire.passed, size);
}

void test_a_cut_loses_the_rest_of_one_packet(void)
{
    scan_with(SIM_LINK_CUT, 500, 60);
    expect_faults(SIM_LINK_CUT, 80, 160);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_UINT_WITHIN(1, heard.ended[SIM_LINK_CUT], fate_count - intact_packets());
    TEST_ASSERT_TRUE(size < wire.passed);
}

void test_a_stall_makes_bytes_late_but_loses_none(void)
{
    scan_with(SIM_LINK_STALL, 1000, 60);
    expect_faults(SIM_LINK_STALL, 35, 85);
    sim_link_calm(&wire, now);
    run_ms(1000);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_EQUAL_size_t(fate_count, intact_packets());
    TEST_ASSERT_EQUAL_size_t(wire.passed, size);
}

void test_nothing_comes_during_a_stall_and_then_it_comes_at_the_lines_speed(void)
{
    size_t before;
    scan_with(SIM_LINK_STALL, 0, 3);
    sim_link_force(&wire, SIM_LINK_STALL, 100, now);
    before = size;
    run_ms(100);
    TEST_ASSERT_EQUAL_size_t(before, size);
    for (int i = 0; i < 50; i++) {
        before = size;
        run_ms(1);
        TEST_ASSERT_UINT_WITHIN(1, 23, size - before);
    }
    run_ms(1000);
    TEST_ASSERT_EQUAL_size_t(wire.passed, size);
}

void test_a_stall_while_the_backlog_drains_holds_the_rest_back(void)
{
    size_t before;
    scan_with(SIM_LINK_STALL, 0, 3);
    sim_link_force(&wire, SIM_LINK_STALL, 100, now);
    run_ms(110);
    sim_link_force(&wire, SIM_LINK_STALL, 50, now);
    before = size;
    run_ms(50);
    TEST_ASSERT_EQUAL_size_t(before, size);
    run_ms(1000);
    TEST_ASSERT_EQUAL_size_t(wire.passed, size);
    expect_the_truth_about_every_packet();
}

/* Flips the first byte of a frame: LastCRC before a start packet, otherwise the header. */
void test_a_spoiled_last_crc_does_not_hit_the_start_packet(void)
{
    unsigned starts = 0;
    scan_with(SIM_LINK_FLIP, 0, 3);
    for (int i = 0; i < 200; i++) {
        size_t before;
        while (wire.packet_open) {
            run_us(20);
        }
        before = fate_count;
        sim_link_force(&wire, SIM_LINK_FLIP, 0, now);
        while (fate_count == before) {
            run_us(20);
        }
        TEST_ASSERT_EQUAL(fates[before].packet.sent.starts_revolution, fates[before].packet.intact);
        starts += fates[before].packet.intact ? 1u : 0u;
    }
    TEST_ASSERT_TRUE(starts > 5);
}

void test_garbling_spoils_every_byte_while_it_lasts(void)
{
    scan_with(SIM_LINK_GARBLE, 0, 3);
    sim_link_force(&wire, SIM_LINK_GARBLE, 500, now);
    TEST_ASSERT_TRUE(sim_link_is_faulty(&wire));
    run_ms(2000);
    TEST_ASSERT_FALSE(sim_link_is_faulty(&wire));
    TEST_ASSERT_EQUAL_UINT64(3500000, sim_link_last_fault_us(&wire));
    TEST_ASSERT_UINT_WITHIN(8, 54, fate_count - intact_packets());
    expect_the_truth_about_every_packet();
}

void test_unplugging_silences_the_line_and_resets_the_device(void)
{
    scan_with(SIM_LINK_UNPLUG, 0, 3);
    sim_link_force(&wire, SIM_LINK_UNPLUG, 1000, now);
    size = 0;
    run_ms(500);
    TEST_ASSERT_EQUAL(SIM_OFF, sim_mode(&sim));
    send(0x60);
    run_ms(3100);
    TEST_ASSERT_EQUAL_size_t(0, size);
    TEST_ASSERT_EQUAL(SIM_IDLE, sim_mode(&sim));
    send(0x0D);
    run_ms(10);
    TEST_ASSERT_EQUAL_size_t(11, size);
}

void test_a_packet_cut_by_unplugging_is_reported_as_hit(void)
{
    scan_into_a_packet();
    sim_link_force(&wire, SIM_LINK_UNPLUG, 1000, now);
    TEST_ASSERT_FALSE(fates[fate_count - 1u].packet.intact);
    expect_the_truth_about_every_packet();
}

void test_a_packet_cut_by_a_reboot_is_reported_as_hit(void)
{
    scan_into_a_packet();
    send(0x40);
    run_ms(3000);
    send(0x60);
    run_ms(1000);
    expect_the_truth_about_every_packet();
    TEST_ASSERT_EQUAL_size_t(fate_count - 1u, intact_packets());
}

void test_a_packet_cut_without_the_wires_knowledge_is_reported_as_hit(void)
{
    scan_into_a_packet();
    sim_power(&sim, false, now + 300);
    run_ms(100);
    TEST_ASSERT_FALSE(fates[fate_count - 1u].packet.intact);
    expect_the_truth_about_every_packet();
}

void test_unplugging_ends_a_burst_and_a_cut_under_way(void)
{
    scan_with(SIM_LINK_UNPLUG, 0, 3);
    sim_link_force(&wire, SIM_LINK_BURST, 5000, now);
    sim_link_force(&wire, SIM_LINK_CUT, 0, now);
    run_ms(1);
    sim_link_force(&wire, SIM_LINK_BURST, 5000, now);
    sim_link_force(&wire, SIM_LINK_UNPLUG, 1000, now);
    run_ms(2000);
    TEST_ASSERT_FALSE(sim_link_is_faulty(&wire));
    TEST_ASSERT_EQUAL_UINT(1, heard.begun[SIM_LINK_BURST]);
    TEST_ASSERT_EQUAL_UINT(1, heard.ended[SIM_LINK_BURST]);
    TEST_ASSERT_EQUAL_UINT(1, heard.ended[SIM_LINK_CUT]);
}

void test_a_random_loss_of_power_ends_by_itself(void)
{
    config.mean_gap[SIM_LINK_UNPLUG] = 5000;
    connect();
    for (int i = 0; i < 60; i++) {
        send(0x60);
        run_ms(1000);
    }
    expect_faults(SIM_LINK_UNPLUG, 3, 15);
    expect_the_truth_about_every_packet();
}

void test_faults_of_bytes_can_be_forced_one_at_a_time(void)
{
    scan_with(SIM_LINK_DROP, 0, 3);
    sim_link_force(&wire, SIM_LINK_DROP, 0, now);
    sim_link_force(&wire, SIM_LINK_CUT, 0, now);
    run_ms(1000);
    TEST_ASSERT_EQUAL_UINT(1, heard.ended[SIM_LINK_DROP]);
    TEST_ASSERT_EQUAL_UINT(1, heard.ended[SIM_LINK_CUT]);
    TEST_ASSERT_TRUE(fate_count - intact_packets() <= 2);
    expect_the_truth_about_every_packet();
}

void test_all_kinds_of_faults_together_are_reported_correctly(void)
{
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        config.mean_gap[kind] = 2000;
    }
    config.mean_gap[SIM_LINK_UNPLUG] = 20000;
    connect();
    for (int i = 0; i < 180; i++) {
        send(0x60);
        run_ms(1000);
    }
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        TEST_ASSERT_TRUE(heard.begun[kind] > 5);
    }
    sim_link_calm(&wire, now);
    run_ms(6000);
    expect_the_truth_about_every_packet();
}

void test_a_calmed_wire_has_no_more_faults(void)
{
    scan_with(SIM_LINK_FLIP, 1000, 10);
    sim_link_calm(&wire, now);
    memset(&heard, 0, sizeof heard);
    run_ms(10000);
    TEST_ASSERT_EQUAL_UINT(0, heard.begun[SIM_LINK_FLIP]);
}

void test_the_same_seed_gives_the_same_faults_whatever_the_steps(void)
{
    static uint8_t other[STREAM_MAX];
    size_t other_size;
    config.mean_gap[SIM_LINK_DROP] = 1000;
    config.mean_gap[SIM_LINK_STALL] = 500;
    config.mean_gap[SIM_LINK_GARBLE] = 3000;
    connect();
    send(0x60);
    run_ms(10000);
    memcpy(other, stream, size);
    other_size = size;
    connect();
    send(0x60);
    size = sim_link_read(&wire, 10000000, stream, STREAM_MAX);
    TEST_ASSERT_TRUE(size > 100000);
    TEST_ASSERT_EQUAL_size_t(other_size, size);
    TEST_ASSERT_EQUAL_MEMORY(other, stream, size);
}

void test_the_next_event_is_never_later_than_the_next_byte(void)
{
    scan_with(SIM_LINK_STALL, 200, 3);
    for (int i = 0; i < 20000; i++) {
        const uint64_t next = sim_link_next_us(&wire);
        if (next > now + 1u) {
            TEST_ASSERT_EQUAL_size_t(0, sim_link_read(&wire, next - 1u, stream, 100));
        }
        now = next > now ? next : now + 1u;
        sim_link_read(&wire, now, stream, 100);
    }
}

void test_kinds_have_names(void)
{
    TEST_ASSERT_EQUAL_STRING("unplug", sim_link_kind_name(SIM_LINK_UNPLUG));
    TEST_ASSERT_EQUAL(SIM_LINK_STALL, sim_link_kind_named("stall"));
    TEST_ASSERT_EQUAL(SIM_LINK_KINDS, sim_link_kind_named("stal"));
}
