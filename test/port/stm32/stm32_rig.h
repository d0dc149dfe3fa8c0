/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One of the STM32 ports on the model, with a lidar: what the tests of both ports share. */

#ifndef STM32_RIG_H
#define STM32_RIG_H

#include "machine.h"
#include "stm32_model.h"
#include "tmini/tmini.h"

/* Ways to receive; sets of them. */
typedef enum { BY_DMA = 1, BY_BLOCKS = 2, BY_BYTES = 4 } rig_way_t;
#define IN_CIRCLE (BY_DMA | BY_BLOCKS)
#define ANY_WAY (BY_DMA | BY_BLOCKS | BY_BYTES)

/* Those of this port. */
#if defined(TMINI_STM32_ACCESS_HEADER)
#define RIG_WAYS (BY_DMA | BY_BYTES)
#elif defined(STM32_MODEL_NO_DMA)
#define RIG_WAYS BY_BYTES
#else
#define RIG_WAYS ANY_WAY
#endif

typedef struct {
    uint32_t overruns;
    uint32_t framing_errors;
    uint32_t noise_errors;
    uint32_t laps;
    uint32_t restarts;
    uint32_t other_errors;
} rig_errors_t;

extern tmini_t lidar;

/* Defined for each port. */
extern const tmini_port_t *const rig_port;
extern void *const rig_context;
void rig_open(rig_way_t way);   /* Resets the hardware and sets the port up. */
tmini_status_t rig_start(void); /* For `lidar`. */
void rig_stop(void);
rig_errors_t rig_errors(void);
bool rig_is_off(void);          /* Nothing of the port is switched on. */
void rig_break_reception(void); /* No flag shows it. */

#endif
