/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A timed stream: the lidar's bytes with the times at which they came, so that a network which
 * delays them spoils neither scans nor times. It has the format of a timed recording (FILE.tmini):
 * 89 74 6D 69 6E 69 02 0A, and then chunks. Numbers have their least significant byte first.
 *
 *     A7 C3   begins a chunk
 *     4       microseconds since the chunk before, or since the beginning
 *     2       how many bytes follow the head: at most 4096; 0: here bytes were lost
 *     2       CRC-16 (polynomial 0x1021, initial value 0xFFFF) of these six and of the bytes
 *     ...     the bytes
 *
 * This file writes chunks, and reads them while they come. It needs no operating system. */

#ifndef TMINI_TIMED_H
#define TMINI_TIMED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TMINI_TIMED_MAGIC_SIZE 8u /**< Bytes that begin each stream. */
#define TMINI_TIMED_HEAD_SIZE 10u /**< Bytes before those of the lidar in a chunk. */
#define TMINI_TIMED_MAX 4096u     /**< The most bytes of the lidar in a chunk. */

/** Chunks that come later than others by up to this much keep their times. While nothing comes, the
 * clock stands still for this long, because late chunks may follow. */
#define TMINI_TIMED_PATIENCE_US 600000u

/** The beginning of each timed stream. */
extern const uint8_t tmini_timed_magic[TMINI_TIMED_MAGIC_SIZE];

/** Fills in the head of a chunk of `count` bytes. */
void tmini_timed_write_head(uint8_t head[TMINI_TIMED_HEAD_SIZE], uint32_t delta_us,
                            const uint8_t *bytes, size_t count);

/** What begins at a place in a stream. */
typedef enum {
    TMINI_TIMED_NOTHING, /**< No chunk, or a damaged one. */
    TMINI_TIMED_SHORT,   /**< Unknown: more bytes are needed. */
    TMINI_TIMED_WHOLE,   /**< A chunk. */
} tmini_timed_found_t;

/** Reads a chunk's head, which is followed by `*size` bytes of the lidar. Both are set if there may
 * be a chunk, even if it is not whole. */
tmini_timed_found_t tmini_timed_read_head(const uint8_t *bytes, size_t count, uint32_t *delta_us,
                                          uint32_t *size);

/** What kind of stream comes. */
typedef enum {
    TMINI_TIMED_UNKNOWN, /**< Its first bytes have not come yet. */
    TMINI_TIMED_RAW,     /**< The lidar's bytes, without times. */
    TMINI_TIMED_YES,     /**< A timed stream. */
} tmini_timed_kind_t;

/** A stream that is being received. All 0: nothing has been received. Its members are private,
 * except `kind`. */
typedef struct {
    tmini_timed_kind_t kind; /**< What kind of stream comes. */
    /** @cond private */
    bool is_anchored;
    bool is_gap;        /* Bytes were lost before the next ones. */
    int64_t sent_us;    /* The sender's clock at the latest chunk. */
    int64_t offset_us;  /* From the sender's clock to the receiver's. */
    int64_t clock_us;   /* When the latest chunk came, by the receiver's clock. */
    int64_t settled_us; /* When the offset was computed. */
    size_t at;          /* The bytes before have been taken. */
    size_t count;
    uint32_t left; /* Of the latest chunk. */
    uint8_t bytes[TMINI_TIMED_HEAD_SIZE + TMINI_TIMED_MAX];
    /** @endcond */
} tmini_timed_t;

/** A connection has been made: another stream begins. */
void tmini_timed_begin(tmini_timed_t *timed);

/** Where to put received bytes, and how many; then call tmini_timed_put(). There is always room
 * when tmini_timed_take() has returned 0. */
uint8_t *tmini_timed_room(tmini_timed_t *timed, size_t *room);

/** `count` bytes were put where tmini_timed_room() said. */
void tmini_timed_put(tmini_timed_t *timed, size_t count);

/** Returns how many of the lidar's bytes come next, at most `most`, and where they are; all of them
 * came at the time of tmini_timed_now_us(). Returns 0 if more must be received, or if bytes were
 * lost here: then *is_gap is true, and the next bytes may be there already. `now_us`: the
 * receiver's clock, which must never go back. */
size_t tmini_timed_take(tmini_timed_t *timed, int64_t now_us, size_t most, const uint8_t **bytes,
                        bool *is_gap);

/** How many bytes of the latest chunk have not been taken. */
size_t tmini_timed_left(const tmini_timed_t *timed);

/** The stream's time, for the driver: the sender's clock, moved to the receiver's by the smallest
 * delay so far. It is behind the receiver's clock by TMINI_TIMED_PATIENCE_US at most, and never
 * goes back. Without a timed stream it is the receiver's clock. */
int64_t tmini_timed_now_us(const tmini_timed_t *timed, int64_t now_us);

#ifdef __cplusplus
}
#endif

#endif
