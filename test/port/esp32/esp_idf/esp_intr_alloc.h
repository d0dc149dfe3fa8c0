/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: flags of interrupts. */

#ifndef ESP_INTR_ALLOC_H
#define ESP_INTR_ALLOC_H

#define ESP_INTR_FLAG_IRAM (1 << 10)

#endif
