/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A turning lidar whose samples can be checked: the distance encodes the revolution, and angle and
 * intensity encode the sample's index. So a scan shows whether all its points are from one
 * revolution, whatever the line has lost. Shares no code with the library. */

#ifndef TURNING_LIDAR_H
#define TURNING_LIDAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/parts/tmini_builder.h"

#define TURNING_PACKET_MAX 131u /* With LastCRC. */
#define TURNING_REPLY_MAX 27u
#define TURNING_POINTS 658u /* Points of a revolution. */

/* Resets the lidar: it does not scan yet. It sends CT information and LastCRC (section 7), or
 * neither. */
void turning_begin(bool ct_information);

/* The lidar receives a command. Returns the reply's size, or 0 without a reply. While it scans, it
 * obeys only stop and reboot. */
size_t turning_command(uint8_t code, uint8_t *reply);

/* Writes the next packet to `out` and returns its size, or 0 if the lidar does not scan. Adds the
 * time of a packet to the clock in both cases. */
size_t turning_packet(uint8_t *out, uint32_t *now_ms);

/* Records bytes that have arrived. Returns false if the record is full. */
bool turning_received(const uint8_t *bytes, size_t count);

void turning_judge(const tmini_scan_t *scan);

/* Returns the first error in a scan, or NULL. Remains of two packets that look like a valid packet
 * cannot be distinguished from one: no error. */
const char *turning_verdict(void);

#endif
