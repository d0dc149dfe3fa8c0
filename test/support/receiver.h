/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ring and parser as a program would use them, for tests. After each feed and read the receiver
 * asserts that every byte is accounted for. */

#ifndef RECEIVER_H
#define RECEIVER_H

#include "random.h"
#include "reference_decoder.h"
#include "tmini/parts/tmini_packet.h"
#include "tmini/parts/tmini_parser.h"

typedef struct {
    tmini_ring_t ring;
    tmini_parser_t parser;
    tmini_packet_t packet; /* Valid when receiver_next() has returned a packet. */
    uint8_t *memory;
    size_t size;
    size_t position;   /* Where the DMA writes next. */
    uint32_t received; /* Bytes fed, including refused ones. */
    bool dma;
} receiver_t;

/* `size` is a power of two; the memory is the caller's. */
void receiver_open(receiver_t *receiver, uint8_t *memory, size_t size, uint8_t max_samples);
void receiver_open_dma(receiver_t *receiver, uint8_t *memory, size_t size, uint8_t max_samples);

/* Sets the ring's indices as after `count` bytes. Call it before the first byte. */
void receiver_age(receiver_t *receiver, size_t count);

/* How many bytes may be fed without loss. */
size_t receiver_room(const receiver_t *receiver);

/* Feeds bytes through tmini_ring_write(), or as a DMA that publishes its position every quarter of
 * the ring. */
void receiver_feed(receiver_t *receiver, const uint8_t *bytes, size_t count);

/* tmini_parser_next() and, for a packet, tmini_packet_open(). */
tmini_frame_type_t receiver_next(receiver_t *receiver);

tmini_parser_counters_t receiver_counters(const receiver_t *receiver);

/* Offset of the last delivered frame from the first byte fed. Not valid after an overrun. */
size_t receiver_frame_offset(const receiver_t *receiver);

void receiver_abandon(receiver_t *receiver);

/* Returns the next frame when no more bytes will come: incomplete candidates are abandoned. */
tmini_frame_type_t receiver_next_at_end(receiver_t *receiver);

/* NULL: nothing. */
void receiver_await(receiver_t *receiver, const reference_reply_t *awaited);

/* Asserts that every byte has been counted once or waits. */
void receiver_check_accounts(const receiver_t *receiver);

/* How receiver_compare() feeds the bytes. */
typedef struct {
    size_t chunk;                                    /* Bytes at a time; 0: random, by `random`. */
    random_t *random;                                /* May be NULL if chunk is not 0. */
    const reference_reply_t *awaited;                /* Awaited from the beginning; NULL: none. */
    void (*on_packet)(const tmini_packet_t *packet); /* That was compared. NULL: nothing. */
} receiver_course_t;

/* Feeds the bytes without loss, and asserts that frames, points and counters are those of the
 * reference decoder. Returns the reference's counters. */
reference_counts_t receiver_compare(receiver_t *receiver, const receiver_course_t *course,
                                    const uint8_t *bytes, size_t size);

#endif
