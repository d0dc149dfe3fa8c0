/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The view in a terminal: keyboard, size and screen around view.h, for any source of scans. */

#ifndef VIEWER_H
#define VIEWER_H

#include "options.h"
#include "scan_list.h"
#include "view.h"

typedef struct {
    view_t view;
    screen_t screen;
    bool is_over;      /* The user has had enough, or a signal has come. */
    bool has_memory;   /* Otherwise over, too. */
    tmini_scan_t scan; /* The latest one, kept for drawing again. */
    tmini_point_t points[SCAN_CAPACITY];
} viewer_t;

/* Takes the terminal over. Returns false, and says so, if there is none. One at a time. */
bool viewer_open(viewer_t *viewer, const char *source);

/* Gives it back. */
void viewer_close(viewer_t *viewer);

/* A new scan, which is copied. */
void viewer_keep(viewer_t *viewer, const tmini_scan_t *scan);

/* To be called every few milliseconds: follows keys and size, and draws again if need be; `is_news`:
 * there is something new to show. */
void viewer_attend(viewer_t *viewer, bool is_news);

/* Shows a recording at its own speed, until the user has had enough. Returns the status to leave with. */
int view_recording(const options_t *options);

#endif
