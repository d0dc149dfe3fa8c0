/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How the lidar's bytes come in: by an interrupt each (by_interrupt.c) or by DMA (by_dma.c). One of
 * the two is compiled; see CMakeLists.txt. */

#ifndef RECEPTION_H
#define RECEPTION_H

#include "tmini_stm32_usart.h"

/* For the port's init; by DMA if it names what is left. */
extern const tmini_stm32_usart_wiring_t reception_wiring;

/* Starts the port, which has been through its init, for a lidar that has been through
 * tmini_init() with `rx`. Returns what the port does. */
tmini_status_t reception_start(tmini_stm32_usart_t *port, tmini_t *lidar, uint8_t *rx,
                               uint16_t rx_size);

#endif
