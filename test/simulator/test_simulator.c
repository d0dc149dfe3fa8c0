/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares the simulated lidar's bytes with docs/protocol.md. host.decode compares those of a
 * healthy one with test/recordings. They come over the faulty wire, which makes the faults asked
 * for, and reports them correctly. */

#include "link.h"
#include "reference_decoder.h"
#include "rows.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STREAM_MAX 4000000u
#define PACKETS_MAX 20000u

static sim_t sim;
static sim_config_t config;
static sim_link_t wire;
static sim_link_config_t wire_config;
static uint64_t now;
static uint8_t stream[STREAM_MAX];
static size_t size;
static size_t taken;  /* Bytes of the stream that a row has named. */
static size_t marked; /* Bytes that had come. */

/* A stream to compare with, and its time. */
static uint8_t kept[STREAM_MAX];
static size_t kept_size;
static uint64_t kept_us;

/* What the wire has reported. */
static struct {
    sim_link_packet_t packet;
    uint8_t bytes[SIM_FRAME_MAX];
} fates[PACKETS_MAX];
static size_t fate_count;

static struct {
    unsigned begun[SIM_LINK_KINDS];
    unsigned ended[SIM_LINK_KINDS];
    unsigned partial; /* Packets of a revolution that began at another angle than usual. */
} heard;

/* Spoils the first event of the kind; how many there have been. */
static struct {
    sim_event_t event;
    sim_trouble_t trouble;
    uint32_t ms;
    unsigned count;
} spoil;

/* ---- The lidar and its wire ---- */

static void hear_packet(void *context, const sim_link_packet_t *packet)
{
    (void)context;
    fates[fate_count].packet = *packet;
    memcpy(fates[fate_count].bytes, packet->sent.bytes, packet->sent.length);
    fate_count++;
    heard.partial += packet->sent.is_of_partial ? 1u : 0u;
}

static void hear_fault(void *context, sim_link_kind_t kind, bool begins, uint64_t at_us)
{
    (void)context;
    (void)at_us;
    heard.begun[kind] += begins ? 1u : 0u;
    heard.ended[kind] += begins ? 0u : 1u;
}

static sim_trouble_t spoil_event(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms)
{
    const bool is_first = event == spoil.event && spoil.count++ == 0;
    (void)context;
    (void)now_us;
    *ms = spoil.ms;
    return is_first ? spoil.trouble : SIM_SOUND;
}

static void power_up(void)
{
    static const sim_observer_t spoiler = {.on_event = spoil_event};
    static const sim_link_observer_t observer = {.on_packet = hear_packet, .on_fault = hear_fault};
    sim_init(&sim, &config);
    sim_observe(&sim, &spoiler);
    sim_link_init(&wire, &sim, &wire_config);
    sim_link_observe(&wire, &observer);
    memset(&heard, 0, sizeof heard);
    memset(&spoil, 0, sizeof spoil);
    fate_count = 0;
    now = 0;
    size = 0;
    taken = 0;
}

/* The time is this; nothing was taken since the latest bytes. They never come faster than 230400
 * baud, ten bits for each. */
static void run_until(uint64_t us)
{
    const size_t more = sim_link_read(&wire, us, stream + size, STREAM_MAX - size);
    const bool is_slow = more <= (us - now) * 72u / 3125u + 1u;
    TEST_ASSERT_TRUE(is_slow || heard.begun[SIM_LINK_INSERT] > 0);
    TEST_ASSERT_EQUAL_UINT32(0, sim.line.lost);
    now = us;
    size += more;
}

static void run_ms(uint32_t milliseconds)
{
    for (; milliseconds > 0; milliseconds--) {
        run_until(now + 1000u);
    }
}

static void send(uint8_t code)
{
    const uint8_t command[2] = {0xA5, code};
    sim_link_write(&wire, command, 2, now);
}

static void forget(void)
{
    taken = 0;
    size = 0;
    memset(&heard, 0, sizeof heard);
}

/* Scans for some seconds, after the spin-up. */
static void scan_seconds(uint32_t seconds)
{
    send(0x60);
    run_ms(3000);
    forget();
    run_ms(seconds * 1000u);
}

void setUp(void)
{
    config = sim_default_config();
    wire_config = sim_link_default_config();
    power_up();
}

/* ---- What the stream holds, according to an independent decoder ---- */

static reference_item_t packets[PACKETS_MAX];
static size_t packet_count;
static reference_counts_t counts;

static struct {
    unsigned ranges;
    unsigned flags[4];
    unsigned lone;   /* Packets of one sample, with LSA slightly below FSA, */
    unsigned askew;  /* and with another LSA. */
    unsigned gaps;   /* Bytes between packets. */
    unsigned aa;     /* LastCRC of this value, */
    unsigned wrong;  /* and of a wrong one. */
    unsigned cts;    /* CT bytes of point packets that are not 0. */
    unsigned off;    /* The farthest start packet from its usual angle, but for the first packet, */
    unsigned hz;     /* and the frequency farthest from the one set, in 0.1 Hz. */
    unsigned before; /* Samples before the first start packet. */
} is;

static size_t absolute(size_t a, size_t b)
{
    return a > b ? a - b : b - a;
}

static unsigned larger(unsigned a, unsigned b)
{
    return a > b ? a : b;
}

static unsigned apart_q6(unsigned a, unsigned b)
{
    const unsigned turned = (a + ENCODE_FULL_TURN_Q6 - b) % ENCODE_FULL_TURN_Q6;
    return turned < ENCODE_FULL_TURN_Q6 / 2u ? turned : ENCODE_FULL_TURN_Q6 - turned;
}

/* A start packet that is not the first packet. */
static void measure_start(const reference_item_t *packet, uint8_t crc, bool is_whole)
{
    const uint8_t last_crc = packet->bytes[-1];
    is.aa += last_crc == 0xAA ? 1u : 0u;
    is.wrong += is_whole && crc != last_crc ? 1u : 0u;
    is.off = larger(is.off, apart_q6(packet->fsa >> 1, config.start_angle_q6));
    is.hz = larger(is.hz, (unsigned)absolute(packet->ct >> 1, config.frequency_chz / 10u));
}

static void measure_point_packet(const reference_item_t *packet)
{
    is.cts += packet->ct != 0 ? 1u : 0u;
    if (packet->lsn == 1u && packet->fsa > 20u) {
        is.lone += packet->lsa == packet->fsa - 14u ? 1u : 0u;
        is.askew += packet->lsa == packet->fsa - 14u ? 0u : 1u;
    }
}

static void measure(void)
{
    uint8_t crc = 0;
    unsigned turns = 0;
    memset(&is, 0, sizeof is);
    for (size_t i = 0; i < packet_count; i++) {
        const reference_item_t *const packet = &packets[i];
        if (!packet->starts_revolution) {
            measure_point_packet(packet);
        } else if (i > 0) {
            measure_start(packet, crc, turns > 0);
        }
        is.gaps +=
            i > 0 ? (unsigned)(packet->offset - packets[i - 1].offset - packets[i - 1].length) : 0;
        turns += packet->starts_revolution ? 1u : 0u;
        is.before += turns == 0 ? packet->lsn : 0u;
        crc = encode_crc8(packet->starts_revolution ? 0 : crc, packet->ct);
        for (unsigned s = 0; s < packet->lsn; s++) {
            const reference_point_t point = reference_point(packet->bytes, s);
            is.ranges += point.distance_mm != 0u ? 1u : 0u;
            is.flags[point.flag]++;
        }
    }
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
    measure();
}

static size_t next_start(size_t from)
{
    while (from < packet_count && !packets[from].starts_revolution) {
        from++;
    }
    TEST_ASSERT_TRUE_MESSAGE(from < packet_count, "no more start packets");
    return from;
}

/* ---- What the wire reports ---- */

/* Every packet reported as intact has arrived. An independent decoder finds hardly any others (for
 * example, after two flips in one column of the checksum). */
static void expect_the_truth_about_every_packet(void)
{
    const reference_options_t options = {80, NULL};
    size_t there = 0;
    size_t intact = 0;
    for (size_t i = 0; i < fate_count; i++) {
        const sim_link_packet_t *packet = &fates[i].packet;
        intact += packet->intact ? 1u : 0u;
        if (packet->intact && packet->offset + packet->sent.length <= size) {
            TEST_ASSERT_EQUAL_MEMORY(fates[i].bytes, stream + packet->offset, packet->sent.length);
            there++;
        }
    }
    const uint64_t found = reference_decode(stream, size, &options, NULL, NULL).packets;
    TEST_ASSERT_TRUE(found >= there && found <= there + fate_count / 1000u);
    TEST_ASSERT_EQUAL_size_t(fate_count, wire.counts.packets);
    TEST_ASSERT_EQUAL_size_t(intact, wire.counts.intact_packets);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        TEST_ASSERT_UINT_WITHIN(1, heard.begun[kind], heard.ended[kind]);
        TEST_ASSERT_EQUAL_UINT(heard.begun[kind], wire.counts.faults[kind]);
    }
}

/* ---- Facts ---- */

static unsigned kind_named(const char *word)
{
    unsigned kind = 0;
    while (kind < SIM_LINK_KINDS && !row_is(word, sim_link_kind_name((sim_link_kind_t)kind))) {
        kind++;
    }
    return kind;
}

/* "begun.drop": faults of a kind. */
static bool is_count_of_faults(const char *word, const char *prefix, const unsigned *faults)
{
    row_number_t numbers[SIM_LINK_KINDS];
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        numbers[kind] = (row_number_t){sim_link_kind_name((sim_link_kind_t)kind), faults[kind]};
    }
    return strncmp(word, prefix, strlen(prefix)) == 0 &&
           row_expects(word + strlen(prefix), numbers);
}

static bool is_fact(const char *word)
{
    const uint32_t spoilt = wire.counts.packets - wire.counts.intact_packets;
    decode();
    const row_number_t facts[] = {
        {"bytes", (uint32_t)size},
        {"hz", sim_frequency_chz(&sim)},
        {"sleeps", sim_next_us(&sim) == SIM_NEVER},
        {"faults", sim_health(&sim)},
        {"next", (uint32_t)sim_link_next_us(&wire)},
        {"lost_frames", sim.line.lost},
        {"commands", sim.counts.commands},
        {"unknown", sim.counts.unknown_commands},
        {"forbidden", sim.counts.commands_while_scanning},
        {"in_tail", sim.counts.commands_in_tail},
        {"packets", (uint32_t)counts.packets},
        {"starts", (uint32_t)counts.start_packets},
        {"replies", (uint32_t)counts.replies},
        {"points", (uint32_t)counts.points},
        {"uncounted", (uint32_t)(absolute(counts.packets, sim.counts.packets) +
                                 absolute(counts.start_packets, sim.counts.start_packets) +
                                 absolute(counts.points, sim.counts.samples))},
        {"checksum_errors", (uint32_t)counts.checksum_errors},
        {"stray", (uint32_t)(size - counts.bytes_in_packets - counts.start_packets)},
        {"ranges", is.ranges},
        {"flag1", is.flags[1]},
        {"flag2", is.flags[2]},
        {"flag3", is.flags[3]},
        {"lone_ones", is.lone},
        {"askew", is.askew},
        {"gaps", is.gaps},
        {"aa", is.aa},
        {"wrong_crc", is.wrong},
        {"point_cts", is.cts},
        {"start_off", is.off},
        {"uneven", is.hz},
        {"before", is.before},
        {"first_off", packet_count > 0 ? apart_q6(packets[0].fsa >> 1, config.first_angle_q6) : 0},
        {"partial", heard.partial},
        {"first_ct", packet_count > 0 ? packets[0].ct : 0},
        {"turned",
         packet_count > 0 ? (uint32_t)(packets[packet_count - 1u].lsa - packets[0].fsa) : 0u},
        {"intact", wire.counts.intact_packets},
        {"spoilt", spoilt},
        {"latest_intact", fate_count > 0 && fates[fate_count - 1u].packet.intact},
        {"untold", (uint32_t)absolute(sim.counts.packets, fate_count)},
        {"unexplained", (uint32_t)absolute(heard.ended[SIM_LINK_CUT], spoilt)},
        {"unaccounted", (uint32_t)absolute(size + heard.begun[SIM_LINK_DROP],
                                           wire.passed + heard.begun[SIM_LINK_INSERT])},
        {"new", (uint32_t)(size - marked)},
        {"faulty", sim_link_is_faulty(&wire)},
        {"last_fault", (uint32_t)wire.last_fault_us},
    };
    return row_expects(word, facts) || is_count_of_faults(word, "begun.", heard.begun) ||
           is_count_of_faults(word, "ended.", heard.ended);
}

/* A setting of the lidar, or the mean gap of a fault of the wire; before anything else: powers up
 * again. */
static bool is_setting(const char *word)
{
    const row_member_t members[] = {
        {"ct_information", MEMBER(config.ct_information)},
        {"frequency", MEMBER(config.frequency_chz)},
        {"latency", MEMBER(config.reply_latency_ms)},
        {"tail", MEMBER(config.stop_tail_ms)},
        {"fatal", MEMBER(config.fatal_health)},
        {"never_answers", MEMBER(config.never_answers)},
        {"blocked_sends_starts", MEMBER(config.blocked_sends_starts)},
        {"beginning", MEMBER(config.beginning)},
        {"first_angle", MEMBER(config.first_angle_q6)},
        {"start_angle", MEMBER(config.start_angle_q6)},
        {"spin_percent", MEMBER(config.spin_up_percent)},
        {"wobble", MEMBER(config.wobble_permille)},
        {"lone", MEMBER(config.lone_packet_permille)},
        {"flagged", MEMBER(config.flagged_permille)},
        {"marked", MEMBER(config.marked)},
        {"sample_size", MEMBER(config.sample_size)},
        {"blind_every", MEMBER(config.blind_every)},
    };
    const unsigned kind = kind_named(word);
    if (kind < SIM_LINK_KINDS) {
        wire_config.mean_gap[kind] = row_number(word);
    } else if (!row_stores(word, members)) {
        return false;
    }
    power_up();
    return true;
}

/* The next bytes of the stream. */
static void expect_bytes(const char *hex)
{
    uint8_t bytes[ROW_WORD_MAX];
    const size_t count = row_bytes(hex, bytes);
    run_ms(taken == 0 ? 10 : 0);
    TEST_ASSERT_TRUE_MESSAGE(taken + count <= size, "no more bytes come");
    TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, &stream[taken], count);
    taken += count;
}

static void expect_frequency(unsigned chz)
{
    char hex[30];
    (void)snprintf(hex, sizeof hex, "A55A0400000004%02X%02X0000", chz & 0xFF, chz >> 8);
    expect_bytes(hex);
    TEST_ASSERT_EQUAL_size_t(taken, size);
    forget();
}

static void expect_range_at(unsigned angle_q6, unsigned distance_mm)
{
    decode();
    for (size_t i = next_start(0); i < packet_count; i++) {
        for (unsigned s = 0; s < packets[i].lsn; s++) {
            const reference_point_t point = reference_point(packets[i].bytes, s);
            if (point.angle_q6 + 20u > angle_q6 && point.angle_q6 < angle_q6 + 20u &&
                point.distance_mm != 0u) {
                TEST_ASSERT_UINT_WITHIN(20, distance_mm, point.distance_mm);
                return;
            }
        }
    }
    TEST_FAIL_MESSAGE("no point there");
}

static void expect_no_mark_twice(void)
{
    static bool is_known[1u << 24];
    decode();
    for (size_t at = 0; at < packet_count; at++) {
        for (unsigned i = 0; i < packets[at].lsn; i++) {
            const reference_point_t point = reference_point(packets[at].bytes, i);
            bool *const mark = &is_known[(uint32_t)point.intensity << 16 |
                                         (uint32_t)point.flag << 14 | point.distance_mm];
            TEST_ASSERT_FALSE(*mark);
            *mark = true;
        }
    }
}

static void keep(void)
{
    memcpy(kept, stream, size);
    kept_size = size;
    kept_us = now;
    power_up();
}

/* Until then at once, without the wire, in portions of this size. */
static void transmit_by(uint32_t portion)
{
    size_t more;
    do {
        more = sim_transmit(&sim, kept_us, stream + size, portion);
        size += more;
    } while (more > 0);
}

/* Nothing comes before the next event. */
static void run_to_next(void)
{
    const uint64_t next = sim_link_next_us(&wire);
    const size_t before = size;
    if (next > now + 1u) {
        run_until(next - 1u);
    }
    TEST_ASSERT_EQUAL_size_t(before, size);
    run_until(next > now ? next : now + 1u);
}

/* Flips the first byte of a frame: LastCRC before a start packet, otherwise the header. */
static void hit_a_frame(void)
{
    while (wire.packet_open) {
        run_until(now + 20u);
    }
    const size_t before = fate_count;
    sim_link_force(&wire, SIM_LINK_FLIP, 0, now);
    while (fate_count == before) {
        run_until(now + 20u);
    }
    TEST_ASSERT_EQUAL(fates[before].packet.sent.starts_revolution, fates[before].packet.intact);
}

static void plan_trouble(const char *text)
{
    static const char *const events[] = {"command", "reply", "beginning", "start"};
    unsigned event = 0;
    while (!row_is(text, events[event])) {
        TEST_ASSERT_TRUE_MESSAGE(++event < sizeof events / sizeof events[0], text);
    }
    spoil.event = (sim_event_t)event;
    spoil.trouble = sim_trouble_named(row_text(text), &spoil.ms);
    spoil.count = 0;
}

/* "stall:100" */
static void force(const char *text)
{
    const unsigned kind = kind_named(text);
    TEST_ASSERT_TRUE_MESSAGE(kind < SIM_LINK_KINDS, text);
    sim_link_force(&wire, (sim_link_kind_t)kind, row_number(text), now);
}

static void send_raw(const char *hex)
{
    uint8_t bytes[ROW_WORD_MAX];
    sim_link_write(&wire, bytes, row_bytes(hex, bytes), now);
}

/* ">0D": a command; "<0DA5": bytes to the lidar; "+50": 50 ms pass; "~100": 100 us; "=A55A": the
 * next bytes, which come within 10 ms; "end": no more come; "got:600": the reply that a frequency
 * is set; "forget": what came before no longer counts; "@idle": the mode; "at:64:2300": angle and
 * range; "ct:3:40": the CT byte of a packet in a turn; "spoil:command:late700", "befalls:no-scans":
 * trouble; "fails": power is lost N microseconds later, and the wire does not notice;
 * "force:stall:100": a fault of the wire; "calm"; "truth": what it has reported about each packet
 * is true; "keep": a new lidar, whose stream must become the "same"; "by:7": it is taken at once,
 * in portions of 7; settings and facts above. */
static void tell(char *word)
{
    const uint32_t number = row_number(word);
    const char *const text = row_text(word);
    unsigned a, b;
    uint32_t ms;
    if (word[0] == '>') {
        send((uint8_t)strtoul(&word[1], NULL, 16));
    } else if (word[0] == '<') {
        send_raw(&word[1]);
    } else if (word[0] == '+') {
        run_ms((uint32_t)atoi(&word[1]));
    } else if (word[0] == '~') {
        run_until(now + (uint32_t)atoi(&word[1]));
    } else if (word[0] == '=') {
        expect_bytes(&word[1]);
    } else if (word[0] == '@') {
        TEST_ASSERT_EQUAL_STRING(&word[1], sim_mode_name(sim_mode(&sim)));
    } else if (sscanf(word, "at:%u:%u", &a, &b) == 2) {
        expect_range_at(a, b);
    } else if (sscanf(word, "ct:%u:%x", &a, &b) == 2) {
        decode();
        TEST_ASSERT_EQUAL_HEX8(b, packets[next_start(0) + a].ct);
    } else if (row_is(word, "spoil")) {
        plan_trouble(text);
    } else if (row_is(word, "befalls")) {
        const sim_trouble_t trouble = sim_trouble_named(text, &ms);
        sim_befall(&sim, trouble, ms, now);
    } else if (row_is(word, "force")) {
        force(text);
    } else if (row_is(word, "end")) {
        TEST_ASSERT_EQUAL_size_t(taken, size);
        forget();
    } else if (row_is(word, "forget")) {
        forget();
    } else if (row_is(word, "marks")) {
        expect_no_mark_twice();
    } else if (row_is(word, "truth")) {
        expect_the_truth_about_every_packet();
    } else if (row_is(word, "keep")) {
        keep();
    } else if (row_is(word, "same")) {
        TEST_ASSERT_EQUAL_size_t(kept_size, size);
        TEST_ASSERT_EQUAL_MEMORY(kept, stream, size);
    } else if (row_is(word, "step")) {
        run_to_next();
    } else if (row_is(word, "inside")) {
        do {
            run_ms(1);
        } while (!wire.packet_open);
    } else if (row_is(word, "spoilt_once")) {
        do {
            run_ms(1);
        } while (spoil.count == 0);
    } else if (row_is(word, "hit")) {
        hit_a_frame();
    } else if (row_is(word, "mark")) {
        marked = size;
    } else if (row_is(word, "by")) {
        transmit_by(number);
    } else if (row_is(word, "clear")) {
        sim_clear_obstacles(&sim);
    } else if (row_is(word, "got")) {
        expect_frequency(number);
    } else if (row_is(word, "us")) {
        run_until(number);
    } else if (row_is(word, "scan")) {
        scan_seconds(number);
    } else if (row_is(word, "untaken")) {
        sim_receive(&sim, (const uint8_t[]){0xA5, 0x65}, 2, now + number * 1000u);
    } else if (row_is(word, "sick")) {
        sim_set_health(&sim, (uint8_t)number);
    } else if (row_is(word, "block")) {
        sim_block_rotor(&sim, number != 0);
    } else if (row_is(word, "cover")) {
        sim_cover_window(&sim, number != 0);
    } else if (row_is(word, "power")) {
        sim_power(&sim, number != 0, now);
    } else if (row_is(word, "fails")) {
        sim_power(&sim, false, now + number);
    } else if (row_is(word, "obstacle")) {
        sim_place_obstacle(&sim, 0, 640, (uint16_t)number);
    } else if (row_is(word, "calm")) {
        sim_link_calm(&wire, now);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(is_setting(word) || is_fact(word), word);
    }
}

/* A step by 1 Hz is spoilt: the bytes that come of it in 100 ms, the frequency, and all bytes after
 * a question 5 s later. */
#define SPOILT(claim, trouble, bytes, hz, all_bytes) \
    ROW(claim,                                       \
        "spoil:" trouble " >0B +100 bytes:" bytes " +5000 >0D +1000 hz:" hz " bytes:" all_bytes)

static const row_t rows[] IN_FLASH = {
    ROW(it_is_idle_and_silent_after_power_up, "+5000 bytes:0 @idle hz:600 sleeps:1"),
    ROW(device_information_has_the_minor_firmware_version_first,
        ">90 =A55A1400000004 =9702010102000206 =000301070000000102030405 end"),
    ROW(health_is_all_clear_at_first_and_reports_the_bits_that_are_set,
        ">92 =A55A0300000006000000 end sick:0x18 >92 =A55A0300000006181800 end"),
    ROW(frequency_steps_are_a_tenth_and_a_whole_hertz,
        ">0D got:600 >09 got:610 >0B got:710 >0A got:700 >0C got:600"),
    ROW(a_step_beyond_the_upper_limit_changes_nothing_and_says_so, "frequency:1150 >0B got:1150"),
    ROW(a_step_beyond_the_lower_limit_changes_nothing_and_says_so, "frequency:500 >0A got:500"),
    ROW(the_upper_limit_itself_can_be_reached, "frequency:1190 >09 got:1200"),
    ROW(the_lower_limit_itself_can_be_reached, "frequency:600 >0C got:500"),
    ROW(stop_and_unknown_commands_have_no_reply, ">65 >61 >00 +100 bytes:0 commands:1 unknown:2"),
    ROW(a_command_may_arrive_in_two_parts_and_among_garbage, "<0D60A5A5 +50 <0D6090 got:600 @idle"),
    ROW(an_undocumented_command_is_answered_with_four_zeros, ">98 =A55A040000001000000000 end"),
    ROW(a_reply_comes_after_the_latency_at_the_lines_speed,
        "latency:20 >92 us:20043 bytes:0 us:20044 bytes:1 us:20434 bytes:9 us:20435 bytes:10"),
    ROW(one_reply_can_be_delayed_and_the_next_one_waits_for_it,
        "befalls:late3000 >92 +1000 >0D +1990 bytes:0 +20 bytes:21 =A55A0300000006000000 "
        "=A55A0400000004 forget >0D got:600"),
    ROW(a_stream_waits_for_its_own_late_reply,
        "befalls:late3000 >92 +1000 >60 +2200 bytes:17 =A55A0300000006000000 =A55A0500004081 +1000 "
        "packets>50"),
    ROW(one_reply_can_be_lost, "befalls:lost >0D +100 bytes:0 >0D got:600"),
    ROW(a_lidar_that_never_answers_obeys,
        "never_answers:1 >0B +100 bytes:0 hz:700 scan:1 packets>90"),
    ROW(the_ct_bytes_carry_what_section_7_says,
        "scan:5 ct:1:40 ct:3:00 ct:4:22 ct:5:04 ct:9:30 ct:10:30 ct:11:88 ct:12:C0 ct:13:72"),
    ROW(a_covered_window_gives_no_ranges_and_the_data_fault,
        "cover:1 scan:3 ranges:0 ct:3:40 cover:0 +1000 forget +1000 ranges>3000 ct:3:00"),
    ROW(a_blocked_rotor_gives_no_ranges_and_the_encoder_fault,
        "block:1 scan:3 packets>250 ranges:0 ct:3:04"),
    ROW(a_blocked_rotor_may_stop_the_start_packets,
        "blocked_sends_starts:0 block:1 scan:3 packets>250 starts:0 turned:0 block:0 +2000 "
        "starts>5"),
    ROW(a_fatal_fault_ends_the_stream_until_it_is_gone_and_start_is_sent,
        "fatal:0x10 scan:1 sick:0x10 @fault +20 forget >60 +2000 bytes:7 sick:0 >60 +2000 "
        "@scanning bytes>10000"),
    ROW(a_turn_may_have_no_range_without_a_fault,
        "blind_every:1 scan:3 packets>250 ranges:0 ct:3:00"),
    ROW(a_unit_with_larger_samples_sends_longer_packets_none_of_them_valid,
        "sample_size:4 scan:3 packets<20 bytes>48000"),
    ROW(the_room_is_seen_clockwise_from_straight_ahead,
        "scan:1 at:64:2300 at:5760:2800 at:11520:1700 at:17280:2200"),
    ROW(a_round_pillar_stands_ahead_to_the_left, "scan:1 at:22316:1380"),
    ROW(an_obstacle_appears_where_it_is_placed_and_can_be_removed,
        "obstacle:400 scan:1 at:64:400 at:23000:400 at:400:2314 clear forget +1000 at:64:2300"),
    ROW(stop_has_a_tail_of_whole_packets,
        "tail:100 scan:1 forget >65 @stopping +90 bytes>1000 +30 @idle forget +1000 bytes:0"),
    ROW(a_stop_before_the_first_packet_leaves_silence, ">60 +100 >65 @idle forget +1000 bytes:0"),
    ROW(commands_while_scanning_are_counted_and_answered_between_packets,
        "scan:1 forget >0D >60 +1000 forbidden:2 checksum_errors:0 stray>18 stray<278 >65 "
        "forbidden:2 >0D forbidden:2 in_tail:1"),
    ROW(a_lost_start_reply_does_not_stop_the_stream,
        "befalls:lost >60 +2000 replies:0 packets>100"),
    ROW(nothing_is_answered_during_a_reboot_and_the_frequency_is_reset,
        ">0B +10 >40 @booting forget +2490 >0D +100 bytes:0 @idle >0D got:600"),
    ROW(a_reboot_forgets_a_reply_that_is_due, ">90 >40 +5000 bytes:0"),
    ROW(losing_power_cuts_a_packet_in_the_middle,
        "scan:1 inside forget power:0 +5000 bytes:0 @off power:1 @booting +2500 @idle >0D got:600"),
    ROW(losing_power_forgets_a_late_command_and_half_of_one,
        "spoil:command:late5000 >0B <A5 power:0 power:1 +4000 <0D +2000 bytes:0 hz:600"),
    ROW(commands_wait_for_a_late_one_and_keep_their_order,
        "spoil:command:late700 >0B >0A +699 bytes:0 +20 bytes:22 =A55A0400000004BC020000 "
        "=A55A0400000004B2020000 end"),
    ROW(replies_wait_for_a_late_one, "spoil:reply:late700 >0B >0A +700 bytes:0 +20 bytes:22"),
    ROW(each_reply_can_be_spoilt_also_where_a_late_one_was_kept,
        "spoil:reply:late100 >0D +200 3( >0D +50 ) forget spoil:reply:lost >0D +50 bytes:0"),
    ROW(a_scan_that_loses_its_beginning_does_not_begin_and_another_start_is_obeyed,
        "spoil:beginning:lost >60 +2000 bytes:7 @idle scan:1 packets>90"),
    ROW(start_packets_are_missing_until_it_boots,
        "spoil:start:no-starts >60 +4000 starts:0 packets>200 >65 +500 scan:1 starts:0 >40 +2501 "
        "scan:1 starts>0"),
    ROW(a_start_packet_is_doubled,
        "first_angle:100 spin_percent:100 wobble:0 spoil:start:doubled >60 +1150 starts:6"),
    ROW(a_start_packet_is_lost,
        "first_angle:100 spin_percent:100 wobble:0 spoil:start:lost >60 +1150 starts:4"),
    ROW(a_lidar_that_answers_and_does_not_scan_needs_a_reboot,
        "befalls:no-scans >60 +2000 bytes:7 >40 +2501 scan:1 packets>90"),
    SPOILT(a_command_is_obeyed_and_answered, "command:sound", "11", "700", "22"),
    SPOILT(a_lost_command_is_not_obeyed, "command:lost", "0", "600", "11"),
    SPOILT(a_late_command_is_obeyed_later, "command:late1000", "0", "700", "22"),
    SPOILT(a_doubled_command_is_obeyed_twice, "command:doubled", "22", "800", "33"),
    SPOILT(a_deaf_lidar_does_not_hear_the_command, "command:deaf1000", "0", "600", "11"),
    SPOILT(a_silent_lidar_obeys_and_does_not_answer, "command:silent1000", "0", "700", "11"),
    SPOILT(a_power_cut_at_a_command_forgets_it, "command:cut1000", "0", "600", "11"),
    SPOILT(a_reboot_at_a_command_forgets_it, "command:reboots", "0", "600", "11"),
    SPOILT(a_lost_reply_does_not_come, "reply:lost", "0", "700", "11"),
    SPOILT(a_late_reply_comes_later, "reply:late1000", "0", "700", "22"),
    SPOILT(a_doubled_reply_comes_twice, "reply:doubled", "22", "700", "33"),
    SPOILT(a_lidar_that_is_deaf_at_a_reply_sends_it, "reply:deaf1000", "11", "700", "22"),
    SPOILT(a_lidar_that_is_silent_at_a_reply_does_not_send_it, "reply:silent1000", "0", "700",
           "11"),
    SPOILT(a_power_cut_at_a_reply_forgets_the_step, "reply:cut1000", "0", "600", "11"),
    SPOILT(a_reboot_at_a_reply_forgets_the_step, "reply:reboots", "0", "600", "11"),
    ROW(of_a_silent_lidar_nobody_can_know_that_it_scans,
        "spoil:start:silent800 >60 spoilt_once +30 >90 forbidden:0 forget +1000 >90 forbidden:1"),
    ROW(a_silent_stream_goes_on_afterwards,
        "spoil:start:silent800 >60 spoilt_once +30 forget +760 bytes:0 +1000 packets>90"),
    ROW(a_late_start_packet_delays_the_stream,
        "spoil:start:late800 >60 spoilt_once +30 forget +760 bytes:0 +1000 packets>90"),
    ROW(lone_point_packets_end_slightly_before_they_begin,
        "lone:200 scan:10 lone_ones>100 askew:0"),
    ROW(start_packets_are_at_the_start_angle, "start_angle:7424 scan:5 starts>25 start_off<57"),
    ROW(bytes_never_come_faster_than_the_line, ">60 30000( ~100 ) bytes>20000"),
    ROW(one_late_call_gives_the_same_bytes_as_many_early_ones,
        ">60 +5000 bytes>40000 keep >60 by:4000000 same"),
    ROW(a_small_buffer_loses_nothing, ">60 +5000 keep >60 by:7 same"),
    ROW(the_first_packets_may_pass_the_start_packets_place_without_one,
        "beginning:1 first_angle:21101 >60 +1500 first_off<4 before>667 start_off<65"),
    ROW(the_first_packet_may_be_a_start_packet_anywhere_at_2_4_hz,
        "beginning:2 first_angle:5485 >60 +1500 first_off<4 before:0 first_ct:0x31 start_off<65 "
        "partial>15 partial<60"),
    ROW(last_crc_guards_the_ct_bytes_of_every_revolution, "scan:20 starts>100 wrong_crc:0"),
    ROW(last_crc_is_sometimes_aa, "frequency:1200 scan:120 aa>0 checksum_errors:0"),
    ROW(a_unit_without_ct_information_sends_neither_ct_nor_last_crc,
        "ct_information:0 scan:10 gaps:0 point_cts:0 uneven<2"),
    ROW(flags_2_and_3_occur_as_often_as_configured,
        "flagged:100 scan:10 flag1:0 flag2>1699 flag2<2301 flag3>1699 flag3<2301"),
    ROW(a_byte_is_there_when_all_of_it_has_left,
        "latency:1 >92 next:1000 us:1000 next:1044 us:1044 next:1087 us:1087 next:1131"),
    ROW(all_that_is_sent_is_counted, ">60 +5000 packets>400 uncounted:0"),
    ROW(frames_that_are_not_taken_in_time_are_lost_and_counted,
        "scan:1 untaken:500 lost_frames>28 lost_frames<46"),
    ROW(no_two_marks_are_equal_and_none_is_a_data_fault,
        "marked:1 scan:20 marks points>79000 faults:0"),

    /* The wire. 60 s are about 780,000 bytes and 6400 packets. */
    ROW(without_faults_every_packet_is_intact, ">60 +10000 truth spoilt:0 faulty:0 untold:0"),
    ROW(dropped_bytes_cost_the_packets_they_were_in,
        "drop:1000 >60 +60000 begun.drop>679 begun.drop<881 truth intact>5459 intact<5861 "
        "unaccounted:0"),
    ROW(flipped_bits_cost_the_packets_they_were_in,
        "flip:1000 >60 +60000 begun.flip>679 begun.flip<881 truth unaccounted:0"),
    ROW(inserted_bytes_cost_only_packets_that_they_split,
        "insert:1000 >60 +60000 begun.insert>679 begun.insert<881 truth unaccounted:0"),
    ROW(bursts_spoil_the_packets_they_touch,
        "burst:500 >60 +60000 begun.burst>79 begun.burst<161 truth spoilt>0 unaccounted:0"),
    ROW(a_silent_line_has_no_bursts_and_cuts, "burst:100 cut:100 +20000 begun.burst:0 begun.cut:0"),
    ROW(a_burst_ends_after_the_bytes_given,
        "latency:20 >92 force:burst:3 +100 ended.burst:1 last_fault:20131 bytes:10"),
    ROW(a_cut_loses_the_rest_of_one_packet,
        "cut:500 >60 +60000 begun.cut>79 begun.cut<161 truth unexplained<2 unaccounted>0"),
    ROW(a_stall_makes_bytes_late_but_loses_none,
        "stall:1000 >60 +60000 begun.stall>34 begun.stall<86 calm +1000 truth spoilt:0 "
        "unaccounted:0"),
    ROW(nothing_comes_during_a_stall_and_then_it_comes_at_the_lines_speed,
        ">60 +3000 force:stall:100 mark +100 new:0 50( mark +1 new>21 new<25 ) +1000 "
        "unaccounted:0"),
    ROW(a_stall_while_the_backlog_drains_holds_the_rest_back,
        ">60 +3000 force:stall:100 +110 force:stall:50 mark +50 new:0 +1000 unaccounted:0 truth"),
    ROW(garbling_spoils_every_byte_while_it_lasts,
        ">60 +3000 force:garble:500 faulty:1 +2000 faulty:0 last_fault:3500000 spoilt>45 spoilt<63 "
        "truth"),
    ROW(unplugging_silences_the_line_and_resets_the_device,
        ">60 +3000 force:unplug:1000 mark +500 @off >60 +3100 new:0 @idle >0D +10 new:11"),
    ROW(a_packet_cut_by_unplugging_is_reported_as_hit,
        ">60 +3000 inside force:unplug:1000 latest_intact:0 truth"),
    ROW(a_packet_cut_by_a_reboot_is_reported_as_hit,
        ">60 +3000 inside >40 +3000 >60 +1000 truth spoilt:1"),
    ROW(what_left_before_power_was_lost_comes_and_the_packet_is_reported_as_hit,
        ">60 +3000 inside mark fails:300 +100 new>5 new<9 latest_intact:0 truth"),
    ROW(unplugging_ends_a_burst_and_a_cut_under_way,
        ">60 +3000 force:burst:5000 force:cut:0 +1 force:burst:5000 force:unplug:1000 +2000 "
        "faulty:0 begun.burst:1 ended.burst:1 ended.cut:1"),
    ROW(a_random_loss_of_power_ends_by_itself,
        "unplug:5000 60( >60 +1000 ) begun.unplug>2 begun.unplug<16 truth"),
    ROW(faults_of_bytes_can_be_forced_one_at_a_time,
        ">60 +3000 force:drop:0 force:cut:0 +1000 ended.drop:1 ended.cut:1 spoilt<3 truth"),
    ROW(all_kinds_of_faults_together_are_reported_correctly,
        "drop:2000 flip:2000 insert:2000 burst:2000 stall:2000 cut:2000 garble:2000 unplug:20000 "
        "180( >60 +1000 ) begun.drop>5 begun.flip>5 begun.insert>5 begun.burst>5 "
        "begun.stall>5 begun.cut>5 begun.garble>5 begun.unplug>5 calm +6000 truth"),
    ROW(a_calmed_wire_has_no_more_faults, "flip:1000 >60 +10000 calm forget +10000 begun.flip:0"),
    ROW(a_spoiled_last_crc_does_not_hit_the_start_packet,
        ">60 +3000 200( hit ) spoilt>100 spoilt<195"),
    ROW(the_same_seed_gives_the_same_faults_whatever_the_steps,
        "drop:1000 stall:500 garble:3000 >60 +10000 bytes>100000 keep >60 us:10000000 same"),
    ROW(the_next_event_is_never_later_than_the_next_byte, "stall:200 >60 +3000 20000( step )"),
};

void test_the_simulated_lidar_and_the_wire(void)
{
    tell_rows(rows, tell);
}
