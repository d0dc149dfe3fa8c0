/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini view` in a terminal: what the screen shows, what keys and sizes do, and that the terminal is
 * given back as it was, whatever ends the program. */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE

#include "encoder.h"
#include "program.h"
#include "vt.h"

#include "unity.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static vt_t vt;
static int master = -1;
static int line = -1;
static pid_t tool;
static struct termios before;

void setUp(void)
{
    (void)unsetenv("NO_COLOR");
}

void tearDown(void)
{
    program_clean_up();
    if (master >= 0) {
        close(master);
        close(line);
    }
    master = -1;
}

static void begin(unsigned columns, unsigned rows, const char *const words[])
{
    vt_init(&vt, columns, rows);
    tool = program_start_on_terminal(columns, rows, words, &master, &line, &before);
}

/* Shows what the tool draws within that time. */
static void watch(int milliseconds)
{
    struct pollfd output = {.fd = master, .events = POLLIN};
    char bytes[4096];
    while (poll(&output, 1, milliseconds) > 0) {
        const ssize_t count = read(master, bytes, sizeof bytes);
        if (count <= 0) {
            return;
        }
        vt_feed(&vt, bytes, (size_t)count);
    }
}

static void wait_for(const char *text)
{
    for (int i = 0; i < 1000; i++) {
        if (strstr(vt_text(&vt), text) != NULL) {
            watch(50); /* Until the whole screen has been drawn. */
            return;
        }
        struct pollfd output = {.fd = master, .events = POLLIN};
        char bytes[512];
        if (poll(&output, 1, 10) > 0) {
            const ssize_t count = read(master, bytes, sizeof bytes);
            vt_feed(&vt, bytes, count > 0 ? (size_t)count : 0);
        }
    }
    TEST_FAIL_MESSAGE(vt_text(&vt));
}

static void press(char key)
{
    TEST_ASSERT_EQUAL_INT(1, (int)write(master, &key, 1));
}

static void expect_terminal_as_before(void)
{
    watch(10);
    TEST_ASSERT_FALSE(vt.is_other_screen);
    TEST_ASSERT_FALSE(vt.is_cursor_hidden);
    TEST_ASSERT_EQUAL_UINT(0, vt.misunderstood);
    struct termios after;
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(line, &after));
    TEST_ASSERT_EQUAL_HEX(before.c_lflag, after.c_lflag);
    TEST_ASSERT_EQUAL_HEX(before.c_iflag, after.c_iflag);
    TEST_ASSERT_EQUAL_HEX(before.c_oflag, after.c_oflag);
    TEST_ASSERT_EQUAL_MEMORY(before.c_cc, after.c_cc, sizeof before.c_cc);
}

/* The program has ended with this status, and the terminal is as it was. */
static void expect_end(int expected)
{
    int status = 0;
    for (int i = 0; i < 1000 && waitpid(tool, &status, WNOHANG) != tool; i++) {
        watch(10);
    }
    TEST_ASSERT_TRUE(WIFEXITED(status));
    TEST_ASSERT_EQUAL_INT(expected, WEXITSTATUS(status));
    expect_terminal_as_before();
}

static void resize(unsigned columns, unsigned rows)
{
    const struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = (unsigned short)rows};
    vt.columns = columns;
    vt.rows = rows;
    TEST_ASSERT_EQUAL_INT(0, ioctl(line, TIOCSWINSZ, &size));
}

/* A scan with a point every 90 degrees: 1 m in front, 2 m to the right, 3 m behind, 4 m to the left. */
static const char *cross_recording(void)
{
    const encode_sample_t front = {1000, 10, 0};
    const encode_sample_t rest[3] = {{2000, 20, 0}, {3000, 30, 0}, {4000, 40, 0}};
    const encode_packet_t start = {121, 1, 0, 0, &front}; /* 6.0 Hz */
    const encode_packet_t packet = {0, 3, 5760, 17280, rest};
    uint8_t bytes[100];
    size_t size = encode_packet(bytes, &start);
    size += encode_packet(bytes + size, &packet);
    size += encode_packet(bytes + size, &start);
    const char *const path = program_path("cross.bin");
    program_write_file(path, bytes, size);
    return path;
}

/* --------------------------------------------------------------------------------------- picture */

void test_points_are_where_they_should_be(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    /* The picture is 53 characters wide: the panel takes 27. Two lines are for words, which leaves 88
     * rows of dots; so 4 m are 43 dots, around the dot between 52 and 53, and between 47 and 48. */
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[11][26]); /* the lidar */
    TEST_ASSERT_EQUAL_HEX32(0x25C6, vt.cells[9][26]);  /* front, nearest: dot 53, 37 */
    TEST_ASSERT_EQUAL_HEX32(0x2801, vt.cells[12][37]); /* right: dot 74, 48, its cell's first */
    TEST_ASSERT_EQUAL_HEX32(0x2808, vt.cells[20][26]); /* back: dot 53, 80 */
    TEST_ASSERT_EQUAL_HEX32(0x2801, vt.cells[12][5]);  /* left: dot 10, 48 */
}

void test_the_panel_says_what_is_seen(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    const char *const text = vt_text(&vt);
    TEST_ASSERT_NOT_NULL(strstr(text, " cross.bin "));
    TEST_ASSERT_NOT_NULL(strstr(text, "scan 1  6.0 Hz\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "nearest   1.000 m\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "at 0 deg,\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, " ahead\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "points    4, 4 valid\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "range     4 m, auto\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "packets   3\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "checksums 0\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "lost      0\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "4.00        \xE2\x96\xB2         2.00\n")); /* left, right */
}

void test_a_room_looks_as_it_did_when_a_person_looked_at_it(void)
{
    size_t size = 0;
    begin(80, 24, WORDS("view", RECORDINGS "sim-6hz.bin"));
    wait_for("end of the recording");
    TEST_ASSERT_EQUAL_STRING(program_read_file(0, SCREENS "view_80x24.txt", &size), vt_text(&vt));
}

void test_colours_are_left_out_when_asked(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    TEST_ASSERT_TRUE(vt.coloured > 10);
    press('q');
    expect_end(0);
    tearDown();
    (void)setenv("NO_COLOR", "1", 1);
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    TEST_ASSERT_EQUAL_UINT(0, vt.coloured);
}

/* ----------------------------------------------------------------------------------- keys and size */

void test_keys_zoom(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("range     4 m, auto");
    press('+');
    wait_for("range     3 m\n");
    press('+');
    wait_for("range     2 m\n");
    press('-');
    press('-');
    press('-');
    wait_for("range     6 m\n");
    press('a');
    wait_for("range     4 m, auto");
}

void test_q_ends(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    TEST_ASSERT_TRUE(vt.is_other_screen);
    TEST_ASSERT_TRUE(vt.is_cursor_hidden);
    press('q');
    expect_end(0);
}

void test_the_picture_follows_the_terminals_size(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    resize(60, 18);
    watch(300);
    TEST_ASSERT_EQUAL_HEX32('q', vt.cells[17][1]);
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[8][16]);
    resize(120, 40);
    watch(300);
    TEST_ASSERT_EQUAL_HEX32('q', vt.cells[39][1]);
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[19][46]);
    press('q');
    expect_end(0);
}

void test_a_tiny_terminal_does_no_harm(void)
{
    begin(7, 3, WORDS("view", cross_recording()));
    watch(500);
    resize(1, 1);
    watch(300);
    press('q');
    expect_end(0);
}

/* --------------------------------------------------------------------------- how else it can end */

void test_ctrl_c_gives_the_terminal_back(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    press(3);
    expect_end(0);
}

void test_signals_give_the_terminal_back(void)
{
    static const int signals[] = {SIGTERM, SIGHUP, SIGQUIT};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        begin(80, 24, WORDS("view", cross_recording()));
        wait_for("end of the recording");
        kill(tool, signals[i]);
        expect_end(0);
        tearDown();
    }
}

void test_a_signal_gives_a_terminal_back_whose_output_is_stopped(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
    press('\x13');  /* Ctrl-S */
    resize(60, 18); /* Something to draw: the tool now waits for the terminal. */
    watch(300);
    kill(tool, SIGTERM);
    expect_end(0);
}

void test_a_second_signal_gives_the_terminal_back_and_stops_the_lidar(void)
{
    const char *const log = program_path("log");
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--log", log))));
    wait_for("scan 2 ");
    kill(tool, SIGSTOP); /* So that both come before it can heed the first. */
    kill(tool, SIGTERM);
    kill(tool, SIGHUP);
    kill(tool, SIGCONT);
    int status = 0;
    for (int i = 0; i < 1000 && waitpid(tool, &status, WNOHANG) != tool; i++) {
        watch(10);
    }
    TEST_ASSERT_TRUE(WIFSIGNALED(status));
    expect_terminal_as_before();
    (void)poll(NULL, 0, 1000); /* The lidar's tail. */
    TEST_ASSERT_NOT_NULL(strstr(program_read_file(0, log, NULL), "stopping -> idle"));
}

void test_without_a_terminal_there_is_no_view(void)
{
    TEST_ASSERT_EQUAL_INT(1, program_tmini(WORDS("view", cross_recording())));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "there is none"));
    TEST_ASSERT_EQUAL_STRING("", program_output);
}

void test_a_file_that_is_no_recording_is_told_at_once(void)
{
    begin(80, 24, WORDS("view", RECORDINGS "README.md"));
    expect_end(1);
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "holds no lidar packet"));
}

/* ----------------------------------------------------------------------------------------- live */

void test_a_lidar_is_shown_live_and_stopped_in_the_end(void)
{
    const char *const log = program_path("log");
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--log", log))));
    wait_for("scanning");
    wait_for("scan 5 ");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "behind to the right"));
    press('q');
    expect_end(0);
    TEST_ASSERT_NOT_NULL(strstr(program_read_file(0, log, NULL), "stopping -> idle"));
}

void test_a_blocked_rotor_is_shown(void)
{
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--blocked"))));
    wait_for("health    FAULTY");
    wait_for("encoder (is the rotor blocked?)");
    press('q');
    expect_end(0);
}

void test_a_pulled_cable_ends_the_view_with_a_message(void)
{
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--seed", "2"))));
    wait_for("scan 2 ");
    program_stop_lidar();
    expect_end(1);
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "has gone: the adapter was unplugged"));
}
