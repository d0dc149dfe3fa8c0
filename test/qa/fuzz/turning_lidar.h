/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar with marked samples, for the fuzzer: each point shows its revolution and its
 * place there. So a scan shows whether all its points are from one revolution, whatever the line
 * has lost. */

#ifndef TURNING_LIDAR_H
#define TURNING_LIDAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim_line.h"
#include "tmini/parts/tmini_builder.h"

/* Resets the lidar: it does not scan yet. It sends CT information and LastCRC (section 7), or
 * neither. */
void turning_begin(bool ct_information);

/* The lidar receives a command. */
void turning_command(uint8_t code);

/* Writes the next packet (with LastCRC) or reply to `out`, which has SIM_FRAME_MAX bytes; returns
 * its size, or 0 if nothing comes for the time of a packet. Moves the clock. */
size_t turning_frame(uint8_t *out, bool *is_packet, uint32_t *now_ms);

/* Records bytes that have arrived. Returns false if the record is full. */
bool turning_received(const uint8_t *bytes, size_t count);

void turning_judge(const tmini_scan_t *scan);

/* Returns the first error in a scan, or NULL. Remains of two packets that look like a valid packet
 * cannot be distinguished from one: no error. */
const char *turning_verdict(void);

#endif
