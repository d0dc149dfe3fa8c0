/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The interfaces between the driver's files. Calls go downwards only:
 *
 *     tmini.c               wishes, state, events, public functions
 *      ├ tmini_recovery.c   the ladder: what to try next, and when
 *      │  └ tmini_command.c one command at a time
 *      ├ tmini_monitor.c    packets to faults
 *      ├ tmini_line.c       the time of bytes: arrival, silence, pauses, doubt
 *      └ tmini_decoder.c    bytes to packets, replies and scans
 *
 * Each writes its own group of members of tmini_t (`command`, `recovery`, `monitor`, `line`;
 * tmini.c `link` and those without a group). Ring and decoder are written by their own modules
 * only, which know nothing of tmini_t. test/layers.sh checks both. docs/design.md draws the states
 * and lists the phases. */

#ifndef TMINI_DRIVER_H
#define TMINI_DRIVER_H

#include "tmini/tmini.h"

/* Waiting times in milliseconds that no user needs to change. */
#define TMINI_STOP_TIMEOUT_MS 600     /* Twice the longest tail seen after a stop (section 9.10). */
#define TMINI_WRITE_TIMEOUT_MS 100    /* For the port to take two bytes (87 us on the wire). */
#define TMINI_SPIN_UP_TIMEOUT_MS 3000 /* From the start reply to the first packet. */
#define TMINI_DATA_TIMEOUT_MS 1000    /* A lidar without a valid packet for this long is lost. */
#define TMINI_REBOOT_TIME_MS 5000     /* "Some seconds" (section 9.11). */
#define TMINI_BACK_OFF_MS 500         /* The first pause after an attempt that failed. */

/* How far the frequency that is set may be from the wanted one: half the finest step. */
#define TMINI_FREQUENCY_TOLERANCE_CHZ 5

/* True if `wait_ms` have passed since `since_ms`, also across the clock's wrap-around. */
static inline bool tmini_has_elapsed(const tmini_t *lidar, uint32_t since_ms, uint32_t wait_ms)
{
    return lidar->line.now_ms - since_ms >= wait_ms;
}

/* ------------------------------------------------------------------------------------ tmini.c */

/* Gives up the current query. Used by the blocking helpers. */
void tmini_cancel(tmini_t *lidar);

/* ------------------------------------------------------------------------------- tmini_line.c */

/* Reads the clock, and notes whether bytes have come since the last look. True if they have, or may
 * have: the line is not quiet. */
bool tmini_line_look(tmini_t *lidar);

/* When the packet found last came: the arrival of the newest bytes, less the time on the wire of
 * the bytes after the packet. Call tmini_line_look() first. */
uint32_t tmini_line_arrival_ms(const tmini_t *lidar);

/* True if packets may be missing before the packet found last, which came at `came_ms`: the line
 * has paused, or the packet is late. Call it once for each packet. */
bool tmini_line_is_doubtful(tmini_t *lidar, uint32_t came_ms);

/* ---------------------------------------------------------------------------- tmini_command.c */

/* What happens on the wire. */
typedef enum {
    TMINI_PHASE_NONE,           /* No command is in progress; the lidar may be scanning. After a
                                 * failed stop or query, TMINI_PHASE_IDLE follows. */
    TMINI_PHASE_IDLE,           /* No command, and the lidar should be idle: if it scans, it is
                                 * stopped. */
    TMINI_PHASE_QUIESCING,      /* After a stop, or between frequency steps, until the line is
                                 * quiet. */
    TMINI_PHASE_AWAITING_REPLY, /* From sending a command until its reply. */
    TMINI_PHASE_AWAITING_STEP,  /* After a reply to a step that shows no change. */
    TMINI_PHASE_SPINNING_UP,    /* From the reply to the start until the first packet. */
    TMINI_PHASE_WAITING,        /* For a fixed time: after a reboot, or in a pause. */
} tmini_phase_t;

/* The result of a command is TMINI_OK, an error, or this: it has not ended. */
#define TMINI_UNDER_WAY 1

/* Begins an operation, named by the event of its success; it replaces the current one. The next
 * tmini_command_poll() first sends a stop, unless the lidar `is_idle` and the line quiet. After a
 * time-out there is another attempt, unless the ladder repeats attempts. TMINI_EVENT_FREQUENCY also
 * sets the wanted frequency, if there is one. */
void tmini_command_begin(tmini_t *lidar, tmini_event_t operation, bool is_idle);

/* Does what is due now: sends bytes, continues when the line is quiet, handles time-outs. */
int tmini_command_poll(tmini_t *lidar);

/* For how long tmini_command_poll() has nothing to do unless bytes come; 0: call it each time. */
uint16_t tmini_command_idle_ms(const tmini_t *lidar);

/* The awaited reply has come, with this content. */
int tmini_command_reply(tmini_t *lidar, const uint8_t *content);

/* Begins an operation that sends nothing and succeeds after `wait_ms`; 0: never. If each packet
 * begins it again, it is a watchdog: its end means that no packet has come. */
void tmini_command_wait(tmini_t *lidar, uint16_t wait_ms);

/* Ends the current operation with `result`, or gives it up with an error. True if the lidar is idle
 * and the line quiet: after a stop, and after an answer to the first attempt. After a later attempt
 * the reply to an earlier one may still come. */
bool tmini_command_end(tmini_t *lidar, int result);

/* From now on this frequency is wanted; 0: any. Steps are counted from 0 again. */
static inline void tmini_command_want(tmini_t *lidar, uint16_t frequency_chz)
{
    lidar->command.wanted_chz = frequency_chz;
    lidar->command.steps = 0;
}

/* The frequency that is set is no longer known. */
static inline void tmini_command_forget_frequency(tmini_t *lidar)
{
    lidar->command.frequency_chz = 0;
}

/* True if the lidar has reported the wanted frequency, or none is wanted. */
bool tmini_command_has_frequency(const tmini_t *lidar);

/* --------------------------------------------------------------------------- tmini_recovery.c */

/* Begins the ladder at its first step. `is_idle`: the lidar is known to be idle, and the line
 * quiet. */
void tmini_recovery_start(tmini_t *lidar, bool is_idle);

/* Begins the ladder for a lidar that has been lost. If it has made no complete revolution since the
 * previous loss, the ladder continues instead. */
void tmini_recovery_begin(tmini_t *lidar);

/* Asks the port, if it can, to start its reception again: after a loss or a failed attempt. */
void tmini_recovery_restart_reception(const tmini_t *lidar);

/* An attempt has failed: waits before the next one. */
void tmini_recovery_back_off(tmini_t *lidar);

/* `ended` has succeeded, or the frequency could not be set: begins the next operation. `is_idle`:
 * as in tmini_recovery_start(). */
void tmini_recovery_go_on(tmini_t *lidar, tmini_event_t ended, bool is_idle);

/* The lidar is back, by an attempt or by itself. */
static inline void tmini_recovery_end(tmini_t *lidar)
{
    lidar->recovery.recoveries++;
}

/* The lidar has started, or a complete revolution has come: after the next loss the ladder begins
 * again. */
static inline void tmini_recovery_forget(tmini_t *lidar)
{
    lidar->recovery.attempts = 0;
}

/* ---------------------------------------------------------------------------- tmini_monitor.c */

/* Scanning begins: the next packet continues no earlier revolution. */
void tmini_monitor_begin(tmini_monitor_t *monitor);

/* What a packet shows about the rotor. */
typedef enum {
    TMINI_TURN_GOES_ON,
    TMINI_TURN_WHOLE,   /* The packet ends a complete revolution. */
    TMINI_TURN_OFF,     /* Revolutions have had a wrong frequency for too long. */
    TMINI_TURN_ENDLESS, /* Packets with ranges come, but no start packets: the lidar is lost. */
} tmini_turn_t;

/* Takes the latest packet. If it ends a revolution, judges that revolution. `wanted_chz` 0:
 * any. */
tmini_turn_t tmini_monitor_packet(tmini_monitor_t *monitor, const tmini_decoder_t *decoder,
                                  uint16_t wanted_chz);

/* The wanted frequency has changed: forgets the fault and the count of turns at a wrong one. */
void tmini_monitor_forget_frequency(tmini_monitor_t *monitor);

#endif
