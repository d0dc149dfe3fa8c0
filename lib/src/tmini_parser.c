/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_parser.h"

#include "tmini_packet_header.h"

/* The start signs (sections 4 and 5): in both, the second byte is the first one, inverted. */
enum { PACKET_FIRST = 0xAA, REPLY_FIRST = 0xA5, INVERTED = 0xFF };

/* Offsets in a reply's header after the start sign (section 4); a packet's are in
 * tmini_packet_header.h. */
enum { REPLY_LENGTH = 0, REPLY_TYPE = 4 };

/* A reply's length has 30 bits, its mode the other two of a word (section 4). */
#define LENGTH_BITS 30
#define LENGTH_MASK (((uint32_t)1 << LENGTH_BITS) - 1)

/* The checksum is computed by words of four bytes. A sample has three bytes, so four samples are
 * three words. */
#define BLOCK_SAMPLES 4u
#define BLOCK_SIZE (BLOCK_SAMPLES * TMINI_SAMPLE_SIZE)

/* -------------------------------------------------------------------------------- the checksum */

/* The part of the checksum that comes from `count` samples (at least one), in the lowest 16 bits:
 * S1 and S2 go into the low byte, S3 into the high byte (section 5). */
static unsigned xor_samples(const uint8_t *sample, size_t count)
{
    unsigned sum = 0;
    do {
        sum ^= sample[0] ^ sample[1] ^ (unsigned)sample[2] << 8;
        sample += TMINI_SAMPLE_SIZE;
    } while (--count > 0);
    return sum;
}

/* The same for `blocks` of four samples. XORing whole words gives the same result as XORing their
 * bytes one by one. S3 is the third byte of the first word, the second byte of the second, the
 * first and last of the third. */
static unsigned xor_blocks(const uint8_t *sample, size_t blocks)
{
    uint32_t first = 0;
    uint32_t second = 0;
    uint32_t third = 0;
    TMINI_UNROLL
    do {
        first ^= tmini_word(sample);
        second ^= tmini_word(sample + 4);
        third ^= tmini_word(sample + 8);
        sample += BLOCK_SIZE;
    } while (--blocks > 0);
    first ^= second << 8 | second >> 24;
    const uint32_t low = (first ^ first >> 24 ^ third >> 8) & 0xFFu;
    return (unsigned)(low ^ first >> 8 ^ third << 8 ^ third >> 16);
}

/* The same for contiguous samples, most of them by blocks. If the address is `ahead` bytes above a
 * multiple of 4, `ahead` samples of three bytes lead to the next multiple. */
static unsigned xor_piece(const uint8_t *sample, size_t count)
{
    unsigned sum = 0;
    const size_t ahead = (uintptr_t)sample & (TMINI_WORD_ALIGNMENT - 1);
    if (ahead > 0 && count > ahead) {
        sum = xor_samples(sample, ahead);
        sample += TMINI_SAMPLE_SIZE * ahead;
        count -= ahead;
    }
    if (count >= BLOCK_SAMPLES) {
        sum ^= xor_blocks(sample, count / BLOCK_SAMPLES);
        sample += BLOCK_SIZE * (count / BLOCK_SAMPLES);
        count %= BLOCK_SAMPLES;
    }
    return count > 0 ? sum ^ xor_samples(sample, count) : sum;
}

/* The header is read by words, too. */
typedef char
    header_is_aligned[offsetof(tmini_frame_t, header) % TMINI_WORD_ALIGNMENT == 0 ? 1 : -1];

/* XORs all 16-bit words of the candidate after the start sign, including the checksum: if that is
 * right, the result is the start sign. */
static bool checksum_matches(const tmini_frame_t *frame)
{
    const uint32_t words = tmini_word(frame->header) ^ tmini_word(&frame->header[4]);
    unsigned sum = (unsigned)(words ^ words >> 16);
    size_t left = frame->header[LSN];
    while (left > 0) {
        const size_t done = frame->header[LSN] - left;
        uint8_t joined[TMINI_SAMPLE_SIZE];
        size_t count = left;
        const uint8_t *const samples = tmini_frame_samples(frame, done, &count, joined);
        sum ^= xor_piece(samples, count);
        left -= count;
    }
    return (sum & 0xFFFFu) == (PACKET_FIRST | (PACKET_FIRST ^ INVERTED) << 8);
}

/* --------------------------------------------------------------------------------- candidates */

static bool packet_header_is_plausible(const tmini_parser_t *parser)
{
    const uint8_t *const header = parser->frame.header;
    const bool is_start = (header[CT] & 1u) != 0;
    const bool check_bits = (header[FSA] & header[LSA] & 1u) != 0;
    return check_bits && header[LSN] >= 1 && header[LSN] <= (is_start ? 1 : parser->max_samples);
}

/* A continuous reply's length has no meaning. */
static bool reply_header_is_awaited(const tmini_parser_t *parser)
{
    const uint8_t *const header = parser->frame.header;
    const tmini_reply_header_t *const awaited = &parser->awaited;
    const uint32_t length_and_mode = tmini_word(&header[REPLY_LENGTH]);
    if (header[REPLY_TYPE] != awaited->type || length_and_mode >> LENGTH_BITS != awaited->mode) {
        return false;
    }
    return awaited->mode == TMINI_REPLY_MODE_CONTINUOUS ||
           (length_and_mode & LENGTH_MASK) == awaited->length;
}

/* True if neither a packet nor the awaited reply can begin with this byte. */
static bool begins_no_frame(const tmini_parser_t *parser, uint8_t byte)
{
    return byte != PACKET_FIRST && !(parser->awaiting && byte == REPLY_FIRST);
}

/* Copies the bytes after the start sign. For a reply this is slightly more than its header. */
static void read_header(tmini_frame_t *frame)
{
    size_t count = sizeof frame->header;
    const uint8_t *const piece = tmini_ring_piece(frame->ring, TMINI_START_SIGN_SIZE, &count);
    if (count == sizeof frame->header) {
        TMINI_COPY(frame->header, piece, sizeof frame->header);
    } else {
        tmini_ring_copy(frame->ring, TMINI_START_SIGN_SIZE, frame->header, sizeof frame->header);
    }
}

static bool take_packet_header(tmini_parser_t *parser)
{
    if (!packet_header_is_plausible(parser)) {
        return false;
    }
    parser->kind = TMINI_FRAME_PACKET;
    parser->need = (uint16_t)TMINI_PACKET_SIZE(parser->frame.header[LSN]);
    return true;
}

static bool take_reply_header(tmini_parser_t *parser)
{
    if (!reply_header_is_awaited(parser)) {
        return false;
    }
    parser->kind = TMINI_FRAME_REPLY;
    parser->need = (uint16_t)(TMINI_REPLY_HEADER_SIZE + parser->awaited.length);
    return true;
}

/* Judges the candidate's start sign, then its header, as soon as these bytes have come, and sets
 * how many bytes it needs before more can be said. False: no frame begins here. */
static bool judge_header(tmini_parser_t *parser, size_t unread)
{
    const tmini_ring_t *const ring = parser->frame.ring;
    const uint8_t first = tmini_ring_peek(ring, 0);
    const bool is_packet = first == PACKET_FIRST;
    const uint16_t size = is_packet ? TMINI_PACKET_HEADER_SIZE : TMINI_REPLY_HEADER_SIZE;
    if (begins_no_frame(parser, first)) {
        return false;
    }
    if (unread < 2) {
        parser->need = 2;
        return true;
    }
    if ((first ^ tmini_ring_peek(ring, 1)) != INVERTED) {
        return false;
    }
    if (unread < size) {
        parser->need = size;
        return true;
    }
    read_header(&parser->frame);
    return is_packet ? take_packet_header(parser) : take_reply_header(parser);
}

/* Judges the ring's oldest bytes. If `need` of them have come, they are a frame. False: no frame
 * begins here. */
static bool judge(tmini_parser_t *parser, size_t unread)
{
    if (parser->kind == TMINI_FRAME_NONE && !judge_header(parser, unread)) {
        return false;
    }
    if (parser->kind == TMINI_FRAME_PACKET && unread >= parser->need &&
        !checksum_matches(&parser->frame)) {
        parser->counters.checksum_errors++;
        parser->effort = (uint16_t)(parser->effort + parser->need);
        return false;
    }
    return true;
}

/* The next candidate is examined from its first byte. */
static void begin_candidate(tmini_parser_t *parser)
{
    parser->need = 1;
    parser->kind = TMINI_FRAME_NONE;
}

/* -------------------------------------------------------------------- skipping and losing bytes */

/* Skips the oldest `count` bytes (at least one). */
static void skip_bytes(tmini_parser_t *parser, size_t count)
{
    tmini_frame_t *const frame = &parser->frame;
    const uint32_t gap = frame->gap + (uint32_t)count;
    frame->last_skipped = tmini_ring_peek(frame->ring, count - 1);
    tmini_ring_discard(frame->ring, count);
    frame->gap = (uint16_t)(gap < TMINI_GAP_UNKNOWN ? gap : TMINI_GAP_UNKNOWN);
    parser->counters.bytes_skipped += (uint32_t)count;
    begin_candidate(parser);
}

/* Skips the candidate's first byte, and the bytes after it that cannot begin a frame, as far as
 * they are contiguous in memory and effort is left. */
static void skip(tmini_parser_t *parser, size_t unread)
{
    const size_t done = parser->effort;
    const size_t left = done < TMINI_PARSER_EFFORT ? TMINI_PARSER_EFFORT - done : 1;
    size_t count = unread < left ? unread : left;
    const uint8_t *const bytes = tmini_ring_piece(parser->frame.ring, 0, &count);
    size_t skipped = 1;
    while (skipped < count && begins_no_frame(parser, bytes[skipped])) {
        skipped++;
    }
    skip_bytes(parser, skipped);
    parser->effort = (uint16_t)(parser->effort + skipped + TMINI_CANDIDATE_EFFORT);
}

/* DMA is `ahead` of the tail by more than the window: drops the bytes that it may have overwritten.
 * If a lap was reported that perhaps never happened (tmini_ring_gap()), bytes that may have been
 * read before are dropped too: those that are kept are certainly new. */
static void drop_overwritten(tmini_parser_t *parser, size_t ahead)
{
    tmini_ring_t *const ring = parser->frame.ring;
    const size_t fresh = ahead & (ring->size - 1);
    const size_t kept = fresh < ring->window ? fresh : ring->window;
    const size_t lost = ahead - kept;
    tmini_ring_discard(ring, lost);
    begin_candidate(parser);
    parser->counters.bytes_overrun += (uint32_t)lost;
    parser->frame.gap = TMINI_GAP_UNKNOWN;
}

/* A closed ring holds `unread` bytes; after them, bytes have been lost. The candidate, which needs
 * more, is given up. If there is none, the ring is opened again. */
static void pass_lost_bytes(tmini_parser_t *parser, size_t unread)
{
    if (unread == 0) {
        parser->frame.gap = TMINI_GAP_UNKNOWN;
        tmini_ring_open(parser->frame.ring);
    } else {
        skip(parser, unread);
    }
}

/* ---------------------------------------------------------------------------- public functions */

/* Gives the memory of the frame delivered last back to the producer. */
static void release_frame(tmini_parser_t *parser)
{
    tmini_frame_t *const frame = &parser->frame;
    if (frame->size > 0) {
        tmini_ring_discard(frame->ring, frame->size);
        frame->size = 0;
        frame->gap = 0;
    }
}

static tmini_frame_type_t deliver(tmini_parser_t *parser)
{
    tmini_frame_t *const frame = &parser->frame;
    frame->size = parser->need;
    frame->checksum_errors = (uint16_t)parser->counters.checksum_errors;
    parser->effort = (uint16_t)(parser->effort + frame->size);
    const tmini_frame_type_t type = (tmini_frame_type_t)parser->kind;
    begin_candidate(parser);
    if (type == TMINI_FRAME_PACKET) {
        parser->counters.packets++;
        parser->counters.bytes_in_packets += frame->size;
    } else {
        parser->awaiting = false;
        parser->counters.bytes_in_replies += frame->size;
    }
    return type;
}

tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples)
{
    if (parser == NULL || ring == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *parser = (tmini_parser_t){.frame.ring = ring, .need = 1, .max_samples = max_samples};
    if (max_samples == 0) {
        parser->max_samples = TMINI_MAX_SAMPLES_DEFAULT;
    }
    const bool fits = ring->window >= TMINI_PACKET_SIZE(parser->max_samples) &&
                      ring->window >= TMINI_REPLY_SIZE_MAX;
    return fits ? TMINI_OK : TMINI_ERROR_ARGUMENT;
}

tmini_frame_type_t tmini_parser_next_after(tmini_parser_t *parser, size_t effort)
{
    parser->effort = (uint16_t)effort;
    release_frame(parser);
    do {
        const size_t ahead = tmini_ring_ahead(parser->frame.ring);
        if (ahead < parser->need) {
            return TMINI_FRAME_NONE;
        }
        size_t unread = ahead;
        if (ahead > parser->frame.ring->window) {
            if (tmini_ring_is_dma(parser->frame.ring)) {
                drop_overwritten(parser, ahead);
                continue;
            }
            unread = ahead - TMINI_RING_CLOSED;
            if (unread < parser->need) {
                pass_lost_bytes(parser, unread);
                continue;
            }
        }
        if (!judge(parser, unread)) {
            skip(parser, unread);
        } else if (unread >= parser->need && tmini_frame_intact(&parser->frame)) {
            return deliver(parser);
        }
    } while (parser->effort < TMINI_PARSER_EFFORT);
    return TMINI_FRAME_MORE;
}

tmini_status_t tmini_parser_await(tmini_parser_t *parser, const tmini_reply_header_t *header)
{
    begin_candidate(parser); /* The candidate may now be something else: examine it again. */
    parser->awaiting = false;
    if (header == NULL) {
        return TMINI_OK;
    }
    if (TMINI_REPLY_HEADER_SIZE + (size_t)header->length > parser->frame.ring->window) {
        return TMINI_ERROR_ARGUMENT;
    }
    parser->awaiting = true;
    parser->awaited = *header;
    return TMINI_OK;
}

size_t tmini_parser_pending(const tmini_parser_t *parser)
{
    return tmini_ring_unread(parser->frame.ring) - parser->frame.size;
}

void tmini_parser_counters(const tmini_parser_t *parser, tmini_parser_counters_t *counters)
{
    *counters = parser->counters;
    counters->bytes_overrun += (uint32_t)tmini_ring_overrun(parser->frame.ring);
}

void tmini_parser_skip_all(tmini_parser_t *parser)
{
    release_frame(parser);
    const size_t count = tmini_ring_unread(parser->frame.ring);
    if (count > 0) {
        skip_bytes(parser, count);
    }
}

bool tmini_parser_abandon(tmini_parser_t *parser)
{
    const size_t unread = tmini_ring_unread(parser->frame.ring);
    if (unread == 0 || unread >= parser->need) {
        return false;
    }
    skip(parser, unread);
    return true;
}
