/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * Interrupt lines that behave as a real machine's, for the models in port tests. A line is up while
 * a flag of the device and that flag's enable bit are both set. So a handler that does not clear
 * its flag is entered again as soon as it returns. One line interrupts another only with a higher
 * priority.
 *
 * Lines interrupt only in irq_access(). Models call it at each access of a register, tests at each
 * access of an index that both sides use (interrupting_atomic.h).
 */

#ifndef IRQ_LINES_H
#define IRQ_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "random.h"

#define IRQ_LINES 4u

/* This many entries in a row, without lower-priority code in between, count as an error. */
#define IRQ_LOCK_UP 1000u

typedef struct {
    bool (*is_up)(void);   /* In the device, a flag and its enable bit are set. */
    void (*handler)(void); /* NULL: none. */
    unsigned priority;     /* A lower number interrupts a higher one. */
    bool disabled;         /* In the interrupt controller. */
    uint32_t served;       /* How often the handler was entered. */
} irq_line_t;

typedef struct {
    irq_line_t lines[IRQ_LINES];
    bool masked;                       /* All lines, in the processor. */
    void (*on_lock_up)(unsigned line); /* A flag is never cleared: fail the test. */
    uint32_t nested;                   /* How often a handler interrupted another. */
    uint32_t accesses;                 /* Calls of irq_access(). */

    /* Private. */
    unsigned level; /* Priority of the running code. */
    uint32_t event_at;
    void (*event)(void);
} irq_t;

extern irq_t irq;

/* Removes all lines. `on_lock_up` need not return. */
void irq_reset(void (*on_lock_up)(unsigned line));

/* Runs the handlers of lines that are up and may interrupt the running code, until there is
 * none. */
void irq_serve(void);

/* An access: calls the event planned for it, then serves the lines. */
void irq_access(void);

/* After `accesses` accesses, the next one calls `event` once; it may set a flag or advance time. */
void irq_happen_after(uint32_t accesses, void (*event)(void));

/* Whether a handler runs, so that models can report calls that only the main program may make. */
bool irq_is_in_handler(void);

/* The access to try for an event after the access `place`: on average 8 accesses later. */
uint32_t irq_next_place(random_t *random, uint32_t place);

#endif
