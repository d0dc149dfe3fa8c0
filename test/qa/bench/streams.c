/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* streams REVOLUTIONS [HEALTH [BYTES]]
 *
 * Writes revolutions at 6 Hz, made by the independent encoder, to standard output: with CT
 * information, which reports this health (section 4), and damaged once per about BYTES bytes. */

#include "corrupt.h"
#include "encoder.h"
#include "random.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define CAPACITY (1u << 20)
#define FULL_PACKET 40u
#define POINTS 667u /* 4000 per second (section 1). */

static uint8_t stream[CAPACITY];
static size_t size;

static encode_sample_t sample(random_t *random)
{
    const bool lost = random_below(random, 20) == 0;
    return (encode_sample_t){.distance_mm = (uint16_t)(lost ? 0 : 200 + random_below(random, 8000)),
                             .intensity = (uint8_t)random_below(random, 256)};
}

/* Adds the packet from the revolution's point `first` on. Returns its number of points. */
static uint32_t add_packet(random_t *random, uint8_t ct, uint32_t first)
{
    encode_sample_t samples[FULL_PACKET];
    const uint32_t left = POINTS - first;
    const uint32_t most = first == 0 ? 1 : FULL_PACKET;
    const uint32_t count = left < most ? left : most;
    for (uint32_t i = 0; i < count; i++) {
        samples[i] = sample(random);
    }
    const encode_packet_t packet = {
        .ct = ct,
        .lsn = (uint8_t)count,
        .first_q6 = (uint16_t)(first * ENCODE_FULL_TURN_Q6 / POINTS),
        .last_q6 = (uint16_t)((first + count - 1) * ENCODE_FULL_TURN_Q6 / POINTS),
        .samples = samples,
    };
    size += encode_packet(&stream[size], &packet);
    return count;
}

static void add_revolution(random_t *random, uint8_t health)
{
    const encode_turn_t turn = {.frequency_dhz = 60,
                                .user_major = 1,
                                .health = health,
                                .hardware = 1,
                                .firmware_major = 1,
                                .firmware_minor = 2,
                                .year = 2024,
                                .month = 5,
                                .day = 4,
                                .serial = 12345};
    uint8_t crc = 0;
    uint32_t index = 0;
    for (uint32_t first = 0; first < POINTS; index++) {
        const uint8_t ct = encode_ct(&turn, index);
        crc = encode_crc8(crc, ct);
        first += add_packet(random, ct, first);
    }
    stream[size++] = crc;
}

int main(int argc, char **argv)
{
    const int revolutions = argc > 1 ? atoi(argv[1]) : 0;
    const uint8_t health = (uint8_t)(argc > 2 ? atoi(argv[2]) : 0);
    random_t random;
    random_seed(&random, 1);
    for (int i = 0; i < revolutions && size + 4096 < CAPACITY; i++) {
        add_revolution(&random, health);
    }
    if (argc > 3) {
        random_seed(&random, 2);
        size = corrupt_some(&random, (unsigned)(size / strtoul(argv[3], NULL, 10)), stream, size,
                            CAPACITY);
    }
    return fwrite(stream, 1, size, stdout) == size ? 0 : 1;
}
