/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: the clock. */

#ifndef ESP_TIMER_H
#define ESP_TIMER_H

#include <stdint.h>

int64_t esp_timer_get_time(void);

#endif
