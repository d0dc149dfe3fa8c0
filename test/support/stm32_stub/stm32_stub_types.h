/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of the STM32 HAL's interface that the port and its example touch: names, types and values as
 * the HAL documents them; nothing behind them. Made for the tests. */

#ifndef STM32_STUB_TYPES_H
#define STM32_STUB_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    HAL_OK = 0x00,
    HAL_ERROR = 0x01,
    HAL_BUSY = 0x02,
    HAL_TIMEOUT = 0x03,
} HAL_StatusTypeDef;

typedef enum {
    HAL_UART_STATE_RESET = 0x00,
    HAL_UART_STATE_READY = 0x20,
    HAL_UART_STATE_BUSY_TX = 0x21,
    HAL_UART_STATE_BUSY_RX = 0x22,
} HAL_UART_StateTypeDef;

#define HAL_UART_ERROR_NONE 0x00000000u
#define HAL_UART_ERROR_PE 0x00000001u
#define HAL_UART_ERROR_NE 0x00000002u
#define HAL_UART_ERROR_FE 0x00000004u
#define HAL_UART_ERROR_ORE 0x00000008u
#define HAL_UART_ERROR_DMA 0x00000010u

#define DMA_NORMAL 0x00000000u
#define DMA_CIRCULAR 0x00000100u

typedef struct {
    volatile uint32_t NDTR; /* Transfers left in this round. */
} DMA_Stream_TypeDef;

typedef struct {
    uint32_t Mode;
} DMA_InitTypeDef;

typedef struct {
    DMA_Stream_TypeDef *Instance;
    DMA_InitTypeDef Init;
#ifdef STM32_STUB_LINKED_LISTS
#define DMA_LINKEDLIST_CIRCULAR 0x0081u
    uint32_t Mode;
#endif
} DMA_HandleTypeDef;

typedef struct {
    uint16_t RxXferSize;
    volatile uint16_t RxXferCount;
    DMA_HandleTypeDef *hdmarx;
    volatile HAL_UART_StateTypeDef gState;
    volatile HAL_UART_StateTypeDef RxState;
    volatile uint32_t ErrorCode;
} UART_HandleTypeDef;

typedef struct {
    uint32_t unused;
} GPIO_TypeDef;

typedef enum { GPIO_PIN_RESET, GPIO_PIN_SET } GPIO_PinState;

extern GPIO_TypeDef stm32_stub_gpiob;
#define GPIOB (&stm32_stub_gpiob)
#define GPIO_PIN_0 ((uint16_t)0x0001)

#define __ALIGNED(alignment) __attribute__((aligned(alignment)))

/* The HAL says uint8_t; the name tells the mocks that it is the address that counts. */
typedef uint8_t hal_memory_t;

/* Whether interrupts are held back; and whether they ever were not while DMA's counter was read. */
extern bool stm32_stub_is_masked;
extern bool stm32_stub_was_read_unmasked;

static inline uint32_t stm32_stub_dma_counter(const DMA_HandleTypeDef *dma)
{
    stm32_stub_was_read_unmasked = stm32_stub_was_read_unmasked || !stm32_stub_is_masked;
    return dma->Instance->NDTR;
}

#define __HAL_DMA_GET_COUNTER(handle) stm32_stub_dma_counter(handle)

static inline uint32_t __get_PRIMASK(void)
{
    return stm32_stub_is_masked;
}

static inline void __set_PRIMASK(uint32_t primask)
{
    stm32_stub_is_masked = primask != 0;
}

static inline void __disable_irq(void)
{
    stm32_stub_is_masked = true;
}

#endif
