/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the Pico SDK's header of this name. */

#include "pico_sdk.h"
