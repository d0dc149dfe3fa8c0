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

#define SECOND UINT64_C(1000000)
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
static reference_item_t packets[PACKETS_MAX];
static size_t packet_count;
static reference_counts_t counts;

/* What the wire has reported. */
static struct {
    sim_link_packet_t packet;
    uint8_t bytes[SIM_FRAME_MAX];
} fates[PACKETS_MAX];
static size_t fate_count;

static struct {
    unsigned begun[SIM_LINK_KINDS];
    unsigned ended[SIM_LINK_KINDS];
} heard;

/* ---- Helpers ---- */

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
    (void)at_us;
    heard.begun[kind] += begins ? 1u : 0u;
    heard.ended[kind] += begins ? 0u : 1u;
}

static void power_up(void)
{
    static const sim_link_observer_t observer = {.on_packet = hear_packet, .on_fault = hear_fault};
    sim_init(&sim, &config);
    sim_link_init(&wire, &sim, &wire_config);
    sim_link_observe(&wire, &observer);
    memset(&heard, 0, sizeof heard);
    fate_count = 0;
    now = 0;
    size = 0;
    taken = 0;
}

/* The time is this; nothing was taken since the latest bytes. */
static void run_until(uint64_t us)
{
    now = us;
    size += sim_link_read(&wire, now, stream + size, STREAM_MAX - size);
    TEST_ASSERT_EQUAL_UINT32(0, sim_lost_frames(&sim));
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

void setUp(void)
{
    config = sim_default_config();
    wire_config = sim_link_default_config();
    power_up();
}

/* ---- What spoils an event on the wire ---- */

/* The first event of the kind; how many there have been. */
static struct {
    sim_event_t event;
    sim_trouble_t trouble;
    uint32_t ms;
    unsigned count;
} spoil;

static sim_trouble_t spoil_event(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms)
{
    const bool is_first = event == spoil.event && spoil.count++ == 0;
    (void)context;
    (void)now_us;
    *ms = spoil.ms;
    return is_first ? spoil.trouble : SIM_SOUND;
}

static void unkind(sim_event_t event, sim_trouble_t trouble, uint32_t ms)
{
    const sim_observer_t observer = {.on_event = spoil_event};
    spoil.event = event;
    spoil.trouble = trouble;
    spoil.ms = ms;
    spoil.count = 0;
    sim_observe(&sim, &observer);
}

static unsigned number_of(const char *name, const char *const *names, unsigned count)
{
    unsigned number = 0;
    while (number < count && strncmp(name, names[number], strlen(names[number])) != 0) {
        number++;
    }
    TEST_ASSERT_TRUE_MESSAGE(number < count, name);
    return number;
}

/* ---- What the wire reports ---- */

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
    size_t there = 0;
    for (size_t i = 0; i < fate_count; i++) {
        const sim_link_packet_t *packet = &fates[i].packet;
        if (is_in_stream(packet)) {
            TEST_ASSERT_EQUAL_MEMORY(fates[i].bytes, stream + packet->offset, packet->sent.length);
            there++;
        }
    }
    const uint64_t found = reference_decode(stream, size, &options, NULL, NULL).packets;
    TEST_ASSERT_TRUE(found >= there && found <= there + fate_count / 1000u);
    TEST_ASSERT_EQUAL_size_t(fate_count, wire.counts.packets);
    TEST_ASSERT_EQUAL_size_t(intact_packets(), wire.counts.intact_packets);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        TEST_ASSERT_UINT_WITHIN(1, heard.begun[kind], heard.ended[kind]);
        TEST_ASSERT_EQUAL_UINT(heard.begun[kind], wire.counts.faults[kind]);
    }
}

/* ---- Rows ---- */

static size_t absolute(size_t a, size_t b)
{
    return a > b ? a - b : b - a;
}

static unsigned ranges(void)
{
    unsigned sum = 0;
    for (size_t i = 0; i < packet_count; i++) {
        for (unsigned s = 0; s < packets[i].lsn; s++) {
            sum += reference_point(packets[i].bytes, s).distance_mm != 0u ? 1u : 0u;
        }
    }
    return sum;
}

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
    const size_t spoilt = fate_count - intact_packets();
    decode();
    const row_number_t facts[] = {
        {"bytes", (uint32_t)size},
        {"hz", sim_frequency_chz(&sim)},
        {"sleeps", sim_next_us(&sim) == SIM_NEVER},
        {"commands", sim.counts.commands},
        {"unknown", sim.counts.unknown_commands},
        {"forbidden", sim.counts.commands_while_scanning},
        {"in_tail", sim.counts.commands_in_tail},
        {"packets", (uint32_t)counts.packets},
        {"starts", (uint32_t)counts.start_packets},
        {"replies", (uint32_t)counts.replies},
        {"uncounted", (uint32_t)(absolute(counts.packets, sim.counts.packets) +
                                 absolute(counts.start_packets, sim.counts.start_packets) +
                                 absolute(counts.points, sim.counts.samples))},
        {"checksum_errors", (uint32_t)counts.checksum_errors},
        {"stray", (uint32_t)(size - counts.bytes_in_packets - counts.start_packets)},
        {"ranges", ranges()},
        {"turned",
         packet_count > 0 ? (uint32_t)(packets[packet_count - 1u].lsa - packets[0].fsa) : 0u},
        {"intact", (uint32_t)intact_packets()},
        {"spoilt", (uint32_t)spoilt},
        {"latest_intact", fate_count > 0 && fates[fate_count - 1u].packet.intact},
        {"untold", (uint32_t)absolute(sim.counts.packets, fate_count)},
        {"unexplained", (uint32_t)absolute(heard.ended[SIM_LINK_CUT], spoilt)},
        {"unaccounted", (uint32_t)absolute(size + heard.begun[SIM_LINK_DROP],
                                           wire.passed + heard.begun[SIM_LINK_INSERT])},
        {"new", (uint32_t)(size - marked)},
        {"faulty", sim_link_is_faulty(&wire)},
        {"last_fault", (uint32_t)sim_link_last_fault_us(&wire)},
    };
    return row_expects(word, facts) || is_count_of_faults(word, "begun.", heard.begun) ||
           is_count_of_faults(word, "ended.", heard.ended);
}

/* A setting of the lidar, or the mean gap of a fault of the wire; before anything else: powers up
 * again. */
static bool is_setting(const char *word)
{
    const row_member_t members[] = {
        {"frequency", MEMBER(config.frequency_chz)},
        {"latency", MEMBER(config.reply_latency_ms)},
        {"tail", MEMBER(config.stop_tail_ms)},
        {"fatal", MEMBER(config.fatal_health)},
        {"never_answers", MEMBER(config.never_answers)},
        {"blocked_sends_starts", MEMBER(config.blocked_sends_starts)},
        {"first_angle", MEMBER(config.first_angle_q6)},
        {"spin_percent", MEMBER(config.spin_up_percent)},
        {"wobble", MEMBER(config.wobble_permille)},
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

static void expect_end(void)
{
    TEST_ASSERT_EQUAL_size_t(taken, size);
    taken = 0;
    forget_stream();
}

static void expect_frequency(unsigned chz)
{
    char hex[30];
    (void)snprintf(hex, sizeof hex, "A55A0400000004%02X%02X0000", chz & 0xFF, chz >> 8);
    expect_bytes(hex);
    expect_end();
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

static void expect_mode(const char *name)
{
    TEST_ASSERT_EQUAL_STRING(name, sim_mode_name(sim_mode(&sim)));
}

static void run_into_a_packet(void)
{
    do {
        run_ms(1);
    } while (!wire.packet_open);
}

static void plan_trouble(const char *text)
{
    static const char *const events[] = {"command", "reply", "beginning", "start"};
    uint32_t ms;
    const sim_trouble_t trouble = sim_trouble_named(row_text(text), &ms);
    unkind((sim_event_t)number_of(text, events, 4), trouble, ms);
}

static void befall(const char *name)
{
    uint32_t ms;
    const sim_trouble_t trouble = sim_trouble_named(name, &ms);
    sim_befall(&sim, trouble, ms, now);
}

static void run_until_spoilt(void)
{
    do {
        run_ms(1);
    } while (spoil.count == 0);
}

static void send_raw(const char *hex)
{
    uint8_t bytes[ROW_WORD_MAX];
    sim_link_write(&wire, bytes, row_bytes(hex, bytes), now);
}

/* "stall:100" */
static void force(const char *text)
{
    const unsigned kind = kind_named(text);
    TEST_ASSERT_TRUE_MESSAGE(kind < SIM_LINK_KINDS, text);
    sim_link_force(&wire, (sim_link_kind_t)kind, row_number(text), now);
}

/* ">0D": a command; "<0DA5": bytes to the lidar; "+50": 50 ms pass; "=A55A": the next bytes, which
 * come within 10 ms; "end": no more come; "got:600": the reply that a frequency is set; "forget":
 * what came before no longer counts; "@idle": the mode; "at:64:2300": angle and range; "ct:3:40":
 * the CT byte of a packet in a turn; "spoil:command:late700", "befalls:no-scans": trouble; "fails":
 * power is lost so many microseconds later, and the wire does not know; "force:stall:100": a fault
 * of the wire; "calm"; "truth": what it has reported about each packet is true; settings and facts
 * above. */
static void tell(char *word)
{
    const uint32_t number = row_number(word);
    const char *const text = row_text(word);
    unsigned a, b;
    if (word[0] == '>') {
        send((uint8_t)strtoul(&word[1], NULL, 16));
    } else if (word[0] == '<') {
        send_raw(&word[1]);
    } else if (word[0] == '+') {
        run_ms((uint32_t)atoi(&word[1]));
    } else if (word[0] == '=') {
        expect_bytes(&word[1]);
    } else if (word[0] == '@') {
        expect_mode(&word[1]);
    } else if (sscanf(word, "at:%u:%u", &a, &b) == 2) {
        expect_range_at(a, b);
    } else if (sscanf(word, "ct:%u:%x", &a, &b) == 2) {
        decode();
        TEST_ASSERT_EQUAL_HEX8(b, packets[next_start(0) + a].ct);
    } else if (row_is(word, "spoil")) {
        plan_trouble(text);
    } else if (row_is(word, "befalls")) {
        befall(text);
    } else if (row_is(word, "end")) {
        expect_end();
    } else if (row_is(word, "forget")) {
        taken = 0;
        forget_stream();
        memset(&heard, 0, sizeof heard);
    } else if (row_is(word, "mark")) {
        marked = size;
    } else if (row_is(word, "inside")) {
        run_into_a_packet();
    } else if (row_is(word, "spoilt_once")) {
        run_until_spoilt();
    } else if (row_is(word, "lose")) {
        sim_lose_next_reply(&sim);
    } else if (row_is(word, "clear")) {
        sim_clear_obstacles(&sim);
    } else if (row_is(word, "got")) {
        expect_frequency(number);
    } else if (row_is(word, "us")) {
        run_until(number);
    } else if (row_is(word, "scan")) {
        scan_seconds(number);
    } else if (row_is(word, "delay")) {
        sim_delay_next_reply(&sim, number);
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
    } else if (row_is(word, "force")) {
        force(text);
    } else if (row_is(word, "calm")) {
        sim_link_calm(&wire, now);
    } else if (row_is(word, "truth")) {
        expect_the_truth_about_every_packet();
    } else {
        TEST_ASSERT_TRUE_MESSAGE(is_setting(word) || is_fact(word), word);
    }
}

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
        "delay:3000 >92 +1000 >0D +1990 bytes:0 +20 bytes:21 =A55A0300000006000000 "
        "=A55A0400000004 forget >0D got:600"),
    ROW(a_stream_waits_for_its_own_late_reply,
        "delay:3000 >92 +1000 >60 +2200 bytes:17 =A55A0300000006000000 =A55A0500004081 +1000 "
        "packets>50"),
    ROW(one_reply_can_be_lost, "lose >0D +100 bytes:0 >0D got:600"),
    ROW(a_lidar_that_never_answers_obeys,
        "never_answers:1 >0B +100 bytes:0 hz:700 scan:1 packets>90"),
    ROW(all_that_is_sent_is_counted, ">60 +5000 packets>400 uncounted:0"),
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
    ROW(a_lost_start_reply_does_not_stop_the_stream, "lose >60 +2000 replies:0 packets>100"),
    ROW(nothing_is_answered_during_a_reboot_and_the_frequency_is_reset,
        ">0B +10 >40 @booting forget +2490 >0D +100 bytes:0 @idle >0D got:600"),
    ROW(a_reboot_forgets_a_reply_that_is_due, ">90 >40 +5000 bytes:0"),
    ROW(losing_power_cuts_a_packet_in_the_middle,
        "scan:1 inside forget power:0 +5000 bytes:0 @off power:1 @booting +2500 @idle >0D got:600"),
    ROW(commands_wait_for_a_late_one_and_keep_their_order,
        "spoil:command:late700 >0B >0A +699 bytes:0 +20 bytes:22 =A55A0400000004BC020000 "
        "=A55A0400000004B2020000 end"),
    ROW(replies_wait_for_a_late_one, "spoil:reply:late700 >0B >0A +700 bytes:0 +20 bytes:22"),
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
    ROW(a_command_is_obeyed_and_answered,
        "spoil:command:sound >0B +100 bytes:11 +5000 >0D +1000 hz:700 bytes:22"),
    ROW(a_lost_command_is_not_obeyed,
        "spoil:command:lost >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_late_command_is_obeyed_later,
        "spoil:command:late1000 >0B +100 bytes:0 +5000 >0D +1000 hz:700 bytes:22"),
    ROW(a_doubled_command_is_obeyed_twice,
        "spoil:command:doubled >0B +100 bytes:22 +5000 >0D +1000 hz:800 bytes:33"),
    ROW(a_deaf_lidar_does_not_hear_the_command,
        "spoil:command:deaf1000 >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_silent_lidar_obeys_and_does_not_answer,
        "spoil:command:silent1000 >0B +100 bytes:0 +5000 >0D +1000 hz:700 bytes:11"),
    ROW(a_power_cut_at_a_command_forgets_it,
        "spoil:command:cut1000 >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_reboot_at_a_command_forgets_it,
        "spoil:command:reboots >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_lost_reply_does_not_come,
        "spoil:reply:lost >0B +100 bytes:0 +5000 >0D +1000 hz:700 bytes:11"),
    ROW(a_late_reply_comes_later,
        "spoil:reply:late1000 >0B +100 bytes:0 +5000 >0D +1000 hz:700 bytes:22"),
    ROW(a_doubled_reply_comes_twice,
        "spoil:reply:doubled >0B +100 bytes:22 +5000 >0D +1000 hz:700 bytes:33"),
    ROW(a_lidar_that_is_deaf_at_a_reply_sends_it,
        "spoil:reply:deaf1000 >0B +100 bytes:11 +5000 >0D +1000 hz:700 bytes:22"),
    ROW(a_lidar_that_is_silent_at_a_reply_does_not_send_it,
        "spoil:reply:silent1000 >0B +100 bytes:0 +5000 >0D +1000 hz:700 bytes:11"),
    ROW(a_power_cut_at_a_reply_forgets_the_step,
        "spoil:reply:cut1000 >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_reboot_at_a_reply_forgets_the_step,
        "spoil:reply:reboots >0B +100 bytes:0 +5000 >0D +1000 hz:600 bytes:11"),
    ROW(a_silent_stream_goes_on_afterwards,
        "spoil:start:silent800 >60 spoilt_once +30 forget +760 bytes:0 +1000 packets>90"),
    ROW(a_late_start_packet_delays_the_stream,
        "spoil:start:late800 >60 spoilt_once +30 forget +760 bytes:0 +1000 packets>90"),
};

void test_the_simulated_lidar(void)
{
    tell_rows(rows, tell);
}

/* ---- The stream ---- */

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
        TEST_ASSERT_TRUE(sim_link_read(&wire, now, chunk, sizeof chunk) <= 3);
    }
}

static uint8_t other[STREAM_MAX];

/* 5 s by a faultless wire in steps of 1 ms, and without it at once, in portions of this size. */
static void expect_the_same_bytes_by(size_t portion)
{
    static const uint8_t start[2] = {0xA5, 0x60};
    size_t other_size = 0;
    size_t more;
    send(0x60);
    run_ms(5000);
    sim_init(&sim, &config);
    sim_receive(&sim, start, 2, 0);
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

/* 500 ms are 50 packets; the line's queue holds 16. */
void test_frames_that_are_not_taken_in_time_are_lost_and_counted(void)
{
    static const uint8_t stop[2] = {0xA5, 0x65};
    scan_seconds(1);
    sim_receive(&sim, stop, 2, now + 500000);
    TEST_ASSERT_UINT_WITHIN(8, 50 + 3 - 16, sim_lost_frames(&sim));
}

/* ---- Marks ---- */

void test_no_two_marks_are_equal_and_none_is_a_data_fault(void)
{
    static bool seen[1u << 24];
    config.marked = true;
    power_up();
    scan_seconds(20);
    for (size_t at = 0; at < packet_count; at++) {
        for (unsigned i = 0; i < packets[at].lsn; i++) {
            const reference_point_t point = reference_point(packets[at].bytes, i);
            bool *const mark = &seen[(uint32_t)point.intensity << 16 | (uint32_t)point.flag << 14 |
                                     point.distance_mm];
            TEST_ASSERT_FALSE(*mark);
            *mark = true;
        }
    }
    TEST_ASSERT_TRUE(counts.points > 79000);
    TEST_ASSERT_EQUAL_HEX8(0, sim_health(&sim));
}

/* ---- The wire ---- */

/* 60 s are about 780,000 bytes and 6400 packets. */
static const row_t wires[] IN_FLASH = {
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
    ROW(a_packet_cut_without_the_wires_knowledge_is_reported_as_hit,
        ">60 +3000 inside fails:300 +100 latest_intact:0 truth"),
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
};

void test_the_wire(void)
{
    tell_rows(wires, tell);
}

/* Flips the first byte of a frame: LastCRC before a start packet, otherwise the header. */
void test_a_spoiled_last_crc_does_not_hit_the_start_packet(void)
{
    unsigned starts = 0;
    send(0x60);
    run_ms(3000);
    for (int i = 0; i < 200; i++) {
        while (wire.packet_open) {
            run_until(now + 20u);
        }
        const size_t before = fate_count;
        sim_link_force(&wire, SIM_LINK_FLIP, 0, now);
        while (fate_count == before) {
            run_until(now + 20u);
        }
        TEST_ASSERT_EQUAL(fates[before].packet.sent.starts_revolution, fates[before].packet.intact);
        starts += fates[before].packet.intact ? 1u : 0u;
    }
    TEST_ASSERT_TRUE(starts > 5);
}

void test_the_same_seed_gives_the_same_faults_whatever_the_steps(void)
{
    wire_config.mean_gap[SIM_LINK_DROP] = 1000;
    wire_config.mean_gap[SIM_LINK_STALL] = 500;
    wire_config.mean_gap[SIM_LINK_GARBLE] = 3000;
    power_up();
    send(0x60);
    run_ms(10000);
    memcpy(other, stream, size);
    const size_t other_size = size;
    power_up();
    send(0x60);
    run_until(10 * SECOND);
    TEST_ASSERT_TRUE(size > 100000);
    TEST_ASSERT_EQUAL_size_t(other_size, size);
    TEST_ASSERT_EQUAL_MEMORY(other, stream, size);
}

void test_the_next_event_is_never_later_than_the_next_byte(void)
{
    wire_config.mean_gap[SIM_LINK_STALL] = 200;
    power_up();
    send(0x60);
    run_ms(3000);
    for (int i = 0; i < 20000; i++) {
        const uint64_t next = sim_link_next_us(&wire);
        if (next > now + 1u) {
            TEST_ASSERT_EQUAL_size_t(0, sim_link_read(&wire, next - 1u, stream, 100));
        }
        now = next > now ? next : now + 1u;
        sim_link_read(&wire, now, stream, 100);
    }
}
