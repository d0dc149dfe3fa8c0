/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The scans of a recording, gathered by the library's scan module and kept. */

#ifndef SCAN_LIST_H
#define SCAN_LIST_H

#include <stdbool.h>
#include <stddef.h>

#include "decoder.h"
#include "tmini/tmini_scan.h"

/* More points than any revolution has: 4000 a second at well below 1 Hz. */
#define SCAN_CAPACITY 8192

typedef struct {
    tmini_scan_t scan;    /* Its points are the list's. */
    uint64_t number;      /* Start packets seen up to and including its own. */
    uint64_t first_point; /* Points in the recording before it: its time, at 4000 a second. */
} kept_scan_t;

typedef struct {
    kept_scan_t *scans;
    size_t count;
    size_t room;
    tmini_scan_builder_t builder;
    kept_scan_t current;
    bool is_open;
    tmini_point_t points[SCAN_CAPACITY]; /* Of the scan under way. */
} scan_list_t;

/* NULL if memory is short. Released by scan_list_free(). */
scan_list_t *scan_list_new(void);
void scan_list_free(scan_list_t *list);

/* Takes the decoder's latest packet. Returns false if memory is short. */
bool scan_list_add(scan_list_t *list, const decoder_t *decoder);

/* The recording has ended: keeps the unfinished scan too, as an incomplete one. Returns false if
 * memory is short. */
bool scan_list_end(scan_list_t *list);

/* A copy of the scan in the list. Returns false if memory is short. */
bool scan_list_append(scan_list_t *list, const kept_scan_t *scan);

/* The last complete scan, or NULL. */
const kept_scan_t *scan_list_last_complete(const scan_list_t *list);

/* The scan with that number, or NULL. */
const kept_scan_t *scan_list_find(const scan_list_t *list, uint64_t number);

/* The nearest valid point, or NULL. */
const tmini_point_t *scan_nearest(const tmini_scan_t *scan);

/* Points with a distance. */
size_t scan_valid_points(const tmini_scan_t *scan);

#endif
