/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* As much of ESP-IDF as the ESP32 port needs, on threads, with the simulated lidar on the UART.
 *
 * Tasks are real threads and run at the same time, as on two cores. Time is virtual: it goes on, by
 * up to half a millisecond, only when all tasks wait for it. So nothing depends on how busy the
 * computer is. */

#ifndef VIRTUAL_IDF_H
#define VIRTUAL_IDF_H

#include <stdbool.h>
#include <stdint.h>

#include "simulator.h"

/* A world without tasks but the caller's, in which `observer` watches the lidar. */
void virtual_idf_begin(const sim_observer_t *observer);

/* The UART's interrupt is held off for this long, as by an operation on the flash. */
void virtual_idf_hold_interrupts(uint32_t duration_us);

/* Something else switches the UART's interrupts off and takes its receive pin away. */
void virtual_idf_break_reception(void);

/* What happens to the lidar: simulator.h. */
void virtual_idf_place_obstacle(uint16_t angle_q6, uint16_t width_q6, uint16_t distance_mm);
void virtual_idf_clear_obstacles(void);
void virtual_idf_power_lidar(bool on);
void virtual_idf_set_health(uint8_t bits);

bool virtual_idf_driver_is_installed(void);

/* Locks of the power management that are held. */
unsigned virtual_idf_locks_held(void);

/* Tasks besides the caller's. */
unsigned virtual_idf_tasks(void);

/* How many calls named a UART whose driver was not installed: 0, if all is well. */
unsigned virtual_idf_stray_calls(void);

/* What has been logged, as text. */
const char *virtual_idf_log(void);

/* At the start another function's, and no GPIO before gpio_reset_pin(). */
#define VIRTUAL_IDF_JTAG_PIN 10

/* The level of a pin; -1 if it is no output. */
int virtual_idf_pin(int pin);

/* Whether it has ever been an output that was low. */
bool virtual_idf_pin_has_been_low(int pin);

#endif
