/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for CubeMX's main.h: the HAL, and the pins with the labels DRIVE_ENABLE and
 * LIDAR_LED. */

#ifndef MAIN_H
#define MAIN_H

#include "stm32_model_hal.h"

#define DRIVE_ENABLE_GPIO_Port GPIOB
#define DRIVE_ENABLE_Pin GPIO_PIN_0
#define LIDAR_LED_GPIO_Port GPIOB
#define LIDAR_LED_Pin GPIO_PIN_1

#endif
