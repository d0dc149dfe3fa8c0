/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar with the HAL port on the model, shared by the HAL port's tests. */

#ifndef HAL_RIG_H
#define HAL_RIG_H

#include "line.h"
#include "tmini_stm32_hal.h"

#define HAL_RIG_RX_SIZE 1024u
#define HAL_RIG_BLOCK_SIZE 256u

typedef enum { BY_DMA, BY_BLOCKS, BY_BYTES } hal_rig_way_t;

typedef struct {
    UART_HandleTypeDef uart;
#ifdef HAL_DMA_MODULE_ENABLED
    DMA_HandleTypeDef dma;
#endif
#ifdef DMA_LINKEDLIST_CIRCULAR
    DMA_NodeTypeDef node;
    DMA_QListTypeDef list;
#endif
    tmini_t lidar;
    tmini_stm32_hal_t port;
    tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
    uint32_t errors_seen;  /* Calls of the HAL's error callback. */
    bool started_in_error; /* True if reception was started again in one of these calls. */
} hal_rig_t;

extern hal_rig_t hal_rig;
extern uint8_t hal_rig_rx[HAL_RIG_RX_SIZE];
extern uint8_t hal_rig_block[HAL_RIG_BLOCK_SIZE];

/* Resets the hardware, initialises the HAL as CubeMX does, and sets up a lidar for this way. */
void hal_rig_open(hal_rig_way_t way);

/* Starts reception in the way of hal_rig_open(). */
tmini_status_t hal_rig_start(void);

/* Does both, with a pause in between. Fails the test if the port does not start. */
void hal_rig_open_and_start(hal_rig_way_t way);

tmini_stm32_hal_counters_t hal_rig_errors(void);

/* Puts this many packets on the line and runs until all have arrived. */
void hal_rig_receive(unsigned packets);

static inline tmini_counters_t hal_rig_poll(void)
{
    return line_poll(&hal_rig.lidar);
}

/* Polls until all bytes have arrived and the line is idle. */
static inline void hal_rig_run(void)
{
    (void)line_run(&hal_rig.lidar, 1000);
}

uint32_t hal_rig_packets(void);

#endif
