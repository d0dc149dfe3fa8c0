/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A clock that skips the time in which nothing happens, for programs that wait for each other: the
 * tool and the simulated lidar. program.c preloads it.
 *
 * The programs share a file, named by TMINI_IDLE_CLOCK. It contains how much time has been skipped
 * and until when each program waits. When all of them wait in poll(), and each has polled again
 * after the last event and found nothing, the clock jumps to the earliest of these times. A program
 * that computes or waits elsewhere keeps the clock at real time, so a busy computer disturbs a test
 * no more than without this clock. A stopped program does not count. */

#define _GNU_SOURCE

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

/* How long poll() must find nothing: bytes take some microseconds through a pseudo-terminal, longer
 * on a busy computer. */
#define QUIET_NS 1000000
#define NEVER INT64_MAX
#define PROGRAMS_MAX 16
#define HIGH_FD 100 /* Never a standard descriptor, even if one of those is closed. */

typedef struct {
    pid_t pid; /* 0: free entry. */
    bool is_waiting;
    uint64_t seen; /* Value of `events` when it last polled. */
    int64_t until_ns;
} program_t;

typedef struct {
    int64_t skipped_ns;
    uint64_t events; /* Counts everything that may end a program's waiting. */
    program_t programs[PROGRAMS_MAX];
} clock_file_t;

static clock_file_t *shared;
static int lock_fd;

static void join(void);

static int real_clock(clockid_t clock, struct timespec *now)
{
    static int (*function)(clockid_t, struct timespec *);
    if (function == NULL) {
        function = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
    }
    return function(clock, now);
}

static int64_t now_ns(void)
{
    struct timespec now;
    (void)real_clock(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec +
           __atomic_load_n(&shared->skipped_ns, __ATOMIC_SEQ_CST);
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    join();
    if (shared == NULL || clock != CLOCK_MONOTONIC) {
        return real_clock(clock, now);
    }
    const int64_t ns = now_ns();
    now->tv_sec = (time_t)(ns / 1000000000);
    now->tv_nsec = (long)(ns % 1000000000);
    return 0;
}

/* This program's entry; NULL if none is free. */
static program_t *own_place(void)
{
    program_t *place = NULL;
    for (program_t *one = shared->programs; one < shared->programs + PROGRAMS_MAX; one++) {
        if (one->pid == getpid()) {
            return one;
        }
        if (one->pid == 0 || (kill(one->pid, 0) != 0 && errno == ESRCH)) {
            one->pid = 0;
            place = one;
        }
    }
    return place;
}

/* Whether a signal has stopped the program: a test does this to a lidar whose supply fails. */
static bool is_stopped(pid_t pid)
{
    char path[40];
    char text[200] = "";
    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    FILE *const file = fopen(path, "r");
    if (file == NULL) {
        return false;
    }
    (void)fgets(text, sizeof text, file);
    (void)fclose(file);
    return strstr(text, ") T ") != NULL;
}

/* The earliest time until which a program waits; NEVER unless all wait and have found nothing. */
static int64_t first_wait(void)
{
    int64_t first_ns = NEVER;
    for (const program_t *one = shared->programs; one < shared->programs + PROGRAMS_MAX; one++) {
        const bool waits = one->is_waiting && one->seen == shared->events;
        if (one->pid == 0 || (!waits && is_stopped(one->pid))) {
            continue;
        }
        if (!waits) {
            return NEVER;
        }
        first_ns = one->until_ns < first_ns ? one->until_ns : first_ns;
    }
    return first_ns;
}

static void look_in_vain(int64_t until_ns)
{
    (void)flock(lock_fd, LOCK_EX);
    program_t *const own = own_place();
    if (own != NULL) {
        *own = (program_t){getpid(), true, shared->events, until_ns};
        const int64_t first_ns = first_wait();
        const int64_t ahead_ns = first_ns - now_ns();
        if (first_ns != NEVER && ahead_ns > 0) {
            __atomic_fetch_add(&shared->skipped_ns, ahead_ns, __ATOMIC_SEQ_CST);
            shared->events++;
        }
    }
    (void)flock(lock_fd, LOCK_UN);
}

static void go_on(void)
{
    (void)flock(lock_fd, LOCK_EX);
    program_t *const own = own_place();
    if (own != NULL) {
        *own = (program_t){.pid = getpid()};
        shared->events++;
    }
    (void)flock(lock_fd, LOCK_UN);
}

static void join(void)
{
    static bool has_tried;
    const char *const path = getenv("TMINI_IDLE_CLOCK");
    if (has_tried || path == NULL) {
        return;
    }
    has_tried = true;
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        return;
    }
    lock_fd = fcntl(fd, F_DUPFD_CLOEXEC, HIGH_FD);
    void *const memory = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    shared = memory != MAP_FAILED && lock_fd >= 0 ? memory : NULL;
    close(fd);
    if (shared != NULL) {
        go_on(); /* No time is skipped until this program waits. */
    }
}

int poll(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    static const struct timespec at_once = {0, 0};
    static const struct timespec quiet = {0, QUIET_NS};
    join();
    const int error = errno;
    int ready = ppoll(fds, count, timeout_ms < 0 && shared == NULL ? NULL : &at_once, NULL);
    if (ready != 0 || timeout_ms == 0) {
        return ready;
    }
    if (shared == NULL) {
        const struct timespec rest = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
        return ppoll(fds, count, &rest, NULL);
    }
    const int64_t until_ns = timeout_ms < 0 ? NEVER : now_ns() + timeout_ms * INT64_C(1000000);
    do {
        ready = ppoll(fds, count, &quiet, NULL);
        if (ready == 0) {
            look_in_vain(until_ns);
        }
    } while (ready == 0 && now_ns() < until_ns);
    const int own_error = errno;
    go_on();
    errno = ready < 0 ? own_error : error;
    return ready;
}

/* _FORTIFY_SOURCE replaces poll() by this. */
int __poll_chk(struct pollfd *fds, nfds_t count, int timeout_ms, size_t size);

int __poll_chk(struct pollfd *fds, nfds_t count, int timeout_ms, size_t size)
{
    (void)size;
    return poll(fds, count, timeout_ms);
}
