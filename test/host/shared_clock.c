/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A clock for programs that wait for each other: the tool, the simulated lidar, and the test
 * itself. It stands still while one of them works, and jumps to the next moment for which one waits
 * when all of them wait in vain. So a busy computer changes nothing, and idle time costs nothing.
 * To be preloaded; conftest.py loads it into the test, too.
 *
 * The programs share a file, named by TMINI_SHARED_CLOCK. It holds the time, and until when each
 * program waits in poll(). The clock jumps when each of them has looked for input in vain after the
 * last of them began to wait: what one has written before, another would have found. Stopped and
 * ended programs do not count. A program that waits elsewhere than in poll() stops the clock. */

#define _GNU_SOURCE

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define NEVER INT64_MAX
#define BEGIN_NS INT64_C(1000000000000)
#define READING_NS 1000 /* What it takes to read the clock: loops that only do this end. */
#define LOOK_NS 50000   /* Between two looks; doubled while nothing happens. */
#define LOOK_MAX_NS 2000000
#define PROGRAMS_MAX 64
#define HIGH_FD 100 /* Never a standard descriptor, even if one of those is closed. */

typedef struct {
    pid_t pid; /* 0: free entry. */
    bool is_waiting;
    uint64_t seen; /* Value of `events` since which it has looked in vain. */
    int64_t until_ns;
} program_t;

typedef struct {
    int64_t passed_ns;
    uint64_t events; /* Counts everything after which a program must look again. */
    program_t programs[PROGRAMS_MAX];
} clock_file_t;

static clock_file_t *shared;
static int lock_fd;

/* The real time after which poll() gives up with ETIME; 0: never. For the test itself. */
int shared_clock_patience_ms;

void shared_clock_open(const char *path);
void shared_clock_expect(pid_t pid);
int64_t shared_clock_now_ns(void);

static int real_clock(clockid_t clock, struct timespec *now)
{
    static int (*function)(clockid_t, struct timespec *);
    if (function == NULL) {
        void *const symbol = dlsym(RTLD_NEXT, "clock_gettime");
        memcpy(&function, &symbol, sizeof function);
    }
    return function(clock, now);
}

static int64_t real_ms(void)
{
    struct timespec now;
    (void)real_clock(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000) + now.tv_nsec / 1000000;
}

static int64_t now_ns(void)
{
    return BEGIN_NS + __atomic_load_n(&shared->passed_ns, __ATOMIC_SEQ_CST);
}

int64_t shared_clock_now_ns(void)
{
    return now_ns();
}

static void join(void)
{
    static bool has_tried;
    const char *const path = getenv("TMINI_SHARED_CLOCK");
    if (!has_tried && shared == NULL && path != NULL) {
        has_tried = true;
        shared_clock_open(path);
    }
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    join();
    if (shared == NULL || clock != CLOCK_MONOTONIC) {
        return real_clock(clock, now);
    }
    const int64_t ns =
        BEGIN_NS + __atomic_add_fetch(&shared->passed_ns, READING_NS, __ATOMIC_SEQ_CST);
    now->tv_sec = (time_t)(ns / 1000000000);
    now->tv_nsec = (long)(ns % 1000000000);
    return 0;
}

/* The state of a process, as /proc reports it; X if there is none. */
static char state_of(pid_t pid)
{
    char path[40];
    char text[200] = "";
    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    FILE *const file = fopen(path, "r");
    if (file == NULL) {
        return 'X';
    }
    (void)!fgets(text, sizeof text, file);
    (void)fclose(file);
    const char *const end = strrchr(text, ')');
    return end != NULL ? end[2] : 'X';
}

/* This process's entry. */
static program_t *place_of(pid_t pid)
{
    program_t *place = NULL;
    for (program_t *one = shared->programs; one < shared->programs + PROGRAMS_MAX; one++) {
        if (one->pid == pid) {
            return one;
        }
        if (place == NULL && one->pid == 0) {
            place = one;
        }
    }
    if (place == NULL) {
        abort(); /* More than PROGRAMS_MAX in one test. */
    }
    *place = (program_t){.pid = pid};
    return place;
}

/* The earliest time until which a program waits; NEVER unless all wait and have found nothing. */
static int64_t first_wait(void)
{
    int64_t first_ns = NEVER;
    for (program_t *one = shared->programs; one < shared->programs + PROGRAMS_MAX; one++) {
        const bool waits = one->is_waiting && one->seen == shared->events;
        if (one->pid != 0 && !waits) {
            const char state = state_of(one->pid);
            if (strchr("TtZX", state) == NULL) {
                return NEVER;
            }
            one->pid = state == 'X' || state == 'Z' ? 0 : one->pid;
        } else if (one->pid != 0) {
            first_ns = one->until_ns < first_ns ? one->until_ns : first_ns;
        }
    }
    return first_ns;
}

/* Notes that this process has looked in vain since `events` had this value. Returns whether
 * anything has happened since it last did so. */
static bool look_in_vain(uint64_t events, int64_t until_ns)
{
    (void)flock(lock_fd, LOCK_EX);
    program_t *const own = place_of(getpid());
    const bool has_missed_one = events != shared->events;
    shared->events += own->is_waiting ? 0 : 1; /* What it has written until now must be found. */
    events = has_missed_one ? events : shared->events;
    const bool is_news = own->seen != events;
    *own = (program_t){getpid(), true, events, until_ns};
    const int64_t first_ns = first_wait();
    if (first_ns != NEVER && first_ns > now_ns()) {
        __atomic_store_n(&shared->passed_ns, first_ns - BEGIN_NS, __ATOMIC_SEQ_CST);
        shared->events++;
    }
    (void)flock(lock_fd, LOCK_UN);
    return is_news;
}

/* From now on the clock stands until the process waits. */
void shared_clock_expect(pid_t pid)
{
    if (shared == NULL) {
        return;
    }
    (void)flock(lock_fd, LOCK_EX);
    *place_of(pid) = (program_t){.pid = pid};
    shared->events++;
    (void)flock(lock_fd, LOCK_UN);
}

/* Uses this file's clock; NULL: real time. */
void shared_clock_open(const char *path)
{
    if (shared != NULL) {
        (void)munmap(shared, sizeof *shared);
        (void)close(lock_fd);
    }
    shared = NULL;
    const int fd = path == NULL ? -1 : open(path, O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        return;
    }
    lock_fd = fcntl(fd, F_DUPFD_CLOEXEC, HIGH_FD);
    void *const memory = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    shared = memory != MAP_FAILED && lock_fd >= 0 ? memory : NULL;
    (void)close(fd);
    shared_clock_expect(getpid());
}

/* Waits in steps of real time until there is input, or the clock has been moved on. */
static int wait_together(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    const int64_t until_ns = timeout_ms < 0 ? NEVER : now_ns() + timeout_ms * INT64_C(1000000);
    struct timespec step = {0, LOOK_NS};
    const int64_t begun_ms = real_ms();
    int ready = 0;
    do {
        const uint64_t events = __atomic_load_n(&shared->events, __ATOMIC_SEQ_CST);
        ready = ppoll(fds, count, &step, NULL);
        if (ready == 0) {
            step.tv_nsec = look_in_vain(events, until_ns)   ? LOOK_NS
                           : step.tv_nsec * 2 < LOOK_MAX_NS ? step.tv_nsec * 2
                                                            : LOOK_MAX_NS;
        }
        if (ready == 0 && shared_clock_patience_ms > 0 &&
            real_ms() - begun_ms > shared_clock_patience_ms) {
            errno = ETIME;
            ready = -1;
        }
    } while (ready == 0 && now_ns() < until_ns);
    const int error = errno;
    shared_clock_expect(getpid());
    errno = error;
    return ready;
}

int poll(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    static const struct timespec at_once = {0, 0};
    join();
    const int error = errno;
    const int ready = ppoll(fds, count, timeout_ms < 0 && shared == NULL ? NULL : &at_once, NULL);
    if (ready != 0 || timeout_ms == 0) {
        return ready;
    }
    if (shared == NULL) {
        const struct timespec rest = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
        return ppoll(fds, count, &rest, NULL);
    }
    errno = error;
    return wait_together(fds, count, timeout_ms);
}

/* _FORTIFY_SOURCE replaces poll() by this. */
int __poll_chk(struct pollfd *fds, nfds_t count, int timeout_ms, size_t size);

int __poll_chk(struct pollfd *fds, nfds_t count, int timeout_ms, size_t size)
{
    (void)size;
    return poll(fds, count, timeout_ms);
}
