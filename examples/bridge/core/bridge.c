/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "bridge.h"

#include <string.h>

#include "tmini_timed.h"

/* The most bytes of the lidar in a chunk: three chunks fit into a queue. */
#define PART_MAX 1024u

#define HOST_MAX 64u

/* ------------------------------------------------------------------------------------- queues */

static void put(bridge_listener_t *listener, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        listener->queue[(listener->first + listener->count++) % BRIDGE_QUEUE_SIZE] = bytes[i];
    }
}

static void put_chunk(bridge_listener_t *listener, uint64_t now_us, const uint8_t *bytes,
                      size_t count)
{
    uint8_t head[TMINI_TIMED_HEAD_SIZE];
    const uint64_t passed_us = listener->is_told ? now_us - listener->told_us : 0;
    tmini_timed_write_head(head, passed_us < UINT32_MAX ? (uint32_t)passed_us : UINT32_MAX, bytes,
                           count);
    listener->is_told = true;
    listener->told_us = now_us;
    put(listener, head, sizeof head);
    put(listener, bytes, count);
}

static void pass(bridge_listener_t *listener, uint64_t now_us, const uint8_t *bytes, size_t count)
{
    if (BRIDGE_QUEUE_SIZE - listener->count < TMINI_TIMED_HEAD_SIZE + count) {
        listener->count = listener->begun;
        listener->stretches++;
        put_chunk(listener, now_us, NULL, 0);
    }
    put_chunk(listener, now_us, bytes, count);
}

void bridge_pass(bridge_t *bridge, uint64_t now_us, const uint8_t *bytes, size_t count)
{
    do {
        const size_t part = count < PART_MAX ? count : PART_MAX;
        for (size_t i = 0; i < BRIDGE_LISTENERS_MAX; i++) {
            if (bridge->listeners[i].is_used) {
                pass(&bridge->listeners[i], now_us, bytes, part);
            }
        }
        bytes = part > 0 ? bytes + part : bytes;
        count -= part;
    } while (count > 0);
}

/* The size of the chunk at the queue's beginning. */
static size_t chunk_size(const bridge_listener_t *listener)
{
    const uint8_t *const queue = listener->queue;
    const size_t first = listener->first;
    const size_t size = queue[(first + 6) % BRIDGE_QUEUE_SIZE] |
                        (size_t)queue[(first + 7) % BRIDGE_QUEUE_SIZE] << 8;
    return TMINI_TIMED_HEAD_SIZE + size;
}

size_t bridge_next(const bridge_t *bridge, int listener, const uint8_t **bytes)
{
    const bridge_listener_t *const one = &bridge->listeners[listener];
    const size_t to_end = BRIDGE_QUEUE_SIZE - one->first;
    *bytes = one->queue + one->first;
    return one->count < to_end ? one->count : to_end;
}

void bridge_sent(bridge_t *bridge, int listener, size_t count)
{
    bridge_listener_t *const one = &bridge->listeners[listener];
    while (count > 0) {
        one->begun = one->begun > 0 ? one->begun : chunk_size(one);
        const size_t part = count < one->begun ? count : one->begun;
        one->first = (one->first + part) % BRIDGE_QUEUE_SIZE;
        one->count -= part;
        one->begun -= part;
        count -= part;
    }
}

/* ---------------------------------------------------------------------------------- listeners */

int bridge_join(bridge_t *bridge)
{
    int listener = 0;
    while (listener < BRIDGE_LISTENERS_MAX && bridge->listeners[listener].is_used) {
        listener++;
    }
    if (listener == BRIDGE_LISTENERS_MAX) {
        return -1;
    }
    memset(&bridge->listeners[listener], 0, sizeof bridge->listeners[listener]);
    bridge->listeners[listener].is_used = true;
    bridge->listeners[listener].begun = TMINI_TIMED_MAGIC_SIZE;
    put(&bridge->listeners[listener], tmini_timed_magic, TMINI_TIMED_MAGIC_SIZE);
    return listener;
}

void bridge_leave(bridge_t *bridge, int listener, uint64_t now_us)
{
    bridge->listeners[listener].is_used = false;
    bridge->left_us = now_us;
}

bool bridge_is_wanted(const bridge_t *bridge, uint64_t now_us)
{
    for (size_t i = 0; i < BRIDGE_LISTENERS_MAX; i++) {
        if (bridge->listeners[i].is_used) {
            return true;
        }
    }
    return bridge->left_us > 0 && now_us - bridge->left_us < BRIDGE_LINGER_US;
}

/* ----------------------------------------------------------------------------------- browsers */

/* No name leads to an address, so a page of others cannot pretend to be one. */
static bool is_address(const char *name)
{
    return *name == '[' || name[strspn(name, "0123456789.")] == '\0';
}

static bool is_same(const char *text, const char *other)
{
    size_t i = 0;
    while (text[i] != '\0' &&
           (text[i] | ('A' <= text[i] && text[i] <= 'Z' ? 0x20 : 0)) == other[i]) {
        i++;
    }
    return text[i] == '\0' && other[i] == '\0';
}

bool bridge_may_listen(const char *host, const char *origin, const char *own_name)
{
    char name[HOST_MAX];
    if (host == NULL || *host == '\0' || strlen(host) >= sizeof name) {
        return false;
    }
    memcpy(name, host, strlen(host) + 1);
    char *const colon = strrchr(name, ':');
    if (colon != NULL && strchr(colon, ']') == NULL) {
        *colon = '\0';
    }
    if (!is_address(name) && !is_same(name, "localhost") && !is_same(name, own_name)) {
        return false;
    }
    return origin == NULL || (strncmp(origin, "http://", 7) == 0 && strcmp(origin + 7, host) == 0);
}
