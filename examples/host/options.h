/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The command line: which command, and its options. */

#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    FORMAT_TEXT, /* For people. */
    FORMAT_CSV,
    FORMAT_JSON,
} format_t;

/* All options of all commands; 0 or NULL: not given. */
typedef struct {
    const char *operand; /* The word that belongs to no option: a file, or a frequency. */
    const char *port;
    const char *output;
    const char *stats;
    format_t format;
    unsigned max_samples;
    unsigned count;
    unsigned seconds;
    unsigned scan;
    bool all;
    bool quiet;
    bool help;
} options_t;

typedef struct {
    const char *name;
    const char *usage;   /* What follows the name. */
    const char *summary; /* One line. */
    const char *details; /* More lines, for --help. */
    const char *accepts; /* The letters of its options, see options.c. */
    const char *operand; /* What the operand is; NULL: there is none. */
    int (*run)(const options_t *options);
} command_t;

/* Reads the words behind the command's name. Returns STATUS_OK, or STATUS_USAGE and says why. */
int options_parse(options_t *options, const command_t *command, int count, char *const *words);

/* Prints the usage of a command and its options. */
void options_help(const command_t *command);

#endif
