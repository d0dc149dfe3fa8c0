/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * CT information: what the packets of one revolution say in bits 1 to 7 of their CT bytes, each by
 * its index within the revolution (section 7).
 *
 * Packets do not carry that index, so a lost one would shift the meaning of every later CT. The
 * lidar therefore sends a CRC-8 over a revolution's CT bytes, LastCRC, just before the next start
 * packet. A revolution is trusted only if LastCRC is there, equals, and nothing was lost; else it
 * is dropped whole. Units that send neither LastCRC nor CT information (section 9.1) never become
 * "healthy, version 0.0": their information stays unknown.
 *
 * All functions: one context, the one that parses; no waiting. */

#ifndef TMINI_CT_H
#define TMINI_CT_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini_packet.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Indices with a documented meaning: 0 to 13. */
#define TMINI_CT_INDICES 14u
/** The fields among them that are kept. */
#define TMINI_CT_FIELDS 9u

/** What tmini_ct_faults() returns when nothing is known; no combination of tmini_fault_t. */
#define TMINI_FAULTS_UNKNOWN 0x100u

/** What has been learned from a unit's CT bytes. Treat the members as private. */
typedef struct {
    uint16_t known;  /**< A bit for each index whose trusted CT is valid; all others are 0. */
    uint16_t gaps;   /**< Of the revolution under way, joined by OR: 0 if nothing was lost. */
    uint8_t packets; /**< Of that revolution, at most 14; 0 before the first. */
    uint8_t fields;  /**< Of its fields, so many have come. */
    uint8_t crc;     /**< Of its CT bytes so far. */
    uint8_t cts;     /**< Those of its point packets, joined by OR: 0 if they say nothing. */
    uint8_t current[TMINI_CT_FIELDS]; /**< CTs of the revolution under way. */
    uint8_t trusted[TMINI_CT_FIELDS]; /**< The newest trusted CT of each field. */
} tmini_ct_t;

/** What a start packet tells of the revolution that it ends. */
typedef enum {
    TMINI_CT_UNKNOWN,   /**< Nothing: no LastCRC, or no CT information. */
    TMINI_CT_CONFIRMED, /**< LastCRC is right: no packet was lost. */
    TMINI_CT_REFUTED,   /**< LastCRC is wrong: a packet was lost, if not LastCRC itself damaged. */
} tmini_ct_verdict_t;

/** Which fields of tmini_ct_info_t are valid: a bit for the index that completes each. Fast scans
 * have fewer than 14 packets, so that the later ones may never arrive (section 9.7). */
typedef enum {
    TMINI_KNOWN_USER_VERSION = 1 << 1, /**< Both of the protocol version's numbers. */
    TMINI_KNOWN_FAULTS = 1 << 3,   /**< Not 4, as one sentence of the manual says (section 9.3). */
    TMINI_KNOWN_HARDWARE = 1 << 4, /**< And the firmware's major number. */
    TMINI_KNOWN_FIRMWARE = 1 << 5, /**< Both of the firmware's numbers. */
    TMINI_KNOWN_YEAR = 1 << 9,     /**< The serial number's year. */
    TMINI_KNOWN_MONTH = 1 << 10,   /**< The serial number's month. */
    TMINI_KNOWN_DAY = 1 << 11,     /**< The serial number's day. */
    TMINI_KNOWN_SERIAL = 1 << 13,  /**< The whole serial number: date and number. */
} tmini_known_t;

/** What the unit has told of itself while scanning. Fields that are not known are 0. */
typedef struct {
    uint16_t known;         /**< A combination of tmini_known_t. */
    uint8_t user_major;     /**< Protocol version, currently 1.0. */
    uint8_t user_minor;     /**< Its second number. */
    uint8_t faults;         /**< A combination of tmini_fault_t; 0: healthy. */
    uint8_t hardware;       /**< Hardware version, 0 to 7. */
    uint8_t firmware_major; /**< 0 to 15. */
    uint8_t firmware_minor; /**< 0 to 127. */
    uint8_t month;          /**< The serial number's month, 0 to 15 as sent. */
    uint8_t day;            /**< The serial number's day, 0 to 31 as sent. */
    uint16_t year;          /**< The serial number's year, 2020 to 2051. */
    uint32_t number;        /**< The serial number's last eight digits, 0 to 2097151. */
} tmini_ct_info_t;

/** Forgets everything. For a new `ct`, and after a unit may have been exchanged. */
void tmini_ct_init(tmini_ct_t *ct);

/** Forgets the revolution under way, which was interrupted; keeps what is known. */
void tmini_ct_discard(tmini_ct_t *ct);

/** Takes the next packet, and returns what it tells of the revolution that it ends;
 * TMINI_CT_UNKNOWN if it ends none. When confirmed, what tmini_ct_read() says is as of now. A few
 * instructions. */
tmini_ct_verdict_t tmini_ct_add(tmini_ct_t *ct, const tmini_packet_t *packet);

/** The faults that the last trusted revolution told, a combination of tmini_fault_t, or
 * TMINI_FAULTS_UNKNOWN if none has. */
unsigned tmini_ct_faults(const tmini_ct_t *ct);

/** Writes what is known from trusted revolutions to `info`; each field keeps its value until a
 * newer one is trusted. */
void tmini_ct_read(const tmini_ct_t *ct, tmini_ct_info_t *info);

/** The guard's CRC-8 (CRC-8/MAXIM: reflected polynomial 0x8C, initial value 0; section 7), `crc` so
 * far and then `byte`. Any context. */
uint8_t tmini_ct_crc8(uint8_t crc, uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif
