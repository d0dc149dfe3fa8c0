/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tale.h"

#include "invariants.h"
#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *word;
    int value;
} entry_t;

static const entry_t events[] = {
    {"NONE", TMINI_EVENT_NONE},
    {"STARTED", TMINI_EVENT_STARTED},
    {"STOPPED", TMINI_EVENT_STOPPED},
    {"INFO", TMINI_EVENT_INFO},
    {"HEALTH", TMINI_EVENT_HEALTH},
    {"FREQUENCY", TMINI_EVENT_FREQUENCY},
    {"REBOOTED", TMINI_EVENT_REBOOTED},
    {"FAILED", TMINI_EVENT_COMMAND_FAILED},
    {"UNWANTED", TMINI_EVENT_UNWANTED_SCANNING},
    {"RECOVERED", TMINI_EVENT_RECOVERED},
    {"FAULTS", TMINI_EVENT_FAULTS_CHANGED},
    {"PACKET", TMINI_EVENT_PACKET},
    {"SCAN", TMINI_EVENT_SCAN},
    {"PAUSED", TMINI_EVENT_PAUSED},
    {"LOST", TMINI_EVENT_LOST},
    {"MORE", TMINI_EVENT_MORE},
    {NULL, 0},
};

static const entry_t states[] = {
    {"UNKNOWN", TMINI_STATE_UNKNOWN},
    {"IDLE", TMINI_STATE_IDLE},
    {"BUSY", TMINI_STATE_BUSY},
    {"STOPPING", TMINI_STATE_STOPPING},
    {"STARTING", TMINI_STATE_STARTING},
    {"SCANNING", TMINI_STATE_SCANNING},
    {"RECOVERING", TMINI_STATE_RECOVERING},
    {NULL, 0},
};

static const entry_t errors[] = {
    {"OK", TMINI_OK},
    {"ARGUMENT", TMINI_ERROR_ARGUMENT},
    {"STATE", TMINI_ERROR_STATE},
    {"TIMEOUT", TMINI_ERROR_TIMEOUT},
    {"WRITE", TMINI_ERROR_WRITE},
    {"REPLY", TMINI_ERROR_REPLY},
    {"ABORTED", TMINI_ERROR_ABORTED},
    {"LISTEN_ONLY", TMINI_ERROR_LISTEN_ONLY},
    {NULL, 0},
};

static const tale_phrase_t phrases[] = {
    {"off", "recovery:1"},
    {"listen", "listening:1"},
    {"dma", "by-dma:1"},
    {"idle", "stop >65 +50 !STOPPED @IDLE"},
    {"starts", "idle start >0D <600 >60"},
    {"scans", "starts <scan <S !STARTED @SCANNING"},
    {"scans-at-10", "wish:1000 idle start >0D <1000 !FREQUENCY >60 <scan <S !STARTED @SCANNING"},
    {"lost", "scans turns:2:60 +1000 !LOST @RECOVERING"},
    {"starts-again", ">65 +50 >0D <600 >60"},
    {"packets", "no-points points:0"},
    {"small", "samples:39"},
    {NULL, NULL},
};

static struct {
    UNITY_LINE_TYPE line;
    char word[ROW_WORD_MAX]; /* The one being told. */
    bool is_set_up;
    bool scans_are_told;
    uint32_t events;
} tale;

static void fail(const char *why)
{
    char message[ROW_WORD_MAX + 40];
    (void)snprintf(message, sizeof message, "%s: %s", tale.word, why);
    UNITY_TEST_FAIL(tale.line, message);
}

static void expect_equal(int expected, int actual, const char *what)
{
    char message[ROW_WORD_MAX + 40];
    (void)snprintf(message, sizeof message, "%s: %s", tale.word, what);
    UNITY_TEST_ASSERT_EQUAL_INT(expected, actual, tale.line, message);
}

static int value_of(const entry_t *entries, const char *word)
{
    for (; entries->word != NULL; entries++) {
        if (strcmp(entries->word, word) == 0) {
            return entries->value;
        }
    }
    fail("no such word");
    return 0;
}

const tale_phrase_t *tale_phrases;
tale_words_t tale_words;
void (*tale_wait)(void *context);

void tale_expect_status(const char *wanted, int status)
{
    expect_equal(wanted != NULL ? value_of(errors, wanted) : TMINI_OK, status, "status");
}

/* ---- The port ---- */

static uint8_t next_byte(void)
{
    const uint8_t byte = rig.sent[0];
    if (rig.sent_count == 0) {
        fail("nothing was sent");
    }
    rig.sent_count--;
    memmove(rig.sent, rig.sent + 1, rig.sent_count);
    return byte;
}

static int poll_once(void)
{
    const tmini_event_t event = tmini_poll(&rig.lidar);
    UNITY_TEST_ASSERT(lidar_is_sound(&rig.lidar), tale.line, tale.word);
    tale.events += event != TMINI_EVENT_NONE ? 1u : 0u;
    return (int)event;
}

static void poll_to(tmini_event_t expected)
{
    tmini_event_t event = (tmini_event_t)poll_once();
    char message[ROW_WORD_MAX + 40];
    while (!tale.scans_are_told && event == TMINI_EVENT_SCAN && expected != TMINI_EVENT_SCAN) {
        event = (tmini_event_t)poll_once();
    }
    (void)snprintf(message, sizeof message, "%s: came \"%s\"", tale.word, tmini_event_name(event));
    UNITY_TEST_ASSERT_EQUAL_INT(expected, event, tale.line, message);
}

static void expect_nothing_sent(void)
{
    expect_equal(0, (int)rig.sent_count, "sent, and not told");
}

static void expect_sent(const char *word)
{
    const bool is_rest = word[0] == '!';
    const int code = (int)strtol(word + (is_rest ? 1 : 0), NULL, 16);
    if (rig.sent_count == 0) {
        poll_to(TMINI_EVENT_NONE);
    }
    if (!is_rest && code != 0xA5) {
        expect_equal(0xA5, next_byte(), "the first byte");
    }
    expect_equal(code, next_byte(), "the command");
}

/* ---- Time ---- */

static void pass(uint32_t ms)
{
    const uint32_t from_ms = rig.now_ms;
    const uint32_t steps[] = {0, ms / 2, ms - 1};
    for (size_t i = 0; i < 3; i++) {
        rig.now_ms = from_ms + steps[i];
        poll_to(TMINI_EVENT_NONE);
        expect_nothing_sent();
    }
    rig.now_ms = from_ms + ms;
}

/* ---- Bytes from the lidar ---- */

static void feed_turn(unsigned dhz)
{
    rig.now_ms += 160;
    rig_feed_packet((uint8_t)(dhz << 1 | 1u), 1, 1000);
    for (unsigned i = 1; i < 5; i++) {
        rig_feed_point_packet(1000);
    }
}

/* Scans come with the turns, and are not told. */
static void feed_turns(const char *word)
{
    char *rest;
    unsigned turns = (unsigned)strtol(word, &rest, 10);
    for (const unsigned dhz = (unsigned)atoi(rest + 1); turns > 0; turns--) {
        int event;
        feed_turn(dhz);
        while ((event = poll_once()) != TMINI_EVENT_NONE) {
            expect_equal(TMINI_EVENT_SCAN, event, "a scan");
        }
        expect_nothing_sent();
    }
}

static void drain(void)
{
    while (poll_once() != TMINI_EVENT_NONE) {
    }
}

/* That many samples in point packets of 40, each polled. */
static void feed_samples(unsigned count, uint16_t distance_mm)
{
    for (unsigned size; count > 0; count -= size) {
        size = count < 40 ? count : 40;
        rig_feed_packet(0, (uint8_t)size, distance_mm);
        drain();
    }
}

static void feed_zeros(unsigned count)
{
    static const uint8_t zeros[RIG_RX_SIZE] = {0};
    rig_feed(zeros, count);
}

/* Three packets, at once. */
static void feed_small_turn(uint16_t start_distance_mm)
{
    rig_feed_start_packet(start_distance_mm);
    rig_feed_point_packet(1000);
    rig_feed_point_packet(1001);
}

static void feed_plain_turn(uint16_t distance_mm)
{
    rig.now_ms += 160;
    rig_feed_plain_turn(distance_mm);
}

static void feed_ct_turn(uint8_t faults, uint16_t distance_mm)
{
    rig.now_ms += 160;
    rig_feed_turn(faults, distance_mm);
}

void tale_feed(const char *word)
{
    const char *const at = strchr(word, ':');
    const unsigned number = at != NULL ? (unsigned)strtol(at + 1, NULL, 0) : 0;
    uint8_t bytes[ROW_WORD_MAX / 2];
    if (word[0] >= '0' && word[0] <= '9') {
        rig_feed_frequency((uint32_t)atol(word));
    } else if (row_is(word, "info")) {
        rig_feed_info();
    } else if (row_is(word, "health")) {
        rig_feed_health((uint8_t)number, 0x1234);
    } else if (row_is(word, "scan")) {
        rig_feed_scan_reply();
    } else if (row_is(word, "P") || row_is(word, "PZ")) {
        rig_feed_packet(0, at != NULL ? (uint8_t)number : 4, word[1] == 'Z' ? 0 : 1000);
    } else if (row_is(word, "S") || row_is(word, "SZ")) {
        rig_feed_start_packet(word[1] == 'Z' ? 0 : 1000);
    } else if (row_is(word, "junk")) {
        rig_feed_byte(0x11);
    } else if (row_is(word, "crc")) {
        rig_feed_byte(rig.crc);
    } else if (row_is(word, "x")) {
        rig_feed(bytes, row_bytes(at + 1, bytes));
    } else if (row_is(word, "zeros")) {
        feed_zeros(number);
    } else if (row_is(word, "turn")) {
        feed_turn(number);
    } else if (row_is(word, "small")) {
        feed_small_turn((uint16_t)number);
    } else if (row_is(word, "plain") || row_is(word, "blind")) {
        feed_plain_turn(word[0] == 'p' ? 1000 : 0);
    } else if (row_is(word, "ct") || row_is(word, "blind-ct")) {
        feed_ct_turn((uint8_t)number, word[0] == 'c' ? 1000 : 0);
    } else if (row_is(word, "ranges") || row_is(word, "blinds")) {
        feed_samples(number, word[0] == 'r' ? 1000 : 0);
    } else {
        fail("what is this?");
    }
}

/* ---- Calls ---- */

static bool call(const char *word, int *status)
{
    const char *const at = strchr(word, ':');
    if (strcmp(word, "start") == 0) {
        *status = tmini_start(&rig.lidar);
    } else if (strcmp(word, "stop") == 0) {
        *status = tmini_stop(&rig.lidar);
    } else if (strcmp(word, "info") == 0) {
        *status = tmini_request_info(&rig.lidar);
    } else if (strcmp(word, "health") == 0) {
        *status = tmini_request_health(&rig.lidar);
    } else if (strcmp(word, "frequency") == 0) {
        *status = tmini_request_frequency(&rig.lidar);
    } else if (strcmp(word, "reboot") == 0) {
        *status = tmini_reboot(&rig.lidar);
    } else if (strncmp(word, "set:", 4) == 0) {
        *status = tmini_set_frequency(&rig.lidar, (uint16_t)atoi(at + 1));
    } else {
        return false;
    }
    UNITY_TEST_ASSERT(lidar_is_sound(&rig.lidar), tale.line, word);
    return true;
}

/* A word before the set-up gives a member of the configuration its number, or 0. */
static bool configure(const char *word)
{
    const row_member_t members[] = {
        {"wish", MEMBER(rig.config.frequency_chz)},
        {"recovery", MEMBER(rig.config.recovery)},
        {"listening", MEMBER(rig.config.listen_only)},
        {"no-port", MEMBER(rig.config.port)},
        {"no-write", MEMBER(rig.port.write)},
        {"no-restart", MEMBER(rig.port.restart)},
        {"no-clock", MEMBER(rig.port.now_ms)},
        {"no-rx", MEMBER(rig.config.rx_buffer)},
        {"rx", MEMBER(rig.config.rx_size)},
        {"by-dma", MEMBER(rig.config.rx_dma)},
        {"samples", MEMBER(rig.config.max_samples)},
        {"no-points", MEMBER(rig.config.points)},
        {"points", MEMBER(rig.config.max_points)},
        {"filter", MEMBER(rig.config.filter)},
        {"backoff", MEMBER(rig.timing.back_off_max_ms)},
        {"attempts", MEMBER(rig.timing.max_attempts)},
        {"quiet", MEMBER(rig.timing.quiet_line_ms)},
        {"reply", MEMBER(rig.timing.reply_timeout_ms)},
        {"frame", MEMBER(rig.timing.frame_timeout_ms)},
        {"pause", MEMBER(rig.timing.max_pause_ms)},
    };
    return row_stores(word, members);
}

void tale_set_up(void)
{
    if (tale.is_set_up) {
        return;
    }
    rig_init();
    tale.is_set_up = true;
}

static void tell_call(char *word)
{
    char *const wanted = strchr(word, '=');
    int status = TMINI_OK;
    if (wanted != NULL) {
        *wanted = '\0';
    }
    if (!tale.is_set_up && configure(word)) {
        return;
    }
    tale_set_up();
    if (!call(word, &status)) {
        fail("what is this?");
    }
    tale_expect_status(wanted != NULL ? wanted + 1 : NULL, status);
}

/* Later commands are refused too, which is reported once. */
static void expect_refusal(void)
{
    expect_equal(TMINI_ERROR_ARGUMENT, tmini_init(&rig.lidar, &rig.config), "the set-up");
    tale.is_set_up = true;
    tale_tell("start=ARGUMENT stop=ARGUMENT !FAILED ?ARGUMENT !NONE @UNKNOWN");
}

/* ---- What has been counted ---- */

static bool expect_number(const char *word)
{
    tmini_counters_t counters;
    tmini_ct_info_t unit;
    tmini_point_t first = {0};
    const tmini_scan_t *const scan = tmini_scan(&rig.lidar);
    const tmini_packet_t *const packet = tmini_packet(&rig.lidar);
    tmini_counters(&rig.lidar, &counters);
    tmini_ct_info(&rig.lidar, &unit);
    (void)(packet->frame != NULL && tmini_packet_point(packet, 0, &first));
    const row_number_t numbers[] = {
        {"next", tmini_next_poll_ms(&rig.lidar)},
        {"age", tmini_scan_age_ms(&rig.lidar)},
        {"faults", tmini_faults(&rig.lidar)},
        {"events", tale.events},
        {"port-restarts", rig.port_restarts},
        {"packets", counters.packets},
        {"in-packets", counters.bytes_in_packets},
        {"in-replies", counters.bytes_in_replies},
        {"skipped", counters.bytes_skipped},
        {"pending", counters.bytes_pending},
        {"overrun", counters.bytes_overrun},
        {"scans", counters.scans},
        {"late", counters.late_scans},
        {"withheld", counters.points_withheld},
        {"timeouts", counters.timeouts},
        {"losses", counters.losses},
        {"recoveries", counters.recoveries},
        {"restarts", counters.restarts},
        {"reboots", counters.reboots},
        {"known", unit.known},
        {"user", unit.user_major},
        {"unit-faults", unit.faults},
        {"health-faults", tmini_health(&rig.lidar)->faults},
        {"health-code", tmini_health(&rig.lidar)->error_code},
        {"gap", packet->gap},
        {"count", scan->count},
        {"first-mm", rig.points[0].distance_mm},
        {"gaps", scan->gaps},
        {"dropped", scan->dropped},
        {"complete", scan->complete},
        {"start-ms", scan->start_ms},
        {"end-ms", scan->end_ms},
        {"chz", scan->frequency_chz},
        {"scan-packets", scan->packets},
        {"second-mm", rig.points[1].distance_mm},
        {"third-mm", rig.points[2].distance_mm},
        {"errors", counters.checksum_errors},
        {"is-start", tmini_packet_is_start(packet)},
        {"packet-count", packet->count},
        {"packet-mm", first.distance_mm},
    };
    return row_expects(word, numbers);
}

/* ---- Words ---- */

static bool tell_phrase(const tale_phrase_t *phrases, const char *word)
{
    for (; phrases != NULL && phrases->word != NULL; phrases++) {
        if (strcmp(word, phrases->word) == 0) {
            tale_tell(phrases->tale);
            return true;
        }
    }
    return false;
}

/* Words for the test's own means. */
static bool tell_means(const char *word)
{
    const uint32_t number = row_number(word);
    if (strcmp(word, "/") == 0) {
        tale_begin();
    } else if (strcmp(word, "refused") == 0) {
        expect_refusal();
    } else if (strcmp(word, "no-scans") == 0) {
        tale.scans_are_told = false;
    } else if (strcmp(word, "drain") == 0) {
        drain();
    } else if (strcmp(word, "bad-crc") == 0) {
        rig.crc ^= 1u;
    } else if (row_is(word, "held")) {
        tmini_feed_held(&rig.lidar, number);
    } else if (row_is(word, "takes")) {
        rig.takes = (int)number;
    } else if (row_is(word, "turns")) {
        feed_turns(row_text(word));
    } else if (row_is(word, "clock")) {
        rig.now_ms = number;
    } else if (row_is(word, "back")) {
        rig.now_ms -= number;
    } else if (row_is(word, "completed")) {
        rig.lidar.complete_ms = rig.now_ms - number;
    } else {
        return false;
    }
    return true;
}

static void tell_sign(const char *word)
{
    const char *const rest = word + 1;
    tale_set_up();
    if (word[0] == '>') {
        expect_sent(rest);
    } else if (word[0] == '<') {
        tale_feed(rest);
    } else if (word[0] == '+') {
        pass((uint32_t)atol(rest));
    } else if (word[0] == '~') {
        rig.now_ms += (uint32_t)atol(rest);
    } else if (word[0] == '!') {
        expect_nothing_sent();
        poll_to((tmini_event_t)value_of(events, rest));
    } else if (word[0] == '@') {
        expect_equal(value_of(states, rest), tmini_state(&rig.lidar), "state");
    } else if (word[0] == '#') {
        expect_equal(atoi(rest), tmini_frequency_chz(&rig.lidar), "frequency");
    } else {
        expect_equal(value_of(errors, rest), tmini_command_error(&rig.lidar), "error");
    }
}

static void tell_word(char *word)
{
    memcpy(tale.word, word, strlen(word) + 1);
    if (strchr("><+~!@#?", word[0]) != NULL) {
        tell_sign(word);
    } else if (tell_phrase(phrases, word) || tell_phrase(tale_phrases, word) || tell_means(word) ||
               (tale_words != NULL && tale_words(word))) {
        return;
    } else if (!tale.is_set_up || !expect_number(word)) {
        tell_call(word);
    }
}

void tale_tell(const char *text)
{
    row_tell(text, tell_word);
}

void tale_end(void)
{
    const bool is_told = tale.is_set_up;
    tale.is_set_up = false;
    if (is_told) {
        memcpy(tale.word, "end", 4);
        expect_nothing_sent();
        poll_to(TMINI_EVENT_NONE);
        expect_nothing_sent();
    }
}

void tale_begin(void)
{
    const UNITY_LINE_TYPE line = tale.line;
    tale_end();
    memset(&tale, 0, sizeof tale);
    tale.line = line;
    tale.scans_are_told = true;
    rig_open();
    rig.port.wait = tale_wait;
}

void tale_tell_row(const row_t *row)
{
    tale.is_set_up = false; /* If the row before has failed, its tale does not go on. */
    tale_begin();
    tale.line = row->line;
    tale_tell(row->steps);
    tale_end();
}
