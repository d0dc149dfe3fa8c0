/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A turning lidar whose samples can be checked: the distance encodes the revolution, angle and
 * intensity the sample's index. So a scan shows whether it is one revolution, whatever the line has
 * lost. Shares no code with the library. */

#ifndef TURNING_LIDAR_H
#define TURNING_LIDAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/parts/tmini_builder.h"

#define TURNING_PACKET_MAX 131u /* With LastCRC. */
#define TURNING_REPLY_MAX 27u
#define TURNING_POINTS 658u /* Of a revolution. */

/* Switched on; it does not scan yet. With CT information and LastCRC (section 7), or neither. */
void turning_begin(bool ct_information);

/* The code of a command has come. Returns the reply's size, 0 if there is none: it ignores all but
 * stop and reboot while it scans. */
size_t turning_command(uint8_t code, uint8_t *reply);

/* Puts the packet that it sends next to `out`, and goes on; returns its size, 0 if it does not
 * scan. Adds to the clock how long that takes, in any case. */
size_t turning_packet(uint8_t *out, uint32_t *now_ms);

/* These bytes have come through the line. Returns false if the account of them is full. */
bool turning_received(const uint8_t *bytes, size_t count);

/* Looks at a scan that the library has delivered. */
void turning_judge(const tmini_scan_t *scan);

/* What is wrong with a scan, or NULL. Remains of two packets that together look like a valid packet
 * cannot be distinguished from one, so they are not an error. */
const char *turning_verdict(void);

#endif
