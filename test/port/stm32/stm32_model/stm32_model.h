/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of the hardware: one USART at 230400 baud with one DMA channel, on two interrupt lines
 * (machine.h has time, line and FIFO). Registers are accessed only by these functions: reading has
 * side effects. Each access takes some nanoseconds, in which interrupts may come.
 *
 * Variants, by macros:
 *   STM32_MODEL_SR            registers SR and DR (F1, F2, F4, L1), where reading clears flags;
 *                             else ISR, ICR, RDR
 *   STM32_MODEL_STREAMS       a DMA with FIFO (F2, F4, F7, H7)
 *   STM32_MODEL_LINKED_LISTS  a DMA that is circular by linked lists (H5, U5), and after an error
 *                             continues with the rest of its block
 *   STM32_MODEL_DCACHE        the CPU sees what DMA has written only after it has invalidated the
 *                             cache lines
 *   STM32_MODEL_YEAR          of the HAL in stm32_model_hal.h. 2019: locks its handles, and has no
 *                             reception until the line is idle; 2021: has it, but without the type
 *                             of the event; 2024: no locks, and an idle event at a full buffer;
 *                             2025: half and full events with DMA's real position
 *   STM32_MODEL_NO_DMA        the HAL's DMA module is switched off */

#ifndef STM32_MODEL_H
#define STM32_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "irq_lines.h"

/* Flags with the same bits in SR and ISR. */
#define MODEL_FE (1u << 1)
#define MODEL_NE (1u << 2)
#define MODEL_ORE (1u << 3)
#define MODEL_IDLE (1u << 4)
#define MODEL_RXNE (1u << 5)
#define MODEL_TC (1u << 6)
#define MODEL_TXE (1u << 7)
#define MODEL_RXFT (1u << 26) /* The FIFO has reached the threshold in CR3. */

#ifdef STM32_MODEL_SR
#define MODEL_CR1_UE (1u << 13)
#else
#define MODEL_CR1_UE (1u << 0)
#endif
#define MODEL_CR1_RE (1u << 2)
#define MODEL_CR1_TE (1u << 3)
#define MODEL_CR1_IDLEIE (1u << 4)
#define MODEL_CR1_RXNEIE (1u << 5)
#define MODEL_CR1_TXEIE (1u << 7)
#define MODEL_CR1_PEIE (1u << 8)
#define MODEL_CR1_FIFOEN (1u << 29)
#define MODEL_CR3_EIE (1u << 0)
#define MODEL_CR3_DMAR (1u << 6)
#define MODEL_CR3_DDRE (1u << 13) /* An error holds the DMA's requests back until it is cleared. */
#define MODEL_CR3_RXFTCFG_HALF (2u << 25)
#define MODEL_CR3_RXFTIE (1u << 28)

#define MODEL_FIFO 8u

/* DMA flags and the interrupts that they raise. */
#define MODEL_DMA_TE (1u << 2)
#define MODEL_DMA_HT (1u << 3)
#define MODEL_DMA_TC (1u << 4)

#ifdef STM32_MODEL_SR
typedef struct {
    volatile uint32_t SR, DR, BRR, CR1, CR2, CR3;
} USART_TypeDef;
#else
typedef struct {
    volatile uint32_t CR1, CR2, CR3, BRR, GTPR, RTOR, RQR, ISR, ICR, RDR, TDR;
} USART_TypeDef;
#endif

/* What is left of this round, with the name for linked lists. */
typedef struct {
    volatile uint32_t CBR1;
} DMA_Channel_TypeDef;

typedef struct {
    bool enabled;
    bool circular;
    uint8_t *memory;
    uint16_t size;
    DMA_Channel_TypeDef channel;
    uint32_t flags;
    uint32_t interrupts;
} model_dma_t;

enum { MODEL_USART_IRQ, MODEL_DMA_IRQ };

typedef struct {
    /* Set by tests. */
    uint64_t held_until_ns; /* No interrupt is served before this time. */
    bool ore_holds_rxne;    /* No byte is received while ORE is set, as on many boards. */

    /* With a data cache: the buffer as the CPU sees it, and the real content of its memory. */
    uint8_t *cached;
    size_t cached_size;
    uint8_t ram[1024];

    /* State of the hardware. */
    uint64_t seen_ns;
    uint64_t tick_ns; /* Time that the tick's interrupt has counted. */
    volatile uint32_t tick_ms;
    uint32_t flags;
    uint32_t seen; /* Flags read in SR: reading DR clears them. */
    uint8_t data;  /* The last byte read, which can be read again. */
    bool was_busy;
    uint64_t idle_ns;
    model_dma_t dma;
    uint32_t sent_count;
    uint8_t sent[2]; /* The last two bytes. */
} model_t;

extern model_t model;
extern USART_TypeDef model_usart;

/* Resets machine and model: the USART is on and idle; interrupt lines have equal priority and no
 * handlers. */
void model_reset(void);

uint32_t model_status(void);   /* Reads SR or ISR. */
uint8_t model_read_data(void); /* Reads DR or RDR. */
void model_write_data(uint8_t byte);
void model_clear(uint32_t flags); /* Writes ICR. */
void model_set(volatile uint32_t *reg, uint32_t bits);
void model_unset(volatile uint32_t *reg, uint32_t bits);
uint32_t model_dma_left(void);

/* Access one of these registers by its address, for the port that does without the HAL. */
uint32_t read_register(const volatile uint32_t *at);
void write_register(volatile uint32_t *at, uint32_t value);

/* Accesses something else: time passes. */
void model_step(void);

#endif
