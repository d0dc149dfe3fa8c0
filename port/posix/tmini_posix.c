/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* POSIX, and from beyond it the baud rate, exclusive use and flock(). */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE
#define _DARWIN_C_SOURCE

#include "tmini_posix.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#ifndef B230400
#error "this system's termios.h has no 230400 baud, the lidar's only baud rate"
#endif

/* Half of the smallest receive buffer that a lidar may have. */
#define BLOCK_SIZE 128

/* ------------------------------------------------------------------------------------- opening */

static tmini_posix_status_t status_of_open(int error)
{
    switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
    case ENOTDIR:
        return TMINI_POSIX_NO_DEVICE;
    case EACCES:
    case EPERM:
        return TMINI_POSIX_PERMISSION;
    case EBUSY:
        return TMINI_POSIX_BUSY;
    case EISDIR:
        return TMINI_POSIX_NOT_A_TERMINAL;
    default:
        return TMINI_POSIX_FAILED;
    }
}

/* TIOCEXCL keeps other users out, flock() also those with all rights, if they ask. */
static tmini_posix_status_t claim(int fd)
{
    if (isatty(fd) == 0) {
        return TMINI_POSIX_NOT_A_TERMINAL;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        return TMINI_POSIX_BUSY;
    }
    (void)ioctl(fd, TIOCEXCL);
    return TMINI_POSIX_OK;
}

/* Bytes as they are, both ways; no modem lines, no flow control. With VMIN 1, reading nothing from a
 * device without O_NONBLOCK's EAGAIN means that it has hung up. */
static void make_raw(struct termios *settings)
{
    settings->c_iflag = IGNBRK;
    settings->c_oflag = 0;
    settings->c_lflag = 0;
    settings->c_cflag = CS8 | CREAD | CLOCAL;
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
}

/* Some drivers take any rate without complaint: what they say afterwards counts. */
static tmini_posix_status_t set_up(int fd)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0) {
        return TMINI_POSIX_FAILED;
    }
    make_raw(&settings);
    if (cfsetispeed(&settings, B230400) != 0 || cfsetospeed(&settings, B230400) != 0 ||
        tcsetattr(fd, TCSANOW, &settings) != 0 || tcgetattr(fd, &settings) != 0 ||
        cfgetospeed(&settings) != B230400) {
        return TMINI_POSIX_BAUD_RATE;
    }
    (void)tcflush(fd, TCIOFLUSH);
    return TMINI_POSIX_OK;
}

tmini_posix_status_t tmini_posix_open(tmini_posix_t *serial, const char *path)
{
    *serial = (tmini_posix_t){.fd = -1, .state = TMINI_POSIX_NO_DEVICE};
    const int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (fd < 0) {
        serial->state = status_of_open(errno);
        return serial->state;
    }
    tmini_posix_status_t status = claim(fd);
    if (status == TMINI_POSIX_OK) {
        status = set_up(fd);
    }
    serial->fd = fd;
    serial->state = status;
    if (status != TMINI_POSIX_OK) {
        const int error = errno;
        tmini_posix_close(serial);
        serial->state = status;
        errno = error;
    }
    return status;
}

void tmini_posix_close(tmini_posix_t *serial)
{
    if (serial->fd >= 0) {
        (void)ioctl(serial->fd, TIOCNXCL);
        (void)close(serial->fd);
    }
    serial->fd = -1;
    serial->state = TMINI_POSIX_NO_DEVICE;
}

/* ----------------------------------------------------------------------------------- receiving */

void tmini_posix_attach(tmini_posix_t *serial, tmini_t *lidar)
{
    serial->lidar = lidar;
}

void tmini_posix_tap(tmini_posix_t *serial, tmini_posix_tap_t tap, void *context)
{
    serial->tap = tap;
    serial->tap_context = context;
}

/* What a failure of read() or write() means. Nothing there yet, or a signal, is none. */
static tmini_posix_status_t status_of_transfer(int error)
{
    switch (error) {
    case EAGAIN:
#if EWOULDBLOCK != EAGAIN
    case EWOULDBLOCK:
#endif
    case EINTR:
        return TMINI_POSIX_OK;
    case EIO:
    case ENXIO:
    case ENODEV:
    case EBADF:
        return TMINI_POSIX_UNPLUGGED;
    default:
        return TMINI_POSIX_FAILED;
    }
}

static void take(tmini_posix_t *serial, const uint8_t *bytes, size_t count)
{
    serial->received += count;
    if (serial->tap != NULL) {
        serial->tap(serial->tap_context, bytes, count);
    }
    if (serial->lidar != NULL) {
        tmini_feed(serial->lidar, bytes, count);
    }
}

tmini_posix_status_t tmini_posix_receive(tmini_posix_t *serial, int timeout_ms)
{
    if (serial->state != TMINI_POSIX_OK) {
        return serial->state;
    }
    struct pollfd device = {.fd = serial->fd, .events = POLLIN};
    const int ready = poll(&device, 1, timeout_ms);
    if (ready <= 0) {
        serial->state = ready == 0 ? TMINI_POSIX_OK : status_of_transfer(errno);
        return serial->state;
    }
    uint8_t block[BLOCK_SIZE];
    const ssize_t count = read(serial->fd, block, sizeof block);
    if (count > 0) {
        take(serial, block, (size_t)count);
    } else {
        serial->state = count == 0 ? TMINI_POSIX_UNPLUGGED : status_of_transfer(errno);
    }
    return serial->state;
}

/* ------------------------------------------------------------------------------------ the port */

static int write_bytes(void *context, const uint8_t *bytes, size_t count)
{
    tmini_posix_t *const serial = context;
    if (serial->state != TMINI_POSIX_OK) {
        return -1;
    }
    const ssize_t written = write(serial->fd, bytes, count);
    if (written >= 0) {
        return (int)written;
    }
    serial->state = status_of_transfer(errno);
    return serial->state == TMINI_POSIX_OK ? 0 : -1;
}

static uint32_t now_ms(void *context)
{
    (void)context;
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)((uint64_t)now.tv_sec * 1000u + (uint64_t)now.tv_nsec / 1000000u);
}

static void wait_a_moment(void *context)
{
    (void)tmini_posix_receive(context, 1);
}

const tmini_port_t tmini_posix_port = {
    .write = write_bytes,
    .now_ms = now_ms,
    .wait = wait_a_moment,
};

const char *tmini_posix_status_name(tmini_posix_status_t status)
{
    switch (status) {
    case TMINI_POSIX_OK:
        return "ok";
    case TMINI_POSIX_NO_DEVICE:
        return "no such device";
    case TMINI_POSIX_PERMISSION:
        return "no permission";
    case TMINI_POSIX_BUSY:
        return "used by another program";
    case TMINI_POSIX_NOT_A_TERMINAL:
        return "not a serial device";
    case TMINI_POSIX_BAUD_RATE:
        return "230400 baud not supported";
    case TMINI_POSIX_UNPLUGGED:
        return "unplugged";
    case TMINI_POSIX_FAILED:
        return "failed";
    }
    return "unknown status";
}
