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

static const uint8_t marker[2] = {0xA7, 0xC3};

const uint8_t chunk_magic[CHUNK_MAGIC_SIZE] = {0x89, 't', 'm', 'i', 'n', 'i', CHUNK_VERSION, '\n'};

static uint32_t number_at(const uint8_t *bytes, unsigned size)
{
    uint32_t number = 0;
    for (unsigned i = 0; i < size; i++) {
        number |= (uint32_t)bytes[i] << (8 * i);
    }
    return number;
}

/* Four bits at a time. */
static uint16_t crc16(uint16_t crc, const uint8_t *bytes, size_t count)
{
    static const uint16_t table[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5,
                                       0x60C6, 0x70E7, 0x8108, 0x9129, 0xA14A, 0xB16B,
                                       0xC18C, 0xD1AD, 0xE1CE, 0xF1EF};
    for (size_t i = 0; i < count; i++) {
        crc = (uint16_t)(table[(crc >> 12) ^ (bytes[i] >> 4)] ^ (crc << 4));
        crc = (uint16_t)(table[(crc >> 12) ^ (bytes[i] & 0xFu)] ^ (crc << 4));
    }
    return crc;
}

static uint16_t crc_of(const uint8_t *head, const uint8_t *bytes, size_t count)
{
    return crc16(crc16(0xFFFF, head + sizeof marker, 6), bytes, count);
}

void chunk_write_head(uint8_t head[CHUNK_HEAD_SIZE], uint32_t delta_us, const uint8_t *bytes,
                      size_t count)
{
    memcpy(head, marker, sizeof marker);
    for (unsigned i = 0; i < 4; i++) {
        head[2 + i] = (uint8_t)(delta_us >> (8 * i));
    }
    head[6] = (uint8_t)count;
    head[7] = (uint8_t)(count >> 8);
    const uint16_t crc = crc_of(head, bytes, count);
    head[8] = (uint8_t)crc;
    head[9] = (uint8_t)(crc >> 8);
}

static chunk_state_t read_new(const uint8_t *bytes, size_t count, chunk_t *chunk)
{
    if (count < CHUNK_HEAD_SIZE) {
        return CHUNK_SHORT;
    }
    const uint32_t size = number_at(bytes + 6, 2);
    if (memcmp(bytes, marker, sizeof marker) != 0 || size == 0 || size > CHUNK_MAX) {
        return CHUNK_NONE;
    }
    *chunk = (chunk_t){CHUNK_HEAD_SIZE, number_at(bytes + 2, 4), size, true};
    if (count - CHUNK_HEAD_SIZE < size) {
        return CHUNK_SHORT;
    }
    return crc_of(bytes, bytes + CHUNK_HEAD_SIZE, size) == number_at(bytes + 8, 2) ? CHUNK_WHOLE
                                                                                   : CHUNK_NONE;
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

/* The file's last chunk may be incomplete. */
bool chunks_begin(chunks_t *chunks, const uint8_t *bytes, size_t count, bool is_end, size_t *head)
{
    chunk_t chunk;
    const chunk_state_t state = read_chunk(chunks, bytes, count, is_end, &chunk);
    if (count == 0 || (state == CHUNK_SHORT && !is_end)) {
        return false;
    }
    const bool was_lost = chunks->is_lost;
    const bool is_believed = chunk.is_plausible && !was_lost;
    const bool is_good = state == CHUNK_WHOLE || (state == CHUNK_SHORT && is_believed);
    chunks->is_lost = !is_good;
    chunks->damages += !is_good && !was_lost ? 1 : 0;
    chunks->time_us += is_good ? chunk.delta_us : 0;
    chunks->left = is_good ? chunk.size : is_believed ? 0 : 1;
    *head = is_good || is_believed ? chunk.head_size : 0; /* The head may be right, and its bytes
                                                           * damaged. */
    return true;
}

unsigned chunk_version(const uint8_t *bytes, size_t count)
{
    return count >= CHUNK_MAGIC_SIZE && memcmp(bytes, chunk_magic, VERSION_AT) == 0 &&
                   bytes[CHUNK_MAGIC_SIZE - 1] == '\n'
               ? bytes[VERSION_AT]
               : 0;
}
