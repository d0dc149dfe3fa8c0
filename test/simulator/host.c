/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _DEFAULT_SOURCE /* cfmakeraw() */
#define _XOPEN_SOURCE 600

#include "host.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

/* Nothing signals that a client opens the pty, so it is polled at this interval. */
#define LOOK_MS 10

static void forget_client(host_t *host)
{
    host->connected = false;
    host->input_ended = false;
    host->pending_count = 0;
}

/* The events of these that there are, and POLLERR, POLLHUP. */
static short events_of(int fd, short events, int timeout_ms)
{
    struct pollfd entry = {fd, events, 0};
    return (short)(poll(&entry, 1, timeout_ms) > 0 ? entry.revents : 0);
}

/* ---- A pseudo-terminal ---- */

/* Makes the slave raw (no echo, no line discipline), at the start and whenever a client has left,
 * and discards bytes that an earlier client left unread. Bytes that a new client has already sent
 * stay. The slave is not kept open here, so that poll() reports "hung up" on the master exactly
 * while there is no client. */
static bool prepare_slave(const char *path)
{
    struct termios settings = {0};
    const int slave = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (slave < 0) {
        return false;
    }
    bool done = tcgetattr(slave, &settings) == 0;
    cfmakeraw(&settings);
    settings.c_iflag &= ~(tcflag_t)IXOFF;
    done = done && tcsetattr(slave, TCSANOW, &settings) == 0 && tcflush(slave, TCIFLUSH) == 0;
    (void)close(slave);
    return done;
}

static bool update_pty(host_t *host)
{
    const bool connected = (events_of(host->fd, POLLIN, 0) & POLLHUP) == 0;
    if (host->connected && !connected) {
        forget_client(host);
        (void)prepare_slave(host->address);
    }
    return connected;
}

static bool open_master(host_t *host)
{
    host->fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (host->fd < 0 || grantpt(host->fd) != 0 || unlockpt(host->fd) != 0) {
        return false;
    }
    const char *const path = ptsname(host->fd);
    if (path == NULL || strlen(path) >= sizeof host->address) {
        return false;
    }
    memcpy(host->address, path, strlen(path) + 1);
    return fcntl(host->fd, F_SETFL, O_NONBLOCK) == 0;
}

bool host_open_pty(host_t *host)
{
    *host = (host_t){.update = update_pty, .listener = -1};
    return open_master(host) && prepare_slave(host->address);
}

/* ---- A TCP socket ---- */

static void set_flag(int fd, int level, int option)
{
    const int on = 1;
    setsockopt(fd, level, option, &on, sizeof on);
}

static bool has_gone(const host_t *host)
{
    return (host->input_ended && events_of(host->listener, POLLIN, 0) != 0) ||
           (events_of(host->fd, 0, 0) & (POLLERR | POLLHUP)) != 0;
}

/* The next client waits in the listener's queue until the present one has gone. A client that has
 * only shut down its sending still gets the stream, until it goes or another comes. */
static bool update_tcp(host_t *host)
{
    if (host->fd >= 0 && has_gone(host)) {
        host_close(host);
        forget_client(host);
    }
    if (host->fd < 0 && (host->fd = accept(host->listener, NULL, NULL)) >= 0) {
        set_flag(host->fd, IPPROTO_TCP, TCP_NODELAY);
        fcntl(host->fd, F_SETFL, O_NONBLOCK);
    }
    return host->fd >= 0;
}

static bool listen_on(host_t *host, uint16_t port)
{
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons(port),
                                  .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    socklen_t length = sizeof address;
    host->listener = socket(AF_INET, SOCK_STREAM, 0);
    set_flag(host->listener, SOL_SOCKET, SO_REUSEADDR);
    if (bind(host->listener, (struct sockaddr *)&address, length) != 0 ||
        listen(host->listener, 4) != 0 ||
        getsockname(host->listener, (struct sockaddr *)&address, &length) != 0) {
        return false;
    }
    (void)snprintf(host->address, sizeof host->address, "127.0.0.1:%u",
                   (unsigned)ntohs(address.sin_port));
    return fcntl(host->listener, F_SETFL, O_NONBLOCK) == 0;
}

bool host_open_tcp(host_t *host, uint16_t port)
{
    *host = (host_t){.update = update_tcp, .fd = -1};
    return listen_on(host, port);
}

/* ---- Bytes ---- */

void host_wait(host_t *host, int timeout_ms)
{
    const bool is_heard = host->connected && !host->input_ended;
    const int fd = is_heard ? host->fd : host->listener; /* poll() ignores -1 */
    (void)events_of(fd, POLLIN, fd >= 0 || timeout_ms < LOOK_MS ? timeout_ms : LOOK_MS);
}

/* Reads also without a client: one that wrote and closed at once has left bytes. */
size_t host_read(host_t *host, uint8_t *bytes, size_t max)
{
    host->connected = host->update(host);
    if (host->fd < 0 || host->input_ended) {
        return 0;
    }
    const ssize_t count = read(host->fd, bytes, max);
    host->input_ended = count == 0;
    return count > 0 ? (size_t)count : 0u;
}

static void send_pending(host_t *host)
{
    const ssize_t count = write(host->fd, host->pending, host->pending_count);
    if (count > 0) {
        host->pending_count -= (size_t)count;
        memmove(host->pending, host->pending + count, host->pending_count);
    } else if (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
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

void host_close(host_t *host)
{
    (void)close(host->fd);
    host->fd = -1;
}
