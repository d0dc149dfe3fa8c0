/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "decoder.h"

/* With the largest packet waiting for its last byte (775), this much still fits in the ring. */
#define BLOCK_SIZE 2048

void decoder_init(decoder_t *decoder, FILE *file, uint8_t max_samples)
{
    *decoder = (decoder_t){.file = file};
    (void)tmini_ring_init(&decoder->ring, decoder->memory, sizeof decoder->memory, false);
    (void)tmini_parser_init(&decoder->parser, &decoder->ring, max_samples);
}

static bool refill(decoder_t *decoder)
{
    uint8_t block[BLOCK_SIZE];
    const size_t count = fread(block, 1, sizeof block, decoder->file);
    tmini_ring_write(&decoder->ring, block, count);
    decoder->totals.bytes += count;
    return count > 0;
}

static void count_errors(decoder_t *decoder)
{
    const uint32_t now = decoder->parser.counters.checksum_errors;
    decoder->totals.checksum_errors += (uint32_t)(now - decoder->checksum_errors);
    decoder->checksum_errors = now;
}

static void count_packet(decoder_t *decoder)
{
    decoder_totals_t *const totals = &decoder->totals;
    totals->packets++;
    totals->start_packets += tmini_packet_is_start(&decoder->packet) ? 1 : 0;
    totals->points += decoder->packet.count;
    totals->bytes_in_packets += TMINI_PACKET_SIZE_MAX(decoder->packet.count);
}

bool decoder_next(decoder_t *decoder)
{
    for (;;) {
        const tmini_frame_t frame = tmini_parser_next(&decoder->parser);
        count_errors(decoder);
        if (frame == TMINI_FRAME_PACKET) {
            tmini_packet_open(&decoder->packet, &decoder->parser);
            count_packet(decoder);
            return true;
        }
        if (!refill(decoder)) {
            if (tmini_parser_pending(&decoder->parser) == 0) {
                return false;
            }
            tmini_parser_abandon(&decoder->parser);
        }
    }
}

uint64_t decoder_bytes_skipped(const decoder_t *decoder)
{
    return decoder->totals.bytes - decoder->totals.bytes_in_packets -
           tmini_parser_pending(&decoder->parser);
}
