/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The faulty wire: it makes the faults asked for, and reports them correctly. */

#include "link.h"
#include "reference_decoder.h"
#include "rows.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
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

static void scan(uint32_t seconds)
{
    connect();
    send(0x60);
    run_ms(seconds * 1000u);
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
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        TEST_ASSERT_UINT_WITHIN(1, heard.begun[kind], heard.ended[kind]);
        TEST_ASSERT_EQUAL_UINT(heard.begun[kind], wire.counts.faults[kind]);
    }
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

/* ---- Rows ---- */

static size_t marked; /* Bytes that had come. */

static void run_into_a_packet(void)
{
    do {
        run_ms(1);
    } while (!wire.packet_open);
}

static size_t absolute(size_t a, size_t b)
{
    return a > b ? a - b : b - a;
}

/* The number that a word names; "begun.drop": faults of a kind. */
static uint64_t look_up(const char *word)
{
    const size_t spoilt = fate_count - intact_packets();
    const char *const dot = strchr(word, '.');
    const sim_link_kind_t kind = dot == NULL ? SIM_LINK_DROP : sim_link_kind_named(dot + 1);
    TEST_ASSERT_NOT_EQUAL(SIM_LINK_KINDS, kind);
    const struct {
        const char *word;
        uint64_t number;
    } facts[] = {
        {"begun", heard.begun[kind]},
        {"ended", heard.ended[kind]},
        {"intact", intact_packets()},
        {"spoilt", spoilt},
        {"latest", fate_count > 0 && fates[fate_count - 1u].packet.intact ? 1 : 0},
        {"untold", absolute(sim.counts.packets, fate_count)},
        {"unexplained", absolute(heard.ended[SIM_LINK_CUT], spoilt)},
        {"unaccounted",
         absolute(size + heard.begun[SIM_LINK_DROP], wire.passed + heard.begun[SIM_LINK_INSERT])},
        {"new", size - marked},
        {"faulty", sim_link_is_faulty(&wire) ? 1 : 0},
        {"last_fault", sim_link_last_fault_us(&wire)},
    };
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++) {
        if (strncmp(facts[i].word, word, strcspn(word, ".")) == 0) {
            return facts[i].number;
        }
    }
    TEST_FAIL_MESSAGE(word);
    return 0;
}

/* Such a fact is this number; more; less. */
static void expect_fact(char *word)
{
    char *const sign = word + strcspn(word, ":<>");
    const char relation = *sign;
    const uint64_t number = strtoull(sign + 1, NULL, 10);
    char text[80];
    *sign = '\0';
    const uint64_t is = look_up(word);
    (void)snprintf(text, sizeof text, "%s is %llu", word, (unsigned long long)is);
    TEST_ASSERT_TRUE_MESSAGE(relation == ':'   ? is == number
                             : relation == '>' ? is > number
                                               : is < number,
                             text);
}

/* "drop:1000": the mean gap of a kind, before "connect" or "scan:60", which sends a start and runs
 * for 60 s; ">0D": a command; "+50": 50 ms pass; "force:stall:100"; "calm"; "truth": what is
 * reported about each packet is true; "@off": the device's mode; facts above. */
static void tell(char *word)
{
    char *const colon = strchr(word, ':');
    const uint32_t number = colon == NULL ? 0 : (uint32_t)strtoul(colon + 1, NULL, 10);
    char name[20];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(word, ":"), word);
    if (word[0] == '>') {
        send((uint8_t)strtoul(&word[1], NULL, 16));
    } else if (word[0] == '+') {
        run_ms((uint32_t)atoi(&word[1]));
    } else if (word[0] == '@') {
        TEST_ASSERT_EQUAL_STRING(&word[1], sim_mode_name(sim_mode(&sim)));
    } else if (strcmp(word, "truth") == 0) {
        expect_the_truth_about_every_packet();
    } else if (strcmp(word, "mark") == 0) {
        marked = size;
    } else if (strcmp(word, "forget") == 0) {
        memset(&heard, 0, sizeof heard);
    } else if (strcmp(word, "inside") == 0) {
        run_into_a_packet();
    } else if (strcmp(word, "calm") == 0) {
        sim_link_calm(&wire, now);
    } else if (strcmp(word, "connect") == 0) {
        connect();
    } else if (strcmp(name, "scan") == 0) {
        scan(number);
    } else if (strcmp(name, "fails") == 0) {
        sim_power(&sim, false, now + number);
    } else if (strcmp(name, "force") == 0) {
        char *const amount = strchr(colon + 1, ':');
        *amount = '\0';
        sim_link_force(&wire, sim_link_kind_named(colon + 1), (uint32_t)atoi(amount + 1), now);
    } else if (sim_link_kind_named(name) != SIM_LINK_KINDS) {
        config.mean_gap[sim_link_kind_named(name)] = number;
    } else {
        expect_fact(word);
    }
}

/* 60 s are about 780,000 bytes and 6400 packets. */
static const row_t rows[] IN_FLASH = {
    ROW(without_faults_every_packet_is_intact, "scan:10 truth spoilt:0 faulty:0 untold:0"),
    ROW(dropped_bytes_cost_the_packets_they_were_in,
        "drop:1000 scan:60 begun.drop>679 begun.drop<881 truth intact>5459 intact<5861 "
        "unaccounted:0"),
    ROW(flipped_bits_cost_the_packets_they_were_in,
        "flip:1000 scan:60 begun.flip>679 begun.flip<881 truth unaccounted:0"),
    ROW(inserted_bytes_cost_only_packets_that_they_split,
        "insert:1000 scan:60 begun.insert>679 begun.insert<881 truth unaccounted:0"),
    ROW(bursts_spoil_the_packets_they_touch,
        "burst:500 scan:60 begun.burst>79 begun.burst<161 truth spoilt>0 unaccounted:0"),
    ROW(a_cut_loses_the_rest_of_one_packet,
        "cut:500 scan:60 begun.cut>79 begun.cut<161 truth unexplained<2 unaccounted>0"),
    ROW(a_stall_makes_bytes_late_but_loses_none,
        "stall:1000 scan:60 begun.stall>34 begun.stall<86 calm +1000 truth spoilt:0 unaccounted:0"),
    ROW(nothing_comes_during_a_stall_and_then_it_comes_at_the_lines_speed,
        "scan:3 force:stall:100 mark +100 new:0 50( mark +1 new>21 new<25 ) +1000 unaccounted:0"),
    ROW(a_stall_while_the_backlog_drains_holds_the_rest_back,
        "scan:3 force:stall:100 +110 force:stall:50 mark +50 new:0 +1000 unaccounted:0 truth"),
    ROW(garbling_spoils_every_byte_while_it_lasts,
        "scan:3 force:garble:500 faulty:1 +2000 faulty:0 last_fault:3500000 spoilt>45 spoilt<63 "
        "truth"),
    ROW(unplugging_silences_the_line_and_resets_the_device,
        "scan:3 force:unplug:1000 mark +500 @off >60 +3100 new:0 @idle >0D +10 new:11"),
    ROW(a_packet_cut_by_unplugging_is_reported_as_hit,
        "scan:3 inside force:unplug:1000 latest:0 truth"),
    ROW(a_packet_cut_by_a_reboot_is_reported_as_hit,
        "scan:3 inside >40 +3000 >60 +1000 truth spoilt:1"),
    ROW(a_packet_cut_without_the_wires_knowledge_is_reported_as_hit,
        "scan:3 inside fails:300 +100 latest:0 truth"),
    ROW(unplugging_ends_a_burst_and_a_cut_under_way,
        "scan:3 force:burst:5000 force:cut:0 +1 force:burst:5000 force:unplug:1000 +2000 "
        "faulty:0 begun.burst:1 ended.burst:1 ended.cut:1"),
    ROW(a_random_loss_of_power_ends_by_itself,
        "unplug:5000 connect 60( >60 +1000 ) begun.unplug>2 begun.unplug<16 truth"),
    ROW(faults_of_bytes_can_be_forced_one_at_a_time,
        "scan:3 force:drop:0 force:cut:0 +1000 ended.drop:1 ended.cut:1 spoilt<3 truth"),
    ROW(all_kinds_of_faults_together_are_reported_correctly,
        "drop:2000 flip:2000 insert:2000 burst:2000 stall:2000 cut:2000 garble:2000 unplug:20000 "
        "connect 180( >60 +1000 ) begun.drop>5 begun.flip>5 begun.insert>5 begun.burst>5 "
        "begun.stall>5 begun.cut>5 begun.garble>5 begun.unplug>5 calm +6000 truth"),
    ROW(a_calmed_wire_has_no_more_faults, "flip:1000 scan:10 calm forget +10000 begun.flip:0"),
};

void test_the_wire(void)
{
    tell_rows(rows, tell);
}

/* ---- The rest ---- */

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

/* Flips the first byte of a frame: LastCRC before a start packet, otherwise the header. */
void test_a_spoiled_last_crc_does_not_hit_the_start_packet(void)
{
    unsigned starts = 0;
    scan(3);
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
    config.mean_gap[SIM_LINK_STALL] = 200;
    scan(3);
    for (int i = 0; i < 20000; i++) {
        const uint64_t next = sim_link_next_us(&wire);
        if (next > now + 1u) {
            TEST_ASSERT_EQUAL_size_t(0, sim_link_read(&wire, next - 1u, stream, 100));
        }
        now = next > now ? next : now + 1u;
        sim_link_read(&wire, now, stream, 100);
    }
}
