/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The bridge's queues, and who may listen. */

#include "bridge.h"
#include "tmini_timed.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static bridge_t bridge;
static uint8_t sent[100000];
static size_t sent_size;

void setUp(void)
{
    memset(&bridge, 0, sizeof bridge);
    sent_size = 0;
    TEST_ASSERT_EQUAL_INT(0, bridge_join(&bridge));
}

/* The network takes at most this many bytes. */
static void take(int listener, size_t most)
{
    const uint8_t *bytes = NULL;
    size_t count = 0;
    while (most > 0 && (count = bridge_next(&bridge, listener, &bytes)) > 0) {
        count = count < most ? count : most;
        TEST_ASSERT_TRUE(sent_size + count <= sizeof sent);
        memcpy(sent + sent_size, bytes, count);
        sent_size += count;
        bridge_sent(&bridge, listener, count);
        most -= count;
    }
}

/* What the listener reads from it: the lidar's bytes, and '!' for each gap. */
static const char *heard(void)
{
    static char text[100000];
    static tmini_timed_t timed;
    size_t length = 0;
    memset(&timed, 0, sizeof timed);
    for (size_t at = 0; at < sent_size; at++) {
        size_t room = 0;
        const uint8_t *bytes = NULL;
        bool is_gap = false;
        *tmini_timed_room(&timed, &room) = sent[at];
        tmini_timed_put(&timed, 1);
        size_t count = 0;
        while ((count = tmini_timed_take(&timed, 0, 4096, &bytes, &is_gap)) > 0 || is_gap) {
            memcpy(text + length, is_gap ? "!" : (const char *)bytes, is_gap ? 1 : count);
            length += is_gap ? 1 : count;
        }
    }
    text[length] = '\0';
    return text;
}

void test_a_listener_gets_magic_bytes_and_chunks_with_the_times_since_the_one_before(void)
{
    /* The CRCs are Python's binascii.crc_hqx(head and bytes, 0xFFFF). */
    static const uint8_t expected[] = "\x89tmini\x02\n"
                                      "\xA7\xC3\x00\x00\x00\x00\x01\x00\x79\xBA"
                                      "a"
                                      "\xA7\xC3\x10\x27\x00\x00\x01\x00\xEE\x20"
                                      "d";
    bridge_pass(&bridge, 5000000000u, (const uint8_t *)"a", 1);
    bridge_pass(&bridge, 5000010000u, (const uint8_t *)"d", 1);
    take(0, SIZE_MAX);
    TEST_ASSERT_EQUAL_size_t(sizeof expected - 1, sent_size);
    TEST_ASSERT_EQUAL_MEMORY(expected, sent, sent_size);
}

void test_what_is_taken_in_portions_of_any_size_is_whole(void)
{
    char all[20001] = "";
    srand(1);
    for (size_t i = 0; i < 20000; i++) {
        all[i] = (char)('a' + rand() % 26);
    }
    for (size_t at = 0; at < 20000;) {
        const size_t some = 1 + (size_t)rand() % 2000;
        const size_t count = some < 20000 - at ? some : 20000 - at;
        bridge_pass(&bridge, at, (const uint8_t *)all + at, count);
        at += count;
        while (bridge.listeners[0].count > 3000) {
            take(0, 1 + (size_t)rand() % 700);
        }
    }
    take(0, SIZE_MAX);
    TEST_ASSERT_EQUAL_STRING(all, heard());
    TEST_ASSERT_EQUAL_UINT32(0, bridge.listeners[0].stretches);
}

void test_a_slow_listener_loses_what_waits_and_is_told_so(void)
{
    uint8_t part[1000];
    for (size_t begun = 0; begun < 300; begun++) { /* So much of the first chunks is on its way. */
        setUp();
        for (int i = 0; i < 10; i++) {
            memset(part, 'a' + i, 100);
            bridge_pass(&bridge, 0, part, 100);
        }
        take(0, begun);
        memset(part, '-', sizeof part);
        while (bridge.listeners[0].stretches == 0) {
            bridge_pass(&bridge, 0, part, sizeof part);
        }
        bridge_pass(&bridge, 0, (const uint8_t *)"end", 3);
        take(0, SIZE_MAX);
        const char *const text = heard();
        const char *const gap = strchr(text, '!');
        TEST_ASSERT_NOT_NULL(gap);
        TEST_ASSERT_EQUAL_size_t(1 + sizeof part + 3, strlen(gap));
        TEST_ASSERT_EQUAL_STRING("-end", gap + sizeof part);
        TEST_ASSERT_EQUAL_size_t(begun <= 8 ? 0 : (begun - 8 + 109) / 110 * 100,
                                 (size_t)(gap - text));
    }
}

void test_a_loss_before_the_bridge_is_a_gap(void)
{
    bridge_pass(&bridge, 0, (const uint8_t *)"a", 1);
    bridge_pass(&bridge, 0, NULL, 0);
    bridge_pass(&bridge, 0, (const uint8_t *)"b", 1);
    take(0, SIZE_MAX);
    TEST_ASSERT_EQUAL_STRING("a!b", heard());
}

void test_listeners_are_few_and_a_place_that_is_free_again_is_empty(void)
{
    for (int i = 1; i < BRIDGE_LISTENERS_MAX; i++) {
        TEST_ASSERT_EQUAL_INT(i, bridge_join(&bridge));
    }
    TEST_ASSERT_EQUAL_INT(-1, bridge_join(&bridge));
    bridge_pass(&bridge, 0, (const uint8_t *)"old", 3);
    bridge_leave(&bridge, 2, 0);
    TEST_ASSERT_EQUAL_INT(2, bridge_join(&bridge));
    bridge_pass(&bridge, 0, (const uint8_t *)"new", 3);
    take(2, SIZE_MAX);
    TEST_ASSERT_EQUAL_STRING("new", heard());
}

void test_the_lidar_scans_while_somebody_listens_and_two_seconds_longer(void)
{
    static const bridge_t unheard;
    TEST_ASSERT_FALSE(bridge_is_wanted(&unheard, 5));
    (void)bridge_join(&bridge);
    TEST_ASSERT_TRUE(bridge_is_wanted(&bridge, 900000000));
    bridge_leave(&bridge, 0, 900000000);
    TEST_ASSERT_TRUE(bridge_is_wanted(&bridge, 990000000));
    bridge_leave(&bridge, 1, 990000000);
    TEST_ASSERT_TRUE(bridge_is_wanted(&bridge, 991999999));
    TEST_ASSERT_FALSE(bridge_is_wanted(&bridge, 992000000));
}

void test_only_a_page_from_here_may_listen(void)
{
    static const struct {
        bool may;
        const char *host;
        const char *origin;
    } cases[] = {
        {true, "192.168.4.1", NULL},
        {true, "192.168.4.1:80", "http://192.168.4.1:80"},
        {true, "[fe80::1]:80", "http://[fe80::1]:80"},
        {true, "localhost", "http://localhost"},
        {true, "Lidar.Local", "http://Lidar.Local"},
        {false, NULL, NULL},
        {false, "", NULL},
        {false, "evil.example", NULL},
        {false, "evil.example", "http://evil.example"},
        {false, "lidar.local.evil.example", NULL},
        {false, "lidar.loca", NULL},
        {false, "192.168.4.1.evil.example", NULL},
        {false, "192.168.4.1", "http://evil.example"},
        {false, "192.168.4.1", "http://192.168.4.1.evil.example"},
        {false, "192.168.4.1", "http://192.168.4.1:81"},
        {false, "192.168.4.1", "null"},
        {false, "192.168.4.1", ""},
        {false, "1111111111111111111111111111111111111111111111111111111111111111", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TEST_ASSERT_EQUAL_MESSAGE(cases[i].may,
                                  bridge_may_listen(cases[i].host, cases[i].origin, "lidar.local"),
                                  cases[i].host != NULL ? cases[i].host : "no host");
    }
}
