/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The host's end of tmini-sim: a pseudo-terminal or a TCP socket that serves one client after
 * another. A device keeps on sending whether or not anything listens: without a client bytes are
 * discarded; a slow client gets some seconds' worth of buffer, then loses bytes, counted.
 */

#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HOST_PENDING 65536u

typedef struct host host_t;

struct host {
    bool (*update)(host_t *host); /* notices clients that come and go; returns: there is one */
    int listener;                 /* TCP only; -1: none */
    int fd;                       /* the pty's master, or the TCP client; -1: none */
    char address[64];             /* path of the slave, or 127.0.0.1:PORT */
    bool connected;
    bool input_ended; /* the client will send no more, but may still listen */
    uint64_t lost;    /* bytes that a connected client did not take in time */
    size_t pending_count;
    uint8_t pending[HOST_PENDING];
};

/* Ready for clients at `address`. False after a message on standard error. */
bool host_open_pty(host_t *host);
bool host_open_tcp(host_t *host, uint16_t port); /* loopback only; 0: any free port */

/* Waits until the client has sent something, or until the time is over. */
void host_wait(host_t *host, int timeout_ms);

/* What the client has sent, without waiting. */
size_t host_read(host_t *host, uint8_t *bytes, size_t max);

/* Sends now or as soon as the client takes it, without waiting. */
void host_write(host_t *host, const uint8_t *bytes, size_t count);

void host_close(host_t *host);

/* For the implementations: the common start, and the end of a client. */
void host_reset(host_t *host);
void host_forget_client(host_t *host);

#endif
