/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Finds the word that a user meant when it was mistyped. */

#ifndef WORDS_H
#define WORDS_H

#include <stddef.h>

/* The one of `count` words that differs from `typed` in the fewest letters (one that is wrong, too
 * many, missing, or exchanged with the next), or that begins with it; NULL if more than a third of
 * the letters are wrong in each. */
const char *words_nearest(const char *typed, const char *const *words, size_t count);

#endif
