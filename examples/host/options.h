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

#define OPTIONS_WORDS 3u

/* All options of all commands; 0 or NULL: not given. */
typedef struct {
    const char *command;
    const char *operand; /* The word after the command: a file, a frequency or a command. */
    const char *words[OPTIONS_WORDS]; /* These two, and a first one too many. */
    size_t word_count;
    const char *port;
    const char *output;
    const char *stats;
    format_t format;
    unsigned max_samples;
    unsigned count;
    unsigned seconds;
    unsigned scan;
    bool all;
    bool timed;
    bool quiet;
    bool help;
    bool version;
    char given[32]; /* The options' letters. */
} options_t;

typedef struct {
    const char *name;
    const char *usage;   /* What follows the name. */
    const char *summary; /* One line. */
    const char *details; /* More lines, for --help; NULL: none. */
    const char *accepts; /* The letters of its options, see options.c; all have help and version. */
    bool has_operand;
    int (*run)(const options_t *options);
} command_t;

/* Reads all words, in any order. Returns STATUS_OK, or STATUS_USAGE and says why. */
int options_parse(options_t *options, int argc, char **argv);

/* Whether the command takes what was given: returns STATUS_OK, or STATUS_USAGE and says what not.
 * */
int options_check(const options_t *options, const command_t *command);

/* Prints the usage of a command and its options. */
void options_help(const command_t *command);

/* Each in a file of its own, or beside its relatives. */
extern const command_t command_ports, command_check, command_info, command_health,
    command_frequency, command_reboot, command_scan, command_record, command_decode, command_plot,
    command_view;

#endif
