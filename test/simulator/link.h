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
    SIM_LINK_STALL,  /* bytes are held back for a while, then delivered at the line's full speed */
    SIM_LINK_CUT,    /* the rest of a packet, from a random place in it, is lost */
    SIM_LINK_UNPLUG, /* power is lost; later it returns, and the device boots */
    SIM_LINK_GARBLE, /* wrong baud rate: every byte is wrong for a while */
    SIM_LINK_KINDS
} sim_link_kind_t;

typedef struct {
    uint64_t seed;
    /* The average gap between two faults of the kind, exponentially distributed: in bytes for
     * drop, flip and insert, in milliseconds for the others. 0: never. */
    uint32_t mean_gap[SIM_LINK_KINDS];
    /* How long one fault lasts, drawn uniformly: in bytes for a burst, in milliseconds for a stall,
     * an unplugged lidar and garbling. Unused for the other kinds. */
    uint16_t shortest[SIM_LINK_KINDS];
    uint16_t longest[SIM_LINK_KINDS];
} sim_link_config_t;

/* How one packet arrived. */
typedef struct {
    sim_packet_t sent;
    bool intact;     /* all bytes delivered, unchanged and contiguous */
    uint64_t offset; /* of its first byte in all delivered bytes; only if intact */
} sim_link_packet_t;

/* Any member may be NULL. */
typedef struct {
    void *context;
    /* Called in the order of sending, before the host can read the packet's last byte. */
    void (*on_packet)(void *context, const sim_link_packet_t *packet);
    /* Called twice per fault: when it begins and when it ends (at once for single bytes). Being
     * unplugged ends when power returns: the device has yet to boot. */
    void (*on_fault)(void *context, sim_link_kind_t kind, bool begins, uint64_t at_us);
    /* Whether byte `i` of the run is lost, besides the faults. Called once for each byte. */
    bool (*loses)(void *context, const sim_run_t *run, size_t i);
} sim_link_observer_t;

typedef struct {
    uint32_t faults[SIM_LINK_KINDS];
    uint32_t packets; /* that have been reported to the observer */
    uint32_t intact_packets;
} sim_link_counts_t;

/* Holds the bytes of a stall of 150 ms; during a longer one the device waits. */
#define SIM_LINK_BACKLOG 4096u

/* Caller-owned. Users may read `counts`, `delivered` and `last_fault_us`; the rest is private. */
typedef struct {
    sim_t *sim;
    sim_link_config_t config;
    sim_link_observer_t observer;
    sim_link_counts_t counts;
    random_t random;
    uint64_t passed;                 /* bytes that came from the device */
    uint64_t next[SIM_LINK_KINDS];   /* faults of single bytes: where; others: when, in us */
    uint64_t end_us[SIM_LINK_KINDS]; /* when the present one ends; SIM_NEVER: unknown, or none */
    bool under_way[SIM_LINK_KINDS];
    uint32_t burst_left;
    size_t cut_from;     /* place in the frame; SIZE_MAX: not cutting, or until the next packet */
    bool throttled;      /* during a stall and until the backlog has drained */
    uint64_t held_from;  /* first byte held back */
    uint64_t release_us; /* when the stall ends */
    uint64_t last_fault_us; /* when the last fault of any kind ended */
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

/* The caller owns `sim`, which must outlive the link. `config` is copied. */
void sim_link_init(sim_link_t *link, sim_t *sim, const sim_link_config_t *config);

/* `observer` is copied. */
void sim_link_observe(sim_link_t *link, const sim_link_observer_t *observer);

/* Bytes from the host arrive at the device now. Lost while unplugged. */
void sim_link_write(sim_link_t *link, const uint8_t *bytes, size_t count, uint64_t now_us);

/* Reads at most `max` of the bytes that have reached the host by now. */
size_t sim_link_read(sim_link_t *link, uint64_t now_us, uint8_t *out, size_t max);

/* The next time at which there may be bytes to read, or a fault begins or ends; or SIM_NEVER. */
uint64_t sim_link_next_us(sim_link_t *link);

/* Changes the rate of this kind of fault; 0: no more of them. */
void sim_link_set_mean_gap(sim_link_t *link, sim_link_kind_t kind, uint32_t mean_gap,
                           uint64_t now_us);

/* No new faults from now on; active ones end as planned. */
void sim_link_calm(sim_link_t *link, uint64_t now_us);

/* Makes one fault of the kind now, lasting `amount` bytes or milliseconds. Drop, flip, insert and
 * cut hit the next byte or packet. */
void sim_link_force(sim_link_t *link, sim_link_kind_t kind, uint32_t amount, uint64_t now_us);

/* Whether a fault with a duration is active. */
bool sim_link_is_faulty(const sim_link_t *link);

/* "drop", "flip" ...; the second finds the kind of a name: SIM_LINK_KINDS if there is none. */
const char *sim_link_kind_name(sim_link_kind_t kind);
sim_link_kind_t sim_link_kind_named(const char *name);

/* Whether the kind's gaps are counted in bytes (otherwise in milliseconds). */
bool sim_link_counts_bytes(sim_link_kind_t kind);

#endif
