/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The picture of a scan: seen from above, the lidar in the middle, its front up, angles clockwise. */

#ifndef POLAR_H
#define POLAR_H

#include <stddef.h>

#include "sheet.h"
#include "tmini/tmini_scan.h"

#define POLAR_WIDTH 1200u
#define POLAR_HEIGHT 1360u

typedef struct {
    const char *title;
    const char *subtitle;
    const tmini_scan_t *const *scans; /* One or more, in one picture. */
    size_t count;
} figure_t;

void polar_draw(const sheet_t *sheet, const figure_t *figure);

#endif
