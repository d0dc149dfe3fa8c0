/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar's driver on the HAL port on the model: what the HAL port's tests share. */

#ifndef HAL_RIG_H
#define HAL_RIG_H

#include "line.h"
#include "tmini_stm32_hal.h"

#define HAL_RIG_RX_SIZE 1024u
#define HAL_RIG_BLOCK_SIZE 256u
#define HAL_RIG_PACKET_SIZE 13u

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
    uint32_t errors_seen;  /* Calls of the HAL's error callback, */
    bool started_in_error; /* and whether reception had been begun anew when one returned. */
} hal_rig_t;

extern hal_rig_t hal_rig;
extern uint8_t hal_rig_rx[HAL_RIG_RX_SIZE];
extern uint8_t hal_rig_block[HAL_RIG_BLOCK_SIZE];

/* Hardware after a reset, the HAL initialised as CubeMX does it, and a lidar set up to receive in
 * this way. */
void hal_rig_open(hal_rig_way_t way);

/* Starts reception in the way of hal_rig_open(). */
tmini_status_t hal_rig_start(void);

/* Both, some time after the reset. Fails the test if the port does not start. */
void hal_rig_open_and_start(hal_rig_way_t way);

tmini_stm32_hal_counters_t hal_rig_errors(void);

/* Puts packets on the line, as a real unit has sent it (section 9.14). */
void hal_rig_line_packets(unsigned count);

/* Lets the line run empty, and an idle line's time pass; then polls. */
void hal_rig_run(void);

/* This many packets come, until all have. */
void hal_rig_receive(unsigned packets);

/* Polls until there is nothing left to do. */
tmini_counters_t hal_rig_poll(void);

uint32_t hal_rig_packets(void);

#endif
