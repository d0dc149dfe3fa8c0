/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the code in port/stm32/README.md needs: a CubeMX project, CMSIS, LL drivers and an RTOS.
 * ST's functions and constants are declared as documented, but the constants have no values. */

#ifndef STM32_PRELUDE_H
#define STM32_PRELUDE_H

#include "FreeRTOS.h"
#include "board.h"
#include "main.h"
#include "task.h"
#include "tmini_stm32_hal.h"
#include "tmini_stm32_usart.h"

extern tmini_t lidar;
extern const tmini_config_t config;
extern UART_HandleTypeDef huart1;

#ifdef TWO_LIDARS
extern tmini_stm32_hal_t left_port;
extern tmini_stm32_hal_t right_port;
#endif

#ifdef RTOS
extern tmini_stm32_hal_t port;
extern TaskHandle_t lidar_task;
void vTaskNotifyGiveFromISR(TaskHandle_t task, BaseType_t *woken);
uint32_t ulTaskNotifyTake(BaseType_t clear, TickType_t ticks);
int osDelay(uint32_t ticks); /* CMSIS-RTOS2 */
#endif

#ifdef REGISTERS
extern uint8_t rx[1024];

typedef struct {
    volatile uint32_t CR;
    volatile uint32_t NDTR;
} DMA_Stream_TypeDef;

typedef struct {
    volatile uint32_t LISR;
} DMA_TypeDef;

#ifdef BY_DMA
extern tmini_stm32_usart_t port;
#endif

extern DMA_TypeDef *const DMA2;
extern DMA_Stream_TypeDef *const DMA2_Stream2;

extern const uint32_t LL_AHB1_GRP1_PERIPH_DMA2, LL_DMA_STREAM_2, LL_DMA_CHANNEL_4,
    LL_DMA_DIRECTION_PERIPH_TO_MEMORY, LL_DMA_MODE_CIRCULAR, LL_DMA_MEMORY_INCREMENT,
    LL_DMA_PDATAALIGN_BYTE, LL_DMA_MDATAALIGN_BYTE;

void LL_AHB1_GRP1_EnableClock(uint32_t periphs);
typedef void ll_dma_switch_t(DMA_TypeDef *dma, uint32_t stream);
ll_dma_switch_t LL_DMA_DisableFifoMode, LL_DMA_EnableIT_HT, LL_DMA_EnableIT_TC, LL_DMA_EnableStream;
typedef void ll_dma_set_t(DMA_TypeDef *dma, uint32_t stream, uint32_t value);
ll_dma_set_t LL_DMA_SetChannelSelection, LL_DMA_ConfigTransfer, LL_DMA_SetPeriphAddress,
    LL_DMA_SetMemoryAddress, LL_DMA_SetDataLength;
uint32_t LL_DMA_IsActiveFlag_HT2(const DMA_TypeDef *dma);
uint32_t LL_DMA_IsActiveFlag_TC2(const DMA_TypeDef *dma);
void LL_DMA_ClearFlag_HT2(DMA_TypeDef *dma);
void LL_DMA_ClearFlag_TC2(DMA_TypeDef *dma);
#endif

#ifdef H7
void __HAL_RCC_D2SRAM1_CLK_ENABLE(void); /* A macro in ST's HAL. */
#endif

#endif
