/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * A pseudo-terminal as the host's end. The slave is made raw (no echo, no line discipline) at the
 * start and whenever a client has left. It is not kept open here, so that poll() reports "hung up"
 * on the master exactly while there is no client.
 */

#define _XOPEN_SOURCE 600

#include "host.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

static bool make_raw(int fd)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0) {
        return false;
    }
    settings.c_iflag &=
        ~(tcflag_t)(IGNBRK | BRKINT | PARMRK | ISTRIP | INLCR | IGNCR | ICRNL | IXON | IXOFF);
    settings.c_oflag &= ~(tcflag_t)OPOST;
    settings.c_lflag &= ~(tcflag_t)(ECHO | ECHONL | ICANON | ISIG | IEXTEN);
    settings.c_cflag &= ~(tcflag_t)(CSIZE | PARENB);
    settings.c_cflag |= CS8;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    return tcsetattr(fd, TCSANOW, &settings) == 0;
}

/* Makes the slave raw and discards bytes that an earlier client left unread. Bytes that a new
 * client has already sent stay. */
static bool prepare_slave(const char *path)
{
    const int slave = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    bool done;
    if (slave < 0) {
        return false;
    }
    done = make_raw(slave) && tcflush(slave, TCIFLUSH) == 0;
    close(slave);
    return done;
}

static bool has_client(const host_t *host)
{
    struct pollfd entry = {host->fd, POLLIN, 0};
    return poll(&entry, 1, 0) >= 0 && (entry.revents & POLLHUP) == 0;
}

static bool update_pty(host_t *host)
{
    const bool connected = has_client(host);
    if (host->connected && !connected) {
        host_forget_client(host);
        prepare_slave(host->address);
    }
    return connected;
}

static bool open_master(host_t *host)
{
    const char *path;
    host->fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (host->fd < 0 || grantpt(host->fd) != 0 || unlockpt(host->fd) != 0) {
        return false;
    }
    path = ptsname(host->fd);
    if (path == NULL || strlen(path) >= sizeof host->address) {
        return false;
    }
    strcpy(host->address, path);
    return fcntl(host->fd, F_SETFL, O_NONBLOCK) == 0;
}

bool host_open_pty(host_t *host)
{
    host_reset(host);
    host->update = update_pty;
    if (open_master(host) && prepare_slave(host->address)) {
        return true;
    }
    fprintf(stderr, "tmini-sim: no pseudo-terminal: %s\n", strerror(errno));
    host_close(host);
    return false;
}
