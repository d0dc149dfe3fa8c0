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
 * know nothing of tmini_t. test/layers.sh checks both. docs/design.md has the states and phases as
 * a drawing. */

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

/* How a command stands: TMINI_OK, it has ended well; an error, it has failed; or this. */
#define TMINI_UNDER_WAY 1

/* Begins an operation, in the place of one that may be under way, and names it by its command;
 * first comes a stop, whose bytes leave with the next tmini_command_poll(). A time-out is followed
 * by another attempt, up to `attempts` in all. A `frequency_chz` other than 0 is where a question
 * for the frequency is to lead: it is then set. */
void tmini_command_begin(tmini_t *lidar, tmini_command_code_t operation, uint8_t attempts,
                         uint16_t frequency_chz);

/* The lidar is known to be idle, and the line quiet: an operation just begun, other than a stop,
 * needs none before its command. */
void tmini_command_skip_stop(tmini_t *lidar);

/* Goes on with what is due now: bytes to send, a line that is quiet, a time that is over. */
int tmini_command_poll(tmini_t *lidar);

/* The awaited reply has come, with this content. */
int tmini_command_reply(tmini_t *lidar, const uint8_t *content);

/* A packet has come while a start or a reboot is under way. True if it shows that the start has
 * ended well, or that a lidar being rebooted scans: the command is then over. Not so the tail
 * behind a stop (section 9.10). */
bool tmini_command_packet(tmini_t *lidar);

/* Sends nothing and ends well after a time; 0: never. While it runs, nothing else is under way. */
void tmini_command_wait(tmini_t *lidar, uint16_t wait_ms);

/* Gives up what is under way, without a word. */
void tmini_command_cancel(tmini_t *lidar);

/* True while nothing is under way, and the lidar was left idle: the line was quiet then. */
bool tmini_command_left_idle(const tmini_t *lidar);

/* --------------------------------------------------------------------------- tmini_recovery.c */

/* Begins to bring back a lidar that has been lost. */
void tmini_recovery_begin(tmini_t *lidar);

/* What is under way has ended, well or not: goes on with the next. */
void tmini_recovery_go_on(tmini_t *lidar, int result);

/* The lidar is back, by an attempt or by itself. */
void tmini_recovery_end(tmini_t *lidar);

/* A complete revolution has come: the next loss is a new one. */
void tmini_recovery_forget(tmini_t *lidar);

/* ---------------------------------------------------------------------------- tmini_monitor.c */

/* What a packet showed; a combination. */
enum {
    TMINI_SHOWN_FAULTS = 1,   /* The faults have changed. */
    TMINI_SHOWN_COMPLETE = 2, /* A complete revolution has ended with it. */
    TMINI_SHOWN_LOSS = 4,     /* LastCRC says that a packet of the revolution was lost. */
};

/* Scanning begins, anew or again: nothing continues what was before. */
void tmini_monitor_begin(tmini_t *lidar);

/* Takes the packet in lidar->latest. */
unsigned tmini_monitor_packet(tmini_t *lidar);

/* Looks after time while scanning. True if the faults have changed. */
bool tmini_monitor_poll(tmini_t *lidar);

#endif
