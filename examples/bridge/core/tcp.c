/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "tcp.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#ifndef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0
#endif

/* The system keeps at most about this many bytes for a listener: more would only be old. */
#define SYSTEM_BYTES 16384

static bool is_only_busy(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

void tcp_server_init(tcp_server_t *tcp, bridge_t *bridge)
{
    tcp->bridge = bridge;
    tcp->fd = -1;
    for (int i = 0; i < BRIDGE_LISTENERS_MAX; i++) {
        tcp->clients[i].fd = -1;
    }
}

unsigned tcp_server_listen(tcp_server_t *tcp, unsigned port, bool is_open)
{
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    socklen_t size = sizeof place;
    const int on = 1;
    place.sin_addr.s_addr = htonl(is_open ? INADDR_ANY : INADDR_LOOPBACK);
    tcp->fd = socket(AF_INET, SOCK_STREAM, 0);
    if (tcp->fd < 0) {
        return 0;
    }
    (void)setsockopt(tcp->fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    (void)fcntl(tcp->fd, F_SETFL, O_NONBLOCK);
    if (bind(tcp->fd, (struct sockaddr *)&place, size) != 0 ||
        listen(tcp->fd, BRIDGE_LISTENERS_MAX) != 0 ||
        getsockname(tcp->fd, (struct sockaddr *)&place, &size) != 0) {
        const int error = errno;
        tcp_server_close(tcp, 0);
        errno = error;
        return 0;
    }
    return ntohs(place.sin_port);
}

static void leave(tcp_server_t *tcp, tcp_client_t *client, uint64_t now_us)
{
    (void)close(client->fd);
    client->fd = -1;
    bridge_leave(tcp->bridge, client->listener, now_us);
}

static void welcome(tcp_server_t *tcp, int fd, int listener, uint64_t now_us)
{
    const int on = 1;
    tcp_client_t *client = tcp->clients;
    while (client->fd >= 0) { /* There are as many as listeners. */
        client++;
    }
    *client = (tcp_client_t){.fd = fd, .listener = listener, .took_us = now_us};
    (void)fcntl(fd, F_SETFL, O_NONBLOCK);
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &(int){SYSTEM_BYTES}, sizeof(int));
    (void)setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
}

/* Who is one too many is left at once. A flood of connections must not hold up the caller. */
static void accept_some(tcp_server_t *tcp, uint64_t now_us)
{
    for (int i = 0; i < BRIDGE_LISTENERS_MAX; i++) {
        const int fd = accept(tcp->fd, NULL, NULL);
        if (fd < 0) {
            return;
        }
        const int listener = bridge_join(tcp->bridge);
        if (listener < 0) {
            (void)close(fd);
        } else {
            welcome(tcp, fd, listener, now_us);
        }
    }
}

/* False: it has gone, or sends something. */
static bool is_listening(const tcp_client_t *client)
{
    uint8_t byte = 0;
    return recv(client->fd, &byte, sizeof byte, 0) < 0 && is_only_busy();
}

/* False: it has gone. */
static bool send_next(tcp_server_t *tcp, tcp_client_t *client, uint64_t now_us)
{
    const uint8_t *bytes = NULL;
    const size_t count = bridge_next(tcp->bridge, client->listener, &bytes);
    const ssize_t sent = count > 0 ? send(client->fd, bytes, count, MSG_NOSIGNAL) : 0;
    if (sent < 0) {
        return is_only_busy() && now_us - client->took_us < TCP_DEAD_US;
    }
    client->took_us = now_us;
    bridge_sent(tcp->bridge, client->listener, (size_t)sent);
    return true;
}

void tcp_server_serve(tcp_server_t *tcp, uint64_t now_us)
{
    accept_some(tcp, now_us);
    for (tcp_client_t *client = tcp->clients; client < tcp->clients + BRIDGE_LISTENERS_MAX;
         client++) {
        if (client->fd >= 0 && (!is_listening(client) || !send_next(tcp, client, now_us))) {
            leave(tcp, client, now_us);
        }
    }
}

void tcp_server_close(tcp_server_t *tcp, uint64_t now_us)
{
    for (tcp_client_t *client = tcp->clients; client < tcp->clients + BRIDGE_LISTENERS_MAX;
         client++) {
        if (client->fd >= 0) {
            leave(tcp, client, now_us);
        }
    }
    if (tcp->fd >= 0) {
        (void)close(tcp->fd);
    }
    tcp->fd = -1;
}
