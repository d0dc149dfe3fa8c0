/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The controller of one trial of the campaign, in virtual time: a receiver of the line's bytes, the
 * library, and a program that polls it and now and then is busy.
 *
 * Receivers: an interrupt for each byte; a task or FIFO below that hands over blocks; circular DMA
 * whose half-transfer, transfer-complete and idle-line interrupts publish its position. Time also
 * passes at each access of an index that both sides share (interrupting_atomic.h), so bytes arrive
 * and interrupts come during tmini_poll(); and a poll may be pre-empted for longer. */

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
    uint32_t poll_us;    /* From one poll that found nothing to the next. */
    uint32_t access_ns;  /* A shared index is accessed as often. */
    uint32_t block_us;   /* A block is handed over as often; 0: by the program, before it polls. */
    bool asks_room;      /* Blocks: what does not fit is kept below, */
    bool reports_held;   /* and reported. */
    bool is_bridged;     /* The program is never busy for longer than the layer has room. */
    uint32_t block_size; /* Bytes that the layer below holds: more are lost. */
    uint32_t handler_us; /* The longest time that the program works on a scan; at least 1 ms. */
    uint32_t handle_one_in;    /* One scan in N is worked on; 0: none. */
    uint32_t preempt_us;       /* The longest time that a poll is pre-empted. */
    uint32_t preempt_one_in;   /* One poll in N is; 0: none. */
    uint32_t stall_laps;       /* DMA goes on for up to N laps while the CPU stands still, */
    uint32_t stall_one_in;     /* in one poll, or pause between polls, of N; 0: never. */
    uint32_t false_gap_one_in; /* One interrupt of DMA in N reports a loss that was none. */
    uint32_t hold_one_in;      /* One block in N comes 20 to 95 ms late; 0: none. */
    int32_t clock_ppm;         /* The clock is too fast by so much. */
    uint32_t back_ms;          /* It is set back by so much once, */
    uint32_t back_at_us;       /* at this time of the line. */
    uint16_t max_pause_ms;     /* As configured. */
    bool tells_twice;          /* Each loss, before the next poll. */
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
    uint64_t begun_us; /* When the start command was sent, by which the line's times count. */
    uint64_t due_ns;   /* When something will happen to the receiver. */
    bool started;
    uint32_t next;      /* The line's next byte. */
    uint32_t fed;       /* Blocks: the next byte to be handed over, */
    uint32_t closed_at; /* and the first one that the layer has lost; 0: none. */
    uint64_t block_due_us;
    bool half; /* DMA: interrupts that are pending. */
    bool full;
    bool idle;
    bool stalled;
    size_t position;  /* Where it writes next, */
    size_t published; /* and how far has been published. */

    uint32_t told;      /* Bytes that the library knows of. */
    uint32_t gaps_told; /* Losses that the receiver has noticed, */
    bool was_lost;      /* and that the library has: the lidar, for a while. */
    uint32_t accesses;
    uint32_t preempted_at; /* The access at which the next pre-emption comes; 0: none. */
    uint32_t told_before_poll;
} host_t;

/* Sets the library up, and starts a lidar that sends what is on the line. */
void host_begin(host_t *host, const host_config_t *config, line_t *line, random_t *random);

/* One tmini_poll(), while time passes. */
tmini_event_t host_poll(host_t *host);

/* The program asks the layer below for what it holds, where nothing else does. */
void host_fetch(host_t *host);

/* Nothing has arrived during the last poll. */
bool host_was_undisturbed(const host_t *host);

/* The program does something else. */
void host_rest(host_t *host);        /* From a poll that found nothing to the next. */
void host_handle_scan(host_t *host); /* Works on a scan, or not. */
void host_wait_us(host_t *host, uint64_t us);

/* All that is on the line has come, and nothing is held anywhere. */
bool host_has_received_all(const host_t *host);

#endif
