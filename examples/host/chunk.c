/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "chunk.h"

#include <string.h>

/* A head of version 1 is plausible only if its time is below this: 67 s. */
#define PLAUSIBLE_US 0x04000000u

/* While a lidar sends, chunks follow each other within this time: 1 s. */
#define SOON_US 0x00100000u

/* How many plausible heads of version 1 in a row are needed after a good chunk; and how many, with
 * short times, after damage or a long pause. */
#define CHAIN 1u
#define LONG_CHAIN 8u

#define OLD_HEAD_SIZE 6u

#define VERSION_AT 6u /* In the magic bytes. */

typedef struct {
    size_t head_size;
    uint32_t delta_us;
    uint32_t size; /* Of the bytes after the head. */
    bool is_plausible;
} chunk_t;

typedef enum {
    CHUNK_NONE,  /* No chunk begins here, or it is damaged. */
    CHUNK_SHORT, /* Unknown: more bytes are needed. */
    CHUNK_WHOLE,
} chunk_state_t;

static uint32_t number_at(const uint8_t *bytes, unsigned size)
{
    uint32_t number = 0;
    for (unsigned i = 0; i < size; i++) {
        number |= (uint32_t)bytes[i] << (8 * i);
    }
    return number;
}

static chunk_state_t read_new(const uint8_t *bytes, size_t count, chunk_t *chunk)
{
    static const chunk_state_t states[] = {
        [TMINI_TIMED_NOTHING] = CHUNK_NONE,
        [TMINI_TIMED_SHORT] = CHUNK_SHORT,
        [TMINI_TIMED_WHOLE] = CHUNK_WHOLE,
    };
    *chunk = (chunk_t){.head_size = CHUNK_HEAD_SIZE, .size = UINT32_MAX};
    const chunk_state_t state =
        states[tmini_timed_read_head(bytes, count, &chunk->delta_us, &chunk->size)];
    chunk->is_plausible = chunk->size != UINT32_MAX;
    return state;
}

/* Whether `length` heads of version 1 follow each other from here on, each less than `max_us` after
 * the one before. */
static chunk_state_t follow_chain(const uint8_t *bytes, size_t count, bool is_end, unsigned length,
                                  uint32_t max_us)
{
    size_t at = 0;
    for (unsigned i = 0; i < length; i++) {
        if (count < at + OLD_HEAD_SIZE) {
            return is_end ? CHUNK_WHOLE : CHUNK_SHORT;
        }
        const uint32_t size = number_at(bytes + at + 4, 2);
        if (number_at(bytes + at, 4) >= max_us || size == 0 || size > CHUNK_MAX) {
            return CHUNK_NONE;
        }
        at += OLD_HEAD_SIZE + size;
    }
    return CHUNK_WHOLE;
}

/* Whether the chunk that begins here, which may come after any pause, is followed by a long
 * chain. */
static chunk_state_t follow_pause(const uint8_t *bytes, size_t count, bool is_end)
{
    const size_t next = OLD_HEAD_SIZE + number_at(bytes + 4, 2);
    if (next > OLD_HEAD_SIZE + CHUNK_MAX) {
        return CHUNK_NONE;
    }
    if (count < next) {
        return is_end ? CHUNK_NONE : CHUNK_SHORT;
    }
    return follow_chain(bytes + next, count - next, is_end, LONG_CHAIN, SOON_US);
}

/* After a good chunk a head is accepted if plausible heads follow it, or if a long pause and then a
 * long chain follow it. After damage a long chain is needed. */
static chunk_state_t read_old(const uint8_t *bytes, size_t count, bool is_end, bool is_lost,
                              chunk_t *chunk)
{
    if (count < OLD_HEAD_SIZE) {
        return CHUNK_SHORT;
    }
    const uint32_t size = number_at(bytes + 4, 2);
    const size_t next = OLD_HEAD_SIZE + size;
    *chunk = (chunk_t){OLD_HEAD_SIZE, number_at(bytes, 4), size,
                       follow_chain(bytes, count, false, 1, PLAUSIBLE_US) != CHUNK_NONE};
    if (is_lost) {
        return follow_chain(bytes, count, is_end, LONG_CHAIN, SOON_US);
    }
    if (!chunk->is_plausible) {
        return follow_pause(bytes, count, is_end);
    }
    if (count < next + OLD_HEAD_SIZE) {
        return is_end && count >= next ? CHUNK_WHOLE : CHUNK_SHORT;
    }
    const chunk_state_t state =
        follow_chain(bytes + next, count - next, is_end, CHAIN, PLAUSIBLE_US);
    return state != CHUNK_NONE ? state : follow_pause(bytes + next, count - next, is_end);
}

static chunk_state_t read_chunk(const chunks_t *chunks, const uint8_t *bytes, size_t count,
                                bool is_end, chunk_t *chunk)
{
    *chunk = (chunk_t){0};
    return chunks->version == 1 ? read_old(bytes, count, is_end, chunks->is_lost, chunk)
                                : read_new(bytes, count, chunk);
}

bool chunks_begin(chunks_t *chunks, const uint8_t *bytes, size_t count, bool is_end, size_t *head)
{
    chunk_t chunk;
    const chunk_state_t state = read_chunk(chunks, bytes, count, is_end, &chunk);
    if (count == 0 || (state == CHUNK_SHORT && !is_end)) {
        return false;
    }
    const bool was_lost = chunks->is_lost;
    if (state == CHUNK_SHORT && !was_lost && !chunk.is_plausible) {
        *head = count; /* The file ends in the head. */
        return true;
    }
    const bool is_believed = chunk.is_plausible && !was_lost;
    const bool is_good = state == CHUNK_WHOLE || (state == CHUNK_SHORT && is_believed);
    chunks->is_lost = !is_good;
    chunks->damages += (!is_good && !was_lost) || (is_good && chunk.size == 0) ? 1 : 0;
    chunks->time_us += is_good ? chunk.delta_us : 0;
    chunks->left = is_good ? chunk.size : is_believed ? 0 : 1;
    *head = is_good || is_believed ? chunk.head_size : 0; /* The head may be right, and its bytes
                                                           * damaged. */
    return true;
}

unsigned chunk_version(const uint8_t *bytes, size_t count)
{
    return count >= CHUNK_MAGIC_SIZE && memcmp(bytes, tmini_timed_magic, VERSION_AT) == 0 &&
                   bytes[CHUNK_MAGIC_SIZE - 1] == '\n'
               ? bytes[VERSION_AT]
               : 0;
}
