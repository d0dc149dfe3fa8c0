/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the models of the platforms share: virtual time, the simulated lidar or a test's own bytes
 * on the line of a UART with its FIFO and its interrupt line (irq_lines.h), and the console. Tests
 * and models read and set its members directly. */

#ifndef MACHINE_H
#define MACHINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

#define MACHINE_FIFO_MAX 128u
#define MACHINE_BYTE_NS 43403u /* 10 bits at 230400 baud. */

/* One platform's UART. */
typedef struct {
    size_t fifo_size;
    void (*arrive)(uint32_t flags, uint8_t byte); /* A byte comes from the line, with errors. */
    void (*move)(void);  /* What the UART does by itself: DMA empties the FIFO. NULL: nothing. */
    bool (*is_up)(void); /* The interrupt line, and its handler. */
    void (*serve)(void);
    void (*switch_tasks)(void); /* A kernel gives the processor to another task; NULL: none. */
} machine_uart_t;

typedef struct {
    sim_t lidar;
    uint64_t now_us;
    uint64_t now_ns;    /* The same time. */
    uint32_t access_ns; /* Time that an access takes. */
    machine_uart_t uart;
    uint16_t fifo[MACHINE_FIFO_MAX]; /* Bytes with their errors. */
    size_t count;
    uint64_t last_us;       /* When the last byte came. */
    uint32_t line_bytes;    /* Bytes on the line so far, including lost ones. */
    void (*on_sleep)(void); /* Called when the program sleeps; may leave by longjmp(), or NULL. */
} machine_t;

extern machine_t machine;

/* Resets everything; `observer` watches the lidar, which is at rest. */
void machine_begin(const sim_observer_t *observer, const machine_uart_t *uart);

/* Replaces the lidar by another one. */
void machine_new_lidar(const sim_observer_t *observer);

/* A step of time: bytes arrive, DMA moves them, the interrupt is served. */
void machine_step(uint32_t us);
void machine_pass(uint32_t us);

/* A step in which nothing runs: in silence to the lidar's next byte, but not beyond `until_us`. */
void machine_idle(uint64_t until_us);

/* As machine_pass(), but no interrupt is served meanwhile. */
void machine_pass_held_up(uint32_t us);

/* Bytes arrive now. The interrupt comes when the FIFO is full, and at the end. */
void machine_receive(uint32_t flags, const uint8_t *bytes, size_t count);

/* These bytes follow each other on the line at full speed, after those sent before; the first one
 * comes with errors. */
void machine_send(uint32_t flags, const uint8_t *bytes, size_t count);
bool machine_has_sent(void);

/* An access to a register: time passes, then interrupts may come. */
void machine_access(void);

/* Puts an entry into the FIFO; returns false if it was full. */
bool machine_put(uint32_t entry);

/* A UART's cause to interrupt: this many entries, or no byte for this time while some wait. */
bool machine_must_read(size_t level, uint32_t timeout_us);

/* Takes entries out of the FIFO. */
uint16_t machine_take(void);
size_t machine_read(uint8_t *bytes, size_t max);

/* The program sleeps. */
void machine_sleep_us(uint64_t us);

/* Power of the lidar. */
void machine_power(bool on);

/* Replaces printf(): see console.h. */
int machine_printf(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
