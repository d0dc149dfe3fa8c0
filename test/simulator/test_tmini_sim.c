/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The program tmini-sim from outside: usage, pseudo-terminal, socket, lines, recordings. TMINI_SIM
 * is its path. POSIX only. */

#define _XOPEN_SOURCE 600

#include "unity.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#define OUTPUT_MAX 2000000u
#define NO_PROCESS (-1)

static pid_t child = NO_PROCESS;
static int child_input = STDIN_FILENO; /* The program's standard input. */
static int child_output = -1;
static uint8_t received[OUTPUT_MAX];

static const uint8_t ask_information[2] = {0xA5, 0x90};
static const uint8_t ask_frequency[2] = {0xA5, 0x0D};
static const uint8_t start_scan[2] = {0xA5, 0x60};
static const uint8_t stop_scan[2] = {0xA5, 0x65};

static const uint8_t information[27] = {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 0x97, 2, 1, 1, 2, 0, 2,
                                        6,    0,    3,    1, 7, 0, 0,    0,    1, 2, 3, 4, 5};
static const uint8_t six_hertz[11] = {0xA5, 0x5A, 0x04, 0, 0, 0, 0x04, 0x58, 0x02, 0, 0};

/* ---- Helpers ---- */

/* Runs the program with up to six arguments and captures its standard output. */
static void launch(const char *const arguments[])
{
    char *argv[8] = {0};
    int ends[2];

    argv[0] = (char *)(uintptr_t)TMINI_SIM;
    for (size_t i = 0; i < 6 && arguments[i] != NULL; i++) {
        argv[i + 1u] = (char *)(uintptr_t)arguments[i];
    }
    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        dup2(child_input, STDIN_FILENO);
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        if (freopen("/dev/null", "w", stderr) != NULL) {
            execv(TMINI_SIM, argv);
        }
        _exit(127);
    }
    close(ends[1]);
    if (child_input != STDIN_FILENO) {
        close(child_input);
        child_input = STDIN_FILENO;
    }
    child_output = ends[0];
}

static int wait_for_exit(void)
{
    int status = 0;

    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    child = NO_PROCESS;
    close(child_output);
    TEST_ASSERT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static int terminate(void)
{
    kill(child, SIGTERM);
    return wait_for_exit();
}

static int run(const char *const arguments[])
{
    launch(arguments);
    return wait_for_exit();
}

static size_t read_for(int fd, size_t wanted, int timeout_ms)
{
    struct pollfd entry = {fd, POLLIN, 0};
    size_t count = 0;

    while (count < wanted && poll(&entry, 1, timeout_ms) > 0) {
        const ssize_t more = read(fd, received + count, wanted - count);

        if (more <= 0) {
            break;
        }
        count += (size_t)more;
    }
    return count;
}

/* The first line of the program's output. */
static void read_address(char *line, size_t size)
{
    size_t length = 0;

    while (length + 1u < size && read_for(child_output, 1, 5000) == 1u && received[0] != '\n') {
        line[length++] = (char)received[0];
    }
    line[length] = '\0';
}

static void send_to(int fd, const uint8_t *command)
{
    TEST_ASSERT_EQUAL_INT(2, (int)write(fd, command, 2));
}

static void expect_reply(int fd, const uint8_t *expected, size_t length)
{
    TEST_ASSERT_EQUAL_size_t(length, read_for(fd, length, 5000));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, received, length);
}

static int open_pty(const char *path)
{
    const int fd = open(path, O_RDWR | O_NOCTTY);

    TEST_ASSERT_TRUE(fd >= 0);
    return fd;
}

static int connect_to(const char *address)
{
    const char *colon = strchr(address, ':');
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in peer;

    TEST_ASSERT_NOT_NULL(colon);
    memset(&peer, 0, sizeof peer);
    peer.sin_family = AF_INET;
    peer.sin_port = htons((uint16_t)atoi(colon + 1));
    peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    TEST_ASSERT_EQUAL_INT(0, connect(fd, (struct sockaddr *)&peer, sizeof peer));
    return fd;
}

static size_t read_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    size_t count;

    TEST_ASSERT_NOT_NULL(file);
    count = fread(received, 1, OUTPUT_MAX, file);
    fclose(file);
    return count;
}

void setUp(void)
{
    signal(SIGPIPE, SIG_IGN);
}

void tearDown(void)
{
    if (child != NO_PROCESS) {
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
        child = NO_PROCESS;
    }
}

/* ---- Usage ---- */

void test_help_succeeds(void)
{
    static const char *const arguments[] = {"--help", NULL};

    TEST_ASSERT_EQUAL_INT(0, run(arguments));
}

void test_options_may_be_short_joined_and_abbreviated(void)
{
    static const char *const ways[][6] = {{"-h", NULL},
                                          {"-V", NULL},
                                          {"--vers", NULL},
                                          {"--writ=/dev/null", "-s1", NULL},
                                          {"--seco", "1", "--write", "/dev/null", NULL}};

    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        TEST_ASSERT_EQUAL_INT(0, run(ways[i]));
    }
}

void test_wrong_usage_is_exit_status_2(void)
{
    static const char *const wrong[][6] = {
        {NULL},
        {"--what", NULL},
        {"--pty", "--tcp", "0", NULL},
        {"--tcp", NULL},
        {"--tcp", "70000", NULL},
        {"--pty", "--frequency", "4.9", NULL},
        {"--pty", "--frequency", "fast", NULL},
        {"--pty", "--fault", "drop", NULL},
        {"--pty", "--fault", "dropp=1e-4", NULL},
        {"--pty", "--fault", "drop=2", NULL},
        {"--pty", "--speed", "0", NULL},
        {"--pty", "--seed", "-1", NULL},
        {"--pty", "--health", "0x40", NULL},
        {"--pty", "--health", "-1", NULL},
        {"--pty", "--health", "ill", NULL},
        {"--write", "/dev/null", NULL},
        {"--pty=yes", NULL},
        {"--pty", "word", NULL},
        {"--s", "1", NULL}, /* --seed, --seconds, --speed, --spin-up */
        {"--pty", "--motor", "0", NULL},
        {"--pty", "--spin-up", "61", NULL},
        {"--write", "-", "--seconds", "1", "--log", NULL},
        {"--lines", "--pty", NULL},
        {"--lines", "--log", "-", NULL},
    };

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_EQUAL_INT(2, run(wrong[i]));
    }
}

void test_a_file_that_cannot_be_written_is_exit_status_1(void)
{
    static const char *const to_directory[] = {"--write", "/", "--seconds", "1", NULL};
    static const char *const to_full_disk[] = {"--write", "/dev/full", "--seconds", "9", NULL};

    TEST_ASSERT_EQUAL_INT(1, run(to_directory));
    if (access("/dev/full", W_OK) == 0) {
        TEST_ASSERT_EQUAL_INT(1, run(to_full_disk));
    }
}

/* ---- Pseudo-terminal ---- */

static void launch_pty(char *path, size_t size)
{
    static const char *const arguments[] = {"--pty", NULL};

    launch(arguments);
    read_address(path, size);
}

void test_clients_of_the_pty_are_served_one_after_another_without_echo(void)
{
    char path[64];

    launch_pty(path, sizeof path);
    for (int client = 0; client < 3; client++) {
        const int fd = open_pty(path);

        send_to(fd, ask_information);
        expect_reply(fd, information, sizeof information);
        send_to(fd, ask_frequency);
        expect_reply(fd, six_hertz, sizeof six_hertz);
        TEST_ASSERT_EQUAL_size_t(0, read_for(fd, 1, 50));
        close(fd);
    }
    TEST_ASSERT_EQUAL_INT(0, terminate());
}

void test_settings_of_a_client_do_not_affect_the_next_one(void)
{
    struct termios settings;
    char path[64];
    int fd;

    launch_pty(path, sizeof path);
    fd = open_pty(path);
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(fd, &settings));
    settings.c_lflag |= (tcflag_t)(ECHO | ICANON);
    TEST_ASSERT_EQUAL_INT(0, tcsetattr(fd, TCSANOW, &settings));
    poll(NULL, 0, 50);
    close(fd);
    poll(NULL, 0, 200);
    fd = open_pty(path);
    send_to(fd, ask_frequency);
    expect_reply(fd, six_hertz, sizeof six_hertz);
    close(fd);
    TEST_ASSERT_EQUAL_INT(0, terminate());
}

void test_the_stream_goes_on_without_a_client_and_nothing_stale_is_kept(void)
{
    char path[64];
    int fd;

    launch_pty(path, sizeof path);
    fd = open_pty(path);
    send_to(fd, start_scan);
    TEST_ASSERT_EQUAL_size_t(3000, read_for(fd, 3000, 5000));
    close(fd);
    poll(NULL, 0, 500);
    fd = open_pty(path);
    TEST_ASSERT_EQUAL_size_t(3000, read_for(fd, 3000, 5000));
    send_to(fd, stop_scan);
    close(fd);
    poll(NULL, 0, 500);
    fd = open_pty(path);
    TEST_ASSERT_EQUAL_size_t(0, read_for(fd, 1, 100));
    close(fd);
    TEST_ASSERT_EQUAL_INT(0, terminate());
}

/* ---- Socket ---- */

void test_clients_of_the_socket_are_served_one_after_another(void)
{
    static const char *const arguments[] = {"--tcp", "0", NULL};
    char address[64];

    launch(arguments);
    read_address(address, sizeof address);
    TEST_ASSERT_EQUAL_INT(0, strncmp(address, "127.0.0.1:", 10));
    for (int client = 0; client < 3; client++) {
        const int fd = connect_to(address);

        send_to(fd, ask_information);
        expect_reply(fd, information, sizeof information);
        close(fd);
    }
    TEST_ASSERT_EQUAL_INT(0, terminate());
}

void test_a_client_that_has_ended_its_sending_still_gets_its_reply(void)
{
    static const char *const arguments[] = {"--tcp", "0", NULL};
    char address[64];
    int fd;

    launch(arguments);
    read_address(address, sizeof address);
    fd = connect_to(address);
    send_to(fd, ask_frequency);
    shutdown(fd, SHUT_WR);
    expect_reply(fd, six_hertz, sizeof six_hertz);
    close(fd);
    TEST_ASSERT_EQUAL_INT(0, terminate());
}

/* 50 virtual seconds pass in one real second, at 13 kB per virtual second; connecting and spin-up
 * cost some of them. */
void test_it_ends_after_the_virtual_seconds_given(void)
{
    static const char *const arguments[] = {"--tcp", "0", "--speed", "50", "--seconds", "50"};
    char address[64];
    int fd;

    launch(arguments);
    read_address(address, sizeof address);
    fd = connect_to(address);
    send_to(fd, start_scan);
    TEST_ASSERT_TRUE(read_for(fd, OUTPUT_MAX, 5000) > 100000u);
    close(fd);
    TEST_ASSERT_EQUAL_INT(0, wait_for_exit());
}

/* ---- In the caller's time ---- */

/* A reply takes 3 ms of latency and 43.4 us per byte: less than the 1 s and the 10 ms given. */
void test_lines_are_answered_in_the_callers_time(void)
{
    static const char *const arguments[] = {"--lines", NULL};
    static const char questions[] = "0 A590\n1000000\n1000000\n2000000 a50D\n2010000\n";
    static const char answers[] = "\n"
                                  "A55A1400000004970201010200020600030107000000010203040"
                                  "5\n\n\nA55A040000000458020000\n";
    int ends[2];

    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    TEST_ASSERT_EQUAL_INT(sizeof questions - 1,
                          (int)write(ends[1], questions, sizeof questions - 1));
    close(ends[1]);
    child_input = ends[0];
    launch(arguments);
    TEST_ASSERT_EQUAL_size_t(sizeof answers - 1, read_for(child_output, sizeof answers, 5000));
    TEST_ASSERT_EQUAL_MEMORY(answers, received, sizeof answers - 1);
    TEST_ASSERT_EQUAL_INT(0, wait_for_exit());
}

/* ---- Recordings ---- */

void test_the_same_options_give_the_same_recording(void)
{
    static const char *const arguments[] = {"--write", "tmini-sim-test.bin", "--seconds", "20",
                                            "--fault", "drop=1e-4"};
    static uint8_t before[OUTPUT_MAX];
    size_t size;

    TEST_ASSERT_EQUAL_INT(0, run(arguments));
    size = read_file("tmini-sim-test.bin");
    TEST_ASSERT_TRUE(size > 250000u);
    memcpy(before, received, size);
    TEST_ASSERT_EQUAL_INT(0, run(arguments));
    TEST_ASSERT_EQUAL_size_t(size, read_file("tmini-sim-test.bin"));
    TEST_ASSERT_EQUAL_MEMORY(before, received, size);
    remove("tmini-sim-test.bin");
}

void test_the_truth_has_a_row_per_sample(void)
{
    static const char *const arguments[] = {"--write", "/dev/null", "--seconds",
                                            "2",       "--truth",   "tmini-sim-test.csv"};
    static const char header[] =
        "packet,revolution,index,angle_q6,distance_mm,intensity,flag,intact\n0,0,0,";
    size_t rows = 0;
    size_t size;

    TEST_ASSERT_EQUAL_INT(0, run(arguments));
    size = read_file("tmini-sim-test.csv");
    TEST_ASSERT_EQUAL_MEMORY(header, received, sizeof header - 1u);
    for (size_t i = 0; i < size; i++) {
        rows += received[i] == '\n' ? 1u : 0u;
    }
    /* 2 s less 3 ms of latency and 200 ms before the first sample, at 4000 per second. */
    TEST_ASSERT_UINT_WITHIN(80, 7188, rows);
    remove("tmini-sim-test.csv");
}

static void expect_in_log(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr((const char *)received, text), text);
}

void test_the_log_has_commands_modes_faults_and_totals(void)
{
    static const char *const arguments[] = {"--tcp",   "0",        "--log", "tmini-sim-test.log",
                                            "--fault", "flip=0.01"};
    static const uint8_t unknown[2] = {0xA5, 0x77};
    char address[64];
    int fd;

    launch(arguments);
    read_address(address, sizeof address);
    fd = connect_to(address);
    send_to(fd, start_scan);
    TEST_ASSERT_EQUAL_size_t(1000, read_for(fd, 1000, 5000));
    send_to(fd, ask_frequency);
    send_to(fd, unknown);
    send_to(fd, stop_scan);
    for (int i = 0; i < 500; i++) {
        received[read_file("tmini-sim-test.log")] = '\0';
        if (strstr((const char *)received, "stopping -> idle") != NULL) {
            break;
        }
        poll(NULL, 0, 10);
    }
    close(fd);
    TEST_ASSERT_EQUAL_INT(0, terminate());
    received[read_file("tmini-sim-test.log")] = '\0';
    expect_in_log("command A5 60 start\n");
    expect_in_log("command A5 0D get frequency (forbidden while scanning)\n");
    expect_in_log("command A5 77 unknown");
    expect_in_log("mode stopping -> idle\n");
    expect_in_log("fault flip begins\n");
    expect_in_log("3 commands, 1 forbidden while scanning, 1 unknown, ");
    remove("tmini-sim-test.log");
}
