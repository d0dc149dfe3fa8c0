/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "world.h"

#include "invariants.h"

#include <stdio.h>
#include <string.h>

#define STEP_US 1000u
#define TIMER_US 10000u
#define LINE_BYTES_PER_STEP 24u            /* 1 ms at 230400 baud (section 1). */
#define CLOCK_AT_THE_BEGINNING 0xFFFF0000u /* It wraps around after a minute. */

static const char *const violation_names[VIOLATION_KINDS] = {
    "packets lost",    "false packets",           "wrong scans",
    "mixed scans",     "bytes not accounted for", "forbidden commands",
    "false faults",    "missed faults",           "wrong answers",
    "slow recoveries", "impossible states"};

const char *world_violation_name(violation_t violation)
{
    return violation_names[violation];
}

void world_violate(world_t *world, violation_t violation, const char *what)
{
    world->counts.violations[violation]++;
    if (world->config.report) {
        printf("violation at %llu ms, seed %llu: %s: %s\n",
               (unsigned long long)world->now_us / 1000u, (unsigned long long)world->config.seed,
               violation_names[violation], what);
    }
}

/* ---- The port ---- */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    world_t *const world = context;

    if (world->config.short_writes) {
        count = random_below(&world->random, (uint32_t)count + 1);
    }
    world->writes++;
    if (!world->deaf) {
        sim_link_write(&world->link, bytes, count, world->now_us);
    }
    return (int)count;
}

static uint32_t port_now_ms(void *context)
{
    const world_t *const world = context;

    return (uint32_t)(world->now_us / 1000u) + CLOCK_AT_THE_BEGINNING;
}

/* ---- Beginning ---- */

world_config_t world_default_config(void)
{
    const world_config_t config = {
        .seed = 1,
        .sim = sim_default_config(),
        .link = sim_link_default_config(),
        .rx_size = 2048,
        .report = true,
    };

    return config;
}

static void on_packet(void *context, const sim_link_packet_t *packet)
{
    world_t *const world = context;

    truth_sent(&world->truth, packet);
}

void world_restart_library(world_t *world)
{
    const tmini_config_t config = {
        .port = &world->port,
        .port_context = world,
        .rx_buffer = world->rx,
        .rx_size = world->config.rx_size,
        .rx_dma = world->config.dma,
        .points = world->config.streaming ? NULL : world->points,
        .max_points = world->config.streaming         ? 0
                      : world->config.max_points != 0 ? world->config.max_points
                                                      : WORLD_POINTS,
        .frequency_chz = world->config.frequency_chz,
        .listen_only = world->config.listen_only,
        .recovery = world->config.recovery,
    };

    world->port.write = port_write;
    world->port.now_ms = port_now_ms;
    if (tmini_init(&world->lidar, &config) != TMINI_OK) {
        world_violate(world, VIOLATION_BYTES, "the library was not set up");
    }
    world->fed_before += world->fed;
    world->fed = 0;
    world->published = 0;
    world->published_at_poll = 0;
    world->dma_position = 0;
    world->faults = 0;
    world->in_trouble = false;
    world->silent_since_us = world->now_us;
    truth_forget(&world->truth, world->fed_before);
}

void world_init(world_t *world, const world_config_t *config)
{
    const sim_link_observer_t observer = {.context = world, .on_packet = on_packet};

    memset(world, 0, sizeof *world);
    world->config = *config;
    world->config.sim.seed += config->seed;
    world->config.link.seed += config->seed;
    random_seed(&world->random, config->seed);
    sim_init(&world->sim, &world->config.sim);
    sim_link_init(&world->link, &world->sim, &world->config.link);
    sim_link_observe(&world->link, &observer);
    truth_init(&world->truth);
    world_restart_library(world);
}

/* ---- Reception ---- */

static size_t half_of(const world_t *world, size_t position)
{
    return position / (world->config.rx_size / 2);
}

static void publish(world_t *world, uint64_t published)
{
    tmini_feed_dma(&world->lidar, world->dma_position);
    world->published = published;
}

/* Publishes in the interrupts for half transfer, transfer complete and idle line, and in a timer:
 * otherwise a large buffer would be published so rarely that the library would detect silence.
 * `world->fed` already counts these bytes. */
static void feed_dma(world_t *world, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const size_t at = world->dma_position;

        world->rx[at] = bytes[i];
        world->dma_position = (at + 1) % world->config.rx_size;
        if (half_of(world, world->dma_position) != half_of(world, at)) {
            publish(world, world->fed - count + i + 1);
        }
    }
    if (count == 0 || world->now_us % TIMER_US == 0) {
        publish(world, world->fed);
    }
}

static void receive(world_t *world)
{
    uint8_t bytes[LINE_BYTES_PER_STEP];
    const size_t count = sim_link_read(&world->link, world->now_us, bytes, sizeof bytes);

    truth_arrived(&world->truth, bytes, count);
    world->fed += count;
    if (world->config.dma) {
        feed_dma(world, bytes, count);
    } else {
        tmini_feed(&world->lidar, bytes, count);
        world->published = world->fed;
    }
}

/* ---- Checks ---- */

/* The place on the line up to which the library has parsed, as packets, replies or skipped
 * bytes. */
static uint64_t parsed(const world_t *world, const tmini_counters_t *counters)
{
    return world->fed_before + counters->bytes_in_packets + counters->bytes_in_replies +
           counters->bytes_skipped;
}

static uint64_t parsed_now(const world_t *world)
{
    tmini_counters_t counters;

    tmini_counters(&world->lidar, &counters);
    return parsed(world, &counters);
}

static void judge(world_t *world, truth_verdict_t verdict, violation_t wrong)
{
    if (verdict == TRUTH_BY_CHANCE) {
        world->counts.packets_by_chance++;
    } else if (world->config.overruns_expected || verdict == TRUTH_RIGHT) {
        return;
    } else if (verdict == TRUTH_LOST) {
        world_violate(world, VIOLATION_LOST_PACKET, "it arrived unharmed");
    } else if (verdict == TRUTH_MIXED) {
        world_violate(world, VIOLATION_MIXED_SCAN, "points of two revolutions");
    } else {
        world_violate(world, wrong, "not as on the line");
    }
}

static void check_packet(world_t *world)
{
    judge(world,
          truth_compare_packet(&world->truth, parsed_now(world), tmini_packet(&world->lidar)),
          VIOLATION_FALSE_PACKET);
}

static void check_scan(world_t *world)
{
    world->scan = *tmini_scan(&world->lidar);
    const unsigned closing = TMINI_PACKET_SIZE(tmini_packet(&world->lidar)->count);

    judge(world,
          truth_compare_scan(&world->truth, parsed_now(world), closing, tmini_scan(&world->lidar)),
          VIOLATION_WRONG_SCAN);
}

static void check_faults(world_t *world)
{
    const uint8_t faults = tmini_faults(&world->lidar);
    const uint64_t since_us = world->now_us - WORLD_FAULT_MS * 1000u;
    char what[60];

    for (unsigned bit = 0; bit < 8; bit++) {
        const bool now = (faults >> bit & 1u) != 0;
        const bool before = (world->faults >> bit & 1u) != 0;
        const uint64_t seen_us = now ? world->fault_on_us[bit] : world->fault_off_us[bit];

        if (now != before && world->now_us > WORLD_FAULT_MS * 1000u && seen_us < since_us) {
            (void)snprintf(what, sizeof what, "bit %u has become %u", bit, now ? 1u : 0u);
            world_violate(world, VIOLATION_FALSE_FAULT, what);
        }
    }
    world->faults = faults;
}

static void check_recovery(world_t *world)
{
    const uint64_t taken_us = world->now_us - world->trouble_us;

    if (!world->in_trouble) {
        return;
    }
    world->in_trouble = false;
    world->counts.recoveries++;
    if (world->now_us > world->trouble_us && taken_us / 1000u > world->counts.worst_recovery_ms) {
        world->counts.worst_recovery_ms = (uint32_t)(taken_us / 1000u);
    }
}

static void check_bytes(world_t *world, const tmini_counters_t *counters)
{
    const uint64_t in = parsed(world, counters) - world->fed_before + counters->bytes_overrun +
                        counters->bytes_pending;

    if (in != world->published) {
        world_violate(world, VIOLATION_BYTES, "the sum differs");
    }
    if (counters->bytes_overrun > 0 && !world->config.overruns_expected) {
        world_violate(world, VIOLATION_BYTES, "an overrun");
    }
}

static void handle(world_t *world, tmini_event_t event)
{
    world->counts.events[event]++;
    switch (event) {
    case TMINI_EVENT_STARTED:
        truth_forget(&world->truth, parsed_now(world) - 1);
        break;
    case TMINI_EVENT_LOST:
        world->in_trouble = true;
        break;
    case TMINI_EVENT_RECOVERED:
        truth_forget(&world->truth, parsed_now(world) - 1);
        check_recovery(world);
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        check_faults(world);
        break;
    case TMINI_EVENT_PACKET:
        check_packet(world);
        break;
    case TMINI_EVENT_SCAN:
        check_scan(world);
        break;
    default:
        break;
    }
}

/* ---- Time ---- */

static void note_faults(world_t *world)
{
    uint8_t faults = sim_health(&world->sim);

    /* The library may then report a data fault (section 8), even if the lidar's health does not. */
    if (world->sim.window_covered || world->sim.rotor_blocked) {
        faults |= SIM_HEALTH_DATA;
    }
    world->fault_on_us[6] = world->now_us; /* TMINI_FAULT_FREQUENCY: not judged here. */
    for (unsigned bit = 0; bit < 8; bit++) {
        if ((faults >> bit & 1u) != 0) {
            world->fault_on_us[bit] = world->now_us;
        }
        if ((sim_health(&world->sim) >> bit & 1u) == 0) {
            world->fault_off_us[bit] = world->now_us;
        }
    }
}

/* Trouble after a power failure also includes the time in which the lidar boots. */
static void note_trouble(world_t *world)
{
    if (sim_mode(&world->sim) == SIM_OFF) {
        world->trouble_us = world->now_us + world->config.sim.boot_ms * 1000u;
    } else if (sim_link_is_faulty(&world->link) && world->trouble_us < world->now_us) {
        world->trouble_us = world->now_us;
    }
    if (tmini_state(&world->lidar) != TMINI_STATE_RECOVERING) {
        world->in_trouble = false; /* The program has stopped it. */
    }
    if (world->in_trouble && world->config.recovery == TMINI_RECOVERY_ON &&
        world->now_us > world->trouble_us &&
        world->now_us - world->trouble_us > WORLD_RECOVERY_MS * 1000u) {
        world->in_trouble = false;
        world_violate(world, VIOLATION_SLOW_RECOVERY, "still no packets");
    }
}

static void note_silence(world_t *world)
{
    const uint64_t silence_us = (tmini_timing_default.frame_timeout_ms - 1u) * 1000u;

    if (world->published != world->published_at_poll) {
        world->published_at_poll = world->published;
        world->silent_since_us = world->now_us;
    } else if (world->now_us - world->silent_since_us >= silence_us) {
        truth_fell_silent(&world->truth, world->fed_before + world->published);
    }
}

/* Between two busy periods there is at least one poll. */
static bool is_busy(world_t *world)
{
    if (world->now_us > world->busy_until_us && world->config.busy_one_in > 0 &&
        random_below(&world->random, world->config.busy_one_in) == 0) {
        world->busy_until_us =
            world->now_us + random_between(&world->random, 1, world->config.busy_ms) * 1000u;
    }
    return world->now_us < world->busy_until_us;
}

/* A missed packet is a violation if the library was scanning. */
static void close_cycle(world_t *world, bool was_scanning)
{
    const bool scanning = tmini_state(&world->lidar) == TMINI_STATE_SCANNING;
    tmini_counters_t counters;

    tmini_counters(&world->lidar, &counters);
    check_bytes(world, &counters);
    if (world->config.streaming && was_scanning && scanning) {
        judge(world, truth_must_be_empty(&world->truth, parsed(world, &counters)),
              VIOLATION_FALSE_PACKET);
    } else if (!scanning) {
        truth_forget(&world->truth, parsed(world, &counters));
    }
    if (world->sim.counts.commands_while_scanning > world->counts.violations[VIOLATION_COMMAND]) {
        world_violate(world, VIOLATION_COMMAND, "while the lidar was scanning");
    }
    world->counts.packets_checked = world->truth.checked;
    world->counts.packets_split = world->truth.split;
    world->counts.packets_eclipsed = world->truth.eclipsed;
    world->counts.points = world->truth.points;
}

static void check_state(world_t *world)
{
    if (!lidar_is_sound(&world->lidar)) {
        world_violate(world, VIOLATION_STATE, "see invariants.h");
    }
}

static unsigned poll_all(world_t *world)
{
    const bool was_scanning = tmini_state(&world->lidar) == TMINI_STATE_SCANNING;
    unsigned events = 0;
    tmini_event_t event;

    note_silence(world);
    check_state(world); /* Commands and fed bytes may have changed it. */
    while ((event = tmini_poll(&world->lidar)) != TMINI_EVENT_NONE) {
        check_state(world);
        events |= BIT(event);
        handle(world, event);
    }
    world->counts.polls++;
    close_cycle(world, was_scanning);
    return events;
}

unsigned world_step(world_t *world)
{
    world->now_us += STEP_US;
    receive(world);
    note_faults(world);
    note_trouble(world);
    return is_busy(world) ? 0 : poll_all(world);
}

unsigned world_run_ms(world_t *world, uint32_t ms)
{
    unsigned events = 0;

    for (; ms > 0; ms--) {
        events |= world_step(world);
    }
    return events;
}

unsigned world_run_until(world_t *world, unsigned events, uint32_t ms)
{
    unsigned seen = 0;

    for (; ms > 0 && (seen & events) == 0; ms--) {
        seen |= world_step(world);
    }
    return seen;
}

bool world_is_undisturbed_since(const world_t *world, uint64_t since_us)
{
    return !sim_link_is_faulty(&world->link) && world->trouble_us < since_us &&
           sim_link_last_fault_us(&world->link) < since_us;
}
