/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_stm32_hal.h"

#include <string.h>

enum reception { RECEPTION_NONE, RECEPTION_DMA, RECEPTION_BLOCKS, RECEPTION_BYTES };

/* How long reception may stand still before it is started again. The HAL reports an error only when
 * it has stopped its DMA, some microseconds after it has marked the reception as ended. */
#define STANDSTILL_MS 3u

/* The DMA controller counts in 16 bits; a power of two is at most this. */
#define RX_SIZE_MAX 32768u

/* ------------------------------------------------------------------- what differs by family */

/* Data cache (Cortex-M7): what DMA writes does not reach it. */
#if defined(__DCACHE_PRESENT) && (__DCACHE_PRESENT == 1U)

#define CACHE_LINE 32u

static bool is_good_buffer(const void *buffer, size_t size)
{
    return buffer != NULL && size > 0 && (uintptr_t)buffer % CACHE_LINE == 0 &&
           size % CACHE_LINE == 0;
}

/* Whole lines from the one in which `from` lies. The CPU writes to none of them while DMA runs, so
 * there is nothing in the cache to lose. */
static void read_anew(uint8_t *buffer, size_t from, size_t to)
{
    const size_t first = from / CACHE_LINE * CACHE_LINE;
    if (to > first) {
        SCB_InvalidateDCache_by_Addr((void *)&buffer[first], (int32_t)(to - first));
    }
}

static void write_through(uint8_t *buffer, size_t size)
{
    SCB_CleanInvalidateDCache_by_Addr((void *)buffer, (int32_t)size);
}

#else

static bool is_good_buffer(const void *buffer, size_t size)
{
    return buffer != NULL && size > 0;
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

/* The newer DMA controllers (H5, U5, …) run in circles by linked lists. */
#ifdef DMA_LINKEDLIST_CIRCULAR

static bool is_circular(const DMA_HandleTypeDef *dma)
{
    return dma->Mode == DMA_LINKEDLIST_CIRCULAR;
}

#else

static bool is_circular(const DMA_HandleTypeDef *dma)
{
    return dma->Init.Mode == DMA_CIRCULAR;
}

#endif

/* ------------------------------------------------------------------------------- receiving */

/* The index that DMA writes next; the size itself when it has just come full circle. */
static uint16_t dma_position(const tmini_stm32_hal_t *port)
{
    return (uint16_t)(port->size - __HAL_DMA_GET_COUNTER(port->uart->hdmarx));
}

/* Hands over what DMA has written into the library's own buffer. The position is the hardware's, not
 * the event's: an idle event may overtake the half-transfer event of bytes that came before, whose
 * position would then be one of the past. For the same reason a second event must not come between
 * reading the position and using it, whatever the priorities are: interrupts are held back for these
 * few instructions. */
static void publish(tmini_stm32_hal_t *port)
{
    const uint32_t primask = __get_PRIMASK();
    __disable_irq();
    const uint16_t position = dma_position(port);
    if (position < port->position) {
        read_anew(port->buffer, port->position, port->size);
        read_anew(port->buffer, 0, position);
    } else {
        read_anew(port->buffer, port->position, position);
    }
    tmini_feed_dma(port->lidar, position);
    port->position = position;
    __set_PRIMASK(primask);
}

/* Hands over the block's bytes up to `end`. An event that was overtaken brings nothing new. */
static void copy(tmini_stm32_hal_t *port, uint16_t end)
{
    if (end <= port->position || end > port->size) {
        return;
    }
    if (port->uart->hdmarx != NULL) {
        read_anew(port->buffer, port->position, end);
    }
    tmini_feed(port->lidar, &port->buffer[port->position], (size_t)(end - port->position));
    port->position = end;
}

/* What had come when reception was broken off. */
static void save_remainder(tmini_stm32_hal_t *port)
{
    const UART_HandleTypeDef *const uart = port->uart;
    if (port->reception == RECEPTION_BYTES) {
        return;
    }
    if (uart->hdmarx == NULL) {
        copy(port, (uint16_t)(port->size - uart->RxXferCount));
    } else if (__HAL_DMA_GET_COUNTER(uart->hdmarx) == 0) {
        return; /* The DMA controller was reset, and has forgotten. */
    } else if (port->reception == RECEPTION_DMA) {
        publish(port);
    } else {
        copy(port, dma_position(port));
    }
}

/* DMA begins again at the buffer's start. The bytes from here to its end are old ones: they are
 * overwritten, so that they cannot be taken for new packets, and passed. */
static void pass_remainder(tmini_stm32_hal_t *port)
{
    if (port->position > 0) {
        memset(&port->buffer[port->position], 0, (size_t)(port->size - port->position));
        write_through(port->buffer, port->size);
        tmini_feed_dma(port->lidar, port->size);
    }
}

static bool start(tmini_stm32_hal_t *port)
{
    port->alive_ms = HAL_GetTick();
    if (port->reception == RECEPTION_DMA) {
        pass_remainder(port);
    }
    port->position = 0;
    HAL_StatusTypeDef status;
    if (port->reception == RECEPTION_BYTES) {
        status = HAL_UART_Receive_IT(port->uart, port->buffer, port->size);
    } else if (port->uart->hdmarx != NULL) {
        status = HAL_UARTEx_ReceiveToIdle_DMA(port->uart, port->buffer, port->size);
    } else {
        status = HAL_UARTEx_ReceiveToIdle_IT(port->uart, port->buffer, port->size);
    }
    return status == HAL_OK;
}

static bool is_receiving(const tmini_stm32_hal_t *port)
{
    return port->uart->RxState != HAL_UART_STATE_READY;
}

static void restart(tmini_stm32_hal_t *port)
{
    port->counters.restarts = port->counters.restarts + 1;
    (void)start(port); /* If it fails, the next polls try again. */
}

static bool is_ours(const tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    return uart == port->uart && port->reception != RECEPTION_NONE;
}

void tmini_stm32_hal_rx_event(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart,
                              uint16_t size)
{
    if (!is_ours(port, uart)) {
        return;
    }
    if (port->reception == RECEPTION_DMA) {
        publish(port);
        return;
    }
    copy(port, size);
    if (!is_receiving(port)) {
        (void)start(port); /* A block by interrupt or by DMA that is not circular has ended. */
    } else if (port->position == port->size) {
        port->position = 0;
    }
}

void tmini_stm32_hal_rx_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (is_ours(port, uart)) {
        tmini_feed_byte(port->lidar, port->byte);
        (void)start(port);
    }
}

/* ---------------------------------------------------------------------------------- errors */

static void count_errors(volatile tmini_stm32_hal_counters_t *counters, uint32_t code)
{
    const uint32_t known = HAL_UART_ERROR_ORE | HAL_UART_ERROR_FE | HAL_UART_ERROR_NE;
    counters->overruns = counters->overruns + ((code & HAL_UART_ERROR_ORE) != 0);
    counters->framing_errors = counters->framing_errors + ((code & HAL_UART_ERROR_FE) != 0);
    counters->noise_errors = counters->noise_errors + ((code & HAL_UART_ERROR_NE) != 0);
    counters->other_errors = counters->other_errors + ((code & ~known) != 0);
}

void tmini_stm32_hal_error(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart)
{
    if (!is_ours(port, uart)) {
        return;
    }
    count_errors(&port->counters, uart->ErrorCode);
    if (!is_receiving(port)) { /* Else the HAL goes on by itself. */
        save_remainder(port);
        restart(port);
    }
}

/* ------------------------------------------------------------------------ the port's functions */

static int write(void *context, const uint8_t *bytes, size_t count)
{
    tmini_stm32_hal_t *const port = context;
    if (port->uart == NULL || count > sizeof port->sending) {
        return -1;
    }
    if (port->uart->gState != HAL_UART_STATE_READY) {
        return 0; /* Still sending, from port->sending. */
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

/* Reception that stands still is noticed here, because every tmini_poll() comes by. */
static void look_after_reception(tmini_stm32_hal_t *port, uint32_t time_ms)
{
    if (port->reception == RECEPTION_NONE) {
        return;
    }
    if (is_receiving(port)) {
        port->alive_ms = time_ms;
    } else if (time_ms - port->alive_ms >= STANDSTILL_MS) {
        restart(port);
    }
}

static uint32_t now_ms(void *context)
{
    const uint32_t time_ms = HAL_GetTick();
    look_after_reception(context, time_ms);
    return time_ms;
}

static void wait(void *context)
{
    (void)context;
    __WFI();
}

const tmini_port_t tmini_stm32_hal_port = {.write = write, .now_ms = now_ms, .wait = wait};

/* -------------------------------------------------------------------------- begin to receive */

static bool is_usable(const tmini_stm32_hal_t *port, const tmini_t *lidar,
                      const UART_HandleTypeDef *uart)
{
    return port != NULL && lidar != NULL && uart != NULL;
}

/* Everything is in place before the first interrupt can come. */
static tmini_status_t begin(tmini_stm32_hal_t *port, const tmini_stm32_hal_t *wanted)
{
    *port = *wanted;
    if (port->reception == RECEPTION_BYTES) {
        port->buffer = &port->byte;
        port->size = 1;
    } else {
        write_through(port->buffer, port->size); /* Nothing that is written later on its own. */
    }
    return start(port) ? TMINI_OK : TMINI_ERROR_STATE;
}

tmini_status_t tmini_stm32_hal_receive_dma(tmini_stm32_hal_t *port, tmini_t *lidar,
                                           UART_HandleTypeDef *uart, uint8_t *rx_buffer,
                                           size_t rx_size)
{
    if (!is_usable(port, lidar, uart) || !is_good_buffer(rx_buffer, rx_size) ||
        rx_size > RX_SIZE_MAX || (rx_size & (rx_size - 1)) != 0 || uart->hdmarx == NULL ||
        !is_circular(uart->hdmarx)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_stm32_hal_t wanted = {
        .uart = uart,
        .lidar = lidar,
        .buffer = rx_buffer,
        .size = (uint16_t)rx_size,
        .reception = RECEPTION_DMA,
    };
    return begin(port, &wanted);
}

tmini_status_t tmini_stm32_hal_receive_blocks(tmini_stm32_hal_t *port, tmini_t *lidar,
                                              UART_HandleTypeDef *uart, uint8_t *block,
                                              size_t block_size)
{
    if (!is_usable(port, lidar, uart) || !is_good_buffer(block, block_size) ||
        block_size > UINT16_MAX) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_stm32_hal_t wanted = {
        .uart = uart,
        .lidar = lidar,
        .buffer = block,
        .size = (uint16_t)block_size,
        .reception = RECEPTION_BLOCKS,
    };
    return begin(port, &wanted);
}

tmini_status_t tmini_stm32_hal_receive_bytes(tmini_stm32_hal_t *port, tmini_t *lidar,
                                             UART_HandleTypeDef *uart)
{
    if (!is_usable(port, lidar, uart)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_stm32_hal_t wanted = {.uart = uart, .lidar = lidar, .reception = RECEPTION_BYTES};
    return begin(port, &wanted);
}
