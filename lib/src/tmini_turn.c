/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_turn.h"

#include <string.h>

#include "tmini/tmini_reply.h"

/* Which information stands at which index (section 7). Health is at 3, not at 4 as one sentence of
 * the manual says (section 9.3). */
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

static void trust_current(tmini_turn_t *turn)
{
    const unsigned count =
        turn->packets < TMINI_TURN_FIELDS ? turn->packets : TMINI_TURN_FIELDS;
    memcpy(turn->trusted, turn->current, count);
    turn->known |= (uint16_t)((1ul << count) - 1);
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
    if (turn->packets < UINT16_MAX) {
        turn->packets++;
    }
}

void tmini_turn_init(tmini_turn_t *turn)
{
    *turn = (tmini_turn_t){ 0 };
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

static bool known(const tmini_turn_t *turn, unsigned index)
{
    return (turn->known >> index & 1u) != 0;
}

/* The serial number's digits 9 to 16 are 21 bits, spread over the last five indices. */
static uint32_t serial_number(const uint8_t *ct)
{
    return (uint32_t)(ct[YEAR] >> 1 & 3u) << 19 | (uint32_t)(ct[MONTH] >> 1 & 7u) << 16 |
           (uint32_t)(ct[DAY] >> 1 & 3u) << 14 | (uint32_t)(ct[NUMBER_HIGH] >> 1) << 7 |
           (uint32_t)(ct[NUMBER_LOW] >> 1);
}

static void read_versions(const tmini_turn_t *turn, tmini_turn_info_t *info)
{
    const uint8_t *const ct = turn->trusted;
    if (known(turn, USER_VERSION)) {
        info->known |= TMINI_KNOWN_USER_VERSION;
        info->user_major = ct[USER_VERSION] >> 6;
        info->user_minor = ct[USER_VERSION] >> 1 & 0x1Fu;
    }
    if (known(turn, HEALTH)) {
        info->known |= TMINI_KNOWN_FAULTS;
        info->faults = ct[HEALTH] >> 1 & TMINI_FAULT_MASK;
    }
    if (known(turn, HARDWARE)) {
        info->known |= TMINI_KNOWN_HARDWARE;
        info->hardware = ct[HARDWARE] >> 5;
        info->firmware_major = ct[HARDWARE] >> 1 & 0x0Fu;
    }
    if (known(turn, FIRMWARE_MINOR)) {
        info->known |= TMINI_KNOWN_FIRMWARE;
        info->firmware_minor = ct[FIRMWARE_MINOR] >> 1;
    }
}

static void read_serial(const tmini_turn_t *turn, tmini_turn_info_t *info)
{
    const uint8_t *const ct = turn->trusted;
    if (known(turn, YEAR)) {
        info->known |= TMINI_KNOWN_YEAR;
        info->year = (uint16_t)(2020u + (ct[YEAR] >> 3));
    }
    if (known(turn, MONTH)) {
        info->known |= TMINI_KNOWN_MONTH;
        info->month = ct[MONTH] >> 4;
    }
    if (known(turn, DAY)) {
        info->known |= TMINI_KNOWN_DAY;
        info->day = ct[DAY] >> 3;
    }
    if (known(turn, NUMBER_LOW)) {
        info->known |= TMINI_KNOWN_SERIAL;
        info->number = serial_number(ct);
    }
}

void tmini_turn_info(const tmini_turn_t *turn, tmini_turn_info_t *info)
{
    *info = (tmini_turn_info_t){ 0 };
    read_versions(turn, info);
    read_serial(turn, info);
}

uint8_t tmini_turn_crc8(uint8_t crc, uint8_t byte)
{
    crc ^= byte;
    for (unsigned bit = 0; bit < 8; bit++) {
        crc = (uint8_t)((crc & 1u) != 0 ? crc >> 1 ^ 0x8C : crc >> 1);
    }
    return crc;
}
