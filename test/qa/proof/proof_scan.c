/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of scans and CT information, from any sound state, with any packet of up to 3 samples. */

#include "proof.h"

#define CAPACITY 4u

static tmini_ring_t ring;
static tmini_frame_t frame;
static tmini_packet_t packet;
static tmini_point_t points[CAPACITY + 1];
static tmini_builder_t builder;

tmini_frame_t nondet_frame(void);
tmini_builder_t nondet_builder(void);
tmini_ct_t nondet_ct(void);

static void any_packet(void)
{
    ring = any_early_ring(RING_SIZE);
    frame = nondet_frame();
    frame.ring = &ring;
    ASSUME(frame.header[1] >= 1 && frame.header[1] <= ((frame.header[0] & 1u) != 0 ? 1 : 3));
    tmini_packet_open(&packet, &frame);
}

static void any_builder(void)
{
    builder = nondet_builder();
    builder.open = any_bool();
    builder.ended = any_bool();
    builder.scan.complete = any_bool();
    builder.scan.upside_down = any_bool();
    builder.scan.points = points;
    ASSUME(builder.capacity <= CAPACITY && builder_is_sound(&builder));
}

void prove_packet_open(void)
{
    any_packet();
    CLAIM(packet_is_sound(&packet, &frame));
}

/* Writes no more points than there is room for, and only valid values. */
void prove_packet_points(void)
{
    any_packet();
    const size_t room = nondet_size();
    const size_t index = nondet_size();
    ASSUME(room <= CAPACITY);
    points[room].angle_q6 = 0xEEEE;
    const size_t count = tmini_packet_points(&packet, nondet_byte(), points, room);
    CLAIM(count == (packet.count < room ? packet.count : room));
    CLAIM(index >= count || points[index].angle_q6 < TMINI_FULL_CIRCLE_Q6);
    CLAIM(index >= count || (points[index].distance_mm < 16384 && points[index].flag <= 3));
    CLAIM(points[room].angle_q6 == 0xEEEE);
    (void)tmini_packet_has_range(&packet);
}

void prove_scan_init(void)
{
    const size_t capacity = nondet_size();
    const unsigned filter = nondet_word();
    const bool is_null = any_bool();
    const tmini_status_t status =
        tmini_builder_init(&builder, is_null ? NULL : points, capacity, filter);
    CLAIM((status == TMINI_OK) ==
          (!is_null && capacity >= 1 && capacity <= 65535 && (filter & ~12u) == 0));
    CLAIM(status != TMINI_OK || builder_is_sound(&builder));
}

/* As in the driver: a packet that ends a scan is then added to the next one. */
void prove_scan_step(void)
{
    any_packet();
    any_builder();
    const bool was_open = builder.open;
    const bool had_start = builder.origin_q6 != UINT16_MAX;
    const uint32_t now_ms = nondet_word();
    points[builder.capacity].angle_q6 = 0xEEEE;
    if (tmini_builder_add(&builder, &packet, now_ms)) {
        CLAIM(builder_is_sound(&builder) && was_open && !builder.open && builder.ended);
        CLAIM(!builder.scan.complete || tmini_packet_is_start(&packet));
        CLAIM(!builder.scan.complete || packet.gap <= 1);
        CLAIM(!builder.scan.complete || (builder.scan.gaps == 0 && builder.scan.dropped == 0));
        CLAIM(!tmini_builder_add(&builder, &packet, now_ms));
    }
    CLAIM(builder_is_sound(&builder));
    const bool may_open = was_open || tmini_packet_is_start(&packet) || had_start;
    const bool has_packet = tmini_frame_intact(packet.frame) || builder.scan.packets > 0;
    CLAIM(builder.open == (may_open && has_packet));
    CLAIM(points[builder.capacity].angle_q6 == 0xEEEE);
}

void prove_scan_refute(void)
{
    any_builder();
    ASSUME(builder.open);
    tmini_builder_refute(&builder);
    CLAIM(builder_is_sound(&builder) && builder.scan.gaps > 0);
    tmini_builder_discard(&builder);
    CLAIM(!builder.open);
}

/* CRC-8/MAXIM as defined, bit by bit. */
static uint8_t crc_of(uint8_t crc, uint8_t byte)
{
    crc ^= byte;
    for (unsigned bit = 0; bit < 8; bit++) {
        crc = (uint8_t)((crc & 1u) != 0 ? crc >> 1 ^ 0x8C : crc >> 1);
    }
    return crc;
}

void prove_ct_crc(void)
{
    const uint8_t crc = nondet_byte();
    const uint8_t byte = nondet_byte();
    CLAIM(tmini_ct_crc8(crc, byte) == crc_of(crc, byte));
}

static tmini_ct_t any_ct(void)
{
    tmini_ct_t ct = nondet_ct();
    ASSUME(ct_is_sound(&ct));
    return ct;
}

/* Only values that LastCRC has confirmed are trusted. */
void prove_ct_add(void)
{
    any_packet();
    tmini_ct_t ct = any_ct();
    const tmini_ct_t before = ct;
    const size_t field = nondet_size();
    ASSUME(field < TMINI_CT_FIELDS);
    const tmini_ct_verdict_t verdict = tmini_ct_add(&ct, &packet, any_bool());
    CLAIM(ct_is_sound(&ct));
    CLAIM(verdict == TMINI_CT_UNKNOWN || (tmini_packet_is_start(&packet) && packet.gap == 1));
    CLAIM(verdict != TMINI_CT_CONFIRMED || frame.last_skipped == before.crc);
    CLAIM(verdict == TMINI_CT_CONFIRMED ||
          (ct.known == before.known && ct.trusted[field] == before.trusted[field]));
    CLAIM((before.known & ~ct.known) == 0);
}

void prove_ct_read(void)
{
    const tmini_ct_t ct = any_ct();
    tmini_ct_info_t info;
    tmini_ct_read(&ct, &info);
    const unsigned faults = tmini_ct_faults(&ct);
    CLAIM(info.user_major <= 3 && info.user_minor <= 31 && info.faults <= TMINI_FAULT_MASK);
    CLAIM(info.hardware <= 7 && info.firmware_major <= 15 && info.firmware_minor <= 127);
    CLAIM(info.month <= 15 && info.day <= 31 && info.number <= 2097151);
    CLAIM(info.year == 0 || (info.year >= 2020 && info.year <= 2051));
    CLAIM(faults <= TMINI_FAULT_MASK ||
          (faults == TMINI_FAULTS_UNKNOWN && (info.known & TMINI_KNOWN_FAULTS) == 0));
}
