/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "traits.h"

#include <ctype.h>
#include <string.h>

#include "tmini/parts/tmini_packet.h"

#define HEADER TMINI_PACKET_HEADER_SIZE

/* The place of a run that is looked at. */
typedef struct {
    const uint8_t *bytes;
    size_t count;
} run_t;

static bool is_sync(run_t run, size_t at)
{
    return at + 1 < run.count && run.bytes[at] == 0xAA && run.bytes[at + 1] == 0x55;
}

/* Section 5, as far as a damaged packet still has it. */
static bool is_header(run_t run, size_t at)
{
    return is_sync(run, at) && at + HEADER <= run.count && run.bytes[at + 3] > 0;
}

static size_t size_of(run_t run, size_t at, size_t sample_size)
{
    return HEADER + sample_size * run.bytes[at + 3];
}

/* Whether the next packet follows: at once, or after LastCRC (section 7). */
static bool is_followed(run_t run, size_t at)
{
    return is_sync(run, at) || is_sync(run, at + 1);
}

/* The difference between the checksum of the packet of three-byte samples and the one that it
 * should have (section 5); 0 for a valid one. */
static uint16_t mismatch(const uint8_t *bytes)
{
    uint8_t low = (uint8_t)(bytes[0] ^ bytes[2] ^ bytes[4] ^ bytes[6] ^ bytes[8]);
    uint8_t high = (uint8_t)(bytes[1] ^ bytes[3] ^ bytes[5] ^ bytes[7] ^ bytes[9]);
    for (size_t i = 0; i < bytes[3]; i++) {
        const uint8_t *const sample = bytes + HEADER + 3 * i;
        low = (uint8_t)(low ^ sample[0] ^ sample[1]);
        high = (uint8_t)(high ^ sample[2]);
    }
    return (uint16_t)(high << 8 | low);
}

static bool is_valid(run_t run, size_t at)
{
    const uint8_t *const bytes = run.bytes + at;
    return is_header(run, at) && at + size_of(run, at, 3) <= run.count &&
           ((bytes[2] & 1) == 0 || bytes[3] == 1) && (bytes[4] & bytes[6] & 1) == 1 &&
           mismatch(run.bytes + at) == 0;
}

/* 0A instead of 0D changes both halves of the sum by 07. */
static bool is_swapped(const uint8_t *bytes)
{
    const uint16_t wrong = mismatch(bytes);
    return wrong == 0x0007 || wrong == 0x0700 || wrong == 0x0707;
}

/* Whether the packet, which lacks one byte, is valid with an 11 or 13 at some place. */
static bool is_eaten(run_t run, size_t at)
{
    static const uint8_t eaten[2] = {0x11, 0x13};
    const size_t size = size_of(run, at, 3);
    uint8_t bytes[HEADER + 3 * UINT8_MAX];
    for (size_t i = 0; i < 2; i++) {
        for (size_t place = 4; place < size; place++) {
            memcpy(bytes, run.bytes + at, place);
            bytes[place] = eaten[i];
            memcpy(bytes + place + 1, run.bytes + at + place, size - place - 1);
            if (mismatch(bytes) == 0) {
                return true;
            }
        }
    }
    return false;
}

/* A header, but no valid packet: of another unit, or damaged. A start packet is too short to tell
 * three bytes from four. */
static void look_at_header(traits_t *traits, run_t run, size_t at)
{
    const size_t size = size_of(run, at, 3);
    traits->headers++;
    if (at + size <= run.count && is_followed(run, at + size)) {
        traits->damaged++;
        traits->swapped += is_swapped(run.bytes + at) ? 1 : 0;
    } else if (at + size <= run.count && is_sync(run, at + size - 1)) {
        traits->eaten += is_eaten(run, at) ? 1 : 0;
    }
    for (size_t sample_size = 2; sample_size <= 4 && run.bytes[at + 3] > 1; sample_size += 2) {
        traits->fit[sample_size] += is_followed(run, at + size_of(run, at, sample_size)) ? 1 : 0;
    }
}

static size_t find_packets(traits_t *traits, run_t run)
{
    size_t valid = 0;
    for (size_t at = 0; at + HEADER <= run.count;) {
        if (is_valid(run, at)) {
            valid++;
            at += size_of(run, at, 3);
        } else {
            if (traits != NULL && is_header(run, at)) {
                look_at_header(traits, run, at);
            }
            at++;
        }
    }
    return valid;
}

/* As a telnet bridge does, FF stands for itself only if it comes twice. */
static void undouble(traits_t *traits, run_t run)
{
    static uint8_t single[TRAITS_MAX];
    size_t count = 0;
    for (size_t i = 0; i < run.count; i++) {
        single[count++] = run.bytes[i];
        if (run.bytes[i] == 0xFF && i + 1 < run.count && run.bytes[i + 1] == 0xFF) {
            traits->doubled++;
            i++;
        }
    }
    traits->undoubled = find_packets(NULL, (run_t){single, count});
}

/* Section 3. */
static bool is_command(const uint8_t *bytes)
{
    static const char codes[] = "\x60\x65\x90\x92\x09\x0A\x0B\x0C\x0D\x40";
    return bytes[0] == 0xA5 && memchr(codes, bytes[1], sizeof codes - 1) != NULL;
}

/* UTF-8 of a byte of 80 to FF, or of the sign for one that could not be converted. */
static size_t utf8_size(const uint8_t *bytes, size_t left)
{
    if (left >= 3 && memcmp(bytes, "\xEF\xBF\xBD", 3) == 0) {
        return 3;
    }
    return left >= 2 && (bytes[0] & 0xFE) == 0xC2 && (bytes[1] & 0xC0) == 0x80 ? 2 : 0;
}

/* The sign of a packet (section 5) or the reply with the information (section 4), in seven bits. */
static bool is_seven(run_t run, size_t at)
{
    static const uint8_t reply[7] = {0x25, 0x5A, 0x14, 0, 0, 0, 0x04};
    const uint8_t *const bytes = run.bytes + at;
    const size_t left = run.count - at;
    return (left >= 2 && bytes[0] == 0x2A && bytes[1] == 0x55) ||
           (left >= sizeof reply && memcmp(bytes, reply, sizeof reply) == 0);
}

static void look_at_bytes(traits_t *traits, run_t run)
{
    for (size_t i = 0; i < run.count; i++) {
        const uint8_t byte = run.bytes[i];
        const bool has_next = i + 1 < run.count;
        traits->of[byte]++;
        traits->high += byte > 0x7F ? 1 : 0;
        traits->text += (byte < 0x7F && isprint(byte)) || byte == '\n' || byte == '\r' ||
                                byte == '\t' || byte == '\x1B'
                            ? 1
                            : 0;
        traits->seven += is_seven(run, i) ? 1 : 0;
        traits->commands += has_next && is_command(run.bytes + i) ? 1 : 0;
    }
    for (size_t i = 0; i < run.count; i++) {
        const size_t size = utf8_size(run.bytes + i, run.count - i);
        traits->utf8 += size;
        i += size > 1 ? size - 1 : 0;
    }
}

/* The longest of the first lines, as far as there is room. */
static void keep_excerpt(traits_t *traits, run_t run)
{
    size_t length = 0;
    for (size_t i = 0; i < run.count && length + 1 < sizeof traits->excerpt; i++) {
        const uint8_t byte = run.bytes[i];
        if (byte < 0x7F && isprint(byte)) {
            traits->excerpt[length++] = (char)byte;
        } else if (length > 3) {
            break;
        }
    }
    traits->excerpt[length] = '\0';
}

void traits_find(traits_t *traits, const uint8_t *bytes, size_t count)
{
    const run_t run = {bytes, count < TRAITS_MAX ? count : TRAITS_MAX};
    memset(traits, 0, sizeof *traits);
    traits->bytes = run.count;
    traits->packets = find_packets(traits, run);
    undouble(traits, run);
    look_at_bytes(traits, run);
    keep_excerpt(traits, run);
}
