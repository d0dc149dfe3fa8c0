/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar on standard input and output, in somebody else's time: for emulators that
 * keep their own. Usage: lidar_pipe FREQUENCY_CHZ
 *
 *     in:   NOW_US HEX      the host's bytes (HEX may be empty), arriving at NOW_US
 *     out:  HEX             what has left the lidar by then
 *
 * At the end of the input follows the truth, a line a sample of every packet sent completely:
 *
 *     out:  REVOLUTION ANGLE_Q6 DISTANCE_MM INTENSITY FLAG */

#include "encoder.h"
#include "reference_decoder.h"
#include "simulator.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static sim_t sim;
static FILE *truth;

static void note_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    const unsigned count = packet->bytes[3]; /* LSN */
    for (unsigned i = 0; i < count; i++) {
        const reference_point_t point = reference_point(packet->bytes, i);
        fprintf(truth, "%" PRIu32 " %u %u %u %u\n", packet->revolution, point.angle_q6,
                point.distance_mm, point.intensity, point.flag);
    }
}

static size_t parse_hex(const char *text, uint8_t *bytes, size_t max)
{
    size_t count = 0;
    unsigned value = 0;
    while (count < max && sscanf(text, "%2x", &value) == 1) {
        bytes[count++] = (uint8_t)value;
        text += 2;
    }
    return count;
}

static void answer(uint64_t now_us)
{
    uint8_t bytes[256];
    size_t count = 0;
    do {
        count = sim_transmit(&sim, now_us, bytes, sizeof bytes);
        for (size_t i = 0; i < count; i++) {
            printf("%02x", bytes[i]);
        }
    } while (count == sizeof bytes);
    printf("\n");
    fflush(stdout);
}

static void serve(void)
{
    char line[1024];
    while (fgets(line, sizeof line, stdin) != NULL) {
        char *rest = line;
        uint8_t bytes[256];
        const uint64_t now_us = strtoull(line, &rest, 10);
        rest += *rest == ' ';
        const size_t count = parse_hex(rest, bytes, sizeof bytes);
        if (count > 0) {
            sim_receive(&sim, bytes, count, now_us);
        }
        answer(now_us);
    }
}

static void print_truth(void)
{
    int character = 0;
    rewind(truth);
    while ((character = fgetc(truth)) != EOF) {
        putchar(character);
    }
}

int main(int argc, char **argv)
{
    const sim_observer_t observer = {.on_packet = note_packet};
    sim_config_t config = sim_default_config();
    truth = tmpfile();
    if (argc != 2 || truth == NULL) {
        fprintf(stderr, "usage: lidar_pipe FREQUENCY_CHZ; it also needs a temporary file\n");
        return 2;
    }
    config.frequency_chz = (uint16_t)strtoul(argv[1], NULL, 10);
    sim_init(&sim, &config);
    sim_observe(&sim, &observer);
    serve();
    print_truth();
    return 0;
}
