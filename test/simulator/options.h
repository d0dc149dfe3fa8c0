/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The command line of tmini-sim. */

#ifndef OPTIONS_H
#define OPTIONS_H

#include "bridge.h"
#include "link.h"

typedef struct {
    bool help;
    bool version;
    bool pty;
    int32_t tcp_port; /* 0: any free one; -1: none */
    bool lines;
    const char *write_path; /* in each path NULL means none, "-" standard output */
    const char *log_path;
    const char *truth_path;
    double seconds; /* of virtual time; 0: without end */
    double speed;   /* virtual seconds per real second */
    bool blocked;   /* the rotor is held */
    bool covered;   /* the window is covered */
    uint8_t health; /* faults that the device reports: SIM_HEALTH_... */
    sim_config_t device;
    sim_link_config_t link;
    bridge_config_t bridge;
    int32_t boot_ms; /* it gets power only when the port is opened first; -1: at once */
} options_t;

/* If the arguments are wrong, prints what to do on standard error and returns false. */
bool options_parse(options_t *options, int argc, char **argv);

void options_print_help(void);
void options_print_version(void);

#endif
