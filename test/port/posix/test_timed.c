/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Timed streams, in virtual time: the simulated lidar, a network that delays what it sends, and the
 * driver, compared with a driver beside the lidar. */

#include "simulator.h"
#include "tmini/tmini.h"
#include "tmini_timed.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define SECONDS_MAX 250u
#define SCANS_MAX (SECONDS_MAX * 7u)
#define STREAM_MAX (SECONDS_MAX * 14500u)
#define CHUNKS_MAX (SECONDS_MAX * 101u)
#define SEND_MS 10u /* A chunk is sent this often. */

/* A network with one stall per second, and a sender's clock that is wrong. */
typedef struct {
    const char *name;
    unsigned stall_ms;
    unsigned stall_from_ms;
    int sender_ppm;
    unsigned seconds;
    unsigned poll_ms; /* How often the program polls. */
} network_t;

typedef struct {
    uint32_t start_ms;
    uint32_t content;
} seen_t;

static uint8_t stream[STREAM_MAX];
static size_t stream_size;
static struct {
    uint32_t sent_ms;
    size_t end; /* In the stream. */
} chunks[CHUNKS_MAX];
static unsigned chunk_count;
static seen_t truth[SCANS_MAX];
static unsigned truths;

static tmini_timed_t timed;
static uint32_t now_ms;
static tmini_t lidar;
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static unsigned losses;
static unsigned recoveries;

void setUp(void)
{
    memset(&timed, 0, sizeof timed);
    now_ms = 0;
    losses = 0;
    recoveries = 0;
}

void tearDown(void) {}

static uint32_t true_now_ms(void *context)
{
    (void)context;
    return now_ms;
}

static uint32_t timed_now_ms(void *context)
{
    (void)context;
    return (uint32_t)(tmini_timed_now_us(&timed, (int64_t)now_ms * 1000) / 1000);
}

static int refuse(void *context, const uint8_t *bytes, size_t count)
{
    (void)context, (void)bytes, (void)count;
    return -1;
}

static void init(const tmini_port_t *port)
{
    const tmini_config_t config = {.port = port,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = sizeof points / sizeof *points,
                                   .listen_only = true};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
}

static uint32_t content_of(const tmini_scan_t *scan)
{
    uint32_t sum = scan->count;
    for (size_t i = 0; i < scan->count; i++) {
        sum = sum * 31u + scan->points[i].distance_mm + scan->points[i].intensity;
    }
    return sum;
}

/* Polls, and adds the complete scans to `seen`. */
static unsigned poll_scans(seen_t *seen, unsigned count)
{
    tmini_event_t event = TMINI_EVENT_MORE;
    while (event != TMINI_EVENT_NONE) {
        event = tmini_poll(&lidar);
        losses += event == TMINI_EVENT_LOST ? 1 : 0;
        recoveries += event == TMINI_EVENT_RECOVERED ? 1 : 0;
        if (event == TMINI_EVENT_SCAN && tmini_scan(&lidar)->complete) {
            TEST_ASSERT_LESS_THAN(SCANS_MAX, count);
            seen[count++] = (seen_t){tmini_scan(&lidar)->start_ms, content_of(tmini_scan(&lidar))};
        }
    }
    return count;
}

static void put(const void *bytes, size_t count)
{
    TEST_ASSERT_TRUE(stream_size + count <= sizeof stream);
    memcpy(stream + stream_size, bytes, count);
    stream_size += count;
}

static void put_chunk(uint32_t delta_us, const uint8_t *bytes, size_t count)
{
    uint8_t head[TMINI_TIMED_HEAD_SIZE];
    tmini_timed_write_head(head, delta_us, bytes, count);
    put(head, sizeof head);
    put(bytes, count);
}

/* The lidar scans for some seconds: what the sender sends, and what a driver beside the lidar
 * sees. */
static void scan_for(unsigned seconds, int sender_ppm)
{
    static const tmini_port_t beside = {.write = refuse, .now_ms = true_now_ms};
    static const uint8_t start[2] = {0xA5, 0x60};
    static sim_t sim;
    const sim_config_t config = sim_default_config();
    sim_init(&sim, &config);
    sim_receive(&sim, start, sizeof start, 0);
    stream_size = 0;
    chunk_count = 0;
    truths = 0;
    put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    init(&beside);
    for (now_ms = SEND_MS; now_ms < seconds * 1000; now_ms += SEND_MS) {
        uint8_t bytes[512];
        const size_t count = sim_transmit(&sim, (uint64_t)now_ms * 1000, bytes, sizeof bytes);
        put_chunk(SEND_MS * 1000u + (uint32_t)((int)SEND_MS * sender_ppm / 1000), bytes, count);
        chunks[chunk_count].sent_ms = now_ms;
        chunks[chunk_count++].end = stream_size;
        TEST_ASSERT_EQUAL_size_t(count, tmini_feed(&lidar, bytes, count));
        truths = poll_scans(truth, truths);
    }
    now_ms = 0;
}

static const tmini_port_t behind = {.write = refuse, .now_ms = timed_now_ms};

/* Hands over what has arrived up to `end` as a port does. */
static void hand_over(size_t *at, size_t end)
{
    size_t room = 0;
    uint8_t *const place = tmini_timed_room(&timed, &room);
    const size_t count = end - *at < room ? end - *at : room;
    memcpy(place, stream + *at, count);
    tmini_timed_put(&timed, count);
    *at += count;
}

static bool feed_next(void)
{
    const uint8_t *bytes = NULL;
    bool is_gap = false;
    const size_t count =
        tmini_timed_take(&timed, (int64_t)now_ms * 1000, tmini_feed_room(&lidar), &bytes, &is_gap);
    (void)tmini_feed(&lidar, bytes, count);
    if (is_gap) {
        tmini_feed_gap(&lidar);
    }
    return count > 0 || is_gap;
}

static bool is_stalled(const network_t *network)
{
    const unsigned ms = (now_ms + 1000 - network->stall_from_ms) % 1000;
    return ms < network->stall_ms;
}

/* What a program at the other end of the network sees. Returns the number of complete scans. */
static unsigned listen(const network_t *network, seen_t *seen)
{
    unsigned count = 0;
    unsigned arrived = 0;
    size_t at = 0;
    size_t end = 0;
    init(&behind);
    for (now_ms = 0; now_ms < network->seconds * 1000 + 1000; now_ms += network->poll_ms) {
        while (!is_stalled(network) && arrived < chunk_count &&
               chunks[arrived].sent_ms + 3 <= now_ms) {
            end = chunks[arrived++].end;
        }
        do {
            hand_over(&at, end);
            while (feed_next()) {
                count = poll_scans(seen, count);
            }
        } while (at < end);
        count = poll_scans(seen, count);
    }
    return count;
}

/* How much the times differ from the truth, without the constant delay. */
static uint32_t spread_ms(const seen_t *seen, unsigned count)
{
    int32_t least = INT32_MAX;
    int32_t most = INT32_MIN;
    unsigned at = 0;
    for (unsigned i = 0; i < count; i++) {
        while (at < truths && truth[at].content != seen[i].content) {
            at++;
        }
        TEST_ASSERT_LESS_THAN_MESSAGE(truths, at, "a scan that the lidar has not sent");
        const int32_t late = (int32_t)(seen[i].start_ms - truth[at].start_ms);
        least = late < least ? late : least;
        most = late > most ? late : most;
    }
    return (uint32_t)(most - least);
}

/* Once the smallest delay is known, after the first stall. */
#define SETTLED_SCANS 12u

static void check_network(const network_t *network)
{
    static seen_t seen[SCANS_MAX];
    char text[100];
    scan_for(network->seconds, network->sender_ppm);
    const unsigned count = listen(network, seen);
    (void)snprintf(text, sizeof text, "%s: %u of %u", network->name, count, truths);
    TEST_ASSERT_TRUE_MESSAGE(count * 100 >= truths * 99 && truths > network->seconds * 5, text);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, losses, network->name);
    const uint32_t spread = spread_ms(seen + SETTLED_SCANS, count - SETTLED_SCANS);
    (void)snprintf(text, sizeof text, "%s: times differ by %u ms", network->name, (unsigned)spread);
    TEST_ASSERT_TRUE_MESSAGE(spread <= 25, text);
}

void test_stalls_cost_neither_scans_nor_times(void)
{
    static const network_t networks[] = {
        {"no stall", 0, 0, 0, 30, 1},
        {"0.3 s per second", 300, 300, 0, 60, 1},
        {"0.5 s per second", 500, 300, 0, 60, 1},
        {"0.5 s per second, polled every 20 ms", 500, 300, 0, 60, 20},
        {"a stall at the beginning", 500, 0, 0, 60, 1},
        {"a sender whose clock is slow", 500, 300, -200, SECONDS_MAX, 1},
        {"a sender whose clock is fast", 500, 300, 200, SECONDS_MAX, 1},
    };
    for (unsigned i = 0; i < sizeof networks / sizeof *networks; i++) {
        setUp();
        check_network(&networks[i]);
    }
}

/* Receives the stream without delay from `from_ms` on. */
static unsigned receive_from(uint32_t from_ms, uint32_t to_ms, size_t *at, seen_t *seen)
{
    unsigned count = 0;
    for (unsigned i = 0; now_ms < to_ms; now_ms++) {
        while (i < chunk_count && from_ms + chunks[i].sent_ms <= now_ms) {
            hand_over(at, chunks[i++].end);
        }
        while (feed_next()) {
            count = poll_scans(seen, count);
        }
        count = poll_scans(seen, count);
    }
    return count;
}

void test_a_dead_link_is_lost_and_another_connection_recovers(void)
{
    static seen_t seen[SCANS_MAX];
    size_t at = 0;
    scan_for(5, 0);
    init(&behind);
    TEST_ASSERT_GREATER_THAN(20, receive_from(0, 5000, &at, seen));
    TEST_ASSERT_EQUAL_UINT(0, losses);
    (void)receive_from(0, 7000, &at, seen);
    TEST_ASSERT_EQUAL_UINT(1, losses);
    at = 0;
    tmini_timed_begin(&timed);
    TEST_ASSERT_GREATER_THAN(20, receive_from(7000, 12000, &at, seen));
    TEST_ASSERT_EQUAL_UINT(1, recoveries);
    TEST_ASSERT_EQUAL_UINT(1, losses);
}

/* The chunks of a stream, as the reader passes them on: their bytes, "!" for a gap. */
static const char *read_all(const void *bytes, size_t count, size_t step)
{
    static char text[1000];
    size_t length = 0;
    tmini_timed_begin(&timed);
    for (size_t at = 0; at < count; at += step) {
        size_t room = 0;
        const size_t part = count - at < step ? count - at : step;
        memcpy(tmini_timed_room(&timed, &room), (const uint8_t *)bytes + at, part);
        tmini_timed_put(&timed, part);
        const uint8_t *taken = NULL;
        bool is_gap = false;
        size_t size = 0;
        while ((size = tmini_timed_take(&timed, 0, 2, &taken, &is_gap)) > 0 || is_gap) {
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
    stream_size = 0;
    put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    put_chunk(1000, (const uint8_t *)"abc", 3);
    put_chunk(0x12345678, NULL, 0);
    put_chunk(10000, (const uint8_t *)"d", 1);
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
        put_chunk(1000, (const uint8_t *)"abc", 3);
        put_chunk(1000, (const uint8_t *)"de", 2);
        put_chunk(1000, more, sizeof more);
        stream[damaged] ^= damaged % 2 > 0 ? 0x80 : 1;
        TEST_ASSERT_EQUAL_STRING_LEN("!dezzz", read_all(stream, stream_size, 500), 6);
    }
}

void test_of_a_connection_before_nothing_is_left(void)
{
    size_t room = 0;
    const uint8_t *taken = NULL;
    bool is_gap = false;
    stream_size = 0;
    put(tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    put_chunk(1000, (const uint8_t *)"abc", 3);
    put("?", 1);
    memcpy(tmini_timed_room(&timed, &room), stream, stream_size);
    tmini_timed_put(&timed, stream_size);
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

/* The clock: the time of the chunk, then, after a patience, the receiver's; never back. */
static int64_t clock_after(int64_t now_us, uint32_t delta_us)
{
    static const uint8_t byte = 'x';
    size_t room = 0;
    const uint8_t *taken = NULL;
    bool is_gap = false;
    stream_size = 0;
    put_chunk(delta_us, &byte, 1);
    memcpy(tmini_timed_room(&timed, &room), stream, stream_size);
    tmini_timed_put(&timed, stream_size);
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
