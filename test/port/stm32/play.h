/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One of the STM32 ports on the model: what the tests of both share (every_port.h), and plays.
 *
 * A play is a row of a table (rows.h), told in words, and plays for each way of receiving that it
 * names. The simulated lidar has no power: only what the play sends comes.
 *
 *     bytes DMA:      plays where a way's name ends with one of these words; all: everywhere
 *     bytes idle:     as above, but the port is not started; else it is, after 10 ms
 *     for:5:20:5      plays with 5, 10 and 15 for each `it` in the words; only as the first word
 * then
 *     P P:20          a packet of 13 bytes follows on the line; 20 packets
 *     head tail       six bytes of such a packet; the other seven
 *     x x:20          a byte that belongs to no packet
 *     run             polls each millisecond until all has come and the line is idle
 *     +3 ~200         3 ms, with a poll in each; 200 µs without a poll
 *     poll            polls until there is no event
 *     start stop restart anew      the port; anew: sets the lidar up again
 *     break           breaks reception, as port_way_t says
 *     packets:9 packets<9 packets>9      this number, here after a poll, is 9, less, or greater
 *     skipped overrun accounted more     other numbers; more: packets since `mark`
 *     served position                    interrupts; how many bytes the lidar has been given
 *     30( P +1 )      that many times
 *     FE NE           the next byte comes with this error; FEs, NEs, ORE, others: their numbers
 *     hold:700        interrupts are held back for 700 µs; held:700: and this time passes
 *
 * more about the registers (play.c), and the port's own words. */

#ifndef PLAY_H
#define PLAY_H

#include "every_port.h"
#include "rows.h"
#include "stm32_model.h"

/* Indices of port_ways. */
typedef enum { BY_BYTES, BY_DMA, BY_BLOCKS } rig_way_t;

typedef struct {
    uint32_t bytes; /* Only without the HAL. */
    uint32_t overruns;
    uint32_t framing_errors;
    uint32_t noise_errors;
    uint32_t laps;
    uint32_t restarts;
    uint32_t other_errors;
} rig_counts_t;

extern rig_way_t rig_way; /* The one that has been chosen. */

/* A word that acts; that acts with the number after it, or 1; that is the name of a number. */
typedef struct {
    const char *name;
    void (*act)(void);
    void (*act_on)(uint32_t number);
    uint32_t (*count)(void);
} play_word_t;

/* Functions for such words. */
#define ACT(name, ...)     \
    static void name(void) \
    {                      \
        __VA_ARGS__;       \
    }
#define ACT_ON(name, ...)             \
    static void name(uint32_t number) \
    {                                 \
        __VA_ARGS__;                  \
    }
#define NUMBER(name, ...)               \
    static uint32_t name(void)          \
    {                                   \
        return (uint32_t)(__VA_ARGS__); \
    }

/* Defined for each port. */
extern const play_word_t port_words[]; /* The last name is NULL. */
void rig_open(void);                   /* Resets the hardware and sets the port up. */
tmini_status_t rig_start(void);        /* For `lidar`. */
rig_counts_t rig_counts(void);
bool rig_is_off(void);          /* Nothing of the port is switched on. */
void rig_break_reception(void); /* No flag shows it. */

/* Plays a row, for run_rows(). */
void play_row(const row_t *row);

/* For tests that are no rows: P:count; P:count run; packets; bytes accounted for. */
void play_send(uint32_t count);
void play_receive(uint32_t count);
uint32_t play_packets(void);
uint32_t play_accounted(void);

/* Begins with this way; starts the port for a lidar without power. */
void play_begin(unsigned way);
void play_start(unsigned way);

#endif
