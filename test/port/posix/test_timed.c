/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Timed streams: their chunks, and the clock that follows from these. ../../host/test_timed.py has
 * the tool hear one through a network that stalls. */

#include "tmini_timed.h"

#include "unity.h"

#include <string.h>

static uint8_t stream[1000];
static size_t stream_size;
static tmini_timed_t timed;

void setUp(void)
{
    memset(&timed, 0, sizeof timed);
    stream_size = 0;
}

/* --------------------------------------------------------------------------------------- chunks */

static void put(const void *bytes, size_t count)
{
    TEST_ASSERT_TRUE(stream_size + count <= sizeof stream);
    for (size_t i = 0; i < count; i++) {
        stream[stream_size++] = ((const uint8_t *)bytes)[i];
    }
}

static void put_chunk(uint32_t delta_us, const void *bytes, size_t count)
{
    uint8_t head[TMINI_TIMED_HEAD_SIZE];
    tmini_timed_write_head(head, delta_us, bytes, count);
    put(head, sizeof head);
    put(bytes, count);
}

/* Hands these bytes over as a port does. */
static void hand_over(const void *bytes, size_t count)
{
    size_t room = 0;
    memcpy(tmini_timed_room(&timed, &room), bytes, count);
    tmini_timed_put(&timed, count);
}

/* The chunks of a stream, as the reader passes them on: their bytes, "!" for a gap. */
static const char *read_all(const void *bytes, size_t count, size_t step)
{
    static char text[1000];
    size_t length = 0;
    tmini_timed_begin(&timed);
    for (size_t at = 0; at < count; at += step) {
        hand_over((const uint8_t *)bytes + at, count - at < step ? count - at : step);
        const uint8_t *taken = NULL;
        bool is_gap = false;
        size_t size = 0;
        while ((size = tmini_timed_take(&timed, 0, 2, &taken, &is_gap)) > 0 || is_gap) {
            TEST_ASSERT_TRUE(!is_gap || size == 0);
            memcpy(text + length, is_gap ? "!" : (const char *)taken, is_gap ? 1 : size);
            length += is_gap ? 1 : size;
        }
    }
    text[length] = '\0';
    return text;
}

void test_what_is_written_is_read(void)
{
    /* Its CRCs are Python's binascii.crc_hqx(head and bytes, 0xFFFF). */
    static const uint8_t file[] = "\x89tmini\x02\n"
                                  "\xA7\xC3\xE8\x03\x00\x00\x03\x00\x6B\xCD"
                                  "abc"
                                  "\xA7\xC3\x78\x56\x34\x12\x00\x00\x62\x55"
                                  "\xA7\xC3\x10\x27\x00\x00\x01\x00\xEE\x20"
                                  "d";
    for (size_t step = 1; step < sizeof file; step++) {
        TEST_ASSERT_EQUAL_STRING("abc!d", read_all(file, sizeof file - 1, step));
        TEST_ASSERT_EQUAL_INT(TMINI_TIMED_YES, timed.kind);
        TEST_ASSERT_EQUAL_INT64(1000 + 0x12345678 + 10000, timed.sent_us);
    }
    put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    put_chunk(1000, "abc", 3);
    put_chunk(0x12345678, NULL, 0);
    put_chunk(10000, "d", 1);
    TEST_ASSERT_EQUAL_size_t(sizeof file - 1, stream_size);
    TEST_ASSERT_EQUAL_MEMORY(file, stream, stream_size);
}

void test_a_damaged_chunk_is_a_gap(void)
{
    uint8_t more[300];
    memset(more, 'z', sizeof more); /* The most that may be awaited. */
    for (size_t damaged = 8; damaged < 8 + 13; damaged++) {
        stream_size = 0;
        put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
        put_chunk(1000, "abc", 3);
        put_chunk(1000, "de", 2);
        put_chunk(1000, more, sizeof more);
        stream[damaged] ^= damaged % 2 > 0 ? 0x80 : 1;
        TEST_ASSERT_EQUAL_STRING_LEN("!dezzz", read_all(stream, stream_size, 500), 6);
    }
}

void test_of_a_connection_before_nothing_is_left(void)
{
    const uint8_t *taken = NULL;
    bool is_gap = false;
    put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    put_chunk(1000, "abc", 3);
    put("?", 1);
    hand_over(stream, stream_size);
    TEST_ASSERT_EQUAL_size_t(2, tmini_timed_take(&timed, 0, 2, &taken, &is_gap));
    TEST_ASSERT_EQUAL_size_t(1, tmini_timed_left(&timed));
    TEST_ASSERT_EQUAL_STRING("abc", read_all(stream, stream_size - 1, 100));
    timed.is_gap = true;
    TEST_ASSERT_EQUAL_STRING("abc", read_all(stream, stream_size - 1, 100));
}

void test_a_stream_that_begins_otherwise_is_raw(void)
{
    TEST_ASSERT_EQUAL_STRING("\x89tmimi", read_all("\x89tmimi", 6, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_TIMED_RAW, timed.kind);
    TEST_ASSERT_EQUAL_STRING("", read_all("\x89tmini\x02", 7, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_TIMED_UNKNOWN, timed.kind);
    TEST_ASSERT_EQUAL_INT64(5, tmini_timed_now_us(&timed, 5));
}

/* ---------------------------------------------------------------------------------------- clock */

/* The clock: the time of the chunk, then, after a patience, the receiver's; never back. */
static int64_t clock_after(int64_t now_us, uint32_t delta_us)
{
    const uint8_t *taken = NULL;
    bool is_gap = false;
    stream_size = 0;
    put_chunk(delta_us, "x", 1);
    hand_over(stream, stream_size);
    TEST_ASSERT_EQUAL_size_t(1, tmini_timed_take(&timed, now_us, 10, &taken, &is_gap));
    return tmini_timed_now_us(&timed, now_us);
}

void test_the_clock_never_goes_back(void)
{
    timed.kind = TMINI_TIMED_YES;
    TEST_ASSERT_EQUAL_INT64(50, tmini_timed_now_us(&timed, 50));
    TEST_ASSERT_EQUAL_INT64(1000000, clock_after(1000000, 123));
    TEST_ASSERT_EQUAL_INT64(1000000, tmini_timed_now_us(&timed, 1600000));
    TEST_ASSERT_EQUAL_INT64(1000001, tmini_timed_now_us(&timed, 1600001));
    TEST_ASSERT_EQUAL_INT64(1400000, tmini_timed_now_us(&timed, 2000000));
    TEST_ASSERT_EQUAL_INT64(1400000, clock_after(2000000, 10000)); /* Too late for its time. */
    TEST_ASSERT_EQUAL_INT64(1510000 + 244, clock_after(2000001, 500000));
    TEST_ASSERT_EQUAL_INT64(2000002, clock_after(2000002, 9000000)); /* Not in the future. */
    TEST_ASSERT_EQUAL_INT64(9000002, clock_after(9000002, 10));      /* The sender's has jumped. */
    tmini_timed_begin(&timed); /* Another sender's is unknown. */
    timed.kind = TMINI_TIMED_YES;
    TEST_ASSERT_EQUAL_INT64(9100002, clock_after(9100002, 9000000));
}
