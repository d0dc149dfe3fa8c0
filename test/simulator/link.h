/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The wire between the simulated lidar and the host, with seeded faults from device to host (the
 * other direction fails only while unplugged). It reports for every packet whether all its bytes
 * reached the host unharmed and without a gap, and for every fault when it began and ended. Pure,
 * like the simulator; virtual time.
 *
 *     sim_link_init(&link, &sim, &config);
 *     sim_link_write(&link, bytes, count, now_us);         host to device
 *     count = sim_link_read(&link, now_us, out, max);      what has reached the host by now
 *
 * A link without faults passes the device's bytes on as they leave it.
 */

#ifndef SIM_LINK_H
#define SIM_LINK_H

#include "simulator.h"

typedef enum {
    SIM_LINK_DROP,   /* one byte is lost */
    SIM_LINK_FLIP,   /* one bit of a byte is flipped */
    SIM_LINK_INSERT, /* one random byte is added */
    SIM_LINK_BURST,  /* a run of bytes is overwritten */
    SIM_LINK_STALL,  /* bytes are held back for a while, then come at the line's full speed */
    SIM_LINK_CUT,    /* the rest of a packet, from a random place in it, is lost */
    SIM_LINK_UNPLUG, /* power is lost; later it returns, and the device boots */
    SIM_LINK_GARBLE, /* wrong baud rate: every byte is wrong for a while */
    SIM_LINK_KINDS
} sim_link_kind_t;

typedef struct {
    uint64_t seed;
    /* The average distance of one fault of the kind from the next, exponentially distributed:
     * in bytes for drop, flip and insert, in milliseconds for the others. 0: never. */
    uint32_t mean_gap[SIM_LINK_KINDS];
    /* How long one fault lasts, drawn uniformly: bytes of a burst, milliseconds of a stall, of
     * being unplugged and of garbling. Unused for the other kinds. */
    uint16_t shortest[SIM_LINK_KINDS];
    uint16_t longest[SIM_LINK_KINDS];
} sim_link_config_t;

/* What became of one packet. */
typedef struct {
    sim_packet_t sent;
    bool intact;     /* all bytes delivered, unchanged and contiguous */
    uint64_t offset; /* of its first byte in all that is delivered; only if intact */
} sim_link_packet_t;

/* Any member may be NULL. */
typedef struct {
    void *context;
    /* In the order of sending; before the host can read the packet's last byte. */
    void (*on_packet)(void *context, const sim_link_packet_t *packet);
    /* Twice a fault: when it begins and when it ends (at once for single bytes). The end of being
     * unplugged is the return of power: the device has yet to boot. */
    void (*on_fault)(void *context, sim_link_kind_t kind, bool begins, uint64_t at_us);
} sim_link_observer_t;

typedef struct {
    uint32_t faults[SIM_LINK_KINDS];
    uint32_t packets; /* whose fate is known */
    uint32_t intact_packets;
} sim_link_counts_t;

/* Holds what a stall of 150 ms leaves waiting; a longer one makes the device wait. */
#define SIM_LINK_BACKLOG 4096u

/* Caller-owned; read `counts`, `delivered` and leave the rest to the functions. */
typedef struct {
    sim_t *sim;
    sim_link_config_t config;
    sim_link_observer_t observer;
    sim_link_counts_t counts;
    random_t random;
    uint64_t passed;                    /* bytes that came from the device */
    uint64_t next_byte[SIM_LINK_KINDS]; /* faults of single bytes: at which byte, else never */
    uint64_t nearest_byte;              /* the least of them */
    uint64_t begin_us[SIM_LINK_KINDS];  /* faults in time: the next one's begin */
    uint64_t end_us[SIM_LINK_KINDS];    /* and the present one's end; SIM_NEVER: none now */
    uint32_t burst_left;
    bool cut_waiting; /* for the next packet to begin */
    size_t cut_from;  /* place in the frame; SIZE_MAX: not cutting */
    bool unplugged;
    bool garbling;
    bool throttled;      /* during a stall and until the backlog has drained */
    uint64_t held_from;  /* first byte held back */
    uint64_t release_us; /* when the stall ends */
    uint64_t last_fault_us;
    bool packet_open;
    sim_link_packet_t packet;
    uint8_t packet_bytes[SIM_FRAME_MAX];
    uint64_t produced;  /* bytes put into the backlog so far */
    uint64_t delivered; /* bytes the host has read so far */
    uint8_t backlog[SIM_LINK_BACKLOG];
} sim_link_t;

/* No faults; default durations: bursts of 2..64 bytes, stalls of 5..100 ms, unplugged for
 * 0.5..5 s, garbled for 50..2000 ms. */
sim_link_config_t sim_link_default_config(void);

/* `sim` stays the caller's. `config` is copied; NULL: the default one. */
void sim_link_init(sim_link_t *link, sim_t *sim, const sim_link_config_t *config);

/* `observer` is copied; NULL: none. */
void sim_link_observe(sim_link_t *link, const sim_link_observer_t *observer);

/* From the host to the device, arriving now. Lost while unplugged. */
void sim_link_write(sim_link_t *link, const uint8_t *bytes, size_t count, uint64_t now_us);

/* The bytes that have reached the host by now and have not been read yet, at most `max`. */
size_t sim_link_read(sim_link_t *link, uint64_t now_us, uint8_t *out, size_t max);

/* When there may be something to read, or a fault begins or ends; SIM_NEVER: never. */
uint64_t sim_link_next_us(sim_link_t *link);

/* Changes the rate of this kind of fault; 0: no more of them. */
void sim_link_set_mean_gap(sim_link_t *link, sim_link_kind_t kind, uint32_t mean_gap,
                           uint64_t now_us);

/* No new faults from now on; those under way run their course. */
void sim_link_calm(sim_link_t *link, uint64_t now_us);

/* One fault of the kind now (faults of bytes and packets: at the next one), lasting `amount`
 * bytes or milliseconds. */
void sim_link_force(sim_link_t *link, sim_link_kind_t kind, uint32_t amount, uint64_t now_us);

/* Whether a fault with a duration is active, and when the last fault of any kind ended. */
bool sim_link_is_faulty(const sim_link_t *link);
uint64_t sim_link_last_fault_us(const sim_link_t *link);

/* "drop", "flip" ...; and the other way round, SIM_LINK_KINDS for no such name. */
const char *sim_link_kind_name(sim_link_kind_t kind);
sim_link_kind_t sim_link_kind_named(const char *name);

/* Whether the kind's gaps are counted in bytes (otherwise in milliseconds). */
bool sim_link_counts_bytes(sim_link_kind_t kind);

#endif
