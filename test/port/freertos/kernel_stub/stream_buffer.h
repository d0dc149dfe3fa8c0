/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the FreeRTOS kernel's header of this name. */

#include "freertos_api.h"
