/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How the lidar's bytes are received: by an interrupt per byte (by_interrupt.c) or by DMA
 * (by_dma.c). One of the two is compiled; see CMakeLists.txt. */

#ifndef RECEPTION_H
#define RECEPTION_H

#include "tmini_stm32_usart.h"

/* For tmini_stm32_usart_init(). With DMA, its member `remaining` is set. */
extern const tmini_stm32_usart_wiring_t reception_wiring;

/* Starts the port for a lidar that uses `rx`; both must have been initialised. Returns the result
 * of tmini_stm32_usart_start(). */
tmini_status_t reception_start(tmini_stm32_usart_t *port, tmini_t *lidar, uint8_t *rx,
                               uint16_t rx_size);

#endif
