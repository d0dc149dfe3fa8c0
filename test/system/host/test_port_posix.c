/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The POSIX port itself: what opening and receiving return, and the blocking helpers over it. */

#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE /* B230400 */

#include "program.h"
#include "tmini/tmini_blocking.h"
#include "tmini_posix.h"

#include "unity.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

static tmini_posix_t serial;
static tmini_t lidar;
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static size_t tapped;

void setUp(void)
{
    tapped = 0;
}

void tearDown(void)
{
    tmini_posix_close(&serial);
    program_clean_up();
}

static void begin(void)
{
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &serial,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = sizeof points / sizeof points[0],
    };
    const char *const port = program_start_lidar((const char *const[]){NULL});
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_open(&serial, port));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
    tmini_posix_attach(&serial, &lidar);
}

static void tap(void *context, const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_EQUAL_PTR(&tapped, context);
    TEST_ASSERT_NOT_NULL(bytes);
    tapped += count;
}

void test_the_blocking_helpers_work_over_it(void)
{
    tmini_info_t info;
    uint16_t frequency_chz = 0;
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_read_frequency(&lidar, &frequency_chz, 8000));
    TEST_ASSERT_EQUAL_UINT16(600, frequency_chz);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start_and_wait(&lidar, 8000));
    TEST_ASSERT_TRUE(tmini_scan(&lidar)->count > 600);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop_and_wait(&lidar, 2000));
}

void test_a_tap_gets_every_byte(void)
{
    tmini_info_t info;
    begin();
    tmini_posix_tap(&serial, tap, &tapped);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_size_t(27, tapped); /* The reply: 7 + 20 bytes. */
    TEST_ASSERT_EQUAL_UINT64(27, serial.received);
    tmini_posix_tap(&serial, NULL, NULL);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_read_info(&lidar, &info, 8000));
    TEST_ASSERT_EQUAL_size_t(27, tapped);
}

void test_silence_is_no_error(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_receive(&serial, 20));
    TEST_ASSERT_EQUAL_UINT64(0, serial.received);
}

void test_a_device_that_has_gone_stays_gone(void)
{
    tmini_info_t info;
    begin();
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_receive(&serial, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_UNPLUGGED, tmini_posix_receive(&serial, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_read_info(&lidar, &info, 8000));
}

void test_a_system_that_cannot_wait_for_bytes_is_no_silence(void)
{
    struct rlimit limit;
    begin();
    TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &limit));
    const struct rlimit none = {.rlim_cur = 0, .rlim_max = limit.rlim_max};
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &none)); /* poll() fails then. */
    const tmini_posix_status_t status = tmini_posix_receive(&serial, 100);
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &limit));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, status);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_FAILED, tmini_posix_receive(&serial, 0));
}

void test_writing_to_a_device_that_has_gone_fails(void)
{
    tmini_info_t info;
    begin();
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_read_info(&lidar, &info, 8000));
}

void test_a_device_is_used_by_one_program_at_a_time(void)
{
    tmini_posix_t other;
    const char *const port = program_start_lidar((const char *const[]){NULL});
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_open(&serial, port));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_BUSY, tmini_posix_open(&other, port));
    tmini_posix_close(&serial);
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_open(&other, port));
    tmini_posix_close(&other);
}

void test_reasons_for_not_opening_are_told_apart(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_open(&serial, "/dev/nowhere"));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NO_DEVICE, tmini_posix_receive(&serial, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, tmini_posix_open(&serial, "/dev/null"));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, tmini_posix_receive(&serial, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_NOT_A_TERMINAL, tmini_posix_open(&serial, "/tmp"));
}

void test_a_line_for_typing_becomes_one_for_bytes(void)
{
    /* A new pseudo-terminal is one for typing: it echoes, edits lines, and changes characters. */
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(master >= 0);
    TEST_ASSERT_EQUAL_INT(0, grantpt(master));
    TEST_ASSERT_EQUAL_INT(0, unlockpt(master));
    TEST_ASSERT_EQUAL_INT(TMINI_POSIX_OK, tmini_posix_open(&serial, ptsname(master)));
    struct termios settings;
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(master, &settings));
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
    for (int i = TMINI_POSIX_FAILED; i <= TMINI_POSIX_OK; i++) {
        const char *const name = tmini_posix_status_name((tmini_posix_status_t)i);
        TEST_ASSERT_TRUE(strlen(name) > 0 && strcmp(name, "unknown status") != 0);
    }
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_posix_status_name((tmini_posix_status_t)1));
}
