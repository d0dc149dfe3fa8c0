/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_decoder.h"

tmini_status_t tmini_decoder_init(tmini_decoder_t *decoder, tmini_ring_t *ring, uint8_t max_samples)
{
    if (decoder == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *decoder = (tmini_decoder_t){0};
    return tmini_parser_init(&decoder->parser, ring, max_samples);
}

TMINI_INLINE void note_turn(tmini_decoder_t *decoder)
{
    const tmini_packet_t *const packet = &decoder->packet;
    const bool is_start = tmini_packet_is_start(packet);
    const bool is_whole = decoder->is_whole && !tmini_packet_misses(packet, packet->gap);
    decoder->was_whole = is_start && is_whole;
    decoder->is_whole = is_start || is_whole;
}

/* Inlined in both callers: a firmware links only one of them, and saves the call. */
TMINI_INLINE bool take_opened(tmini_decoder_t *decoder, uint32_t now_ms)
{
    note_turn(decoder);
    decoder->verdict = (uint8_t)tmini_ct_add(&decoder->ct, &decoder->packet, decoder->is_whole);
    if (decoder->builder.capacity == 0) {
        return false;
    }
    if (decoder->verdict == TMINI_CT_REFUTED) {
        tmini_builder_refute(&decoder->builder);
    }
    return tmini_builder_add(&decoder->builder, &decoder->packet, now_ms);
}

bool tmini_decoder_take(tmini_decoder_t *decoder, bool is_doubtful, uint32_t now_ms,
                        uint16_t late_ms)
{
    tmini_builder_backdate(&decoder->builder, late_ms);
    tmini_packet_open(&decoder->packet, tmini_parser_frame(&decoder->parser));
    if (is_doubtful) {
        decoder->packet.gap = TMINI_GAP_UNKNOWN;
    }
    return take_opened(decoder, now_ms);
}

bool tmini_decoder_take_packet(tmini_decoder_t *decoder, const tmini_packet_t *packet,
                               uint32_t now_ms)
{
    decoder->packet = *packet;
    return take_opened(decoder, now_ms);
}

void tmini_decoder_restart(tmini_decoder_t *decoder)
{
    tmini_builder_discard(&decoder->builder);
    tmini_ct_discard(&decoder->ct);
    decoder->is_whole = false;
}
