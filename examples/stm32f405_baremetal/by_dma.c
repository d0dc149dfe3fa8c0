/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* DMA2's stream 2 on channel 4 is USART1_RX (RM0090, DMA request mapping). */

#include "board.h"
#include "reception.h"
#include "stm32f405.h"

const tmini_stm32_usart_wiring_t reception_wiring = {
    .usart = (volatile void *)USART1_BASE,
    .clock_hz = BOARD_USART1_CLOCK_HZ,
    .time_ms = &board_time_ms,
    .remaining = &DMA2_S2NDTR,
};

static tmini_stm32_usart_t *usart_port;

void DMA2_Stream2_IRQHandler(void);

/* Both flags in one call: if both are set, this interrupt is late. */
void DMA2_Stream2_IRQHandler(void)
{
    const uint32_t flags = DMA2_LISR & (DMA_STREAM2_HT | DMA_STREAM2_TC);
    DMA2_LIFCR = flags;
    tmini_stm32_usart_dma_interrupt(usart_port, (flags & DMA_STREAM2_HT) != 0,
                                    (flags & DMA_STREAM2_TC) != 0);
}

/* Circular, byte by byte, with a rising memory address; the FIFO is off after a reset. The stream
 * is switched off first, which takes a moment. */
static void start_stream(uint8_t *rx, uint16_t rx_size)
{
    RCC_AHB1ENR |= RCC_AHB1ENR_DMA2;
    DMA2_S2CR = 0;
    board_wait_for(&DMA2_S2CR, DMA_SCR_EN, 0);
    DMA2_LIFCR = DMA_STREAM2_ALL;
    DMA2_S2PAR = USART1_BASE + USART_DR_OFFSET;
    DMA2_S2M0AR = (uint32_t)(uintptr_t)rx;
    DMA2_S2NDTR = rx_size;
    DMA2_S2CR = DMA_SCR_CHANNEL(4) | DMA_SCR_MINC | DMA_SCR_CIRC | DMA_SCR_TCIE | DMA_SCR_HTIE;
    DMA2_S2CR |= DMA_SCR_EN;
}

tmini_status_t reception_start(tmini_stm32_usart_t *port, tmini_t *lidar, uint8_t *rx,
                               uint16_t rx_size)
{
    usart_port = port;
    start_stream(rx, rx_size);
    NVIC_ISER(DMA2_STREAM2_IRQ) = NVIC_BIT(DMA2_STREAM2_IRQ);
    return tmini_stm32_usart_start(port, lidar);
}
