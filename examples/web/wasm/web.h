/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The interface between the library and JavaScript, which calls the functions marked EXPORTED;
 * there are no imports. Bytes go in both directions through `transfer`. Numbers are read from a
 * table with their names, so that JavaScript needs only the layout of a point. */

#ifndef WEB_H
#define WEB_H

#include <stddef.h>
#include <stdint.h>

#include "stream.h"
#include "tmini_timed.h"

#define EXPORTED __attribute__((visibility("default")))

#define WEB_SCAN_POINTS STREAM_POINTS_MAX

#define WEB_TRANSFER_SIZE 16384u
extern uint8_t web_transfer[WEB_TRANSFER_SIZE];

/* The result of network_take() where bytes were lost. */
#define NETWORK_GAP UINT32_C(0x40000000)

/* Empties the table of numbers; adds one. `name` is a constant string. */
void numbers_clear(void);
void numbers_put(const char *name, uint32_t value);
void numbers_put_ct(const tmini_ct_info_t *info);
uint32_t numbers_count(void);

/* Shows `scan`, which is copied. */
void shown_take(const tmini_scan_t *scan);

void shown_clear(void);

#endif
