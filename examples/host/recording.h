/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings as files: opening one, and saying what is wrong with one. */

#ifndef RECORDING_H
#define RECORDING_H

#include <stdio.h>

#include "decoder.h"

/* Opens a recording for reading; "-" is standard input. NULL, and said why, if that fails. */
FILE *recording_open(const char *path);

void recording_close(FILE *file);

/* To be called when the decoder has come to the end: says what is wrong if the file could not be
 * read, was empty, or holds nothing of a lidar. Returns the status to leave with. */
int recording_verdict(const char *path, const decoder_t *decoder);

/* The path without its folders. */
const char *recording_base_name(const char *path);

#endif
