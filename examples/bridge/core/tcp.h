/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A TCP server for the bridge's streams, over the sockets of POSIX, which ESP-IDF's lwIP has, too.
 * No function waits. Listeners send nothing: who does is left. So is who takes nothing for a
 * while. (lwIP has a tcp_init(), a tcp_listen() and a tcp_close() of its own.) */

#ifndef TCP_H
#define TCP_H

#include "bridge.h"

/* A listener that takes nothing for this long is dead. */
#define TCP_DEAD_US 15000000u

typedef struct {
    int fd; /* -1: nobody. */
    int listener;
    uint64_t took_us; /* When it last took something. */
} tcp_client_t;

typedef struct {
    bridge_t *bridge;
    int fd; /* -1: not open. */
    tcp_client_t clients[BRIDGE_LISTENERS_MAX];
} tcp_server_t;

void tcp_server_init(tcp_server_t *tcp, bridge_t *bridge);

/* Listens on this TCP port; 0: any that is free. `is_open`: not only for programs on this computer.
 * Returns the number of the port, or 0 and sets errno. */
unsigned tcp_server_listen(tcp_server_t *tcp, unsigned port, bool is_open);

/* Accepts, sends, and leaves. Call it often. */
void tcp_server_serve(tcp_server_t *tcp, uint64_t now_us);

/* Ends all connections. */
void tcp_server_close(tcp_server_t *tcp, uint64_t now_us);

#endif
