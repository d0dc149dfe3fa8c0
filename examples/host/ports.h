/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Which port is the lidar on? */

#ifndef PORTS_H
#define PORTS_H

#include "options.h"

/* The port of the options, or else of the environment's TMINI_PORT, or else the only adapter that
 * there is. NULL, and said why, if that does not tell. Valid until the next call. */
const char *ports_choose(const options_t *options);

#endif
