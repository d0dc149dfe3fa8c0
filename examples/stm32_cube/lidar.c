/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar.h"

#include "obstacle.h"
#include "tmini/tmini.h"
#include "tmini_stm32_hal.h"

/* Define LIDAR_PRINTF to print a line of text per second, by printf(). README.md explains where
 * printf() writes to. */
#ifdef LIDAR_PRINTF
#include <stdio.h>

#include "tmini/tmini_names.h"
#endif

#define REPORT_MS 1000u

/* Aligned for the data cache of a Cortex-M7; other chips do not need this. It must be in RAM that
 * the DMA reaches: see README.md for H7, and for F4's CCM. */
static uint8_t rx[1024] __ALIGNED(32);
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_stm32_hal_t port;

static obstacle_t obstacle;

/* --------------------------------------------- the HAL's callbacks: share them with other UARTs */

void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size)
{
    (void)Size;
    tmini_stm32_hal_rx_event(&port, huart);
}

/* An older HAL does not name the event that it reports. */
#ifndef HAL_UART_RXEVENT_HT
void HAL_UART_RxHalfCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_half_complete(&port, huart);
}

void HAL_UART_RxCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_complete(&port, huart);
}
#endif

void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_error(&port, huart);
}

/* ----------------------------------------------------------------------------- something to see */

/* A pin with the user label LIDAR_LED, if there is one, changes with every complete scan. */
static void blink(const tmini_scan_t *scan)
{
#ifdef LIDAR_LED_Pin
    if (scan->complete) {
        HAL_GPIO_TogglePin(LIDAR_LED_GPIO_Port, LIDAR_LED_Pin);
    }
#else
    (void)scan;
#endif
}

static void report(void)
{
#ifdef LIDAR_PRINTF
    static uint32_t reported_ms;
    if (HAL_GetTick() - reported_ms < REPORT_MS) {
        return;
    }
    reported_ms = HAL_GetTick();
    tmini_counters_t counters;
    char faults[64];
    tmini_counters(&lidar, &counters);
    printf("lidar %s, faults %s, scans %lu, ahead %u mm, errors %lu, overrun %lu\r\n",
           tmini_state_name(tmini_state(&lidar)),
           tmini_faults_text(tmini_faults(&lidar), faults, sizeof faults),
           (unsigned long)counters.scans, (unsigned)lidar_ahead_mm(),
           (unsigned long)counters.checksum_errors, (unsigned long)counters.bytes_overrun);
#endif
}

/* -------------------------------------------------------------------------------- obstacle stop */

/* Without a scanning lidar, or with a faulty one, the way ahead is unknown. */
static void drive(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    HAL_GPIO_WritePin(DRIVE_ENABLE_GPIO_Port, DRIVE_ENABLE_Pin,
                      obstacle_may_move(&obstacle, HAL_GetTick()) ? GPIO_PIN_SET : GPIO_PIN_RESET);
}

void lidar_start(UART_HandleTypeDef *uart)
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
    if (tmini_stm32_hal_init(&port, uart) != TMINI_OK || tmini_init(&lidar, &config) != TMINI_OK ||
        tmini_stm32_hal_start(&port, &lidar) == TMINI_ERROR_ARGUMENT) {
        Error_Handler(); /* Wrong baud rate, or no circular DMA: see README.md. */
    }
    (void)tmini_start(&lidar); /* The library tries until the lidar scans. */
}

/* Takes all events now, because bytes left in the buffer could be overwritten before the next
 * call. */
void lidar_work(void)
{
    tmini_event_t event;
    while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
        if (event == TMINI_EVENT_SCAN) {
            obstacle_see(&obstacle, tmini_scan(&lidar));
            blink(tmini_scan(&lidar));
        }
    }
    drive();
    report();
}

uint16_t lidar_ahead_mm(void)
{
    return obstacle.sectors[0].nearest_mm;
}
