/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "encoder.h"

#include <string.h>

void encode_u16(uint8_t *out, uint16_t value)
{
    out[0] = (uint8_t)(value & 0xFFu);
    out[1] = (uint8_t)(value >> 8);
}

void encode_u32(uint8_t *out, uint32_t value)
{
    encode_u16(out, (uint16_t)(value & 0xFFFFu));
    encode_u16(out + 2, (uint16_t)(value >> 16));
}

uint16_t encode_angle(uint16_t angle_q6)
{
    return (uint16_t)(((uint32_t)angle_q6 << 1) | 1u);
}

void encode_sample(uint8_t *out, encode_sample_t sample)
{
    out[0] = sample.intensity;
    out[1] = (uint8_t)(((sample.distance_mm & 0x3Fu) << 2) | (sample.flag & 3u));
    out[2] = (uint8_t)((sample.distance_mm >> 6) & 0xFFu);
}

void encode_packet_header(uint8_t *out, const encode_packet_t *packet)
{
    out[0] = 0xAA;
    out[1] = 0x55;
    out[2] = packet->ct;
    out[3] = packet->lsn;
    encode_u16(out + 4, encode_angle(packet->first_q6));
    encode_u16(out + 6, encode_angle(packet->last_q6));
    encode_u16(out + 8, 0);
}

/* The XOR of words of section 5, computed for low and high bytes separately. A sample is the words
 * 0x00.S1 and S3.S2: S1 and S2 are low bytes, S3 is a high byte. */
uint16_t encode_checksum(const uint8_t *packet)
{
    const uint8_t *sample = packet + ENCODE_PACKET_HEADER;
    uint8_t low = (uint8_t)(packet[0] ^ packet[2] ^ packet[4] ^ packet[6]);
    uint8_t high = (uint8_t)(packet[1] ^ packet[3] ^ packet[5] ^ packet[7]);
    for (uint8_t left = packet[3]; left > 0; left--) {
        low = (uint8_t)(low ^ sample[0] ^ sample[1]);
        high = (uint8_t)(high ^ sample[2]);
        sample += ENCODE_SAMPLE_SIZE;
    }
    return (uint16_t)(((uint32_t)high << 8) | low);
}

void encode_seal(uint8_t *packet)
{
    encode_u16(packet + 8, encode_checksum(packet));
}

size_t encode_packet(uint8_t *out, const encode_packet_t *packet)
{
    uint8_t *sample = out + ENCODE_PACKET_HEADER;
    encode_packet_header(out, packet);
    for (size_t i = 0; i < packet->lsn; i++) {
        encode_sample(sample, packet->samples[i]);
        sample += ENCODE_SAMPLE_SIZE;
    }
    encode_seal(out);
    return (size_t)(sample - out);
}

size_t encode_other_packet(uint8_t *out, const encode_packet_t *packet, uint8_t sample_size)
{
    const size_t size = ENCODE_PACKET_HEADER + (size_t)sample_size * packet->lsn;
    uint16_t checksum = 0;
    encode_packet_header(out, packet);
    for (size_t i = 0; i < packet->lsn; i++) {
        const encode_sample_t *const from = &packet->samples[i];
        uint8_t *const sample = out + ENCODE_PACKET_HEADER + sample_size * i;
        if (sample_size == 2) {
            encode_u16(sample, (uint16_t)(((uint32_t)from->distance_mm << 2) | (from->flag & 3u)));
        } else {
            encode_u16(sample, from->intensity);
            encode_u16(sample + 2, from->distance_mm);
        }
    }
    for (size_t i = 0; i < size; i += 2) {
        checksum ^= (uint16_t)(((uint32_t)out[i + 1] << 8) | out[i]);
    }
    encode_u16(out + 8, checksum);
    return size;
}

size_t encode_reply(uint8_t *out, uint8_t mode, uint8_t type, const uint8_t *content,
                    uint32_t length)
{
    out[0] = 0xA5;
    out[1] = 0x5A;
    encode_u32(out + 2, ((uint32_t)mode << 30) | (length & 0x3FFFFFFFu));
    out[6] = type;
    if (mode != ENCODE_MODE_SINGLE || content == NULL) {
        return ENCODE_REPLY_HEADER;
    }
    memcpy(out + ENCODE_REPLY_HEADER, content, (size_t)length);
    return ENCODE_REPLY_HEADER + (size_t)length;
}

/* The length field says 5, which is meaningless in continuous mode (section 4). */
size_t encode_scan_reply(uint8_t *out)
{
    return encode_reply(out, ENCODE_MODE_CONTINUOUS, ENCODE_TYPE_SCAN, NULL, 5);
}

/* Firmware version: minor byte first, as real units send it (section 9.4). */
size_t encode_information_reply(uint8_t *out, const encode_information_t *information)
{
    uint8_t content[20];
    content[0] = information->model;
    content[1] = information->firmware_minor;
    content[2] = information->firmware_major;
    content[3] = information->hardware;
    memcpy(content + 4, information->serial, sizeof information->serial);
    return encode_reply(out, ENCODE_MODE_SINGLE, ENCODE_TYPE_INFORMATION, content, sizeof content);
}

size_t encode_health_reply(uint8_t *out, uint8_t status, uint16_t error_code)
{
    uint8_t content[3];
    content[0] = status;
    encode_u16(content + 1, error_code);
    return encode_reply(out, ENCODE_MODE_SINGLE, ENCODE_TYPE_HEALTH, content, sizeof content);
}

size_t encode_frequency_reply(uint8_t *out, uint32_t frequency_chz)
{
    uint8_t content[4];
    encode_u32(content, frequency_chz);
    return encode_reply(out, ENCODE_MODE_SINGLE, ENCODE_TYPE_INFORMATION, content, sizeof content);
}

uint8_t encode_crc8(uint8_t crc, uint8_t byte)
{
    crc ^= byte;
    for (int bit = 0; bit < 8; bit++) {
        crc = (uint8_t)((crc & 1u) != 0u ? (crc >> 1) ^ 0x8Cu : crc >> 1);
    }
    return crc;
}

/* The manual does not disclose them: any value with bit 0 clear will do. */
static uint8_t production_data(uint8_t production, uint32_t index)
{
    return (uint8_t)((index * 0x5Au + production * 2u) & 0xFEu);
}

static uint8_t field(uint32_t high, unsigned shift, uint32_t low)
{
    return (uint8_t)(((high << shift) | (low << 1)) & 0xFEu);
}

uint8_t encode_ct(const encode_turn_t *turn, uint32_t index)
{
    switch (index) {
    case 0:
        return (uint8_t)(field(0, 1, turn->frequency_dhz) | 1u);
    case 1:
        return field(turn->user_major, 6, turn->user_minor);
    case 3:
        return field(0, 1, turn->health);
    case 4:
        return field(turn->hardware, 5, turn->firmware_major);
    case 5:
        return field(0, 1, turn->firmware_minor);
    case 9:
        return field(turn->year - 2020u, 3, (turn->serial >> 19) & 3u);
    case 10:
        return field(turn->month, 4, (turn->serial >> 16) & 7u);
    case 11:
        return field(turn->day, 3, (turn->serial >> 14) & 3u);
    case 12:
        return field(0, 1, (turn->serial >> 7) & 0x7Fu);
    case 13:
        return field(0, 1, turn->serial & 0x7Fu);
    default:
        return production_data(turn->production, index);
    }
}
