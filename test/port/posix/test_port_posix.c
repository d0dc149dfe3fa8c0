/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the POSIX port with the simulated lidar at the other end of a pseudo-terminal or a socket.
 * All in this process, and in virtual time: the port's poll() and clock_gettime() are those below.
 * Time passes while poll() waits in vain. */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE /* B230400 */

#include "simulator.h"
#include "tmini/tmini_blocking.h"
#include "tmini_posix.h"

#include "unity.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static tmini_posix_t port;
static tmini_t lidar;
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static size_t tapped;

static uint64_t now_us;
static int poll_error;    /* poll() fails with it, */
static int poll_fails_ms; /* after so many milliseconds. */

static sim_t unit;      /* The simulated lidar, */
static int its_end;     /* its end of the line (-1: it is unplugged), */
static int listener;    /* where it can be reached by a socket (-1: it cannot), */
static char device[64]; /* and the port's name of it. */

/* ---- The lidar, and the time ---- */

static void close_end(int *end)
{
    if (*end >= 0) {
        (void)close(*end);
    }
    *end = -1;
}

static void make_listener(int backlog)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    listener = socket(AF_INET, SOCK_STREAM, 0);
    TEST_ASSERT_EQUAL_INT(0, bind(listener, (struct sockaddr *)&address, size));
    TEST_ASSERT_EQUAL_INT(0, listen(listener, backlog));
    TEST_ASSERT_EQUAL_INT(0, getsockname(listener, (struct sockaddr *)&address, &size));
    TEST_ASSERT_EQUAL_INT(0, fcntl(listener, F_SETFL, O_NONBLOCK));
    (void)snprintf(device, sizeof device, "tcp:127.0.0.1:%u", ntohs(address.sin_port));
}

/* A new pseudo-terminal is set for typing: it echoes, edits lines, and changes characters. */
static int open_terminal(void)
{
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(master >= 0);
    TEST_ASSERT_EQUAL_INT(0, grantpt(master));
    TEST_ASSERT_EQUAL_INT(0, unlockpt(master));
    TEST_ASSERT_EQUAL_INT(0, fcntl(master, F_SETFL, O_NONBLOCK));
    return master;
}

/* An idle lidar at another pseudo-terminal. */
static void plug_in(void)
{
    const sim_config_t config = sim_default_config();
    sim_init(&unit, &config);
    its_end = open_terminal();
    (void)snprintf(device, sizeof device, "%s", ptsname(its_end));
}

static void pull_the_cable(void)
{
    close_end(&its_end);
    close_end(&listener);
    (void)snprintf(device, sizeof device, "/dev/nowhere");
}

/* A moment of real time: what is under way inside the system arrives. */
static void rest(void)
{
    struct timeval moment = {0, 500};
    (void)select(0, NULL, NULL, NULL, &moment);
}

static void accept_connection(void)
{
    rest();
    if (its_end < 0) {
        its_end = accept(listener, NULL, NULL);
        (void)fcntl(its_end, F_SETFL, O_NONBLOCK);
    }
}

static void send_to_port(const uint8_t *bytes, size_t count)
{
    int waiting = 0;
    (void)ioctl(port.fd, FIONREAD, &waiting);
    const int wanted = waiting + (int)write(its_end, bytes, count);
    for (int i = 0; i < 1000 && ioctl(port.fd, FIONREAD, &waiting) == 0 && waiting < wanted; i++) {
        rest();
    }
}

static void pass_ms(void)
{
    uint8_t bytes[64];
    ssize_t count = 0;
    now_us += 1000;
    if (listener >= 0) {
        accept_connection();
    }
    while ((count = read(its_end, bytes, sizeof bytes)) > 0) {
        sim_receive(&unit, bytes, (size_t)count, now_us);
    }
    if (its_end >= 0) {
        send_to_port(bytes, sim_transmit(&unit, now_us, bytes, sizeof bytes));
    }
}

int poll(struct pollfd *file, nfds_t count, int timeout_ms)
{
    fd_set readable;
    fd_set writable;
    TEST_ASSERT_TRUE(count == (file != NULL ? 1 : 0));
    for (int passed_ms = 0;; passed_ms++) {
        struct timeval at_once = {0, 0};
        FD_ZERO(&readable);
        FD_ZERO(&writable);
        if (count > 0) {
            FD_SET(file->fd, file->events == POLLIN ? &readable : &writable);
        }
        const int ready = select(FD_SETSIZE, &readable, &writable, NULL, &at_once);
        if (poll_error != 0 && passed_ms == poll_fails_ms) {
            errno = poll_error;
            return -1;
        }
        if (ready != 0 || passed_ms == timeout_ms) {
            return ready;
        }
        pass_ms();
    }
}

/* Reading it takes a moment: a loop that only does this ends. */
int clock_gettime(clockid_t clock, struct timespec *now)
{
    (void)clock;
    now_us++;
    now->tv_sec = (time_t)(now_us / 1000000);
    now->tv_nsec = (long)(now_us % 1000000) * 1000;
    return 0;
}

/* ---- The rig ---- */

void setUp(void)
{
    tapped = 0;
    poll_error = 0;
    now_us = UINT64_C(0xFFFFFE00) * 1000; /* In half a second 32 bits of milliseconds wrap. */
    its_end = listener = -1;
    pull_the_cable();
    tmini_posix_init(&port, device);
}

void tearDown(void)
{
    tmini_posix_stop(&port);
    pull_the_cable();
}

static tmini_posix_status_t start(tmini_posix_t *other, const char *path)
{
    tmini_posix_init(other, path);
    return tmini_posix_start(other, NULL);
}

static void init_lidar(bool listen_only)
{
    const tmini_config_t config = {.port = &tmini_posix_port,
                                   .port_context = &port,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = sizeof points / sizeof points[0],
                                   .listen_only = listen_only};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
}

static void begin(void)
{
    plug_in();
    init_lidar(false);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
}

static void begin_by_socket(void)
{
    begin();
    pull_the_cable();
    make_listener(1);
    const uint64_t begun_us = now_us;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT64(600, (now_us - begun_us) / 1000); /* A timed stream would begin. */
}

/* Without a lidar, but it may be plugged in at any time. */
static void begin_to_wait(void)
{
    init_lidar(false);
    tmini_posix_reconnect(&port, true);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_start(&port, &lidar));
}

static tmini_status_t read_info(void)
{
    tmini_info_t info;
    const tmini_status_t status = tmini_blocking_read_info(&lidar, &info, 8000);
    TEST_ASSERT_TRUE(status != TMINI_OK || info.model == 151);
    return status;
}

/* Polls until the event comes, at most 20 s. */
static void poll_until(tmini_event_t wanted)
{
    const uint64_t end_us = now_us + 20000000;
    tmini_event_t event = TMINI_EVENT_NONE;
    do {
        TEST_ASSERT_TRUE(now_us < end_us);
        event = tmini_poll(&lidar);
        if (event == TMINI_EVENT_NONE) {
            TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 10));
        }
    } while (event != wanted);
}

/* Waits until it has received this many bytes in all, which takes no time. */
static void receive(uint64_t total)
{
    const uint64_t begun_us = now_us;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_UINT64(total, port.received);
    TEST_ASSERT_TRUE(now_us - begun_us < 1000);
}

/* Starts the port on one end of a pair of sockets, with these bytes sent to it. Returns the other
 * end. */
static int start_on_pair(tmini_t *for_lidar, const uint8_t *bytes, size_t count)
{
    int ends[2];
    TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start_on(&port, ends[0], for_lidar));
    TEST_ASSERT_EQUAL_INT(count, write(ends[1], bytes, count));
    return ends[1];
}

/* ---- Opening ---- */

static const struct {
    const char *path;
    tmini_posix_status_t status;
} unopened[] = {
    {"/dev/nowhere", TMINI_POSIX_NO_DEVICE},
    {"/dev/null", TMINI_POSIX_NOT_A_TERMINAL},
    {"/tmp", TMINI_POSIX_NOT_A_TERMINAL},
    /* Nothing listens there. */
    {"tcp:127.0.0.1:1", TMINI_POSIX_FAILED},
    {"tcp:[::1]:1", TMINI_POSIX_FAILED},
    {"tcp:::1:1", TMINI_POSIX_FAILED},
    {"tcp:", TMINI_POSIX_ADDRESS},
    {"tcp:host", TMINI_POSIX_ADDRESS},
    {"tcp::1", TMINI_POSIX_ADDRESS},
    {"tcp:host:", TMINI_POSIX_ADDRESS},
    {"tcp:127.0.0.1:0", TMINI_POSIX_ADDRESS},
    {"tcp:127.0.0.1:65536", TMINI_POSIX_ADDRESS},
    {"tcp:127.0.0.1:99999", TMINI_POSIX_ADDRESS},
    {"tcp:127.0.0.1:1x", TMINI_POSIX_ADDRESS},
    {"tcp:no.such.host.invalid:1", TMINI_POSIX_ADDRESS},
};

void test_each_reason_for_not_opening_has_its_own_status_which_stays(void)
{
    for (size_t i = 0; i < sizeof unopened / sizeof unopened[0]; i++) {
        const char *const path = unopened[i].path;
        TEST_ASSERT_EQUAL_INT_MESSAGE(unopened[i].status, start(&port, path), path);
        TEST_ASSERT_EQUAL_INT_MESSAGE(unopened[i].status, tmini_posix_wait(&port, 0), path);
    }
}

/* A host name of any number of zeros is a valid address at which nothing listens. */
void test_the_longest_host_name_has_255_characters(void)
{
    for (int digits = 255; digits <= 256; digits++) {
        char path[sizeof "tcp:" + 256 + sizeof ":1"];
        (void)snprintf(path, sizeof path, "tcp:%0*d:1", digits, 0);
        TEST_ASSERT_EQUAL_INT(digits == 255 ? TMINI_POSIX_FAILED : TMINI_POSIX_ADDRESS,
                              start(&port, path));
    }
}

void test_a_lack_of_file_descriptors_is_reported(void)
{
    struct rlimit limit;
    TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &limit));
    const struct rlimit few = {3, limit.rlim_max};
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &few));
    const tmini_posix_status_t status = start(&port, "tcp:127.0.0.1:1");
    const int error = errno;
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &limit));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, status);
    TEST_ASSERT_EQUAL_INT(EMFILE, error);
}

/* The listener's queue is full and never emptied, so that connecting waits until its timeout. */
void test_connecting_ends_after_5_s_and_not_by_a_signal(void)
{
    struct sockaddr_in address;
    socklen_t size = sizeof address;
    const int first = socket(AF_INET, SOCK_STREAM, 0);
    make_listener(0);
    TEST_ASSERT_EQUAL_INT(0, getsockname(listener, (struct sockaddr *)&address, &size));
    TEST_ASSERT_EQUAL_INT(0, connect(first, (struct sockaddr *)&address, size));
    const int full = listener;
    listener = -1; /* Nobody accepts. */
    const uint64_t begun_us = now_us;
    poll_error = EINTR;
    poll_fails_ms = 20;
    const tmini_posix_status_t status = start(&port, device);
    const int error = errno;
    close(first);
    close(full);
    if (status == TMINI_POSIX_OK) {
        TEST_IGNORE_MESSAGE("this system accepts more connections than its queue holds");
    }
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, status);
    TEST_ASSERT_EQUAL_INT(ETIMEDOUT, error);
    TEST_ASSERT_EQUAL_UINT64(5000, (now_us - begun_us) / 1000);
}

void test_a_lidar_can_be_reached_through_a_socket(void)
{
    int sends_at_once = 0;
    socklen_t size = sizeof sends_at_once;
    begin_by_socket();
    TEST_ASSERT_EQUAL_INT(0, getsockopt(port.fd, IPPROTO_TCP, TCP_NODELAY, &sends_at_once, &size));
    TEST_ASSERT_NOT_EQUAL_INT(0, sends_at_once);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, read_info());
    close_end(&its_end);
    close_end(&listener);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, read_info());
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_start(&port, &lidar));
}

void test_bytes_from_before_the_start_are_thrown_away(void)
{
    const int master = open_terminal();
    const int line = open(ptsname(master), O_RDWR | O_NOCTTY); /* Otherwise stopping would do it. */
    struct pollfd arrival = {.fd = line, .events = POLLIN};
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, start(&port, ptsname(master))); /* Makes it raw. */
    TEST_ASSERT_EQUAL_INT(3, write(master, "old", 3));
    TEST_ASSERT_EQUAL_INT(1, poll(&arrival, 1, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, NULL));
    TEST_ASSERT_EQUAL_INT(4, write(master, "news", 4));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_UINT64(4, port.received);
    close(line);
    close(master);
}

/* The system allows root to open a claimed device, but the port refuses it to root, too, and leaves
 * the claim. */
void test_a_device_is_used_by_one_program_at_a_time(void)
{
    tmini_posix_t other;
    plug_in();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, start(&port, device));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_BUSY, start(&other, device));
#if defined(TIOCGEXCL)
    int is_claimed = 0;
    TEST_ASSERT_EQUAL_INT(0, ioctl(port.fd, TIOCGEXCL, &is_claimed));
    TEST_ASSERT_EQUAL_INT(1, is_claimed);
#endif
    tmini_posix_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, start(&other, device));
    tmini_posix_stop(&other);
}

/* Otherwise Ctrl-C would no longer interrupt the program, and typed text would not be shown. */
void test_the_programs_own_terminal_is_refused(void)
{
    const int master = open_terminal();
    const pid_t child = fork();
    if (child == 0) {
        (void)setsid();
        (void)open(ptsname(master), O_RDWR); /* Becomes the session's terminal. */
        (void)ioctl(open(ptsname(master), O_RDWR), TIOCSCTTY, 0);
        _exit(start(&port, "/dev/tty") == TMINI_POSIX_NOT_A_TERMINAL &&
                      start(&port, ptsname(master)) == TMINI_POSIX_NOT_A_TERMINAL
                  ? 0
                  : 1);
    }
    int status = -1;
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_EQUAL_INT(0, status);
    close(master);
}

/* Otherwise a child of system() would keep the device claimed after the port has stopped. */
void test_children_inherit_neither_device_nor_socket(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
    const int other = start_on_pair(&lidar, NULL, 0);
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
    close(other);
    begin_by_socket();
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
}

void test_a_terminal_for_typing_becomes_a_line_for_bytes(void)
{
    /* Another program has set it so that read() returns 0 after 0.1 s without a byte. */
    struct termios settings;
    const int master = open_terminal();
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(master, &settings));
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 1;
    TEST_ASSERT_EQUAL_INT(0, tcsetattr(master, TCSANOW, &settings));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, start(&port, ptsname(master)));
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(master, &settings));
    TEST_ASSERT_EQUAL_UINT8(1, settings.c_cc[VMIN]);
    TEST_ASSERT_EQUAL_UINT8(0, settings.c_cc[VTIME]);
    TEST_ASSERT_EQUAL_HEX(0, settings.c_lflag & (tcflag_t)(ICANON | ECHO | ISIG | IEXTEN));
    TEST_ASSERT_EQUAL_HEX(0, settings.c_iflag & (tcflag_t)(ICRNL | INLCR | IGNCR | IXON | IXOFF |
                                                           ISTRIP | PARMRK | INPCK));
    TEST_ASSERT_EQUAL_HEX(0, settings.c_oflag & (tcflag_t)OPOST);
    TEST_ASSERT_EQUAL_HEX(CS8 | CREAD | CLOCAL,
                          settings.c_cflag & (tcflag_t)(CSIZE | CREAD | CLOCAL | PARENB | CSTOPB));
    TEST_ASSERT_TRUE(cfgetispeed(&settings) == B230400 && cfgetospeed(&settings) == B230400);
    close(master);
}

/* A device that is started twice is open once: its first descriptor is free again. */
void test_only_between_start_and_stop_something_is_received_or_sent(void)
{
    static const uint8_t stop[2] = {0xA5, 0x65};
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(-1, tmini_posix_port.write(&port, stop, sizeof stop));
    begin();
    const int first = port.fd;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(first, port.fd);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, read_info());
    tmini_posix_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT64(0, port.received);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, read_info());
}

/* ---- Receiving ---- */

static void tap(void *context, const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_EQUAL_PTR(&tapped, context);
    TEST_ASSERT_NOT_NULL(bytes);
    tapped += count;
}

void test_a_tap_gets_every_byte(void)
{
    begin();
    tmini_posix_tap(&port, tap, &tapped);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, read_info());
    TEST_ASSERT_EQUAL_size_t(27, tapped); /* The reply: 7 + 20 bytes. */
    TEST_ASSERT_EQUAL_UINT64(27, port.received);
    tmini_posix_tap(&port, NULL, NULL);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, read_info());
    TEST_ASSERT_EQUAL_size_t(27, tapped);
}

void test_a_line_without_counters_has_no_errors(void)
{
    tmini_posix_counters_t counters = {1, 1, 1};
    begin();
    tmini_posix_counters(&port, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.overruns + counters.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(0, counters.parity_errors);
}

/* With a lidar as many as it has room for, without one in blocks. */
void test_bytes_that_have_waited_are_handed_over_at_once(void)
{
    static const uint8_t bytes[700];
    init_lidar(false);
    close(start_on_pair(NULL, bytes, 300));
    receive(128);
    receive(256);
    receive(300);
    close(start_on_pair(&lidar, bytes, sizeof bytes));
    receive(sizeof bytes);
}

void test_bytes_without_room_stay_with_the_system_and_are_not_waited_for(void)
{
    static const uint8_t bytes[2000];
    tmini_counters_t counters;
    init_lidar(false);
    const int other = start_on_pair(&lidar, bytes, sizeof bytes);
    receive(sizeof rx);
    receive(sizeof rx);
    for (unsigned i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1));
        while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
        }
    }
    TEST_ASSERT_EQUAL_UINT64(sizeof bytes, port.received);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
    close(other);
}

/* The receive buffer holds a third of the bytes of 250 ms, the system the rest. */
void test_a_pause_of_the_program_costs_no_scan(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    for (int i = 0; i < 9; i++) {
        poll_until(TMINI_EVENT_SCAN);
        TEST_ASSERT_TRUE(tmini_scan(&lidar)->complete);
        (void)poll(NULL, 0, i == 3 || i == 6 ? 250 : 0);
    }
}

/* What the lidar sends in a third of a second, in chunks of 10 ms; all of it comes at the end. */
static void send_late(int other)
{
    static uint8_t stream[10000];
    size_t size = 0;
    for (int i = 0; i < 33; i++) {
        uint8_t *const head = stream + size;
        uint8_t *const bytes = head + TMINI_TIMED_HEAD_SIZE;
        now_us += 10000;
        const size_t count = sim_transmit(&unit, now_us, bytes, TMINI_TIMED_MAX);
        tmini_timed_write_head(head, 10000, bytes, count);
        size += TMINI_TIMED_HEAD_SIZE + count;
    }
    TEST_ASSERT_EQUAL_INT(size, write(other, stream, size));
}

/* Handles all that has come. Returns when the last scan ended; before it, scans are complete and
 * six in a second, once the lidar has `settled`. */
static uint32_t take_scans(uint32_t end_ms, bool settled)
{
    for (unsigned i = 0; i < 100; i++) {
        const tmini_event_t event = tmini_poll(&lidar);
        if (event == TMINI_EVENT_NONE) {
            TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 0));
        } else if (event == TMINI_EVENT_SCAN) {
            const tmini_scan_t *const scan = tmini_scan(&lidar);
            TEST_ASSERT_TRUE(!settled || (scan->complete && scan->end_ms - end_ms - 155 < 25));
            end_ms = scan->end_ms;
        }
    }
    return end_ms;
}

void test_a_timed_stream_that_comes_late_has_the_times_of_its_sender(void)
{
    static const uint8_t command[2] = {0xA5, SIM_COMMAND_START};
    uint32_t end_ms = 0;
    plug_in();
    close_end(&its_end);
    sim_receive(&unit, command, sizeof command, now_us);
    init_lidar(true);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    const int other = start_on_pair(&lidar, tmini_timed_magic, sizeof tmini_timed_magic);
    for (unsigned i = 0; i < 15; i++) {
        send_late(other);
        end_ms = take_scans(end_ms, i > 5);
        TEST_ASSERT_INT64_WITHIN(5000, (int64_t)now_us, tmini_posix_now_us(&port));
    }
    TEST_ASSERT_UINT32_WITHIN(90, 90, tmini_posix_port.now_ms(&port) - end_ms);
    TEST_ASSERT_TRUE(tmini_posix_is_timed(&port));
    TEST_ASSERT_EQUAL_INT(-1, tmini_posix_port.write(&port, command, sizeof command));
    close(other);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 0));
}

void test_a_failure_to_wait_for_bytes_is_an_error_but_silence_and_a_signal_are_not(void)
{
    begin();
    const uint64_t begun_us = now_us;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 20));
    TEST_ASSERT_UINT64_WITHIN(1000, 20000, now_us - begun_us);
    TEST_ASSERT_EQUAL_UINT64(0, port.received);
    poll_fails_ms = 7;
    poll_error = EINTR;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 100));
    poll_error = ENOMEM;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_wait(&port, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_wait(&port, 0));
}

/* ---- Unplugged, plugged in again ---- */

void test_an_unplugged_device_stays_unplugged_for_reading_and_writing(void)
{
    for (int writes = 0; writes < 2; writes++) {
        begin();
        pull_the_cable();
        if (writes == 0) {
            TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 1000));
        }
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, read_info());
        TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 0));
    }
}

/* The port tries a missing device only five times per second. */
void test_a_device_that_is_not_there_yet_is_waited_for(void)
{
    begin_to_wait();
    plug_in();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 199));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, port.state);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, port.state);
}

void test_a_device_that_was_stopped_is_not_waited_for(void)
{
    begin_to_wait();
    plug_in();
    tmini_posix_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 1000));
}

void test_a_cable_that_is_pulled_and_plugged_in_again_is_a_loss_and_a_recovery(void)
{
    begin_to_wait();
    plug_in();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    poll_until(TMINI_EVENT_SCAN);
    pull_the_cable();
    poll_until(TMINI_EVENT_LOST);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, port.state);
    plug_in();
    poll_until(TMINI_EVENT_RECOVERED);
    poll_until(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, port.state);
    TEST_ASSERT_TRUE(port.reconnections >= 2);
}

/* Until the gap has been handled there is no room: no scan continues across it. */
void test_a_reconnection_is_a_gap(void)
{
    begin_to_wait();
    plug_in();
    TEST_ASSERT_TRUE(tmini_feed_room(&lidar) > 0);
    (void)poll(NULL, 0, 300); /* Then the next attempt is due at once. */
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_UINT32(1, port.reconnections);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed_room(&lidar));
    (void)tmini_poll(&lidar);
    TEST_ASSERT_TRUE(tmini_feed_room(&lidar) > 0);
}

void test_every_status_has_a_name(void)
{
    for (int i = TMINI_POSIX_ADDRESS; i <= TMINI_POSIX_OK; i++) {
        const char *const name = tmini_posix_status_name((tmini_posix_status_t)i);
        TEST_ASSERT_TRUE(strlen(name) > 0 && strcmp(name, "unknown status") != 0);
    }
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_posix_status_name((tmini_posix_status_t)1));
}
