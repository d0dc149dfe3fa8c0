/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Writes a stream of scan packets to standard output, made by the independent encoder:
 *
 *   streams clean REVOLUTIONS POINTS   as a lidar sends them, with CT information; at 6 Hz a
 *                                      revolution has 667 points
 *   streams faulty REVOLUTIONS POINTS  the same from a lidar that reports a fault of its encoder
 *   streams corrupted REVOLUTIONS POINTS  as clean, but with one fault per about 500 bytes */

#include "corrupt.h"
#include "encoder.h"
#include "random.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CAPACITY (1u << 20)
#define FULL_PACKET 40u
#define BYTES_PER_FAULT 500u
#define HEALTH_ENCODER 2u /* section 4 */

static uint8_t stream[CAPACITY];
static size_t size;
static uint32_t points_per_revolution;

static encode_turn_t turn = {.frequency_dhz = 60,
                             .user_major = 1,
                             .hardware = 1,
                             .firmware_major = 1,
                             .firmware_minor = 2,
                             .year = 2024,
                             .month = 5,
                             .day = 4,
                             .serial = 12345};

static encode_sample_t room(random_t *random)
{
    const bool lost = random_below(random, 20) == 0;
    return (encode_sample_t){.distance_mm = (uint16_t)(lost ? 0 : 200 + random_below(random, 8000)),
                             .intensity = (uint8_t)random_below(random, 256),
                             .flag = 0};
}

/* Adds the packet from the revolution's point `first` on. Returns its number of points. */
static uint32_t add_packet(random_t *random, uint32_t index, uint32_t first)
{
    encode_sample_t samples[FULL_PACKET];
    const uint32_t left = points_per_revolution - first;
    const uint32_t most = index == 0 ? 1 : FULL_PACKET;
    const uint32_t count = left < most ? left : most;
    for (uint32_t i = 0; i < count; i++) {
        samples[i] = room(random);
    }
    const encode_packet_t packet = {
        .ct = encode_ct(&turn, index),
        .lsn = (uint8_t)count,
        .first_q6 = (uint16_t)(first * ENCODE_FULL_TURN_Q6 / points_per_revolution),
        .last_q6 = (uint16_t)((first + count - 1) * ENCODE_FULL_TURN_Q6 / points_per_revolution),
        .samples = samples,
    };
    size += encode_packet(&stream[size], &packet);
    return count;
}

static void add_revolution(random_t *random)
{
    uint8_t crc = 0;
    uint32_t index = 0;
    for (uint32_t first = 0; first < points_per_revolution; index++) {
        crc = encode_crc8(crc, encode_ct(&turn, index));
        first += add_packet(random, index, first);
    }
    stream[size++] = crc;
}

static void make_scans(uint32_t revolutions)
{
    random_t random;
    random_seed(&random, 1);
    for (uint32_t i = 0; i < revolutions && size + 4096 < CAPACITY; i++) {
        add_revolution(&random);
    }
}

static void corrupt(void)
{
    random_t random;
    random_seed(&random, 2);
    size = corrupt_some(&random, (unsigned)(size / BYTES_PER_FAULT), stream, size, CAPACITY);
}

static bool make(const char *kind, uint32_t amount, uint32_t parameter)
{
    points_per_revolution = parameter;
    if (strcmp(kind, "clean") == 0) {
        make_scans(amount);
    } else if (strcmp(kind, "faulty") == 0) {
        turn.health = HEALTH_ENCODER;
        make_scans(amount);
    } else if (strcmp(kind, "corrupted") == 0) {
        make_scans(amount);
        corrupt();
    } else {
        return false;
    }
    return true;
}

static uint32_t number(const char *word)
{
    return (uint32_t)strtoul(word, NULL, 10);
}

int main(int argc, char **argv)
{
    if (argc != 4 || !make(argv[1], number(argv[2]), number(argv[3]))) {
        fputs("usage: streams KIND AMOUNT PARAMETER\n", stderr);
        return 2;
    }
    return fwrite(stream, 1, size, stdout) == size ? 0 : 1;
}
