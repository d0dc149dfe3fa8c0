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
 * tmini.c those without a group), and reads only its own and those of files below it, and `link`,
 * the configuration. Ring and decoder are written by their own modules only, which know nothing of
 * tmini_t. test/layers.py checks all this. docs/design.md draws the states and phases. */

#ifndef TMINI_DRIVER_H
#define TMINI_DRIVER_H

#include "tmini/tmini.h"

/* Waiting times in milliseconds that no user needs to change. */
#define TMINI_STOP_TIMEOUT_MS \
    550                               /* The longest tail seen after a stop is 300 (section 9.10);
                                       * the time of a quiet line comes on top. */
#define TMINI_WRITE_TIMEOUT_MS 100    /* For the port to take two bytes (87 us on the wire). */
#define TMINI_SPIN_UP_TIMEOUT_MS 3000 /* From the start reply to the first packet. */
#define TMINI_DATA_TIMEOUT_MS 1000    /* A lidar without a valid packet for this long is lost. */
#define TMINI_REBOOT_TIME_MS 1000     /* After this, the driver asks whether a reboot is over. */
#define TMINI_BACK_OFF_MS 500         /* The first pause after an attempt that failed. */

/* How far the frequency that is set may be from the wanted one: half the finest step. */
#define TMINI_FREQUENCY_TOLERANCE_CHZ 5

/* True if `wait_ms` have passed since `since_ms`, also across the clock's wrap-around. */
static inline bool tmini_has_elapsed(const tmini_t *lidar, uint32_t since_ms, uint32_t wait_ms)
{
    return lidar->line.now_ms - since_ms >= wait_ms;
}

/* The place in the stream where parsing continues: the byte after the frame delivered last. */
static inline size_t tmini_position(const tmini_t *lidar)
{
    return tmini_ring_tail(&lidar->ring) + tmini_parser_frame(&lidar->decoder.parser)->size;
}

/* ------------------------------------------------------------------------------------ tmini.c */

/* Withdraws the wish for this query. Used by the blocking helpers. */
void tmini_withdraw(tmini_t *lidar, tmini_event_t query);

/* ------------------------------------------------------------------------------- tmini_line.c */

/* Of the time between two polls, at most this much counts as silence: bytes may be waiting in a
 * layer below. */
#define TMINI_UNSEEN_SILENCE_MAX_MS 50u

/* The driver has handled all that had come, unless the port holds more. */
static inline void tmini_line_settle(tmini_t *lidar)
{
    if (lidar->line.held == 0) {
        lidar->line.busy_ms = 0;
    }
}

/* True if the program is behind: what has come could not be handled for some time. */
static inline bool tmini_line_is_behind(const tmini_t *lidar)
{
    return lidar->line.busy_ms > 150;
}

/* Reads the clock, and notes whether bytes have come since the last look. True if they have, or may
 * have: the line is not quiet. `is_scanning`: the lidar sends packets. */
bool tmini_line_look(tmini_t *lidar, bool is_scanning);

/* When the packet found last came: the arrival of the newest bytes, less the time on the wire of
 * the bytes after the packet. Call tmini_line_look() first. */
uint32_t tmini_line_arrival_ms(const tmini_t *lidar);

/* True if packets may be missing before the packet found last, which came at `came_ms`: the line
 * has paused, or the packet is late. Call it once for each packet. */
bool tmini_line_is_doubtful(tmini_t *lidar, uint32_t came_ms);

/* ---------------------------------------------------------------------------- tmini_command.c */

/* What happens on the wire. docs/phases.svg draws them; tmini_command.c has a function for each way
 * in which they end. */
typedef enum {
    TMINI_PHASE_NONE,        /* No command is in progress, and the lidar may be scanning. */
    TMINI_PHASE_WATCHING,    /* No command, and the lidar should be idle: if it scans, it is
                              * stopped. */
    TMINI_PHASE_IDLE,        /* The same, and the line is known to be quiet. */
    TMINI_PHASE_QUIESCING,   /* From a stop until the line is quiet. */
    TMINI_PHASE_SETTLING,    /* After an answer, until the line is quiet for the next command. */
    TMINI_PHASE_ASKING,      /* Asks for the frequency again and again, until the first answer. */
    TMINI_PHASE_AWAITING,    /* From sending a command until its reply. */
    TMINI_PHASE_UNCHANGED,   /* After a reply to a step that shows no change: awaits another. */
    TMINI_PHASE_SPINNING_UP, /* From the reply to the start until the first packet. */
    TMINI_PHASE_TURNING,     /* A lost lidar sends ranges: until a start packet comes. */
    TMINI_PHASE_STANDING,    /* A lost lidar sends packets without ranges: likewise. */
    TMINI_PHASE_REBOOTING,   /* After a reboot. */
    TMINI_PHASE_PAUSING,     /* Between two attempts. */
    TMINI_PHASE_LISTENING,   /* Nothing is sent: until a packet comes. */
    TMINI_PHASE_SCANNING,    /* From packet to packet. */
    TMINI_PHASE_LAST_CHANCE, /* The same, when a poll came too late to know whether any came. */
} tmini_phase_t;

/* The result of a command is TMINI_OK, an error, or one of these. */
#define TMINI_UNDER_WAY 1 /* It has not ended. */
#define TMINI_SCANS 2     /* The lidar scans: packets come. */

/* The bit of tmini_command_t.unsent of a command that the port has not taken completely. */
#define TMINI_UNSENT 2u

/* True if the port has not taken the whole command yet. */
static inline bool tmini_command_is_sending(const tmini_t *lidar)
{
    return (lidar->command.unsent & TMINI_UNSENT) != 0;
}

/* True while packets are expected. */
static inline bool tmini_command_is_scanning(const tmini_t *lidar)
{
    return lidar->command.phase >= TMINI_PHASE_SCANNING;
}

/* True if a command is in progress or the lidar scans. */
static inline bool tmini_command_is_busy(const tmini_t *lidar)
{
    return lidar->command.phase > TMINI_PHASE_IDLE;
}

/* Begins an operation, named by the event of its success, and replaces the current one. Unless the
 * lidar is known to be idle, a stop is sent first. After a time-out there are other attempts, at
 * most `attempts` in all (0: one). TMINI_EVENT_FREQUENCY asks until the lidar answers, and then
 * sets the wanted frequency, if there is one; after a reboot it asks likewise. */
void tmini_command_begin(tmini_t *lidar, tmini_event_t operation, uint8_t attempts);

/* Does what is due now: sends bytes, continues when the line is quiet, handles time-outs. */
int tmini_command_poll(tmini_t *lidar);

/* The awaited reply has come, with this content. */
int tmini_command_reply(tmini_t *lidar, const uint8_t *content);

/* What a packet means in the current phase, while none is expected. */
typedef enum {
    TMINI_PACKET_UNWANTED, /* The lidar should be idle: its stop was lost on the wire. */
    TMINI_PACKET_IGNORED,  /* No news: for example, of the tail after a stop (section 9.10). */
    TMINI_PACKET_FIRST,    /* The lidar scans from now on, also if the reply to its start was
                            * lost. */
} tmini_packet_meaning_t;

/* What a packet shows by itself. */
typedef enum {
    TMINI_SIGN_STANDS, /* The lidar was lost; its rotor may be blocked (section 8). */
    TMINI_SIGN_TURNS,  /* The lidar was lost; it sends ranges, but perhaps no start packets. */
    TMINI_SIGN_SCANS,  /* All is well. */
} tmini_sign_t;

/* A packet has come. */
tmini_packet_meaning_t tmini_command_packet(tmini_t *lidar, tmini_sign_t sign);

/* Bytes have come: the line is no longer known to be quiet. */
static inline void tmini_command_disturb(tmini_t *lidar)
{
    if (lidar->command.phase == TMINI_PHASE_IDLE) {
        lidar->command.phase = TMINI_PHASE_WATCHING;
    }
}

/* True until the line is quiet. */
static inline bool tmini_command_awaits_quiet(const tmini_t *lidar)
{
    return lidar->command.phase == TMINI_PHASE_QUIESCING ||
           lidar->command.phase == TMINI_PHASE_SETTLING;
}

/* How much of the phase's time is left; UINT16_MAX: it has no limit. */
static inline uint16_t tmini_command_left_ms(const tmini_t *lidar)
{
    const tmini_command_t *const command = &lidar->command;
    const uint32_t passed_ms = lidar->line.now_ms - command->since_ms;
    return (uint16_t)(command->timeout_ms == 0 ? UINT16_MAX : command->timeout_ms - passed_ms);
}

/* For how long tmini_command_poll() has nothing to do unless bytes come; UINT16_MAX: without limit;
 * 0: the line is watched. */
static inline uint16_t tmini_command_idle_ms(const tmini_t *lidar)
{
    return tmini_command_awaits_quiet(lidar) ? 0 : tmini_command_left_ms(lidar);
}

/* The same, with the time until the line will be quiet. */
uint16_t tmini_command_due_ms(const tmini_t *lidar);

/* Begins a phase without an operation, in which nothing is sent: pausing, listening or scanning. It
 * lasts `wait_ms`; 0: without limit. */
void tmini_command_wait(tmini_t *lidar, tmini_phase_t phase, uint16_t wait_ms);

/* Ends the current operation with `result`, or gives it up with an error. The lidar is then idle,
 * and the line quiet, after a stop and after an answer to the first attempt. After a later attempt
 * the reply to an earlier one may still come. */
void tmini_command_end(tmini_t *lidar, int result);

/* From now on this frequency is wanted; 0: any. */
static inline void tmini_command_want(tmini_t *lidar, uint16_t frequency_chz)
{
    lidar->command.wanted_chz = frequency_chz;
}

/* Steps are counted anew: of an idle lidar each wish may have as many as it needs. */
static inline void tmini_command_renew_steps(tmini_t *lidar)
{
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

/* A wish is a bit, named by the event of its success: to scan, to stop, or a question. */
static inline bool tmini_recovery_wishes(const tmini_t *lidar, tmini_event_t event)
{
    return (lidar->recovery.wishes & 1u << event) != 0;
}

/* Adds a wish. The ladder will begin from its first attempt. */
void tmini_recovery_wish(tmini_t *lidar, tmini_event_t event);

/* A wish has been fulfilled, has failed or is withdrawn. */
static inline void tmini_recovery_forget_wish(tmini_t *lidar, tmini_event_t event)
{
    lidar->recovery.wishes &= (uint8_t) ~(1u << event);
}

/* To stop replaces all other wishes. */
static inline void tmini_recovery_forget_wishes(tmini_t *lidar)
{
    lidar->recovery.wishes = 0;
}

/* The first of these events in their order, or TMINI_EVENT_NONE. */
tmini_event_t tmini_recovery_first(unsigned events);

/* True if this operation is, or was, a step of the ladder, and no wish of its own. */
bool tmini_recovery_is_step(const tmini_t *lidar, tmini_event_t operation);

/* Begins the next operation that the wishes need, after `ended`: TMINI_EVENT_FREQUENCY, or
 * TMINI_EVENT_NONE. Without one the lidar rests. */
void tmini_recovery_go_on(tmini_t *lidar, tmini_event_t ended);

/* Begins the ladder from its first attempt. */
void tmini_recovery_restart(tmini_t *lidar);

/* Begins the ladder for a lidar that has been lost. If it has made no complete revolution since the
 * previous loss, the ladder continues instead. */
void tmini_recovery_begin(tmini_t *lidar);

/* Bits of tmini_recovery_t.contact. MUTE: the lidar has been asked again and again, and has not
 * answered since. ANSWERED: it has answered since it was set up. UNSET: the wanted frequency could
 * not be set, which has not been reported. */
#define TMINI_CONTACT_MUTE 1u
#define TMINI_CONTACT_ANSWERED 2u
#define TMINI_CONTACT_UNSET 4u

/* A reply has come. */
static inline void tmini_recovery_note_reply(tmini_t *lidar)
{
    lidar->recovery.contact |= TMINI_CONTACT_ANSWERED;
    lidar->recovery.contact &= (uint8_t)~TMINI_CONTACT_MUTE;
}

/* The lidar has been asked again and again in vain. True if it is worth a start even so: it may be
 * one that obeys and never answers. One that has answered before has no power. */
static inline bool tmini_recovery_note_silence(tmini_t *lidar)
{
    lidar->recovery.contact |= TMINI_CONTACT_MUTE;
    return (lidar->recovery.contact & TMINI_CONTACT_ANSWERED) == 0;
}

/* True from then on, until a reply comes. */
static inline bool tmini_recovery_is_mute(const tmini_t *lidar)
{
    return (lidar->recovery.contact & TMINI_CONTACT_MUTE) != 0;
}

/* Asks the port, if it can, to start its reception again: after a loss or a failed attempt. */
void tmini_recovery_restart_reception(const tmini_t *lidar);

/* An attempt has failed with this result: waits before the next one, unless something else is
 * wished, or it has been asking in vain for longer than any pause. */
void tmini_recovery_back_off(tmini_t *lidar, int result);

/* The wanted frequency has been set, or could not be. */
static inline void tmini_recovery_note_frequency(tmini_t *lidar, bool is_set)
{
    const unsigned others = lidar->recovery.contact & ~TMINI_CONTACT_UNSET;
    lidar->recovery.contact = (uint8_t)(others | (is_set ? 0 : TMINI_CONTACT_UNSET));
}

/* True from the failure on, until tmini_recovery_note_frequency() has heard that it is set or
 * reported. */
static inline bool tmini_recovery_is_unset(const tmini_t *lidar)
{
    return (lidar->recovery.contact & TMINI_CONTACT_UNSET) != 0;
}

/* The lidar scans again, by an attempt or by itself. */
static inline void tmini_recovery_end(tmini_t *lidar)
{
    lidar->recovery.recoveries++;
    lidar->recovery.is_lost = false;
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
    TMINI_TURN_STILL,   /* The wish has not changed for some turns. */
    TMINI_TURN_OFF,     /* Revolutions have had a wrong or unknown frequency for too long. */
    TMINI_TURN_ENDLESS, /* Packets with ranges come, but no start packets: the lidar is lost. */
} tmini_turn_t;

/* Takes the latest packet. If it ends a revolution, judges that revolution. `wanted_chz` 0: any.
 * `reported_chz`: the frequency that is set; 0: the lidar has not reported it. */
tmini_turn_t tmini_monitor_packet(tmini_monitor_t *monitor, const tmini_decoder_t *decoder,
                                  uint16_t wanted_chz, uint16_t reported_chz);

/* The wanted frequency has changed, or the lidar has been lost: forgets the fault, the count of
 * turns at a wrong one, and a wish that is not still yet. The next start will set it. */
void tmini_monitor_forget_frequency(tmini_monitor_t *monitor);

/* A wish that is still for this many start packets is carried out: while somebody moves a slider,
 * the lidar goes on scanning. */
#define TMINI_STILL_TURNS 4

/* The wish has changed while the lidar is to scan: TMINI_TURN_STILL follows when it has not changed
 * again for some turns. */
static inline void tmini_monitor_await_still(tmini_monitor_t *monitor)
{
    monitor->turns_to_still = TMINI_STILL_TURNS;
}

#endif
