/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_IRQ_H
#define HARDWARE_IRQ_H

#include "hardware/address_mapped.h"
#include "pico.h"

typedef void (*irq_handler_t)(void);
bool irq_has_handler(uint number);
void irq_set_exclusive_handler(uint number, irq_handler_t handler);
void irq_remove_handler(uint number, irq_handler_t handler);
void irq_set_enabled(uint number, bool enabled);

#endif
