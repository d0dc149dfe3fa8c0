/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The lidar's health in words. */

#ifndef FAULTS_H
#define FAULTS_H

#include <stdint.h>

#define FAULTS_TEXT_SIZE 160

/* "healthy", or the faulty modules and what may help. `faults` is a combination of tmini_fault_t.
 * Returns `text`. */
const char *faults_text(uint8_t faults, char text[FAULTS_TEXT_SIZE]);

#endif
