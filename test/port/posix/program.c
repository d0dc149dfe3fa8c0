/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#define WORDS_MAX 16
#define LIDARS_MAX 200
#define PORT_SIZE 100

static pid_t lidars[LIDARS_MAX]; /* 0: has been ended. */
static size_t lidar_count;

#ifdef SHARED_CLOCK
/* shared_clock.c */
void shared_clock_open(const char *path);
void shared_clock_expect(pid_t pid);

static char preload[PORT_SIZE];

static void remove_link(void)
{
    (void)unlink(preload);
}

/* The test and its lidars share a clock, which stands while one of them works. In LD_PRELOAD spaces
 * separate libraries, so it has a path without them. */
static void begin_clock(void)
{
    static const char nothing[4096];
    FILE *const file = fopen(HOME_DIR "/clock", "wb");
    if (file == NULL || fwrite(nothing, 1, sizeof nothing, file) != sizeof nothing ||
        fclose(file) != 0) {
        abort();
    }
    (void)snprintf(preload, sizeof preload, "/tmp/tmini-clock.%ld", (long)getpid());
    (void)unlink(preload);
    if (symlink(SHARED_CLOCK, preload) != 0 || atexit(remove_link) != 0) {
        abort();
    }
    shared_clock_open(HOME_DIR "/clock");
}

static void share_clock(void)
{
    (void)setenv("LD_PRELOAD", preload, 1);
    (void)setenv("TMINI_SHARED_CLOCK", HOME_DIR "/clock", 1);
    (void)setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
}
#else
static void begin_clock(void) {}

static void share_clock(void) {}

static void shared_clock_expect(pid_t pid)
{
    (void)pid;
}
#endif

/* The test leaves its files in its own folder, wherever it is started. */
__attribute__((constructor)) static void go_home(void)
{
    if (chdir(HOME_DIR) != 0) {
        abort();
    }
    begin_clock();
}

const char *program_path(const char *name)
{
    static char paths[4][100];
    static unsigned next;
    char *const path = paths[next++ % 4];
    (void)snprintf(path, sizeof paths[0], "%s/%s", WORK_DIR, name);
    return path;
}

/* The first line that the simulator prints: "/dev/pts/3" or "127.0.0.1:4711". */
static void read_port(int fd, char *port)
{
    struct pollfd output = {.fd = fd, .events = POLLIN};
    char line[80];
    size_t length = 0;
    while (length + 1 < sizeof line && poll(&output, 1, 60000) > 0 &&
           read(fd, line + length, 1) == 1 && line[length] != '\n') {
        length++;
    }
    line[length] = '\0';
    TEST_ASSERT_TRUE_MESSAGE(length > 0, "the simulator names no port");
    (void)snprintf(port, PORT_SIZE, "%s%s", line[0] == '/' ? "" : "tcp:", line);
}

const char *program_start_lidar(const char *const options[])
{
    static char ports[LIDARS_MAX][PORT_SIZE];
    const bool is_socket = options[0] != NULL && strcmp(options[0], "--tcp") == 0;
    char *words[WORDS_MAX] = {(char *)(uintptr_t)TMINI_SIM, (char *)(uintptr_t) "--pty"};
    int ends[2];
    TEST_ASSERT_TRUE(lidar_count < LIDARS_MAX);
    for (size_t i = 0; options[i] != NULL; i++) {
        words[i + (is_socket ? 1 : 2)] = (char *)(uintptr_t)options[i];
    }
    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    const pid_t lidar = fork();
    TEST_ASSERT_TRUE(lidar >= 0);
    if (lidar == 0) {
        (void)dup2(ends[1], STDOUT_FILENO);
        (void)close(ends[0]);
        (void)close(ends[1]);
        share_clock();
        (void)execv(TMINI_SIM, words);
        _exit(127);
    }
    shared_clock_expect(lidar);
    char *const port = ports[lidar_count];
    lidars[lidar_count++] = lidar;
    (void)close(ends[1]);
    read_port(ends[0], port);
    (void)close(ends[0]);
    return port;
}

void program_plug_in(const char *device)
{
    const char *const name = program_path("adapter");
    (void)remove(name);
    TEST_ASSERT_TRUE(device == NULL || symlink(device, name) == 0);
}

static void end(pid_t *lidar)
{
    if (*lidar != 0) {
        (void)kill(*lidar, SIGKILL);
        (void)waitpid(*lidar, NULL, 0);
        *lidar = 0;
    }
}

void program_stop_lidar(void)
{
    TEST_ASSERT_TRUE(lidar_count > 0);
    end(&lidars[lidar_count - 1]);
}

void program_clean_up(void)
{
    for (size_t i = 0; i < lidar_count; i++) {
        end(&lidars[i]);
    }
}
