/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* WebAssembly has no C library. These are the only functions of it that the library and the
 * simulated lidar use; string.c defines them. */

#ifndef WEB_STRING_H
#define WEB_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t count);
void *memmove(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);
int memcmp(const void *one, const void *other, size_t count);
int strcmp(const char *one, const char *other);

#endif
