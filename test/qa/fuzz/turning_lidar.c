/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "turning_lidar.h"

#include <string.h>

#include "encoder.h"
#include "reference_decoder.h"

/* As a unit at 6.08 Hz (section 9.6), but the last packet is larger: the loss of any packet but the
 * first leaves a hole of more than 4 degrees, which cannot be jitter. */
#define PACKETS 18u
#define LAST_SAMPLES 17u
#define STEP_Q6 35u

#define RECEIVED_MAX 49152u

static struct {
    bool scans;
    bool ct_information;
    uint8_t crc;
    uint32_t frequency_chz;
    uint16_t revolution;
    unsigned packet; /* The next packet of this revolution. */
    uint8_t received[RECEIVED_MAX];
    size_t received_count;
    const char *wrong;
} lidar;

void turning_begin(bool ct_information)
{
    lidar.scans = false;
    lidar.ct_information = ct_information;
    lidar.crc = 0;
    lidar.frequency_chz = 600;
    lidar.revolution = 0;
    lidar.packet = PACKETS - 1;
    lidar.received_count = 0;
    lidar.wrong = NULL;
}

static size_t step_frequency(int32_t chz, uint8_t *reply)
{
    const int32_t wanted = (int32_t)lidar.frequency_chz + chz;
    lidar.frequency_chz = (uint32_t)(wanted < 600 ? 600 : wanted > 1200 ? 1200 : wanted);
    return encode_frequency_reply(reply, lidar.frequency_chz);
}

size_t turning_command(uint8_t code, uint8_t *reply)
{
    static const encode_information_t information = {.model = 151, .serial = {2, 0, 2, 6}};
    if (lidar.scans) {
        lidar.scans = code != 0x65 && code != 0x40;
        return 0;
    }
    switch (code) {
    case 0x60:
        lidar.scans = true;
        return encode_scan_reply(reply);
    case 0x90:
        return encode_information_reply(reply, &information);
    case 0x92:
        return encode_health_reply(reply, 0, 0);
    case 0x0D:
        return step_frequency(0, reply);
    case 0x09:
        return step_frequency(10, reply);
    case 0x0A:
        return step_frequency(-10, reply);
    case 0x0B:
        return step_frequency(100, reply);
    case 0x0C:
        return step_frequency(-100, reply);
    default:
        return 0;
    }
}

static unsigned samples_of(unsigned packet)
{
    return packet == 0 ? 1 : packet == PACKETS - 1 ? LAST_SAMPLES : 40;
}

static uint8_t ct_of(unsigned packet)
{
    static const encode_turn_t turn = {
        .frequency_dhz = 61, .user_major = 1, .hardware = 1, .firmware_major = 1, .year = 2026};
    return packet == 0 || lidar.ct_information ? encode_ct(&turn, packet) : 0;
}

static size_t make_packet(uint8_t *out, unsigned packet, uint16_t revolution)
{
    encode_sample_t samples[40];
    const unsigned count = samples_of(packet);
    const unsigned before = packet == 0 ? 0 : 1 + 40 * (packet - 1);
    const encode_packet_t content = {.ct = ct_of(packet),
                                     .lsn = (uint8_t)count,
                                     .first_q6 = (uint16_t)(before * STEP_Q6),
                                     .last_q6 = (uint16_t)((before + count - 1) * STEP_Q6),
                                     .samples = samples};
    for (unsigned i = 0; i < count; i++) {
        samples[i] = (encode_sample_t){.distance_mm = (uint16_t)(revolution + 1),
                                       .intensity = (uint8_t)(before + i)};
    }
    return encode_packet(out, &content);
}

size_t turning_packet(uint8_t *out, uint32_t *now_ms)
{
    const unsigned packet = lidar.packet;
    const uint16_t revolution = lidar.revolution;
    *now_ms += (samples_of(packet) + 3) / 4;
    lidar.packet = (packet + 1) % PACKETS;
    if (lidar.packet == 0) {
        lidar.revolution = (uint16_t)((revolution + 1) % 8192);
    }
    const size_t guard = packet == 0 && lidar.ct_information ? 1 : 0;
    out[0] = lidar.crc;
    lidar.crc = encode_crc8(packet == 0 ? 0 : lidar.crc, ct_of(packet));
    return lidar.scans ? guard + make_packet(out + guard, packet, revolution) : 0;
}

bool turning_received(const uint8_t *bytes, size_t count)
{
    if (RECEIVED_MAX - lidar.received_count < count) {
        return false;
    }
    memcpy(&lidar.received[lidar.received_count], bytes, count);
    lidar.received_count += count;
    return true;
}

/* ---- Checks of the delivered scans ---- */

static void complain(bool is_wrong, const char *what)
{
    if (is_wrong && lidar.wrong == NULL) {
        lidar.wrong = what;
    }
}

void turning_judge(const tmini_scan_t *scan)
{
    unsigned next = 0;
    bool lacks = false;
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const unsigned sample = point->angle_q6 / STEP_Q6;
        complain(point->angle_q6 % STEP_Q6 != 0 || sample >= TURNING_POINTS ||
                     point->intensity != (uint8_t)sample || point->flag != 0 ||
                     point->distance_mm == 0 || point->distance_mm > lidar.revolution + 1u,
                 "a point that was never sent");
        complain(point->distance_mm != scan->points[0].distance_mm, "points of two revolutions");
        complain(sample < next, "points out of order");
        lacks = lacks || sample != next;
        next = sample + 1;
    }
    lacks = lacks || (next != TURNING_POINTS && scan->dropped == 0);
    complain(scan->complete && (lacks || scan->dropped > 0), "complete, but something is missing");
    complain(lacks && scan->gaps == 0, "something is missing, and no gap says so");
}

/* Sets `context` if this packet was never sent: remains of others look like one by chance. */
static void look_for_chance(void *context, const reference_item_t *item)
{
    uint8_t sent[TURNING_PACKET_MAX];
    const unsigned before = (item->fsa >> 1) / STEP_Q6;
    const unsigned packet = before == 0 ? 0 : (before + 39) / 40;
    const uint16_t revolution = (uint16_t)((item->bytes[12] * 64u + item->bytes[11] / 4u) - 1u);
    bool *const by_chance = context;
    if (packet >= PACKETS || make_packet(sent, packet, revolution) != item->length ||
        memcmp(sent, item->bytes, item->length) != 0) {
        *by_chance = true;
    }
}

const char *turning_verdict(void)
{
    const reference_options_t options = {.max_samples = 80};
    bool by_chance = false;
    if (lidar.wrong != NULL) {
        (void)reference_decode(lidar.received, lidar.received_count, &options, look_for_chance,
                               &by_chance);
    }
    return by_chance ? NULL : lidar.wrong;
}
