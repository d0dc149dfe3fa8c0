/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "irq_lines.h"

#include <stddef.h>

#define MAIN_PROGRAM UINT16_MAX /* A priority below all others. */
#define PLACES_SKIPPED 15u

irq_t irq;

void irq_reset(void (*on_lock_up)(unsigned line))
{
    irq = (irq_t){.on_lock_up = on_lock_up, .level = MAIN_PROGRAM};
}

static bool may_run(const irq_line_t *line)
{
    return line->handler != NULL && !line->disabled && line->priority < irq.level && line->is_up();
}

/* Among equal priorities, the first. */
static irq_line_t *most_urgent(void)
{
    irq_line_t *chosen = NULL;
    for (unsigned i = 0; i < IRQ_LINES && !irq.masked; i++) {
        irq_line_t *const line = &irq.lines[i];
        if ((chosen == NULL || line->priority < chosen->priority) && may_run(line)) {
            chosen = line;
        }
    }
    return chosen;
}

static void run(irq_line_t *line)
{
    const unsigned level = irq.level;
    irq.nested += irq_is_in_handler();
    irq.level = line->priority;
    line->served++;
    line->handler();
    irq.level = level;
}

void irq_serve(void)
{
    uint32_t entries[IRQ_LINES] = {0};
    for (irq_line_t *line = most_urgent(); line != NULL; line = most_urgent()) {
        const ptrdiff_t number = line - irq.lines;
        if (++entries[number] > IRQ_LOCK_UP) {
            irq.on_lock_up((unsigned)number);
            return;
        }
        run(line);
    }
}

void irq_happen_after(uint32_t accesses, void (*event)(void))
{
    irq.event_at = irq.accesses + accesses + 1;
    irq.event = event;
}

void irq_access(void)
{
    void (*const event)(void) = irq.event;
    irq.accesses++;
    if (event != NULL && irq.accesses == irq.event_at) {
        irq.event = NULL;
        event();
    }
    irq_serve();
}

bool irq_is_in_handler(void)
{
    return irq.level != MAIN_PROGRAM;
}

uint32_t irq_next_place(random_t *random, uint32_t place)
{
    return place + 1 + random_below(random, PLACES_SKIPPED);
}
