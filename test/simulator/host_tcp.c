/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * A TCP socket on the loopback interface as the host's end. The next client waits in the
 * listener's queue until the present one has gone. A client that has only shut down its sending
 * still gets the stream, until it goes or another comes.
 */

#define _XOPEN_SOURCE 600

#include "host.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static bool has_event(int fd, short events)
{
    struct pollfd entry = {fd, events, 0};
    return poll(&entry, 1, 0) > 0 && (entry.revents & (events | POLLERR | POLLHUP)) != 0;
}

static void set_flag(int fd, int level, int option)
{
    const int on = 1;
    setsockopt(fd, level, option, &on, sizeof on);
}

static bool accept_client(host_t *host)
{
    host->fd = accept(host->listener, NULL, NULL);
    if (host->fd < 0) {
        return false;
    }
    set_flag(host->fd, IPPROTO_TCP, TCP_NODELAY);
    fcntl(host->fd, F_SETFL, O_NONBLOCK);
    return true;
}

static bool has_gone(const host_t *host)
{
    if (host->input_ended && has_event(host->listener, POLLIN)) {
        return true;
    }
    return has_event(host->fd, 0);
}

static bool update_tcp(host_t *host)
{
    if (host->fd >= 0 && has_gone(host)) {
        close(host->fd);
        host->fd = -1;
        host_forget_client(host);
    }
    if (host->fd < 0 && has_event(host->listener, POLLIN)) {
        return accept_client(host);
    }
    return host->fd >= 0;
}

static bool listen_on(host_t *host, uint16_t port)
{
    struct sockaddr_in address;
    socklen_t length = sizeof address;
    memset(&address, 0, sizeof address);
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    host->listener = socket(AF_INET, SOCK_STREAM, 0);
    if (host->listener < 0) {
        return false;
    }
    set_flag(host->listener, SOL_SOCKET, SO_REUSEADDR);
    if (bind(host->listener, (struct sockaddr *)&address, length) != 0 ||
        listen(host->listener, 4) != 0 ||
        getsockname(host->listener, (struct sockaddr *)&address, &length) != 0) {
        return false;
    }
    snprintf(host->address, sizeof host->address, "127.0.0.1:%u",
             (unsigned)ntohs(address.sin_port));
    return fcntl(host->listener, F_SETFL, O_NONBLOCK) == 0;
}

bool host_open_tcp(host_t *host, uint16_t port)
{
    host_reset(host);
    host->update = update_tcp;
    if (listen_on(host, port)) {
        return true;
    }
    fprintf(stderr, "tmini-sim: cannot listen on 127.0.0.1:%u: %s\n", (unsigned)port,
            strerror(errno));
    host_close(host);
    return false;
}
