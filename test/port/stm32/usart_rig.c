/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "usart_rig.h"

usart_rig_t usart_rig;

const tmini_port_t *const rig_port = &tmini_stm32_usart_port;
void *const rig_context = &usart_rig.port;

static void usart_handler(void)
{
    tmini_stm32_usart_interrupt(&usart_rig.port);
}

static void dma_handler(void)
{
    const uint32_t flags = model.dma.flags;
    model_step();
    model.dma.flags &= ~flags;
    tmini_stm32_usart_dma_interrupt(&usart_rig.port, (flags & MODEL_DMA_HT) != 0,
                                    (flags & MODEL_DMA_TC) != 0);
}

void rig_open(rig_way_t way)
{
    (void)way;
    model_reset();
    irq.lines[MODEL_USART_IRQ].handler = usart_handler;
    irq.lines[MODEL_DMA_IRQ].handler = dma_handler;
    usart_rig.wiring = (tmini_stm32_usart_wiring_t){.usart = &model_usart,
                                                    .clock_hz = 84000000,
                                                    .time_ms = &model.tick_ms,
                                                    .remaining = &model.dma.channel.CBR1};
    (void)tmini_stm32_usart_init(&usart_rig.port, &usart_rig.wiring);
}

tmini_status_t rig_start(void)
{
    size_t size = 0;
    uint8_t *const memory = tmini_rx_buffer(&lidar, &size);
    if (memory != NULL) {
        model.dma = (model_dma_t){.enabled = true,
                                  .circular = true,
                                  .memory = memory,
                                  .size = (uint16_t)size,
                                  .channel = {(uint32_t)size},
                                  .interrupts = MODEL_DMA_HT | MODEL_DMA_TC};
    }
    return tmini_stm32_usart_start(&usart_rig.port, &lidar);
}

void rig_stop(void)
{
    tmini_stm32_usart_stop(&usart_rig.port);
}

rig_errors_t rig_errors(void)
{
    tmini_stm32_usart_counters_t c;
    tmini_stm32_usart_counters(&usart_rig.port, &c);
    return (rig_errors_t){.overruns = c.overruns,
                          .framing_errors = c.framing_errors,
                          .noise_errors = c.noise_errors,
                          .laps = c.laps};
}

bool rig_is_off(void)
{
    const uint32_t on = model_usart.CR1 & (MODEL_CR1_RXNEIE | MODEL_CR1_IDLEIE);
    return on == 0 && (model_usart.CR3 & MODEL_CR3_DMAR) == 0;
}

void rig_break_reception(void)
{
    model_usart = (USART_TypeDef){0};
}
