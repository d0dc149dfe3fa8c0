/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The command line: which command, its options, and the port. */

#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini_mount.h"

#define OPTIONS_WORDS 3u
#define OPTIONS_MASKS 8u

/* All options of all commands; 0 or NULL: not given. */
typedef struct {
    const char *command;
    const char *operand; /* The word after the command: a file, a frequency or a command. */
    const char *words[OPTIONS_WORDS]; /* These two, and the first excess word. */
    size_t word_count;
    const char *port;
    const char *output;
    const char *stats;
    unsigned max_samples;
    unsigned count;
    unsigned seconds;
    unsigned scan;
    bool csv; /* Neither of these: text for people. */
    bool json;
    bool all;
    bool timed;
    bool wait;
    bool listen;
    bool with_serial;
    bool ask;
    bool force;
    tmini_mount_t mount;
    tmini_arc_t masked[OPTIONS_MASKS]; /* The arcs of the mount. */
    bool quiet;
    bool help;
    bool version;
    char given[32]; /* The letters of the options given. */
} options_t;

struct device;

typedef struct {
    const char *name;
    const char *usage;   /* The words after the name. */
    const char *summary; /* One line. */
    const char *details; /* More lines, for --help; NULL: none. */
    const char *accepts; /* The letters of its options (main.c); all commands have help and
                          * version. */
    bool has_operand;
    int (*run)(const options_t *options); /* If null, `use` runs with the lidar on the port: */
    int (*use)(struct device *device, const options_t *options);
} command_t;

/* The port that the options name, otherwise TMINI_PORT of the environment, otherwise the only
 * adapter. If there is no such port, prints the reason and returns NULL. Valid until the next
 * call. */
const char *ports_choose(const options_t *options);

/* A name that the adapter on this port keeps when it is plugged in again, or `path` itself. Valid
 * until the next call of either function. */
const char *ports_stable_name(const char *path);

/* Each command, or group of similar commands, has its own file. */
extern const command_t command_ports, command_check, command_info, command_health,
    command_frequency, command_reboot, command_scan, command_record, command_decode, command_plot,
    command_survey, command_calibrate, command_view;

#endif
