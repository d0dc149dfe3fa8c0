/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of the RP2040 hardware that the port uses, with the simulated lidar on UART1: the UART's
 * FIFO with its error flags, level and timeout interrupt; DMA channels with ring, chain and
 * transfer count; pins; and a clock that advances only in the functions below.
 *
 * Facts from the data sheets (RP2040 sections 2.5 and 4.2, RP2350 12.6):
 *   - the FIFO holds 32 entries of a byte and four flags; a byte that finds it full is lost, and
 *     the next one stored carries the overrun flag;
 *   - the interrupt is raised at the chosen level, or after 32 bit times without a byte;
 *   - a triggered channel reloads its transfer count and counts down; at 0 it triggers the channel
 *     that it is chained to; its write address is not reloaded;
 *   - with a ring, only the low bits of the address count up. */

#ifndef PICO_MODEL_H
#define PICO_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

#define PICO_PINS 48

/* Resets the chip. The lidar is at rest, and `observer` watches it. */
void pico_model_begin(const sim_observer_t *observer);

sim_t *pico_model_lidar(void);

uint64_t pico_model_now_us(void);

/* Time passes: bytes arrive, DMA moves them, interrupts are served. */
void pico_model_pass(uint32_t us);

/* As above, but no interrupt is served. */
void pico_model_pass_held_up(uint32_t us);

/* After DMA's position has been read `reads` more times, time passes before the reader
 * continues. */
void pico_model_pass_after_read(unsigned reads, uint32_t us);

/* After each reading of DMA's position, a random time passes: mostly some bytes, sometimes several
 * laps. */
void pico_model_be_erratic(uint64_t seed);

unsigned pico_model_reads(void);

/* The active channel advances by this many bytes at once, but writes nothing. */
void pico_model_move_on(uint32_t bytes);

/* Stops DMA, as a bus error does: both channels become idle. */
void pico_model_break_dma(void);

/* Blocks DMA, as a busy bus does, or unblocks it. */
void pico_model_block_dma(bool blocked);

/* Bytes arrive now, with these error flags of the data register. */
void pico_model_receive(uint32_t flags, const uint8_t *bytes, size_t count);

/* Bytes that have arrived on the line so far, including lost ones. */
uint32_t pico_model_line_bytes(void);

/* Other code takes DMA channels or an interrupt, or baud rates are wrong by this much. */
void pico_model_take_channels(unsigned count);
void pico_model_take_interrupt(unsigned number);
void pico_model_set_baud_error(int permille);

/* Sets the room in the transmitter, which then stays busy until the next call. */
void pico_model_fill_transmitter(unsigned places_left);

unsigned pico_model_claimed_channels(void);
bool pico_model_is_claimed(unsigned channel);
bool pico_model_is_interrupt_enabled(unsigned number);
bool pico_model_has_handler(void);
bool pico_model_asks_for_interrupts(void);

/* How often one DMA channel has taken over from the other. */
unsigned pico_model_changes_of_channel(void);
unsigned pico_model_interrupts(void);
unsigned pico_model_baud_rate(void);

/* A pin's function, pull-up and level; -1: the pin was never set. */
int pico_model_function(unsigned pin);
bool pico_model_is_pulled_up(unsigned pin);
int pico_model_level(unsigned pin);

/* Called whenever the program sleeps; may leave by longjmp(), or be NULL. */
void pico_model_on_sleep(void (*callback)(void));

/* Replaces printf() in a program built for the model: see console.h. */
int pico_model_printf(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
