/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the firmware prints on its console: lines that consist of a word and named values. */

#ifndef REPORT_H
#define REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "obstacle.h"
#include "tmini/tmini.h"
#include "tmini_stm32_usart.h"

void report_start(void);
void report_info(const tmini_info_t *info);
void report_health(const tmini_health_t *health);
void report_frequency(uint16_t frequency_chz);
void report_failure(tmini_status_t status);
void report_faults(uint8_t faults);
void report_word(const char *word);

/* A scan's points as a checksum (CRC-32 of each point's angle, distance, intensity and flag, as 2,
 * 2, 1 and 1 bytes, low byte first), to be compared with what the lidar has sent. */
void report_digest(const tmini_scan_t *scan);

/* Values for the report of each second. */
typedef struct {
    uint32_t points;       /* In all scans so far. */
    uint32_t worst_cycles; /* In the lidar's interrupt, since the last report. */
    bool may_move;
} report_status_t;

void report_status(const tmini_counters_t *counters, const obstacle_t *obstacle,
                   const report_status_t *status);

/* Prints all counters. The first value is the interrupt's count of bytes; the library's counters of
 * bytes must add up to it. */
void report_counters(const tmini_t *lidar, const tmini_stm32_usart_t *port);

#endif
