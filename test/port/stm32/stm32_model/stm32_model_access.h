/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The registers of the port without the HAL are the model's. */

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
