/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini view` in a terminal: what the screen shows, what keys and sizes do, and that the terminal
 * is restored, however the program ends. */

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
#include <time.h>
#include <unistd.h>

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

/* How long to wait for an expected screen. */
#define PATIENCE_S 60

static vt_t vt;
static int master = -1;
static int line = -1;
static pid_t tool;
static struct termios before;

/* Without idle time, a live picture would change too fast to be examined. */
void setUp(void)
{
    program_use_real_time();
    (void)unsetenv("NO_COLOR");
    (void)unsetenv("TMINI_PORT");
    (void)setenv("TERM", "xterm-256color", 1);
    (void)setenv("LC_ALL", "C.UTF-8", 1);
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

/* Feeds the tool's output to the screen until there is none for this time. */
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
    const time_t begun = time(NULL);
    while (time(NULL) - begun < PATIENCE_S) {
        if (strstr(vt_text(&vt), text) != NULL) {
            watch(50); /* Wait until the whole screen has been drawn. */
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

static void press_all(const char *keys)
{
    TEST_ASSERT_EQUAL_INT((int)strlen(keys), (int)write(master, keys, strlen(keys)));
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

/* The program must end with this status and restore the terminal. */
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

static void quit(void)
{
    press('q');
    expect_end(0);
}

static void resize(unsigned columns, unsigned rows)
{
    const struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = (unsigned short)rows};
    vt.columns = columns;
    vt.rows = rows;
    TEST_ASSERT_EQUAL_INT(0, ioctl(line, TIOCSWINSZ, &size));
}

/* A scan with a point every 90 degrees: 1 m in front, 2 m to the right, 3 m behind, 4 m to the
 * left. */
static const char *cross_recording(void)
{
    const encode_sample_t samples[4] = {{1000, 10, 0}, {2000, 20, 0}, {3000, 30, 0}, {4000, 40, 0}};
    return program_write_turn("cross.bin", samples);
}

static void see_the_cross(void)
{
    begin(80, 24, WORDS("view", cross_recording()));
    wait_for("end of the recording");
}

/* ------------------------------------------------------------------------------------ picture */

void test_points_are_where_they_should_be(void)
{
    see_the_cross();
    /* The panel takes 27 of 80 columns, so the picture has 53. Two of 24 lines are text, which
     * leaves 22, or 88 rows of dots. So 4 m are 43 dots. The centre is between the dots 52 and 53
     * of a row, and between the rows 47 and 48. */
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[11][26]); /* the lidar */
    TEST_ASSERT_EQUAL_HEX32(0x25C6, vt.cells[9][26]);  /* front, nearest: dot 53, 37 */
    TEST_ASSERT_EQUAL_HEX32(0x2801, vt.cells[12][37]); /* right: dot 74, 48, its cell's first */
    TEST_ASSERT_EQUAL_HEX32(0x2808, vt.cells[20][26]); /* back: dot 53, 80 */
    TEST_ASSERT_EQUAL_HEX32(0x2801, vt.cells[12][5]);  /* left: dot 10, 48 */
}

void test_the_panel_reports_what_is_seen(void)
{
    see_the_cross();
    const char *const text = vt_text(&vt);
    TEST_ASSERT_NOT_NULL(strstr(text, " cross.bin "));
    TEST_ASSERT_NOT_NULL(strstr(text, "  incomplete scan 1  6.0 Hz\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "nearest   1.000 m\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "at 0 deg,\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, " ahead\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "points    4, 4 valid\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "range     4 m, auto\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "packets   3\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "damaged   0.0 %\n"));
    TEST_ASSERT_NOT_NULL(strstr(text, "4.00        \xE2\x96\xB2         2.00\n")); /* left, right */
}

void test_a_room_looks_as_it_did_when_a_person_looked_at_it(void)
{
    program_skip_idle_time();
    size_t size = 0;
    begin(80, 24, WORDS("view", RECORDINGS "sim-6hz.bin"));
    wait_for("end of the recording");
    TEST_ASSERT_EQUAL_STRING(program_read_file(0, SCREENS "view_80x24.txt", &size), vt_text(&vt));
}

void test_colours_are_left_out_when_asked(void)
{
    see_the_cross();
    TEST_ASSERT_TRUE(vt.coloured > 10);
    quit();
    tearDown();
    (void)setenv("NO_COLOR", "1", 1);
    see_the_cross();
    TEST_ASSERT_EQUAL_UINT(0, vt.coloured);
}

/* ------------------------------------------------------------------------------ keys and size */

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
    see_the_cross();
    TEST_ASSERT_TRUE(vt.is_other_screen);
    TEST_ASSERT_TRUE(vt.is_cursor_hidden);
    quit();
}

void test_the_picture_follows_the_terminals_size(void)
{
    see_the_cross();
    resize(60, 18);
    watch(300);
    TEST_ASSERT_EQUAL_HEX32('q', vt.cells[17][1]);
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[8][16]);
    resize(120, 40);
    watch(300);
    TEST_ASSERT_EQUAL_HEX32('q', vt.cells[39][1]);
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[19][46]);
    quit();
}

void test_a_tiny_terminal_does_no_harm(void)
{
    program_skip_idle_time();
    begin(7, 3, WORDS("view", cross_recording()));
    watch(500);
    resize(1, 1);
    watch(300);
    quit();
}

void test_escape_ends_and_an_arrow_does_not(void)
{
    see_the_cross();
    press_all("\033[A"); /* The key "up" has no function. */
    press('+');
    wait_for("range     3 m\n");
    press(27);
    expect_end(0);
}

/* A raw recording of two seconds: somewhat more than 8 scans. */
#define ROOM RECORDINGS "sim-6hz.bin"
#define LONG_ROOM "room.bin"

void test_a_recording_can_be_paused_stepped_through_and_played_again(void)
{
    begin(80, 24, WORDS("view", ROOM));
    wait_for("end of the recording");
    press(',');
    wait_for("scan 7 ");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "paused"));
    press(',');
    wait_for("scan 6 ");
    press('.');
    wait_for("scan 7 ");
    watch(400); /* It stays paused. */
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "scan 7 "));
    press(' '); /* It continues. */
    wait_for("end of the recording");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "scan 8 "));
    press_all("\033[D"); /* Five seconds back is the beginning. */
    wait_for("playing");
    wait_for("scan 2 ");
    press('>');
    wait_for("end of the recording");
}

/* The cross as a timed recording: the scan ends two seconds after its beginning. */
static void write_slow_cross(const char *path)
{
    size_t size = 0;
    const char *const cross = program_read_file(0, cross_recording(), &size);
    const size_t first = 13; /* The start packet. */
    uint8_t file[200] = {0x89, 't', 'm', 'i', 'n', 'i', 1, '\n', 0, 0, 0, 0, (uint8_t)first, 0};
    size_t length = 14;
    memcpy(file + length, cross, first);
    length += first;
    const uint8_t head[6] = {0x80, 0x84, 0x1E, 0, (uint8_t)(size - first), 0}; /* 2000000 us */
    memcpy(file + length, head, sizeof head);
    length += sizeof head;
    memcpy(file + length, cross + first, size - first);
    program_write_file(path, file, length + size - first);
}

void test_a_timed_recording_is_played_at_its_own_pace(void)
{
    write_slow_cross(program_path("slow.tmini"));
    begin(80, 24, WORDS("view", program_path("slow.tmini")));
    wait_for("playing");
    struct timespec since;
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &since);
    TEST_ASSERT_NULL(strstr(vt_text(&vt), "scan 1 "));
    wait_for("scan 1 ");
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    const long passed_ms =
        (now.tv_sec - since.tv_sec) * 1000 + (now.tv_nsec - since.tv_nsec) / 1000000;
    TEST_ASSERT_TRUE(passed_ms > 1000); /* Less than 2 s, because `since` is read a little late. */
    quit();
}

static unsigned scan_shown(void)
{
    unsigned number = 0;
    const char *const at = strstr(vt_text(&vt), "scan ");
    TEST_ASSERT_NOT_NULL(at);
    TEST_ASSERT_EQUAL_INT(1, sscanf(at, "scan %u", &number));
    return number;
}

/* The recording's time stands still during the pause: 2 s would be 12 scans. */
void test_after_a_pause_a_recording_goes_on_where_it_was(void)
{
    TEST_ASSERT_EQUAL_INT(0, system("cat " ROOM " " ROOM " " ROOM " " ROOM " >" LONG_ROOM));
    begin(80, 24, WORDS("view", LONG_ROOM));
    wait_for("scan 2 ");
    press(' ');
    wait_for("paused");
    const unsigned before_pause = scan_shown();
    watch(2000);
    TEST_ASSERT_EQUAL_UINT(before_pause, scan_shown());
    press(' ');
    wait_for("playing");
    TEST_ASSERT_TRUE(scan_shown() < before_pause + 8);
    for (int i = 0; i < 300 && scan_shown() == before_pause; i++) {
        watch(10);
    }
    TEST_ASSERT_TRUE(scan_shown() > before_pause);
    TEST_ASSERT_TRUE(scan_shown() < before_pause + 8);
    quit();
}

void test_keys_come_from_the_terminal_also_when_the_recording_comes_through_a_pipe(void)
{
    program_skip_idle_time();
    (void)setenv("TOOL", TMINI, 1);
    vt_init(&vt, 80, 24);
    tool = program_start_shell_on_terminal(80, 24, "cat " ROOM " | \"$TOOL\" view -", &master,
                                           &line, &before);
    wait_for("end of the recording");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "scan 8 "));
    press('+');
    wait_for("range     4 m\n");
    quit();
}

void test_ctrl_z_gives_the_terminal_back_and_fg_takes_it_again(void)
{
    program_skip_idle_time();
    (void)setenv("TOOL", TMINI, 1);
    vt_init(&vt, 80, 24);
    tool = program_start_shell_on_terminal(80, 24, "set -m; \"$TOOL\" view " ROOM "; fg >/dev/null",
                                           &master, &line, &before);
    wait_for("end of the recording");
    const unsigned taken_before = vt.taken;
    press(26);
    for (int i = 0; i < 500 && vt.taken == taken_before; i++) {
        watch(10); /* The shell continues the tool in the foreground. */
    }
    TEST_ASSERT_EQUAL_UINT(taken_before + 1, vt.taken);
    wait_for("end of the recording");
    quit();
}

/* ---------------------------------------------------------------------------- other terminals */

static void expect_ascii(void)
{
    for (const char *at = vt_text(&vt); *at != '\0'; at++) {
        TEST_ASSERT_TRUE((unsigned char)*at < 128);
    }
}

void test_a_locale_without_utf_8_gets_ascii_characters(void)
{
    (void)setenv("LC_ALL", "C", 1);
    see_the_cross();
    expect_ascii();
    TEST_ASSERT_EQUAL_HEX32('A', vt.cells[11][26]); /* the lidar */
    TEST_ASSERT_EQUAL_HEX32('X', vt.cells[9][26]);  /* front, nearest */
    TEST_ASSERT_EQUAL_HEX32('*', vt.cells[12][37]); /* right */
    TEST_ASSERT_EQUAL_HEX32('*', vt.cells[20][26]); /* back */
    TEST_ASSERT_EQUAL_HEX32('*', vt.cells[12][5]);  /* left */
    quit();
}

/* The first of the three variables that is not empty counts. */
void test_the_locale_is_the_one_that_the_variables_say(void)
{
    (void)setenv("LC_ALL", "", 1);
    (void)setenv("LC_CTYPE", "", 1);
    (void)setenv("LANG", "xy_ZZ.utf8", 1); /* Not installed here. */
    see_the_cross();
    TEST_ASSERT_EQUAL_HEX32(0x25B2, vt.cells[11][26]);
    quit();
    (void)unsetenv("LC_CTYPE");
    (void)unsetenv("LANG");
}

void test_a_dumb_terminal_gets_one_picture_below_the_other(void)
{
    program_skip_idle_time();
    (void)setenv("TERM", "dumb", 1);
    see_the_cross();
    TEST_ASSERT_EQUAL_UINT(0, vt.coloured);
    TEST_ASSERT_EQUAL_UINT(0, vt.escapes);
    TEST_ASSERT_FALSE(vt.is_other_screen);
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "nearest   1.000 m\n"));
    press('q');
    int status = 0;
    for (int i = 0; i < 1000 && waitpid(tool, &status, WNOHANG) != tool; i++) {
        watch(10);
    }
    TEST_ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    TEST_ASSERT_EQUAL_UINT(0, vt.escapes);
}

void test_an_empty_no_color_variable_has_no_effect(void)
{
    (void)setenv("NO_COLOR", "", 1);
    see_the_cross();
    TEST_ASSERT_TRUE(vt.coloured > 10);
}

void test_a_small_terminal_has_the_picture_the_state_and_the_way_out(void)
{
    program_skip_idle_time();
    begin(30, 10, WORDS("view", ROOM));
    wait_for("end of the recording");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "\n q quit  end of the recording\n"));
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), " sim-6hz.bin   scan 8  6.0 Hz\n"));
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "\xE2\x96\xB2")); /* the lidar */
    resize(18, 5);
    wait_for("\n q quit  end of th\n");
    TEST_ASSERT_EQUAL_STRING_LEN("   scan 8  6.0 Hz\n", vt_text(&vt), 18);
    quit();
}

/* ------------------------------------------------------------------------- imperfect conditions */

/* `decode` and `plot` show it, but only on a terminal. */
void test_reading_a_long_recording_shows_its_progress(void)
{
    (void)setenv("TOOL", TMINI, 1);
    vt_init(&vt, 80, 24);
    tool = program_start_shell_on_terminal(
        80, 24,
        "cp " ROOM " " LONG_ROOM "; for i in 1 2 3 4 5 6 7 8 9 10; do cat " LONG_ROOM " " LONG_ROOM
        " >two; mv two " LONG_ROOM "; done; \"$TOOL\" decode " LONG_ROOM " | tail -n 1",
        &master, &line, &before);
    wait_for("100 % of " LONG_ROOM);
    wait_for("LastCRC bytes");
    (void)remove(LONG_ROOM);
}

void test_a_damaged_recording_says_so(void)
{
    program_skip_idle_time();
    begin(80, 24, WORDS("view", RECORDINGS "sim-6hz-damaged.bin"));
    wait_for("end of the recording");
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "  incomplete scan "));
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "damaged   10.7 %\n")); /* 32 of 298 */
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "health    unknown\n"));
}

/* The colour scale keeps its range when the brightest point has gone. */
void test_the_colour_scale_does_not_shrink(void)
{
    const encode_sample_t dim = {1000, 10, 0};
    const encode_sample_t far_dim = {2000, 20, 0};
    const encode_sample_t far_bright = {2000, 250, 0};
    const encode_packet_t start = {121, 1, 0, 0, &dim};
    const encode_packet_t with_bright = {0, 1, 5760, 5760, &far_bright};
    const encode_packet_t with_dim = {0, 1, 5760, 5760, &far_dim};
    uint8_t bytes[200];
    size_t size = 0;
    for (unsigned turn = 0; turn < 2; turn++) {
        size += encode_packet(bytes + size, &start);
        size += encode_packet(bytes + size, turn == 0 ? &with_bright : &with_dim);
    }
    size += encode_packet(bytes + size, &start);
    program_write_file(program_path("steady.bin"), bytes, size);
    begin(80, 24, WORDS("view", program_path("steady.bin")));
    wait_for("end of the recording");
    /* 2 m to the right: in scan 2 intensity 20, on a scale of 10 to 250. */
    const unsigned colour = vt.colours[12][48];
    press(',');
    wait_for("scan 1 ");
    TEST_ASSERT_TRUE(vt.colours[12][48] != colour); /* In scan 1 it is the brightest. */
}

/* --------------------------------------------------------------------------- other ways to end */

void test_ctrl_c_gives_the_terminal_back(void)
{
    see_the_cross();
    press(3);
    expect_end(0);
}

void test_signals_give_the_terminal_back(void)
{
    static const int signals[] = {SIGTERM, SIGHUP, SIGQUIT};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        see_the_cross();
        kill(tool, signals[i]);
        expect_end(0);
        tearDown();
    }
}

void test_a_signal_gives_a_terminal_back_whose_output_is_stopped(void)
{
    see_the_cross();
    press('\x13');  /* Ctrl-S stops the terminal's output. */
    resize(60, 18); /* The tool must draw again, and blocks in the write. */
    watch(300);
    kill(tool, SIGTERM);
    expect_end(0);
}

void test_a_second_signal_gives_the_terminal_back_and_stops_the_lidar(void)
{
    const char *const log = program_path("log");
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--log", log))));
    wait_for("scan 2 ");
    kill(tool, SIGSTOP); /* So that both signals are pending before it can handle the first. */
    kill(tool, SIGTERM);
    kill(tool, SIGHUP);
    kill(tool, SIGCONT);
    int status = 0;
    for (int i = 0; i < 1000 && waitpid(tool, &status, WNOHANG) != tool; i++) {
        watch(10);
    }
    TEST_ASSERT_TRUE(WIFSIGNALED(status));
    expect_terminal_as_before();
    (void)program_wait_for("log", "stopping -> idle");
}

void test_without_a_terminal_there_is_no_view(void)
{
    TEST_ASSERT_EQUAL_INT(1, program_tmini(WORDS("view", cross_recording())));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "there is none"));
    TEST_ASSERT_EQUAL_STRING("", program_output);
}

void test_a_file_that_is_no_recording_is_reported_at_once(void)
{
    begin(80, 24, WORDS("view", RECORDINGS "README.md"));
    expect_end(1);
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "holds no lidar packet"));
}

/* --------------------------------------------------------------------------------------- live */

void test_a_lidar_is_shown_live_and_stopped_at_the_end(void)
{
    const char *const log = program_path("log");
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--log", log))));
    wait_for("scanning");
    wait_for("scan 5 ");
    wait_for("behind right"); /* Or in the next scan, if this one has a gap there. */
    quit();
    (void)program_wait_for("log", "stopping -> idle");
}

void test_a_lidar_that_falls_silent_is_called_so_until_it_is_back(void)
{
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--seed", "3"))));
    wait_for("scan 2 ");
    program_freeze_lidar();
    wait_for("SILENT: starting it again\n");
    program_thaw_lidar();
    wait_for("scanning\n");
    TEST_ASSERT_NULL(strstr(vt_text(&vt), "SILENT"));
    quit();
}

void test_a_blocked_rotor_is_shown(void)
{
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--blocked"))));
    wait_for("health    FAULTY");
    wait_for("faulty: encoder (is the rotor blocked?)\n"); /* It has a separate line. */
    wait_for("\n q quit   + - zoom   a auto ");
    quit();
}

void test_a_pulled_cable_ends_the_view_with_a_message(void)
{
    begin(80, 24, WORDS("view", "-p", program_start_lidar(WORDS("--seed", "2"))));
    wait_for("scan 2 ");
    program_stop_lidar();
    expect_end(1);
    TEST_ASSERT_NOT_NULL(strstr(vt_text(&vt), "has gone: the adapter was unplugged"));
}
