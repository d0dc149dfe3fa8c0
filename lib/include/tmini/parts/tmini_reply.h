/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Commands, their replies, and the content of the replies (sections 3 and 4).
 * Pure functions, any context; they read `content`, keep nothing and never wait. */

#ifndef TMINI_REPLY_H
#define TMINI_REPLY_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini_parser.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A command is two bytes: this one and the code. */
#define TMINI_COMMAND_SYNC 0xA5u

/** The codes of the commands (section 3). */
typedef enum {
    TMINI_COMMAND_FASTER_TENTH = 0x09,  /**< Scan frequency + 0.1 Hz. */
    TMINI_COMMAND_SLOWER_TENTH = 0x0A,  /**< Scan frequency - 0.1 Hz. */
    TMINI_COMMAND_FASTER_ONE = 0x0B,    /**< Scan frequency + 1 Hz. */
    TMINI_COMMAND_SLOWER_ONE = 0x0C,    /**< Scan frequency - 1 Hz. */
    TMINI_COMMAND_GET_FREQUENCY = 0x0D, /**< The scan frequency that is set. */
    TMINI_COMMAND_REBOOT = 0x40,        /**< Soft reboot; no reply. */
    TMINI_COMMAND_START = 0x60,         /**< Start scanning. */
    TMINI_COMMAND_STOP = 0x65,          /**< Stop scanning; no reply. */
    TMINI_COMMAND_GET_INFO = 0x90,      /**< Device information. */
    TMINI_COMMAND_GET_HEALTH = 0x92,    /**< Health status. */
} tmini_command_code_t;

/** Bytes of a device information reply's content (section 4). */
#define TMINI_INFO_SIZE 20u
/** Bytes of a health reply's content (section 4). */
#define TMINI_HEALTH_SIZE 3u
/** Bytes of a scan frequency reply's content (section 4). */
#define TMINI_FREQUENCY_SIZE 4u
/** Returns how the reply to `command` begins, or null for the commands that have no reply: stop and
 * reboot. */
const tmini_reply_header_t *tmini_reply_header(tmini_command_code_t command);

/** Reads the device information from a reply's 20 bytes. The firmware's minor number comes first:
 * real units send it so, although the manual says otherwise (section 9.4). */
void tmini_reply_info(const uint8_t content[TMINI_INFO_SIZE], tmini_info_t *info);

/** Reads the health status from a reply's 3 bytes. The two reserved bits are ignored. */
void tmini_reply_health(const uint8_t content[TMINI_HEALTH_SIZE], tmini_health_t *health);

/** The scan frequency that is set, in 0.01 Hz, from a reply's 4 bytes. */
static inline uint32_t tmini_reply_frequency_chz(const uint8_t content[TMINI_FREQUENCY_SIZE])
{
    return content[0] | (uint32_t)content[1] << 8 | (uint32_t)content[2] << 16 |
           (uint32_t)content[3] << 24;
}

#ifdef __cplusplus
}
#endif

#endif
