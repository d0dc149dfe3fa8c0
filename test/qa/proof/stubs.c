/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Replaces parser, packets, scans and CT information in the driver's proofs. These functions do
 * anything that the contracts permit; proof_parser.c and proof_scan.c prove the contracts. */

#include "proof.h"

tmini_parser_t nondet_parser(void);
tmini_packet_t nondet_packet(void);
tmini_builder_t nondet_builder(void);
tmini_ct_t nondet_ct(void);

/* ---- Parser ---- */

/* The parser may change in any way, and may have freed any number of bytes. */
static void change(tmini_parser_t *parser)
{
    tmini_ring_t *const ring = parser->frame.ring;
    const tmini_reply_header_t awaited = parser->awaited;
    *parser = nondet_parser();
    parser->frame.ring = ring;
    parser->awaited = awaited;
    parser->awaiting = any_bool();
    ring->tail += nondet_byte();
    if (tmini_ring_is_closed(ring) && any_bool()) {
        ring->tail += TMINI_RING_CLOSED;
    }
}

tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples)
{
    const tmini_parser_t any = nondet_parser();
    *parser = any;
    parser->frame.ring = ring;
    parser->awaiting = false;
    if (any_bool()) {
        return TMINI_ERROR_ARGUMENT;
    }
    ASSUME(ring->window >= TMINI_REPLY_SIZE_MAX && parser_is_sound(parser));
    return TMINI_OK;
}

tmini_frame_type_t tmini_parser_next_after(tmini_parser_t *parser, size_t effort)
{
    const tmini_parser_t before = *parser;
    const uint8_t type = nondet_byte();
    CLAIM(parser_is_sound(parser) && effort < TMINI_PARSER_EFFORT);
    change(parser);
    ASSUME(type <= TMINI_FRAME_REPLY);
    ASSUME(next_keeps_its_word(&before, parser, (tmini_frame_type_t)type));
    return (tmini_frame_type_t)type;
}

tmini_status_t tmini_parser_await(tmini_parser_t *parser, const tmini_reply_header_t *header)
{
    CLAIM(header == NULL || TMINI_REPLY_HEADER_SIZE + header->length <= TMINI_REPLY_SIZE_MAX);
    parser->need = 1;
    parser->kind = TMINI_FRAME_NONE;
    parser->awaiting = header != NULL;
    if (header != NULL) {
        parser->awaited = *header;
    }
    return TMINI_OK;
}

size_t tmini_parser_pending(const tmini_parser_t *parser)
{
    return tmini_ring_unread(parser->frame.ring) - parser->frame.size;
}

void tmini_parser_counters(const tmini_parser_t *parser, tmini_parser_counters_t *counters)
{
    *counters = parser->counters;
}

void tmini_parser_skip_all(tmini_parser_t *parser)
{
    const tmini_parser_t before = *parser;
    CLAIM(parser_is_sound(parser));
    change(parser);
    ASSUME(skip_keeps_its_word(&before, parser));
}

bool tmini_parser_abandon(tmini_parser_t *parser)
{
    const tmini_parser_t before = *parser;
    CLAIM(parser_is_sound(parser) && parser->frame.size == 0);
    change(parser);
    ASSUME(skip_keeps_its_word(&before, parser));
    return any_bool();
}

/* ---- Packet ---- */

void tmini_packet_open(tmini_packet_t *packet, const tmini_frame_t *frame)
{
    CLAIM(frame->header[1] >= 1 && frame->size == TMINI_PACKET_SIZE(frame->header[1]));
    *packet = nondet_packet();
    packet->frame = frame;
    ASSUME(packet_is_sound(packet, frame));
}

bool tmini_packet_has_range(const tmini_packet_t *packet)
{
    CLAIM(packet->frame->size > 0);
    return any_bool();
}

/* ---- Scan ---- */

static void change_builder(tmini_builder_t *builder, bool open, bool ended)
{
    const tmini_builder_t before = *builder;
    *builder = nondet_builder();
    builder->capacity = before.capacity;
    builder->scan.points = before.scan.points;
    builder->open = open;
    builder->ended = ended;
    builder->scan.complete = any_bool();
    builder->scan.upside_down = any_bool();
    ASSUME(builder_is_sound(builder));
}

tmini_status_t tmini_builder_init(tmini_builder_t *builder, tmini_point_t *buffer, size_t capacity,
                                  unsigned filter)
{
    (void)filter;
    if (buffer == NULL || capacity == 0 || capacity > UINT16_MAX || any_bool()) {
        return TMINI_ERROR_ARGUMENT;
    }
    builder->scan.points = buffer;
    builder->capacity = (uint16_t)capacity;
    change_builder(builder, false, false);
    return TMINI_OK;
}

void tmini_builder_discard(tmini_builder_t *builder)
{
    builder->open = false;
    builder->ended = false;
    builder->origin_q6 = UINT16_MAX;
}

void tmini_builder_refute(tmini_builder_t *builder)
{
    if (builder->scan.gaps < UINT16_MAX) {
        builder->scan.gaps++;
    }
}

bool tmini_builder_add(tmini_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms)
{
    const bool is_start = tmini_packet_is_start(packet);
    (void)now_ms;
    CLAIM(builder_is_sound(builder) && packet_is_sound(packet, packet->frame));
    const bool closes = builder->open && (is_start || any_bool());
    if (builder->open || is_start || builder->origin_q6 != UINT16_MAX) {
        change_builder(builder, !closes, closes);
    }
    return closes;
}

/* ---- CT information ---- */

static void change_ct(tmini_ct_t *ct)
{
    *ct = nondet_ct();
    ASSUME(ct_is_sound(ct));
}

void tmini_ct_discard(tmini_ct_t *ct)
{
    change_ct(ct);
}

tmini_ct_verdict_t tmini_ct_add(tmini_ct_t *ct, const tmini_packet_t *packet, bool is_whole)
{
    const uint8_t verdict = nondet_byte();
    CLAIM(ct_is_sound(ct) && packet_is_sound(packet, packet->frame));
    CLAIM(is_whole || !tmini_packet_is_start(packet));
    change_ct(ct);
    ASSUME(verdict <= TMINI_CT_REFUTED);
    ASSUME(verdict == TMINI_CT_UNKNOWN || tmini_packet_is_start(packet));
    return (tmini_ct_verdict_t)verdict;
}

unsigned tmini_ct_faults(const tmini_ct_t *ct)
{
    const unsigned faults = nondet_half();
    (void)ct;
    ASSUME(faults <= TMINI_FAULT_MASK || faults == TMINI_FAULTS_UNKNOWN);
    return faults;
}

void tmini_ct_read(const tmini_ct_t *ct, tmini_ct_info_t *info)
{
    (void)ct, (void)info;
}
