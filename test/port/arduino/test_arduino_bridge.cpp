/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged sketch Bridge. */

#include <Arduino.h>

#include "Bridge/Bridge.ino"

#include "cpp_tests.h"

#include "virtual_lidar.h"

void setUp(void)
{
    setup();
}

void tearDown(void) {}

TEST(it_forwards_every_byte_in_both_directions)
{
    for (unsigned i = 0; i < 256; i++) {
        Serial1.take(static_cast<uint8_t>(i));
        Serial.take(static_cast<uint8_t>(255 - i));
        loop();
    }
    TEST_ASSERT_EQUAL_UINT(256, Serial.sent.size());
    TEST_ASSERT_EQUAL_UINT(256, Serial1.sent.size());
    for (unsigned i = 0; i < 256; i++) {
        TEST_ASSERT_EQUAL_HEX8(i, Serial.sent[i]);
        TEST_ASSERT_EQUAL_HEX8(255 - i, Serial1.sent[i]);
    }
}

TEST(both_ports_have_the_lidars_baud_rate)
{
    TEST_ASSERT_EQUAL_UINT(230400, Serial.baud_rate);
    TEST_ASSERT_EQUAL_UINT(230400, Serial1.baud_rate);
}
