/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The port on the registers as a project sets it up, on the model. */

#ifndef USART_RIG_H
#define USART_RIG_H

#include "tmini_stm32_usart.h"

#include "stm32_rig.h"

typedef struct {
    tmini_stm32_usart_t port;
    tmini_stm32_usart_wiring_t wiring;
} usart_rig_t;

extern usart_rig_t usart_rig;

#endif
