/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stm32_model.h"

#include <string.h>

#include "interrupting_atomic.h"
#include "unity.h"

#define STEP_NS 5000u

#define ERRORS (MODEL_FE | MODEL_NE | MODEL_ORE)

model_t model;
USART_TypeDef model_usart;

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

static bool has_fifo(void)
{
#ifdef STM32_MODEL_SR
    return false;
#else
    return (model_usart.CR1 & MODEL_CR1_FIFOEN) != 0;
#endif
}

/* RXNE means that a byte waits, also with the FIFO on. */
static void note_waiting(void)
{
    const bool half = has_fifo() && model.waiting >= MODEL_FIFO / 2;
    model.flags &= ~(MODEL_RXNE | MODEL_RXFT);
    model.flags |= (model.waiting > 0 ? MODEL_RXNE : 0u) | (half ? MODEL_RXFT : 0u);
}

static uint8_t take_data(void)
{
    const uint8_t byte = model.data[0];
    if (model.waiting > 1) { /* The last byte can be read again. */
        memmove(model.data, &model.data[1], MODEL_FIFO - 1);
    }
    model.waiting = (uint8_t)(model.waiting - (model.waiting > 0));
    model.flags &= ~model.seen;
    model.seen = 0;
    note_waiting();
    return byte;
}

static bool is_dma_requested(void)
{
    const bool held = (model_usart.CR3 & MODEL_CR3_DDRE) != 0 && (model.flags & ERRORS) != 0;
    return (model.flags & MODEL_RXNE) != 0 && (model_usart.CR3 & MODEL_CR3_DMAR) != 0 && !held;
}

static void serve_dma(void)
{
    while (is_dma_requested() && model.dma.enabled) {
        dma_write(take_data());
    }
}

static bool receives(void)
{
    const uint32_t on = MODEL_CR1_UE | MODEL_CR1_RE;
    return (model_usart.CR1 & on) == on;
}

static void receive(const model_byte_t *byte)
{
    const bool held = model.ore_holds_rxne && (model.flags & MODEL_ORE) != 0;
    if (held || model.waiting >= (has_fifo() ? MODEL_FIFO : 1u)) {
        model.flags |= MODEL_ORE;
        model.overruns++;
    } else {
        model.data[model.waiting++] = byte->byte;
        model.flags |= byte->errors;
        note_waiting();
    }
    model.was_busy = model.was_busy || !held;
    model.idle_ns = byte->at_ns + MODEL_BYTE_NS;
    serve_dma();
}

/* Receives the bytes that have arrived by now, and notices an idle line after them. */
static void catch_up(void)
{
    model_byte_t byte;
    while (model.next != NULL && model.next(&byte) && byte.at_ns <= model.now_ns) {
        model.take();
        if (receives()) {
            receive(&byte);
        }
    }
    if (model.was_busy && model.now_ns >= model.idle_ns) {
        model.was_busy = false;
        model.flags |= MODEL_IDLE;
    }
    serve_dma();
}

/* ----------------------------------------------------------------------------------- interrupts */

static bool is_held(void)
{
    return model.now_ns < model.held_until_ns;
}

static bool usart_interrupts(void)
{
    const uint32_t cr1 = model_usart.CR1;
    return ((cr1 & MODEL_CR1_RXNEIE) != 0 && (model.flags & (MODEL_RXNE | MODEL_ORE)) != 0) ||
           ((cr1 & MODEL_CR1_IDLEIE) != 0 && (model.flags & MODEL_IDLE) != 0) ||
           ((cr1 & MODEL_CR1_TXEIE) != 0 && (model.flags & MODEL_TXE) != 0) ||
           ((model_usart.CR3 & MODEL_CR3_RXFTIE) != 0 && (model.flags & MODEL_RXFT) != 0) ||
           ((model_usart.CR3 & MODEL_CR3_EIE) != 0 && (model.flags & ERRORS) != 0);
}

static bool is_usart_up(void)
{
    return usart_interrupts() && !is_held();
}

static bool is_dma_up(void)
{
    return (model.dma.flags & model.dma.interrupts) != 0 && !is_held();
}

static void fail(unsigned line)
{
    TEST_FAIL_MESSAGE(line == MODEL_USART_IRQ ? "the USART's handler leaves its flag: a lock-up"
                                              : "the DMA's handler leaves its flag: a lock-up");
}

void model_reset(void)
{
    model = (model_t){.access_ns = 100, .flags = MODEL_TXE | MODEL_TC};
    model_usart = (USART_TypeDef){.CR1 = MODEL_CR1_UE | MODEL_CR1_RE | MODEL_CR1_TE};
    irq_reset(fail);
    irq.lines[MODEL_USART_IRQ] = (irq_line_t){.is_up = is_usart_up, .priority = 5};
    irq.lines[MODEL_DMA_IRQ] = (irq_line_t){.is_up = is_dma_up, .priority = 5};
}

/* The tick's interrupt is held back like all others. Ticks missed meanwhile are lost. */
static void pass(uint64_t ns)
{
    model.now_ns += ns;
    if (!is_held()) {
        model.tick_ns += ns;
    }
    catch_up();
}

static void advance(uint64_t ns)
{
    pass(ns);
    irq_serve();
}

void model_step(void)
{
    pass(model.access_ns);
    irq_access();
}

/* An index of the library is accessed. */
void interrupt(void)
{
    model_step();
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
    model_step(); /* DMA may advance before the caller uses the value. */
    return left;
}

uint32_t model_read(const volatile uint32_t *at)
{
#ifdef STM32_MODEL_SR
    const volatile uint32_t *const status = &model_usart.SR;
    const volatile uint32_t *const data = &model_usart.DR;
#else
    const volatile uint32_t *const status = &model_usart.ISR;
    const volatile uint32_t *const data = &model_usart.RDR;
#endif
    if (at == status) {
        return model_status();
    }
    if (at == data) {
        return model_read_data();
    }
    if (at == &model.dma.channel.CBR1) {
        return model_dma_left() | 0xFFFF0000u; /* The upper half has other fields. */
    }
    model_step();
    return *at;
}

void model_write(volatile uint32_t *at, uint32_t value)
{
#ifdef STM32_MODEL_SR
    volatile uint32_t *const to_send = &model_usart.DR;
#else
    volatile uint32_t *const to_send = &model_usart.TDR;
    if (at == &model_usart.ICR) {
        model_clear(value);
        return;
    }
#endif
    if (at == to_send) {
        model_write_data((uint8_t)value);
        return;
    }
    model_step();
    *at = value;
    advance(0);
}

uint32_t model_tick_ms(void)
{
    return (uint32_t)(model.tick_ns / 1000000u);
}
