/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tale.h"

#include "invariants.h"
#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX 32
#define SENT_MAX 16

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

static struct {
    UNITY_LINE_TYPE line;
    char word[WORD_MAX]; /* The one being told. */
    uint8_t sent[SENT_MAX];
    unsigned sent_count;
    int takes;
    bool is_set_up;
} tale;

static void fail(const char *why)
{
    char message[100];
    (void)snprintf(message, sizeof message, "%s: %s", tale.word, why);
    UNITY_TEST_FAIL(tale.line, message);
}

static void expect_equal(int expected, int actual, const char *what)
{
    char message[60];
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

/* ---- The port ---- */

static int record(void *context, const uint8_t *bytes, size_t count)
{
    const int taken = tale.takes < (int)count ? tale.takes : (int)count;
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    for (int i = 0; i < taken; i++) {
        TEST_ASSERT_TRUE(tale.sent_count < SENT_MAX);
        tale.sent[tale.sent_count++] = bytes[i];
    }
    return taken;
}

static uint8_t next_byte(void)
{
    const uint8_t byte = tale.sent[0];
    if (tale.sent_count == 0) {
        fail("nothing was sent");
    }
    tale.sent_count--;
    memmove(tale.sent, tale.sent + 1, tale.sent_count);
    return byte;
}

static int poll_once(void)
{
    const tmini_event_t event = tmini_poll(&rig.lidar);
    UNITY_TEST_ASSERT(lidar_is_sound(&rig.lidar), tale.line, tale.word);
    return (int)event;
}

static void poll_to(tmini_event_t expected)
{
    const tmini_event_t event = (tmini_event_t)poll_once();
    char message[60];
    (void)snprintf(message, sizeof message, "%s: came \"%s\"", tale.word, tmini_event_name(event));
    UNITY_TEST_ASSERT_EQUAL_INT(expected, event, tale.line, message);
}

static void expect_nothing_sent(void)
{
    expect_equal(0, (int)tale.sent_count, "sent, and not told");
}

static void expect_sent(const char *word)
{
    const bool is_rest = word[0] == '!';
    const int code = (int)strtol(word + (is_rest ? 1 : 0), NULL, 16);
    if (tale.sent_count == 0) {
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

static void feed(const char *word)
{
    if (word[0] >= '0' && word[0] <= '9') {
        rig_feed_frequency((uint32_t)atol(word));
    } else if (strcmp(word, "info") == 0) {
        rig_feed_info();
    } else if (strcmp(word, "health") == 0) {
        rig_feed_health(0, 0);
    } else if (strcmp(word, "scan") == 0) {
        rig_feed_scan_reply();
    } else if (strcmp(word, "P") == 0 || strcmp(word, "Z") == 0) {
        rig_feed_point_packet(word[0] == 'P' ? 1000 : 0);
    } else if (strcmp(word, "S") == 0) {
        rig_feed_start_packet(1000);
    } else if (strcmp(word, "junk") == 0) {
        rig_feed_byte(0x11);
    } else if (strncmp(word, "turn:", 5) == 0) {
        feed_turn((unsigned)atoi(word + 5));
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

static bool configure(const char *word)
{
    const char *const at = strchr(word, ':');
    const unsigned value = at != NULL ? (unsigned)atoi(at + 1) : 0;
    const size_t length = at != NULL ? (size_t)(at - word) : strlen(word);
    if (strcmp(word, "off") == 0) {
        rig.config.recovery = TMINI_RECOVERY_OFF;
    } else if (strcmp(word, "listen") == 0) {
        rig.config.listen_only = true;
    } else if (strcmp(word, "packets") == 0) {
        rig.config.points = NULL;
        rig.config.max_points = 0;
    } else if (strncmp(word, "wish", length) == 0) {
        rig.config.frequency_chz = (uint16_t)value;
    } else if (strncmp(word, "backoff", length) == 0) {
        rig.timing.back_off_max_ms = (uint16_t)value;
    } else if (strncmp(word, "attempts", length) == 0) {
        rig.timing.max_attempts = (uint8_t)value;
    } else if (strncmp(word, "quiet", length) == 0) {
        rig.timing.quiet_line_ms = (uint16_t)value;
    } else if (strncmp(word, "reply", length) == 0) {
        rig.timing.reply_timeout_ms = (uint16_t)value;
    } else {
        return false;
    }
    return true;
}

static void set_up(void)
{
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
    if (!tale.is_set_up) {
        set_up();
    }
    if (!call(word, &status)) {
        fail("what is this?");
    }
    expect_equal(wanted != NULL ? value_of(errors, wanted + 1) : TMINI_OK, status, "status");
}

static void tell_word(char *word)
{
    const char *const rest = word + 1;
    if (strncmp(word, "takes:", 6) == 0) {
        tale.takes = atoi(word + 6);
    } else if (strncmp(word, "turns:", 6) == 0) {
        feed_turns(word + 6);
    } else if (strncmp(word, "next:", 5) == 0) {
        expect_equal(atoi(word + 5), (int)tmini_next_poll_ms(&rig.lidar), "next poll");
    } else if (strncmp(word, "age:", 4) == 0) {
        expect_equal((int)atol(word + 4), (int)tmini_scan_age_ms(&rig.lidar), "age");
    } else if (strchr("><+~!@#?", word[0]) == NULL) {
        tell_call(word);
    } else if (!tale.is_set_up) {
        set_up();
        tell_word(word);
    } else if (word[0] == '>') {
        expect_sent(rest);
    } else if (word[0] == '<') {
        feed(rest);
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

void tale_go_on(unsigned line, const char *text)
{
    tale.line = line;
    while (*text != '\0') {
        const size_t length = strcspn(text, " ");
        char word[WORD_MAX];
        TEST_ASSERT_TRUE(length < WORD_MAX);
        memcpy(word, text, length);
        word[length] = '\0';
        memcpy(tale.word, word, length + 1);
        if (length > 0) {
            tell_word(word);
        }
        text += length + (text[length] != '\0' ? 1 : 0);
    }
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

void tale_tell(unsigned line, const char *text)
{
    tale_end();
    memset(&tale, 0, sizeof tale);
    tale.takes = 2;
    rig_open();
    rig.port.write = record;
    tale_go_on(line, text);
}
