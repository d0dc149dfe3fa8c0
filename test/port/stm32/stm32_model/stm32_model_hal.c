/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "usart.h"

#ifndef HAL_UART_RECEPTION_STANDARD
#define HAL_UART_RECEPTION_STANDARD 0u
#endif
#define TO_IDLE 1u
#define EVENT_TC 0u
#define EVENT_HT 1u
#define EVENT_IDLE 2u
#define ERRORS (MODEL_FE | MODEL_NE | MODEL_ORE)

/* The two kinds of USART clear the idle flag in different ways. */
static void clear_idle(void)
{
#ifdef STM32_MODEL_SR
    (void)model_status();
    (void)model_read_data();
#else
    model_clear(MODEL_IDLE);
#endif
}

/* In HALs before 2022, a function locks the handle while it runs, and other calls are refused. */
static bool lock(UART_HandleTypeDef *uart)
{
    if (STM32_MODEL_YEAR > 2021) {
        return true;
    }
    if (uart->Lock) {
        return false;
    }
    uart->Lock = true;
    model_step();
    return true;
}

static void unlock(UART_HandleTypeDef *uart)
{
    if (STM32_MODEL_YEAR <= 2021) {
        uart->Lock = false;
    }
}

/* --------------------------------------------------------------------------------------- events */

#ifndef STM32_MODEL_NO_DMA

static bool is_circular(const DMA_HandleTypeDef *dma)
{
#ifdef STM32_MODEL_LINKED_LISTS
    return dma->Mode == DMA_LINKEDLIST_CIRCULAR;
#else
    return dma->Init.Mode == DMA_CIRCULAR;
#endif
}

static void report(UART_HandleTypeDef *uart, uint32_t type, uint16_t size)
{
    uart->RxEventType = type;
    model_step();
    if (uart->ReceptionType == TO_IDLE) {
        HAL_UARTEx_RxEventCallback(uart, size);
    } else if (type == EVENT_HT) {
        HAL_UART_RxHalfCpltCallback(uart);
    } else {
        HAL_UART_RxCpltCallback(uart);
    }
}

/* Since 2025 the reported size is DMA's real position. */
static uint16_t reported_size(const UART_HandleTypeDef *uart, uint16_t nominal)
{
    if (STM32_MODEL_YEAR < 2025) {
        return nominal;
    }
    const uint32_t left = model_dma_left();
    return (uint16_t)(left < uart->RxXferSize ? uart->RxXferSize - left : uart->RxXferSize);
}

static void idle_with_dma(UART_HandleTypeDef *uart)
{
    const uint32_t left = model_dma_left();
    if (left > 0 && left < uart->RxXferSize) {
        report(uart, EVENT_IDLE, (uint16_t)(uart->RxXferSize - left));
    } else if (left == uart->RxXferSize && STM32_MODEL_YEAR >= 2024 && is_circular(uart->hdmarx)) {
        report(uart, EVENT_IDLE, uart->RxXferSize);
    }
}

/* ------------------------------------------------------------------------------------------ DMA */

/* With linked lists, the channel finishes its current block before it reads the list of the
 * start. */
static uint32_t first_round(uint16_t size)
{
#ifdef STM32_MODEL_LINKED_LISTS
    const uint32_t left = model.dma.channel.CBR1;
    return left > 0 ? left : size;
#else
    return size;
#endif
}

static bool dma_start(UART_HandleTypeDef *uart, uint8_t *memory, uint16_t size)
{
    DMA_HandleTypeDef *const dma = uart->hdmarx;
    if (dma->State != HAL_DMA_STATE_READY) {
        return false;
    }
    dma->State = HAL_DMA_STATE_BUSY;
    model_step();
    const uint32_t left = first_round(size);
    model.dma = (model_dma_t){.circular = is_circular(dma), .memory = memory, .size = size};
    model.dma.channel.CBR1 = left;
    model_step();
    model.dma.interrupts = MODEL_DMA_HT | MODEL_DMA_TC | MODEL_DMA_TE;
    model.dma.enabled = true;
    model_step();
    return true;
}

/* Stops DMA as an error does: the count of bytes left in the block stays. */
static void dma_stop(DMA_HandleTypeDef *dma)
{
    model.dma.enabled = false;
    model.dma.interrupts = 0;
    model.dma.flags = 0;
    model_step();
    dma->State = HAL_DMA_STATE_READY;
}

HAL_StatusTypeDef HAL_DMA_Abort(DMA_HandleTypeDef *hdma)
{
    if (hdma->State != HAL_DMA_STATE_BUSY) {
        return HAL_ERROR;
    }
    dma_stop(hdma);
    model.dma.channel.CBR1 = 0;
    return HAL_OK;
}

HAL_StatusTypeDef HAL_DMAEx_Resume(DMA_HandleTypeDef *hdma)
{
    if (hdma->State != HAL_DMA_STATE_SUSPEND) {
        return HAL_ERROR;
    }
    model.dma.enabled = true;
    hdma->State = HAL_DMA_STATE_BUSY;
    return HAL_OK;
}

static void end_reception(UART_HandleTypeDef *uart);

static void dma_failed(UART_HandleTypeDef *uart)
{
    dma_stop(uart->hdmarx);
    if (uart->RxState == HAL_UART_STATE_BUSY_RX) {
        end_reception(uart);
    }
    uart->ErrorCode |= HAL_UART_ERROR_DMA;
    HAL_UART_ErrorCallback(uart);
}

static void dma_half(UART_HandleTypeDef *uart)
{
    model.dma.flags &= ~MODEL_DMA_HT;
    model_step();
    report(uart, EVENT_HT, reported_size(uart, uart->RxXferSize / 2));
}

static void dma_complete(UART_HandleTypeDef *uart)
{
    model.dma.flags &= ~MODEL_DMA_TC;
    model_step();
    report(uart, EVENT_TC, reported_size(uart, uart->RxXferSize));
}

void HAL_DMA_IRQHandler(DMA_HandleTypeDef *hdma)
{
    (void)hdma;
    model_step();
    const uint32_t flags = model.dma.flags & model.dma.interrupts;
    if ((flags & MODEL_DMA_TE) != 0) {
        dma_failed(&huart1);
        return;
    }
    if ((flags & MODEL_DMA_HT) != 0) {
        dma_half(&huart1);
    }
    if ((flags & MODEL_DMA_TC) != 0) {
        dma_complete(&huart1);
    }
}

#endif

/* ----------------------------------------------------------------------------- starting, ending */

static void disable_interrupts(const UART_HandleTypeDef *uart)
{
    model_unset(&model_usart.CR1, MODEL_CR1_RXNEIE | MODEL_CR1_PEIE);
    model_unset(&model_usart.CR3, MODEL_CR3_EIE);
    if (uart->ReceptionType == TO_IDLE) {
        model_unset(&model_usart.CR1, MODEL_CR1_IDLEIE);
    }
}

static void end_reception(UART_HandleTypeDef *uart)
{
    disable_interrupts(uart);
    uart->RxState = HAL_UART_STATE_READY;
    uart->ReceptionType = HAL_UART_RECEPTION_STANDARD;
}

static void prepare(UART_HandleTypeDef *uart, uint8_t *memory, uint16_t size)
{
    uart->pRxBuffPtr = memory;
    uart->RxXferSize = size;
    uart->RxXferCount = size;
    uart->ErrorCode = HAL_UART_ERROR_NONE;
    uart->RxState = HAL_UART_STATE_BUSY_RX;
    model_step();
}

static HAL_StatusTypeDef start_interrupt(UART_HandleTypeDef *uart, uint8_t *memory, uint16_t size)
{
    prepare(uart, memory, size);
    unlock(uart);
    model_set(&model_usart.CR3, MODEL_CR3_EIE);
    model_set(&model_usart.CR1, MODEL_CR1_RXNEIE);
    return HAL_OK;
}

static bool may_start(UART_HandleTypeDef *uart)
{
    model_step();
    return uart->RxState == HAL_UART_STATE_READY && lock(uart);
}

/* A function that starts a reception of this type in this way. */
#define RECEPTION(function, type, start)                                                 \
    HAL_StatusTypeDef function(UART_HandleTypeDef *huart, uint8_t *pData, uint16_t Size) \
    {                                                                                    \
        if (!may_start(huart)) {                                                         \
            return HAL_BUSY;                                                             \
        }                                                                                \
        huart->ReceptionType = type;                                                     \
        return start;                                                                    \
    }

RECEPTION(HAL_UART_Receive_IT, HAL_UART_RECEPTION_STANDARD, start_interrupt(huart, pData, Size))

#ifndef STM32_MODEL_NO_DMA

/* EIE is set before DMAR: a pending error interrupts in between, while DMAR is still off. */
static HAL_StatusTypeDef start_dma(UART_HandleTypeDef *uart, uint8_t *memory, uint16_t size)
{
    prepare(uart, memory, size);
    if (!dma_start(uart, memory, size)) {
        uart->ErrorCode = HAL_UART_ERROR_DMA;
        uart->RxState = HAL_UART_STATE_READY;
        unlock(uart);
        return HAL_ERROR;
    }
#ifdef STM32_MODEL_SR
    (void)model_status();
    (void)model_read_data();
#endif
    unlock(uart);
    if (STM32_MODEL_YEAR <= 2021) { /* Even without parity. */
        model_set(&model_usart.CR1, MODEL_CR1_PEIE);
    }
    model_set(&model_usart.CR3, MODEL_CR3_EIE);
    model_set(&model_usart.CR3, MODEL_CR3_DMAR);
    return HAL_OK;
}

/* Enables the idle line's interrupt, unless an error has already ended the reception. */
static HAL_StatusTypeDef await_idle(UART_HandleTypeDef *uart, HAL_StatusTypeDef status)
{
    if (uart->ReceptionType != TO_IDLE) {
        return HAL_ERROR;
    }
    clear_idle();
    model_set(&model_usart.CR1, MODEL_CR1_IDLEIE);
    return status;
}

RECEPTION(HAL_UART_Receive_DMA, HAL_UART_RECEPTION_STANDARD, start_dma(huart, pData, Size))
RECEPTION(HAL_UARTEx_ReceiveToIdle_DMA, TO_IDLE, await_idle(huart, start_dma(huart, pData, Size)))

#endif

HAL_StatusTypeDef HAL_UART_AbortReceive(UART_HandleTypeDef *huart)
{
    disable_interrupts(huart);
#ifndef STM32_MODEL_NO_DMA
    if ((model_usart.CR3 & MODEL_CR3_DMAR) != 0) {
        model_unset(&model_usart.CR3, MODEL_CR3_DMAR);
        if (huart->hdmarx != NULL) {
            (void)HAL_DMA_Abort(huart->hdmarx);
        }
    }
#endif
#ifndef STM32_MODEL_SR
    model_clear(ERRORS);
    (void)model_read_data();
#endif
    huart->RxXferCount = 0;
    huart->RxState = HAL_UART_STATE_READY;
    huart->ReceptionType = HAL_UART_RECEPTION_STANDARD;
    return HAL_OK;
}

/* ------------------------------------------------------------------------------------ interrupt */

static void receive_byte(UART_HandleTypeDef *uart)
{
    if (uart->RxState != HAL_UART_STATE_BUSY_RX) {
        return;
    }
    *uart->pRxBuffPtr++ = model_read_data();
    uart->RxXferCount--;
    if (uart->RxXferCount > 0) {
        return;
    }
    disable_interrupts(uart);
    uart->RxState = HAL_UART_STATE_READY;
    HAL_UART_RxCpltCallback(uart);
}

static void note_errors(UART_HandleTypeDef *uart, uint32_t flags, uint32_t cr1, uint32_t cr3)
{
    const bool eie = (cr3 & MODEL_CR3_EIE) != 0;
    uint32_t noted = eie ? flags & (MODEL_FE | MODEL_NE) : 0;
    if (eie || (cr1 & MODEL_CR1_RXNEIE) != 0) {
        noted |= flags & MODEL_ORE;
    }
    uart->ErrorCode |= (noted & MODEL_FE) != 0 ? HAL_UART_ERROR_FE : 0;
    uart->ErrorCode |= (noted & MODEL_NE) != 0 ? HAL_UART_ERROR_NE : 0;
    uart->ErrorCode |= (noted & MODEL_ORE) != 0 ? HAL_UART_ERROR_ORE : 0;
#ifndef STM32_MODEL_SR
    model_clear(noted);
#endif
}

/* Ends a reception after an error. */
static void break_off(UART_HandleTypeDef *uart)
{
    end_reception(uart);
#ifndef STM32_MODEL_NO_DMA
    if ((model_usart.CR3 & MODEL_CR3_DMAR) != 0) {
        model_unset(&model_usart.CR3, MODEL_CR3_DMAR);
        (void)HAL_DMA_Abort(uart->hdmarx);
    }
#endif
    HAL_UART_ErrorCallback(uart);
}

static void handle_errors(UART_HandleTypeDef *uart, uint32_t flags, uint32_t cr1, uint32_t cr3)
{
    note_errors(uart, flags, cr1, cr3);
    if (uart->ErrorCode == HAL_UART_ERROR_NONE) {
        return;
    }
    if ((flags & MODEL_RXNE) != 0 && (cr1 & MODEL_CR1_RXNEIE) != 0) {
        receive_byte(uart);
    }
    if ((uart->ErrorCode & HAL_UART_ERROR_ORE) != 0 || (model_usart.CR3 & MODEL_CR3_DMAR) != 0) {
        break_off(uart);
    } else {
        HAL_UART_ErrorCallback(uart);
        uart->ErrorCode = HAL_UART_ERROR_NONE;
    }
}

/* The port waits for it only with DMA. */
static void handle_idle(UART_HandleTypeDef *uart)
{
    clear_idle();
#ifndef STM32_MODEL_NO_DMA
    if ((model_usart.CR3 & MODEL_CR3_DMAR) != 0) {
        idle_with_dma(uart);
    }
#else
    (void)uart;
#endif
}

static void transmit_next(UART_HandleTypeDef *uart)
{
    model_write_data(*uart->pTxBuffPtr++);
    uart->TxXferCount--;
    if (uart->TxXferCount == 0) {
        model_unset(&model_usart.CR1, MODEL_CR1_TXEIE);
        uart->gState = HAL_UART_STATE_READY;
    }
}

void HAL_UART_IRQHandler(UART_HandleTypeDef *huart)
{
    const uint32_t flags = model_status();
    const uint32_t cr1 = model_usart.CR1;
    const uint32_t cr3 = model_usart.CR3;
    const bool errors_wanted =
        (cr3 & MODEL_CR3_EIE) != 0 || (cr1 & (MODEL_CR1_RXNEIE | MODEL_CR1_PEIE)) != 0;
    if ((flags & ERRORS) != 0 && errors_wanted) {
        handle_errors(huart, flags, cr1, cr3);
    } else if ((flags & MODEL_RXNE) != 0 && (cr1 & MODEL_CR1_RXNEIE) != 0) {
        receive_byte(huart);
    } else if (huart->ReceptionType == TO_IDLE && (flags & MODEL_IDLE) != 0 &&
               (cr1 & MODEL_CR1_IDLEIE) != 0) {
        handle_idle(huart);
    } else if ((flags & MODEL_TXE) != 0 && (cr1 & MODEL_CR1_TXEIE) != 0) {
        transmit_next(huart);
    }
}

/* -------------------------------------------------------------------------------------- sending */

HAL_StatusTypeDef HAL_UART_Transmit_IT(UART_HandleTypeDef *huart, const uint8_t *pData,
                                       uint16_t Size)
{
    if (huart->gState != HAL_UART_STATE_READY || !lock(huart)) {
        return HAL_BUSY;
    }
    huart->pTxBuffPtr = pData;
    huart->TxXferCount = Size;
    huart->gState = HAL_UART_STATE_BUSY_TX;
    model_step();
    unlock(huart);
    model_set(&model_usart.CR1, MODEL_CR1_TXEIE);
    return HAL_OK;
}

uint32_t HAL_GetTick(void)
{
    return model.tick_ms;
}

/* ------------------------------------------------------------------------ what CubeMX generates */

UART_HandleTypeDef huart1;

#ifdef HAL_DMA_MODULE_ENABLED

DMA_HandleTypeDef hdma_usart1_rx;
#ifdef DMA_LINKEDLIST_CIRCULAR
DMA_NodeTypeDef Node_GPDMA1_Channel0;
DMA_QListTypeDef List_GPDMA1_Channel0;
#endif

static void dma_interrupt(void)
{
    HAL_DMA_IRQHandler(&hdma_usart1_rx);
}

static void init_dma(void)
{
    hdma_usart1_rx = (DMA_HandleTypeDef){
        .Instance = &model.dma.channel, .Init.Mode = DMA_CIRCULAR, .Init.MemInc = DMA_MINC_ENABLE};
#ifdef DMA_LINKEDLIST_CIRCULAR
    Node_GPDMA1_Channel0.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET] = DMA_CTR1_DINC;
    List_GPDMA1_Channel0.Head = &Node_GPDMA1_Channel0;
    hdma_usart1_rx.Mode = DMA_LINKEDLIST_CIRCULAR;
    hdma_usart1_rx.LinkedListQueue = &List_GPDMA1_Channel0;
#endif
    huart1.hdmarx = &hdma_usart1_rx;
    irq.lines[MODEL_DMA_IRQ].handler = dma_interrupt;
}

#else

static void init_dma(void) {}

#endif

static void usart_interrupt(void)
{
    HAL_UART_IRQHandler(&huart1);
}

void MX_USART1_UART_Init(void)
{
    huart1 = (UART_HandleTypeDef){
        .Instance = &model_usart,
        .Init = {.BaudRate = 230400, .WordLength = UART_WORDLENGTH_8B, .Parity = UART_PARITY_NONE},
        .gState = HAL_UART_STATE_READY,
        .RxState = HAL_UART_STATE_READY,
    };
    irq.lines[MODEL_USART_IRQ].handler = usart_interrupt;
    init_dma();
}

/* ----------------------------------------------------------------------------------- data cache */

#ifdef STM32_MODEL_DCACHE

#define LINE 32u

/* Copies the cache lines that contain these bytes, up to the buffer's end. */
static void between_cache_and_memory(uint8_t *addr, int32_t count, bool to_memory)
{
    const size_t first = (size_t)(addr - model.cached) / LINE * LINE;
    const size_t end = ((size_t)(addr - model.cached) + (size_t)count + LINE - 1) / LINE * LINE;
    for (size_t i = first; i < end && i < model.cached_size; i++) {
        if (to_memory) {
            model.ram[i] = model.cached[i];
        } else {
            model.cached[i] = model.ram[i];
        }
    }
}

void SCB_InvalidateDCache_by_Addr(void *addr, int32_t dsize)
{
    between_cache_and_memory(addr, dsize, false);
}

void SCB_CleanInvalidateDCache_by_Addr(void *addr, int32_t dsize)
{
    between_cache_and_memory(addr, dsize, true);
}

#endif
