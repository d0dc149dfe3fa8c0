/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What `tmini view` shows: the scan as a picture, and beside it what a person wants to know. */

#ifndef VIEW_H
#define VIEW_H

#include "screen.h"
#include "tmini/tmini_scan.h"

/* The whole state of the view; the caller fills it in. */
typedef struct {
    const char *source; /* The port's or the file's name. */
    const char *state;  /* "scanning", "end of the recording", … */
    const char *health; /* In words, or NULL if not known. */
    bool is_faulty;
    const tmini_scan_t *scan; /* The latest, or NULL before the first. */
    uint64_t scans;
    uint64_t packets;
    uint64_t checksum_errors;
    uint64_t bytes_lost; /* Stray bytes between packets, or overrun ones. */
    unsigned zoom_mm;    /* The range chosen by hand; 0: as far as there is something. */
    unsigned range_mm;   /* The range shown: view_draw()'s own. */
} view_t;

/* Draws the view on the screen, whatever its size. */
void view_draw(view_t *view, screen_t *screen);

/* The next smaller or larger range than the one shown. */
void view_zoom(view_t *view, bool in);

#endif
