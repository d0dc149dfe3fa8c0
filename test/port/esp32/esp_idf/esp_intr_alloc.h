/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: interrupt flags. */

#ifndef ESP_INTR_ALLOC_H
#define ESP_INTR_ALLOC_H

#define ESP_INTR_FLAG_IRAM (1 << 10)

#endif
