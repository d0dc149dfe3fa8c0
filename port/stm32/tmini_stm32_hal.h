/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A tmini port for STM32 with ST's HAL, of any family and any year. It does not support the HAL2 of
 * the STM32C5, which has other types and callbacks. README.md beside this file has the CubeMX
 * settings.
 *
 *     tmini_stm32_hal_init(&port, &huart1);    after the HAL's own initialisation
 *     config.port = &tmini_stm32_hal_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_stm32_hal_start(&port, &lidar);    from now on bytes come in
 *     tmini_start(&lidar); …                   commands, polling
 *     tmini_stm32_hal_stop(&port);             no more bytes come in; start again as you like
 *
 * Received bytes come in one of three ways:
 *
 *   DMA     With rx_dma in the configuration: circular DMA into the lidar's receive buffer itself.
 *           No work at all for a byte.
 *   bytes   Without rx_dma: an interrupt per byte, about 13,000 times per second while scanning.
 *   blocks  Without rx_dma, and tmini_stm32_hal_start_blocks(): circular DMA into a small buffer,
 *           and a copy. For a receive buffer that lies where DMA does not reach.
 *
 * The HAL's callbacks stay yours; call the port's function from each:
 *
 *   HAL_UARTEx_RxEventCallback(huart, size)  tmini_stm32_hal_rx_event(&port, huart)     DMA, blocks
 *   HAL_UART_RxCpltCallback(huart)           tmini_stm32_hal_rx_complete(&port, huart)  bytes
 *   HAL_UART_ErrorCallback(huart)            tmini_stm32_hal_error(&port, huart)        all
 *
 * Each does nothing for another UART, so several UARTs may share a callback. The event's size is
 * not used, because its meaning differs between HALs; the port reads the DMA's position instead.
 *
 * A reception that has stopped is started again by the next tmini_poll(), never in an interrupt,
 * and once more whenever the lidar is lost. */

#ifndef TMINI_STM32_HAL_H
#define TMINI_STM32_HAL_H

#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini.h"
#include "tmini_stm32_circle.h"

/* Every CubeMX project has a main.h that includes the HAL of its family. */
#ifdef TMINI_STM32_HAL_HEADER
#include TMINI_STM32_HAL_HEADER
#else
#include "main.h"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Running totals, for diagnostics. With DMA, errors are noticed only at polls and events: several
 * between two of these count as one, and with SR and DR the HAL clears some before they are
 * counted. So the counters show that there are errors, but not exactly how many. */
typedef struct {
    uint32_t overruns;       /**< Bytes came faster than interrupt or DMA took them. */
    uint32_t framing_errors; /**< A stop bit was missing: wrong baud rate, noise? */
    uint32_t noise_errors;   /**< A bit's samples differed. */
    uint32_t parity_errors;  /**< Cannot happen without a parity bit; counted if the HAL reports
                              * it. */
    uint32_t other_errors;   /**< Other errors, mostly of the DMA. */
    uint32_t restarts;       /**< How often a stopped reception was started again. */
    uint32_t laps; /**< How often DMA may have written an unseen lap, because its interrupts were
                    * too late. */
} tmini_stm32_hal_counters_t;

/** One lidar's UART. Treat the members as private. */
typedef struct {
    /** @cond private */
    UART_HandleTypeDef *uart;
    tmini_t *lidar;
    uint8_t *buffer; /* The buffer that the HAL fills. */
    uint16_t size;
    uint8_t reception;
    volatile bool is_started; /* The HAL receives, and the DMA channel's position is valid. */
    uint8_t byte;
    uint8_t line_flags; /* Line errors that have been counted and whose flags are still set. */
    uint8_t sending[2]; /* The bytes being sent: the HAL reads them here. */
    uint32_t started_ms;
    tmini_stm32_circle_t circle;
    volatile tmini_stm32_hal_counters_t counters;
    /** @endcond */
} tmini_stm32_hal_t;

/** The `port` of tmini_config_t; its `port_context` is the address of a tmini_stm32_hal_t. Sends by
 * interrupt, never waits. `wait` sleeps until the next interrupt (WFI); with an RTOS, copy the
 * structure and put its delay there. */
extern const tmini_port_t tmini_stm32_hal_port;

/** Sets the UART, which must outlive the port. Sends and receives nothing yet. From the polling
 * context.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer. */
tmini_status_t tmini_stm32_hal_init(tmini_stm32_hal_t *port, UART_HandleTypeDef *uart);

/** Receives for `lidar`, set up by tmini_init(), into the buffer given there: with rx_dma by DMA,
 * without it byte by byte. For DMA the buffer has a size of 512 to 32768, lies where the DMA
 * reaches it and, on a processor with data cache, is aligned to 32 bytes; the DMA channel is
 * circular, byte-wide, with its FIFO off. From the polling context.
 * Returns TMINI_OK;
 *   TMINI_ERROR_STATE     lidar or port not set up; or the HAL refuses to start: polls try again
 *   TMINI_ERROR_ARGUMENT  the UART is not set to 230400 8N1; or DMA: none, not circular, not by
 *                         byte, with FIFO, or a buffer too large or not aligned */
tmini_status_t tmini_stm32_hal_start(tmini_stm32_hal_t *port, tmini_t *lidar);

/** Receives by circular DMA into `block`, a buffer of its own, and copies everything from there
 * into the one given to tmini_init() (without rx_dma). `block_size` is even, 64 to 32768; 256 bytes
 * last for 5 ms without an interrupt. Alignment, DMA channel and results as above; also
 * TMINI_ERROR_ARGUMENT for a null pointer, another size, or with rx_dma. */
tmini_status_t tmini_stm32_hal_start_blocks(tmini_stm32_hal_t *port, tmini_t *lidar, uint8_t *block,
                                            size_t block_size);

/** Ends reception: when it returns, neither the HAL nor its DMA writes to the lidar's buffers.
 * Bytes received before are handed over. Waits some microseconds for the DMA, 5 ms at most if it
 * does not stop. From the polling context. */
void tmini_stm32_hal_stop(tmini_stm32_hal_t *port);

/** Returns the counters of errors so far. From the polling context. */
void tmini_stm32_hal_counters(const tmini_stm32_hal_t *port, tmini_stm32_hal_counters_t *counters);

/** For HAL_UARTEx_RxEventCallback(), with DMA and blocks: hands over the received bytes. Call it,
 * and the three below, in interrupt context. None waits, and none does anything for another
 * UART. */
void tmini_stm32_hal_rx_event(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);

/** For HAL_UART_RxHalfCpltCallback(), with DMA and blocks and a HAL that does not define
 * HAL_UART_RXEVENT_HT and so does not name the event that it reports. */
void tmini_stm32_hal_rx_half_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);

/** For HAL_UART_RxCpltCallback(): by bytes, takes the byte that has come; with DMA and blocks it is
 * needed for a HAL without HAL_UART_RXEVENT_HT. */
void tmini_stm32_hal_rx_complete(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);

/** For HAL_UART_ErrorCallback(): counts the error. If it has ended reception, the next poll starts
 * it again. */
void tmini_stm32_hal_error(tmini_stm32_hal_t *port, const UART_HandleTypeDef *uart);

#ifdef __cplusplus
}
#endif

#endif
