/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A clock for programs that wait for each other: the tool, the simulated lidar, and the test
 * itself. It stands still while one of them works, and jumps to the next moment for which one waits
 * when all of them wait in vain. So a busy computer changes nothing, and idle time costs nothing.
 * To be preloaded; conftest.py loads it into the test, too. A library such as libfaketime gives
 * each program a clock of its own, which runs on while another one works.
 *
 * The programs share a file, named by TMINI_SHARED_CLOCK. It holds the time, and until when each
 * program waits in poll(). The clock jumps when each of them has looked for input in vain after the
 * last of them began to wait: what one has written before, another would have found. The last one
 * wakes the others to look; whoever moves the clock wakes those whose time has come. Stopped and
 * ended programs do not count. A program that waits elsewhere than in poll() stops the clock. */

#define _GNU_SOURCE

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define NEVER INT64_MAX
#define BEGIN_NS INT64_C(1000000000000)
#define READING_NS 1000 /* What it takes to read the clock: loops that only do this end. */
#define LOOK_NS 2000000 /* Real time between two looks: programs end without a word. */
#define LONGEST_NS INT64_C(1200000000000)
#define PROGRAMS_MAX 64
#define FDS_MAX 16  /* That a program waits for. */
#define HIGH_FD 100 /* Never a standard descriptor, even if one of those is closed. */

typedef struct {
    pid_t pid; /* 0: free entry. */
    bool is_waiting;
    bool is_stopped;
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
static int wake_fd;    /* Others wake this program here. */
static char name[100]; /* Of the file: part of the names of all `wake_fd`. */

/* The real time in which nothing happens after which poll() gives up with ETIME; 0: never. It also
 * gives up after LONGEST_NS of the clock's time. For the test itself. */
int shared_clock_patience_ms;

void shared_clock_open(const char *path);
void shared_clock_expect(pid_t pid);
void shared_clock_stop(pid_t pid);
bool shared_clock_waits(pid_t pid);
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

static void lock(void)
{
    while (flock(lock_fd, LOCK_EX) != 0 && errno == EINTR) {
    }
}

static void unlock(void)
{
    (void)flock(lock_fd, LOCK_UN);
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

static bool has_ended(char state)
{
    return state == 'X' || state == 'Z';
}

/* This process's entry. */
static program_t *place_of(pid_t pid)
{
    program_t *const end = shared->programs + PROGRAMS_MAX;
    program_t *place = NULL;
    for (program_t *one = shared->programs; one < end; one++) {
        if (one->pid == pid) {
            return one;
        }
        if (place == NULL && one->pid == 0) {
            place = one;
        }
    }
    for (program_t *one = shared->programs; one < end && place == NULL; one++) {
        place = has_ended(state_of(one->pid)) ? one : NULL; /* It ended while nobody looked. */
    }
    if (place == NULL) {
        abort(); /* More than PROGRAMS_MAX at once. */
    }
    *place = (program_t){.pid = pid};
    return place;
}

/* The address of a program's `wake_fd`: a name that needs no file. */
static struct sockaddr_un wake_address(pid_t pid, socklen_t *length)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    *length = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1) +
              (socklen_t)snprintf(address.sun_path + 1, sizeof address.sun_path - 1, "%s.%d", name,
                                  (int)pid);
    return address;
}

static void wake(const program_t *program)
{
    socklen_t length;
    const struct sockaddr_un address = wake_address(program->pid, &length);
    (void)sendto(wake_fd, "", 1, MSG_DONTWAIT, (const struct sockaddr *)&address, length);
}

static bool has_looked(const program_t *program)
{
    return program->is_waiting && program->seen == shared->events;
}

/* Whether the clock must wait for the program: it works, or waits and has not looked. */
static bool is_awaited(program_t *program, bool is_late)
{
    if (program->pid == 0 || has_looked(program)) {
        return false;
    }
    if (!is_late && !program->is_stopped) {
        return true; /* Reading the state takes longer than all the rest. */
    }
    const char state = state_of(program->pid);
    program->pid = has_ended(state) ? 0 : program->pid;
    program->is_stopped = state == 'T' || state == 't';
    return program->pid != 0 && !program->is_stopped;
}

/* Whether the clock must wait for any program. If all wait, those that must look are woken. */
static bool is_any_awaited(pid_t own, bool is_late)
{
    bool is_one[PROGRAMS_MAX] = {false};
    bool is_any = false;
    bool works = false;
    for (int i = 0; i < PROGRAMS_MAX; i++) {
        is_one[i] = is_awaited(&shared->programs[i], is_late);
        is_any = is_any || is_one[i];
        works = works || (is_one[i] && !shared->programs[i].is_waiting);
    }
    for (int i = 0; i < PROGRAMS_MAX && !works; i++) {
        if (is_one[i] && shared->programs[i].pid != own) {
            wake(&shared->programs[i]);
        }
    }
    return is_any;
}

/* All wait in vain: moves the clock to the earliest time until which one waits. */
static void jump(pid_t own)
{
    const program_t *const end = shared->programs + PROGRAMS_MAX;
    int64_t first_ns = NEVER;
    for (const program_t *one = shared->programs; one < end; one++) {
        const bool counts = one->pid != 0 && has_looked(one); /* Others are stopped. */
        first_ns = counts && one->until_ns < first_ns ? one->until_ns : first_ns;
    }
    if (first_ns != NEVER && first_ns > now_ns()) {
        __atomic_store_n(&shared->passed_ns, first_ns - BEGIN_NS, __ATOMIC_SEQ_CST);
        shared->events++;
    }
    for (const program_t *one = shared->programs; one < end; one++) {
        if (one->pid != 0 && one->pid != own && one->until_ns <= now_ns()) {
            wake(one);
        }
    }
}

/* Notes that this process has looked in vain since `events` had this value. Returns whether it must
 * look again at once. */
static bool look_in_vain(uint64_t events, int64_t until_ns, bool is_late)
{
    lock();
    program_t *const own = place_of(getpid());
    const bool has_missed_one = events != shared->events;
    shared->events += own->is_waiting ? 0 : 1; /* What it has written until now must be found. */
    *own = (program_t){getpid(), true, false, has_missed_one ? events : shared->events, until_ns};
    if (!is_any_awaited(own->pid, is_late)) {
        jump(own->pid);
    }
    unlock();
    return has_missed_one;
}

/* From now on the clock stands until the process waits. */
void shared_clock_expect(pid_t pid)
{
    if (shared == NULL) {
        return;
    }
    lock();
    *place_of(pid) = (program_t){.pid = pid};
    shared->events++;
    unlock();
}

/* Whether the process waits in poll(). */
bool shared_clock_waits(pid_t pid)
{
    lock();
    const bool waits = place_of(pid)->is_waiting;
    unlock();
    return waits;
}

static int open_wake(const char *path)
{
    (void)snprintf(name, sizeof name, "%.90s", path);
    socklen_t length;
    const struct sockaddr_un address = wake_address(getpid(), &length);
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const int high_fd = fcntl(fd, F_DUPFD_CLOEXEC, HIGH_FD);
    (void)close(fd);
    return bind(high_fd, (const struct sockaddr *)&address, length) == 0 ? high_fd : -1;
}

/* Stops a process outside of the functions that lock the file. */
void shared_clock_stop(pid_t pid)
{
    static const struct timespec moment = {0, 100000};
    lock();
    (void)kill(pid, SIGSTOP);
    while (strchr("TtZX", state_of(pid)) == NULL) {
        (void)nanosleep(&moment, NULL);
    }
    place_of(pid)->is_stopped = true;
    unlock();
}

/* Uses this file's clock; NULL: real time. */
void shared_clock_open(const char *path)
{
    if (shared != NULL) {
        (void)munmap(shared, sizeof *shared);
        (void)close(lock_fd);
        (void)close(wake_fd);
    }
    shared = NULL;
    const int fd = path == NULL ? -1 : open(path, O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        return;
    }
    lock_fd = fcntl(fd, F_DUPFD_CLOEXEC, HIGH_FD);
    wake_fd = open_wake(path);
    void *const memory = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    shared = memory != MAP_FAILED && lock_fd >= 0 && wake_fd >= 0 ? memory : NULL;
    (void)close(fd);
    shared_clock_expect(getpid());
}

/* ppoll() that also ends, with 0, when another program wakes this one. */
static int wait_or_be_woken(struct pollfd *fds, nfds_t count, long wait_ns, bool *is_woken)
{
    struct pollfd all[FDS_MAX + 1];
    const struct timespec wait = {0, wait_ns};
    if (count > FDS_MAX) {
        abort();
    }
    for (nfds_t i = 0; i < count; i++) {
        all[i] = fds[i];
    }
    all[count] = (struct pollfd){.fd = wake_fd, .events = POLLIN};
    const int ready = ppoll(all, count + 1, &wait, NULL);
    *is_woken = ready > 0 && all[count].revents != 0;
    if (*is_woken) {
        char bytes[1];
        while (recv(wake_fd, bytes, sizeof bytes, MSG_DONTWAIT) > 0) {
        }
    }
    for (nfds_t i = 0; i < count && ready > 0; i++) {
        fds[i].revents = all[i].revents;
    }
    return *is_woken ? ready - 1 : ready;
}

/* Waits until there is input, or the clock has been moved on. */
static int wait_together(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    const int64_t begun_ns = now_ns();
    const int64_t until_ns = timeout_ms < 0 ? NEVER : begun_ns + timeout_ms * INT64_C(1000000);
    uint64_t latest = 0; /* Value of `events`, and when it was seen first. */
    int64_t latest_ms = real_ms();
    bool is_late = false;
    int ready = 0;
    do {
        bool is_woken = false;
        const uint64_t events = __atomic_load_n(&shared->events, __ATOMIC_SEQ_CST);
        ready = wait_or_be_woken(fds, count, 0, &is_woken);
        if (ready == 0 && now_ns() < until_ns) {
            const bool must_look = look_in_vain(events, until_ns, is_late);
            ready = wait_or_be_woken(fds, count, must_look ? 0 : LOOK_NS, &is_woken);
            is_late = !must_look && !is_woken;
        }
        latest_ms = latest == events ? latest_ms : real_ms();
        latest = events;
        if (ready == 0 && shared_clock_patience_ms > 0 &&
            (real_ms() - latest_ms > shared_clock_patience_ms ||
             now_ns() - begun_ns > LONGEST_NS)) {
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
