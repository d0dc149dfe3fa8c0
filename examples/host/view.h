/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What `tmini view` shows: the scan as a picture, and values beside it. */

#ifndef VIEW_H
#define VIEW_H

#include "stream.h"
#include "points.h"
#include "terminal.h"

/* The whole state of the view; the caller fills it in. */
typedef struct {
    const char *source; /* The port's or the file's name. */
    const char *state;  /* "scanning", "end of the recording", … */
    const char *keys;   /* What the keys do. */
    const stream_t *stream;
    unsigned faults;   /* A combination of tmini_fault_t, or TMINI_FAULTS_UNKNOWN. */
    unsigned zoom_mm;  /* The range chosen by the user; 0: as far as the points. */
    unsigned range_mm; /* The range shown; 0: to be chosen. */
    survey_t survey;   /* Private to view_draw(): the survey of the scan. */
    survey_t colours;  /* Private: the range of the colours, kept from scan to scan. */
} view_t;

/* Draws the view on the screen, whatever its size. */
void view_draw(view_t *view, screen_t *screen);

/* Selects the next smaller or larger range. */
void view_zoom(view_t *view, bool in);

#endif
