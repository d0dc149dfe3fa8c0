/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program, the library and an unkind lidar (simulator.h: on_event, sim_befall()) in virtual
 * time, as light as can be: thousands of seconds per second. It keeps what the program wants and
 * sees. With a watch (watch.h) there is a faulty wire, and all that comes is compared with what was
 * sent.
 *
 * Without one, all of it is in one struct, so that a copy of it, put back in the same place, goes
 * on from there. */

#ifndef BED_H
#define BED_H

#include "watch.h"

#define BED_EVENTS 32u
#define BED_RECENT 12u
#define BED_ROW 8u
#define BED_HELD_MAX 65536u

/* What the lidar has heard. */
typedef struct {
    uint32_t commands, starts, stops, reboots;
    uint64_t start_us;  /* The first start, */
    uint16_t start_chz; /* and what frequency was set then. */
    uint32_t stops_while_scanning;
} bed_heard_t;

/* Bytes that a system below the program holds; it reports at most `reported_max` of them. What
 * overflows it is lost, and so is all that comes until it is empty. */
typedef struct {
    size_t reported_max;
    size_t size;          /* 0: BED_HELD_MAX. */
    bool is_mute;         /* Reports nothing. */
    bool ignores_room;    /* Hands over more than the ring may take. */
    uint32_t every_us;    /* A task hands over this often. 0: the program does, before it polls. */
    uint32_t late_one_in; /* One of these times in this many, 20 to 95 ms late. 0: none. */
    size_t count;
    uint64_t to; /* Of the bytes that have come, it holds those before this one. */
    bool has_overflowed;
    uint64_t due_us;
    uint8_t bytes[BED_HELD_MAX];
} bed_held_t;

struct bed {
    /* To be set between bed_prepare() and bed_init(). */
    uint32_t poll_ms;     /* Between two rounds of polls, */
    uint32_t later_us;    /* and this much more. */
    uint32_t write_max;   /* Bytes that the port takes per call. 0: all. */
    uint32_t work_ms;     /* What the program does with each scan takes this long. */
    uint32_t flip_one_in; /* One in this many bytes from the lidar is damaged. 0: none. */
    bool is_told;         /* What happens is printed. */
    bool sleeps;          /* The program polls only when bytes come or tmini_next_poll_ms() ends. */
    bool writes_short;    /* The port takes 0, 1 or 2 bytes, at random. */
    uint16_t busy_one_in; /* One poll in this many begins a busy period. 0: none. */
    uint16_t busy_ms;     /* The longest of these. */
    bed_held_t *held;     /* The caller's. NULL: bytes come by an interrupt, or by DMA. */
    uint32_t grain_us;    /* Time passes in such steps; 50 ms. */
    bool polls_first;     /* Also before the program fetches what is held. */
    bool reports_twice;   /* Each loss. */
    uint32_t false_gap_one_in; /* One DMA interrupt in this many reports none. 0: none does. */
    uint32_t clock_ms;         /* The clock at the beginning, */
    int32_t clock_ppm;         /* its error; positive: it is fast; */
    uint32_t back_ms;          /* by how much it is set back once, */
    uint64_t back_at_us;       /* and when. */
    watch_t *watch;            /* The caller's. NULL: none. */
    /* Decides what spoils an event on the wire, as sim_observer_t. NULL: nothing. */
    sim_trouble_t (*spoil)(bed_t *bed, uint32_t *ms);
    tmini_config_t
        config; /* Without port; without buffers, unless those of the bed are too small. */
    tmini_timing_t timing;

    sim_t sim;
    tmini_t lidar;
    tmini_port_t port;
    random_t random;
    uint64_t now_us;
    uint8_t outbox[16]; /* Bytes that reach the lidar with the next step. */
    size_t outbox_count;
    uint32_t sent;      /* Bytes to the lidar. */
    uint64_t known;     /* Bytes from it that the library knows of. */
    uint64_t come;      /* And by DMA those that have come, */
    uint64_t published; /* and that its interrupts have published. */
    size_t dma_position;
    bool is_half, is_full; /* DMA interrupts that wait. */
    bool is_stalled;       /* They have to. */
    uint32_t gaps;         /* Losses that the receiver has reported. */
    bool is_polling;       /* Inside tmini_poll(). */
    uint32_t polls;
    uint64_t known_at_poll; /* When the latest began. */
    uint64_t busy_until_us;

    bed_heard_t heard;    /* Since it was cleared. */
    uint32_t wire_events; /* Those that may be spoilt. */

    /* What the program wants. */
    bool wants_scans;
    uint16_t wants_chz; /* 0: any. */
    uint64_t asked_us;  /* The latest question; 0: none. */
    uint64_t wished_us; /* The latest wish. */
    uint64_t stop_us;   /* The latest stop; 0: none. */

    /* What the program has seen. */
    uint32_t latest; /* Events: bits, for bed_run_until(). */
    uint32_t events[BED_EVENTS];
    uint64_t event_us[BED_EVENTS];  /* The latest of each kind; 0: none. */
    uint64_t recent_us[BED_RECENT]; /* The latest ones except packets and scans, in a circle. */
    uint32_t recent;                /* How many there have been. */
    uint32_t most_per_second;       /* The most of these in any second. */
    tmini_scan_t scan;              /* The latest; its points may have been overwritten. */
    uint32_t small;                 /* Scans of one packet. */
    uint32_t complete;              /* Complete scans. */
    uint64_t complete_us;           /* The latest of these. */
    uint32_t complete_in_a_row;     /* Now. */
    uint16_t row_chz[BED_ROW];      /* The frequencies of the latest of these, in a circle. */
    uint64_t busy_since_us;         /* The latest step at whose end the driver was not idle. */

    /* Whether each gap in the scans is announced. */
    bool may_flow;       /* STARTED or RECOVERED has come, and no gap was announced since. */
    bool flows;          /* And scans have come. */
    bool stop_sent;      /* By the driver, in this step. */
    uint64_t heard_us;   /* When bytes came last. */
    uint64_t due_us;     /* The next poll, if the program sleeps and no byte comes. */
    uint32_t wakes;      /* Rounds of polls. */
    const char *unheard; /* The first gap that was not announced; NULL: none. */

    uint8_t rx[4096];
    tmini_point_t points[800];
};

/* The README's program without a frequency, polling each millisecond. */
void bed_prepare(bed_t *bed);

/* The lidar is idle and powered. False: the library refuses the configuration. */
bool bed_init(bed_t *bed, const sim_config_t *sim);

/* The controller restarts: the library is set up anew, while the lidar goes on. */
bool bed_restart(bed_t *bed);

/* A documented unit whose sensor has no noise: random numbers would take most of the time. */
sim_config_t bed_quiet_lidar(void);

/* The program's wishes. */
tmini_status_t bed_start(bed_t *bed);
tmini_status_t bed_stop(bed_t *bed);
tmini_status_t bed_set_frequency(bed_t *bed, uint16_t frequency_chz);
tmini_status_t bed_request_info(bed_t *bed);

/* Time passes: bytes go both ways, then the program polls until nothing is left to do. */
void bed_step(bed_t *bed);
void bed_run_ms(bed_t *bed, uint32_t ms);

/* Runs until one of these events (bits) comes or the time is over; returns a bit for each event. */
unsigned bed_run_until(bed_t *bed, unsigned events, uint32_t ms);
#define BIT(event) (1u << (event))

/* The program does something else, or (bed_pass_us()) is interrupted. */
void bed_pause_ms(bed_t *bed, uint32_t ms);
void bed_pass_us(bed_t *bed, uint64_t us);

/* The processor stands still while DMA writes this many bytes, or for three seconds. */
void bed_stall(bed_t *bed, uint64_t bytes);

uint32_t bed_ms(const bed_t *bed);

/* With `is_told` prints the time and this, or how lidar and driver are. */
void bed_tell(const bed_t *bed, const char *format, ...);
void bed_tell_state(const bed_t *bed);

/* The number of the event with this name (tmini_event_name()); BED_EVENTS - 1, which never comes,
 * if there is none. */
unsigned bed_event_named(const char *name);

/* The latest `scans` scans, at most BED_ROW, are complete and at this frequency, within 5 %, which
 * is also the one that is set, and that the driver knows. 0: at any frequency. */
bool bed_scans_at(const bed_t *bed, uint16_t frequency_chz, uint32_t scans);

/* Why the wishes are not fulfilled yet; NULL: they are. */
const char *bed_shortcoming(const bed_t *bed);

/* What the driver must never do; NULL: it has not. */
const char *bed_misdeed(const bed_t *bed);

#endif
