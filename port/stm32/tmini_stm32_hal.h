/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A tmini port for STM32 with ST's HAL, any family. README.md beside this file has the CubeMX settings.
 *
 * Received bytes can come in three ways; choose one of the tmini_stm32_hal_receive_…() functions:
 *
 *   DMA     Circular DMA straight into the library's receive buffer: no work at all for a byte.
 *   blocks  The HAL collects blocks, by DMA of any mode or by interrupt; each is copied.
 *   bytes   An interrupt a byte: works everywhere, about 13,000 times a second.
 *
 * The HAL's callbacks stay yours; call from them the function named like each:
 *
 *   HAL_UARTEx_RxEventCallback(huart, size)   tmini_stm32_hal_rx_event(&port, huart, size)   DMA, blocks
 *   HAL_UART_RxCpltCallback(huart)            tmini_stm32_hal_rx_complete(&port, huart)      bytes
 *   HAL_UART_ErrorCallback(huart)             tmini_stm32_hal_error(&port, huart)            all
 *
 * Each does nothing if the UART is another one, so several UARTs may share a callback.
 *
 * Line errors. After an overrun, and with DMA after every error, the HAL stops receiving for good. The
 * port counts the error, saves what had come before it and starts again. A reception that stands still
 * for any other reason (the HAL was locked, or a callback is missing) is started again within some
 * milliseconds by tmini_poll(), through the port's clock.
 *
 * Order of calls: HAL's initialisation, tmini_init() with this port and a zeroed context, then one of
 * the receive functions, then commands. */

#ifndef TMINI_STM32_HAL_H
#define TMINI_STM32_HAL_H

#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini.h"

/* Every CubeMX project has a main.h that includes the HAL of its family. */
#ifdef TMINI_STM32_HAL_HEADER
#include TMINI_STM32_HAL_HEADER
#else
#include "main.h"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Running totals, for diagnostics. */
typedef struct {
    uint32_t overruns; /* Bytes came faster than interrupt or DMA took them. */
    uint32_t framing_errors;
    uint32_t noise_errors;
    uint32_t other_errors; /* Parity, DMA. */
    uint32_t restarts;     /* Of a reception that had stopped. */
} tmini_stm32_hal_counters_t;

/* One lidar's UART. Allocate it statically, so that it is zero at first; `counters` may be read,
 * the rest is private. */
typedef struct {
    UART_HandleTypeDef *uart;
    tmini_t *lidar;
    uint8_t *buffer; /* What the HAL receives into. */
    uint16_t size;
    uint16_t position; /* Bytes of it that have been handed over in this round. */
    uint8_t reception;
    uint8_t byte;
    uint8_t sending[2]; /* The HAL reads it while it sends. */
    uint32_t alive_ms;  /* When reception was last seen running. */
    volatile tmini_stm32_hal_counters_t counters;
} tmini_stm32_hal_t;

/* The `port` of tmini_config_t; its `port_context` is the address of a tmini_stm32_hal_t. Sends by
 * interrupt, never waits. `wait` sleeps until the next interrupt (WFI); with an RTOS, copy the
 * structure and put its delay there. */
extern const tmini_port_t tmini_stm32_hal_port;

/* Receives by circular DMA into `rx_buffer`, which is the one given to tmini_init(), with rx_dma
 * set. `rx_size`: a power of two from 512 to 32768; on a Cortex-M7 with data cache the buffer must be
 * aligned to 32 bytes, and lie where the DMA reaches it. The DMA channel must be circular, byte-wide,
 * with its FIFO off.
 * Returns TMINI_OK; TMINI_ERROR_ARGUMENT (null pointer, size, alignment, DMA missing or not circular);
 * TMINI_ERROR_STATE if the HAL refuses to start. */
tmini_status_t tmini_stm32_hal_receive_dma(tmini_stm32_hal_t *port, tmini_t *lidar,
                                           UART_HandleTypeDef *uart, uint8_t *rx_buffer,
                                           size_t rx_size);

/* Receives blocks into `block`, a buffer of its own (64 to 256 bytes do well; on a Cortex-M7 aligned
 * as above), and copies them on; rx_dma is not set. Uses DMA if the UART has a channel for it, circular
 * or not, else interrupts. Returns as above. */
tmini_status_t tmini_stm32_hal_receive_blocks(tmini_stm32_hal_t *port, tmini_t *lidar,
                                              UART_HandleTypeDef *uart, uint8_t *block,
                                              size_t block_size);

/* Receives byte by byte; rx_dma is not set. Returns as above. */
tmini_status_t tmini_stm32_hal_receive_bytes(tmini_stm32_hal_t *port, tmini_t *lidar,
                                             UART_HandleTypeDef *uart);

/* To be called from the HAL's callbacks, in interrupt context; see the table above. */
void tmini_stm32_hal_rx_event(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart,
                              uint16_t size);
void tmini_stm32_hal_rx_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);
void tmini_stm32_hal_error(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);

#ifdef __cplusplus
}
#endif

#endif
