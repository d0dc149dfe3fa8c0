/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop for a project made by CubeMX: the pin DRIVE_ENABLE is high while the lidar sees
 * nothing near in front. Two calls from main.c; main.c beside this file shows where. */

#ifndef LIDAR_H
#define LIDAR_H

#include <stdint.h>

#include "main.h"

/* Once, after all MX_…_Init(). `uart`: the lidar's, &huart1 for example. */
void lidar_start(UART_HandleTypeDef *uart);

/* Again and again in the main loop; returns at once. At the latest every 20 ms. */
void lidar_work(void);

/* The distance of the nearest thing in front, in a sector 45 degrees wide, in the last scan; 0:
 * nothing. */
uint16_t lidar_ahead_mm(void);

#endif
