/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The driver as a whole: set-up, feeding, events and results, the clock, and wrong use. Tales
 * (tale.h), which here know these words as well:
 *
 *     at:2:health     while the clock is read for the second time from now on, this comes
 *     reads:2         the next poll reads the clock twice, and returns no event
 *     runs            from now on, the clock goes on by 5 ms each time it is read */

#include "tale.h"

#include <stdlib.h>
#include <string.h>

/* ---- Clocks ---- */

static unsigned readings;
static unsigned chosen;  /* The reading at which bytes come. */
static char coming[24];  /* In words. */
static uint32_t slow_ms; /* What a reading takes. */

static uint32_t slow_clock(void *context)
{
    (void)context;
    readings++;
    rig.now_ms += slow_ms;
    if (readings == chosen) {
        tale_feed(coming);
    }
    return rig.now_ms;
}

static void use_slow_clock(void)
{
    rig.port.now_ms = slow_clock;
    readings = 0;
    chosen = 0;
    slow_ms = 0;
}

static bool tell(char *word)
{
    if (row_is(word, "at")) {
        use_slow_clock();
        chosen = row_number(word);
        strcpy(coming, row_text(row_text(word)));
    } else if (row_is(word, "runs")) {
        use_slow_clock();
        slow_ms = 5;
    } else if (row_is(word, "reads")) {
        use_slow_clock();
        TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&rig.lidar));
        TEST_ASSERT_EQUAL_UINT(row_number(word), readings);
    } else {
        return false;
    }
    return true;
}

void setUp(void)
{
    tale_words = tell;
    tale_begin();
}

void tearDown(void)
{
    tale_end();
}

#define SCANS "starts <scan <P !STARTED "
#define HALF_HEALTH "x:A55A030000"
#define LATER_HALF "<x:0006000000 "

static const row_t tales[] IN_FLASH = {
    /* ---- A poll reads the clock to check for work and, at the latest every 10 ms, to examine the
     * line. According to the clock, the line has been silent for the frame timeout. ---- */
    ROW(bytes_that_come_while_a_poll_looks_for_work_are_not_given_up,
        "idle health >92 +100 ~10 at:1:" HALF_HEALTH " !NONE " LATER_HALF "!HEALTH"),
    ROW(bytes_that_come_while_a_poll_examines_the_line_are_not_given_up,
        "idle health >92 +100 ~10 at:2:" HALF_HEALTH " !NONE " LATER_HALF "!HEALTH"),
    ROW(a_reply_that_comes_while_the_clock_is_read_leaves_the_lidar_idle, /* It is no new byte. */
        "idle health >92 !NONE ~10 at:2:health !HEALTH ~1 !NONE @IDLE"),
    ROW(bytes_that_complete_nothing_are_looked_at_every_10_ms,
        "scans <x:AA550028 !NONE 2( <x:01 ~9 reads:1 ~1 reads:2 )"),
    ROW(a_line_on_which_bytes_come_while_a_poll_looks_for_work_is_not_quiet,
        "stop >65 +49 ~10 at:1:" HALF_HEALTH " !NONE @STOPPING +50 !STOPPED"),
    ROW(a_line_on_which_bytes_come_while_a_poll_examines_it_is_not_quiet, /* The next notices. */
        "stop >65 +49 ~10 at:2:" HALF_HEALTH " !NONE @STOPPING ~1 +50 !STOPPED"),
    ROW(a_byte_that_comes_in_time_keeps_the_candidate,
        "<x:AA +99 <x:55 +99 <x:75 +99 <x:01 +99 <x:3F +99 <x:00 +99 <x:3F +99 <x:00 +99 <x:9E "
        "+99 <x:56 +99 <x:15 +99 <x:54 +99 packets:0 <x:02 +99 packets:1"),
    ROW(a_packet_that_comes_while_the_clock_is_read_has_the_time_of_that_reading,
        SCANS "<small:700 !NONE clock:5166 at:2:S !SCAN end-ms:5166"),
    ROW(a_packet_has_the_time_of_the_poll_however_long_that_takes, /* The second reading. */
        SCANS "<small:700 !NONE clock:5166 <S runs !SCAN end-ms:5176"),
    /* ---- Scans ---- */
    ROW(a_scan_is_delivered_with_the_start_packet_that_follows_it, /* 44 bytes take 3 ms. */
        SCANS "clock:70000 <small:700 !NONE clock:70166 <small:800 !SCAN count:9 scan-packets:3 "
              "chz:600 start-ms:69997 end-ms:70163 gaps:0 first-mm:700 second-mm:1000 scans:1"),
    ROW(a_scan_is_valid_until_the_next_poll_whatever_is_fed,
        SCANS "<small:700 <small:800 !SCAN <small:900 count:9 first-mm:700 !SCAN count:9 "
              "first-mm:800"),
    ROW(the_packet_that_ended_a_scan_keeps_its_time_however_late_the_next_poll,
        SCANS "<small:700 !NONE clock:7000 <small:800 !SCAN clock:7077 !NONE <small:900 !SCAN "
              "start-ms:6997"),
    ROW(the_filter_of_the_configuration_is_applied, /* Of 1000 mm, flag 2; 2000 mm, flag 3. */
        "filter:4 " SCANS "<S <x:AA550002010541050B4732A20F <x:32431F <S !SCAN second-mm:0 "
        "third-mm:2000"),
    /* ---- Streaming ---- */
    ROW(single_bytes_blocks_and_dma_bring_the_same_packet,
        "packets starts <x:AA5575013F003F009E56155402 !STARTED !PACKET packet-mm:149 / packets "
        "starts <x:AA <x:55 <x:75 <x:01 <x:3F <x:00 <x:3F <x:00 <x:9E <x:56 <x:15 <x:54 <x:02 "
        "!STARTED !PACKET packet-mm:149 / packets small dma starts <x:AA5575013F003F009E56155402 "
        "!STARTED !PACKET packet-mm:149"),
    ROW(streaming_brings_an_event_for_each_packet_and_none_for_scans,
        "packets starts 2( <small:700 ) !STARTED !PACKET is-start:1 !PACKET is-start:0 "
        "packet-count:4 4( !PACKET ) !NONE scans:0"),
    ROW(a_streamed_packet_is_valid_until_the_next_poll_though_its_event_came_second,
        "packets starts <S <P:2 !STARTED !PACKET packet-count:1 packet-mm:1000 !PACKET "
        "packet-count:2 packet-mm:1000"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}

/* ---- Setting up, and wrong use ---- */

/* As docs/design.md says. */
void test_the_default_timing(void)
{
    TEST_ASSERT_EQUAL_UINT16(100, tmini_timing_default.frame_timeout_ms);
    TEST_ASSERT_EQUAL_UINT16(30, tmini_timing_default.max_pause_ms);
    TEST_ASSERT_EQUAL_UINT16(50, tmini_timing_default.quiet_line_ms);
    TEST_ASSERT_EQUAL_UINT16(2000, tmini_timing_default.reply_timeout_ms);
    TEST_ASSERT_EQUAL_UINT16(2000, tmini_timing_default.back_off_max_ms);
    TEST_ASSERT_EQUAL_UINT8(3, tmini_timing_default.max_attempts);
}

static tmini_t untouched;

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
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(lidar));
    TEST_ASSERT_EQUAL_UINT32(0, tmini_next_poll_ms(lidar));
}

void test_a_null_pointer_and_a_lidar_never_set_up_refuse_every_command(void)
{
    refuses_all_commands(NULL);
    refuses_all_commands(&untouched);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(NULL, &rig.config));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_decoder_init(NULL, &rig.lidar.ring, 0));
}

void test_a_lidar_never_set_up_counts_bytes_as_refused_and_has_empty_results(void)
{
    const uint8_t bytes[4] = {1, 2, 3, 4};
    size_t size = 1;
    tmini_counters_t seen;
    tmini_ct_info_t turn;
    untouched = (tmini_t){0};
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

static void is_refused(const tmini_config_t *config)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(&rig.lidar, config));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_start(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_COMMAND_FAILED, tmini_poll(&rig.lidar));
    tmini_feed_byte(&rig.lidar, 1);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed(&rig.lidar, (const uint8_t *)"12", 2));
}

void test_a_lidar_that_was_refused_stores_nothing(void)
{
    is_refused(NULL);
    rig.config.spare_points = rig.config.points; /* One buffer for two scans. */
    is_refused(&rig.config);
    rig.config.spare_points = NULL;
    if (SIZE_MAX > 65535u) { /* More points than can be counted. */
        rig.config.max_points = (size_t)65535u + 1;
        is_refused(&rig.config);
        rig.config.max_points = (size_t)65535u + 2; /* In 16 bits it would be 1. */
        is_refused(&rig.config);
    }
}

void test_setting_up_again_clears_everything(void)
{
    tale_tell("lost >65");
    rig_init();
    tale_tell("@UNKNOWN losses:0 packets:0 +60000");
}

/* ---- Feeding ---- */

void test_a_port_that_restarts_dma_finds_buffer_and_position_and_no_other_does(void)
{
    size_t size = 1;
    TEST_ASSERT_NULL(tmini_rx_buffer(&rig.lidar, &size));
    TEST_ASSERT_EQUAL_size_t(0, size);
    tale_tell("dma small");
    tale_set_up();
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

/* Bytes are not read before a poll, so the memory need not exist. */
void test_pending_bytes_may_be_more_than_16_bits_count(void)
{
    if (SIZE_MAX > 65535u) {
        tmini_counters_t seen;
        rig.config.rx_size = (size_t)0x10000u * 4;
        rig.config.rx_dma = true;
        rig_init();
        tmini_feed_dma(&rig.lidar, (size_t)0x10000u + 300);
        tmini_counters(&rig.lidar, &seen);
        TEST_ASSERT_EQUAL_UINT32(65836u, seen.bytes_pending);
    }
}

/* ---- Results ---- */

/* As after weeks: each counter has a different value near the end of its range. */
void test_counters_count_to_the_end_of_their_ranges(void)
{
    tmini_t *const lidar = &rig.lidar;
    tmini_parser_counters_t *const parser = &lidar->decoder.parser.counters;
    tmini_counters_t seen;
    const struct {
        uint32_t *counter;
        const uint32_t *seen;
    } wide[] = {
        {&parser->packets, &seen.packets},
        {&parser->checksum_errors, &seen.checksum_errors},
        {&parser->bytes_in_packets, &seen.bytes_in_packets},
        {&parser->bytes_in_replies, &seen.bytes_in_replies},
        {&parser->bytes_skipped, &seen.bytes_skipped},
        {&parser->bytes_overrun, &seen.bytes_overrun},
        {&lidar->scans, &seen.scans},
        {&lidar->decoder.builder.late_scans, &seen.late_scans},
    };
    const struct {
        uint16_t *counter;
        const uint16_t *seen;
    } narrow[] = {
        {&lidar->command.timeouts, &seen.timeouts},
        {&lidar->recovery.losses, &seen.losses},
        {&lidar->recovery.recoveries, &seen.recoveries},
        {&lidar->recovery.restarts, &seen.restarts},
        {&lidar->recovery.reboots, &seen.reboots},
    };
    for (unsigned i = 0; i < 8; i++) {
        *wide[i].counter = 4294967280u + i;
    }
    for (unsigned i = 0; i < 5; i++) {
        *narrow[i].counter = (uint16_t)(65530u + i);
    }
    tmini_counters(lidar, &seen);
    for (unsigned i = 0; i < 8; i++) {
        TEST_ASSERT_EQUAL_UINT32(4294967280u + i, *wide[i].seen);
    }
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT16(65530u + i, *narrow[i].seen);
    }
}

/* Seven events end a command: STARTED (bit 1) to COMMAND_FAILED (bit 7). The other six, up to SCAN
 * (bit 13), stay. */
void test_a_question_drops_its_own_last_end_and_a_failure_and_nothing_else(void)
{
    tale_tell("idle");
    rig.lidar.pending = 0x7FFE;
    tale_tell("info");
    TEST_ASSERT_EQUAL_HEX16(0x7F76, rig.lidar.pending);
    rig.lidar.pending = 0;
    tale_tell(">90");
}

void test_events_are_returned_in_their_order(void)
{
    rig.lidar.pending = 0x7FFE;
    for (int event = TMINI_EVENT_STARTED; event <= TMINI_EVENT_LOST; event++) {
        TEST_ASSERT_EQUAL_INT(event, tmini_poll(&rig.lidar));
    }
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&rig.lidar));
}

/* ---- Several lidars ---- */

static tmini_t lidars[3];
static uint8_t sent[3]; /* The code of each lidar's last command. */

static int note_command(void *context, const uint8_t *bytes, size_t count)
{
    *(uint8_t *)context = bytes[count - 1];
    return (int)count;
}

static uint32_t clock_of_all(void *context)
{
    (void)context;
    return rig.now_ms;
}

static void poll_all(tmini_event_t first, uint8_t a, uint8_t b, uint8_t c)
{
    const uint8_t commands[3] = {a, b, c};
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(i == 0 ? first : TMINI_EVENT_NONE, tmini_poll(&lidars[i]));
        TEST_ASSERT_EQUAL_HEX8(commands[i], sent[i]);
        sent[i] = 0;
    }
}

void test_three_lidars_at_once_do_not_affect_each_other(void)
{
    static uint8_t rx[3][RIG_RX_SIZE];
    static const tmini_port_t port = {.write = note_command, .now_ms = clock_of_all};
    uint8_t reply[ENCODE_REPLY_MAX];
    rig.config.port = &port;
    for (unsigned i = 0; i < 3; i++) {
        rig.config.rx_buffer = rx[i];
        rig.config.port_context = &sent[i];
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidars[i], &rig.config));
    }
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidars[0]));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidars[1]));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&lidars[2]));
    poll_all(TMINI_EVENT_NONE, 0x65, 0x65, 0x65);
    rig.now_ms += 50;
    poll_all(TMINI_EVENT_STOPPED, 0, 0x0D, 0x90);
    tmini_feed(&lidars[1], reply, encode_frequency_reply(reply, 600));
    poll_all(TMINI_EVENT_NONE, 0, 0x60, 0);
    tmini_feed(&lidars[1], reply, encode_scan_reply(reply));
    tmini_feed(&lidars[2], reply, encode_health_reply(reply, 0, 0)); /* Not the awaited reply. */
    poll_all(TMINI_EVENT_NONE, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_IDLE, tmini_state(&lidars[0]));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_STARTING, tmini_state(&lidars[1]));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_BUSY, tmini_state(&lidars[2]));
}
