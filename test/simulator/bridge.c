/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "bridge.h"

#include <string.h>

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

void bridge_put(bridge_t *bridge, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        deliver(bridge, bytes[i]);
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
