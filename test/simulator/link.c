/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "link.h"

#include <string.h>

/* Room for a whole frame with a byte inserted before each of its bytes. */
#define ROOM_FOR_A_FRAME (2u * SIM_FRAME_MAX)

static const char *const kind_names[SIM_LINK_KINDS] = {"drop",  "flip", "insert", "burst",
                                                       "stall", "cut",  "unplug", "garble"};

const char *sim_link_kind_name(sim_link_kind_t kind)
{
    return kind_names[kind];
}

sim_link_kind_t sim_link_kind_named(const char *name)
{
    unsigned kind = 0;
    while (kind < SIM_LINK_KINDS && strcmp(name, kind_names[kind]) != 0) {
        kind++;
    }
    return (sim_link_kind_t)kind;
}

bool sim_link_counts_bytes(sim_link_kind_t kind)
{
    return kind < SIM_LINK_BURST;
}

sim_link_config_t sim_link_default_config(void)
{
    return (sim_link_config_t){
        .seed = 1,
        .shortest = {[SIM_LINK_BURST] = 2,
                     [SIM_LINK_STALL] = 5,
                     [SIM_LINK_UNPLUG] = 500,
                     [SIM_LINK_GARBLE] = 50},
        .longest = {[SIM_LINK_BURST] = 64,
                    [SIM_LINK_STALL] = 100,
                    [SIM_LINK_UNPLUG] = 5000,
                    [SIM_LINK_GARBLE] = 2000},
    };
}

/* ---- When faults come ---- */

/* Plans the next fault of this kind. */
static void schedule(sim_link_t *link, sim_link_kind_t kind, uint64_t from_us)
{
    const bool in_bytes = sim_link_counts_bytes(kind);
    const uint32_t mean = link->config.mean_gap[kind];
    link->next[kind] = mean == 0u ? SIM_NEVER
                       : in_bytes ? link->passed + random_gap(&link->random, mean)
                                  : from_us + random_gap(&link->random, mean) * 1000u;
}

void sim_link_init(sim_link_t *link, sim_t *sim, const sim_link_config_t *config)
{
    memset(link, 0, sizeof *link);
    link->sim = sim;
    link->config = *config;
    link->cut_from = SIZE_MAX;
    random_seed(&link->random, link->config.seed);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        link->end_us[kind] = SIM_NEVER;
        schedule(link, (sim_link_kind_t)kind, 0);
    }
}

void sim_link_observe(sim_link_t *link, const sim_link_observer_t *observer)
{
    link->observer = *observer;
}

static void report(const sim_link_t *link, sim_link_kind_t kind, bool begins, uint64_t at_us)
{
    if (link->observer.on_fault != NULL) {
        link->observer.on_fault(link->observer.context, kind, begins, at_us);
    }
}

static void begin(sim_link_t *link, sim_link_kind_t kind, uint64_t at_us)
{
    link->counts.faults[kind]++;
    report(link, kind, true, at_us);
    link->under_way[kind] = true;
}

static void end(sim_link_t *link, sim_link_kind_t kind, uint64_t at_us)
{
    link->under_way[kind] = false;
    link->end_us[kind] = SIM_NEVER;
    link->last_fault_us = at_us > link->last_fault_us ? at_us : link->last_fault_us;
    report(link, kind, false, at_us);
}

/* ---- Processing a packet ---- */

static void close_packet(sim_link_t *link, bool complete)
{
    sim_link_packet_t *packet = &link->packet;
    if (!link->packet_open) {
        return;
    }
    link->packet_open = false;
    packet->intact = packet->intact && complete;
    packet->offset = packet->intact ? link->produced - packet->sent.length : 0u;
    link->counts.packets++;
    link->counts.intact_packets += packet->intact ? 1u : 0u;
    if (link->observer.on_packet != NULL) {
        link->observer.on_packet(link->observer.context, packet);
    }
}

/* Copies the packet's bytes: they are needed even if the device is switched off meanwhile. */
static void open_packet(sim_link_t *link, const sim_packet_t *sent)
{
    link->packet_open = true;
    link->packet.sent = *sent;
    link->packet.sent.bytes = link->packet_bytes;
    link->packet.intact = true;
    memcpy(link->packet_bytes, sent->bytes, sent->length);
}

/* ---- Bytes ---- */

static void deliver(sim_link_t *link, const uint8_t *bytes, size_t count)
{
    const size_t at = (size_t)(link->produced % SIM_LINK_BACKLOG);
    const size_t to_end = SIM_LINK_BACKLOG - at;
    const size_t first = count < to_end ? count : to_end;
    memcpy(link->backlog + at, bytes, first);
    memcpy(link->backlog, bytes + first, count - first);
    link->produced += count;
}

/* Never the same byte, so that a byte that is hit always changes. */
static uint8_t spoiled(sim_link_t *link, uint8_t byte)
{
    return (uint8_t)(byte ^ random_between(&link->random, 1, 255));
}

/* Whether a fault of the kind hits this byte; then reports it, and plans the next one. */
static bool meets(sim_link_t *link, sim_link_kind_t kind, uint64_t at_us)
{
    if (link->passed < link->next[kind]) {
        return false;
    }
    begin(link, kind, at_us);
    end(link, kind, at_us);
    schedule(link, kind, at_us);
    return true;
}

static void count_burst_down(sim_link_t *link, uint64_t at_us)
{
    if (link->under_way[SIM_LINK_BURST] && --link->burst_left == 0u) {
        end(link, SIM_LINK_BURST, at_us);
    }
}

/* LastCRC comes before a start packet in the same frame, but is not part of the packet. */
static void pass_byte(sim_link_t *link, const sim_run_t *run, size_t i)
{
    const size_t place = run->offset + i;
    const uint64_t at_us = sim_byte_us(run->start_us, place);
    const bool in_packet = place >= run->packet_at;
    uint8_t byte = run->bytes[i];
    if (meets(link, SIM_LINK_INSERT, at_us)) {
        byte = spoiled(link, run->bytes[i]); /* Differs, so that the packet is really broken. */
        deliver(link, &byte, 1);
        byte = run->bytes[i];
        link->packet.intact = link->packet.intact && place <= run->packet_at;
    }
    if (meets(link, SIM_LINK_FLIP, at_us)) {
        byte = (uint8_t)(byte ^ (1u << random_below(&link->random, 8)));
    }
    if (link->under_way[SIM_LINK_BURST] || link->under_way[SIM_LINK_GARBLE]) {
        byte = spoiled(link, run->bytes[i]);
    }
    if (meets(link, SIM_LINK_DROP, at_us) || place >= link->cut_from ||
        (link->observer.loses != NULL && link->observer.loses(link->observer.context, run, i))) {
        link->packet.intact = link->packet.intact && !in_packet;
    } else {
        link->packet.intact = link->packet.intact && (!in_packet || byte == run->bytes[i]);
        deliver(link, &byte, 1);
    }
    link->passed++;
    count_burst_down(link, at_us);
}

/* No fault can hit any of these bytes. */
static bool is_safe(const sim_link_t *link, const sim_run_t *run)
{
    const uint64_t end = link->passed + run->length;
    return link->observer.loses == NULL && !link->under_way[SIM_LINK_BURST] &&
           !link->under_way[SIM_LINK_GARBLE] && link->cut_from == SIZE_MAX &&
           end <= link->next[SIM_LINK_DROP] && end <= link->next[SIM_LINK_FLIP] &&
           end <= link->next[SIM_LINK_INSERT];
}

static void begin_frame(sim_link_t *link, const sim_run_t *run)
{
    close_packet(link, false);
    if (run->packet == NULL) {
        return;
    }
    open_packet(link, run->packet);
    if (link->under_way[SIM_LINK_CUT] && link->cut_from == SIZE_MAX) {
        link->cut_from = run->packet_at + (size_t)random_below(&link->random, run->packet->length);
    }
}

static void end_frame(sim_link_t *link, const sim_run_t *run)
{
    close_packet(link, run->completes);
    if (link->cut_from != SIZE_MAX) {
        link->cut_from = SIZE_MAX;
        end(link, SIM_LINK_CUT, sim_byte_us(run->start_us, run->frame_length - 1u));
    }
}

static void pass_run(sim_link_t *link, const sim_run_t *run)
{
    if (run->offset == 0u) {
        begin_frame(link, run);
    }
    if (is_safe(link, run)) {
        deliver(link, run->bytes, run->length);
        link->passed += run->length;
    } else {
        for (size_t i = 0; i < run->length; i++) {
            pass_byte(link, run, i);
        }
    }
    if (run->offset + run->length == run->frame_length) {
        end_frame(link, run);
    }
}

/* ---- Faults that last ---- */

/* How many bytes may have been delivered by now: after a stall, as many as the line can carry. */
static uint64_t delivery_limit(const sim_link_t *link, uint64_t now_us)
{
    uint64_t limit = link->held_from;
    if (!link->throttled) {
        return link->produced;
    }
    if (now_us > link->release_us) {
        limit += (now_us - link->release_us) * 72u / 3125u; /* section 1: 230400 baud */
    }
    return limit < link->produced ? limit : link->produced;
}

static void begin_stall(sim_link_t *link, uint64_t end_us, uint64_t at_us)
{
    const uint64_t limit = delivery_limit(link, at_us);
    /* `at_us` may lie in the past: bytes delivered since then cannot be held back. */
    link->held_from = limit > link->delivered ? limit : link->delivered;
    link->release_us = end_us;
    link->throttled = true;
}

/* Power is lost, and with it what would have damaged the next bytes. */
static void unplug(sim_link_t *link, uint64_t at_us)
{
    static const sim_link_kind_t moot[] = {SIM_LINK_BURST, SIM_LINK_CUT};
    sim_power(link->sim, false, at_us);
    close_packet(link, false);
    for (unsigned i = 0; i < 2; i++) {
        if (link->under_way[moot[i]]) {
            end(link, moot[i], at_us);
        }
    }
    link->cut_from = SIZE_MAX;
}

/* A burst ends after some bytes, a cut with the next packet. */
static void begin_fault(sim_link_t *link, sim_link_kind_t kind, uint64_t amount, uint64_t at_us)
{
    const uint64_t end_us = at_us + amount * 1000u;
    begin(link, kind, at_us);
    if (kind == SIM_LINK_BURST) {
        link->burst_left = (uint32_t)amount;
    } else if (kind != SIM_LINK_CUT) {
        link->end_us[kind] = end_us;
    }
    if (kind == SIM_LINK_STALL) {
        begin_stall(link, end_us, at_us);
    } else if (kind == SIM_LINK_UNPLUG) {
        unplug(link, at_us);
    }
}

/* On a silent line a burst or a cut has no bytes to damage; without power no fault has an
 * effect. */
static bool has_an_effect(const sim_link_t *link, sim_link_kind_t kind)
{
    const sim_mode_t mode = sim_mode(link->sim);
    if (kind == SIM_LINK_BURST || kind == SIM_LINK_CUT) {
        return mode == SIM_SCANNING || mode == SIM_STOPPING;
    }
    return !link->under_way[SIM_LINK_UNPLUG];
}

static void fault_is_due(sim_link_t *link, sim_link_kind_t kind, uint64_t at_us)
{
    schedule(link, kind, at_us);
    if (has_an_effect(link, kind) && !link->under_way[kind]) {
        const sim_link_config_t *const config = &link->config;
        begin_fault(link, kind,
                    random_between(&link->random, config->shortest[kind], config->longest[kind]),
                    at_us);
    }
}

/* ---- Time ---- */

static uint64_t next_event_us(const sim_link_t *link)
{
    uint64_t next = SIM_NEVER;
    for (unsigned kind = SIM_LINK_BURST; kind < SIM_LINK_KINDS; kind++) {
        next = link->next[kind] < next ? link->next[kind] : next;
        next = link->end_us[kind] < next ? link->end_us[kind] : next;
    }
    return next;
}

static void happen(sim_link_t *link, uint64_t at_us)
{
    for (unsigned kind = SIM_LINK_BURST; kind < SIM_LINK_KINDS; kind++) {
        if (link->end_us[kind] == at_us) {
            if (kind == SIM_LINK_UNPLUG) {
                sim_power(link->sim, true, at_us);
            }
            end(link, (sim_link_kind_t)kind, at_us);
        }
        if (link->next[kind] == at_us) {
            fault_is_due(link, (sim_link_kind_t)kind, at_us);
        }
    }
}

/* One step towards now: a run of bytes, or the beginning or end of a fault. False: nothing more
 * happens until now, or there is no room until the host reads. */
static bool pass_next(sim_link_t *link, uint64_t now_us)
{
    const uint64_t event_us = next_event_us(link);
    sim_run_t run;
    if (link->produced - link->delivered > SIM_LINK_BACKLOG - ROOM_FOR_A_FRAME) {
        return false;
    }
    if (sim_next_run(link->sim, event_us < now_us ? event_us : now_us, &run)) {
        pass_run(link, &run);
        return true;
    }
    if (event_us > now_us) {
        return false;
    }
    happen(link, event_us);
    return true;
}

static void pass_all(sim_link_t *link, uint64_t now_us)
{
    while (pass_next(link, now_us)) {
    }
}

static size_t hand_over(sim_link_t *link, uint64_t now_us, uint8_t *out, size_t max)
{
    const size_t at = (size_t)(link->delivered % SIM_LINK_BACKLOG);
    const size_t ready = (size_t)(delivery_limit(link, now_us) - link->delivered);
    const size_t count = ready < max ? ready : max;
    const size_t to_end = SIM_LINK_BACKLOG - at;
    const size_t first = count < to_end ? count : to_end;
    memcpy(out, link->backlog + at, first);
    memcpy(out + first, link->backlog, count - first);
    link->delivered += count;
    if (now_us > link->release_us && link->delivered == link->produced) {
        link->throttled = false;
    }
    return count;
}

/* A long time may have passed since the last call, so it works in portions that fit the backlog. */
size_t sim_link_read(sim_link_t *link, uint64_t now_us, uint8_t *out, size_t max)
{
    size_t count = 0;
    size_t more;
    do {
        pass_all(link, now_us);
        more = hand_over(link, now_us, out + count, max - count);
        count += more;
    } while (more > 0u);
    return count;
}

void sim_link_write(sim_link_t *link, const uint8_t *bytes, size_t count, uint64_t now_us)
{
    pass_all(link, now_us);
    if (!link->under_way[SIM_LINK_UNPLUG]) {
        sim_receive(link->sim, bytes, count, now_us);
    }
}

static uint64_t next_delivery_us(const sim_link_t *link)
{
    if (link->delivered == link->produced) {
        return SIM_NEVER;
    }
    if (!link->throttled) {
        return 0;
    }
    return sim_byte_us(link->release_us, (size_t)(link->delivered - link->held_from));
}

uint64_t sim_link_next_us(sim_link_t *link)
{
    const uint64_t event_us = next_event_us(link);
    const uint64_t device_us = sim_next_us(link->sim);
    const uint64_t delivery_us = next_delivery_us(link);
    const uint64_t next_us = event_us < device_us ? event_us : device_us;
    return delivery_us < next_us ? delivery_us : next_us;
}

void sim_link_set_mean_gap(sim_link_t *link, sim_link_kind_t kind, uint32_t mean_gap,
                           uint64_t now_us)
{
    pass_all(link, now_us);
    link->config.mean_gap[kind] = mean_gap;
    schedule(link, kind, now_us);
}

void sim_link_calm(sim_link_t *link, uint64_t now_us)
{
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        sim_link_set_mean_gap(link, (sim_link_kind_t)kind, 0, now_us);
    }
}

void sim_link_force(sim_link_t *link, sim_link_kind_t kind, uint32_t amount, uint64_t now_us)
{
    pass_all(link, now_us);
    if (sim_link_counts_bytes(kind)) {
        link->next[kind] = link->passed;
    } else if (!link->under_way[kind]) {
        begin_fault(link, kind, amount, now_us);
    }
}

bool sim_link_is_faulty(const sim_link_t *link)
{
    for (unsigned kind = SIM_LINK_BURST; kind < SIM_LINK_KINDS; kind++) {
        if (link->under_way[kind]) {
            return true;
        }
    }
    return false;
}
