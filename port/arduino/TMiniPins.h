/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The pins that the sketches use. On the ESP32 family a serial port may have any pins, and its
 * default ones may be the flash's or USB's: pass TMINI_SERIAL1 to begin() instead of Serial1. On
 * other boards it is Serial1. For other pins write begin(Serial1, rxPin, txPin). */

#ifndef TMINI_PINS_H
#define TMINI_PINS_H

/** @def TMINI_RX1_PIN
 * To the TX of the lidar on Serial1. */
/** @def TMINI_TX1_PIN
 * To its RX. */
/** @def TMINI_RX2_PIN
 * The same on Serial2, where there is one. */
/** @def TMINI_TX2_PIN
 * The same. */
/** @def TMINI_LED_PINS
 * Pins that are free for LEDs, eight where the chip has them. */
#if defined(ESP32)
#if CONFIG_IDF_TARGET_ESP32
#define TMINI_RX1_PIN 26
#define TMINI_TX1_PIN 27
#define TMINI_RX2_PIN 32
#define TMINI_TX2_PIN 33
#define TMINI_LED_PINS 4, 13, 14, 18, 19, 21, 22, 23
#elif CONFIG_IDF_TARGET_ESP32S2 || CONFIG_IDF_TARGET_ESP32S3
#define TMINI_RX1_PIN 18
#define TMINI_TX1_PIN 17
#define TMINI_RX2_PIN 16
#define TMINI_TX2_PIN 15
#define TMINI_LED_PINS 4, 5, 6, 7, 8, 9, 10, 11
#elif CONFIG_IDF_TARGET_ESP32C6
#define TMINI_RX1_PIN 18
#define TMINI_TX1_PIN 19
#define TMINI_LED_PINS 0, 1, 2, 3, 6, 7, 20, 21
#elif CONFIG_IDF_TARGET_ESP32H2
#define TMINI_RX1_PIN 10
#define TMINI_TX1_PIN 11
#define TMINI_LED_PINS 0, 1, 4, 5, 12, 13, 14, 22
#elif CONFIG_IDF_TARGET_ESP32P4
#define TMINI_RX1_PIN 20
#define TMINI_TX1_PIN 21
#define TMINI_RX2_PIN 22
#define TMINI_TX2_PIN 23
#define TMINI_LED_PINS 2, 3, 4, 5, 26, 27, 32, 33
#elif CONFIG_IDF_TARGET_ESP32C5 || CONFIG_IDF_TARGET_ESP32C61
#define TMINI_RX1_PIN 23
#define TMINI_TX1_PIN 24
#define TMINI_LED_PINS 0, 1, 5, 6
#else /* ESP32-C2, ESP32-C3 */
#define TMINI_RX1_PIN 4
#define TMINI_TX1_PIN 5
#define TMINI_LED_PINS 0, 1, 3, 6, 7, 10
#endif
/** The lidar's port on the pins above. */
#define TMINI_SERIAL1 Serial1, TMINI_RX1_PIN, TMINI_TX1_PIN
/** A second lidar's, on the chips that have a third port. */
#define TMINI_SERIAL2 Serial2, TMINI_RX2_PIN, TMINI_TX2_PIN
#else
#define TMINI_LED_PINS 2, 3, 4, 5, 6, 7, 8, 9
/** The lidar's port. */
#define TMINI_SERIAL1 Serial1
/** A second lidar's, on boards that have it. */
#define TMINI_SERIAL2 Serial2
#endif

#endif
