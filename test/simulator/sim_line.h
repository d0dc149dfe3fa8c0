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

/* LastCRC and a packet of 40 samples, of up to four bytes. */
#define SIM_FRAME_MAX 171u
#define SIM_LINE_FRAMES 16u

/* One packet as it was sent: the truth that tests compare with. */
typedef struct {
    const uint8_t *bytes; /* without LastCRC; valid during the callback or until the next call */
    uint16_t length;
    uint32_t number;     /* of the packet since sim_init(), from 0 */
    uint32_t revolution; /* start packets so far, this one included */
    bool starts_revolution;
    bool is_of_partial; /* its revolution did not begin at the start packet's usual angle */
} sim_packet_t;

/* Bytes of one frame, back to back on the wire. */
typedef struct {
    const uint8_t *bytes;
    size_t length;
    size_t offset; /* of the first byte in its frame */
    size_t frame_length;
    size_t packet_at;           /* where the packet begins in the frame: 1 after a LastCRC */
    const sim_packet_t *packet; /* NULL in a reply */
    uint64_t start_us;          /* when the frame's first bit went on the line */
    bool completes;             /* the frame ends with this run and was not cut off */
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
    uint64_t free_us; /* when all queued bytes have been sent */
    uint32_t lost;    /* frames that found the queue full */
} sim_line_t;

/* Returns an empty frame at the queue's end to fill in. If the queue is full, counts a lost frame
 * and returns NULL. */
sim_frame_t *sim_line_open(sim_line_t *line);

/* Queues the frame just filled in. */
void sim_line_send(sim_line_t *line, uint64_t now_us);

/* The first frame of the queue, or NULL. Removes frames that have been taken completely. */
sim_frame_t *sim_line_front(sim_line_t *line);

/* Takes at most `max` of the first frame's bytes that have left by `now_us`; false if there are
 * none. */
bool sim_line_take(sim_line_t *line, uint64_t now_us, size_t max, sim_run_t *run);

/* Power fails: bytes that have not left by now are lost. */
void sim_line_cut(sim_line_t *line, uint64_t now_us);

/* When byte `offset` of a frame that began at `start_us` has left completely. */
uint64_t sim_byte_us(uint64_t start_us, size_t offset);

#endif
