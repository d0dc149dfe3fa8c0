/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How the lidar is mounted, as the options say: --front, --upside-down, --mask. */

#ifndef MOUNT_H
#define MOUNT_H

#include "options.h"

/* The options' mounting, or NULL if they say nothing about it. Valid as long as they are. */
const tmini_mount_t *mount_of(const options_t *options);

/* Read a value; false if it is none. */
bool mount_read_front(options_t *options, const char *text);
bool mount_read_mask(options_t *options, const char *text);

/* Whether the robot sees itself in that direction. */
bool mount_hides(const tmini_mount_t *mount, uint16_t angle_q6);

#endif
