/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_turn.h"

#include <string.h>

#include "tmini/tmini_reply.h"

/* Which information stands at which index (section 7). */
enum {
    USER_VERSION = 1,
    HEALTH = 3,
    HARDWARE = 4,
    FIRMWARE_MINOR = 5,
    YEAR = 9,
    MONTH = 10,
    DAY = 11,
    NUMBER_HIGH = 12,
    NUMBER_LOW = 13,
};

/* The others are production data. */
#define KNOWN_MASK                                                                                 \
    (TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE | TMINI_KNOWN_FIRMWARE | \
     TMINI_KNOWN_YEAR | TMINI_KNOWN_MONTH | TMINI_KNOWN_DAY | TMINI_KNOWN_SERIAL)

static void trust_current(tmini_turn_t *turn)
{
    const unsigned count = turn->packets < TMINI_TURN_FIELDS ? turn->packets : TMINI_TURN_FIELDS;
    memcpy(turn->trusted, turn->current, count);
    turn->known |= (uint16_t)((1u << count) - 1);
}

static void begin_revolution(tmini_turn_t *turn)
{
    turn->packets = 0;
    turn->crc = 0;
    turn->spoiled = false;
    turn->informative = false;
}

/* Exactly one byte between the last point packet and this start packet is LastCRC. */
static bool ends_trusted_revolution(const tmini_turn_t *turn, const tmini_packet_t *start)
{
    return turn->informative && !turn->spoiled && start->gap == 1 && start->stray == turn->crc;
}

static void append(tmini_turn_t *turn, uint8_t ct)
{
    turn->crc = tmini_turn_crc8(turn->crc, ct);
    if (turn->packets < TMINI_TURN_FIELDS) {
        turn->current[turn->packets] = ct;
    }
    if (turn->packets < UINT8_MAX) {
        turn->packets++;
    }
}

void tmini_turn_init(tmini_turn_t *turn)
{
    *turn = (tmini_turn_t){0};
}

void tmini_turn_discard(tmini_turn_t *turn)
{
    begin_revolution(turn);
}

bool tmini_turn_add(tmini_turn_t *turn, const tmini_packet_t *packet)
{
    bool trusted = false;
    if (tmini_packet_is_start(packet)) {
        trusted = ends_trusted_revolution(turn, packet);
        if (trusted) {
            trust_current(turn);
        }
        begin_revolution(turn);
    } else if (turn->packets == 0) {
        return false; /* Before the first start packet: the index is not known. */
    } else {
        turn->spoiled = turn->spoiled || packet->gap > 0;
        turn->informative = turn->informative || packet->ct != 0;
    }
    append(turn, packet->ct);
    return trusted;
}

/* The serial number's digits 9 to 16 are 21 bits, spread over the last five indices. */
static uint32_t serial_number(const uint8_t *ct)
{
    return (uint32_t)(ct[YEAR] >> 1 & 3u) << 19 | (uint32_t)(ct[MONTH] >> 1 & 7u) << 16 |
           (uint32_t)(ct[DAY] >> 1 & 3u) << 14 | (uint32_t)(ct[NUMBER_HIGH] >> 1) << 7 |
           (uint32_t)(ct[NUMBER_LOW] >> 1);
}

unsigned tmini_turn_faults(const tmini_turn_t *turn)
{
    return (turn->known & TMINI_KNOWN_FAULTS) != 0 ? turn->trusted[HEALTH] >> 1 & TMINI_FAULT_MASK
                                                   : TMINI_FAULTS_UNKNOWN;
}

void tmini_turn_info(const tmini_turn_t *turn, tmini_turn_info_t *info)
{
    const uint8_t *const ct = turn->trusted; /* 0 where it is not known. */
    info->known = turn->known & KNOWN_MASK;
    info->user_major = ct[USER_VERSION] >> 6;
    info->user_minor = ct[USER_VERSION] >> 1 & 0x1Fu;
    info->faults = ct[HEALTH] >> 1 & TMINI_FAULT_MASK;
    info->hardware = ct[HARDWARE] >> 5;
    info->firmware_major = ct[HARDWARE] >> 1 & 0x0Fu;
    info->firmware_minor = ct[FIRMWARE_MINOR] >> 1;
    info->year = (uint16_t)((info->known & TMINI_KNOWN_YEAR) != 0 ? 2020u + (ct[YEAR] >> 3) : 0);
    info->month = ct[MONTH] >> 4;
    info->day = ct[DAY] >> 3;
    info->number = (info->known & TMINI_KNOWN_SERIAL) != 0 ? serial_number(ct) : 0;
}

uint8_t tmini_turn_crc8(uint8_t crc, uint8_t byte)
{
    /* What four steps of the reflected polynomial 0x8C make of the low four bits. */
    static const uint8_t steps[16] = {0x00, 0x9D, 0x23, 0xBE, 0x46, 0xDB, 0x65, 0xF8,
                                      0x8C, 0x11, 0xAF, 0x32, 0xCA, 0x57, 0xE9, 0x74};
    crc ^= byte;
    crc = (uint8_t)(crc >> 4 ^ steps[crc & 0x0Fu]);
    return (uint8_t)(crc >> 4 ^ steps[crc & 0x0Fu]);
}
