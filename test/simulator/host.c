/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _XOPEN_SOURCE 600

#include "host.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

/* Nothing signals that a client opens the pty, so it is polled at this interval. */
#define LOOK_MS 10

void host_reset(host_t *host)
{
    memset(host, 0, sizeof *host);
    host->listener = -1;
    host->fd = -1;
}

void host_forget_client(host_t *host)
{
    host->connected = false;
    host->input_ended = false;
    host->pending_count = 0;
}

static int wait_for(int fd, short events, int timeout_ms)
{
    struct pollfd entry = {fd, events, 0};
    return poll(&entry, 1, timeout_ms);
}

void host_wait(host_t *host, int timeout_ms)
{
    if (host->connected && !host->input_ended) {
        wait_for(host->fd, POLLIN, timeout_ms);
    } else if (host->listener >= 0) {
        wait_for(host->listener, POLLIN, timeout_ms);
    } else {
        poll(NULL, 0, timeout_ms < LOOK_MS ? timeout_ms : LOOK_MS);
    }
}

/* Reads also without a client: one that wrote and closed at once has left bytes. */
size_t host_read(host_t *host, uint8_t *bytes, size_t max)
{
    ssize_t count;
    host->connected = host->update(host);
    if (host->fd < 0 || host->input_ended) {
        return 0;
    }
    count = read(host->fd, bytes, max);
    if (count == 0) {
        host->input_ended = true;
    }
    return count > 0 ? (size_t)count : 0u;
}

static bool is_passing(int error)
{
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

static void send_pending(host_t *host)
{
    const ssize_t count = write(host->fd, host->pending, host->pending_count);
    if (count > 0) {
        host->pending_count -= (size_t)count;
        memmove(host->pending, host->pending + count, host->pending_count);
    } else if (count < 0 && !is_passing(errno)) {
        host->pending_count = 0; /* the client has gone: update() will notice */
    }
}

void host_write(host_t *host, const uint8_t *bytes, size_t count)
{
    const size_t room = HOST_PENDING - host->pending_count;
    const size_t taken = count < room ? count : room;
    if (!host->connected) {
        return;
    }
    memcpy(host->pending + host->pending_count, bytes, taken);
    host->pending_count += taken;
    host->lost += count - taken;
    if (host->pending_count > 0u) {
        send_pending(host);
    }
}

static void close_fd(int *fd)
{
    if (*fd >= 0) {
        close(*fd);
    }
    *fd = -1;
}

void host_close(host_t *host)
{
    close_fd(&host->fd);
    close_fd(&host->listener);
}
