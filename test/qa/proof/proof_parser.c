/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of the parser, from any sound state on a ring of 32 bytes (with DMA, half of it is
 * used), with any bytes arriving between two accesses: each step is memory-safe, keeps the state
 * sound, and accounts for every byte. The source is included, because the steps are private.
 *
 * tmini_parser_next_after() calls these steps in a loop. The proof checks one turn of this loop,
 * from any state that earlier turns may have left: see at_loop_head(). In the proof of judge(),
 * any checksum may be right or wrong. */

void at_loop_head(void);

#include "tmini_parser.c"

#include "proof.h"

bool any_judge(tmini_parser_t *same, size_t unread);
void any_skip(tmini_parser_t *same, size_t unread);

static tmini_ring_t ring;
static tmini_parser_t parser;
static tmini_parser_t before;
static uint32_t before_account;
static size_t before_head;
static size_t before_overrun;

static void begin(void)
{
    ring = any_early_ring(RING_SIZE);
    parser = any_parser(&ring);
    before = parser;
    before_account = parser_account(&parser);
    before_head = ring.head;
    before_overrun = ring.overrun;
    let_bytes_come(&ring);
}

/* Bytes stored since the index was `head`. DMA may be any number of bytes ahead; a ring fed by the
 * CPU may have been closed and opened meanwhile. */
static size_t stored_since(size_t head)
{
    return tmini_ring_is_dma(&ring) ? ring.head - head : tmini_ring_distance(head, ring.head);
}

/* Each byte that has arrived is counted exactly once. */
static bool is_accounted_for(void)
{
    let_bytes_come(NULL);
    const size_t came = stored_since(before_head) + (ring.overrun - before_overrun);
    return parser_account(&parser) == before_account + (uint32_t)came;
}

void prove_parser_init(void)
{
    ring = any_early_ring(RING_SIZE);
    const uint8_t max_samples = nondet_byte();
    const unsigned largest = max_samples == 0 ? 250 : 10 + 3 * max_samples;
    const tmini_status_t status = tmini_parser_init(&parser, &ring, max_samples);
    CLAIM((status == TMINI_OK) == (ring.window >= largest && ring.window >= 27));
    CLAIM(status != TMINI_OK || parser_is_sound(&parser));
    CLAIM(tmini_parser_init(NULL, &ring, max_samples) == TMINI_ERROR_ARGUMENT);
    CLAIM(tmini_parser_init(&parser, NULL, max_samples) == TMINI_ERROR_ARGUMENT);
}

void prove_parser_await(void)
{
    begin();
    const tmini_reply_header_t header = {nondet_byte(), nondet_byte(), nondet_byte()};
    const bool is_null = any_bool();
    const tmini_status_t status = tmini_parser_await(&parser, is_null ? NULL : &header);
    CLAIM(is_accounted_for());
    CLAIM(parser_is_sound(&parser));
    CLAIM((status == TMINI_OK) == (is_null || 7u + header.length <= ring.window));
    CLAIM(parser.awaiting == (status == TMINI_OK && !is_null));
    CLAIM(parser.frame.size == before.frame.size);
}

/* judge() changes only kind and need, and counters and effort for a failed candidate; a complete
 * frame is as in the contract. */
void prove_parser_judge(void)
{
    begin();
    ASSUME(parser.frame.size == 0);
    const size_t unread = nondet_size();
    ASSUME(unread >= parser.need && unread <= tmini_ring_unread(&ring) && unread <= ring.window);
    const bool may_be_frame = judge(&parser, unread);
    CLAIM(is_accounted_for());
    CLAIM(same_expectations(&before, &parser) && parser.frame.size == 0);
    CLAIM(parser_is_sound(&parser));
    CLAIM(!may_be_frame || unread < parser.need || parser.kind != TMINI_FRAME_NONE);
    CLAIM(parser.effort == before.effort ||
          (!may_be_frame && parser.effort == (uint16_t)(before.effort + parser.need)));
    CLAIM(parser.frame.gap == before.frame.gap);
}

/* The samples' part of the checksum as defined in section 5: byte by byte. */
static unsigned contribution(const uint8_t *bytes, size_t samples)
{
    unsigned sum = 0;
    for (size_t i = 0; i < 3 * samples; i++) {
        sum ^= (unsigned)bytes[i] << (i % 3 == 2 ? 8 : 0);
    }
    return sum;
}

/* 9 samples are two blocks of 4, and one more. */
void prove_parser_xor_piece(void)
{
    uint8_t bytes[3 * 9];
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = nondet_byte();
    }
    const size_t samples = nondet_size();
    ASSUME(samples <= 9);
    CLAIM((xor_piece(bytes, samples) & 0xFFFFu) == contribution(bytes, samples));
}

/* The samples may be anywhere in the ring, also across its end. */
void prove_parser_checksum(void)
{
    ring = any_early_ring(RING_SIZE);
    tmini_frame_t frame = {.ring = &ring};
    uint8_t samples[3 * 3];
    unsigned sum = 0x55AA;
    for (size_t i = 0; i < sizeof frame.header; i++) {
        frame.header[i] = i == LSN ? nondet_byte() : 0;
        sum ^= (unsigned)frame.header[i] << (i % 2 * 8);
    }
    frame.header[6] = nondet_byte(); /* The two bytes of the checksum. */
    frame.header[7] = nondet_byte();
    sum ^= frame.header[6] | (unsigned)frame.header[7] << 8;
    ASSUME(frame.header[LSN] <= 3);
    for (size_t i = 0; i < sizeof samples; i++) {
        samples[i] = tmini_ring_peek(&ring, TMINI_PACKET_HEADER_SIZE + i);
    }
    sum ^= contribution(samples, frame.header[LSN]);
    CLAIM(checksum_matches(&frame) == (sum == 0));
}

void prove_parser_skip(void)
{
    begin();
    ASSUME(parser.frame.size == 0);
    const size_t unread = nondet_size();
    const size_t tail = tmini_ring_tail(&ring);
    ASSUME(unread >= 1 && unread <= tmini_ring_unread(&ring) && unread <= ring.window);
    const size_t place = nondet_size();
    const uint8_t byte = tmini_ring_peek(&ring, place);
    skip(&parser, unread);
    CLAIM(is_accounted_for());
    CLAIM(skip_keeps_its_word(&before, &parser));
    const size_t skipped = tmini_ring_tail(&ring) - tail;
    CLAIM(skipped >= 1 && skipped <= unread);
    CLAIM(place < 1 || place >= skipped || begins_no_frame(&parser, byte)); /* Skips no frame. */
    CLAIM(place != skipped - 1 || parser.frame.last_skipped == byte);
    CLAIM(parser.frame.gap >= before.frame.gap);
    CLAIM(skipped == 1 || skipped + before.effort <= TMINI_PARSER_EFFORT);
    CLAIM(parser.effort == (uint16_t)(before.effort + skipped + TMINI_CANDIDATE_EFFORT));
}

/* With DMA, bytes that may have been overwritten are skipped. */
void prove_parser_drop_overwritten(void)
{
    begin();
    const size_t ahead = tmini_ring_ahead(&ring);
    const size_t head = tmini_ring_tail(&ring) + ahead;
    ASSUME(parser.frame.size == 0 && tmini_ring_is_dma(&ring) && ahead > ring.window);
    drop_overwritten(&parser, ahead);
    CLAIM(is_accounted_for());
    CLAIM(skip_keeps_its_word(&before, &parser));
    CLAIM(head - tmini_ring_tail(&ring) <= ring.window);
    CLAIM(parser.frame.gap == before.frame.gap || parser.frame.gap == TMINI_GAP_UNKNOWN);
}

void prove_parser_pass_lost_bytes(void)
{
    begin();
    const size_t stored = ring.head;
    ASSUME(parser.frame.size == 0 && tmini_ring_is_closed(&ring));
    ASSUME(tmini_ring_unread(&ring) < parser.need && tmini_ring_unread(&ring) <= ring.window);
    pass_lost_bytes(&parser, tmini_ring_unread(&ring));
    CLAIM(is_accounted_for());
    CLAIM(skip_keeps_its_word(&before, &parser));
    CLAIM(tmini_ring_is_closed(&ring) || tmini_ring_distance(stored, tmini_ring_tail(&ring)) == 0);
}

void prove_parser_release(void)
{
    begin();
    release_frame(&parser);
    CLAIM(is_accounted_for());
    CLAIM(skip_keeps_its_word(&before, &parser));
    CLAIM(before.frame.size == 0 || parser.frame.gap == 0);
}

void prove_parser_deliver(void)
{
    begin();
    ASSUME(parser.frame.size == 0 && parser.kind != TMINI_FRAME_NONE);
    ASSUME(tmini_ring_unread(&ring) >= parser.need);
    const tmini_frame_type_t type = deliver(&parser);
    CLAIM(is_accounted_for());
    CLAIM(next_keeps_its_word(&before, &parser, type));
    CLAIM(type == before.kind && parser.frame.size == before.need);
}

void prove_parser_skip_all(void)
{
    begin();
    let_bytes_come(NULL);
    tmini_parser_skip_all(&parser);
    CLAIM(is_accounted_for());
    CLAIM(skip_keeps_its_word(&before, &parser));
    CLAIM(tmini_parser_pending(&parser) == 0);
}

void prove_parser_abandon(void)
{
    begin();
    tmini_parser_abandon(&parser);
    CLAIM(is_accounted_for());
    CLAIM(parser_is_sound(&parser) && same_expectations(&before, &parser));
    CLAIM(parser.awaiting == before.awaiting && parser.frame.size == before.frame.size);
}

/* ---- One turn of the loop of tmini_parser_next_after() ---- */

/* These replace judge() and skip(): they check how they are called, and do anything that is
 * proved above. */

bool any_judge(tmini_parser_t *same, size_t unread)
{
    const tmini_parser_t was = parser;
    const bool may_be_frame = any_bool();
    CLAIM(same == &parser && parser.frame.size == 0);
    CLAIM(unread >= parser.need && unread <= ring.window && unread <= tmini_ring_unread(&ring));
    parser = any_parser(&ring);
    ASSUME(same_expectations(&was, &parser) && parser.awaiting == was.awaiting);
    ASSUME(parser.frame.size == 0 && parser.frame.gap == was.frame.gap);
    ASSUME(!may_be_frame || unread < parser.need || parser.kind != TMINI_FRAME_NONE);
    ASSUME(parser.effort == was.effort ||
           (!may_be_frame && parser.effort == (uint16_t)(was.effort + parser.need)));
    parser.counters = was.counters;
    return may_be_frame;
}

void any_skip(tmini_parser_t *same, size_t unread)
{
    const size_t skipped = nondet_size();
    CLAIM(same == &parser && parser.frame.size == 0);
    CLAIM(unread >= 1 && unread <= ring.window && unread <= tmini_ring_unread(&ring));
    ASSUME(skipped >= 1 && skipped <= unread);
    ASSUME(skipped == 1 || skipped + parser.effort <= TMINI_PARSER_EFFORT);
    skip_bytes(&parser, skipped);
    parser.effort = (uint16_t)(parser.effort + skipped + TMINI_CANDIDATE_EFFORT);
}

static bool is_second_turn;
static unsigned rank_before;

/* How many turns without effort may follow if no byte arrives: one that drops overwritten bytes,
 * one in which a candidate needs more bytes, and one that opens a closed ring. */
static unsigned rank(void)
{
    let_bytes_come(NULL);
    const bool is_overwritten = tmini_ring_is_dma(&ring) && tmini_ring_ahead(&ring) > ring.window;
    const bool is_enough = tmini_ring_unread(&ring) >= parser.need;
    return is_overwritten ? 3 : is_enough ? 2 : tmini_ring_is_closed(&ring) ? 1 : 0;
}

/* prove.py inserts a call of this function at the beginning of each turn. It proves: if the state
 * is sound and without a frame before a turn, it is so before the next one. Each turn costs some
 * effort, which is limited, or leads nearer to the end, unless bytes have arrived meanwhile. */
void at_loop_head(void)
{
    if (is_second_turn) {
        CLAIM(is_accounted_for());
        CLAIM(skip_keeps_its_word(&before, &parser));
        CLAIM(parser.effort < TMINI_PARSER_EFFORT);
        CLAIM(parser.effort > before.effort + TMINI_CANDIDATE_EFFORT || have_bytes_come() ||
              rank() < rank_before);
        ASSUME(false);
    }
    is_second_turn = true;
    let_bytes_come(&ring);
}

void prove_parser_next(void)
{
    begin();
    let_bytes_come(NULL);
    ASSUME(parser.frame.size == 0 && parser.effort < TMINI_PARSER_EFFORT);
    rank_before = rank();
    const tmini_frame_type_t type = tmini_parser_next_after(&parser, parser.effort);
    CLAIM(is_accounted_for());
    CLAIM(next_keeps_its_word(&before, &parser, type));
    CLAIM((type == TMINI_FRAME_MORE) == (parser.effort >= TMINI_PARSER_EFFORT) ||
          type == TMINI_FRAME_PACKET || type == TMINI_FRAME_REPLY);
    /* The last turn may add a damaged candidate and its skipped bytes, or a frame. */
    CLAIM(parser.effort <
          TMINI_PARSER_EFFORT + TMINI_PACKET_SIZE(255) + TMINI_CANDIDATE_EFFORT + 1);
}
