/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What programs in the documents need from a board and from the reader's own program. Registers
 * have the chip makers' names. */

#ifndef BOARD_H
#define BOARD_H

#include "tmini/tmini.h"

/* A USART of an STM32: F1, F2, F4 and L1 have SR and DR; the other series have ISR, RDR and ICR.
 * ../handlers.py checks that no handler mixes them. */
typedef struct {
    volatile uint32_t SR;
    volatile uint32_t DR;
    volatile uint32_t ISR;
    volatile uint32_t RDR;
    volatile uint32_t ICR;
} board_usart_t;

#define USART_SR_ORE (1u << 3)
#define USART_SR_RXNE (1u << 5)
#define USART_SR_TXE (1u << 7)
#define USART_ISR_ORE (1u << 3)
#define USART_ISR_RXNE (1u << 5)
#define USART_ICR_ORECF (1u << 3)

extern board_usart_t board_usart1;
#define USART1 (&board_usart1)

typedef enum {
    USART1_IRQn = 37,
    DMA2_Stream2_IRQn = 58,
} IRQn_Type;
void NVIC_EnableIRQ(IRQn_Type interrupt);

extern const tmini_port_t board_port;

/* Functions of the reader's program. */
void avoid_obstacles(const tmini_scan_t *scan);
void steer_away_from(unsigned degrees, unsigned distance_mm);
void signal_faults(uint8_t faults);
void stop_robot(void);
void halt(void);
void use(const tmini_scan_t *scan);
void handle(tmini_event_t event);
void sleep_ms(uint32_t milliseconds);
int uart_write(void *uart, const uint8_t *bytes, size_t count);
size_t uart_take(uint8_t *bytes, size_t size, int *overrun);

#endif
