/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "words.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#define LETTERS_MAX 24u

static unsigned least(unsigned a, unsigned b, unsigned c)
{
    const unsigned less = a < b ? a : b;
    return less < c ? less : c;
}

static char letter(const char *word, size_t i)
{
    return (char)tolower((unsigned char)word[i]);
}

/* How many letters must be changed (optimal string alignment). `cost[i][j]` is the number for the
 * first i letters of `a` and the first j of `b`. */
static unsigned difference(const char *a, const char *b)
{
    const size_t a_length = strlen(a);
    const size_t b_length = strlen(b);
    unsigned cost[LETTERS_MAX + 1][LETTERS_MAX + 1];
    if (a_length > LETTERS_MAX || b_length > LETTERS_MAX) {
        return LETTERS_MAX;
    }
    for (size_t i = 0; i <= a_length; i++) {
        for (size_t j = 0; j <= b_length; j++) {
            if (i == 0 || j == 0) {
                cost[i][j] = (unsigned)(i + j);
                continue;
            }
            const unsigned wrong = letter(a, i - 1) != letter(b, j - 1) ? 1 : 0;
            cost[i][j] = least(cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + wrong);
            if (i > 1 && j > 1 && letter(a, i - 1) == letter(b, j - 2) &&
                letter(a, i - 2) == letter(b, j - 1) && cost[i - 2][j - 2] + 1 < cost[i][j]) {
                cost[i][j] = cost[i - 2][j - 2] + 1;
            }
        }
    }
    return cost[a_length][b_length];
}

const char *words_nearest(const char *typed, const char *const *words, size_t count)
{
    const size_t length = strlen(typed);
    const char *nearest = NULL;
    size_t fewest = length / 3 + 1; /* Only fewer are accepted. */
    for (size_t i = 0; i < count; i++) {
        const bool begins = length > 0 && strncmp(words[i], typed, length) == 0;
        const size_t letters = begins ? 0 : difference(typed, words[i]);
        if (letters < fewest) {
            nearest = words[i];
            fewest = letters;
        }
    }
    return nearest;
}
