/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the driver's three files share: tmini.c (events), tmini_command.c (what is said to the
 * lidar) and tmini_watch.c (whether it keeps scanning, and is well). */

#ifndef TMINI_DRIVER_H
#define TMINI_DRIVER_H

#include "tmini/tmini.h"

/* What goes on on the wire. */
enum phase {
    PHASE_UNKNOWN,     /* Nothing; but the lidar may be streaming. */
    PHASE_IDLE,        /* Nothing, and the line is quiet. */
    PHASE_HUSHING,     /* Stop has been sent: until the line is quiet. */
    PHASE_ASKING,      /* A command has been sent: until its reply. */
    PHASE_SETTLING,    /* Between two frequency commands: until the line is quiet. */
    PHASE_SPINNING_UP, /* The start has been acknowledged: until the first packet. */
    PHASE_SCANNING,
    PHASE_BACKING_OFF, /* Between two attempts to recover. */
    PHASE_BOOTING,
};

/* The command that is being carried out. While scanning it is GOAL_START. */
enum goal {
    GOAL_NONE,
    GOAL_STOP,
    GOAL_START,
    GOAL_INFO,
    GOAL_HEALTH,
    GOAL_FREQUENCY,
    GOAL_SET_FREQUENCY,
    GOAL_REBOOT,
};

static inline bool driver_is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && lidar->port != NULL;
}

static inline bool driver_elapsed(const tmini_t *lidar, uint32_t since_ms, uint32_t wait_ms)
{
    return lidar->now_ms - since_ms >= wait_ms; /* Right across the clock's wrap-around too. */
}

static inline void driver_raise(tmini_t *lidar, tmini_event_t event)
{
    lidar->pending |= (uint16_t)(1u << event);
}

/* A phase that has lasted `limit_ms` is over, one way or the other; 0 for no limit. */
static inline void driver_enter(tmini_t *lidar, enum phase phase, uint16_t limit_ms)
{
    lidar->phase = (uint8_t)phase;
    lidar->phase_ms = lidar->now_ms;
    lidar->limit_ms = limit_ms;
}

/* All bytes had come when time was last looked at. Those that an interrupt has brought since must
 * not be judged by it. */
static inline bool driver_is_up_to_date(const tmini_t *lidar)
{
    return tmini_ring_stored(&lidar->ring) == lidar->received;
}

/* Nothing has been heard since the lidar was last known to be idle. */
static inline bool driver_is_idle(const tmini_t *lidar)
{
    return lidar->phase == PHASE_IDLE && !lidar->heard;
}

/* tmini.c: reads the clock and notes whether bytes have come. */
void tmini_driver_look(tmini_t *lidar);

/* tmini_command.c */
void tmini_driver_hush(tmini_t *lidar);      /* Begins to carry out lidar->goal. */
void tmini_driver_cancel(tmini_t *lidar);    /* Gives it up without a word. */
void tmini_driver_reply(tmini_t *lidar);     /* The awaited reply has come. */
void tmini_driver_keep_time(tmini_t *lidar); /* What the wire's phase asks for now. */

/* tmini_watch.c */
void tmini_driver_packet(tmini_t *lidar);      /* A packet has come. */
void tmini_driver_watch_rotor(tmini_t *lidar); /* While scanning: does it turn? */
void tmini_driver_lose(tmini_t *lidar);        /* No packet any more. */
void tmini_driver_back_off(tmini_t *lidar);    /* An attempt to recover has failed. */
void tmini_driver_climb(tmini_t *lidar);       /* Makes the next attempt to recover. */

#endif
