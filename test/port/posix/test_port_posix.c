/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the POSIX port with the simulated lidar at the other end of a pseudo-terminal or a socket.
 * All in this process, and in virtual time: the port's poll() and clock_gettime() are those below.
 * Time passes while poll() waits in vain. */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE /* B230400 */

#include "rows.h"
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
static int first_fd;      /* The port's, when it was begun. */
static uint64_t begun_us; /* When the last call began. */

static uint64_t now_us;
static int poll_error;    /* poll() fails with it, */
static int poll_fails_ms; /* after this time. */

static sim_t unit;      /* The simulated lidar, */
static int its_end;     /* its end of the line (-1: it is unplugged), */
static int listener;    /* where it can be reached by a socket (-1: it cannot), */
static int other_end;   /* of a pair of sockets with the port (-1: there is none), */
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

static void hang_up(void)
{
    close_end(&its_end);
    close_end(&listener);
    close_end(&other_end);
}

static void pull_the_cable(void)
{
    hang_up();
    (void)snprintf(device, sizeof device, "/dev/nowhere");
}

/* A moment of real time: what is under way inside the system arrives. */
static void rest(void)
{
    struct timeval moment = {0, 500};
    (void)select(0, NULL, NULL, NULL, &moment);
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
        rest();
    }
    if (listener >= 0 && its_end < 0) {
        its_end = accept(listener, NULL, NULL);
        (void)fcntl(its_end, F_SETFL, O_NONBLOCK);
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

void setUp(void)
{
    tapped = 0;
    poll_error = 0;
    now_us = UINT64_C(0xFFFFFE00) * 1000; /* In half a second 32 bits of milliseconds wrap. */
    its_end = listener = other_end = -1;
    pull_the_cable();
    tmini_posix_init(&port, device);
    init_lidar(false);
}

void tearDown(void)
{
    tmini_posix_stop(&port);
    hang_up();
}

static tmini_posix_status_t start(tmini_posix_t *other, const char *path)
{
    tmini_posix_init(other, path);
    return tmini_posix_start(other, NULL);
}

static void begin(void)
{
    plug_in();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    first_fd = port.fd;
}

static void begin_by_socket(void)
{
    int sends_at_once = 0;
    socklen_t size = sizeof sends_at_once;
    begin();
    pull_the_cable();
    make_listener(1);
    const uint64_t begun_us = now_us;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT64(600, (now_us - begun_us) / 1000); /* A timed stream would begin. */
    TEST_ASSERT_EQUAL_INT(0, getsockopt(port.fd, IPPROTO_TCP, TCP_NODELAY, &sends_at_once, &size));
    TEST_ASSERT_NOT_EQUAL_INT(0, sends_at_once);
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

/* Starts the port on one end of a pair of sockets, with these bytes sent to it. */
static void start_on_pair(tmini_t *for_lidar, const uint8_t *bytes, size_t count)
{
    int ends[2];
    TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start_on(&port, ends[0], for_lidar));
    TEST_ASSERT_EQUAL_INT(count, write(ends[1], bytes, count));
    close_end(&other_end);
    other_end = ends[1];
}

/* ---- Opening ---- */

static const struct {
    tmini_posix_status_t status;
    const char *paths[6];
} unopened[] = {
    {TMINI_POSIX_NO_DEVICE, {"/dev/nowhere"}},
    {TMINI_POSIX_NOT_A_TERMINAL, {"/dev/null", "/tmp"}},
    /* Nothing listens there. */
    {TMINI_POSIX_FAILED, {"tcp:127.0.0.1:1", "tcp:[::1]:1", "tcp:::1:1"}},
    {TMINI_POSIX_ADDRESS, {"tcp:", "tcp:host", "tcp::1", "tcp:host:", "tcp:127.0.0.1:0"}},
    {TMINI_POSIX_ADDRESS, {"tcp:127.0.0.1:65536", "tcp:127.0.0.1:99999", "tcp:127.0.0.1:1x"}},
    {TMINI_POSIX_ADDRESS, {"tcp:no.such.host.invalid:1"}},
};

void test_each_reason_for_not_opening_has_its_own_status_which_stays(void)
{
    for (size_t i = 0; i < sizeof unopened / sizeof unopened[0]; i++) {
        for (const char *const *path = unopened[i].paths; *path != NULL; path++) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(unopened[i].status, start(&port, *path), *path);
            TEST_ASSERT_EQUAL_INT_MESSAGE(unopened[i].status, tmini_posix_wait(&port, 0), *path);
        }
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

/* What the lidar sends in a third of a second, in chunks of 10 ms; all of it comes at the end. */
static void send_late(void)
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
    TEST_ASSERT_EQUAL_INT(size, write(other_end, stream, size));
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
    start_on_pair(&lidar, tmini_timed_magic, sizeof tmini_timed_magic);
    for (unsigned i = 0; i < 15; i++) {
        send_late();
        end_ms = take_scans(end_ms, i > 5);
        TEST_ASSERT_INT64_WITHIN(5000, (int64_t)now_us, tmini_posix_now_us(&port));
    }
    TEST_ASSERT_UINT32_WITHIN(90, 90, tmini_posix_port.now_ms(&port) - end_ms);
    TEST_ASSERT_TRUE(tmini_posix_is_timed(&port));
    TEST_ASSERT_EQUAL_INT(-1, tmini_posix_port.write(&port, command, sizeof command));
    hang_up();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 0));
}

void test_every_status_has_a_name(void)
{
    for (int i = TMINI_POSIX_ADDRESS; i <= TMINI_POSIX_OK; i++) {
        const char *const name = tmini_posix_status_name((tmini_posix_status_t)i);
        TEST_ASSERT_TRUE(strlen(name) > 0 && strcmp(name, "unknown status") != 0);
    }
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_posix_status_name((tmini_posix_status_t)1));
}

/* ---- Told in words ---- */

static void tap(void *context, const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_EQUAL_PTR(&tapped, context);
    TEST_ASSERT_NOT_NULL(bytes);
    tapped += count;
}

static const struct {
    const char *name;
    int value;
} values[] = {
    {"nodevice", TMINI_POSIX_NO_DEVICE},
    {"unplugged", TMINI_POSIX_UNPLUGGED},
    {"failed", TMINI_POSIX_FAILED},
    {"unwritten", TMINI_ERROR_WRITE},
    {"refused", -1},
    {"scan", TMINI_EVENT_SCAN},
    {"lost", TMINI_EVENT_LOST},
    {"recovered", TMINI_EVENT_RECOVERED},
    {"signal", EINTR},
    {"memory", ENOMEM},
};

static int value_of(const char *name)
{
    size_t i = 0;
    while (strcmp(values[i].name, name) != 0) {
        TEST_ASSERT_TRUE_MESSAGE(++i < sizeof values / sizeof values[0], name);
    }
    return values[i].value;
}

/* Whether the word is a number that is known, and expected. */
static bool is_fact(const char *word)
{
    tmini_counters_t counters;
    tmini_posix_counters_t line = {1, 1, 1};
    tmini_counters(&lidar, &counters);
    tmini_posix_counters(&port, &line);
    const tmini_scan_t *const scan = tmini_scan(&lidar);
    const row_number_t facts[] = {
        {"received", (uint32_t)port.received},
        {"tapped", (uint32_t)tapped},
        {"reconnections", port.reconnections},
        {"room", (uint32_t)tmini_feed_room(&lidar)},
        {"overrun", counters.bytes_overrun},
        {"errors", line.overruns + line.framing_errors + line.parity_errors},
        {"complete", scan != NULL && scan->complete},
        {"inherited", fcntl(port.fd, F_GETFD) != FD_CLOEXEC},
        {"moved", port.fd != first_fd},
        {"ms", (uint32_t)((now_us - begun_us) / 1000)},
    };
    return row_expects(word, facts);
}

/* A call's status is OK, or what follows its "=": "wait:1000=unplugged". "await": without a lidar,
 * but it may be plugged in at any time; "pair:7": on a socket with 7 bytes, "blocks:7" without a
 * lidar; "hold": another opens the device, too; "error:signal": poll() fails 7 ms later. */
static void tell(char *word)
{
    static const uint8_t bytes[2000];
    const uint32_t number = row_number(word);
    tmini_info_t info;
    char *const equals = strchr(word, '=');
    const int wanted = equals != NULL ? value_of(equals + 1) : 0;
    int status = wanted;
    word[strcspn(word, "=")] = '\0';
    if (is_fact(word)) {
        return;
    }
    begun_us = now_us;
    if (row_is(word, "begin")) {
        begin();
    } else if (row_is(word, "socket")) {
        begin_by_socket();
    } else if (row_is(word, "await")) {
        tmini_posix_reconnect(&port, true);
        status = tmini_posix_start(&port, &lidar);
    } else if (row_is(word, "plug")) {
        plug_in();
    } else if (row_is(word, "pull")) {
        pull_the_cable();
    } else if (row_is(word, "hangup")) {
        hang_up();
    } else if (row_is(word, "wait")) {
        status = tmini_posix_wait(&port, (int)number);
    } else if (row_is(word, "start")) {
        status = tmini_posix_start(&port, &lidar);
    } else if (row_is(word, "stop")) {
        tmini_posix_stop(&port);
    } else if (row_is(word, "state")) {
        status = port.state;
    } else if (row_is(word, "restart")) {
        tmini_posix_port.restart(&port);
    } else if (row_is(word, "write")) {
        status = tmini_posix_port.write(&port, bytes, 2);
    } else if (row_is(word, "tap")) {
        tmini_posix_tap(&port, number != 0 ? tap : NULL, &tapped);
    } else if (row_is(word, "info")) {
        status = (int)tmini_blocking_read_info(&lidar, &info, 8000);
        TEST_ASSERT_TRUE(status != 0 || info.model == 151);
    } else if (row_is(word, "scan")) {
        status = (int)tmini_start(&lidar);
    } else if (row_is(word, "poll")) {
        (void)tmini_poll(&lidar);
    } else if (row_is(word, "until")) {
        poll_until((tmini_event_t)value_of(row_text(word)));
    } else if (row_is(word, "pair") || row_is(word, "blocks")) {
        start_on_pair(row_is(word, "pair") ? &lidar : NULL, bytes, number);
    } else if (row_is(word, "hold")) {
        other_end = open(device, O_RDWR | O_NOCTTY);
    } else if (row_is(word, "send")) {
        send_to_port(bytes, number);
    } else if (row_is(word, "pause")) {
        (void)poll(NULL, 0, (int)number);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_is(word, "error"), word);
        poll_error = value_of(row_text(word));
        poll_fails_ms = 7;
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(wanted, status, word);
}

static const row_t rows[] = {
    /* Held open, because otherwise stopping would do it. */
    ROW(bytes_from_before_the_start_are_thrown_away,
        "begin hold send:3 start send:4 wait:1000 received:4"),
    ROW(a_lidar_can_be_reached_through_a_socket,
        "socket info hangup wait:1000=unplugged info=unwritten start=failed"),
    ROW(writing_to_a_socket_whose_other_end_has_gone_raises_no_signal,
        "pair:0 hangup write=refused state=unplugged"),
    /* Otherwise a child of system() would keep the device claimed after the port has stopped. */
    ROW(children_inherit_neither_device_nor_socket,
        "begin inherited:0 pair:0 inherited:0 hangup socket inherited:0"),
    /* A device that is started twice is open once: its first descriptor is free again. */
    ROW(only_between_start_and_stop_something_is_received_or_sent,
        "wait:0=nodevice write=refused begin start moved:0 info stop wait:0=nodevice "
        "start received:0 info"),
    /* The reply: 7 + 20 bytes. */
    ROW(a_tap_gets_every_byte, "begin tap:1 info tapped:27 received:27 tap:0 info tapped:27"),
    ROW(a_line_without_counters_has_no_errors, "begin errors:0"),
    /* With a lidar, as many as it has room for; without one, in blocks. */
    ROW(bytes_that_have_waited_are_handed_over_at_once,
        "blocks:300 hangup wait:1000 received:128 ms:0 wait:1000 received:256 ms:0 wait:1000 "
        "received:300 ms:0 pair:700 hangup wait:1000 received:700 ms:0"),
    ROW(bytes_without_room_stay_with_the_system_and_are_not_waited_for,
        "pair:2000 2( wait:1000 received:1024 ms:0 ) 20( wait:1 9( poll ) ) received:2000 "
        "overrun:0"),
    /* The receive buffer holds a third of the bytes of 250 ms, the system the rest. */
    ROW(a_pause_of_the_program_costs_no_scan,
        "begin scan until:scan complete:1 2( 3( until:scan complete:1 ) pause:250 ) "
        "2( until:scan complete:1 )"),
    ROW(a_failure_to_wait_for_bytes_is_an_error_but_silence_and_a_signal_are_not,
        "begin wait:20 ms:20 received:0 error:signal wait:100 error:memory wait:100=failed "
        "wait:0=failed"),
    ROW(an_unplugged_device_stays_unplugged_for_reading,
        "begin pull wait:1000=unplugged info=unwritten wait:0=unplugged"),
    ROW(an_unplugged_device_stays_unplugged_for_writing,
        "begin pull info=unwritten wait:0=unplugged"),
    /* The port tries a missing device only five times per second. */
    ROW(a_device_that_is_not_there_yet_is_waited_for,
        "await=nodevice plug wait:0 wait:199 state=nodevice wait:1 state"),
    ROW(a_device_that_was_stopped_is_not_waited_for, "await=nodevice plug stop wait:1000=nodevice"),
    ROW(a_cable_that_is_pulled_and_plugged_in_again_is_a_loss_and_a_recovery,
        "await=nodevice plug scan until:scan pull until:lost state=nodevice plug until:recovered "
        "until:scan state reconnections>1"),
    /* Until the gap has been handled there is no room: no scan continues across it. After the pause
     * the next attempt is due at once. */
    ROW(a_reconnection_is_a_gap,
        "await=nodevice pause:300 wait:0 state=nodevice reconnections:0 plug room>0 pause:300 "
        "wait:0 reconnections:1 room:0 poll room>0"),
    /* Its driver may hang. */
    ROW(a_device_from_which_nothing_comes_is_opened_again,
        "await=nodevice plug pause:300 wait:0 restart reconnections:2 stop restart "
        "reconnections:2 start reconnections:0"),
    ROW(who_does_not_reconnect_keeps_it, "begin restart reconnections:0 moved:0 state"),
};

void test_each_row(void)
{
    tell_rows(rows, tell);
}
