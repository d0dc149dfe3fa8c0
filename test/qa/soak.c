/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* soak HOURS [SEED]
 *
 * Runs the library with the simulated lidar for HOURS of virtual time, half an hour for each of
 * many configurations, with all kinds of faults: on the line, in the lidar, in the program that
 * uses the library. Prints what happened. Exit status: 0 if the library did nothing wrong
 * (world.h lists the checks), 1 if it did, 2 wrong usage. The same seed gives the same run. */

#include "world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIFE_MS 1800000u
#define MAX_HOURS 1000.0

typedef struct {
    world_t world;
    random_t random;
    uint32_t frequency_chz; /* Set by a successful command; 0: as after power-up. */
    uint32_t restarts;
    uint32_t commands;
    uint32_t failures;
    uint32_t lidar_faults;
} soak_t;

typedef struct {
    uint32_t lives;
    uint64_t ms;
    uint64_t bytes;
    uint64_t scans;
    uint64_t packets;
    uint64_t points;
    uint32_t by_chance;
    uint32_t split;
    uint32_t eclipsed;
    uint32_t line_faults[SIM_LINK_KINDS];
    uint32_t lidar_faults;
    uint32_t fault_events;
    uint32_t losses;
    uint32_t recoveries;
    uint32_t worst_recovery_ms;
    uint32_t library_restarts;
    uint32_t commands;
    uint32_t failures;
    uint32_t commands_in_tail;
    uint32_t violations[VIOLATION_KINDS];
} totals_t;

static uint32_t between(soak_t *soak, uint32_t low, uint32_t high)
{
    return random_between(&soak->random, low, high);
}

static bool one_in(soak_t *soak, uint32_t number)
{
    return random_below(&soak->random, number) == 0;
}

/* ---- Configuration: each life has another lidar, another line and another program ---- */

static world_config_t draw_config(soak_t *soak, uint64_t seed)
{
    world_config_t config = world_default_config();
    config.seed = seed;
    config.sim.ct_information = !one_in(soak, 3);
    config.sim.frequency_chz = (uint16_t)(600 + 10 * between(soak, 0, 60));
    config.sim.stop_tail_ms = (uint16_t)between(soak, 10, 300);
    config.sim.reply_latency_ms = (uint16_t)between(soak, 1, 40);
    config.sim.start_angle_q6 = one_in(soak, 2) ? 0 : (uint16_t)between(soak, 0, 23039);
    config.sim.blocked_sends_starts = one_in(soak, 2);
    config.sim.boot_ms = (uint16_t)between(soak, 500, 4000);
    config.sim.beginning =
        (sim_beginning_t)between(soak, SIM_BEGINS_ANYWHERE, SIM_BEGINS_WITH_A_START);
    config.sim.information.firmware_minor = one_in(soak, 2) ? 3 : 2;
    config.dma = one_in(soak, 2);
    config.rx_size = config.dma ? 8192 : 2048;
    config.streaming = one_in(soak, 3);
    config.short_writes = one_in(soak, 3);
    config.busy_one_in = one_in(soak, 3) ? 0 : (uint16_t)between(soak, 20, 500);
    config.busy_ms = 60;
    return config;
}

/* ---- The program that uses the library: it always wants scans ---- */

static void keep_scanning(soak_t *soak)
{
    tmini_t *const lidar = &soak->world.lidar;
    const tmini_state_t state = tmini_state(lidar);
    if ((state == TMINI_STATE_UNKNOWN || state == TMINI_STATE_IDLE) &&
        soak->world.now_us % 100000u == 0) {
        (void)tmini_start(lidar);
    }
}

static void run_ms(soak_t *soak, uint32_t ms)
{
    for (; ms > 0; ms--) {
        (void)world_step(&soak->world);
        keep_scanning(soak);
    }
}

/* Waits for the end of a command that has begun. Returns true if it ended with the event `end`. */
static bool carry_out(soak_t *soak, tmini_status_t begun, tmini_event_t end, uint32_t limit_ms)
{
    world_t *const world = &soak->world;
    const uint64_t begun_us = world->now_us;
    soak->commands++;
    if (begun != TMINI_OK) {
        world_violate(world, VIOLATION_ANSWER, "not begun");
        return false;
    }
    unsigned events = world_run_until(world, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    if ((events & BIT(end)) == 0 && tmini_command_error(&world->lidar) == TMINI_ERROR_ABORTED) {
        /* This was only the end of an earlier start: wait again. */
        events |= world_run_until(world, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    }
    if ((events & BIT(end)) != 0) {
        return true;
    }
    soak->failures++;
    if (world_is_undisturbed_since(world, begun_us)) {
        world_violate(world, VIOLATION_ANSWER, "none");
    }
    return false;
}

static void check_answer(soak_t *soak, bool right, uint64_t since_us)
{
    if (!right && world_is_undisturbed_since(&soak->world, since_us)) {
        world_violate(&soak->world, VIOLATION_ANSWER, "not the truth");
    }
}

static void ask_for_info(soak_t *soak)
{
    world_t *const world = &soak->world;
    const uint64_t since_us = world->now_us;
    const encode_information_t *const truth = &world->config.sim.information;
    if (carry_out(soak, tmini_request_info(&world->lidar), TMINI_EVENT_INFO, 10000)) {
        const tmini_info_t *const info = tmini_info(&world->lidar);
        check_answer(soak,
                     info->model == truth->model && info->hardware == truth->hardware &&
                         info->firmware_major == truth->firmware_major &&
                         info->firmware_minor == truth->firmware_minor &&
                         memcmp(info->serial, truth->serial, sizeof info->serial) == 0,
                     since_us);
    }
}

static void ask_for_health(soak_t *soak)
{
    world_t *const world = &soak->world;
    const uint64_t since_us = world->now_us;
    if (carry_out(soak, tmini_request_health(&world->lidar), TMINI_EVENT_HEALTH, 10000)) {
        check_answer(soak, tmini_health(&world->lidar)->faults == sim_health(&world->sim),
                     since_us);
    }
}

static void ask_for_frequency(soak_t *soak)
{
    world_t *const world = &soak->world;
    const uint64_t since_us = world->now_us;
    if (carry_out(soak, tmini_request_frequency(&world->lidar), TMINI_EVENT_FREQUENCY, 10000)) {
        check_answer(soak, tmini_frequency_chz(&world->lidar) == sim_frequency_chz(&world->sim),
                     since_us);
    }
}

static void set_frequency(soak_t *soak)
{
    world_t *const world = &soak->world;
    const uint64_t since_us = world->now_us;
    const uint16_t target_chz = (uint16_t)(600 + 10 * between(soak, 0, 60));
    if (carry_out(soak, tmini_set_frequency(&world->lidar, target_chz), TMINI_EVENT_FREQUENCY,
                  20000)) {
        check_answer(soak, sim_frequency_chz(&world->sim) == target_chz, since_us);
    }
}

static void reboot(soak_t *soak)
{
    (void)carry_out(soak, tmini_reboot(&soak->world.lidar), TMINI_EVENT_REBOOTED, 10000);
}

static void (*const requests[])(soak_t *soak) = {ask_for_info, ask_for_health, ask_for_frequency,
                                                 set_frequency, reboot};

/* Stops the lidar and makes some requests. After that, keep_scanning() starts it again. */
static void make_requests(soak_t *soak)
{
    world_t *const world = &soak->world;
    if (!carry_out(soak, tmini_stop(&world->lidar), TMINI_EVENT_STOPPED, 5000)) {
        return;
    }
    for (uint32_t left = between(soak, 0, 4); left > 0; left--) {
        requests[between(soak, 0, 4)](soak);
        if (tmini_state(&world->lidar) == TMINI_STATE_BUSY) {
            return; /* The request has not ended in time: make no others. */
        }
    }
}

static void restart_library(soak_t *soak)
{
    soak->restarts++;
    world_restart_library(&soak->world);
}

/* ---- The line ---- */

static uint32_t draw_gap(soak_t *soak, uint32_t low, uint32_t high)
{
    uint32_t gap = low;
    while (gap < high && !one_in(soak, 3)) {
        gap *= 2;
    }
    return gap;
}

static void set_gap(soak_t *soak, sim_link_kind_t kind, uint32_t low, uint32_t high)
{
    sim_link_set_mean_gap(&soak->world.link, kind, draw_gap(soak, low, high), soak->world.now_us);
}

/* Sets rates from one damaged byte in 150 to one in 100,000, and of other faults. */
static void bring_bad_weather(soak_t *soak)
{
    static const struct {
        uint32_t low;
        uint32_t high;
    } ranges[SIM_LINK_KINDS] = {
        [SIM_LINK_DROP] = {150, 100000},    [SIM_LINK_FLIP] = {150, 100000},
        [SIM_LINK_INSERT] = {150, 100000},  [SIM_LINK_BURST] = {30, 10000},
        [SIM_LINK_STALL] = {200, 20000},    [SIM_LINK_CUT] = {30, 10000},
        [SIM_LINK_UNPLUG] = {10000, 60000}, [SIM_LINK_GARBLE] = {4000, 60000},
    };
    const bool all = one_in(soak, 4);
    const uint32_t only = between(soak, 0, SIM_LINK_KINDS - 1);

    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        if (all || kind == only || one_in(soak, 6)) {
            set_gap(soak, (sim_link_kind_t)kind, ranges[kind].low, ranges[kind].high);
        }
    }
}

static void live_through_bad_weather(soak_t *soak)
{
    bring_bad_weather(soak);
    for (uint32_t left = between(soak, 1, 6); left > 0; left--) {
        run_ms(soak, between(soak, 1000, 20000));
        if (one_in(soak, 4)) {
            restart_library(soak);
        } else if (one_in(soak, 4)) {
            make_requests(soak);
        }
    }
    sim_link_calm(&soak->world.link, soak->world.now_us);
}

/* ---- The lidar ---- */

typedef enum { BLOCKED, COVERED, SICK, LIDAR_FAULTS } lidar_fault_t;

static void set_fault(soak_t *soak, lidar_fault_t fault, bool on)
{
    sim_t *const sim = &soak->world.sim;
    if (fault == BLOCKED) {
        sim_block_rotor(sim, on);
    } else if (fault == COVERED) {
        sim_cover_window(sim, on);
    } else {
        sim_set_health(sim, on ? SIM_HEALTH_SENSOR | SIM_HEALTH_LD : 0);
    }
}

/* The faults that the library must report (tmini_faults() in tmini.h). */
static uint8_t expected_faults(const soak_t *soak, lidar_fault_t fault)
{
    const sim_config_t *const sim = &soak->world.config.sim;
    switch (fault) {
    case BLOCKED:
        return !sim->ct_information && sim->blocked_sends_starts ? TMINI_FAULT_DATA
                                                                 : TMINI_FAULT_ENCODER;
    case COVERED:
        return TMINI_FAULT_DATA;
    default:
        return sim->ct_information ? TMINI_FAULT_SENSOR | TMINI_FAULT_LD : 0;
    }
}

static void expect_faults(soak_t *soak, uint8_t expected, uint64_t since_us)
{
    /* Without TMINI_FAULT_FREQUENCY, which scripts.c tests. */
    const uint8_t faults = tmini_faults(&soak->world.lidar) & TMINI_FAULT_MASK;
    char what[60];
    if (faults != expected && world_is_undisturbed_since(&soak->world, since_us)) {
        (void)snprintf(what, sizeof what, "%02X reported, %02X is there", faults, expected);
        world_violate(&soak->world, VIOLATION_MISSED_FAULT, what);
    }
}

static void live_through_a_fault(soak_t *soak)
{
    const lidar_fault_t fault = (lidar_fault_t)between(soak, 0, LIDAR_FAULTS - 1);
    const uint64_t since_us = soak->world.now_us;
    soak->lidar_faults++;
    set_fault(soak, fault, true);
    run_ms(soak, WORLD_FAULT_MS + between(soak, 0, 20000));
    expect_faults(soak, expected_faults(soak, fault), since_us);
    set_fault(soak, fault, false);
    run_ms(soak, WORLD_FAULT_MS);
    expect_faults(soak, 0, since_us);
}

/* ---- */

static void live(soak_t *soak, uint32_t ms)
{
    world_t *const world = &soak->world;
    while (world->now_us < (uint64_t)ms * 1000u) {
        live_through_bad_weather(soak);
        /* After any faults, scans must have resumed by then. */
        run_ms(soak, WORLD_RECOVERY_MS + 5000u);
        if (tmini_state(&world->lidar) != TMINI_STATE_SCANNING) {
            world_violate(world, VIOLATION_SLOW_RECOVERY, "not scanning on an undisturbed line");
        }
        if (one_in(soak, 2)) {
            live_through_a_fault(soak);
        }
        if (one_in(soak, 3)) {
            make_requests(soak);
            run_ms(soak, WORLD_RECOVERY_MS);
        }
    }
}

static void add_up(totals_t *totals, const soak_t *soak)
{
    const world_t *const world = &soak->world;
    const world_counts_t *const counts = &world->counts;
    totals->lives++;
    totals->ms += world->now_us / 1000u;
    totals->bytes += world->fed_before + world->fed;
    totals->scans += counts->events[TMINI_EVENT_SCAN];
    totals->packets += counts->packets_checked;
    totals->points += counts->points;
    totals->by_chance += counts->packets_by_chance;
    totals->split += counts->packets_split;
    totals->eclipsed += counts->packets_eclipsed;
    totals->lidar_faults += soak->lidar_faults;
    totals->fault_events += counts->events[TMINI_EVENT_FAULTS_CHANGED];
    totals->losses += counts->events[TMINI_EVENT_LOST];
    totals->recoveries += counts->events[TMINI_EVENT_RECOVERED];
    totals->library_restarts += soak->restarts;
    totals->commands += soak->commands;
    totals->failures += soak->failures;
    totals->commands_in_tail += world->sim.counts.commands_in_tail;
    if (counts->worst_recovery_ms > totals->worst_recovery_ms) {
        totals->worst_recovery_ms = counts->worst_recovery_ms;
    }
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        totals->line_faults[kind] += world->link.counts.faults[kind];
    }
    for (unsigned kind = 0; kind < VIOLATION_KINDS; kind++) {
        totals->violations[kind] += counts->violations[kind];
    }
}

static void print_number(const char *what, uint64_t number)
{
    printf("%-44s %12llu\n", what, (unsigned long long)number);
}

static uint32_t print(const totals_t *totals)
{
    uint32_t violations = 0;
    print_number("minutes of virtual time", totals->ms / 60000u);
    print_number("lidars, lines and programs", totals->lives);
    print_number("bytes", totals->bytes);
    print_number("scans", totals->scans);
    print_number("packets compared with what was sent", totals->packets);
    print_number("points compared", totals->points);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        printf("faults of the line: %-24s %12u\n", sim_link_kind_name((sim_link_kind_t)kind),
               (unsigned)totals->line_faults[kind]);
    }
    print_number("faults of the lidar", totals->lidar_faults);
    print_number("fault events", totals->fault_events);
    print_number("losses", totals->losses);
    print_number("recoveries", totals->recoveries);
    print_number("worst time to recover, ms", totals->worst_recovery_ms);
    print_number("restarts of the program", totals->library_restarts);
    print_number("commands besides start", totals->commands);
    print_number("of which failed", totals->failures);
    print_number("commands into the tail of a stop", totals->commands_in_tail);
    print_number("damaged, but valid by chance", totals->by_chance);
    print_number("given up in a silence", totals->split);
    print_number("begun inside a packet valid by chance", totals->eclipsed);
    for (unsigned kind = 0; kind < VIOLATION_KINDS; kind++) {
        printf("VIOLATIONS: %-32s %12u\n", world_violation_name((violation_t)kind),
               (unsigned)totals->violations[kind]);
        violations += totals->violations[kind];
    }
    return violations;
}

int main(int argc, char **argv)
{
    static soak_t soak;
    static totals_t totals;
    const double hours = argc > 1 ? strtod(argv[1], NULL) : 0;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    if (argc > 3 || !(hours > 0 && hours <= MAX_HOURS)) {
        fprintf(stderr, "usage: soak HOURS [SEED]: hours of virtual time, above 0 to 1000\n");
        return 2;
    }
    const uint64_t all_ms = (uint64_t)(hours * 3600000.0);
    for (uint64_t ms = 0; ms < all_ms; ms += LIFE_MS) {
        const uint64_t left_ms = all_ms - ms;
        const uint64_t life = seed * 1000000u + ms / LIFE_MS;
        memset(&soak, 0, sizeof soak);
        random_seed(&soak.random, life);
        const world_config_t config = draw_config(&soak, life);
        world_init(&soak.world, &config);
        live(&soak, left_ms < LIFE_MS ? (uint32_t)left_ms : LIFE_MS);
        add_up(&totals, &soak);
    }
    return print(&totals) == 0 ? 0 : 1;
}
