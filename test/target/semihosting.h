/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Semihosting: a program on an emulated controller prints on this computer and ends with a status.
 * Each machine's start-up file implements this. */

#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

void semihosting_put(char character);

/* Ends the emulator: with status 0 if `status` is 0, else with 1. Does not return. */
void semihosting_exit(int status);

#endif
