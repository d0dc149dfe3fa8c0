/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The controller in one trial, in virtual time: a receiver of the line's bytes, the library, and
 * a program that polls it and is sometimes busy.
 *
 * There are three receivers: an interrupt per byte; a task or FIFO below that hands over blocks;
 * and circular DMA whose half-transfer, transfer-complete and idle-line interrupts publish its
 * position. Time also passes at each access to an index that both sides share
 * (interrupting_atomic.h): bytes arrive and interrupts come during tmini_poll(). A poll may also
 * be pre-empted for longer. */

#ifndef CAMPAIGN_HOST_H
#define CAMPAIGN_HOST_H

#include "campaign_line.h"

#include "tmini/tmini.h"

#define HOST_RX_MAX 65536u
#define HOST_POINTS 2048u

typedef enum { FEED_BYTES, FEED_BLOCKS, FEED_DMA, FEED_KINDS } feed_t;

typedef struct {
    feed_t feed;
    size_t rx_size;
    size_t max_points;
    uint32_t poll_us;        /* Pause after a poll without an event. */
    uint32_t access_ns;      /* Time per access to a shared index. */
    uint32_t block_us;       /* Time between two blocks; 0: the program fetches them, then polls. */
    bool asks_room;          /* Blocks: bytes that do not fit stay in the layer below. */
    bool reports_held;       /* Bytes in the layer below are reported. */
    bool is_bridged;         /* The program is never busy so long that the layer overflows. */
    uint32_t block_size;     /* The layer's size in bytes. */
    uint32_t handler_us;     /* The longest work on a scan; from 1 ms. */
    uint32_t handle_one_in;  /* It works on one scan in N; 0: on none. */
    uint32_t preempt_us;     /* The longest pre-emption of a poll. */
    uint32_t preempt_one_in; /* One poll in N is pre-empted; 0: none. */
    uint32_t stall_laps;     /* While the CPU stops, DMA receives up to this many laps. */
    uint32_t stall_one_in;   /* The CPU stops in one poll or pause in N; 0: never. */
    uint32_t false_gap_one_in; /* One DMA interrupt in N reports a loss although there was none. */
    uint32_t hold_one_in;      /* One block in N comes 20 to 95 ms late; 0: none. */
    int32_t clock_ppm;         /* Error of the clock; positive: it is fast. */
    uint32_t back_ms;          /* The clock is set back once, by this much. */
    uint32_t back_at_us;       /* When that happens, in the line's time. */
    uint16_t max_pause_ms;     /* As in the library's configuration. */
    bool reports_twice;        /* The receiver reports each loss twice. */
} host_config_t;

typedef struct {
    host_config_t config;
    line_t *line;
    random_t *random;
    tmini_timing_t timing;
    tmini_t lidar;
    tmini_point_t points[HOST_POINTS];
    uint8_t rx[HOST_RX_MAX];

    uint64_t now_ns;
    uint64_t begun_us; /* Time of the start command: the line's 0. */
    uint64_t due_ns;   /* Time of the receiver's next action. */
    bool started;
    uint32_t next;      /* The line's next byte. */
    uint32_t fed;       /* Blocks: the next byte to be handed over. */
    uint32_t closed_at; /* Blocks: the first byte that the layer has lost; 0: none. */
    uint64_t block_due_us;
    bool half; /* DMA: pending interrupts. */
    bool full;
    bool idle;
    bool stalled;
    size_t position;  /* DMA: its position. */
    size_t published; /* DMA: the position published last. */

    uint32_t reported;      /* Bytes reported to the library. */
    uint32_t gaps_reported; /* Losses that the receiver has reported. */
    bool was_lost;          /* The library has reported the lidar as lost. */
    uint32_t accesses;
    uint32_t preempted_at; /* The access at which this poll is pre-empted; 0: none. */
    uint32_t reported_before_poll;
} host_t;

/* Sets the library up, and starts a lidar that sends what is on the line. */
void host_begin(host_t *host, const host_config_t *config, line_t *line, random_t *random);

/* One tmini_poll(), while time passes. */
tmini_event_t host_poll(host_t *host);

/* The program fetches the bytes in the layer below, if block_us is 0. */
void host_fetch(host_t *host);

/* True if no byte arrived during the last poll. */
bool host_was_undisturbed(const host_t *host);

void host_rest(host_t *host);        /* The program rests after a poll without an event. */
void host_handle_scan(host_t *host); /* The program works on some scans. */
void host_wait_us(host_t *host, uint64_t us);

/* True if all bytes of the line have arrived, and none is held anywhere. */
bool host_has_received_all(const host_t *host);

#endif
