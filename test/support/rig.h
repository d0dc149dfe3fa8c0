/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For the driver's unit tests: a driver on a mocked port, with a scripted clock and bytes from the
 * independent encoder. A test reads as a story:
 *
 *     sends(GET_INFO);                          the port expects these bytes
 *     begins(tmini_request_info(&rig.lidar));   the call succeeds
 *     passes(1999);                             time passes, nothing happens
 *     rig_feed_info();                          the reply arrives
 *     polls_to(TMINI_EVENT_INFO);
 */

#ifndef RIG_H
#define RIG_H

#include "encoder.h"
#include "tmini/tmini.h"

#include "unity.h"

#define RIG_RX_SIZE 256
#define RIG_POINTS 60

/* Command codes, from section 3. */
enum {
    FASTER_TENTH = 0x09,
    SLOWER_TENTH = 0x0A,
    FASTER_ONE = 0x0B,
    SLOWER_ONE = 0x0C,
    GET_FREQUENCY = 0x0D,
    REBOOT = 0x40,
    START = 0x60,
    STOP = 0x65,
    GET_INFO = 0x90,
    GET_HEALTH = 0x92
};

typedef struct {
    tmini_t lidar;
    tmini_config_t config;
    tmini_timing_t timing; /* The default, except that pauses of the line are not judged. */
    tmini_port_t port;
    uint32_t now_ms; /* Time of the port's clock. */
    uint8_t rx[RIG_RX_SIZE];
    tmini_point_t points[RIG_POINTS];
    uint8_t crc;  /* Of the turn fed last. */
    bool in_turn; /* A turn with CT information has begun. */
    uint32_t fed; /* Bytes, since the lidar was set up. */
} rig_t;

extern rig_t rig;

/* Fresh mocks, a clock at 1000 ms, a configuration with a scan buffer; the lidar is set up. */
void rig_open(void);

/* Sets the lidar up again, with rig.config as it is now. */
void rig_init(void);

/* ---- The port ---- */

/* The port's next write is expected with these bytes, and accepts `taken` of them. */
#define sends(code) rig_expect_write(__LINE__, 0xA5, code, 2, 2)
#define sends_both_taking(code, taken) rig_expect_write(__LINE__, 0xA5, code, 2, taken)
#define sends_rest_taking(code, taken) rig_expect_write(__LINE__, code, 0, 1, taken)
void rig_expect_write(unsigned line, uint8_t first, uint8_t second, size_t count, int taken);

/* All bytes expected so far have been sent. */
void rig_verify(void);

/* ---- Time and events ---- */

#define begins(call) TEST_ASSERT_EQUAL_INT(TMINI_OK, call)

/* The same, and the call sends this command. */
#define begins_with(code, call) \
    do {                        \
        sends(code);            \
        begins(call);           \
    } while (false)

#define polls_to(event) \
    UNITY_TEST_ASSERT_EQUAL_INT(event, tmini_poll(&rig.lidar), __LINE__, "event")

#define is_in(state) UNITY_TEST_ASSERT_EQUAL_INT(state, tmini_state(&rig.lidar), __LINE__, "state")

/* The next poll sends this command and returns no event. */
#define polls_and_sends(code)       \
    do {                            \
        sends(code);                \
        polls_to(TMINI_EVENT_NONE); \
    } while (false)

/* `ms` milliseconds pass. Polls at the beginning, in the middle and one millisecond before the end:
 * nothing may happen or be sent. The next poll is at the end. */
#define passes(ms) rig_pass(__LINE__, ms)
void rig_pass(unsigned line, uint32_t ms);

/* `ms` milliseconds pass, and bring this event. */
#define passes_to(ms, event) \
    do {                     \
        passes(ms);          \
        polls_to(event);     \
    } while (false)

/* The lidar answers that this frequency is set, and this command follows. */
#define answers_and_gets(frequency_chz, code) \
    do {                                      \
        rig_feed_frequency(frequency_chz);    \
        polls_and_sends(code);                \
    } while (false)

/* Polls until there is nothing left to do; returns a bit for each event. */
unsigned rig_drain(void);

#define BIT(event) (1u << (event))

tmini_counters_t rig_counters(void);

/* ---- Bytes from the lidar ---- */

void rig_feed(const uint8_t *bytes, size_t count);
void rig_feed_byte(uint8_t byte);

void rig_feed_scan_reply(void);
void rig_feed_info(void); /* T-mini Plus, firmware 1.2, hardware 1. */
void rig_feed_health(uint8_t status, uint16_t error_code);
void rig_feed_frequency(uint32_t frequency_chz);

/* A packet of `lsn` samples, all of this distance, half a degree apart from 10 degrees on. */
void rig_feed_packet(uint8_t ct, uint8_t lsn, uint16_t distance_mm);
void rig_feed_start_packet(uint16_t distance_mm); /* 6.0 Hz. */
void rig_feed_point_packet(uint16_t distance_mm); /* 4 samples. */

/* A start packet and four point packets, as from a unit without CT information. */
void rig_feed_plain_turn(uint16_t distance_mm);

/* The same from a unit with CT information that reports this health. The LastCRC of the turn before
 * comes first: that turn is now complete, and is judged. */
void rig_feed_turn(uint8_t health, uint16_t distance_mm);

/* Feeds a turn with CT information, 160 ms later; it is judged when the next one begins. Returns a
 * bit for each event, except for scans. */
unsigned rig_turn_events(uint8_t health);

/* Feeds turns without it, each 160 ms later. */
void rig_plain_turns(unsigned count, uint16_t distance_mm);

/* ---- Ways into each state ---- */

void rig_go_idle(void);

/* The lidar is idle, and the call sends this command. */
#define is_idle_and_asked(code, call) \
    do {                              \
        rig_go_idle();                \
        begins_with(code, call);      \
    } while (false)

void rig_go_starting(void);   /* The start has been sent, its reply is awaited. */
void rig_go_scanning(void);   /* One point packet with a range has come. */
void rig_go_recovering(void); /* Lost; a stop has been sent just now. */

#endif
