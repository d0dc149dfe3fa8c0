/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The HAL port as a project sets it up, on the model. */

#ifndef HAL_RIG_H
#define HAL_RIG_H

#include "tmini_stm32_hal.h"

#include "play.h"
#include "usart.h"

extern tmini_stm32_hal_t port;
extern uint8_t hal_rig_block[1024];

/* With this value in this place, a start is refused. */
void hal_rig_assert_refused(uint32_t *member, uint32_t value);

#endif
