/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_ct.h"

#include "tmini/parts/tmini_reply.h"

#if !defined(TMINI_NO_CT)

/* The fields that are kept, in the order of their indices. */
enum {
    USER_VERSION,
    HEALTH,
    HARDWARE,
    FIRMWARE_MINOR,
    YEAR,
    MONTH,
    DAY,
    NUMBER_HIGH,
    NUMBER_LOW,
};

/* One bit for each field's index (section 7). The other indices are production data. */
#define KEPT_MASK \
    (1u << 1 | 1u << 3 | 1u << 4 | 1u << 5 | 1u << 9 | 1u << 10 | 1u << 11 | 1u << 12 | 1u << 13)

#define KNOWN_MASK                                                                                 \
    (TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE | TMINI_KNOWN_FIRMWARE | \
     TMINI_KNOWN_YEAR | TMINI_KNOWN_MONTH | TMINI_KNOWN_DAY | TMINI_KNOWN_SERIAL)

/* Fields that have not come keep their values. */
static void trust_current(tmini_ct_t *ct)
{
    while (ct->fields > 0) {
        ct->fields--;
        ct->trusted[ct->fields] = ct->current[ct->fields];
    }
    ct->known |= ((1u << ct->packets) - 1) & KNOWN_MASK;
}

/* If there is exactly one byte between the last point packet and this start packet, it is LastCRC.
 * From units without CT information it is noise, because they send no LastCRC. */
static tmini_ct_verdict_t check_revolution(const tmini_ct_t *ct, const tmini_packet_t *start)
{
    if (ct->cts == 0 || start->gap != 1) {
        return TMINI_CT_UNKNOWN;
    }
    return start->frame->last_skipped == ct->crc ? TMINI_CT_CONFIRMED : TMINI_CT_REFUTED;
}

static void append_byte(tmini_ct_t *ct, uint8_t byte)
{
    ct->crc = tmini_ct_crc8(ct->crc, byte);
    if (ct->packets == TMINI_CT_INDICES) {
        return;
    }
    if ((KEPT_MASK >> ct->packets & 1u) != 0) {
        ct->current[ct->fields++] = byte;
    }
    ct->packets++;
}

void tmini_ct_discard(tmini_ct_t *ct)
{
    ct->packets = 0;
    ct->fields = 0;
    ct->crc = 0;
    ct->cts = 0;
}

tmini_ct_verdict_t tmini_ct_add(tmini_ct_t *ct, const tmini_packet_t *packet, bool is_whole)
{
    tmini_ct_verdict_t verdict = TMINI_CT_UNKNOWN;
    if (tmini_packet_is_start(packet)) {
        verdict = check_revolution(ct, packet);
        if (verdict == TMINI_CT_CONFIRMED) {
            trust_current(ct);
        }
        tmini_ct_discard(ct);
    } else if (!is_whole) {
        tmini_ct_discard(ct); /* Until the next start packet the index is not known. */
        return TMINI_CT_UNKNOWN;
    } else {
        ct->cts |= packet->ct;
    }
    append_byte(ct, packet->ct);
    return verdict;
}

/* The serial number's digits 9 to 16 are 21 bits, spread over the last five indices. */
static uint32_t serial_number(const uint8_t *ct)
{
    return (uint32_t)(ct[YEAR] >> 1 & 3u) << 19 | (uint32_t)(ct[MONTH] >> 1 & 7u) << 16 |
           (uint32_t)(ct[DAY] >> 1 & 3u) << 14 | (uint32_t)(ct[NUMBER_HIGH] >> 1) << 7 |
           (uint32_t)(ct[NUMBER_LOW] >> 1);
}

unsigned tmini_ct_faults(const tmini_ct_t *ct)
{
    return (ct->known & TMINI_KNOWN_FAULTS) != 0 ? ct->trusted[HEALTH] >> 1 & TMINI_FAULT_MASK
                                                 : TMINI_FAULTS_UNKNOWN;
}

void tmini_ct_read(const tmini_ct_t *ct, tmini_ct_info_t *info)
{
    const uint8_t *const trusted = ct->trusted; /* 0 where a field is not known. */
    const unsigned user_version = trusted[USER_VERSION];
    const unsigned hardware = trusted[HARDWARE];
    info->known = ct->known;
    info->user_major = (uint8_t)(user_version >> 6);
    info->user_minor = user_version >> 1 & 0x1Fu;
    info->faults = trusted[HEALTH] >> 1 & TMINI_FAULT_MASK;
    info->hardware = (uint8_t)(hardware >> 5);
    info->firmware_major = hardware >> 1 & 0x0Fu;
    info->firmware_minor = trusted[FIRMWARE_MINOR] >> 1;
    info->year =
        (uint16_t)((info->known & TMINI_KNOWN_YEAR) != 0 ? 2020u + (trusted[YEAR] >> 3) : 0);
    info->month = trusted[MONTH] >> 4;
    info->day = trusted[DAY] >> 3;
    info->number = (info->known & TMINI_KNOWN_SERIAL) != 0 ? serial_number(trusted) : 0;
}

#endif

uint8_t tmini_ct_crc8(uint8_t crc, uint8_t byte)
{
    /* All eight steps at once: divides by the polynomial and returns the remainder. */
    const unsigned sum = crc ^ (unsigned)byte;
    const unsigned quotient = (sum ^ sum << 3 ^ sum << 4 ^ sum << 6) & 0xFFu;
    return (uint8_t)(quotient ^ quotient >> 4 ^ quotient >> 5);
}
