/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a lidar sends, passed on to listeners as timed streams (tmini_timed.h). Knows nothing of
 * networks: it has a queue of bytes for each listener, which a server empties as fast as the
 * network takes them. A listener that is too slow loses all that waits for it, and is told so by an
 * empty chunk. No function waits. */

#ifndef BRIDGE_H
#define BRIDGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BRIDGE_LISTENERS_MAX 4

/* For each listener: more than half a second of a scanning lidar. */
#define BRIDGE_QUEUE_SIZE 8192u

/* The lidar scans on for this long after the last listener has gone: it may come back at once. */
#define BRIDGE_LINGER_US 2000000u

typedef struct {
    bool is_used;
    bool is_told;     /* The times of its chunks have begun. */
    uint64_t told_us; /* The time of its latest chunk. */
    size_t first;     /* The place of the first byte in the queue. */
    size_t count;
    size_t begun;       /* The first bytes, which are not dropped: the rest of a chunk. */
    uint32_t stretches; /* How often it was too slow. */
    uint8_t queue[BRIDGE_QUEUE_SIZE];
} bridge_listener_t;

/* All 0: no listeners. */
typedef struct {
    bridge_listener_t listeners[BRIDGE_LISTENERS_MAX];
    uint64_t left_us; /* When the last listener has gone; 0: there was none. */
} bridge_t;

/* A listener has come: its number, or -1 if there are too many. */
int bridge_join(bridge_t *bridge);
void bridge_leave(bridge_t *bridge, int listener, uint64_t now_us);

/* The lidar is to scan. */
bool bridge_is_wanted(const bridge_t *bridge, uint64_t now_us);

/* Passes on what came from the lidar at `now_us`. No bytes: here an unknown number was lost. */
void bridge_pass(bridge_t *bridge, uint64_t now_us, const uint8_t *bytes, size_t count);

/* Returns how many bytes can be sent to this listener, at least, and where they are. Then say how
 * many of them were sent. */
size_t bridge_next(const bridge_t *bridge, int listener, const uint8_t **bytes);
void bridge_sent(bridge_t *bridge, int listener, size_t count);

/* Whether a browser's request may have the stream: it names this server by an address, by
 * "localhost" or by `own_name`, and comes from a page of this server. Otherwise any page in a
 * browser could see the room. `host`, `origin`: the headers; NULL: absent. */
bool bridge_may_listen(const char *host, const char *origin, const char *own_name);

#endif
