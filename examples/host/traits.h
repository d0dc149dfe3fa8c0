/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a run of bytes looks like, also if it is not what a T-mini Plus sends: signs of other units
 * and of what lies between the lidar and this program. Only counts; causes.c judges. */

#ifndef TRAITS_H
#define TRAITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Longer runs are not looked at. */
#define TRAITS_MAX 65536u

typedef struct {
    size_t bytes;
    size_t packets; /* Valid ones; and headers of others. */
    size_t headers;
    size_t fit[5];  /* [2], [4]: packets that have the length for such samples, not for three. */
    size_t damaged; /* Packets of the right length with a wrong checksum; and how many of these one
                     * 0A instead of 0D, or the reverse, explains. */
    size_t swapped;
    size_t eaten;     /* Packets that lack one byte, and that 11 or 13 makes valid. */
    size_t doubled;   /* Doubled FF; and how many packets are valid without the second one. */
    size_t undoubled; /* (The valid ones above included.) */
    size_t seven;     /* Packets and replies in seven bits. */
    size_t commands;  /* Commands of two bytes, which only a host sends. */
    size_t high;      /* Bytes above 7F, and of these the ones that are UTF-8. */
    size_t utf8;
    size_t text;      /* Printable characters, spaces and new lines. */
    size_t of[256];   /* How often each byte occurs. */
    char excerpt[41]; /* The first line of text. */
} traits_t;

void traits_find(traits_t *traits, const uint8_t *bytes, size_t count);

#endif
