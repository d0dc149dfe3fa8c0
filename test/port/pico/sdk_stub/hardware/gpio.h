/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_GPIO_H
#define HARDWARE_GPIO_H

#include "hardware/irq.h"
#include "pico.h"

enum { GPIO_FUNC_UART = 2, GPIO_FUNC_UART_AUX = 11 };

#define GPIO_OUT true
void gpio_init(uint gpio);
void gpio_set_dir(uint gpio, bool out);
void gpio_put(uint gpio, bool value);
void gpio_set_function(uint gpio, uint function);
void gpio_pull_up(uint gpio);

#endif
