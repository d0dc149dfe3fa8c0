/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Replies: their format for each command, and the meaning of their content (sections 3, 4 and
 * 9). */

#include "rows.h"

#include "tmini/parts/tmini_reply.h"
#include "tmini/tmini_names.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static tmini_info_t info;
static tmini_health_t health;

/* Words of the rows:
 *
 *     90=0:04:20      the command 90 has a reply of this mode, type and length; 65=: it has none
 *     info:9702…      the content of a reply: information; serial:2025…: its serial number
 *     health:023412 frequency:58020000=600    the same with health; with a frequency
 *     model:151 …     what the content says */

static void expect_header(const char *word)
{
    char *rest;
    const unsigned long command = strtoul(word, &rest, 16);
    const tmini_reply_header_t *const header = tmini_reply_header((tmini_command_code_t)command);
    TEST_ASSERT_EQUAL_MESSAGE(rest[1] != '\0', header != NULL, word);
    if (header != NULL) {
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(strtoul(rest + 1, &rest, 16), header->mode, word);
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(strtoul(rest + 1, &rest, 16), header->type, word);
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(strtoul(rest + 1, NULL, 10), header->length, word);
    }
}

static void expect_serial(const char *digits)
{
    char serial[TMINI_SERIAL_DIGITS + 2];
    serial[TMINI_SERIAL_DIGITS + 1] = 'x';
    tmini_serial_text(&info, serial);
    TEST_ASSERT_EQUAL_STRING(digits, serial);
    TEST_ASSERT_EQUAL_INT('x', serial[TMINI_SERIAL_DIGITS + 1]);
}

static void tell_word(char *word)
{
    char *const wanted = strchr(word, '=');
    uint8_t content[TMINI_INFO_SIZE];
    const row_number_t numbers[] = {
        {"model", info.model},
        {"plus", info.model == TMINI_MODEL_T_MINI_PLUS},
        {"firmware", info.firmware_major},
        {"firmware-minor", info.firmware_minor},
        {"hardware", info.hardware},
        {"faults", health.faults},
        {"code", health.error_code},
    };
    if (row_is(word, "info")) {
        (void)row_bytes(row_text(word), content);
        tmini_reply_info(content, &info);
    } else if (row_is(word, "serial")) {
        expect_serial(row_text(word));
    } else if (row_is(word, "health")) {
        (void)row_bytes(row_text(word), content);
        health = (tmini_health_t){0xEE, 0xEEEE};
        tmini_reply_health(content, &health);
    } else if (row_is(word, "frequency")) {
        *wanted = '\0';
        (void)row_bytes(row_text(word), content);
        TEST_ASSERT_EQUAL_UINT32(strtoul(wanted + 1, NULL, 0), tmini_reply_frequency_chz(content));
    } else if (wanted != NULL) {
        expect_header(word);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* Only the start is answered in continuous mode. */
    ROW(each_command_but_stop_and_reboot_has_its_reply,
        "65= 40= 60=1:81:0 90=0:04:20 92=0:06:3 09=0:04:4 0A=0:04:4 0B=0:04:4 0C=0:04:4 0D=0:04:4"),
    /* Two T-mini Plus (section 9.4) and a T-mini Pro, whose firmware's minor number comes first.
     * The second is composed from the output of the vendor's program (issue 65 of
     * YDLIDAR/YDLidar-SDK). */
    ROW(device_information_of_real_units,
        "info:9702010102000205000402040000000900010904 model:151 plus:1 firmware:1 "
        "firmware-minor:2 "
        "hardware:1 serial:2025042400090194 info:9703010102000204000401030000000900000900 "
        "firmware-minor:3 serial:2024041300090090"),
    ROW(device_information_of_a_t_mini_pro,
        "info:9600010202000202010100030001010101010101 model:150 plus:0 firmware:1 "
        "firmware-minor:0 hardware:2 serial:2022110301111111"),
    ROW(each_byte_of_device_information_has_its_place,
        "info:8081828300000000000000000000000000000000 model:0x80 firmware-minor:0x81 "
        "firmware:0x82 hardware:0x83"),
    ROW(what_is_not_a_digit_reads_as_a_question_mark,
        "info:00000000090A30FF000102030405060708090080 serial:9???01234567890?"),
    ROW(a_healthy_lidar_has_no_faults_and_no_error_code, "health:000000 faults:0 code:0"),
    ROW(the_error_code_is_little_endian, "health:0234F2 faults:2 code:0xF234"),
    ROW(the_six_fault_bits_are_kept_and_the_two_reserved_ones_left_out,
        "health:FF0000 faults:0x3F"),
    ROW(a_frequency_is_in_hundredths_of_a_hertz_and_little_endian,
        "frequency:58020000=600 frequency:8192A3F4=0xF4A39281"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}
