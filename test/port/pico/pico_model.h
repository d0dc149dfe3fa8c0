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

#include "hardware/dma.h"
#include "hardware/irq.h"
#include "hardware/uart.h"
#include "machine.h"

#define PICO_PINS 48
#define FIFO_SIZE 32u
#define CHANNELS 12u
#define IRQS 64u

typedef struct {
    bool overrun; /* The next entry gets the overrun flag. */
    bool receive_irq;
    unsigned places_to_send; /* With fewer than FIFO_SIZE places, they become fewer. */
    uart_hw_t hw;
} uart_model_t;

typedef struct {
    bool claimed;
    bool busy;
    bool enabled;
    dma_channel_config config;
    uint8_t *write;
    uint32_t reload;
    uint32_t count;
    dma_channel_hw_t shown;
} channel_t;

typedef struct {
    uart_model_t uart;
    channel_t channels[CHANNELS];
    bool dma_blocked; /* As a busy bus does. */
    irq_handler_t handlers[IRQS];
    bool irq_enabled[IRQS];
    unsigned baud_rate;
    int baud_error_permille;
    unsigned changes_of_channel; /* How often one DMA channel has taken over from the other. */
    /* After DMA's position has been read so often, this time passes before the reader continues. */
    unsigned pass_after;
    uint32_t pass_us;
    int functions[PICO_PINS]; /* Function and level of a pin; -1: never set. */
    int levels[PICO_PINS];
    bool values[PICO_PINS]; /* Bits of the output registers. */
    bool pulled_up[PICO_PINS];
} chip_t;

extern chip_t chip;

/* Resets the chip. The lidar is at rest, and `observer` watches it. */
void pico_model_begin(const sim_observer_t *observer);

/* The active channel advances by this many bytes at once, but writes nothing. */
void pico_model_move_on(uint32_t bytes);

/* Stops DMA, as a bus error does: both channels become idle. */
void pico_model_break_dma(void);

/* Other code takes DMA channels. */
void pico_model_take_channels(unsigned count);
unsigned pico_model_claimed_channels(void);

#endif
