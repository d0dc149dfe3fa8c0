/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar.h"

#include "main.h"
#include "obstacle.h"
#include "tmini/tmini.h"
#include "tmini_stm32_hal.h"
#include "usart.h"

#define RETRY_MS 1000u

/* Aligned for the data cache of a Cortex-M7; elsewhere that does no harm. On an H7 it must also lie in a RAM
 * that the DMA reaches, which the default DTCM is not. */
static uint8_t rx[1024] __ALIGNED(32);
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_stm32_hal_t port;

static obstacle_t obstacle;
static uint32_t tried_ms;

/* ------------------------------------------------- the HAL's callbacks: share them with other UARTs */

void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size)
{
    tmini_stm32_hal_rx_event(&port, huart, Size);
}

void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_error(&port, huart);
}

/* --------------------------------------------------------------------------------- obstacle stop */

/* Without a scanning lidar, or with a faulty one, nothing can be known of what is in front. */
static void drive(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    HAL_GPIO_WritePin(DRIVE_ENABLE_GPIO_Port, DRIVE_ENABLE_Pin,
                      obstacle_may_move(&obstacle, HAL_GetTick()) ? GPIO_PIN_SET : GPIO_PIN_RESET);
}

/* At first, and after a failure. A lidar lost while it scans is brought back by the library. */
static void try_to_scan(void)
{
    if (HAL_GetTick() - tried_ms >= RETRY_MS) {
        tried_ms = HAL_GetTick();
        (void)tmini_start(&lidar); /* Refused while it is under way, or done. */
    }
}

void lidar_start(void)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = true,
        .points = points,
        .max_points = sizeof points / sizeof points[0],
    };
    if (tmini_init(&lidar, &config) != TMINI_OK ||
        tmini_stm32_hal_receive_dma(&port, &lidar, &huart1, rx, sizeof rx) != TMINI_OK) {
        Error_Handler(); /* DMA missing or not circular: see the settings in README.md. */
    }
    tried_ms = HAL_GetTick();
    (void)tmini_start(&lidar);
}

void lidar_work(void)
{
    if (tmini_poll(&lidar) == TMINI_EVENT_SCAN) {
        obstacle_see(&obstacle, tmini_scan(&lidar), HAL_GetTick());
    }
    try_to_scan();
    drive();
}

uint16_t lidar_ahead_mm(void)
{
    return obstacle.nearest_mm[0];
}
