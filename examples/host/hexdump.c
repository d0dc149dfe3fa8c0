/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "hexdump.h"

#include <ctype.h>
#include <string.h>

/* Addresses have at least this many digits, bytes and words fewer. */
#define ADDRESS_DIGITS 6u

static bool is_hex(char c)
{
    return isxdigit((unsigned char)c) != 0;
}

static unsigned value_of(char c)
{
    return c <= '9' ? (unsigned)(c - '0') : (unsigned)(tolower((unsigned char)c) - 'a' + 10);
}

static size_t digits_at(const char *text)
{
    size_t digits = 0;
    while (is_hex(text[digits])) {
        digits++;
    }
    return digits;
}

static const char *skip_prefix(const char *at)
{
    return at[0] == '0' && (at[1] == 'x' || at[1] == 'X') ? at + 2 : at;
}

/* The address at the beginning of a line; `has_colon`: as xxd writes it. */
static const char *skip_address(const char *line, bool *has_colon)
{
    const char *const at = skip_prefix(line + strspn(line, " \t"));
    const size_t digits = digits_at(at);
    *has_colon = digits >= 4 && at[digits] == ':';
    if (*has_colon) {
        return at + digits + 1;
    }
    const char *const next = at + digits + strspn(at + digits, " \t");
    const bool is_address = digits >= ADDRESS_DIGITS && digits <= 16 && next > at + digits &&
                            digits_at(next) > 0 && digits_at(next) < ADDRESS_DIGITS;
    return is_address ? at + digits : line;
}

/* A line's characters follow "|" (hexdump -C), or two spaces (xxd). */
static const char *end_of(const char *at, bool has_colon)
{
    const char *const bar = strchr(at, '|');
    const char *const first = at + strspn(at, " \t");
    const char *const gap = has_colon ? strstr(first, "  ") : NULL;
    return bar != NULL ? bar : gap != NULL ? gap : at + strlen(at);
}

/* hexdump writes words, the high byte first, although the low one comes first in the file. */
static size_t put_digits(const char *at, size_t digits, bool is_swapped, uint8_t *bytes)
{
    const size_t count = digits / 2;
    for (size_t i = 0; i < count; i++) {
        const size_t place = is_swapped ? count - 1 - i : i;
        bytes[place] = (uint8_t)(value_of(at[2 * i]) << 4 | value_of(at[2 * i + 1]));
    }
    return count;
}

/* Anything else than pairs of digits and what may stand between them ends a line. */
static size_t take_line(hexdump_t *dump, const char *line, uint8_t *bytes)
{
    static const char between[] = " \t\r,;:{}[]\"'-";
    bool has_colon = false;
    const char *at = skip_address(line, &has_colon);
    const bool has_address = at != line;
    const char *const end = end_of(at, has_colon);
    size_t count = 0;
    if (dump->has_addresses && !has_address) {
        return 0;
    }
    dump->has_addresses = has_address;
    while (at < end) {
        at += strspn(at, between);
        at = skip_prefix(at);
        const size_t digits = digits_at(at);
        if (digits == 0 || digits % 2 != 0 || at + digits > end) {
            break;
        }
        count += put_digits(at, digits, has_address && !has_colon && digits == 4, bytes + count);
        at += digits;
    }
    return count;
}

/* A line without end is taken in pieces: between two bytes. */
static bool is_full(const hexdump_t *dump, char next)
{
    const bool is_between = !is_hex(next) && next != 'x' && next != 'X';
    return (dump->count >= HEXDUMP_LINE - 100 && is_between) ||
           (dump->count >= HEXDUMP_LINE - 3 && dump->count % 2 == 0);
}

static size_t end_line(hexdump_t *dump, uint8_t *bytes)
{
    dump->line[dump->count] = '\0';
    dump->count = 0;
    return take_line(dump, dump->line, bytes);
}

size_t hexdump_take(hexdump_t *dump, const uint8_t *text, size_t count, uint8_t *bytes)
{
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        if (text[i] == '\n' || is_full(dump, (char)text[i])) {
            made += end_line(dump, bytes + made);
        }
        if (text[i] != '\n') {
            dump->line[dump->count++] = (char)text[i];
        }
    }
    return count == 0 ? end_line(dump, bytes) : made;
}

static bool is_text(const uint8_t *text, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (text[i] > 0x7E || (text[i] < ' ' && strchr("\t\r\n", text[i]) == NULL)) {
            return false;
        }
    }
    return true;
}

/* Text that gives a byte for at most eight characters, among them the sign of packets (section 5)
 * or replies (section 4). */
bool hexdump_is(const uint8_t *text, size_t count)
{
    static uint8_t bytes[2 * HEXDUMP_LINE];
    hexdump_t dump = {.count = 0};
    const size_t looked_at = count < HEXDUMP_LINE ? count : HEXDUMP_LINE;
    if (looked_at == 0 || !is_text(text, looked_at)) {
        return false;
    }
    size_t made = hexdump_take(&dump, text, looked_at, bytes);
    made += hexdump_take(&dump, text, 0, bytes + made);
    for (size_t i = 0; i + 1 < made; i++) {
        if ((bytes[i] == 0xAA && bytes[i + 1] == 0x55) ||
            (bytes[i] == 0xA5 && bytes[i + 1] == 0x5A)) {
            return 8 * made >= looked_at;
        }
    }
    return false;
}
