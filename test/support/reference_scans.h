/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Which scans a sequence of packets makes, as directly as docs/design.md ("No complete scan mixes
 * revolutions") can be written down: by looking at all of them, later ones included. The library
 * sees one packet at a time; it is compared with this. */

#ifndef REFERENCE_SCANS_H
#define REFERENCE_SCANS_H

#include "reference_decoder.h"

typedef struct {
    size_t first;  /* Its start packet among the items, */
    size_t end;    /* and the packet that ended it. */
    size_t points; /* Of all its packets; */
    size_t packets;
    size_t gaps;       /* between them, or before the one that ended it. */
    bool is_whole;     /* The circle is full, without a gap. */
    uint8_t decihertz; /* From the start packet after it; 0: none. */
} reference_scan_t;

/* Finds the first scan that begins at items[from] or later, and has ended. Returns false if none
 * is. The items are those of one decoding, in order, and nothing was lost before it. */
bool reference_scan(const reference_item_t *items, size_t count, size_t from,
                    reference_scan_t *scan);

#endif
