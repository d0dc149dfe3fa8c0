/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* POSIX, and extensions to it: the baud rate, exclusive use and flock(). */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE
#define _DARWIN_C_SOURCE

#include "tmini_posix.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#ifdef __linux__
#include <linux/serial.h>
#endif

#ifndef B230400
#error "this system's termios.h has no 230400 baud, the lidar's only baud rate"
#endif

/* Half of the smallest receive buffer that a lidar may have. */
#define BLOCK_SIZE 128

#define SOCKET_PREFIX "tcp:"
#define CONNECT_MS 5000u

/* For how long a socket's first bytes are awaited, which show whether the stream is timed. */
#define GREETING_MS 600u

/* The pause between two attempts to open a device that has disappeared. */
#define RETRY_MS 200u

/* ----------------------------------------------------------------------------------- starting */

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

/* TIOCEXCL keeps other programs out, except those of root; flock() also those, if they call it
 * too. */
static tmini_posix_status_t claim(int fd)
{
    if (isatty(fd) == 0 || tcgetpgrp(fd) >= 0) { /* Or our own terminal. */
        return TMINI_POSIX_NOT_A_TERMINAL;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        return TMINI_POSIX_BUSY;
    }
    (void)ioctl(fd, TIOCEXCL);
    return TMINI_POSIX_OK;
}

/* Bytes pass unchanged in both directions; no modem lines, no flow control. With VMIN 1, read()
 * fails with EAGAIN if there are no bytes; if it returns 0, the device has hung up. */
static void make_raw(struct termios *settings)
{
    settings->c_iflag = IGNBRK;
    settings->c_oflag = 0;
    settings->c_lflag = 0;
    settings->c_cflag = CS8 | CREAD | CLOCAL;
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
}

/* Some drivers accept a rate that they cannot set, so the settings are read back. */
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

void tmini_posix_init(tmini_posix_t *port, const char *path)
{
    *port = (tmini_posix_t){.path = path, .fd = -1, .state = TMINI_POSIX_NO_DEVICE};
}

/* Child processes do not inherit the descriptor: a child of system() would keep the device claimed.
 * Reading and writing never wait. On systems where this is a socket's option, no signal is raised
 * when the other end has gone. */
static void make_own(int fd)
{
    (void)fcntl(fd, F_SETFD, FD_CLOEXEC);
    (void)fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
#if !defined(MSG_NOSIGNAL) && defined(SO_NOSIGPIPE)
    const int on = 1;
    (void)setsockopt(fd, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
}

static tmini_posix_status_t open_device(tmini_posix_t *port)
{
    do {
        port->fd = open(port->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    } while (port->fd < 0 && errno == EINTR);
    if (port->fd < 0) {
        return status_of_open(errno);
    }
    port->timed.kind = TMINI_TIMED_RAW;
    const tmini_posix_status_t status = claim(port->fd);
    if (status != TMINI_POSIX_OK) {
        (void)close(port->fd); /* Not close_port(): it would end another program's claim. */
        port->fd = -1;
        return status;
    }
    return set_up(port->fd);
}

static int64_t now_us(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int64_t tmini_posix_now_us(const tmini_posix_t *port)
{
    return tmini_timed_now_us(&port->timed, now_us());
}

/* Without a port: the system's clock. */
static uint32_t now_ms(void *context)
{
    return (uint32_t)((context != NULL ? tmini_posix_now_us(context) : now_us()) / 1000);
}

/* Waits until a connection is established. Returns 0 or an error number. */
static int await_connection(int fd)
{
    const uint32_t begun_ms = now_ms(NULL);
    struct pollfd socket = {.fd = fd, .events = POLLOUT};
    socklen_t size = sizeof(int);
    int error = 0;
    int ready = 0;
    do {
        const uint32_t passed_ms = now_ms(NULL) - begun_ms;
        ready = poll(&socket, 1, passed_ms < CONNECT_MS ? (int)(CONNECT_MS - passed_ms) : 0);
    } while (ready < 0 && errno == EINTR);
    if (ready <= 0) {
        return ready == 0 ? ETIMEDOUT : errno;
    }
    return getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

/* Returns the socket, or -1 with errno set. After a signal connect() continues in the
 * background. */
static int connect_to(const struct addrinfo *place)
{
    const int on = 1;
    const int fd = socket(place->ai_family, place->ai_socktype, place->ai_protocol);
    if (fd < 0) {
        return -1;
    }
    make_own(fd);
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    int error = connect(fd, place->ai_addr, place->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS || error == EINTR) {
        error = await_connection(fd);
    }
    if (error != 0) {
        (void)close(fd);
        errno = error;
        return -1;
    }
    return fd;
}

/* Checked here, because the system would turn 99999 into 34463. */
static bool is_port_number(const char *text)
{
    const size_t digits = strspn(text, "0123456789");
    const long number = strtol(text, NULL, 10);
    return digits >= 1 && digits <= 5 && text[digits] == '\0' && number >= 1 && number <= 65535;
}

/* The addresses of "HOST:PORT"; NULL: none. PORT is after the last colon, because HOST may be an
 * IPv6 address, in brackets or not. */
static struct addrinfo *places_of(const char *address)
{
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    const char *const colon = strrchr(address, ':');
    struct addrinfo *places = NULL;
    char name[256];
    if (colon == NULL || colon == address || !is_port_number(colon + 1)) {
        return NULL;
    }
    const bool in_brackets = address[0] == '[' && colon[-1] == ']';
    const char *const host = in_brackets ? address + 1 : address;
    const size_t length = (size_t)(colon - host) - (in_brackets ? 1 : 0);
    if (length >= sizeof name) {
        return NULL;
    }
    memcpy(name, host, length);
    name[length] = '\0';
    return getaddrinfo(name, colon + 1, &hints, &places) == 0 ? places : NULL;
}

static tmini_posix_status_t open_socket(tmini_posix_t *port)
{
    struct addrinfo *const places = places_of(port->path + sizeof SOCKET_PREFIX - 1);
    if (places == NULL) {
        return TMINI_POSIX_ADDRESS;
    }
    for (const struct addrinfo *place = places; place != NULL && port->fd < 0;
         place = place->ai_next) {
        port->fd = connect_to(place);
    }
    const int error = errno;
    freeaddrinfo(places);
    errno = error;
    if (port->fd < 0) {
        return TMINI_POSIX_FAILED;
    }
    return TMINI_POSIX_OK;
}

tmini_posix_status_t tmini_posix_start_on(tmini_posix_t *port, int fd, tmini_t *lidar)
{
    tmini_posix_stop(port);
    port->lidar = lidar;
    port->received = 0;
    port->fd = fd;
    port->state = TMINI_POSIX_OK;
    tmini_timed_begin(&port->timed);
    make_own(fd);
    return port->state;
}

static void close_port(tmini_posix_t *port, tmini_posix_status_t state)
{
    if (port->fd >= 0) {
        (void)ioctl(port->fd, TIOCNXCL);
        (void)close(port->fd);
    }
    port->fd = -1;
    port->state = state;
}

static void open_port(tmini_posix_t *port)
{
    const bool is_socket = strncmp(port->path, SOCKET_PREFIX, sizeof SOCKET_PREFIX - 1) == 0;
    tmini_timed_begin(&port->timed);
    port->state = is_socket ? open_socket(port) : open_device(port);
    if (port->state != TMINI_POSIX_OK) {
        const int error = errno;
        close_port(port, port->state);
        errno = error;
    }
    port->tried_ms = now_ms(NULL);
}

/* What a failure of read() or write() means. No bytes yet, or a signal, is no failure. */
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
    case EPIPE:
    case ECONNRESET:
    case ETIMEDOUT:
        return TMINI_POSIX_UNPLUGGED;
    default:
        return TMINI_POSIX_FAILED;
    }
}

/* Waits for bytes. Returns false if none came. */
static bool await_bytes(tmini_posix_t *port, int timeout_ms)
{
    struct pollfd device = {.fd = port->fd, .events = POLLIN};
    const int ready = poll(&device, 1, timeout_ms);
    if (ready < 0) {
        port->state = status_of_transfer(errno);
    }
    return ready > 0;
}

/* What kind of stream comes, judged by its first bytes; those of the lidar stay in the
 * socket. */
static void recognise(tmini_posix_t *port)
{
    uint8_t first[TMINI_TIMED_MAGIC_SIZE];
    const ssize_t count = recv(port->fd, first, sizeof first, MSG_PEEK);
    if (count < 0 && status_of_transfer(errno) == TMINI_POSIX_OK) {
        return;
    }
    if (count <= 0 || memcmp(first, tmini_timed_magic, (size_t)count) != 0) {
        port->timed.kind = TMINI_TIMED_RAW;
    } else if (count == sizeof first) {
        port->timed.kind = TMINI_TIMED_YES;
        (void)recv(port->fd, first, sizeof first, 0);
    } else {
        (void)poll(NULL, 0, 1); /* More will come soon. */
    }
}

/* Waits until it is known whether the stream is timed. */
static void await_greeting(tmini_posix_t *port)
{
    const uint32_t begun_ms = now_ms(NULL);
    uint32_t passed_ms = 0;
    while (port->state == TMINI_POSIX_OK && port->timed.kind == TMINI_TIMED_UNKNOWN &&
           passed_ms < GREETING_MS) {
        if (await_bytes(port, (int)(GREETING_MS - passed_ms))) {
            recognise(port);
        }
        passed_ms = now_ms(NULL) - begun_ms;
    }
}

tmini_posix_status_t tmini_posix_start(tmini_posix_t *port, tmini_t *lidar)
{
    tmini_posix_stop(port); /* If it was started before, nothing is left open. */
    port->lidar = lidar;
    port->received = 0;
    port->reconnections = 0;
    port->is_started = true;
    open_port(port);
    await_greeting(port);
    return port->state;
}

void tmini_posix_stop(tmini_posix_t *port)
{
    close_port(port, TMINI_POSIX_NO_DEVICE);
    port->is_started = false;
}

/* ------------------------------------------------------------------------------- reconnecting */

void tmini_posix_reconnect(tmini_posix_t *port, bool reconnects)
{
    port->reconnects = reconnects;
}

static bool is_away(const tmini_posix_t *port)
{
    return port->reconnects && port->is_started && port->state != TMINI_POSIX_OK;
}

/* Bytes that were on their way when the device disappeared are lost. */
static void open_again(tmini_posix_t *port)
{
    close_port(port, TMINI_POSIX_UNPLUGGED);
    open_port(port);
    if (port->state == TMINI_POSIX_OK) {
        port->reconnections++;
        if (port->lidar != NULL) {
            tmini_feed_gap(port->lidar);
        }
    }
}

/* Pauses for at most `timeout_ms`. If it is time, tries once to open the device. */
static void wait_for_device(tmini_posix_t *port, int timeout_ms)
{
    const uint32_t passed_ms = now_ms(NULL) - port->tried_ms;
    const int left_ms = passed_ms < RETRY_MS ? (int)(RETRY_MS - passed_ms) : 0;
    const bool is_early = timeout_ms >= 0 && timeout_ms < left_ms;
    (void)poll(NULL, 0, is_early ? timeout_ms : left_ms);
    if (!is_early) {
        open_again(port);
    }
}

/* ---------------------------------------------------------------------------------- receiving */

void tmini_posix_tap(tmini_posix_t *port, tmini_posix_tap_t tap, void *context)
{
    port->tap = tap;
    port->tap_context = context;
}

static void take(tmini_posix_t *port, const uint8_t *bytes, size_t count)
{
    port->received += count;
    if (port->tap != NULL) {
        port->tap(port->tap_context, bytes, count);
    }
    if (port->lidar != NULL) {
        tmini_feed(port->lidar, bytes, count);
    }
}

/* Bytes that the ring has no room for are safe in the system until polling has made room. */
static size_t room(const tmini_posix_t *port)
{
    const size_t space = port->lidar != NULL ? tmini_feed_room(port->lidar) : BLOCK_SIZE;
    return space < BLOCK_SIZE ? space : BLOCK_SIZE;
}

/* True if all `wanted` bytes have come: there may be more. */
static bool take_block(tmini_posix_t *port, size_t wanted)
{
    uint8_t block[BLOCK_SIZE];
    const ssize_t count = read(port->fd, block, wanted);
    if (count > 0) {
        take(port, block, (size_t)count);
    } else {
        port->state = count == 0 ? TMINI_POSIX_UNPLUGGED : status_of_transfer(errno);
    }
    return count == (ssize_t)wanted;
}

static void report_held(const tmini_posix_t *port)
{
    int held = 0;
    if (port->lidar != NULL && port->timed.kind == TMINI_TIMED_YES) {
        tmini_feed_held(port->lidar, tmini_timed_left(&port->timed));
    } else if (port->lidar != NULL && ioctl(port->fd, FIONREAD, &held) == 0) {
        tmini_feed_held(port->lidar, held > 0 ? (size_t)held : 0);
    }
}

/* Puts what has come into `timed`. */
static void receive_timed(tmini_posix_t *port)
{
    size_t space = 0;
    uint8_t *const place = tmini_timed_room(&port->timed, &space);
    const ssize_t count = read(port->fd, place, space);
    if (count > 0) {
        tmini_timed_put(&port->timed, (size_t)count);
    } else {
        port->state = count == 0 ? TMINI_POSIX_UNPLUGGED : status_of_transfer(errno);
    }
}

/* Hands over the next chunk; the following ones as well if they came soon after it, compared with
 * the program's pause before this call, so that a slow program keeps up. Returns false if there was
 * none. */
static bool take_chunks(tmini_posix_t *port)
{
    const int64_t us = now_us();
    const int64_t span_us = 2 * (us - port->waited_us);
    int64_t begun_us = 0;
    const uint8_t *bytes = NULL;
    size_t count = 0;
    bool is_gap = false;
    bool is_any = false;
    do {
        const size_t space = room(port);
        count = space > 0 ? tmini_timed_take(&port->timed, us, space, &bytes, &is_gap) : 0;
        if (count > 0) {
            take(port, bytes, count);
        } else if (is_gap && port->lidar != NULL) {
            tmini_feed_gap(port->lidar);
        }
        begun_us = is_any ? begun_us : port->timed.clock_us;
        is_any = is_any || count > 0 || is_gap || space == 0;
    } while (count > 0 && port->timed.clock_us - begun_us < span_us);
    return is_any;
}

static void receive_raw(tmini_posix_t *port)
{
    size_t wanted = room(port);
    /* Hands over all waiting bytes at once, so that the lidar can compute when they came. */
    while (wanted > 0 && take_block(port, wanted)) {
        wanted = port->lidar != NULL ? room(port) : 0;
    }
}

static void receive(tmini_posix_t *port, int timeout_ms)
{
    const bool has_chunks = port->timed.kind == TMINI_TIMED_YES && take_chunks(port);
    if (!has_chunks && room(port) > 0 && await_bytes(port, timeout_ms)) {
        if (port->timed.kind == TMINI_TIMED_UNKNOWN) {
            recognise(port);
        }
        if (port->timed.kind == TMINI_TIMED_RAW) {
            receive_raw(port);
        } else if (port->timed.kind == TMINI_TIMED_YES) {
            receive_timed(port);
            (void)take_chunks(port);
        }
    }
    report_held(port);
}

tmini_posix_status_t tmini_posix_wait(tmini_posix_t *port, int timeout_ms)
{
    if (is_away(port)) {
        wait_for_device(port, timeout_ms);
    } else if (port->state == TMINI_POSIX_OK) {
        receive(port, timeout_ms);
    }
    port->waited_us = now_us();
    return is_away(port) ? TMINI_POSIX_OK : port->state;
}

bool tmini_posix_is_timed(const tmini_posix_t *port)
{
    return port->timed.kind == TMINI_TIMED_YES;
}

void tmini_posix_counters(const tmini_posix_t *port, tmini_posix_counters_t *counters)
{
    *counters = (tmini_posix_counters_t){0};
#ifdef TIOCGICOUNT
    struct serial_icounter_struct counted;
    if (ioctl(port->fd, TIOCGICOUNT, &counted) == 0) {
        counters->overruns = (uint32_t)counted.overrun + (uint32_t)counted.buf_overrun;
        counters->framing_errors = (uint32_t)counted.frame;
        counters->parity_errors = (uint32_t)counted.parity;
    }
#else
    (void)port;
#endif
}

/* ----------------------------------------------------------------------------------- the port */

/* write() raises a signal if a socket's other end has gone. */
static ssize_t write_quietly(int fd, const uint8_t *bytes, size_t count)
{
#ifdef MSG_NOSIGNAL
    const ssize_t sent = send(fd, bytes, count, MSG_NOSIGNAL);
    if (sent >= 0 || errno != ENOTSOCK) {
        return sent;
    }
#endif
    return write(fd, bytes, count);
}

static int write_bytes(void *context, const uint8_t *bytes, size_t count)
{
    tmini_posix_t *const port = context;
    if (port->state != TMINI_POSIX_OK || tmini_posix_is_timed(port)) {
        return -1;
    }
    const ssize_t written = write_quietly(port->fd, bytes, count);
    if (written >= 0) {
        return (int)written;
    }
    port->state = status_of_transfer(errno);
    return port->state == TMINI_POSIX_OK ? 0 : -1;
}

static void wait_a_moment(void *context)
{
    (void)tmini_posix_wait(context, 1);
}

/* The device's driver may hang, or the connection may have ended unnoticed: opens it again. */
static void restart(void *context)
{
    tmini_posix_t *const port = context;
    if (port->reconnects && port->is_started) {
        open_again(port);
    }
}

const tmini_port_t tmini_posix_port = {
    .write = write_bytes,
    .now_ms = now_ms,
    .wait = wait_a_moment,
    .restart = restart,
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
    case TMINI_POSIX_ADDRESS:
        return "no such address";
    }
    return "unknown status";
}
