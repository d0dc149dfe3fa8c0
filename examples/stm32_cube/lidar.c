/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar.h"

#include "main.h"
#include "tmini/tmini.h"
#include "tmini_stm32_hal.h"
#include "usart.h"

#define STOP_MM 300u
#define AHEAD_Q6 (30u * 64u) /* To either side, in 1/64 degree. */
#define BLIND_MS 500u        /* Without a complete scan for so long, the robot stops. */
#define RETRY_MS 1000u

/* Aligned for the data cache of a Cortex-M7; elsewhere that does no harm. On an H7 it must also lie in a RAM
 * that the DMA reaches, which the default DTCM is not. */
static uint8_t rx[1024] __ALIGNED(32);
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_stm32_hal_t port;

static uint16_t ahead_mm;
static uint32_t seen_ms;
static uint32_t tried_ms;
static bool has_seen;

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

static bool is_ahead(uint16_t angle_q6)
{
    return angle_q6 <= AHEAD_Q6 || angle_q6 >= TMINI_TURN_Q6 - AHEAD_Q6;
}

static void see(const tmini_scan_t *scan)
{
    ahead_mm = 0;
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm != 0 && is_ahead(point->angle_q6) &&
            (ahead_mm == 0 || point->distance_mm < ahead_mm)) {
            ahead_mm = point->distance_mm;
        }
    }
    if (scan->complete) {
        has_seen = true;
        seen_ms = HAL_GetTick();
    }
}

static bool may_move(void)
{
    return has_seen && HAL_GetTick() - seen_ms < BLIND_MS && tmini_faults(&lidar) == 0 &&
           (ahead_mm == 0 || ahead_mm >= STOP_MM);
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
        see(tmini_scan(&lidar));
    }
    try_to_scan();
    HAL_GPIO_WritePin(DRIVE_ENABLE_GPIO_Port, DRIVE_ENABLE_Pin,
                      may_move() ? GPIO_PIN_SET : GPIO_PIN_RESET);
}

uint16_t lidar_ahead_mm(void)
{
    return ahead_mm;
}
