/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "reference_decoder.h"

typedef enum { NOT_A_PACKET, WRONG_CHECKSUM, VALID_PACKET } verdict_t;

typedef struct {
    const uint8_t *bytes;
    size_t size;
    reference_options_t options;
    reference_callback_t callback;
    void *context;
    reference_counts_t counts;
} decoding_t;

static uint16_t word_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] + 256u * bytes[1]);
}

static size_t packet_length(const uint8_t *packet)
{
    return 10u + 3u * (size_t)packet[3];
}

/* Section 5, word by word in the manual's order. */
static uint16_t checksum_of(const uint8_t *packet)
{
    uint16_t sum = word_at(packet);
    sum ^= word_at(packet + 2);
    sum ^= word_at(packet + 4);
    sum ^= word_at(packet + 6);
    for (unsigned i = 0; i < packet[3]; i++) {
        const uint8_t *sample = packet + 10u + 3u * i;
        sum ^= sample[0];
        sum ^= word_at(sample + 1);
    }
    return sum;
}

static bool is_start(const uint8_t *packet)
{
    return (packet[2] & 1u) != 0u;
}

static bool header_is_acceptable(const uint8_t *packet, unsigned max_samples)
{
    return packet[0] == 0xAA && packet[1] == 0x55 &&      /* PH */
           packet[3] >= 1u && packet[3] <= max_samples && /* LSN */
           (packet[4] & 1u) != 0u &&                      /* check bit of FSA */
           (packet[6] & 1u) != 0u &&                      /* check bit of LSA */
           (!is_start(packet) || packet[3] == 1u);
}

static verdict_t judge_packet(const decoding_t *d, size_t at)
{
    const uint8_t *packet = d->bytes + at;
    const size_t left = d->size - at;
    if (left < 10u || !header_is_acceptable(packet, d->options.max_samples)) {
        return NOT_A_PACKET;
    }
    if (left < packet_length(packet)) {
        return NOT_A_PACKET;
    }
    return checksum_of(packet) == word_at(packet + 8) ? VALID_PACKET : WRONG_CHECKSUM;
}

/* The length of the awaited reply if it begins here, else 0. */
static size_t match_reply(const decoding_t *d, size_t at)
{
    const reference_reply_t *awaited = d->options.awaited;
    const uint8_t *reply = d->bytes + at;
    const size_t left = d->size - at;
    uint32_t length;
    if (awaited == NULL || left < 7u || reply[0] != 0xA5 || reply[1] != 0x5A) {
        return 0;
    }
    length = word_at(reply + 2) + 65536u * (word_at(reply + 4) & 0x3FFFu);
    if (reply[5] >> 6 != awaited->mode || reply[6] != awaited->type) {
        return 0;
    }
    if (awaited->mode == 1u) {
        return 7; /* the length is meaningless (section 4) and the content has no end */
    }
    return length == awaited->length && left - 7u >= length ? 7u + (size_t)length : 0;
}

static void report(const decoding_t *d, const reference_item_t *item)
{
    if (d->callback != NULL) {
        d->callback(d->context, item);
    }
}

static size_t deliver_packet(decoding_t *d, size_t at)
{
    const uint8_t *packet = d->bytes + at;
    reference_item_t item = {0};
    item.is_packet = true;
    item.offset = at;
    item.length = packet_length(packet);
    item.bytes = packet;
    item.ct = packet[2];
    item.lsn = packet[3];
    item.fsa = word_at(packet + 4);
    item.lsa = word_at(packet + 6);
    item.starts_revolution = is_start(packet);
    d->counts.packets++;
    d->counts.start_packets += item.starts_revolution ? 1u : 0u;
    d->counts.points += item.lsn;
    d->counts.bytes_in_packets += item.length;
    report(d, &item);
    return at + item.length;
}

static size_t deliver_reply(decoding_t *d, size_t at, size_t length)
{
    reference_item_t item = {0};
    item.offset = at;
    item.length = length;
    item.bytes = d->bytes + at;
    d->counts.replies++;
    d->counts.bytes_in_replies += length;
    d->options.awaited = NULL;
    report(d, &item);
    return at + length;
}

static size_t skip_byte(decoding_t *d, size_t at, verdict_t verdict)
{
    d->counts.checksum_errors += verdict == WRONG_CHECKSUM ? 1u : 0u;
    d->counts.bytes_skipped++;
    return at + 1u;
}

static size_t decode_at(decoding_t *d, size_t at)
{
    const verdict_t verdict = judge_packet(d, at);
    const size_t reply = match_reply(d, at);
    if (verdict == VALID_PACKET) {
        return deliver_packet(d, at);
    }
    if (reply != 0) {
        return deliver_reply(d, at, reply);
    }
    return skip_byte(d, at, verdict);
}

reference_counts_t reference_decode(const uint8_t *bytes, size_t size,
                                    const reference_options_t *options,
                                    reference_callback_t callback, void *context)
{
    decoding_t d = {0};
    size_t at = 0;
    d.bytes = bytes;
    d.size = size;
    d.options = *options;
    d.callback = callback;
    d.context = context;
    d.counts.bytes = size;
    while (at < size) {
        at = decode_at(&d, at);
    }
    return d.counts;
}

/* x = first + index * (clockwise difference) / (LSN - 1), rounded as floor((2x + 1) / 2). */
static uint16_t angle_of(const uint8_t *packet, unsigned index)
{
    const uint64_t full = 23040;
    const uint64_t first = (uint64_t)(word_at(packet + 4) >> 1) % full;
    const uint64_t last = (uint64_t)(word_at(packet + 6) >> 1) % full;
    const uint64_t difference = (last + full - first) % full;
    const uint64_t parts = packet[3] > 1u ? packet[3] - 1u : 1u;
    const uint64_t moved = packet[3] > 1u ? difference * index : 0;
    const uint64_t twice = 2u * (first * parts + moved) + parts;
    return (uint16_t)(twice / (2u * parts) % full);
}

reference_point_t reference_point(const uint8_t *packet, unsigned index)
{
    const uint8_t *sample = packet + 10u + 3u * index;
    reference_point_t point;
    point.angle_q6 = angle_of(packet, index);
    point.distance_mm = (uint16_t)(sample[2] * 64u + sample[1] / 4u);
    point.intensity = sample[0];
    point.flag = sample[1] & 3u;
    return point;
}
