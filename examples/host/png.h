/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A canvas as a PNG file. A writer of its own, not libpng: this project's demonstration is to need
 * nothing but a C compiler and CMake, and writing (unlike reading) PNG takes little. */

#ifndef PNG_H
#define PNG_H

#include "canvas.h"

/* Returns false, with errno set, if the file cannot be written. */
bool png_save(const canvas_t *canvas, const char *path);

#endif
