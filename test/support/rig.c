/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rig.h"

#include "mock_port_functions.h"

#include <string.h>

rig_t rig;

/* CMock reads the expected bytes when the call comes, so they must still exist then. */
#define EXPECTATIONS 16
static uint8_t expected[EXPECTATIONS][2];
static unsigned expectations;

static uint32_t read_clock(void *context, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    return rig.now_ms;
}

static void renew_mocks(void)
{
    mock_port_functions_Destroy();
    mock_port_functions_Init();
    port_now_ms_StubWithCallback(read_clock);
}

void rig_open(void)
{
    memset(&rig, 0, sizeof rig);
    rig.port.write = port_write;
    rig.port.now_ms = port_now_ms;
    renew_mocks();
    rig.now_ms = 1000;
    rig.config.port = &rig.port;
    rig.config.port_context = &rig.port;
    rig.config.rx_buffer = rig.rx;
    rig.config.rx_size = sizeof rig.rx;
    rig.config.points = rig.points;
    rig.config.max_points = RIG_POINTS;
    rig.timing = tmini_timing_default;
    rig.timing.max_pause_ms = 0; /* The rig's turns are short, and its clock jumps. */
    rig.config.timing = &rig.timing;
    rig_init();
}

void rig_init(void)
{
    rig.fed = 0;
    rig.in_turn = false;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&rig.lidar, &rig.config));
}

/* ---- The port ---- */

void rig_expect_write(unsigned line, uint8_t first, uint8_t second, size_t count, int taken)
{
    uint8_t *const bytes = expected[expectations++ % EXPECTATIONS];

    bytes[0] = first;
    bytes[1] = second;
    port_write_CMockExpectAndReturn((UNITY_LINE_TYPE)line, &rig.port, bytes, count, taken);
}

void rig_verify(void)
{
    mock_port_functions_Verify();
    renew_mocks(); /* CMock's memory would not hold the calls of a long story. */
}

/* ---- Time and events ---- */

static void check_silence(unsigned line)
{
    UNITY_TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&rig.lidar), (UNITY_LINE_TYPE)line,
                                "an event too early");
}

void rig_pass(unsigned line, uint32_t ms)
{
    const uint32_t from_ms = rig.now_ms;

    check_silence(line);
    rig.now_ms = from_ms + ms / 2;
    check_silence(line);
    rig.now_ms = from_ms + ms - 1;
    check_silence(line);
    rig.now_ms = from_ms + ms;
}

unsigned rig_drain(void)
{
    unsigned events = 0;
    tmini_event_t event;

    while ((event = tmini_poll(&rig.lidar)) != TMINI_EVENT_NONE) {
        events |= BIT(event);
    }
    return events;
}

tmini_counters_t rig_counters(void)
{
    tmini_counters_t counters;
    tmini_counters(&rig.lidar, &counters);
    return counters;
}

/* ---- Bytes from the lidar ---- */

void rig_feed(const uint8_t *bytes, size_t count)
{
    tmini_feed(&rig.lidar, bytes, count);
    rig.fed += (uint32_t)count;
}

void rig_feed_byte(uint8_t byte)
{
    rig_feed(&byte, 1);
}

void rig_feed_scan_reply(void)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    rig_feed(reply, encode_scan_reply(reply));
}

void rig_feed_info(void)
{
    static const encode_information_t information = {
        151, 1, 2, 1, {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4}};
    uint8_t reply[ENCODE_REPLY_MAX];

    rig_feed(reply, encode_information_reply(reply, &information));
}

void rig_feed_health(uint8_t status, uint16_t error_code)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    rig_feed(reply, encode_health_reply(reply, status, error_code));
}

void rig_feed_frequency(uint32_t frequency_chz)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    rig_feed(reply, encode_frequency_reply(reply, frequency_chz));
}

void rig_feed_packet(uint8_t ct, uint8_t lsn, uint16_t distance_mm)
{
    encode_sample_t samples[40];
    uint8_t bytes[ENCODE_PACKET_HEADER + 40 * ENCODE_SAMPLE_SIZE];
    const encode_packet_t packet = {ct, lsn, 640, (uint16_t)(640 + 32 * (lsn - 1)), samples};

    for (unsigned i = 0; i < lsn; i++) {
        samples[i].distance_mm = distance_mm;
        samples[i].intensity = 50;
        samples[i].flag = 0;
    }
    rig_feed(bytes, encode_packet(bytes, &packet));
}

void rig_feed_start_packet(uint16_t distance_mm)
{
    rig_feed_packet(0x79, 1, distance_mm);
}

void rig_feed_point_packet(uint16_t distance_mm)
{
    rig_feed_packet(0, 4, distance_mm);
}

void rig_feed_plain_turn(uint16_t distance_mm)
{
    rig_feed_start_packet(distance_mm);
    for (unsigned index = 1; index < 5; index++) {
        rig_feed_point_packet(distance_mm);
    }
}

void rig_feed_turn(uint8_t health, uint16_t distance_mm)
{
    const encode_turn_t turn = {.frequency_dhz = 60, .user_major = 1, .health = health};

    if (rig.in_turn) {
        rig_feed_byte(rig.crc);
    }
    rig.in_turn = true;
    rig.crc = 0;
    for (unsigned index = 0; index < 5; index++) {
        const uint8_t ct = encode_ct(&turn, index);

        rig_feed_packet(ct, index == 0 ? 1 : 4, distance_mm);
        rig.crc = encode_crc8(rig.crc, ct);
    }
}

/* ---- Ways into each state ---- */

void rig_go_idle(void)
{
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE);
}

void rig_go_starting(void)
{
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    answers_and_gets(600, START);
}

void rig_go_scanning(void)
{
    rig_go_starting();
    rig_feed_scan_reply();
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    (void)rig_drain();
    is_in(TMINI_STATE_SCANNING);
}

void rig_go_recovering(void)
{
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
}

/* ---- Turns and their events ---- */

unsigned rig_turn_events(uint8_t health)
{
    rig.now_ms += 160;
    rig_feed_turn(health, 1000);
    return rig_drain() & ~BIT(TMINI_EVENT_SCAN);
}

void rig_plain_turns(unsigned count, uint16_t distance_mm)
{
    while (count-- > 0) {
        rig.now_ms += 160;
        rig_feed_plain_turn(distance_mm);
        (void)rig_drain();
    }
}
