/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An RP2040 as far as the port talks to it, with the simulated lidar on UART1: the UART's FIFO with
 * its error flags, level and timeout interrupt; DMA channels with ring, chain and transfer count;
 * pins; and a clock that goes on only when the test, or something that a test has arranged, makes
 * it.
 *
 * Facts from the data sheets (RP2040 sections 2.5 and 4.2, RP2350 12.6):
 *   - the FIFO holds 32 entries of a byte and four flags; a byte that finds it full is lost, and
 *     the next one stored carries the overrun flag;
 *   - the interrupt is raised at the level chosen, or after 32 bit times without a byte;
 *   - a channel triggered takes over its last transfer count and counts down; at 0 it triggers the
 *     channel that it is chained to; its write address stays where it is;
 *   - with a ring only the address's low bits count up. */

#ifndef PICO_MODEL_H
#define PICO_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

#define PICO_PINS 48

/* A chip after reset, with a lidar at rest that `observer` watches. */
void pico_model_begin(const sim_observer_t *observer);

/* The lidar; see simulator.h. */
sim_t *pico_model_lidar(void);

uint64_t pico_model_now_us(void);

/* Time passes: bytes come, DMA moves them, interrupts are served. */
void pico_model_pass(uint32_t us);

/* The same, while no interrupt is served. */
void pico_model_pass_held_up(uint32_t us);

/* When DMA's position has been read `reads` times more, time passes before the reader goes on. */
void pico_model_pass_after_read(unsigned reads, uint32_t us);

/* Time passes at random after readings of DMA's position: mostly some bytes' worth, at times
 * laps. */
void pico_model_be_erratic(uint64_t seed);

/* How often DMA's position has been read. */
unsigned pico_model_reads(void);

/* The channel at work moves this many bytes at once, as if much time had passed; nothing is
 * written. */
void pico_model_move_on(uint32_t bytes);

/* DMA stops, as after a bus error: both channels have nothing left to do. */
void pico_model_break_dma(void);

/* DMA gets no turn on the bus, or gets it again. */
void pico_model_block_dma(bool blocked);

/* Bytes as if the lidar had sent them now, with the data register's error flags. */
void pico_model_receive(uint32_t flags, const uint8_t *bytes, size_t count);

/* Bytes that have come on the line so far, also those that were lost. */
uint32_t pico_model_line_bytes(void);

/* From now on DMA channels or an interrupt belong to another part of the program; the baud rate is
 * wrong. */
void pico_model_take_channels(unsigned count);
void pico_model_take_interrupt(unsigned number);
void pico_model_set_baud_error(int permille);

/* A transmitter that is busy until it is called again. */
void pico_model_fill_transmitter(unsigned places_left);

unsigned pico_model_claimed_channels(void);
bool pico_model_is_claimed(unsigned channel);
bool pico_model_is_interrupt_enabled(unsigned number);
bool pico_model_has_handler(void);
bool pico_model_asks_for_interrupts(void);

/* How often one channel has taken over from another. */
unsigned pico_model_changes_of_channel(void);
unsigned pico_model_interrupts(void);
unsigned pico_model_baud_rate(void);

/* A pin's function, pull-up and level; -1: never set. */
int pico_model_function(unsigned pin);
bool pico_model_is_pulled_up(unsigned pin);
int pico_model_level(unsigned pin);

/* Called whenever the program sleeps; may leave by longjmp(). NULL: nothing. */
void pico_model_on_sleep(void (*callback)(void));

/* What printf() does in a program built for the model: see console.h. */
int pico_model_printf(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
