/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The tool's commands: each in a file of its own, each returning the status to leave with. */

#ifndef COMMANDS_H
#define COMMANDS_H

#include "options.h"

extern const command_t command_info;
extern const command_t command_health;
extern const command_t command_frequency;
extern const command_t command_reboot;
extern const command_t command_scan;
extern const command_t command_record;
extern const command_t command_decode;
extern const command_t command_plot;
extern const command_t command_view;

#endif
