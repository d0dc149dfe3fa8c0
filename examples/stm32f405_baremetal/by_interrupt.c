/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* reception.h with an interrupt per byte. */

#include "board.h"
#include "reception.h"
#include "stm32f405.h"

const tmini_stm32_usart_wiring_t reception_wiring = {
    .usart = (volatile void *)USART1_BASE,
    .clock_hz = BOARD_USART1_CLOCK_HZ,
    .time_ms = &board_time_ms,
};

tmini_status_t reception_start(tmini_stm32_usart_t *port, tmini_t *lidar, uint8_t *rx,
                               uint16_t rx_size)
{
    (void)rx;
    (void)rx_size;
    return tmini_stm32_usart_start(port, lidar);
}
