/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE

#include "program.h"

#include "unity.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#define FILE_MAX 8000000u
#define PATIENCE_MS 60000
#define NOBODY (-1)
#define NOBODYS_ID 65534 /* By custom the user without rights. */

const char *program_output;
const char *program_errors;

static char files[4][FILE_MAX];
static bool gives_up_rights;
static pid_t lidar = NOBODY;
static pid_t talker = NOBODY;
static pid_t tool = NOBODY;

const char *program_path(const char *name)
{
    static char paths[4][500];
    static unsigned next;
    char *const path = paths[next++ % 4];
    (void)snprintf(path, sizeof paths[0], "%s/%s", WORK_DIR, name);
    return path;
}

const char *program_read_file(unsigned slot, const char *path, size_t *size)
{
    FILE *const file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    const size_t count = fread(files[slot], 1, FILE_MAX - 1, file);
    fclose(file);
    files[slot][count] = '\0';
    if (size != NULL) {
        *size = count;
    }
    return files[slot];
}

void program_write_file(const char *path, const void *bytes, size_t size)
{
    FILE *const file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    TEST_ASSERT_EQUAL_size_t(size, fwrite(bytes, 1, size, file));
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

static void redirect(int to, const char *path, int flags)
{
    const int fd = open(path, flags, 0666);
    if (fd < 0 || dup2(fd, to) < 0) {
        _exit(126);
    }
    close(fd);
}

void program_give_up_rights(bool gives_up)
{
    gives_up_rights = gives_up;
}

/* In the child: becomes the program. */
static void become(const char *path, const char *const words[])
{
    char *arguments[PROGRAM_WORDS_MAX + 2] = {(char *)(uintptr_t)path};
    for (size_t i = 0; i < PROGRAM_WORDS_MAX && words[i] != NULL; i++) {
        arguments[i + 1] = (char *)(uintptr_t)words[i];
    }
    if (gives_up_rights && geteuid() == 0 && (setgid(NOBODYS_ID) != 0 || setuid(NOBODYS_ID) != 0)) {
        _exit(PROGRAM_CANNOT_START);
    }
    execv(path, arguments);
    _exit(PROGRAM_CANNOT_START);
}

static pid_t start(const char *path, const char *input, const char *const words[])
{
    program_write_file(WORK_DIR "/output", "", 0); /* Nothing of the program before. */
    program_write_file(WORK_DIR "/errors", "", 0);
    const pid_t pid = fork();
    TEST_ASSERT_TRUE(pid >= 0);
    if (pid == 0) {
        redirect(STDIN_FILENO, input, O_RDONLY);
        redirect(STDOUT_FILENO, WORK_DIR "/output", O_WRONLY);
        redirect(STDERR_FILENO, WORK_DIR "/errors", O_WRONLY);
        become(path, words);
    }
    tool = pid;
    return pid;
}

/* Returns false if the program has not ended in time. */
static bool wait_for(pid_t pid, int *status)
{
    for (int waited_ms = 0; waited_ms < PATIENCE_MS; waited_ms += 5) {
        if (waitpid(pid, status, WNOHANG) == pid) {
            return true;
        }
        (void)poll(NULL, 0, 5);
    }
    return false;
}

int program_finish(pid_t pid, int signal_number)
{
    int status = 0;
    if (signal_number != 0) {
        kill(pid, signal_number);
    }
    TEST_ASSERT_TRUE_MESSAGE(wait_for(pid, &status), "the tool does not end");
    tool = NOBODY;
    program_output = program_read_file(2, WORK_DIR "/output", NULL);
    program_errors = program_read_file(3, WORK_DIR "/errors", NULL);
    TEST_ASSERT_TRUE_MESSAGE(WIFEXITED(status), "the tool was ended by a signal");
    return WEXITSTATUS(status);
}

pid_t program_start_tmini(const char *const words[])
{
    return start(TMINI, "/dev/null", words);
}

pid_t program_start(const char *path, const char *const words[])
{
    return start(path, "/dev/null", words);
}

int program_tmini(const char *const words[])
{
    return program_finish(start(TMINI, "/dev/null", words), 0);
}

int program_tmini_from(const char *input, const char *const words[])
{
    return program_finish(start(TMINI, input, words), 0);
}

/* The first line of what the simulator prints. */
static void read_port(int fd, char *port, size_t size)
{
    struct pollfd output = {.fd = fd, .events = POLLIN};
    size_t length = 0;
    while (length + 1 < size && poll(&output, 1, 5000) > 0 && read(fd, port + length, 1) == 1 &&
           port[length] != '\n') {
        length++;
    }
    port[length] = '\0';
    TEST_ASSERT_EQUAL_CHAR_MESSAGE('/', port[0], "the simulator names no port");
}

const char *program_start_lidar(const char *const options[])
{
    static char port[100];
    int ends[2];
    const char *words[PROGRAM_WORDS_MAX] = {"--pty"};
    for (size_t i = 0; options[i] != NULL; i++) {
        words[i + 1] = options[i];
    }
    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    lidar = fork();
    TEST_ASSERT_TRUE(lidar >= 0);
    if (lidar == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        become(TMINI_SIM, words);
    }
    close(ends[1]);
    read_port(ends[0], port, sizeof port);
    close(ends[0]);
    return port;
}

static void end(pid_t *pid)
{
    if (*pid != NOBODY) {
        kill(*pid, SIGKILL);
        (void)waitpid(*pid, NULL, 0);
    }
    *pid = NOBODY;
}

void program_stop_lidar(void)
{
    end(&lidar);
}

void program_freeze_lidar(void)
{
    TEST_ASSERT_TRUE(lidar > 0);
    TEST_ASSERT_EQUAL_INT(0, kill(lidar, SIGSTOP));
}

/* What the host sends is read and forgotten. */
static void talk(int fd, const uint8_t *bytes, size_t size)
{
    uint8_t heard[64];
    size_t at = 0;
    for (;;) {
        if (size > 0) {
            const size_t rest = size - at;
            const ssize_t sent = write(fd, bytes + at, rest < 131 ? rest : 131);
            at = sent > 0 ? (at + (size_t)sent) % size : at;
        }
        if (read(fd, heard, sizeof heard) < 0) {
            (void)poll(NULL, 0, 10);
        }
    }
}

/* Opens both ends of a pseudo-terminal. */
static void open_terminal(int *master, int *line)
{
    *master = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(*master >= 0);
    TEST_ASSERT_EQUAL_INT(0, grantpt(*master));
    TEST_ASSERT_EQUAL_INT(0, unlockpt(*master));
    *line = open(ptsname(*master), O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(*line >= 0);
}

const char *program_start_talker(const uint8_t *bytes, size_t size)
{
    int master = -1;
    int line = -1;
    struct termios settings;
    open_terminal(&master, &line);
    /* Raw, so that there is no echo. */
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(line, &settings));
    settings.c_lflag = 0;
    settings.c_oflag = 0;
    TEST_ASSERT_EQUAL_INT(0, tcsetattr(line, TCSANOW, &settings));
    talker = fork();
    TEST_ASSERT_TRUE(talker >= 0);
    if (talker == 0) {
        (void)fcntl(master, F_SETFL, O_NONBLOCK);
        talk(master, bytes, size);
    }
    const char *const port = ptsname(master);
    close(master);
    close(line); /* The talker's stays open: else it would find the line hung up. */
    return port;
}

pid_t program_start_on_terminal(unsigned columns, unsigned rows, const char *const words[],
                                int *master, int *line, struct termios *before)
{
    const struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = (unsigned short)rows};
    open_terminal(master, line);
    TEST_ASSERT_EQUAL_INT(0, ioctl(*line, TIOCSWINSZ, &size));
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(*line, before));
    tool = fork();
    TEST_ASSERT_TRUE(tool >= 0);
    if (tool == 0) {
        (void)setsid();
        (void)ioctl(*line, TIOCSCTTY, 0);
        for (int fd = 0; fd < 3; fd++) {
            dup2(*line, fd);
        }
        become(TMINI, words);
    }
    return tool;
}

void program_clean_up(void)
{
    end(&tool);
    end(&lidar);
    end(&talker);
}
