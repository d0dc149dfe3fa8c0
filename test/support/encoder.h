/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * Encodes everything that the lidar can send: packets, replies, turn information (CT) and its
 * CRC-8. Written from docs/protocol.md alone, without code of lib/, so that one misreading of the
 * protocol cannot hide in both. Pure functions; the caller owns all memory.
 */

#ifndef ENCODER_H
#define ENCODER_H

#include <stddef.h>
#include <stdint.h>

/* Sizes of section 4 and section 5. */
#define ENCODE_PACKET_HEADER 10u
#define ENCODE_SAMPLE_SIZE 3u
#define ENCODE_PACKET_MAX 775u /* LSN is one byte: 10 + 3 * 255 */
#define ENCODE_OTHER_MAX 1030u /* the same with four-byte samples */
#define ENCODE_REPLY_HEADER 7u
#define ENCODE_REPLY_MAX 27u       /* device information: 7 + 20 */
#define ENCODE_FULL_TURN_Q6 23040u /* 360 degrees in 1/64 degree */

/* Reply modes and type codes of section 4. */
#define ENCODE_MODE_SINGLE 0u
#define ENCODE_MODE_CONTINUOUS 1u
#define ENCODE_TYPE_INFORMATION 0x04u /* also of frequency replies */
#define ENCODE_TYPE_HEALTH 0x06u
#define ENCODE_TYPE_SCAN 0x81u

typedef struct {
    uint16_t distance_mm; /* 0..16383 */
    uint8_t intensity;
    uint8_t flag; /* 0..3 */
} encode_sample_t;

typedef struct {
    uint8_t ct;        /* the whole byte; bit 0 set in a start packet */
    uint8_t lsn;       /* number of samples */
    uint16_t first_q6; /* angle of the first sample, 1/64 degree, 0..32767 */
    uint16_t last_q6;  /* angle of the last sample */
    const encode_sample_t *samples;
} encode_packet_t;

typedef struct {
    uint8_t model;
    uint8_t firmware_major;
    uint8_t firmware_minor;
    uint8_t hardware;
    uint8_t serial[16]; /* digits as numbers 0..9, the most significant first (section 9.5) */
} encode_information_t;

/* The content of the CT bytes of one revolution (section 7). */
typedef struct {
    uint16_t frequency_dhz; /* 0.1 Hz */
    uint8_t user_major;     /* 0..3 */
    uint8_t user_minor;     /* 0..31 */
    uint8_t health;         /* bits of section 4 */
    uint8_t hardware;       /* 0..7 */
    uint8_t firmware_major; /* 0..15 */
    uint8_t firmware_minor; /* 0..127 */
    uint16_t year;          /* 2020..2051 */
    uint8_t month;          /* 1..12 */
    uint8_t day;            /* 1..31 */
    uint32_t serial;        /* 0..2097151 */
    uint8_t production;     /* makes the values of all other indices, which are undisclosed */
} encode_turn_t;

/* Little-endian words (section 1). */
void encode_u16(uint8_t *out, uint16_t value);
void encode_u32(uint8_t *out, uint32_t value);

/* An angle as FSA and LSA hold it: bit 0 is the check bit, always 1. */
uint16_t encode_angle(uint16_t angle_q6);

/* Writes the three bytes of a sample. */
void encode_sample(uint8_t *out, encode_sample_t sample);

/* The ten bytes before the samples, with a checksum of 0. */
void encode_packet_header(uint8_t *out, const encode_packet_t *packet);

/* The checksum that the packet's bytes should have; reads LSN from the packet itself. */
uint16_t encode_checksum(const uint8_t *packet);

/* Sets the packet's checksum to the one that its bytes should have. */
void encode_seal(uint8_t *packet);

/* A complete valid packet; returns its length. `out` has room for 10 + 3 * lsn bytes. */
size_t encode_packet(uint8_t *out, const encode_packet_t *packet);

/* The same with samples of 2 or 4 bytes, as other units send them (sections 9.18, 9.19): the
 * distance with its flag alone, or 16 bits of intensity and 16 bits of distance. The checksum is
 * the XOR of all 16-bit words. `out` has room for 10 + sample_size * lsn bytes. */
size_t encode_other_packet(uint8_t *out, const encode_packet_t *packet, uint8_t sample_size);

/* Any reply: header and content (`content` may be NULL when there is none). `length` is the length
 * field of the header and, in mode 0, the size of the content. Returns the number of bytes. */
size_t encode_reply(uint8_t *out, uint8_t mode, uint8_t type, const uint8_t *content,
                    uint32_t length);

/* The replies of section 4; each returns its length, at most ENCODE_REPLY_MAX. */
size_t encode_scan_reply(uint8_t *out);
size_t encode_information_reply(uint8_t *out, const encode_information_t *information);
size_t encode_health_reply(uint8_t *out, uint8_t status, uint16_t error_code);
size_t encode_frequency_reply(uint8_t *out, uint32_t frequency_chz);

/* One step of the CRC-8 of section 7: start with 0 and feed every CT byte. */
uint8_t encode_crc8(uint8_t crc, uint8_t byte);

/* The CT byte of the packet with this index in its revolution (start packet = 0). Indices
 * that the manual calls production data get a value made up from `production`. */
uint8_t encode_ct(const encode_turn_t *turn, uint32_t index);

#endif
