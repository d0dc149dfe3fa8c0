/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Finds the scans in a sequence of packets, written as directly as possible from docs/design.md
 * ("No complete scan mixes revolutions"). This code sees all packets at once, also later ones. The
 * library, which sees one at a time, is compared with it. */

#ifndef REFERENCE_SCANS_H
#define REFERENCE_SCANS_H

#include "reference_decoder.h"

typedef struct {
    size_t first;  /* Index of its first packet among the items. */
    size_t end;    /* Index of the packet that ended it. */
    size_t points; /* Of all its packets. */
    size_t packets;
    size_t gaps;       /* Before its packets or the one that ended it; also a lost start. */
    bool is_whole;     /* The circle is full, without a gap. */
    uint8_t decihertz; /* From the next start packet; if that was lost, from the one before. */
} reference_scan_t;

/* Finds the first scan that begins at items[from] or after it. Returns false if there is none, or
 * nothing ends it. The items are all those of one decoding, in order, without overruns. */
bool reference_scan(const reference_item_t *items, size_t count, size_t from,
                    reference_scan_t *scan);

#endif
