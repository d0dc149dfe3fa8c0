/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Gives the model's registers to the port that does without the HAL. */

#ifndef STM32_MODEL_ACCESS_H
#define STM32_MODEL_ACCESS_H

#include "stm32_model.h"

static inline uint32_t read_register(const volatile uint32_t *at)
{
    return model_read(at);
}

static inline void write_register(volatile uint32_t *at, uint32_t value)
{
    model_write(at, value);
}

#endif
