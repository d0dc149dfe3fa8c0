/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_timed.h"

#include <string.h>

/* A chunk that seems to be later than this is not: the sender's clock has jumped. */
#define JUMP_US 5000000

/* The smallest delay grows by this part of the time that passes, so that a sender whose clock is
 * slow by up to 244 ppm is followed. */
#define LEAK 4096

static const uint8_t marker[2] = {0xA7, 0xC3};

const uint8_t tmini_timed_magic[TMINI_TIMED_MAGIC_SIZE] = {0x89, 't', 'm', 'i', 'n', 'i', 2, '\n'};

/* ------------------------------------------------------------------------------------- chunks */

static uint32_t number_at(const uint8_t *bytes, unsigned size)
{
    uint32_t number = 0;
    for (unsigned i = 0; i < size; i++) {
        number |= (uint32_t)bytes[i] << (8 * i);
    }
    return number;
}

static void put_number(uint8_t *bytes, unsigned size, uint32_t number)
{
    for (unsigned i = 0; i < size; i++) {
        bytes[i] = (uint8_t)(number >> (8 * i));
    }
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

void tmini_timed_write_head(uint8_t head[TMINI_TIMED_HEAD_SIZE], uint32_t delta_us,
                            const uint8_t *bytes, size_t count)
{
    memcpy(head, marker, sizeof marker);
    put_number(head + 2, 4, delta_us);
    put_number(head + 6, 2, (uint32_t)count);
    put_number(head + 8, 2, crc_of(head, bytes, count));
}

tmini_timed_found_t tmini_timed_read_head(const uint8_t *bytes, size_t count, uint32_t *delta_us,
                                          uint32_t *size)
{
    const size_t seen = count < sizeof marker ? count : sizeof marker;
    if (memcmp(bytes, marker, seen) != 0) {
        return TMINI_TIMED_NOTHING;
    }
    if (count < TMINI_TIMED_HEAD_SIZE) {
        return TMINI_TIMED_SHORT;
    }
    const uint32_t length = number_at(bytes + 6, 2);
    if (length > TMINI_TIMED_MAX) {
        return TMINI_TIMED_NOTHING;
    }
    *delta_us = number_at(bytes + 2, 4);
    *size = length;
    if (count - TMINI_TIMED_HEAD_SIZE < length) {
        return TMINI_TIMED_SHORT;
    }
    return crc_of(bytes, bytes + TMINI_TIMED_HEAD_SIZE, length) == number_at(bytes + 8, 2)
               ? TMINI_TIMED_WHOLE
               : TMINI_TIMED_NOTHING;
}

/* -------------------------------------------------------------------------------------- clock */

int64_t tmini_timed_now_us(const tmini_timed_t *timed, int64_t now_us)
{
    const int64_t least_us = now_us - TMINI_TIMED_PATIENCE_US;
    if (!timed->is_anchored) {
        return now_us;
    }
    return timed->clock_us > least_us ? timed->clock_us : least_us;
}

/* A chunk has come, `delta_us` after the one before by the sender's clock. If its delay is smaller
 * than each so far, it is the smallest from now on. */
static void settle(tmini_timed_t *timed, uint32_t delta_us, int64_t now_us)
{
    const int64_t leak_us = (now_us - timed->settled_us) / LEAK;
    timed->sent_us += delta_us;
    const int64_t late_us = now_us - (timed->sent_us + timed->offset_us);
    const bool is_new = !timed->is_anchored || late_us > JUMP_US;
    timed->offset_us += is_new || late_us < leak_us ? late_us : leak_us;
    timed->settled_us = now_us;
    timed->clock_us = timed->sent_us + timed->offset_us;
    timed->is_anchored = true;
}

/* ------------------------------------------------------------------------------------- stream */

void tmini_timed_begin(tmini_timed_t *timed)
{
    timed->kind = TMINI_TIMED_UNKNOWN;
    timed->is_anchored = false;
    timed->is_gap = false;
    timed->sent_us = 0;
    timed->at = 0;
    timed->count = 0;
    timed->left = 0;
}

uint8_t *tmini_timed_room(tmini_timed_t *timed, size_t *room)
{
    timed->count -= timed->at;
    memmove(timed->bytes, timed->bytes + timed->at, timed->count);
    timed->at = 0;
    *room = sizeof timed->bytes - timed->count;
    return timed->bytes + timed->count;
}

/* What the first bytes show. Until then none is taken. */
static void judge(tmini_timed_t *timed)
{
    const size_t seen =
        timed->count < TMINI_TIMED_MAGIC_SIZE ? timed->count : TMINI_TIMED_MAGIC_SIZE;
    if (memcmp(timed->bytes, tmini_timed_magic, seen) != 0) {
        timed->kind = TMINI_TIMED_RAW;
    } else if (seen == TMINI_TIMED_MAGIC_SIZE) {
        timed->kind = TMINI_TIMED_YES;
        timed->at = seen;
    }
}

void tmini_timed_put(tmini_timed_t *timed, size_t count)
{
    timed->count += count;
    if (timed->kind == TMINI_TIMED_UNKNOWN) {
        judge(timed);
    }
}

/* Goes on to the next chunk; false if more bytes are needed, or bytes were lost. What is no chunk
 * is skipped. */
static bool find_chunk(tmini_timed_t *timed, int64_t now_us)
{
    while (timed->left == 0 && timed->at < timed->count) {
        uint32_t delta_us = 0;
        uint32_t size = 0;
        const tmini_timed_found_t found = tmini_timed_read_head(
            timed->bytes + timed->at, timed->count - timed->at, &delta_us, &size);
        if (found == TMINI_TIMED_SHORT) {
            return false;
        }
        if (found == TMINI_TIMED_WHOLE) {
            settle(timed, delta_us, now_us);
            timed->left = size;
        }
        timed->is_gap |= found == TMINI_TIMED_NOTHING || size == 0;
        timed->at += found == TMINI_TIMED_WHOLE ? TMINI_TIMED_HEAD_SIZE : 1;
    }
    return timed->left > 0;
}

static size_t available(tmini_timed_t *timed, int64_t now_us)
{
    switch (timed->kind) {
    case TMINI_TIMED_RAW:
        return timed->count - timed->at;
    case TMINI_TIMED_YES:
        return find_chunk(timed, now_us) ? timed->left : 0;
    default:
        return 0;
    }
}

size_t tmini_timed_take(tmini_timed_t *timed, int64_t now_us, size_t most, const uint8_t **bytes,
                        bool *is_gap)
{
    size_t count = available(timed, now_us);
    *is_gap = timed->is_gap;
    timed->is_gap = false;
    if (*is_gap) {
        return 0;
    }
    count = count < most ? count : most;
    *bytes = timed->bytes + timed->at;
    timed->at += count;
    timed->left -= timed->kind == TMINI_TIMED_YES ? (uint32_t)count : 0;
    return count;
}

size_t tmini_timed_left(const tmini_timed_t *timed)
{
    return timed->left;
}
