/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Replies: their format for each command, and the meaning of their content (sections 3, 4 and
 * 9). */

#include "tmini/tmini_names.h"
#include "tmini/parts/tmini_reply.h"

#include "unity.h"

#include <string.h>

void setUp(void) {}

void tearDown(void) {}

/* Only the start is answered in continuous mode; stop and reboot are not answered. */
void test_each_command_has_its_reply(void)
{
    static const struct {
        tmini_command_code_t command;
        bool is_answered;
        tmini_reply_header_t header;
    } replies[] = {
        {TMINI_COMMAND_STOP, false, {0}},
        {TMINI_COMMAND_REBOOT, false, {0}},
        {TMINI_COMMAND_START, true, {.mode = 1, .type = 0x81, .length = 0}},
        {TMINI_COMMAND_GET_INFO, true, {.mode = 0, .type = 0x04, .length = 20}},
        {TMINI_COMMAND_GET_HEALTH, true, {.mode = 0, .type = 0x06, .length = 3}},
        {TMINI_COMMAND_FASTER_TENTH, true, {.mode = 0, .type = 0x04, .length = 4}},
        {TMINI_COMMAND_SLOWER_TENTH, true, {.mode = 0, .type = 0x04, .length = 4}},
        {TMINI_COMMAND_FASTER_ONE, true, {.mode = 0, .type = 0x04, .length = 4}},
        {TMINI_COMMAND_SLOWER_ONE, true, {.mode = 0, .type = 0x04, .length = 4}},
        {TMINI_COMMAND_GET_FREQUENCY, true, {.mode = 0, .type = 0x04, .length = 4}},
    };
    for (size_t i = 0; i < sizeof replies / sizeof replies[0]; i++) {
        const tmini_reply_header_t *const header = tmini_reply_header(replies[i].command);
        TEST_ASSERT_EQUAL_MESSAGE(replies[i].is_answered, header != NULL, "is answered");
        if (header != NULL) {
            TEST_ASSERT_EQUAL_HEX8(replies[i].header.mode, header->mode);
            TEST_ASSERT_EQUAL_HEX8(replies[i].header.type, header->type);
            TEST_ASSERT_EQUAL_UINT8(replies[i].header.length, header->length);
        }
    }
}

/* Two T-mini Plus (section 9.4) and a T-mini Pro, whose firmware's minor number comes first. The
 * second is composed from the output of the vendor's program (issue 65 of YDLIDAR/YDLidar-SDK). */
static const struct {
    uint8_t content[20];
    tmini_info_t info; /* Without the serial number. */
    const char *serial;
} units[] = {
    {{0x97, 2, 1, 1, 2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4},
     {.model = 151, .firmware_major = 1, .firmware_minor = 2, .hardware = 1},
     "2025042400090194"},
    {{0x97, 3, 1, 1, 2, 0, 2, 4, 0, 4, 1, 3, 0, 0, 0, 9, 0, 0, 9, 0},
     {.model = 151, .firmware_major = 1, .firmware_minor = 3, .hardware = 1},
     "2024041300090090"},
    {{0x96, 0, 1, 2, 2, 0, 2, 2, 1, 1, 0, 3, 0, 1, 1, 1, 1, 1, 1, 1},
     {.model = 150, .firmware_major = 1, .firmware_minor = 0, .hardware = 2},
     "2022110301111111"},
};

void test_device_information_of_real_units(void)
{
    for (unsigned i = 0; i < sizeof units / sizeof units[0]; i++) {
        tmini_info_t info;
        char serial[TMINI_SERIAL_DIGITS + 2];
        memset(serial, 'x', sizeof serial);
        tmini_reply_info(units[i].content, &info);
        tmini_serial_text(&info, serial);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.model, info.model);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.firmware_major, info.firmware_major);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.firmware_minor, info.firmware_minor);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.hardware, info.hardware);
        TEST_ASSERT_EQUAL_STRING(units[i].serial, serial);
        TEST_ASSERT_EQUAL_INT('x', serial[TMINI_SERIAL_DIGITS + 1]);
    }
    TEST_ASSERT_EQUAL_UINT8(151, TMINI_MODEL_T_MINI_PLUS);
}

void test_each_byte_of_device_information_has_its_place(void)
{
    uint8_t content[20];
    tmini_info_t info;
    for (uint8_t i = 0; i < 20; i++) {
        content[i] = (uint8_t)(0x80 + i);
    }
    tmini_reply_info(content, &info);
    TEST_ASSERT_EQUAL_HEX8(0x80, info.model);
    TEST_ASSERT_EQUAL_HEX8(0x81, info.firmware_minor);
    TEST_ASSERT_EQUAL_HEX8(0x82, info.firmware_major);
    TEST_ASSERT_EQUAL_HEX8(0x83, info.hardware);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&content[4], info.serial, 16);
}

void test_what_is_not_a_digit_reads_as_a_question_mark(void)
{
    const tmini_info_t info = {.serial = {9, 10, '0', 255, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 128}};
    char text[17];
    tmini_serial_text(&info, text);
    TEST_ASSERT_EQUAL_STRING("9???01234567890?", text);
}

void test_a_healthy_lidar_has_no_faults_and_no_error_code(void)
{
    const uint8_t content[3] = {0, 0, 0};
    tmini_health_t health = {0xEE, 0xEEEE};
    tmini_reply_health(content, &health);
    TEST_ASSERT_EQUAL_HEX8(0, health.faults);
    TEST_ASSERT_EQUAL_HEX16(0, health.error_code);
}

void test_the_error_code_is_little_endian(void)
{
    const uint8_t content[3] = {0x02, 0x34, 0xF2};
    tmini_health_t health;
    tmini_reply_health(content, &health);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, health.faults);
    TEST_ASSERT_EQUAL_HEX16(0xF234, health.error_code);
}

void test_the_six_fault_bits_are_kept_and_the_two_reserved_ones_left_out(void)
{
    const uint8_t content[3] = {0xFF, 0, 0};
    tmini_health_t health;
    tmini_reply_health(content, &health);
    TEST_ASSERT_EQUAL_HEX8(0x3F, health.faults);
}

void test_a_frequency_is_in_hundredths_of_a_hertz_and_little_endian(void)
{
    const uint8_t six_hertz[4] = {0x58, 0x02, 0, 0};
    const uint8_t large[4] = {0x81, 0x92, 0xA3, 0xF4};
    TEST_ASSERT_EQUAL_UINT32(600, tmini_reply_frequency_chz(six_hertz));
    TEST_ASSERT_EQUAL_HEX32(0xF4A39281, tmini_reply_frequency_chz(large));
}
