/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * What tmini-sim does to the device's bytes on their way to the host: bridges and terminals that
 * change, drop or delay bytes (section 9.20). Without settings, bytes pass unchanged.
 */

#ifndef BRIDGE_H
#define BRIDGE_H

#include <stddef.h>
#include <stdint.h>

typedef enum {
    BRIDGE_CLEAN,
    BRIDGE_TELNET,  /* FF is doubled */
    BRIDGE_CRNL,    /* 0D becomes 0A */
    BRIDGE_XONXOFF, /* 11 and 13 are taken away */
    BRIDGE_SEVEN    /* seven bits */
} bridge_kind_t;

typedef struct {
    bridge_kind_t kind;
    uint16_t bursts_ms; /* bytes are delivered this often; 0: at once */
} bridge_config_t;

#define BRIDGE_HELD 65536u

/* Begins as {.config = …}. */
typedef struct {
    bridge_config_t config;
    uint64_t deliver_us; /* when `out` may be taken */
    size_t out_count;
    uint8_t out[BRIDGE_HELD];
} bridge_t;

/* The device has sent these bytes. What finds no room in `out` is lost. */
void bridge_put(bridge_t *bridge, const uint8_t *bytes, size_t count);

/* Takes at most `max` bytes that have reached the host by now. */
size_t bridge_take(bridge_t *bridge, uint64_t now_us, uint8_t *bytes, size_t max);

#endif
