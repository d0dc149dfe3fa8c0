/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The simulated lidar's transmitter: a short queue of frames (a packet with its LastCRC, or a
 * reply), put on the line back to back at 230400 baud 8N1. Part of the simulator; its users
 * need only sim_run_t.
 */

#ifndef SIM_LINE_H
#define SIM_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* LastCRC and a packet of 40 samples. */
#define SIM_FRAME_MAX 131u
#define SIM_LINE_FRAMES 16u

/* One packet as it was sent: the truth that tests compare with. */
typedef struct {
    const uint8_t *bytes; /* LastCRC not included; valid during the call or until the next one */
    uint16_t length;
    uint32_t number;     /* of the packet since sim_init(), from 0 */
    uint32_t revolution; /* start packets so far, this one included */
    bool starts_revolution;
    bool is_of_partial; /* its revolution began elsewhere than at the start packets' place */
    uint64_t position;  /* of its first byte in all that the device has sent */
} sim_packet_t;

/* Bytes of one frame, back to back on the wire. */
typedef struct {
    const uint8_t *bytes;
    size_t length;
    size_t offset; /* of the first of them in its frame */
    size_t frame_length;
    size_t packet_at;           /* where the packet begins in the frame: 1 after a LastCRC */
    const sim_packet_t *packet; /* NULL in a reply */
    uint64_t start_us;          /* when the frame's first bit went on the line */
    bool completes;             /* nothing more comes of this frame, and nothing was cut off */
} sim_run_t;

typedef struct {
    uint64_t start_us;
    uint16_t length;
    uint16_t taken;
    uint8_t packet_at;
    bool is_packet;
    bool cut;
    sim_packet_t packet;
    uint8_t bytes[SIM_FRAME_MAX];
} sim_frame_t;

typedef struct {
    sim_frame_t frames[SIM_LINE_FRAMES];
    uint32_t first;
    uint32_t count;
    uint64_t free_us; /* when the line has sent all that is queued */
    uint64_t sent;    /* bytes taken so far */
    uint32_t lost;    /* frames that found the queue full */
} sim_line_t;

/* A clean frame to fill in, at the queue's end; NULL, counted, when the queue is full. */
sim_frame_t *sim_line_open(sim_line_t *line);

/* Queues the frame just filled in. */
void sim_line_send(sim_line_t *line, uint64_t now_us);

/* The front frame, or NULL. Drops frames that have been taken completely. */
sim_frame_t *sim_line_front(sim_line_t *line);

/* Takes the front frame's bytes that have left by `now_us`, at most `max`; false if there are
 * none. */
bool sim_line_take(sim_line_t *line, uint64_t now_us, size_t max, sim_run_t *run);

/* Power fails: only what has left by now has left. */
void sim_line_cut(sim_line_t *line, uint64_t now_us);

/* When byte `offset` of a frame that began at `start_us` has left completely. */
uint64_t sim_byte_us(uint64_t start_us, size_t offset);

#endif
