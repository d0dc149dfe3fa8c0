/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of ESP-IDF that the ESP32 port needs, with the simulated lidar on the UART.
 *
 * Tasks are real threads and run at the same time, as on two cores. Time is virtual: it advances
 * only when all tasks wait, in steps of up to half a millisecond. So results do not depend on how
 * busy the computer is. */

#ifndef VIRTUAL_IDF_H
#define VIRTUAL_IDF_H

#include <stdbool.h>
#include <stdint.h>

#include "machine.h"

/* Resets the model, with the caller as the only task. `observer` watches the lidar. */
void virtual_idf_begin(const sim_observer_t *observer);

/* Delays the UART's interrupt for this long, as an operation on the flash does. */
void virtual_idf_hold_interrupts(uint32_t duration_us);

/* Switches the UART's interrupts off and disconnects its receive pin, as other code could do. */
void virtual_idf_break_reception(void);

/* While it is locked, a test may change the simulated lidar. */
void virtual_idf_lock(void);
void virtual_idf_unlock(void);

typedef struct {
    unsigned tasks;       /* With the caller. */
    bool installed;       /* The UART's driver. */
    unsigned stray_calls; /* Calls for a UART without a driver; should be 0. */
    unsigned locks_held;  /* Of the power management. */
} virtual_idf_state_t;

virtual_idf_state_t virtual_idf_state(void);

const char *virtual_idf_log(void);

/* This pin belongs to JTAG at first, and is a GPIO only after gpio_reset_pin(). */
#define VIRTUAL_IDF_JTAG_PIN 10

/* The level of a pin; -1 if it is no output. */
int virtual_idf_pin(int pin);

/* True if the pin has ever been an output with low level. */
bool virtual_idf_pin_has_been_low(int pin);

#endif
