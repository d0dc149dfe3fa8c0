/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for Zephyr's header of this name. */

#include "zephyr_api.h"
