/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the driver's files ask of each other. Calls go downwards only:
 *
 *     tmini.c              state, events, public functions, the time of this poll
 *      ├ tmini_recovery.c  what to try next, and when
 *      │  └ tmini_command.c  one command at a time
 *      └ tmini_monitor.c   packets to faults
 *
 * Each writes its own group of members of tmini_t (`command`, `recovery`, `monitor`; tmini.c `link`
 * and those without a group). Ring, parser and builder are written by their own modules only, which
 * know nothing of tmini_t. test/layers.sh checks both. docs/design.md draws the states and
 * lists the phases. */

#ifndef TMINI_DRIVER_H
#define TMINI_DRIVER_H

#include "tmini/tmini.h"

/* True when a time that began at `since_ms` is over; across the clock's wrap-around too. */
static inline bool tmini_has_elapsed(const tmini_t *lidar, uint32_t since_ms, uint32_t wait_ms)
{
    return lidar->link.now_ms - since_ms >= wait_ms;
}

/* ------------------------------------------------------------------------------------ tmini.c */

/* Gives up the command under way: for the blocking helpers, which stand above. */
void tmini_cancel(tmini_t *lidar);

/* ---------------------------------------------------------------------------- tmini_command.c */

/* What goes on on the wire. */
typedef enum {
    TMINI_PHASE_NONE,           /* Nothing is under way; the lidar may be streaming. */
    TMINI_PHASE_IDLE,           /* The same; the lidar was left idle, and the line quiet. */
    TMINI_PHASE_QUIESCING,      /* Behind a stop, or between frequency steps: until it is quiet. */
    TMINI_PHASE_AWAITING_REPLY, /* A command has been sent: until its reply. */
    TMINI_PHASE_AWAITING_STEP,  /* The same; one has come that shows no step: until another. */
    TMINI_PHASE_SPINNING_UP,    /* The start has been acknowledged: until the first packet. */
    TMINI_PHASE_WAITING,        /* A reboot has been sent, or nothing: as long as it takes. */
} tmini_phase_t;

/* How a command stands: TMINI_OK, it has ended well; an error, it has failed; or this. */
#define TMINI_UNDER_WAY 1

/* Begins an operation, in the place of one that may be under way, and names it by its command;
 * first comes a stop, whose bytes leave with the next tmini_command_poll(). A time-out is followed
 * by another attempt, up to `attempts` in all. A `frequency_chz` other than 0 is where a question
 * for the frequency is to lead: it is then set. */
void tmini_command_begin(tmini_t *lidar, tmini_command_code_t operation, uint8_t attempts,
                         uint16_t frequency_chz);

/* The line is quiet: the next command of the operation may be sent. Called from above, after
 * tmini_command_begin(), when the lidar is known to be idle: then it needs no stop before. */
int tmini_command_proceed(tmini_t *lidar);

/* Goes on with what is due now: bytes to send, a line that is quiet, a time that is over. */
int tmini_command_poll(tmini_t *lidar);

/* The awaited reply has come, with this content. */
int tmini_command_reply(tmini_t *lidar, const uint8_t *content);

/* Sends nothing and ends well after a time; 0: never. While it runs, nothing else is under way.
 * Begun anew by each packet it is a watchdog: its end says that none has come. */
void tmini_command_wait(tmini_t *lidar, uint16_t wait_ms);

/* What is under way has ended with `result`, or is given up with an error. After a stop the lidar
 * is idle, and after an answer to the first attempt; after a second one, the reply to the first may
 * still come. */
void tmini_command_end(tmini_t *lidar, int result);

/* --------------------------------------------------------------------------- tmini_recovery.c */

/* Begins to bring back a lidar that has been lost. */
void tmini_recovery_begin(tmini_t *lidar);

/* What is under way has ended, well or not: goes on with the next. */
void tmini_recovery_go_on(tmini_t *lidar, int result);

/* The lidar is back, by an attempt or by itself. */
static inline void tmini_recovery_end(tmini_t *lidar)
{
    lidar->recovery.recoveries++;
}

/* A complete revolution has come, or a command from the user: the next loss is a new one. */
static inline void tmini_recovery_forget(tmini_t *lidar)
{
    lidar->recovery.attempts = 0;
}

/* ---------------------------------------------------------------------------- tmini_monitor.c */

/* Scanning begins, anew or again: nothing continues what was before. */
void tmini_monitor_begin(tmini_t *lidar);

/* Takes the packet in lidar->latest, and what it tells of the revolution that it ends. True if a
 * complete revolution has ended with it. */
bool tmini_monitor_packet(tmini_t *lidar, tmini_ct_verdict_t verdict);

/* Looks after time while scanning. */
void tmini_monitor_poll(tmini_t *lidar);

#endif
