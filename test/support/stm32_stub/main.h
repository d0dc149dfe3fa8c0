/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands for the main.h that CubeMX writes into every project: brings the (stub) HAL, and names a pin that
 * was labelled DRIVE_ENABLE. */

#ifndef MAIN_H
#define MAIN_H

#include "stm32_stub_hal.h"

/* What the HAL calls and a project may define. */
void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size);
void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart);

#define DRIVE_ENABLE_GPIO_Port GPIOB
#define DRIVE_ENABLE_Pin GPIO_PIN_0

#endif
