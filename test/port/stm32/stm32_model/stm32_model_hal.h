/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of the STM32 HAL's interface that the port and its example use: names, types and values
 * as ST documents them. stm32_model.h lists the variants. */

#ifndef STM32_MODEL_HAL_H
#define STM32_MODEL_HAL_H

#include "stm32_model.h"

#ifndef STM32_MODEL_YEAR
#define STM32_MODEL_YEAR 2025
#endif

#define __ALIGNED(alignment) __attribute__((aligned(alignment)))

typedef enum { HAL_OK, HAL_ERROR, HAL_BUSY } HAL_StatusTypeDef;

typedef enum {
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

#define UART_WORDLENGTH_8B 0x00000000u
#define UART_WORDLENGTH_9B 0x00001000u
#define UART_PARITY_NONE 0x00000000u
#define UART_PARITY_EVEN 0x00000400u

/* ---- DMA ---- */

#ifndef STM32_MODEL_NO_DMA

#define HAL_DMA_MODULE_ENABLED
#define DMA_NORMAL 0x00000000u
#define DMA_CIRCULAR 0x00000100u
#define DMA_PINC_DISABLE 0x00000000u
#define DMA_MINC_ENABLE 0x00000400u
#define DMA_PDATAALIGN_BYTE 0x00000000u
#define DMA_MDATAALIGN_BYTE 0x00000000u
#define DMA_MDATAALIGN_WORD 0x00004000u
#ifdef STM32_MODEL_STREAMS
#define DMA_FIFOMODE_DISABLE 0x00000000u
#define DMA_FIFOMODE_ENABLE 0x00000004u
#endif
#ifdef STM32_MODEL_LINKED_LISTS
#define DMA_LINKEDLIST_CIRCULAR 0x0081u
#define DMA_CTR1_SDW_LOG2 0x00000003u
#define DMA_CTR1_SINC 0x00000008u
#define DMA_CTR1_DDW_LOG2 0x00030000u
#define DMA_CTR1_DINC 0x00080000u
#define NODE_CTR1_DEFAULT_OFFSET 0u

typedef struct {
    uint32_t LinkRegisters[8];
} DMA_NodeTypeDef;

typedef struct {
    DMA_NodeTypeDef *Head;
} DMA_QListTypeDef;
#endif

typedef enum {
    HAL_DMA_STATE_READY,
    HAL_DMA_STATE_BUSY,
    HAL_DMA_STATE_ABORT,
    HAL_DMA_STATE_SUSPEND,
} model_dma_state_t;

typedef struct {
    DMA_Channel_TypeDef *Instance;
    struct {
        uint32_t Mode;
        uint32_t FIFOMode;
        uint32_t PeriphInc;
        uint32_t MemInc;
        uint32_t PeriphDataAlignment;
        uint32_t MemDataAlignment;
    } Init;
    uint32_t Mode; /* Used with linked lists. */
#ifdef STM32_MODEL_LINKED_LISTS
    DMA_QListTypeDef *LinkedListQueue;
#endif
    volatile model_dma_state_t State;
} DMA_HandleTypeDef;

#define __HAL_DMA_GET_COUNTER(handle) ((void)(handle), model_dma_left())

HAL_StatusTypeDef HAL_DMA_Abort(DMA_HandleTypeDef *hdma);
HAL_StatusTypeDef HAL_DMAEx_Resume(DMA_HandleTypeDef *hdma);
void HAL_DMA_IRQHandler(DMA_HandleTypeDef *hdma);

#endif

/* ---- UART ---- */

typedef struct {
    USART_TypeDef *Instance;
    struct {
        uint32_t BaudRate;
        uint32_t WordLength;
        uint32_t Parity;
    } Init;
    uint8_t *pRxBuffPtr;
    uint16_t RxXferSize;
    volatile uint16_t RxXferCount;
    const uint8_t *pTxBuffPtr;
    volatile uint16_t TxXferCount;
    volatile uint32_t ReceptionType;
    volatile uint32_t RxEventType;
#ifndef STM32_MODEL_NO_DMA
    DMA_HandleTypeDef *hdmarx;
#endif
    volatile bool Lock;
    volatile HAL_UART_StateTypeDef gState;
    volatile HAL_UART_StateTypeDef RxState;
    volatile uint32_t ErrorCode;
} UART_HandleTypeDef;

#define USART_CR3_EIE MODEL_CR3_EIE
#define USART_CR3_DMAR MODEL_CR3_DMAR
#define USART_CR1_PEIE MODEL_CR1_PEIE
#define UART_FLAG_RXNE MODEL_RXNE
#define UART_FLAG_ORE MODEL_ORE
#define UART_FLAG_NE MODEL_NE
#define UART_FLAG_FE MODEL_FE

#define __HAL_UART_GET_FLAG(handle, flag) ((void)(handle), (model_status() & (flag)) == (flag))
#define CLEAR_BIT(reg, bit) model_unset(&(reg), bit)

#ifdef STM32_MODEL_SR
#define __HAL_UART_CLEAR_OREFLAG(handle) \
    ((void)(handle), (void)model_status(), (void)model_read_data())
#else
#define UART_CLEAR_OREF MODEL_ORE
#define UART_CLEAR_NEF MODEL_NE
#define UART_CLEAR_FEF MODEL_FE
#define __HAL_UART_CLEAR_FLAG(handle, flag) ((void)(handle), model_clear(flag))
#define __HAL_UART_CLEAR_OREFLAG(handle) __HAL_UART_CLEAR_FLAG(handle, UART_CLEAR_OREF)
#endif

/* Reads, changes and writes the register without an interrupt in between. */
#if STM32_MODEL_YEAR >= 2021
#define ATOMIC_CLEAR_BIT(reg, bit) model_unset(&(reg), bit)
#define HAL_UART_RECEPTION_STANDARD 0x00000000u
#endif
#if STM32_MODEL_YEAR >= 2024
#define HAL_UART_RXEVENT_TC 0x00000000u
#define HAL_UART_RXEVENT_HT 0x00000001u
#define HAL_UART_RXEVENT_IDLE 0x00000002u
#endif

HAL_StatusTypeDef HAL_UART_Transmit_IT(UART_HandleTypeDef *huart, const uint8_t *pData,
                                       uint16_t Size);
HAL_StatusTypeDef HAL_UART_Receive_IT(UART_HandleTypeDef *huart, uint8_t *pData, uint16_t Size);
HAL_StatusTypeDef HAL_UART_Receive_DMA(UART_HandleTypeDef *huart, uint8_t *pData, uint16_t Size);
HAL_StatusTypeDef HAL_UARTEx_ReceiveToIdle_DMA(UART_HandleTypeDef *huart, uint8_t *pData,
                                               uint16_t Size);
HAL_StatusTypeDef HAL_UART_AbortReceive(UART_HandleTypeDef *huart);
void HAL_UART_IRQHandler(UART_HandleTypeDef *huart);

/* Called by the HAL; defined by the project. */
void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size);
void HAL_UART_RxHalfCpltCallback(UART_HandleTypeDef *huart);
void HAL_UART_RxCpltCallback(UART_HandleTypeDef *huart);
void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart);

/* ---- The rest ---- */

typedef struct {
    uint32_t unused;
} GPIO_TypeDef;

typedef enum { GPIO_PIN_RESET, GPIO_PIN_SET } GPIO_PinState;

extern GPIO_TypeDef stm32_model_gpiob;
#define GPIOB (&stm32_model_gpiob)
#define GPIO_PIN_0 ((uint16_t)0x0001)
#define GPIO_PIN_1 ((uint16_t)0x0002)

HAL_StatusTypeDef HAL_Init(void);
uint32_t HAL_GetTick(void);
void HAL_GPIO_WritePin(GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin, GPIO_PinState PinState);
void HAL_GPIO_TogglePin(GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin);
void Error_Handler(void);
void __WFI(void);

static inline uint32_t __get_PRIMASK(void)
{
    return irq.masked;
}

static inline void __set_PRIMASK(uint32_t primask)
{
    irq.masked = primask != 0;
    model_step();
}

static inline void __disable_irq(void)
{
    irq.masked = true;
}

/* Declared only for a Cortex-M7, which has a data cache. */
#ifdef STM32_MODEL_DCACHE
#define __DCACHE_PRESENT 1U
#endif
void SCB_InvalidateDCache_by_Addr(void *addr, int32_t dsize);
void SCB_CleanInvalidateDCache_by_Addr(void *addr, int32_t dsize);

#endif
