/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "board.h"
#include "reception.h"

const bool reception_uses_dma = false;

tmini_status_t reception_start(tmini_stm32_usart_t *port, tmini_t *lidar, uint8_t *rx,
                               uint16_t rx_size)
{
    (void)rx;
    (void)rx_size;
    return tmini_stm32_usart_start(port, lidar, BOARD_USART1_CLOCK_HZ);
}
