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

void test_command_codes_are_those_of_section_3(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xA5, TMINI_COMMAND_SYNC);
    TEST_ASSERT_EQUAL_HEX8(0x60, TMINI_COMMAND_START);
    TEST_ASSERT_EQUAL_HEX8(0x65, TMINI_COMMAND_STOP);
    TEST_ASSERT_EQUAL_HEX8(0x90, TMINI_COMMAND_GET_INFO);
    TEST_ASSERT_EQUAL_HEX8(0x92, TMINI_COMMAND_GET_HEALTH);
    TEST_ASSERT_EQUAL_HEX8(0x09, TMINI_COMMAND_FASTER_TENTH);
    TEST_ASSERT_EQUAL_HEX8(0x0A, TMINI_COMMAND_SLOWER_TENTH);
    TEST_ASSERT_EQUAL_HEX8(0x0B, TMINI_COMMAND_FASTER_ONE);
    TEST_ASSERT_EQUAL_HEX8(0x0C, TMINI_COMMAND_SLOWER_ONE);
    TEST_ASSERT_EQUAL_HEX8(0x0D, TMINI_COMMAND_GET_FREQUENCY);
    TEST_ASSERT_EQUAL_HEX8(0x40, TMINI_COMMAND_REBOOT);
}

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
        tmini_reply_header_t header = {.type = 0xEE, .mode = 0xEE, .length = 0xEE};
        const bool is_answered = tmini_reply_header(replies[i].command, &header);
        TEST_ASSERT_EQUAL_MESSAGE(replies[i].is_answered, is_answered, "is answered");
        if (is_answered) {
            TEST_ASSERT_EQUAL_HEX8(replies[i].header.mode, header.mode);
            TEST_ASSERT_EQUAL_HEX8(replies[i].header.type, header.type);
            TEST_ASSERT_EQUAL_UINT8(replies[i].header.length, header.length);
        }
    }
}

/* From a real T-mini Plus: 97 02 01 01 is model 151, firmware 1.2, hardware 1 (section 9.4). */
static const uint8_t real_info[20] = {0x97, 2, 1, 1, 2, 0, 2, 5, 0, 4,
                                      2,    4, 0, 0, 0, 9, 0, 1, 9, 4};

void test_device_information_has_the_firmwares_minor_number_first(void)
{
    tmini_info_t info;
    tmini_reply_info(real_info, &info);
    TEST_ASSERT_EQUAL_UINT8(TMINI_MODEL_T_MINI_PLUS, info.model);
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    TEST_ASSERT_EQUAL_UINT8(1, info.firmware_major);
    TEST_ASSERT_EQUAL_UINT8(2, info.firmware_minor);
    TEST_ASSERT_EQUAL_UINT8(1, info.hardware);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&real_info[4], info.serial, 16);
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

void test_the_serial_number_of_a_real_unit_reads_as_16_characters(void)
{
    tmini_info_t info;
    char text[18];
    memset(text, 'x', sizeof text);
    tmini_reply_info(real_info, &info);
    tmini_serial_text(&info, text);
    TEST_ASSERT_EQUAL_STRING("2025042400090194", text);
    TEST_ASSERT_EQUAL_INT('x', text[17]);
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
    TEST_ASSERT_EQUAL_HEX8(0x01, TMINI_FAULT_SENSOR);
    TEST_ASSERT_EQUAL_HEX8(0x02, TMINI_FAULT_ENCODER);
    TEST_ASSERT_EQUAL_HEX8(0x04, TMINI_FAULT_WIRELESS_POWER);
    TEST_ASSERT_EQUAL_HEX8(0x08, TMINI_FAULT_PD);
    TEST_ASSERT_EQUAL_HEX8(0x10, TMINI_FAULT_LD);
    TEST_ASSERT_EQUAL_HEX8(0x20, TMINI_FAULT_DATA);
}

void test_a_frequency_is_in_hundredths_of_a_hertz_and_little_endian(void)
{
    const uint8_t six_hertz[4] = {0x58, 0x02, 0, 0};
    const uint8_t large[4] = {0x81, 0x92, 0xA3, 0xF4};
    TEST_ASSERT_EQUAL_UINT32(600, tmini_reply_frequency_chz(six_hertz));
    TEST_ASSERT_EQUAL_HEX32(0xF4A39281, tmini_reply_frequency_chz(large));
}
