/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stm32_model.h"

#define NOTHING_RUNS 100u
#define STEP_NS 5000u

model_t model;
USART_TypeDef model_usart;

void model_reset(void)
{
    model = (model_t){.access_ns = 100, .level = NOTHING_RUNS, .flags = MODEL_TXE | MODEL_TC};
    model.priority[MODEL_USART_IRQ] = 5;
    model.priority[MODEL_DMA_IRQ] = 5;
    model_usart = (USART_TypeDef){0};
}

/* ----------------------------------------------------------------------------------- DMA, USART */

static void dma_write(uint8_t byte)
{
    model_dma_t *const dma = &model.dma;
#ifdef STM32_MODEL_DCACHE
    model.ram[dma->size - dma->channel.CBR1] = byte;
#else
    dma->memory[dma->size - dma->channel.CBR1] = byte;
#endif
    dma->channel.CBR1--;
    if (dma->channel.CBR1 == dma->size / 2u) {
        dma->flags |= MODEL_DMA_HT;
    }
    if (dma->channel.CBR1 == 0) {
        dma->flags |= MODEL_DMA_TC;
        dma->enabled = dma->circular;
        dma->channel.CBR1 = dma->circular ? dma->size : 0;
    }
}

static uint8_t take_data(void)
{
    model.flags &= ~(MODEL_RXNE | model.seen);
    model.seen = 0;
    return model.data;
}

static void serve_dma(void)
{
    if ((model.flags & MODEL_RXNE) != 0 && (model_usart.CR3 & MODEL_CR3_DMAR) != 0 &&
        model.dma.enabled) {
        dma_write(take_data());
    }
}

static void receive(const model_byte_t *byte)
{
    if ((model.flags & MODEL_RXNE) != 0) {
        model.flags |= MODEL_ORE;
        model.overruns++;
    } else {
        model.data = byte->byte;
        model.flags |= MODEL_RXNE | byte->errors;
    }
    model.was_busy = true;
    model.idle_ns = byte->at_ns + MODEL_BYTE_NS;
    serve_dma();
}

/* What has come by now, and the silence behind it. */
static void catch_up(void)
{
    model_byte_t byte;
    while (model.next != NULL && model.next(&byte) && byte.at_ns <= model.now_ns) {
        model.take();
        receive(&byte);
    }
    if (model.was_busy && model.now_ns >= model.idle_ns) {
        model.was_busy = false;
        model.flags |= MODEL_IDLE;
    }
    serve_dma();
}

/* ----------------------------------------------------------------------------------- interrupts */

static bool usart_interrupts(void)
{
    const uint32_t cr1 = model_usart.CR1;
    const bool errors = (model.flags & (MODEL_FE | MODEL_NE | MODEL_ORE)) != 0;
    return ((cr1 & MODEL_CR1_RXNEIE) != 0 && (model.flags & (MODEL_RXNE | MODEL_ORE)) != 0) ||
           ((cr1 & MODEL_CR1_IDLEIE) != 0 && (model.flags & MODEL_IDLE) != 0) ||
           ((cr1 & MODEL_CR1_TXEIE) != 0 && (model.flags & MODEL_TXE) != 0) ||
           ((model_usart.CR3 & MODEL_CR3_EIE) != 0 && errors);
}

static bool is_pending(model_irq_t irq)
{
    return irq == MODEL_USART_IRQ ? usart_interrupts()
                                  : (model.dma.flags & model.dma.interrupts) != 0;
}

static bool may_run(model_irq_t irq)
{
    return is_pending(irq) && !model.disabled[irq] && model.handler[irq] != NULL &&
           model.priority[irq] < model.level && model.now_ns >= model.irq_held_until_ns[irq];
}

static void run(model_irq_t irq)
{
    const unsigned level = model.level;
    model.level = model.priority[irq];
    model.interrupts[irq]++;
    model.nested += level != NOTHING_RUNS;
    model.handler[irq]();
    model.level = level;
}

static void interrupt(void)
{
    while (!model.masked && model.now_ns >= model.held_until_ns) {
        const bool usart = may_run(MODEL_USART_IRQ);
        const bool dma = may_run(MODEL_DMA_IRQ);
        if (!usart && !dma) {
            return;
        }
        const bool dma_first =
            dma && model.priority[MODEL_DMA_IRQ] < model.priority[MODEL_USART_IRQ];
        run(usart && !dma_first ? MODEL_USART_IRQ : MODEL_DMA_IRQ);
    }
}

/* The tick's interrupt is held back like all others, and what it has missed it does not catch up
 * with. */
static void advance(uint64_t ns)
{
    model.now_ns += ns;
    if (model.now_ns >= model.held_until_ns) {
        model.tick_ns += ns;
    }
    catch_up();
    interrupt();
}

void model_step(void)
{
    if (model.on_access != NULL) {
        model.on_access();
    }
    advance(model.access_ns);
}

void model_pass(uint64_t us)
{
    const uint64_t end_ns = model.now_ns + us * 1000u;
    while (model.now_ns < end_ns) {
        const uint64_t left_ns = end_ns - model.now_ns;
        advance(left_ns < STEP_NS ? left_ns : STEP_NS);
    }
}

/* ------------------------------------------------------------------------------------- accesses */

uint32_t model_status(void)
{
    model_step();
#ifdef STM32_MODEL_SR
    model.seen = model.flags & (MODEL_FE | MODEL_NE | MODEL_ORE | MODEL_IDLE);
#endif
    return model.flags;
}

uint8_t model_read_data(void)
{
    model_step();
    return take_data();
}

void model_write_data(uint8_t byte)
{
    model_step();
    if (model.sent != NULL) {
        model.sent(byte, model.now_ns / 1000u);
    }
}

void model_clear(uint32_t flags)
{
    model_step();
    model.flags &= ~flags;
}

void model_set(volatile uint32_t *reg, uint32_t bits)
{
    model_step();
    *reg |= bits;
    advance(0);
}

void model_unset(volatile uint32_t *reg, uint32_t bits)
{
    model_step();
    *reg &= ~bits;
}

uint32_t model_dma_left(void)
{
    model_step();
    const uint32_t left = model.dma.channel.CBR1;
    model_step(); /* What is read is old already when it is used. */
    return left;
}

uint32_t model_tick_ms(void)
{
    return (uint32_t)(model.tick_ns / 1000000u);
}
