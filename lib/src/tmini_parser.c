/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_parser.h"

#include "tmini_packet_header.h"

enum verdict { USELESS, INCOMPLETE, COMPLETE };

/* The start signs (sections 4 and 5). */
enum { PACKET_FIRST = 0xAA, PACKET_SECOND = 0x55, REPLY_FIRST = 0xA5, REPLY_SECOND = 0x5A };

/* Offsets in a reply's header (section 4); a packet's are in tmini_packet_header.h. */
enum { REPLY_LENGTH = 2, REPLY_MODE_AND_LENGTH = 5, REPLY_TYPE = 6 };

/* True if the candidate has `count` bytes; if not, it need not be looked at again before it has. */
static bool has(tmini_parser_t *parser, size_t unread, size_t count)
{
    parser->need = (uint16_t)count;
    return unread >= count;
}

static bool packet_header_is_plausible(const tmini_parser_t *parser)
{
    const uint8_t *const header = parser->header;
    const bool is_start = (header[CT] & 1u) != 0;
    const bool check_bits = (header[FSA] & header[LSA] & 1u) != 0;
    return check_bits && header[LSN] >= 1 && header[LSN] <= (is_start ? 1 : parser->max_samples);
}

/* XORs the candidate's 16-bit words: those of the header, and two for each sample. The checksum
 * itself is among them, so that nothing remains if it is right. */
static bool checksum_matches(const tmini_parser_t *parser)
{
    unsigned sum = 0;
    for (size_t i = 0; i < TMINI_PACKET_HEADER_SIZE; i += 2) {
        sum ^= parser->header[i] | (unsigned)parser->header[i + 1] << 8;
    }
    const size_t samples = parser->header[LSN];
    for (size_t done = 0; done < samples;) {
        uint8_t joined[TMINI_SAMPLE_SIZE];
        size_t count = samples - done;
        const uint8_t *sample =
            tmini_ring_samples(parser->ring, TMINI_PACKET_SIZE_MAX(done), &count, joined);
        done += count;
        const uint8_t *const end = &sample[TMINI_SAMPLE_SIZE * count];
        for (; sample != end; sample += TMINI_SAMPLE_SIZE) {
            sum ^= sample[0] ^ (sample[1] | (unsigned)sample[2] << 8);
        }
    }
    return sum == 0;
}

/* Of the length only the lowest byte can be other than 0: no reply is longer than 20 bytes. When
 * continuous it has no meaning. */
static bool reply_has_awaited_shape(const tmini_parser_t *parser)
{
    const uint8_t *const header = parser->header;
    const tmini_reply_shape_t *const awaited = &parser->awaited;
    const uint8_t mode_and_length = header[REPLY_MODE_AND_LENGTH];
    if (header[REPLY_TYPE] != awaited->type || mode_and_length >> 6 != awaited->mode) {
        return false;
    }
    return awaited->mode == TMINI_REPLY_MODE_CONTINUOUS ||
           (header[REPLY_LENGTH] == awaited->length &&
            (header[REPLY_LENGTH + 1] | header[REPLY_LENGTH + 2] | mode_and_length) == 0);
}

/* What the ring's oldest bytes are. */
static enum verdict judge(tmini_parser_t *parser, size_t unread)
{
    uint8_t sign[2]; /* The second byte has perhaps not come yet. */
    tmini_ring_copy(parser->ring, 0, sign, sizeof sign);
    const bool is_packet = sign[0] == PACKET_FIRST;
    if (!is_packet && !(parser->awaiting && sign[0] == REPLY_FIRST)) {
        return USELESS;
    }
    if (!has(parser, unread, 2)) {
        return INCOMPLETE;
    }
    if (sign[1] != (is_packet ? PACKET_SECOND : REPLY_SECOND)) {
        return USELESS;
    }
    const size_t header_size = is_packet ? TMINI_PACKET_HEADER_SIZE : TMINI_REPLY_HEADER_SIZE;
    if (!has(parser, unread, header_size)) {
        return INCOMPLETE;
    }
    tmini_ring_copy(parser->ring, 0, parser->header, header_size);
    if (!(is_packet ? packet_header_is_plausible(parser) : reply_has_awaited_shape(parser))) {
        return USELESS;
    }
    if (!has(parser, unread,
             is_packet ? TMINI_PACKET_SIZE_MAX(parser->header[LSN])
                       : TMINI_REPLY_HEADER_SIZE + parser->awaited.length)) {
        return INCOMPLETE;
    }
    if (is_packet && !checksum_matches(parser)) {
        parser->counters.checksum_errors++;
        return USELESS;
    }
    return COMPLETE;
}

static void skip_byte(tmini_parser_t *parser)
{
    parser->stray = tmini_ring_peek(parser->ring, 0);
    tmini_ring_discard(parser->ring, 1);
    parser->need = 1;
    parser->counters.bytes_skipped++;
    if (parser->gap < UINT16_MAX) {
        parser->gap++;
    }
}

/* Gives the frame delivered last back to the producer. */
static void release_frame(tmini_parser_t *parser)
{
    if (parser->frame > 0) {
        tmini_ring_discard(parser->ring, parser->frame);
        parser->frame = 0;
        parser->gap = 0;
    }
}

/* Bytes are refused when the ring is full: they are missing one ring's size ahead of its tail. */
static void count_refused(tmini_parser_t *parser)
{
    const tmini_ring_t *const ring = parser->ring;
    const size_t refused = tmini_ring_refused(ring);
    if (refused != parser->refused) {
        parser->counters.bytes_overrun += (uint32_t)(refused - parser->refused);
        parser->refused = refused;
        parser->hole = ring->tail + ring->mask + 1;
        parser->hole_ahead = true;
    }
}

/* The unread bytes, less those that DMA may have overwritten: they are dropped. */
static size_t intact_bytes(tmini_parser_t *parser)
{
    tmini_ring_t *const ring = parser->ring;
    const size_t unread = tmini_ring_unread(ring);
    if (unread <= ring->window) {
        return unread;
    }
    const size_t lost = unread - ring->window;
    tmini_ring_discard(ring, lost);
    parser->counters.bytes_overrun += (uint32_t)lost;
    parser->gap = UINT16_MAX;
    parser->need = 1;
    return ring->window;
}

/* The complete candidate becomes a frame: `need` has come to its size. */
static tmini_frame_t deliver(tmini_parser_t *parser)
{
    parser->frame = parser->need;
    parser->need = 1;
    if (parser->hole_ahead && parser->ring->tail - parser->hole <= SIZE_MAX / 2) {
        parser->hole_ahead = false;
        parser->gap = UINT16_MAX;
    }
    if (parser->header[0] == PACKET_FIRST) {
        parser->counters.packets++;
        parser->counters.bytes_in_packets += parser->frame;
        return TMINI_FRAME_PACKET;
    }
    parser->awaiting = false;
    parser->counters.bytes_in_replies += parser->frame;
    return TMINI_FRAME_REPLY;
}

tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples)
{
    if (parser == NULL || ring == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *parser = (tmini_parser_t){.ring = ring, .need = 1, .max_samples = max_samples};
    if (max_samples == 0) {
        parser->max_samples = TMINI_MAX_SAMPLES_DEFAULT;
    }
    const bool fits = ring->window >= TMINI_PACKET_SIZE_MAX(parser->max_samples) &&
                      ring->window >= TMINI_REPLY_SIZE_MAX;
    return fits ? TMINI_OK : TMINI_ERROR_ARGUMENT;
}

tmini_frame_t tmini_parser_next(tmini_parser_t *parser)
{
    count_refused(parser);
    release_frame(parser);
    for (;;) {
        const size_t unread = intact_bytes(parser);
        if (unread < parser->need) {
            return TMINI_FRAME_NONE;
        }
        const enum verdict verdict = judge(parser, unread);
        if (verdict == INCOMPLETE) {
            return TMINI_FRAME_NONE;
        }
        if (verdict == USELESS) {
            skip_byte(parser);
        } else if (tmini_parser_frame_intact(parser)) {
            return deliver(parser);
        }
    }
}

bool tmini_parser_frame_intact(const tmini_parser_t *parser)
{
    return tmini_ring_intact(parser->ring);
}

void tmini_parser_await(tmini_parser_t *parser, const tmini_reply_shape_t *shape)
{
    parser->need = 1; /* What the candidate may be has changed: look at it again. */
    parser->awaiting = shape != NULL;
    if (shape != NULL) {
        parser->awaited = *shape;
    }
}

void tmini_parser_reply_content(const tmini_parser_t *parser, uint8_t *content, size_t count)
{
    tmini_ring_copy(parser->ring, TMINI_REPLY_HEADER_SIZE, content, count);
}

size_t tmini_parser_pending(const tmini_parser_t *parser)
{
    return tmini_ring_unread(parser->ring) - parser->frame;
}

void tmini_parser_abandon(tmini_parser_t *parser)
{
    const size_t unread = tmini_ring_unread(parser->ring);
    if (unread > 0 && unread < parser->need) {
        skip_byte(parser);
    }
}
