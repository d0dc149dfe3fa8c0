/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One of the STM32 ports on the model: what the tests of both ports share (every_port.h). */

#ifndef STM32_RIG_H
#define STM32_RIG_H

#include "every_port.h"
#include "play.h"
#include "stm32_model.h"

/* Indices of port_ways. */
typedef enum { BY_BYTES, BY_DMA, BY_BLOCKS } rig_way_t;

typedef struct {
    uint32_t bytes; /* Only without the HAL. */
    uint32_t overruns;
    uint32_t framing_errors;
    uint32_t noise_errors;
    uint32_t laps;
    uint32_t restarts;
    uint32_t other_errors;
} rig_counts_t;

extern rig_way_t rig_way; /* The one that has been chosen. */
extern const play_word_t rig_words[];

/* Defined for each port. */
void rig_open(void);            /* Resets the hardware and sets the port up. */
tmini_status_t rig_start(void); /* For `lidar`. */
rig_counts_t rig_counts(void);
bool rig_is_off(void);          /* Nothing of the port is switched on. */
void rig_break_reception(void); /* No flag shows it. */

#endif
