/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the POSIX port itself: results of opening and receiving, and the blocking helpers. */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE /* B230400 */

#include "program.h"
#include "tmini/tmini_blocking.h"
#include "tmini_posix.h"

#include "unity.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

static tmini_posix_t port;
static tmini_t lidar;
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static size_t tapped;

void setUp(void)
{
    tapped = 0;
    tmini_posix_init(&port, "/dev/nowhere");
}

void tearDown(void)
{
    tmini_posix_stop(&port);
    program_clean_up();
}

static tmini_posix_status_t start(tmini_posix_t *device, const char *path)
{
    tmini_posix_init(device, path);
    return tmini_posix_start(device, NULL);
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

static void begin_with(const char *const options[])
{
    tmini_posix_init(&port, program_start_lidar(options));
    init_lidar(false);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
}

static void begin(void)
{
    begin_with((const char *const[]){NULL});
}

static void begin_by_socket(void)
{
    begin_with((const char *const[]){"--tcp", "0", NULL});
}

/* A new pseudo-terminal is set for typing: it echoes, edits lines, and changes characters. */
static int open_terminal(void)
{
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(master >= 0);
    TEST_ASSERT_EQUAL_INT(0, grantpt(master));
    TEST_ASSERT_EQUAL_INT(0, unlockpt(master));
    return master;
}

static void tap(void *context, const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_EQUAL_PTR(&tapped, context);
    TEST_ASSERT_NOT_NULL(bytes);
    tapped += count;
}

/* Polls until the event comes, at most 20 s. */
static void poll_until(tmini_event_t wanted)
{
    const uint32_t begun_ms = tmini_posix_port.now_ms(&port);
    tmini_event_t event = TMINI_EVENT_NONE;
    do {
        TEST_ASSERT_TRUE(tmini_posix_port.now_ms(&port) - begun_ms < 20000u);
        event = tmini_poll(&lidar);
        if (event == TMINI_EVENT_NONE) {
            TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 10));
        }
    } while (event != wanted);
}

/* Waits for a scan without a gap: on a busy computer, some scans may have gaps. */
static void await_complete_scan(void)
{
    do {
        poll_until(TMINI_EVENT_SCAN);
    } while (!tmini_scan(&lidar)->complete);
}

void test_the_blocking_helpers_work(void)
{
    tmini_info_t info;
    uint16_t frequency_chz = 0;
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_frequency(&lidar, &frequency_chz, 8000));
    TEST_ASSERT_EQUAL_UINT16(600, frequency_chz);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&lidar, 8000));
    await_complete_scan();
    TEST_ASSERT_TRUE(tmini_scan(&lidar)->count > 600);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&lidar, 2000));
}

void test_a_tap_gets_every_byte(void)
{
    tmini_info_t info;
    begin();
    tmini_posix_tap(&port, tap, &tapped);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_size_t(27, tapped); /* The reply: 7 + 20 bytes. */
    TEST_ASSERT_EQUAL_UINT64(27, port.received);
    tmini_posix_tap(&port, NULL, NULL);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
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

void test_a_lidar_can_be_reached_through_a_socket(void)
{
    tmini_info_t info;
    begin_by_socket();
    int sends_at_once = 0;
    socklen_t size = sizeof sends_at_once;
    TEST_ASSERT_EQUAL_INT(0, getsockopt(port.fd, IPPROTO_TCP, TCP_NODELAY, &sends_at_once, &size));
    TEST_ASSERT_NOT_EQUAL_INT(0, sends_at_once);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_blocking_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_start(&port, &lidar));
}

/* The TCP port has only one digit. */
void test_an_address_where_nothing_listens_is_still_valid(void)
{
    tmini_posix_init(&port, "tcp:127.0.0.1:1");
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_start(&port, NULL));
}

void test_an_invalid_address_is_reported(void)
{
    static const char *const wrong[] = {"tcp:",
                                        "tcp:host",
                                        "tcp::1",
                                        "tcp:host:",
                                        "tcp:127.0.0.1:0",
                                        "tcp:127.0.0.1:65536",
                                        "tcp:127.0.0.1:99999",
                                        "tcp:127.0.0.1:1x",
                                        "tcp:no.such.host.invalid:1"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        tmini_posix_init(&port, wrong[i]);
        TEST_ASSERT_EQUAL_INT(TMINI_POSIX_ADDRESS, tmini_posix_start(&port, NULL));
    }
}

static tmini_posix_status_t start_at_host_of_zeros(int digits)
{
    char path[sizeof "tcp:" + 256 + sizeof ":1"];
    (void)snprintf(path, sizeof path, "tcp:%0*d:1", digits, 0);
    tmini_posix_init(&port, path);
    return tmini_posix_start(&port, NULL);
}

/* A host name of any number of zeros is a valid address at which nothing listens. */
void test_the_longest_host_name_has_255_characters(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, start_at_host_of_zeros(255));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_ADDRESS, start_at_host_of_zeros(256));
}

void test_an_ipv6_address_may_be_in_brackets(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, start(&port, "tcp:[::1]:1"));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, start(&port, "tcp:::1:1"));
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

void test_bytes_that_have_waited_are_handed_over_at_once(void)
{
    static const uint8_t bytes[700];
    begin();
    const int other = start_on_pair(&lidar, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_UINT64(sizeof bytes, port.received);
    close(other);
}

void test_without_a_lidar_bytes_are_received_in_blocks(void)
{
    static const uint8_t bytes[300];
    static const uint64_t totals[] = {128, 256, 300};
    const int other = start_on_pair(NULL, bytes, sizeof bytes);
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
        TEST_ASSERT_EQUAL_UINT64(totals[i], port.received);
    }
    close(other);
}

void test_without_room_it_does_not_wait(void)
{
    static const uint8_t bytes[sizeof rx];
    begin();
    const int other = start_on_pair(&lidar, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_UINT64(sizeof bytes, port.received);
    const uint32_t begun_ms = tmini_posix_port.now_ms(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 5000));
    TEST_ASSERT_TRUE(tmini_posix_port.now_ms(&port) - begun_ms < 2500u);
    close(other);
}

/* Appends a chunk, 10 ms after the one before. */
static size_t put_chunk(uint8_t *to, const uint8_t *bytes, size_t count)
{
    tmini_timed_write_head(to, 10000, bytes, count);
    memcpy(to + TMINI_TIMED_HEAD_SIZE, bytes, count);
    return TMINI_TIMED_HEAD_SIZE + count;
}

/* Polls until nothing comes for a moment; returns the number of complete scans. */
static unsigned count_complete(void)
{
    unsigned complete = 0;
    const uint64_t before = port.received;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    for (tmini_event_t event = TMINI_EVENT_MORE;
         port.received > before || event != TMINI_EVENT_NONE;) {
        event = tmini_poll(&lidar);
        complete += event == TMINI_EVENT_SCAN && tmini_scan(&lidar)->complete ? 1 : 0;
        if (event == TMINI_EVENT_NONE) {
            const uint64_t count = port.received;
            TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 50));
            if (port.received == count) {
                break;
            }
        }
    }
    return complete;
}

/* A second of a lidar at 6 Hz, of which each third comes late and at once. */
void test_a_timed_stream_that_comes_late_has_the_times_of_its_sender(void)
{
    static uint8_t stream[20000];
    uint8_t bytes[13000];
    FILE *const file = fopen("recordings/sim-6hz.bin", "rb");
    TEST_ASSERT_NOT_NULL(file);
    TEST_ASSERT_EQUAL_size_t(sizeof bytes, fread(bytes, 1, sizeof bytes, file));
    (void)fclose(file);
    size_t size = TMINI_TIMED_MAGIC_SIZE;
    memcpy(stream, tmini_timed_magic, size);
    for (size_t at = 0; at < sizeof bytes; at += 130) {
        size += put_chunk(stream + size, bytes + at, 130);
    }
    init_lidar(true);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    const int other = start_on_pair(&lidar, stream, 8 + 140);
    TEST_ASSERT_EQUAL_UINT(0, count_complete());
    TEST_ASSERT_TRUE(tmini_posix_is_timed(&port));
    TEST_ASSERT_EQUAL_UINT64(130, port.received);
    const int64_t begun_us = tmini_posix_now_us(&port);
    TEST_ASSERT_EQUAL_INT(-1, tmini_posix_port.write(&port, stream, 2));
    unsigned complete = 0;
    for (size_t at = 148; at < size; at += 33 * 140) {
        (void)poll(NULL, 0, 330);
        TEST_ASSERT_EQUAL_INT(33 * 140, write(other, stream + at, 33 * 140));
        complete += count_complete();
    }
    TEST_ASSERT_EQUAL_UINT(4, complete); /* Of five start packets. */
    TEST_ASSERT_EQUAL_UINT64(sizeof bytes, port.received);
    TEST_ASSERT_INT64_WITHIN(1000, begun_us + 990000, tmini_posix_now_us(&port));
    const uint32_t age_ms = tmini_posix_port.now_ms(&port) - tmini_scan(&lidar)->end_ms;
    TEST_ASSERT_UINT32_WITHIN(90, 90, age_ms); /* Less than a revolution. */
    close(other);
}

void test_silence_is_no_error(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 20));
    TEST_ASSERT_EQUAL_UINT64(0, port.received);
}

void test_an_unplugged_device_stays_unplugged(void)
{
    tmini_info_t info;
    begin();
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_blocking_read_info(&lidar, &info, 8000));
}

void test_a_failure_to_wait_for_bytes_is_an_error(void)
{
    struct rlimit limit;
    begin();
    TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &limit));
    const struct rlimit none = {.rlim_cur = 0, .rlim_max = limit.rlim_max};
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &none)); /* This makes poll() fail. */
    const tmini_posix_status_t status = tmini_posix_wait(&port, 100);
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &limit));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, status);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_wait(&port, 0));
}

static void begin_with_an_adapter(void)
{
    begin();
    program_plug_in(port.path);
    tmini_posix_stop(&port);
    tmini_posix_init(&port, program_path("adapter"));
    tmini_posix_reconnect(&port, true);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
}

void test_a_cable_that_is_pulled_and_plugged_in_again_is_a_loss_and_a_recovery(void)
{
    begin_with_an_adapter();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    poll_until(TMINI_EVENT_SCAN);
    program_stop_lidar();
    program_plug_in(NULL);
    poll_until(TMINI_EVENT_LOST);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, port.state);
    program_plug_in(program_start_lidar((const char *const[]){NULL}));
    poll_until(TMINI_EVENT_RECOVERED);
    poll_until(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, port.state);
    TEST_ASSERT_TRUE(port.reconnections >= 1);
}

/* Until the gap has been handled there is no room: no scan continues across it. */
void test_a_reconnection_is_a_gap(void)
{
    begin_with_an_adapter();
    program_stop_lidar();
    program_plug_in(program_start_lidar((const char *const[]){NULL}));
    for (int i = 0; i < 1000 && port.reconnections == 0; i++) {
        TEST_ASSERT_TRUE(tmini_feed_room(&lidar) > 0);
        (void)tmini_posix_wait(&port, 10);
    }
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed_room(&lidar));
    (void)tmini_poll(&lidar);
    TEST_ASSERT_TRUE(tmini_feed_room(&lidar) > 0);
}

void test_bytes_from_before_the_start_are_thrown_away(void)
{
    const int master = open_terminal();
    const int line = open(ptsname(master), O_RDWR | O_NOCTTY); /* Otherwise stopping would do it. */
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, start(&port, ptsname(master))); /* Makes it raw. */
    TEST_ASSERT_EQUAL_INT(3, write(master, "old", 3));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, NULL));
    TEST_ASSERT_EQUAL_INT(4, write(master, "news", 4));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_UINT64(4, port.received);
    close(line);
    close(master);
}

void test_a_device_that_is_not_there_yet_is_waited_for(void)
{
    const char *const device = program_start_lidar((const char *const[]){NULL});
    program_plug_in(NULL);
    tmini_posix_init(&port, program_path("adapter"));
    tmini_posix_reconnect(&port, true);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_start(&port, NULL));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 10));
    program_plug_in(device);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, port.state);
}

/* The port tries a missing device only five times per second: first after a pause. */
void test_a_missing_device_is_tried_again_only_after_a_pause(void)
{
    const char *const device = program_start_lidar((const char *const[]){NULL});
    program_plug_in(NULL);
    tmini_posix_init(&port, program_path("adapter"));
    tmini_posix_reconnect(&port, true);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_start(&port, NULL));
    program_plug_in(device);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, port.state);
    port.tried_ms -= 1000;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, port.state);
}

void test_writing_to_an_unplugged_device_fails(void)
{
    tmini_info_t info;
    begin();
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_blocking_read_info(&lidar, &info, 8000));
}

/* The system allows root to open a claimed device, but the port refuses it to root, too, and leaves
 * the claim. */
void test_a_device_is_used_by_one_program_at_a_time(void)
{
    tmini_posix_t other;
    const char *const device = program_start_lidar((const char *const[]){NULL});
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
    int ends[2];
    begin();
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
    TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start_on(&port, ends[0], &lidar));
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
    close(ends[1]);
    begin_by_socket();
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(port.fd, F_GETFD));
}

static void note_alarm(int number)
{
    (void)number;
}

static void alarm_every_20_ms(bool on)
{
    const struct sigaction action = {.sa_handler = note_alarm}; /* Calls are not restarted. */
    const struct itimerval interval = {{0, on ? 20000 : 0}, {0, on ? 20000 : 0}};
    TEST_ASSERT_EQUAL_INT(0, sigaction(SIGALRM, &action, NULL));
    TEST_ASSERT_EQUAL_INT(0, setitimer(ITIMER_REAL, &interval, NULL));
}

/* The listener's queue is full and never emptied, so that connecting waits until its timeout. */
void test_connecting_ends_after_5_s_and_not_by_a_signal(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    char path[32];
    const int listener = socket(AF_INET, SOCK_STREAM, 0);
    const int first = socket(AF_INET, SOCK_STREAM, 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    TEST_ASSERT_EQUAL_INT(0, bind(listener, (struct sockaddr *)&address, size));
    TEST_ASSERT_EQUAL_INT(0, listen(listener, 0));
    TEST_ASSERT_EQUAL_INT(0, getsockname(listener, (struct sockaddr *)&address, &size));
    TEST_ASSERT_EQUAL_INT(0, connect(first, (struct sockaddr *)&address, size));
    (void)snprintf(path, sizeof path, "tcp:127.0.0.1:%u", ntohs(address.sin_port));
    const uint32_t begun_ms = tmini_posix_port.now_ms(&port);
    alarm_every_20_ms(true);
    const tmini_posix_status_t status = start(&port, path);
    const int error = errno;
    alarm_every_20_ms(false);
    if (status == TMINI_POSIX_OK) {
        TEST_IGNORE_MESSAGE("this system accepts more connections than its queue holds");
    }
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, status);
    TEST_ASSERT_EQUAL_INT(ETIMEDOUT, error);
    TEST_ASSERT_UINT32_WITHIN(1000, 5000, tmini_posix_port.now_ms(&port) - begun_ms);
    close(first);
    close(listener);
}

void test_a_device_is_started_again_after_it_was_stopped(void)
{
    tmini_info_t info;
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
    tmini_posix_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT64(0, port.received);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 8000));
}

void test_a_device_started_twice_is_open_once(void)
{
    begin();
    const int first = port.fd;
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(first, port.fd); /* The first one was closed: its number is free. */
}

void test_before_it_is_started_nothing_is_received_or_sent(void)
{
    static const uint8_t stop[2] = {0xA5, 0x65};
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(-1, tmini_posix_port.write(&port, stop, sizeof stop));
}

void test_without_polling_bytes_stay_with_the_system(void)
{
    static const uint8_t bytes[2000];
    tmini_counters_t counters;
    begin();
    const int other = start_on_pair(&lidar, bytes, sizeof bytes);
    for (unsigned i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_wait(&port, 1000));
    }
    TEST_ASSERT_EQUAL_UINT64(sizeof rx, port.received);
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

/* Receives eight scans, with a pause after two of them. Returns how many are incomplete. */
static unsigned count_gaps(void)
{
    unsigned gaps = 0;
    for (int i = 0; i < 8; i++) {
        poll_until(TMINI_EVENT_SCAN);
        gaps += tmini_scan(&lidar)->complete ? 0 : 1;
        (void)poll(NULL, 0, i == 2 || i == 5 ? 250 : 0);
    }
    return gaps;
}

/* The receive buffer holds a third of the bytes of 250 ms, the system the rest. On a busy computer
 * that rest may be late, in real time: one success in four tries is enough. */
void test_a_pause_of_the_program_costs_no_scan(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
    poll_until(TMINI_EVENT_SCAN);
    unsigned gaps = count_gaps();
    for (int i = 1; i < 4 && gaps > 0; i++) {
        gaps = count_gaps();
    }
    TEST_ASSERT_EQUAL_UINT(0, gaps);
}

void test_each_reason_for_not_opening_has_its_own_status(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, start(&port, "/dev/nowhere"));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, start(&port, "/dev/null"));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, tmini_posix_wait(&port, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, start(&port, "/tmp"));
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

void test_every_status_has_a_name(void)
{
    for (int i = TMINI_POSIX_ADDRESS; i <= TMINI_POSIX_OK; i++) {
        const char *const name = tmini_posix_status_name((tmini_posix_status_t)i);
        TEST_ASSERT_TRUE(strlen(name) > 0 && strcmp(name, "unknown status") != 0);
    }
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_posix_status_name((tmini_posix_status_t)1));
}
