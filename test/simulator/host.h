/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The host's end of tmini-sim: a pseudo-terminal or a TCP socket that serves one client after
 * another. The device sends even if nothing listens: without a client, bytes are discarded. A slow
 * client has some seconds of buffer; then it loses bytes, which are counted.
 */

#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HOST_PENDING 65536u

typedef struct host host_t;

struct host {
    bool (*update)(host_t *host); /* notices clients that come and go; true: there is one */
    int listener;                 /* TCP only; -1: none */
    int fd;                       /* the pty's master, or the TCP client; -1: none */
    char address[64];             /* path of the slave, or 127.0.0.1:PORT */
    bool connected;
    bool input_ended; /* the client will send no more, but may still listen */
    uint64_t lost;    /* bytes that a connected client did not take in time */
    size_t pending_count;
    uint8_t pending[HOST_PENDING];
};

/* Makes the host ready for clients at `address`. False: errno says why not. */
bool host_open_pty(host_t *host);
bool host_open_tcp(host_t *host, uint16_t port); /* loopback only; 0: any free port */

/* Waits until a client has sent something, or until the timeout. */
void host_wait(host_t *host, int timeout_ms);

/* Reads what the client has sent, without waiting. */
size_t host_read(host_t *host, uint8_t *bytes, size_t max);

/* Sends without waiting: now, or later when the client can take it. */
void host_write(host_t *host, const uint8_t *bytes, size_t count);

/* Shows the client at once that nothing more comes. */
void host_close(host_t *host);

#endif
