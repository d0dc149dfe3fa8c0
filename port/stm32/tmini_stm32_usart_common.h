/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The part of the port that both kinds of USART share: everything except the places of the
 * registers and how flags are cleared. Each of the two sources defines these and then includes this
 * file; no other file does.
 *
 *   STATUS CR1 CR2 CR3 BRR DATA_IN DATA_OUT   indices of registers
 *   CR1_UE                                    the bit that switches the USART on
 *   clear_flags(registers, status)            clears the errors and the idle flag in `status` */

#ifndef TMINI_STM32_USART_COMMON_H
#define TMINI_STM32_USART_COMMON_H

/** The largest error of the baud rate from dividing the clock, in 1/1000. The receiver tolerates
 * 3.3 % in all, and the lidar's own clock needs part of it. */
#define BAUD_ERROR_MAX 20u

/** These bits are the same in SR and ISR. */
#define STATUS_FE (1u << 1)
#define STATUS_NE (1u << 2)
#define STATUS_ORE (1u << 3)
#define STATUS_IDLE (1u << 4)
#define STATUS_RXNE (1u << 5)
#define STATUS_TXE (1u << 7)
#define STATUS_ERRORS (STATUS_FE | STATUS_NE | STATUS_ORE)

#define CR1_RE (1u << 2)
#define CR1_TE (1u << 3)
#define CR1_IDLEIE (1u << 4)
#define CR1_RXNEIE (1u << 5)  /**< Also for overruns. */
#define CR1_INTERRUPTS 0x1F0u /**< These two, TCIE, TXEIE, PEIE. */
#define CR3_EIE (1u << 0)
#define CR3_DMAR (1u << 6)

#define DMA_COUNT 0xFFFFu

/* A test replaces the registers by a model. */
#ifdef TMINI_STM32_ACCESS_HEADER
#include TMINI_STM32_ACCESS_HEADER
#else
static inline uint32_t read_register(const volatile uint32_t *at)
{
    return *at;
}

static inline void write_register(volatile uint32_t *at, uint32_t value)
{
    *at = value;
}
#endif

static inline void clear_flags(volatile uint32_t *registers, uint32_t status);

/* ------------------------------------------------------------------------------- receiving */

static volatile uint32_t *registers_of(const tmini_stm32_usart_t *port)
{
    return port->wiring.usart;
}

static bool is_by_dma(const tmini_stm32_usart_t *port)
{
    return port->circle.size != 0;
}

static void count_errors(tmini_stm32_usart_t *port, uint32_t errors)
{
    volatile tmini_stm32_usart_counters_t *const counters = &port->counters;
    counters->overruns = counters->overruns + ((errors & STATUS_ORE) != 0);
    counters->framing_errors = counters->framing_errors + ((errors & STATUS_FE) != 0);
    counters->noise_errors = counters->noise_errors + ((errors & STATUS_NE) != 0);
}

/** An overrun means that an unknown number of bytes was lost after the byte in the data
 * register. */
static void take_byte(tmini_stm32_usart_t *port)
{
    volatile uint32_t *const registers = registers_of(port);
    const uint32_t status = read_register(&registers[STATUS]);
    count_errors(port, status);
    clear_flags(registers, status);
    if ((status & STATUS_RXNE) != 0) {
        const uint8_t byte = (uint8_t)read_register(&registers[DATA_IN]);
        port->counters.bytes = port->counters.bytes + 1;
        tmini_feed_byte(port->lidar, byte);
    }
    if ((status & STATUS_ORE) != 0) {
        tmini_feed_gap(port->lidar);
    }
}

static void change(volatile uint32_t *at, uint32_t clear, uint32_t set)
{
    write_register(at, (read_register(at) & ~clear) | set);
}

/** An error flag that is still set from a byte counted before is not counted again. The idle flag
 * cannot be cleared while a byte waits for the DMA. If the channel has stopped, the idle line would
 * interrupt endlessly, so its interrupt is disabled until the next poll. */
static void look_at_line(tmini_stm32_usart_t *port)
{
    volatile uint32_t *const registers = registers_of(port);
    const uint32_t status = read_register(&registers[STATUS]);
    count_errors(port, status & ~port->line_flags);
    clear_flags(registers, status);
    const uint32_t left = read_register(&registers[STATUS]);
    port->line_flags = left & STATUS_ERRORS;
    if ((left & (STATUS_IDLE | STATUS_RXNE)) == (STATUS_IDLE | STATUS_RXNE)) {
        change(&registers[CR1], CR1_IDLEIE, 0);
    }
}

static void hand_over(tmini_stm32_usart_t *port)
{
    tmini_stm32_circle_t *const circle = &port->circle;
    const uint8_t middles =
        circle->middles; /* Read before the position, which may only be newer. */
    const uint8_t ends = circle->ends;
    const uint16_t position =
        (uint16_t)(circle->size - (read_register(port->wiring.remaining) & DMA_COUNT));
    if (tmini_stm32_circle_advance(circle, position, middles, ends)) {
        port->counters.laps = port->counters.laps + 1;
        tmini_feed_gap(port->lidar);
    }
    tmini_feed_dma(port->lidar, circle->position);
}

static void hand_over_new(tmini_stm32_usart_t *port)
{
    if (!tmini_stm32_circle_enter(&port->circle)) {
        return;
    }
    do {
        hand_over(port);
    } while (tmini_stm32_circle_leave(&port->circle));
}

/** Clears the idle flag first, even if another context is handing over: otherwise the idle line
 * would interrupt endlessly and the poll would never end. */
void tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port)
{
    if (is_by_dma(port)) {
        look_at_line(port);
        hand_over_new(port);
    } else if (port->lidar != NULL) {
        take_byte(port);
    }
}

void tmini_stm32_usart_dma_interrupt(tmini_stm32_usart_t *port, bool half, bool complete)
{
    if (is_by_dma(port)) {
        tmini_stm32_circle_report(&port->circle, half, complete);
        hand_over_new(port);
    }
}

/* ------------------------------------------------------------------------ the port's functions */

static int send_bytes(void *context, const uint8_t *bytes, size_t count)
{
    volatile uint32_t *const registers = registers_of(context);
    int taken = 0;
    while ((size_t)taken < count && (read_register(&registers[STATUS]) & STATUS_TXE) != 0) {
        write_register(&registers[DATA_OUT], bytes[taken]);
        taken++;
    }
    return taken;
}

/** Every tmini_poll() calls this, so it also hands over what DMA has written since the last
 * interrupt. */
static uint32_t time_now_ms(void *context)
{
    tmini_stm32_usart_t *const port = context;
    volatile uint32_t *const registers = registers_of(port);
    if (is_by_dma(port)) {
        hand_over_new(port);
        look_at_line(port); /* An overrun may stop further bytes, and so their interrupts. */
        if ((read_register(&registers[CR1]) & CR1_IDLEIE) == 0) {
            change(&registers[CR1], 0, CR1_IDLEIE);
        }
    }
    return *port->wiring.time_ms;
}

/* --------------------------------------------------------------------------- the USART's set-up */

/* With 16-fold oversampling BRR is the divider in sixteenths: clock divided by baud rate. */
static uint32_t divider(uint32_t clock_hz)
{
    return (clock_hz + TMINI_STM32_BAUD_RATE / 2) / TMINI_STM32_BAUD_RATE;
}

static bool is_good_clock(uint32_t clock_hz)
{
    const uint32_t made_hz = divider(clock_hz) * TMINI_STM32_BAUD_RATE;
    const uint32_t error_hz = made_hz > clock_hz ? made_hz - clock_hz : clock_hz - made_hz;
    return clock_hz == 0 ||
           (divider(clock_hz) >= 16 && error_hz <= made_hz / 1000 * BAUD_ERROR_MAX);
}

/* The other registers can be written only while the USART is off. */
static void switch_on(const tmini_stm32_usart_t *port)
{
    volatile uint32_t *const registers = registers_of(port);
    const uint32_t clock_hz = port->wiring.clock_hz;
    change(&registers[CR1], CR1_UE | CR1_INTERRUPTS, 0);
    if (clock_hz != 0) {
        write_register(&registers[CR1], 0);
        write_register(&registers[CR2], 0);
        write_register(&registers[CR3], 0);
        write_register(&registers[BRR], divider(clock_hz));
    }
    change(&registers[CR3], CR3_EIE | CR3_DMAR, is_by_dma(port) ? CR3_DMAR : 0);
    clear_flags(registers, read_register(&registers[STATUS]));
    change(&registers[CR1], 0,
           CR1_UE | CR1_TE | CR1_RE | (is_by_dma(port) ? CR1_IDLEIE : CR1_RXNEIE));
}

/* The lidar is lost: perhaps something has changed the USART. */
static void restart(void *context)
{
    const tmini_stm32_usart_t *const port = context;
    if (port->lidar != NULL) {
        switch_on(port);
    }
}

const tmini_port_t tmini_stm32_usart_port = {
    .write = send_bytes, .now_ms = time_now_ms, .wait = NULL, .restart = restart};

/* -------------------------------------------------------------------------------- life cycle */

tmini_status_t tmini_stm32_usart_init(tmini_stm32_usart_t *port,
                                      const tmini_stm32_usart_wiring_t *wiring)
{
    if (port == NULL || wiring == NULL || wiring->usart == NULL || wiring->time_ms == NULL ||
        !is_good_clock(wiring->clock_hz)) {
        return TMINI_ERROR_ARGUMENT;
    }
    *port = (tmini_stm32_usart_t){.wiring = *wiring};
    return TMINI_OK;
}

static bool are_set_up(const tmini_stm32_usart_t *port, const tmini_t *lidar)
{
    return port != NULL && port->wiring.usart != NULL && tmini_stm32_circle_is_set_up(lidar);
}

/* True if the DMA channel is at the buffer's start and covers the whole buffer. */
static bool is_good_channel(const tmini_stm32_usart_t *port, size_t size)
{
    const volatile uint32_t *const remaining = port->wiring.remaining;
    return size <= TMINI_STM32_CIRCLE_MAX && remaining != NULL &&
           (read_register(remaining) & DMA_COUNT) == size;
}

tmini_status_t tmini_stm32_usart_start(tmini_stm32_usart_t *port, tmini_t *lidar)
{
    if (!are_set_up(port, lidar)) {
        return TMINI_ERROR_STATE;
    }
    const size_t size = tmini_stm32_circle_size(lidar);
    if (size != 0) {
        if (!is_good_channel(port, size)) {
            return TMINI_ERROR_ARGUMENT;
        }
        tmini_stm32_circle_rewind(lidar);
    }
    tmini_stm32_circle_begin(&port->circle, size);
    port->line_flags = 0;
    port->lidar = lidar;
    switch_on(port);
    return TMINI_OK;
}

void tmini_stm32_usart_stop(tmini_stm32_usart_t *port)
{
    volatile uint32_t *const registers = registers_of(port);
    change(&registers[CR1], CR1_INTERRUPTS, 0);
    change(&registers[CR3], CR3_DMAR, 0);
    if (is_by_dma(port)) {
        hand_over_new(port);
        port->circle.size = 0;
    }
    port->lidar = NULL;
}

void tmini_stm32_usart_counters(const tmini_stm32_usart_t *port,
                                tmini_stm32_usart_counters_t *counters)
{
    *counters = port->counters;
}

#endif
