/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands for the main.h that CubeMX writes into every project: brings the (stub) HAL. */

#ifndef MAIN_H
#define MAIN_H

#include "stm32_stub_hal.h"

#endif
