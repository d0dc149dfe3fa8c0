/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The tool's commands: each in a file of its own, each returning the status to leave with. */

#ifndef COMMANDS_H
#define COMMANDS_H

#include "options.h"

extern const command_t command_decode;
extern const command_t command_plot;

#endif
