/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A play is a row of a table (rows.h), told in words, and plays for each way of receiving that it
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
 *
 * and the port's own words. */

#ifndef PLAY_H
#define PLAY_H

#include <stdint.h>

#include "rows.h"

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

/* Defined by a port's test: tables of words, in which the last name is NULL, and then NULL. */
extern const play_word_t *const port_words[];

/* Plays a row, for run_rows(). */
void play_row(const row_t *row);

/* The next byte on the line comes with these errors. */
void play_damage(uint32_t errors);

/* For tests that are no rows: P:count; P:count run; packets; bytes accounted for. */
void play_send(uint32_t count);
void play_receive(uint32_t count);
uint32_t play_packets(void);
uint32_t play_accounted(void);

/* Begins with this way; starts the port for a lidar without power. */
void play_begin(unsigned way);
void play_start(unsigned way);

#endif
