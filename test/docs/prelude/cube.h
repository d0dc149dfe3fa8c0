/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the code in examples/stm32_cube/README.md needs: a CubeMX project with a console. */

#include "board.h"
#include "main.h"

extern UART_HandleTypeDef huart2;
HAL_StatusTypeDef HAL_UART_Transmit(UART_HandleTypeDef *huart, const uint8_t *pData, uint16_t Size,
                                    uint32_t Timeout);
