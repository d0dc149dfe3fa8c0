/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Private to the model: shared by the UART's two APIs and the kernel. */

#ifndef ZEPHYR_BOARD_H
#define ZEPHYR_BOARD_H

#include <stdbool.h>
#include <stdint.h>

void zephyr_kernel_begin(void);
void zephyr_async_begin(void);

/* The UART's interrupt while the async API is in use. */
bool zephyr_async_is_up(void);
void zephyr_async_serve(void);

/* The line's errors since the last call. */
int zephyr_board_take_errors(void);

#endif
