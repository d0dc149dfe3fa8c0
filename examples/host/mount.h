/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How the lidar is mounted, as the options say: --front, --upside-down, --offset,
 * --mask. */

#ifndef MOUNT_H
#define MOUNT_H

#include "options.h"

/* The mounting in the options, or NULL if they have none. Valid as long as the options. */
const tmini_mount_t *mount_of(const options_t *options);

/* Read an option's value; false if it is invalid. */
bool mount_read_front(options_t *options, const char *text);
bool mount_read_offset(options_t *options, const char *text);
bool mount_read_mask(options_t *options, const char *text);

/* Whether the lidar sees the robot itself in that direction. */
bool mount_hides(const tmini_mount_t *mount, uint16_t angle_q6);

#endif
