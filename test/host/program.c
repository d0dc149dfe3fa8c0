/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE

#include "program.h"

#include "unity.h"

#include <dlfcn.h>
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
#define CHILDREN_MAX 200
#define PORTS_MAX 100
#define NOBODYS_ID 65534 /* Usually the user without rights. */

const char *program_output;
const char *program_errors;

static char files[4][FILE_MAX];
static bool gives_up_rights;
static pid_t lidar = NOBODY; /* The last one started. */

/* All running children; those before `background` run until the end. */
static pid_t children[CHILDREN_MAX];
static size_t child_count;
static size_t background;
static bool is_background;

/* The test leaves its files in its own folder, wherever it is started. */
__attribute__((constructor)) static void go_home(void)
{
    if (chdir(HOME_DIR) != 0) {
        abort();
    }
}

const char *program_path(const char *name)
{
    static char paths[4][100];
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

const char *program_wait_for(const char *name, const char *text)
{
    for (int waited_ms = 0; waited_ms < PATIENCE_MS; waited_ms += 10) {
        const char *const content = program_read_file(0, program_path(name), NULL);
        if (strstr(content, text) != NULL) {
            return content;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_FAIL_MESSAGE(files[0]);
    return NULL;
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

/* In the child: runs the program. */
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

static void forget(pid_t pid)
{
    for (size_t i = 0; i < child_count; i++) {
        children[i] = children[i] == pid ? NOBODY : children[i];
    }
}

static pid_t fork_child(void)
{
    TEST_ASSERT_TRUE(child_count < CHILDREN_MAX);
    const pid_t pid = fork();
    TEST_ASSERT_TRUE(pid >= 0);
    if (pid == 0) {
        /* Adapters plugged into this computer must not matter. */
        (void)setenv("TMINI_ROOT", WORK_DIR "/no_adapters", 0);
        return 0;
    }
    children[child_count++] = pid;
    background = is_background ? child_count : background;
    return pid;
}

/* Path of a program's output or errors: WORK_DIR/NAMEoutput. */
typedef char file_name_t[120];

static const char *file_of(const char *name, const char *kind, file_name_t file)
{
    (void)snprintf(file, sizeof(file_name_t), "%s/%.50s%.20s", WORK_DIR, name, kind);
    return file;
}

static pid_t start(const char *path, const char *name, const char *input, const char *const words[])
{
    file_name_t output;
    file_name_t errors;
    (void)file_of(name, "output", output);
    (void)file_of(name, "errors", errors);
    program_write_file(output, "", 0); /* Remove the previous program's output. */
    program_write_file(errors, "", 0);
    const pid_t pid = fork_child();
    if (pid == 0) {
        redirect(STDIN_FILENO, input, O_RDONLY);
        redirect(STDOUT_FILENO, output, O_WRONLY);
        redirect(STDERR_FILENO, errors, O_WRONLY);
        become(path, words);
    }
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

int program_finish_as(const char *name, pid_t pid)
{
    int status = 0;
    file_name_t file;
    TEST_ASSERT_TRUE_MESSAGE(wait_for(pid, &status), "the tool does not end");
    forget(pid);
    program_output = program_read_file(2, file_of(name, "output", file), NULL);
    program_errors = program_read_file(3, file_of(name, "errors", file), NULL);
    TEST_ASSERT_TRUE_MESSAGE(WIFEXITED(status), "the tool was ended by a signal");
    return WEXITSTATUS(status);
}

int program_finish(pid_t pid, int signal_number)
{
    if (signal_number != 0) {
        kill(pid, signal_number);
    }
    return program_finish_as("", pid);
}

pid_t program_start_as(const char *name, const char *const words[])
{
    return start(TMINI, name, "/dev/null", words);
}

pid_t program_start_tmini(const char *const words[])
{
    return start(TMINI, "", "/dev/null", words);
}

pid_t program_start(const char *path, const char *const words[])
{
    return start(path, "", "/dev/null", words);
}

int program_tmini(const char *const words[])
{
    return program_finish(start(TMINI, "", "/dev/null", words), 0);
}

int program_tmini_from(const char *input, const char *const words[])
{
    return program_finish(start(TMINI, "", input, words), 0);
}

static bool is_in_real_time;

void program_use_real_time(void)
{
    is_in_real_time = true;
}

static file_name_t clock_link;

void program_skip_idle_time(void)
{
/* Sanitizers must be the first library loaded. */
#if defined(IDLE_CLOCK) && !defined(__SANITIZE_ADDRESS__)
    static const char nothing[4096];
    static unsigned count;
    file_name_t name;
    (void)snprintf(name, sizeof name, "%s/clock.%u", WORK_DIR, count++);
    program_write_file(name, nothing, sizeof nothing);
    (void)setenv("TMINI_IDLE_CLOCK", name, 1);
    /* A path without spaces: in LD_PRELOAD spaces separate libraries. */
    if (clock_link[0] == '\0') {
        (void)snprintf(clock_link, sizeof clock_link, "/tmp/tmini-clock.%ld", (long)getpid());
        (void)unlink(clock_link);
        TEST_ASSERT_EQUAL_INT(0, symlink(IDLE_CLOCK, clock_link));
    }
    (void)setenv("LD_PRELOAD", clock_link, 1);
#endif
}

static void begin_clock(void)
{
    if (!is_in_real_time) {
        program_skip_idle_time();
    }
}

static char *new_port(void)
{
    static char ports[PORTS_MAX][100];
    static size_t count;
    TEST_ASSERT_TRUE(count < PORTS_MAX);
    return ports[count++];
}

/* The first line that the simulator prints: "/dev/pts/3" or "127.0.0.1:4711". */
static void read_port(int fd, char *port, size_t size)
{
    struct pollfd output = {.fd = fd, .events = POLLIN};
    char line[80];
    size_t length = 0;
    while (length + 1 < sizeof line && poll(&output, 1, 5000) > 0 &&
           read(fd, line + length, 1) == 1 && line[length] != '\n') {
        length++;
    }
    line[length] = '\0';
    TEST_ASSERT_TRUE_MESSAGE(length > 0, "the simulator names no port");
    (void)snprintf(port, size, "%s%s", line[0] == '/' ? "" : "tcp:", line);
}

const char *program_start_lidar(const char *const options[])
{
    begin_clock();
    return program_start_lidar_again(options);
}

const char *program_start_lidar_again(const char *const options[])
{
    char *const port = new_port();
    int ends[2];
    const char *words[PROGRAM_WORDS_MAX] = {"--pty"};
    const bool is_socket = options[0] != NULL && strcmp(options[0], "--tcp") == 0;
    for (size_t i = 0; options[i] != NULL; i++) {
        words[i + (is_socket ? 0 : 1)] = options[i];
    }
    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    lidar = fork_child();
    if (lidar == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        become(TMINI_SIM, words);
    }
    close(ends[1]);
    read_port(ends[0], port, 100);
    close(ends[0]);
    return port;
}

void program_plug_in(const char *device)
{
    const char *const name = program_path("adapter");
    (void)remove(name);
    TEST_ASSERT_TRUE(device == NULL || symlink(device, name) == 0);
}

static void end(pid_t pid)
{
    if (pid != NOBODY) {
        kill(pid, SIGKILL);
        (void)waitpid(pid, NULL, 0);
        forget(pid);
    }
}

void program_stop_lidar(void)
{
    end(lidar);
    lidar = NOBODY;
}

void program_freeze_lidar(void)
{
    TEST_ASSERT_TRUE(lidar > 0);
    TEST_ASSERT_EQUAL_INT(0, kill(lidar, SIGSTOP));
}

void program_thaw_lidar(void)
{
    TEST_ASSERT_EQUAL_INT(0, kill(lidar, SIGCONT));
}

/* Waits on the clock that this process shares with the tool. */
static void wait_10_ms(void)
{
    static int (*wait)(struct pollfd * fds, nfds_t count, int timeout_ms) = poll;
#ifdef IDLE_CLOCK
    void *const library = getenv("LD_PRELOAD") != NULL ? dlopen(IDLE_CLOCK, RTLD_NOW) : NULL;
    void *const function = library != NULL ? dlsym(library, "poll") : NULL;
    if (function != NULL) {
        memcpy(&wait, &function, sizeof wait);
    }
#endif
    (void)wait(NULL, 0, 10);
}

/* Discards what the host sends, but answers the command A5 `code` (0: none). */
static void talk(int fd, const uint8_t *bytes, size_t size, uint8_t code)
{
    uint8_t heard = 0;
    uint8_t before = 0;
    size_t at = 0;
    for (;;) {
        if (size > 0 && code == 0) {
            const size_t rest = size - at;
            const ssize_t sent = write(fd, bytes + at, rest < 131 ? rest : 131);
            at = sent > 0 ? (at + (size_t)sent) % size : at;
        }
        if (read(fd, &heard, 1) < 0) {
            wait_10_ms();
        } else {
            if (code != 0 && before == 0xA5 && heard == code && write(fd, bytes, size) < 0) {
                _exit(1);
            }
            before = heard;
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

static const char *start_talker(const uint8_t *bytes, size_t size, uint8_t code)
{
    char *const port = new_port();
    int master = -1;
    int line = -1;
    struct termios settings;
    begin_clock();
    open_terminal(&master, &line);
    /* Raw mode, so that there is no echo. */
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(line, &settings));
    settings.c_lflag = 0;
    settings.c_oflag = 0;
    TEST_ASSERT_EQUAL_INT(0, tcsetattr(line, TCSANOW, &settings));
    if (fork_child() == 0) {
        (void)fcntl(master, F_SETFL, O_NONBLOCK);
        talk(master, bytes, size, code);
    }
    (void)snprintf(port, 100, "%s", ptsname(master));
    close(master);
    close(line); /* The child's copy stays open: otherwise the child would get a hang-up. */
    return port;
}

const char *program_start_talker(const uint8_t *bytes, size_t size)
{
    return start_talker(bytes, size, 0);
}

const char *program_start_answerer(uint8_t code, const uint8_t *bytes, size_t size)
{
    return start_talker(bytes, size, code);
}

static pid_t start_on_terminal(const struct winsize *size, const char *path,
                               const char *const words[], int *master, int *line,
                               struct termios *before)
{
    open_terminal(master, line);
    TEST_ASSERT_EQUAL_INT(0, ioctl(*line, TIOCSWINSZ, size));
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(*line, before));
    const pid_t tool = fork_child();
    if (tool == 0) {
        (void)setsid();
        (void)ioctl(*line, TIOCSCTTY, 0);
        for (int fd = 0; fd < 3; fd++) {
            dup2(*line, fd);
        }
        become(path, words);
    }
    return tool;
}

pid_t program_start_on_terminal(unsigned columns, unsigned rows, const char *const words[],
                                int *master, int *line, struct termios *before)
{
    const struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = (unsigned short)rows};
    return start_on_terminal(&size, TMINI, words, master, line, before);
}

pid_t program_start_shell_on_terminal(unsigned columns, unsigned rows, const char *script,
                                      int *master, int *line, struct termios *before)
{
    const struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = (unsigned short)rows};
    const char *const words[] = {"-c", script, NULL};
    return start_on_terminal(&size, "/bin/sh", words, master, line, before);
}

void program_begin_background(void)
{
    is_background = true;
}

void program_end_background(void)
{
    is_background = false;
}

static void end_all(void)
{
    background = 0;
    program_clean_up();
    (void)unlink(clock_link);
}

void program_clean_up(void)
{
    static bool is_at_exit;
    is_at_exit = is_at_exit || atexit(end_all) == 0;
    (void)unsetenv("LD_PRELOAD"); /* The clock of the ended programs. */
    (void)unsetenv("TMINI_IDLE_CLOCK");
    while (child_count > background) {
        end(children[--child_count]);
    }
}

unsigned program_count(const char *text, const char *part)
{
    unsigned count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part)) {
        count++;
    }
    return count;
}

void program_expect_failure(int status, const char *reason, const char *const words[])
{
    TEST_ASSERT_EQUAL_INT(status, program_tmini(words));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini: "));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, reason), program_errors);
}

const char *program_write_turn(const char *name, const encode_sample_t samples[4])
{
    const encode_packet_t start = {60 << 1 | 1, 1, 0, 0, samples};
    const encode_packet_t packet = {0, 3, 90 * 64, 270 * 64, samples + 1};
    uint8_t bytes[100];
    size_t size = encode_packet(bytes, &start);
    size += encode_packet(bytes + size, &packet);
    size += encode_packet(bytes + size, &start);
    const char *const path = program_path(name);
    program_write_file(path, bytes, size);
    return path;
}
