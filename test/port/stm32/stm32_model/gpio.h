/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the gpio.h that CubeMX generates. */

#ifndef GPIO_H
#define GPIO_H

void MX_GPIO_Init(void);

#endif
