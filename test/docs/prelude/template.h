/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What port/README.md takes for granted. */

#include "board.h"
#include "tmini_port_template.h"

extern void *const uart;
