/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop for a project made by CubeMX: the pin DRIVE_ENABLE is high while the lidar sees
 * nothing near in front. Two calls from main.c; main.c beside this file shows where. */

#ifndef LIDAR_H
#define LIDAR_H

#include <stdint.h>

#include "main.h"

/* Call it once, after all MX_…_Init(). `uart`: the lidar's UART, for example &huart1. */
void lidar_start(UART_HandleTypeDef *uart);

/* Call it in the main loop, at least every 20 ms; it returns at once. */
void lidar_work(void);

/* The distance of the nearest thing in front, in a sector 45 degrees wide, in the last scan; 0:
 * nothing. */
uint16_t lidar_ahead_mm(void);

#endif
