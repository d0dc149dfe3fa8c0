/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the usart.h that CubeMX generates. */

#ifndef USART_H
#define USART_H

#include "main.h"

extern UART_HandleTypeDef huart1;

void MX_USART1_UART_Init(void);

#endif
