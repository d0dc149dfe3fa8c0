/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stm32_model.h"

#include "machine.h"

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

static size_t fifo_size(void)
{
#ifdef STM32_MODEL_SR
    return 1;
#else
    return (model_usart.CR1 & MODEL_CR1_FIFOEN) != 0 ? MODEL_FIFO : 1;
#endif
}

/* RXNE means that a byte waits, also with the FIFO on. */
static void note_waiting(void)
{
    const bool half = machine.count >= MODEL_FIFO / 2;
    model.flags &= ~(MODEL_RXNE | MODEL_RXFT);
    model.flags |= (machine.count > 0 ? MODEL_RXNE : 0u) | (half ? MODEL_RXFT : 0u);
}

static uint8_t take_data(void)
{
    if (machine.count > 0) {
        model.data = (uint8_t)machine_take();
    }
    model.flags &= ~model.seen;
    model.seen = 0;
    note_waiting();
    return model.data;
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

static void receive(uint32_t errors, uint8_t byte)
{
    const bool held = model.ore_holds_rxne && (model.flags & MODEL_ORE) != 0;
    machine.uart.fifo_size = fifo_size();
    model.flags |= held || !machine_put(byte) ? MODEL_ORE : errors;
    note_waiting();
    model.was_busy = model.was_busy || !held;
    model.idle_ns = machine.now_ns + MACHINE_BYTE_NS;
    serve_dma();
}

static void arrive(uint32_t errors, uint8_t byte)
{
    if (receives()) {
        receive(errors, byte);
    }
}

/* ----------------------------------------------------------------------------------- interrupts */

static bool is_held(void)
{
    return machine.now_ns < model.held_until_ns;
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

/* The tick's interrupt is held back like all others. Ticks missed meanwhile are lost. After a byte
 * the line may fall idle. */
static void move(void)
{
    if (!is_held()) {
        model.tick_ns += machine.now_ns - model.seen_ns;
    }
    model.seen_ns = machine.now_ns;
    model.tick_ms = (uint32_t)(model.tick_ns / 1000000u);
    if (model.was_busy && machine.now_ns >= model.idle_ns) {
        model.was_busy = false;
        model.flags |= MODEL_IDLE;
    }
    serve_dma();
}

void model_reset(void)
{
    const machine_uart_t uart = {.arrive = arrive, .move = move, .is_up = is_usart_up};
    machine_begin(NULL, &uart);
    machine.access_ns = 100;
    model = (model_t){.flags = MODEL_TXE | MODEL_TC};
    model_usart = (USART_TypeDef){.CR1 = MODEL_CR1_UE | MODEL_CR1_RE | MODEL_CR1_TE};
    irq.lines[MODEL_USART_IRQ].priority = 5;
    irq.lines[MODEL_DMA_IRQ] = (irq_line_t){.is_up = is_dma_up, .priority = 5};
}

void model_step(void)
{
    machine_access();
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
    model.sent_count++;
    model.sent[0] = model.sent[1];
    model.sent[1] = byte;
    sim_receive(&machine.lidar, &byte, 1, machine.now_us);
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
    machine_step(0);
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

uint32_t read_register(const volatile uint32_t *at)
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

void write_register(volatile uint32_t *at, uint32_t value)
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
    machine_step(0);
}
