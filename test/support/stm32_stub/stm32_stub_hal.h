/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The functions of the HAL and of CMSIS that the port calls: prototypes, to be mocked. */

#ifndef STM32_STUB_HAL_H
#define STM32_STUB_HAL_H

#include "stm32_stub_types.h"

HAL_StatusTypeDef HAL_UART_Receive_IT(UART_HandleTypeDef *huart, hal_memory_t *pData,
                                      uint16_t Size);
HAL_StatusTypeDef HAL_UARTEx_ReceiveToIdle_IT(UART_HandleTypeDef *huart, hal_memory_t *pData,
                                              uint16_t Size);
HAL_StatusTypeDef HAL_UARTEx_ReceiveToIdle_DMA(UART_HandleTypeDef *huart, hal_memory_t *pData,
                                               uint16_t Size);
HAL_StatusTypeDef HAL_UART_Transmit_IT(UART_HandleTypeDef *huart, const uint8_t *pData,
                                       uint16_t Size);
HAL_StatusTypeDef HAL_Init(void);
uint32_t HAL_GetTick(void);
void HAL_GPIO_WritePin(GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin, GPIO_PinState PinState);
void Error_Handler(void);
void __WFI(void);

/* Only there, as the macro says, on a Cortex-M7. */
#ifdef STM32_STUB_DCACHE
#define __DCACHE_PRESENT 1U
#endif
void SCB_InvalidateDCache_by_Addr(void *addr, int32_t dsize);
void SCB_CleanInvalidateDCache_by_Addr(void *addr, int32_t dsize);

#endif
