/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stream.h"

#include <string.h>

encode_sample_t stream_sample(unsigned index)
{
    const encode_sample_t sample = {.distance_mm = (uint16_t)(1000u + 7u * index),
                                    .intensity = (uint8_t)(200u - index),
                                    .flag = (uint8_t)(index % 4u)};
    return sample;
}

void stream_add(stream_t *stream, const uint8_t *bytes, size_t count)
{
    if (count <= stream->capacity - stream->size) {
        memcpy(&stream->bytes[stream->size], bytes, count);
        stream->size += count;
    }
}

void stream_add_byte(stream_t *stream, uint8_t byte)
{
    stream_add(stream, &byte, 1);
}

size_t stream_add_packet(stream_t *stream, uint8_t ct, uint8_t lsn, uint16_t first_q6,
                         uint16_t last_q6)
{
    const encode_packet_t packet = {ct, lsn, first_q6, last_q6, NULL};
    const size_t size = ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * (size_t)lsn;
    uint8_t *const out = &stream->bytes[stream->size];
    if (size > stream->capacity - stream->size) {
        return 0;
    }
    encode_packet_header(out, &packet);
    for (unsigned i = 0; i < lsn; i++) {
        encode_sample(&out[ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * i], stream_sample(i));
    }
    encode_seal(out);
    stream->size += size;
    return size;
}
