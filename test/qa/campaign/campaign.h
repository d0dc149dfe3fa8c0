/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the files of the campaign share. */

#ifndef CAMPAIGN_H
#define CAMPAIGN_H

#include "sim_line.h"

#include "random.h"

extern random_t dice;

static inline uint32_t below(uint32_t limit)
{
    return random_below(&dice, limit);
}

static inline uint32_t between(uint32_t low, uint32_t high)
{
    return random_between(&dice, low, high);
}

static inline bool one_in(uint32_t number)
{
    return number > 0 && below(number) == 0;
}

/* The mode of hours (soak.c), as main(): the arguments are "soak", the hours and the seed. */
int soak(int argc, char **argv);

/* A line that falls silent: holes of up to five turns, sometimes two close together. Holes begin
 * and end at any byte, but often have nearly a whole number of turns, by angle or by time.
 * Sometimes some bytes of each packet in it arrive, or only a start packet is lost. */

#define HOLES_SILENCES 1024u

typedef struct {
    uint64_t from_us;
    uint64_t to_us;
} silence_t;

typedef struct {
    uint32_t turn_us;
    uint32_t turns;   /* After this many nothing arrives. */
    uint32_t every;   /* The mean number of packets between two holes. */
    uint32_t left;    /* Holes to come. */
    uint32_t packets; /* Until the next one; */
    uint32_t bytes;   /* then bytes until it. */
    bool is_over;     /* The turns have been sent. */

    bool is_open;
    bool dribbles;
    bool of_start; /* Of the next start packet: all of it, or its first byte. */
    bool is_short;
    uint64_t to_q6; /* It ends before the first packet from there on, 0: not so; */
    uint64_t to_us; /* or then; */
    uint32_t size;  /* or after this many bytes. */

    uint64_t turned_q6; /* How far the rotor has turned in all, */
    uint16_t last_q6;   /* and the latest angle. */
    uint32_t drops;     /* Bytes of the present packet that arrive in a hole. */
    uint64_t heard_us;  /* The latest byte that has arrived. */
    silence_t silences[HOLES_SILENCES];
    uint32_t silence_count;
} holes_t;

extern holes_t holes;

/* `count` holes in this many turns, of `turn_us` each. */
void holes_begin(uint32_t count, uint32_t turns, uint32_t turn_us);

/* Whether byte `i` of the run is lost (sim_link_observer_t). Call it for each byte, in order. */
bool holes_take(void *context, const sim_run_t *run, size_t i);

/* The longest silence that ended in this time. */
uint64_t holes_longest_us(uint64_t from_us, uint64_t to_us);

#endif
