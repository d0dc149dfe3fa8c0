/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * Interrupt lines as hard as the machine's, for the models under port tests. A line is up as long
 * as a flag of the device and that flag's enable bit are both set. So a handler that does not clear
 * its flag is entered again as soon as it returns. One line interrupts another only with a higher
 * priority.
 *
 * Models call irq_access() at each access of a register, tests at each access of an index that both
 * sides use (interrupting_atomic.h): there, and nowhere else, the lines interrupt.
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
    bool (*is_up)(void);   /* Asks the device: a flag and its enable both stand. */
    void (*handler)(void); /* NULL: there is none. */
    unsigned priority;     /* A lower number interrupts a higher one. */
    bool disabled;         /* In the interrupt controller. */
    uint32_t served;       /* Entries of the handler. */
} irq_line_t;

typedef struct {
    irq_line_t lines[IRQ_LINES];
    bool masked;                       /* All lines, in the processor. */
    void (*on_lock_up)(unsigned line); /* A line is not let down: fail the test. */
    uint32_t nested;                   /* Handlers that have interrupted another. */
    uint32_t accesses;                 /* So far. */

    /* The model's own. */
    unsigned level; /* The priority of what runs. */
    uint32_t event_at;
    void (*event)(void);
} irq_t;

extern irq_t irq;

/* No lines. `on_lock_up` need not return. */
void irq_reset(void (*on_lock_up)(unsigned line));

/* Runs the handler of each line that is up and may interrupt what runs, until there is none. */
void irq_serve(void);

/* An access: triggers the events planned for it, then serves the lines. */
void irq_access(void);

/* At the access after `accesses` others `event` happens once: raises a flag, lets time pass. */
void irq_happen_after(uint32_t accesses, void (*event)(void));

/* Whether interrupt code runs: what only the main program may do is an error there. */
bool irq_is_in_handler(void);

/* The place to try after `place`, of those at which an event may happen: a random one in eight; if
 * the environment has TMINI_EVERY_MOMENT, the next. */
uint32_t irq_next_place(random_t *random, uint32_t place);

#endif
