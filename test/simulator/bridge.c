/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "bridge.h"

#include "reference_decoder.h"

#include <string.h>

void bridge_init(bridge_t *bridge, const bridge_config_t *config)
{
    memset(bridge, 0, sizeof *bridge);
    bridge->config = *config;
}

static void put_byte(bridge_t *bridge, uint8_t byte)
{
    if (bridge->out_count < BRIDGE_HELD) {
        bridge->out[bridge->out_count++] = byte;
    }
}

/* The byte as the host will see it. */
static void deliver(bridge_t *bridge, uint8_t byte)
{
    const bridge_kind_t kind = bridge->config.kind;
    if (kind == BRIDGE_XONXOFF && (byte == 0x11 || byte == 0x13)) {
        return;
    }
    if (kind == BRIDGE_TELNET && byte == 0xFF) {
        put_byte(bridge, byte);
    }
    byte = kind == BRIDGE_CRNL && byte == 0x0D ? 0x0A : byte;
    put_byte(bridge, kind == BRIDGE_SEVEN ? byte & 0x7F : byte);
}

/* ---- Packets ---- */

static bool is_blind(const bridge_t *bridge)
{
    const uint8_t every = bridge->config.blind_every;
    return every > 0 && bridge->turns % every == 0;
}

/* The bytes in `open` are a whole packet: delivers the one that this unit sends instead. */
static void deliver_packet(bridge_t *bridge)
{
    const uint8_t *const open = bridge->open;
    const uint8_t size = bridge->config.sample_size > 0 ? bridge->config.sample_size : 3;
    encode_sample_t samples[255];
    encode_packet_t packet = {open[2], open[3], 0, 0, samples};
    uint8_t out[ENCODE_OTHER_MAX];
    size_t count;
    bridge->turns += open[2] & 1u;
    packet.first_q6 = (uint16_t)((open[4] | (unsigned)open[5] << 8) >> 1);
    packet.last_q6 = (uint16_t)((open[6] | (unsigned)open[7] << 8) >> 1);
    for (unsigned i = 0; i < packet.lsn; i++) {
        const reference_point_t point = reference_point(open, i);
        samples[i].distance_mm = is_blind(bridge) ? 0 : point.distance_mm;
        samples[i].intensity = point.intensity;
        samples[i].flag = point.flag;
    }
    count = size == 3 ? encode_packet(out, &packet) : encode_other_packet(out, &packet, size);
    for (size_t i = 0; i < count; i++) {
        deliver(bridge, out[i]);
    }
    bridge->open_count = 0;
}

static size_t missing(const bridge_t *bridge)
{
    const size_t need = bridge->open_count < ENCODE_PACKET_HEADER
                            ? ENCODE_PACKET_HEADER
                            : ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * bridge->open[3];
    return need - bridge->open_count;
}

/* The device's stream is undamaged, so AA 55 outside of a packet begins one. */
static void put(bridge_t *bridge, uint8_t byte)
{
    bridge->open[bridge->open_count++] = byte;
    if (bridge->open_count == 2 && byte != 0x55) {
        deliver(bridge, bridge->open[0]);
        bridge->open[0] = byte;
        bridge->open_count = 1;
    }
    if (bridge->open_count == 1 && bridge->open[0] != 0xAA) {
        deliver(bridge, byte);
        bridge->open_count = 0;
    } else if (bridge->open_count >= ENCODE_PACKET_HEADER && missing(bridge) == 0) {
        deliver_packet(bridge);
    }
}

void bridge_put(bridge_t *bridge, const uint8_t *bytes, size_t count)
{
    const bool changes_packets = bridge->config.sample_size != 0 || bridge->config.blind_every != 0;
    for (size_t i = 0; i < count; i++) {
        if (changes_packets) {
            put(bridge, bytes[i]);
        } else {
            deliver(bridge, bytes[i]);
        }
    }
}

size_t bridge_take(bridge_t *bridge, uint64_t now_us, uint8_t *bytes, size_t max)
{
    const size_t count = bridge->out_count < max ? bridge->out_count : max;
    if (now_us < bridge->deliver_us || count == 0) {
        return 0;
    }
    memcpy(bytes, bridge->out, count);
    bridge->out_count -= count;
    memmove(bridge->out, bridge->out + count, bridge->out_count);
    if (bridge->out_count == 0) {
        bridge->deliver_us = now_us + bridge->config.bursts_ms * UINT64_C(1000);
    }
    return count;
}

bool bridge_kind_named(const char *name, bridge_kind_t *kind)
{
    static const char *const names[BRIDGE_KINDS] = {"clean", "telnet", "crnl", "xonxoff", "seven"};
    for (*kind = BRIDGE_CLEAN; *kind < BRIDGE_KINDS; *kind = (bridge_kind_t)(*kind + 1)) {
        if (strcmp(name, names[*kind]) == 0) {
            return true;
        }
    }
    return false;
}
