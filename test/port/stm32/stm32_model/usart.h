/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the usart.h that CubeMX generates: the lidar's UART, set up as the port needs it,
 * with the handlers of its interrupts. */

#ifndef USART_H
#define USART_H

#include "main.h"

extern UART_HandleTypeDef huart1;
#ifdef HAL_DMA_MODULE_ENABLED
extern DMA_HandleTypeDef hdma_usart1_rx;
#endif
#ifdef DMA_LINKEDLIST_CIRCULAR
extern DMA_NodeTypeDef Node_GPDMA1_Channel0;
extern DMA_QListTypeDef List_GPDMA1_Channel0;
#endif

void MX_USART1_UART_Init(void);

#endif
