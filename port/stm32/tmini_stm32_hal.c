/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_stm32_hal.h"

enum reception { RECEPTION_NONE, RECEPTION_DMA, RECEPTION_BLOCKS, RECEPTION_BYTES };

/* Pause between two attempts to start a reception that fails. */
#define RESTART_PAUSE_MS 3u

#define BLOCK_SIZE_MIN 64u

/* ------------------------------------------------------------------- what differs by family */

/* Data cache (Cortex-M7): it does not see what DMA writes. */
#if defined(__DCACHE_PRESENT) && (__DCACHE_PRESENT == 1U)

#define CACHE_LINE 32u

static bool is_aligned(const void *buffer, size_t size)
{
    return (uintptr_t)buffer % CACHE_LINE == 0 && size % CACHE_LINE == 0;
}

/* Invalidates whole cache lines, from the one that contains `from`. The CPU writes to none of them
 * while DMA runs, so nothing is lost. */
static void read_anew(uint8_t *buffer, size_t from, size_t to)
{
    const size_t first = from / CACHE_LINE * CACHE_LINE;
    SCB_InvalidateDCache_by_Addr((void *)&buffer[first], (int32_t)(to - first));
}

/* The cache must not write old data over new bytes from DMA later. */
static void write_through(uint8_t *buffer, size_t size)
{
    SCB_CleanInvalidateDCache_by_Addr((void *)buffer, (int32_t)size);
}

#else

static bool is_aligned(const void *buffer, size_t size)
{
    (void)buffer;
    (void)size;
    return true;
}

static void read_anew(const uint8_t *buffer, size_t from, size_t to)
{
    (void)buffer;
    (void)from;
    (void)to;
}

static void write_through(const uint8_t *buffer, size_t size)
{
    (void)buffer;
    (void)size;
}

#endif

/* Changes a bit of a register that the HAL's interrupts change as well. HALs before 2021 cannot do
 * this atomically and take the small risk themselves. */
#ifdef ATOMIC_CLEAR_BIT
#define CLEAR_SHARED_BIT(reg, bit) ATOMIC_CLEAR_BIT(reg, bit)
#else
#define CLEAR_SHARED_BIT(reg, bit) CLEAR_BIT(reg, bit)
#endif

#ifdef HAL_DMA_MODULE_ENABLED

/* The newer DMA controllers (H5, U5, …) use linked lists for circular transfers. */
static bool is_circular(const DMA_HandleTypeDef *dma)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    return dma->Mode == DMA_LINKEDLIST_CIRCULAR;
#else
    return dma->Init.Mode == DMA_CIRCULAR;
#endif
}

/* The DMA counts bytes in its FIFO as received before they are in memory. */
static bool has_fifo(const DMA_HandleTypeDef *dma)
{
#ifdef DMA_FIFOMODE_DISABLE
    return dma->Init.FIFOMode != DMA_FIFOMODE_DISABLE;
#else
    (void)dma;
    return false;
#endif
}

/* With linked lists, width and increment are in the node. */
static bool is_by_byte(const DMA_HandleTypeDef *dma)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    const DMA_QListTypeDef *const list = dma->LinkedListQueue;
    const uint32_t mask = DMA_CTR1_SDW_LOG2 | DMA_CTR1_DDW_LOG2 | DMA_CTR1_SINC | DMA_CTR1_DINC;
    return list != NULL && list->Head != NULL &&
           (list->Head->LinkRegisters[NODE_CTR1_DEFAULT_OFFSET] & mask) == DMA_CTR1_DINC;
#else
    return dma->Init.PeriphDataAlignment == DMA_PDATAALIGN_BYTE &&
           dma->Init.MemDataAlignment == DMA_MDATAALIGN_BYTE &&
           dma->Init.PeriphInc == DMA_PINC_DISABLE && dma->Init.MemInc == DMA_MINC_ENABLE;
#endif
}

static bool has_good_dma(const UART_HandleTypeDef *uart)
{
    return uart->hdmarx != NULL && is_circular(uart->hdmarx) && !has_fifo(uart->hdmarx) &&
           is_by_byte(uart->hdmarx);
}

/* HAL_DMA_Abort() refuses a channel of linked lists that has been suspended. */
static bool is_suspended(const DMA_HandleTypeDef *dma)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    return dma->State == HAL_DMA_STATE_SUSPEND;
#else
    (void)dma;
    return false;
#endif
}

static void resume(DMA_HandleTypeDef *dma)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    (void)HAL_DMAEx_Resume(dma);
#else
    (void)dma;
#endif
}

/* True if the UART requests DMA and nothing else has stopped the channel. */
static bool is_dma_running(const UART_HandleTypeDef *uart)
{
    return (uart->Instance->CR3 & USART_CR3_DMAR) != 0 &&
           uart->hdmarx->State != HAL_DMA_STATE_READY && !is_suspended(uart->hdmarx);
}

/* The HAL stops the channel only if the UART still requests DMA, which it does not after
 * HAL_UART_Init(). */
static void stop_dma(const UART_HandleTypeDef *uart)
{
    if (uart->hdmarx != NULL && is_suspended(uart->hdmarx)) {
        resume(uart->hdmarx);
    }
    if (uart->hdmarx != NULL && uart->hdmarx->State == HAL_DMA_STATE_BUSY) {
        (void)HAL_DMA_Abort(uart->hdmarx);
    }
}

/* Uses the idle line if the HAL also names the event that it reports. Otherwise half and whole
 * buffer and the polls are enough. */
static HAL_StatusTypeDef receive_by_dma(tmini_stm32_hal_t *port)
{
#ifdef HAL_UART_RXEVENT_HT
    return HAL_UARTEx_ReceiveToIdle_DMA(port->uart, port->buffer, port->size);
#else
    return HAL_UART_Receive_DMA(port->uart, port->buffer, port->size);
#endif
}

/* If a linked-list channel has stopped because of an error and is started again, it continues in
 * the middle of the buffer, with the rest of its block: the HAL clears that rest only when it stops
 * the channel itself. Once the rest is cleared, the channel reads its list and begins at the
 * buffer's start. */
static void forget_rest_of_block(const tmini_stm32_hal_t *port)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    if (port->uart->hdmarx->State == HAL_DMA_STATE_READY) {
        port->uart->hdmarx->Instance->CBR1 = 0;
    }
#else
    (void)port;
#endif
}

/* Disables the interrupts of line errors, because the HAL ends a DMA reception at any error.
 * Without them each error costs only its byte. HALs up to 2022 also enable the parity interrupt;
 * with it on, their handler would serve a pending error endlessly and nothing else. */
static void ignore_line_errors(tmini_stm32_hal_t *port)
{
    CLEAR_SHARED_BIT(port->uart->Instance->CR3, USART_CR3_EIE);
    CLEAR_SHARED_BIT(port->uart->Instance->CR1, USART_CR1_PEIE);
}

/* The index that DMA writes next; the size itself when it has just wrapped. */
static uint16_t dma_position(const tmini_stm32_hal_t *port)
{
    return (uint16_t)(port->size - __HAL_DMA_GET_COUNTER(port->uart->hdmarx));
}

/* The type is reset at once: if the DMA's interrupt comes after the idle line's interrupt has
 * stored its type, but before it calls back, both callbacks would read the DMA's type. */
static void report_event(tmini_stm32_hal_t *port)
{
#ifdef HAL_UART_RXEVENT_HT
    const uint32_t type = port->uart->RxEventType;
    port->uart->RxEventType = HAL_UART_RXEVENT_IDLE;
    tmini_stm32_circle_report(&port->circle, type == HAL_UART_RXEVENT_HT,
                              type == HAL_UART_RXEVENT_TC);
#else
    (void)port;
#endif
}

#else /* The project's HAL has no DMA. */

static bool has_good_dma(const UART_HandleTypeDef *uart)
{
    (void)uart;
    return false;
}

static bool is_dma_running(const UART_HandleTypeDef *uart)
{
    (void)uart;
    return true;
}

static void stop_dma(const UART_HandleTypeDef *uart)
{
    (void)uart;
}

static HAL_StatusTypeDef receive_by_dma(const tmini_stm32_hal_t *port)
{
    (void)port;
    return HAL_ERROR;
}

static void forget_rest_of_block(const tmini_stm32_hal_t *port)
{
    (void)port;
}

static void ignore_line_errors(const tmini_stm32_hal_t *port)
{
    (void)port;
}

static uint16_t dma_position(const tmini_stm32_hal_t *port)
{
    return port->circle.position;
}

static void report_event(const tmini_stm32_hal_t *port)
{
    (void)port;
}

#endif

/* ------------------------------------------------------------------------------- line errors */

static void count_errors(volatile tmini_stm32_hal_counters_t *counters, uint32_t code)
{
    const uint32_t known =
        HAL_UART_ERROR_ORE | HAL_UART_ERROR_FE | HAL_UART_ERROR_NE | HAL_UART_ERROR_PE;
    counters->overruns = counters->overruns + ((code & HAL_UART_ERROR_ORE) != 0);
    counters->framing_errors = counters->framing_errors + ((code & HAL_UART_ERROR_FE) != 0);
    counters->noise_errors = counters->noise_errors + ((code & HAL_UART_ERROR_NE) != 0);
    counters->parity_errors = counters->parity_errors + ((code & HAL_UART_ERROR_PE) != 0);
    counters->other_errors = counters->other_errors + ((code & ~known) != 0);
}

static uint32_t line_errors(const UART_HandleTypeDef *uart)
{
    uint32_t errors = HAL_UART_ERROR_NONE;
    errors |= __HAL_UART_GET_FLAG(uart, UART_FLAG_ORE) ? HAL_UART_ERROR_ORE : 0;
    errors |= __HAL_UART_GET_FLAG(uart, UART_FLAG_FE) ? HAL_UART_ERROR_FE : 0;
    errors |= __HAL_UART_GET_FLAG(uart, UART_FLAG_NE) ? HAL_UART_ERROR_NE : 0;
    return errors;
}

/* Counts line errors with DMA, where no interrupt reports them. Flags in SR are cleared when DMA
 * reads the next byte, because SR has been read here; flags in ISR are cleared here. */
static void look_at_line_errors(tmini_stm32_hal_t *port)
{
    const uint32_t errors = line_errors(port->uart);
    count_errors(&port->counters, errors & ~(uint32_t)port->line_flags);
    port->line_flags = (uint8_t)errors;
#ifdef UART_CLEAR_OREF
    if (errors != 0) {
        __HAL_UART_CLEAR_FLAG(port->uart, UART_CLEAR_OREF | UART_CLEAR_FEF | UART_CLEAR_NEF);
        port->line_flags = 0;
    }
#else
    if ((errors & HAL_UART_ERROR_ORE) != 0 && !__HAL_UART_GET_FLAG(port->uart, UART_FLAG_RXNE)) {
        __HAL_UART_CLEAR_OREFLAG(port->uart); /* An overrun may stop further bytes. */
        port->line_flags = 0;
    }
#endif
}

/* ------------------------------------------------------------------- what DMA has brought */

static void copy_out(tmini_stm32_hal_t *port, uint16_t from, uint16_t to)
{
    read_anew(port->buffer, from, to);
    tmini_feed(port->lidar, &port->buffer[from], (size_t)(to - from));
}

static void copy_new(tmini_stm32_hal_t *port, uint16_t from, uint16_t to)
{
    if (to < from) {
        copy_out(port, from, port->size);
        from = 0;
    }
    if (to > from) {
        copy_out(port, from, to);
    }
}

static void publish_new(tmini_stm32_hal_t *port, uint16_t from, uint16_t to)
{
    if (to < from) {
        read_anew(port->buffer, from, port->size);
        from = 0;
    }
    read_anew(port->buffer, from, to);
    tmini_feed_dma(port->lidar, to);
}

static void hand_over(tmini_stm32_hal_t *port)
{
    tmini_stm32_circle_t *const circle = &port->circle;
    const uint8_t middles =
        circle->middles; /* Read before the position, which may only be newer. */
    const uint8_t ends = circle->ends;
    const uint16_t from = circle->position;
    if (tmini_stm32_circle_advance(circle, dma_position(port), middles, ends)) {
        port->counters.laps = port->counters.laps + 1;
        read_anew(port->buffer, 0, port->size);
        tmini_feed_gap(port->lidar);
    }
    if (port->reception == RECEPTION_DMA) {
        publish_new(port, from, circle->position);
    } else {
        copy_new(port, from, circle->position);
    }
    look_at_line_errors(port);
}

static bool is_receiving(const tmini_stm32_hal_t *port)
{
    return port->is_started && port->uart->RxState == HAL_UART_STATE_BUSY_RX &&
           (port->reception == RECEPTION_BYTES || is_dma_running(port->uart));
}

/* Any context. Uses the hardware's position, never the event's, because an idle event may overtake
 * the half-transfer event of earlier bytes. */
static void hand_over_new(tmini_stm32_hal_t *port)
{
    if (!is_receiving(port) || !tmini_stm32_circle_enter(&port->circle)) {
        return;
    }
    do {
        hand_over(port);
    } while (tmini_stm32_circle_leave(&port->circle));
}

/* ----------------------------------------------------------------------- starting, in the poll */

/* Also clears an overrun, which would end the next reception during the call that begins it. */
static void forget_reception(tmini_stm32_hal_t *port)
{
    port->is_started = false;
    (void)HAL_UART_AbortReceive(port->uart);
    if (port->reception != RECEPTION_BYTES) {
        stop_dma(port->uart);
    }
    __HAL_UART_CLEAR_OREFLAG(port->uart);
}

static void prepare_circle(tmini_stm32_hal_t *port)
{
    forget_rest_of_block(port);
    if (port->reception == RECEPTION_DMA) {
        tmini_stm32_circle_rewind(port->lidar);
    }
    write_through(port->buffer, port->size);
    tmini_stm32_circle_begin(&port->circle, port->size);
    port->line_flags = 0;
}

/* Interrupts are disabled for about ten microseconds. The HAL enables the error interrupt first,
 * then that of bytes or the DMA. A damaged byte between the two would end the reception before it
 * has begun, or, where only reading the byte clears the error (SR and DR), interrupt endlessly. */
static HAL_StatusTypeDef begin_uninterrupted(tmini_stm32_hal_t *port)
{
    const uint32_t primask = __get_PRIMASK();
    HAL_StatusTypeDef status;
    __disable_irq();
    if (port->reception == RECEPTION_BYTES) {
        status = HAL_UART_Receive_IT(port->uart, &port->byte, 1);
    } else {
        status = receive_by_dma(port);
        ignore_line_errors(port);
    }
    port->is_started = status == HAL_OK;
    __set_PRIMASK(primask);
    return status;
}

/* Call forget_reception() first. */
static bool begin_reception(tmini_stm32_hal_t *port)
{
    port->started_ms = HAL_GetTick();
    if (port->reception != RECEPTION_BYTES) {
        prepare_circle(port);
    }
    return begin_uninterrupted(port) == HAL_OK;
}

/* The old reception ends first, because only one context at a time may feed the lidar. */
static void restart_reception(tmini_stm32_hal_t *port)
{
    port->counters.restarts = port->counters.restarts + 1;
    forget_reception(port);
    if (port->reception != RECEPTION_DMA) {
        tmini_feed_gap(port->lidar);
    }
    (void)begin_reception(port);
}

/* Every tmini_poll() calls this. */
static void look_after_reception(tmini_stm32_hal_t *port, uint32_t time_ms)
{
    if (port->reception == RECEPTION_NONE) {
        return;
    }
    if (!is_receiving(port)) {
        if (time_ms - port->started_ms >= RESTART_PAUSE_MS) {
            restart_reception(port);
        }
    } else if (port->reception != RECEPTION_BYTES) {
        hand_over_new(port);
    }
}

/* -------------------------------------------------------------------------- the HAL's callbacks */

static bool is_ours(const tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    return uart == port->uart && port->is_started;
}

static bool is_in_circle(const tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    return is_ours(port, uart) && port->reception != RECEPTION_BYTES;
}

void tmini_stm32_hal_rx_event(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (is_in_circle(port, uart)) {
        report_event(port);
        hand_over_new(port);
    }
}

void tmini_stm32_hal_rx_half_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (is_in_circle(port, uart)) {
        tmini_stm32_circle_report(&port->circle, true, false);
        hand_over_new(port);
    }
}

/* When receiving by bytes, an overrun means that an unknown number of bytes was lost after the last
 * one. */
static void note_errors(tmini_stm32_hal_t *port, uint32_t code)
{
    count_errors(&port->counters, code);
    if (port->reception == RECEPTION_BYTES && (code & HAL_UART_ERROR_ORE) != 0) {
        tmini_feed_gap(port->lidar);
    }
}

/* Errors are noted first, because requesting the next byte clears the HAL's record of them. */
static void take_byte(tmini_stm32_hal_t *port)
{
    tmini_feed_byte(port->lidar, port->byte);
    note_errors(port, port->uart->ErrorCode);
    (void)HAL_UART_Receive_IT(port->uart, &port->byte, 1); /* If it fails, a poll starts it
                                                            * again. */
}

void tmini_stm32_hal_rx_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (is_in_circle(port, uart)) {
        tmini_stm32_circle_report(&port->circle, false, true);
        hand_over_new(port);
    } else if (is_ours(port, uart)) {
        take_byte(port);
    }
}

/* The poll starts reception again, not this function: it may run during the call that starts
 * reception, and the DMA may still be stopping. */
void tmini_stm32_hal_error(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (is_ours(port, uart)) {
        note_errors(port, uart->ErrorCode);
    }
}

/* ------------------------------------------------------------------------ the port's functions */

static int send_bytes(void *context, const uint8_t *bytes, size_t count)
{
    tmini_stm32_hal_t *const port = context;
    if (port->uart == NULL || count > sizeof port->sending) {
        return -1;
    }
    if (port->uart->gState != HAL_UART_STATE_READY) {
        return 0; /* The HAL still sends from port->sending. */
    }
    memcpy(port->sending, bytes, count);
    switch (HAL_UART_Transmit_IT(port->uart, port->sending, (uint16_t)count)) {
    case HAL_OK:
        return (int)count;
    case HAL_BUSY:
        return 0;
    default:
        return -1;
    }
}

static uint32_t time_now_ms(void *context)
{
    const uint32_t time_ms = HAL_GetTick();
    look_after_reception(context, time_ms);
    return time_ms;
}

/* The lidar is lost: perhaps reception has stopped unnoticed. */
static void restart(void *context)
{
    tmini_stm32_hal_t *const port = context;
    if (port->reception != RECEPTION_NONE) {
        restart_reception(port);
    }
}

static void wait_for_interrupt(void *context)
{
    (void)context;
    __WFI();
}

const tmini_port_t tmini_stm32_hal_port = {
    .write = send_bytes, .now_ms = time_now_ms, .wait = wait_for_interrupt, .restart = restart};

/* -------------------------------------------------------------------------------- life cycle */

tmini_status_t tmini_stm32_hal_init(tmini_stm32_hal_t *port, UART_HandleTypeDef *uart)
{
    if (port == NULL || uart == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *port = (tmini_stm32_hal_t){.uart = uart};
    return TMINI_OK;
}

static bool are_set_up(const tmini_stm32_hal_t *port, const tmini_t *lidar)
{
    return port != NULL && port->uart != NULL && tmini_stm32_circle_is_set_up(lidar);
}

static bool is_230400_8n1(const UART_HandleTypeDef *uart)
{
    return uart->Init.BaudRate == TMINI_STM32_BAUD_RATE &&
           uart->Init.WordLength == UART_WORDLENGTH_8B && uart->Init.Parity == UART_PARITY_NONE;
}

static bool is_good_circle(const UART_HandleTypeDef *uart, const uint8_t *buffer, size_t size)
{
    return has_good_dma(uart) && size <= TMINI_STM32_CIRCLE_MAX && is_aligned(buffer, size);
}

static tmini_status_t start_reception(tmini_stm32_hal_t *port, tmini_t *lidar,
                                      enum reception reception, uint8_t *buffer, size_t size)
{
    port->is_started = false;
    port->lidar = lidar;
    port->buffer = buffer;
    port->size = (uint16_t)size;
    port->reception = (uint8_t)reception;
    forget_reception(port);
    return begin_reception(port) ? TMINI_OK : TMINI_ERROR_STATE;
}

tmini_status_t tmini_stm32_hal_start(tmini_stm32_hal_t *port, tmini_t *lidar)
{
    if (!are_set_up(port, lidar)) {
        return TMINI_ERROR_STATE;
    }
    if (!is_230400_8n1(port->uart)) {
        return TMINI_ERROR_ARGUMENT;
    }
    size_t size;
    uint8_t *const memory = tmini_rx_buffer(lidar, &size);
    if (memory == NULL) {
        return start_reception(port, lidar, RECEPTION_BYTES, NULL, 0);
    }
    if (!is_good_circle(port->uart, memory, size)) {
        return TMINI_ERROR_ARGUMENT;
    }
    return start_reception(port, lidar, RECEPTION_DMA, memory, size);
}

tmini_status_t tmini_stm32_hal_start_blocks(tmini_stm32_hal_t *port, tmini_t *lidar, uint8_t *block,
                                            size_t block_size)
{
    if (!are_set_up(port, lidar)) {
        return TMINI_ERROR_STATE;
    }
    if (block == NULL || block_size < BLOCK_SIZE_MIN || block_size % 2 != 0 ||
        tmini_stm32_circle_size(lidar) != 0 || !is_230400_8n1(port->uart) ||
        !is_good_circle(port->uart, block, block_size)) {
        return TMINI_ERROR_ARGUMENT;
    }
    return start_reception(port, lidar, RECEPTION_BLOCKS, block, block_size);
}

void tmini_stm32_hal_stop(tmini_stm32_hal_t *port)
{
    if (port == NULL || port->uart == NULL || port->reception == RECEPTION_NONE) {
        return;
    }
    if (port->reception != RECEPTION_BYTES) {
        hand_over_new(port);
    }
    forget_reception(port);
    port->reception = RECEPTION_NONE;
}

void tmini_stm32_hal_counters(const tmini_stm32_hal_t *port, tmini_stm32_hal_counters_t *counters)
{
    *counters = port->counters;
}
