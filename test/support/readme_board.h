/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the programs in the documents take for granted, so that test/docs.sh can compile them. */

#ifndef README_BOARD_H
#define README_BOARD_H

#include "tmini/tmini.h"

typedef struct {
    uint32_t DR;
} usart_t;

extern usart_t *const USART1;
extern const tmini_port_t board_port;
extern int board_uart;

void USART1_IRQHandler(void);
void UART1_Handler(void);
int uart_write(void *uart, const uint8_t *bytes, size_t count);
void avoid_obstacles(const tmini_scan_t *scan);
void signal_fault(uint8_t faults);

#endif
