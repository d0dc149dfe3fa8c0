/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * CT information: bits 1 to 7 of the CT bytes of one revolution's packets. What they mean depends
 * on the packet's index within the revolution (section 7).
 *
 * Packets do not carry that index, so a lost packet would shift the meaning of every later CT byte.
 * The lidar therefore sends a CRC-8 over a revolution's CT bytes, LastCRC, just before the next
 * start packet. A revolution's information is used only if LastCRC is present and right and nothing
 * was lost; otherwise all of it is dropped. Units that send neither LastCRC nor CT information
 * (section 9.1) never become "healthy, version 0.0": their information stays unknown.
 *
 * All functions: one context, the one that parses; no waiting.
 *
 * If TMINI_NO_CT is defined for the whole build, the code for CT information is left out, and none
 * is ever known. */

#ifndef TMINI_CT_H
#define TMINI_CT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "tmini_packet.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Indices with a documented meaning: 0 to 13. */
#define TMINI_CT_INDICES 14u
/** How many of these are kept. */
#define TMINI_CT_FIELDS 9u

/** What tmini_ct_faults() returns when nothing is known; no combination of tmini_fault_t. */
#define TMINI_FAULTS_UNKNOWN 0x100u

/** What has been learned from a unit's CT bytes. Treat the members as private. */
typedef struct {
    uint8_t packets; /**< Packets of the current revolution, at most 14; 0 if its beginning or a
                      * later packet is missing. */
    uint8_t fields;  /**< How many fields of the current revolution have come. */
    uint8_t crc;     /**< The CRC of that revolution's CT bytes so far. */
    uint8_t cts;     /**< The OR of its point packets' CT bytes; 0: they carry no information. */
    uint16_t known;  /**< What the trusted fields hold, a combination of tmini_known_t. */
    uint8_t current[TMINI_CT_FIELDS]; /**< The fields of the current revolution that have come. */
    uint8_t trusted[TMINI_CT_FIELDS]; /**< The newest trusted CT byte of each field; 0: none. */
} tmini_ct_t;

/** What a start packet shows about the revolution that it ends. */
typedef enum {
    TMINI_CT_UNKNOWN,   /**< Nothing: there is no LastCRC, or no CT information. */
    TMINI_CT_CONFIRMED, /**< LastCRC is right: no packet was lost. */
    TMINI_CT_REFUTED,   /**< LastCRC is wrong: a packet was lost, or LastCRC itself is damaged. */
} tmini_ct_verdict_t;

/** Forgets everything. Call it for a new `ct`, and when the unit may have been exchanged. */
static inline void tmini_ct_init(tmini_ct_t *ct)
{
    memset(ct, 0, sizeof *ct);
}

#if !defined(TMINI_NO_CT)

/** Forgets the current revolution, because it was interrupted. Trusted information is kept. */
void tmini_ct_discard(tmini_ct_t *ct);

/** Takes the next packet. `is_whole`: none has been lost since the last start packet, which may be
 * this one; a tmini_decoder_t knows. Returns what the packet shows about the revolution that it
 * ends, or TMINI_CT_UNKNOWN if it ends none. After TMINI_CT_CONFIRMED, tmini_ct_read() includes
 * that revolution. A few instructions. */
tmini_ct_verdict_t tmini_ct_add(tmini_ct_t *ct, const tmini_packet_t *packet, bool is_whole);

/** The faults that the last trusted revolution reported, a combination of tmini_fault_t, or
 * TMINI_FAULTS_UNKNOWN if none has. */
unsigned tmini_ct_faults(const tmini_ct_t *ct);

/** Writes the information of trusted revolutions to `info`. Each field keeps its value until a
 * newer one is trusted. */
void tmini_ct_read(const tmini_ct_t *ct, tmini_ct_info_t *info);

#else /* Left out. Many units send none (section 9.1); the driver still finds its own faults. */

static inline void tmini_ct_discard(tmini_ct_t *ct)
{
    (void)ct;
}

static inline tmini_ct_verdict_t tmini_ct_add(tmini_ct_t *ct, const tmini_packet_t *packet,
                                              bool is_whole)
{
    (void)ct;
    (void)packet;
    (void)is_whole;
    return TMINI_CT_UNKNOWN;
}

static inline unsigned tmini_ct_faults(const tmini_ct_t *ct)
{
    (void)ct;
    return TMINI_FAULTS_UNKNOWN;
}

static inline void tmini_ct_read(const tmini_ct_t *ct, tmini_ct_info_t *info)
{
    (void)ct;
    memset(info, 0, sizeof *info);
}

#endif

/** The CRC-8 of the CT bytes (CRC-8/MAXIM: reflected polynomial 0x8C, initial value 0; section 7).
 * Returns `crc`, continued by `byte`. Any context. */
uint8_t tmini_ct_crc8(uint8_t crc, uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif
