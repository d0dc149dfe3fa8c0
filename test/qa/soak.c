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

static world_t world;
static random_t dice;

/* What is added up over all lives, in the order of the report. */
typedef enum {
    MINUTES,
    LIVES,
    BYTES,
    SCANS,
    PACKETS,
    POINTS,
    LINE_FAULTS,
    LIDAR_FAULTS_MADE = LINE_FAULTS + SIM_LINK_KINDS,
    FAULT_EVENTS,
    LOSSES,
    RECOVERIES,
    WORST_RECOVERY_MS,
    RESTARTS,
    COMMANDS,
    FAILURES,
    COMMANDS_IN_TAIL,
    BY_CHANCE,
    SPLIT,
    ECLIPSED,
    TOTALS
} total_t;

static const char *const total_names[TOTALS] = {
    [MINUTES] = "minutes of virtual time",
    [LIVES] = "lidars, lines and programs",
    [BYTES] = "bytes",
    [SCANS] = "scans",
    [PACKETS] = "packets compared with what was sent",
    [POINTS] = "points compared",
    [LIDAR_FAULTS_MADE] = "faults of the lidar",
    [FAULT_EVENTS] = "fault events",
    [LOSSES] = "losses",
    [RECOVERIES] = "recoveries",
    [WORST_RECOVERY_MS] = "worst time to recover, ms",
    [RESTARTS] = "restarts of the program",
    [COMMANDS] = "commands besides start",
    [FAILURES] = "of which failed",
    [COMMANDS_IN_TAIL] = "commands into the tail of a stop",
    [BY_CHANCE] = "damaged, but valid by chance",
    [SPLIT] = "given up in a silence",
    [ECLIPSED] = "begun inside a packet valid by chance"};

static uint64_t totals[TOTALS];
static uint32_t violations[VIOLATION_KINDS];

static uint32_t between(uint32_t low, uint32_t high)
{
    return random_between(&dice, low, high);
}

static bool one_in(uint32_t number)
{
    return random_below(&dice, number) == 0;
}

/* ---- Configuration: each life has another lidar, another line and another program ---- */

static world_config_t draw_config(uint64_t seed)
{
    world_config_t config = world_default_config();
    config.seed = seed;
    config.sim.ct_information = !one_in(3);
    config.sim.frequency_chz = (uint16_t)(600 + 10 * between(0, 60));
    config.sim.stop_tail_ms = (uint16_t)between(10, 300);
    config.sim.reply_latency_ms = (uint16_t)between(1, 40);
    config.sim.start_angle_q6 = one_in(2) ? 0 : (uint16_t)between(0, 23039);
    config.sim.blocked_sends_starts = one_in(2);
    config.sim.boot_ms = (uint16_t)between(500, 4000);
    config.sim.beginning = (sim_beginning_t)between(SIM_BEGINS_ANYWHERE, SIM_BEGINS_WITH_A_START);
    config.sim.information.firmware_minor = one_in(2) ? 3 : 2;
    config.dma = one_in(2);
    config.rx_size = config.dma ? 8192 : 2048;
    config.streaming = one_in(3);
    config.short_writes = one_in(3);
    config.busy_one_in = one_in(3) ? 0 : (uint16_t)between(20, 500);
    config.busy_ms = 60;
    return config;
}

/* ---- The program that uses the library: it always wants scans ---- */

static void keep_scanning(void)
{
    const tmini_state_t state = tmini_state(&world.lidar);
    if ((state == TMINI_STATE_UNKNOWN || state == TMINI_STATE_IDLE) &&
        world.now_us % 100000u == 0) {
        (void)tmini_start(&world.lidar);
    }
}

static void run_ms(uint32_t ms)
{
    for (; ms > 0; ms--) {
        (void)world_step(&world);
        keep_scanning();
    }
}

/* Waits for the end of a command that has begun. Returns true if it ended with the event `end`. */
static bool carry_out(tmini_status_t begun, tmini_event_t end, uint32_t limit_ms)
{
    const uint64_t begun_us = world.now_us;
    totals[COMMANDS]++;
    if (begun != TMINI_OK) {
        world_violate(&world, VIOLATION_ANSWER, "not begun");
        return false;
    }
    unsigned events = world_run_until(&world, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    if ((events & BIT(end)) == 0 && tmini_command_error(&world.lidar) == TMINI_ERROR_ABORTED) {
        /* This was only the end of an earlier start: wait again. */
        events |= world_run_until(&world, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    }
    if ((events & BIT(end)) != 0) {
        return true;
    }
    totals[FAILURES]++;
    if (world_is_undisturbed_since(&world, begun_us)) {
        world_violate(&world, VIOLATION_ANSWER, "none");
    }
    return false;
}

static void check_answer(bool right, uint64_t since_us)
{
    if (!right && world_is_undisturbed_since(&world, since_us)) {
        world_violate(&world, VIOLATION_ANSWER, "not the truth");
    }
}

static void ask_for_info(void)
{
    const uint64_t since_us = world.now_us;
    const encode_information_t *const truth = &world.config.sim.information;
    if (carry_out(tmini_request_info(&world.lidar), TMINI_EVENT_INFO, 10000)) {
        const tmini_info_t *const info = tmini_info(&world.lidar);
        check_answer(info->model == truth->model && info->hardware == truth->hardware &&
                         info->firmware_major == truth->firmware_major &&
                         info->firmware_minor == truth->firmware_minor &&
                         memcmp(info->serial, truth->serial, sizeof info->serial) == 0,
                     since_us);
    }
}

static void ask_for_health(void)
{
    const uint64_t since_us = world.now_us;
    if (carry_out(tmini_request_health(&world.lidar), TMINI_EVENT_HEALTH, 10000)) {
        check_answer(tmini_health(&world.lidar)->faults == sim_health(&world.sim), since_us);
    }
}

/* What the lidar is set to is what the driver knows, and what was wanted; 0: only asked. */
static void settle_frequency(uint16_t wanted_chz)
{
    const uint64_t since_us = world.now_us;
    const tmini_status_t begun = wanted_chz == 0 ? tmini_request_frequency(&world.lidar)
                                                 : tmini_set_frequency(&world.lidar, wanted_chz);
    if (carry_out(begun, TMINI_EVENT_FREQUENCY, wanted_chz == 0 ? 10000 : 20000)) {
        const uint16_t set_chz = sim_frequency_chz(&world.sim);
        check_answer(set_chz == (wanted_chz == 0 ? tmini_frequency_chz(&world.lidar) : wanted_chz),
                     since_us);
    }
}

static void ask_for_frequency(void)
{
    settle_frequency(0);
}

static void set_frequency(void)
{
    settle_frequency((uint16_t)(600 + 10 * between(0, 60)));
}

static void reboot(void)
{
    (void)carry_out(tmini_reboot(&world.lidar), TMINI_EVENT_REBOOTED, 10000);
}

static void (*const requests[])(void) = {ask_for_info, ask_for_health, ask_for_frequency,
                                         set_frequency, reboot};

/* Stops the lidar and makes some requests. After that, keep_scanning() starts it again. */
static void make_requests(void)
{
    if (!carry_out(tmini_stop(&world.lidar), TMINI_EVENT_STOPPED, 5000)) {
        return;
    }
    for (uint32_t left = between(0, 4); left > 0; left--) {
        requests[between(0, 4)]();
        if (tmini_state(&world.lidar) == TMINI_STATE_BUSY) {
            return; /* The request has not ended in time: make no others. */
        }
    }
}

static void restart_library(void)
{
    totals[RESTARTS]++;
    world_restart_library(&world);
}

/* ---- The line ---- */

static uint32_t draw_gap(uint32_t low, uint32_t high)
{
    uint32_t gap = low;
    while (gap < high && !one_in(3)) {
        gap *= 2;
    }
    return gap;
}

static void set_gap(sim_link_kind_t kind, uint32_t low, uint32_t high)
{
    sim_link_set_mean_gap(&world.link, kind, draw_gap(low, high), world.now_us);
}

/* Sets rates from one damaged byte in 150 to one in 100,000, and of other faults. */
static void bring_bad_weather(void)
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
    const bool all = one_in(4);
    const uint32_t only = between(0, SIM_LINK_KINDS - 1);

    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        if (all || kind == only || one_in(6)) {
            set_gap((sim_link_kind_t)kind, ranges[kind].low, ranges[kind].high);
        }
    }
}

static void live_through_bad_weather(void)
{
    bring_bad_weather();
    for (uint32_t left = between(1, 6); left > 0; left--) {
        run_ms(between(1000, 20000));
        if (one_in(4)) {
            restart_library();
        } else if (one_in(4)) {
            make_requests();
        }
    }
    sim_link_calm(&world.link, world.now_us);
}

/* ---- The lidar ---- */

typedef enum { BLOCKED, COVERED, SICK, LIDAR_FAULTS } lidar_fault_t;

static void set_fault(lidar_fault_t fault, bool on)
{
    if (fault == BLOCKED) {
        sim_block_rotor(&world.sim, on);
    } else if (fault == COVERED) {
        sim_cover_window(&world.sim, on);
    } else {
        sim_set_health(&world.sim, on ? SIM_HEALTH_SENSOR | SIM_HEALTH_LD : 0);
    }
}

/* The faults that the library must report (tmini_faults() in tmini.h). */
static uint8_t expected_faults(lidar_fault_t fault)
{
    const sim_config_t *const sim = &world.config.sim;
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

static void expect_faults(uint8_t expected, uint64_t since_us)
{
    /* Without TMINI_FAULT_FREQUENCY, which scripts.c tests. */
    const uint8_t faults = tmini_faults(&world.lidar) & TMINI_FAULT_MASK;
    char what[60];
    if (faults != expected && world_is_undisturbed_since(&world, since_us)) {
        (void)snprintf(what, sizeof what, "%02X reported, %02X is there", faults, expected);
        world_violate(&world, VIOLATION_MISSED_FAULT, what);
    }
}

static void live_through_a_fault(void)
{
    const lidar_fault_t fault = (lidar_fault_t)between(0, LIDAR_FAULTS - 1);
    const uint64_t since_us = world.now_us;
    totals[LIDAR_FAULTS_MADE]++;
    set_fault(fault, true);
    run_ms(WORLD_FAULT_MS + between(0, 20000));
    expect_faults(expected_faults(fault), since_us);
    set_fault(fault, false);
    run_ms(WORLD_FAULT_MS);
    expect_faults(0, since_us);
}

/* ---- */

static void live(uint32_t ms)
{
    while (world.now_us < (uint64_t)ms * 1000u) {
        live_through_bad_weather();
        /* After any faults, scans must have resumed by then. */
        run_ms(WORLD_RECOVERY_MS + 5000u);
        if (tmini_state(&world.lidar) != TMINI_STATE_SCANNING) {
            world_violate(&world, VIOLATION_SLOW_RECOVERY, "not scanning on an undisturbed line");
        }
        if (one_in(2)) {
            live_through_a_fault();
        }
        if (one_in(3)) {
            make_requests();
            run_ms(WORLD_RECOVERY_MS);
        }
    }
}

static void add_up(void)
{
    const world_counts_t *const counts = &world.counts;
    totals[LIVES]++;
    totals[MINUTES] += world.now_us / 1000u / 60u;
    totals[BYTES] += world.fed_before + world.fed;
    totals[SCANS] += counts->events[TMINI_EVENT_SCAN];
    totals[PACKETS] += counts->packets_checked;
    totals[POINTS] += counts->points;
    totals[FAULT_EVENTS] += counts->events[TMINI_EVENT_FAULTS_CHANGED];
    totals[LOSSES] += counts->events[TMINI_EVENT_LOST];
    totals[RECOVERIES] += counts->events[TMINI_EVENT_RECOVERED];
    totals[COMMANDS_IN_TAIL] += world.sim.counts.commands_in_tail;
    totals[BY_CHANCE] += counts->packets_by_chance;
    totals[SPLIT] += counts->packets_split;
    totals[ECLIPSED] += counts->packets_eclipsed;
    if (counts->worst_recovery_ms > totals[WORST_RECOVERY_MS]) {
        totals[WORST_RECOVERY_MS] = counts->worst_recovery_ms;
    }
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        totals[LINE_FAULTS + kind] += world.link.counts.faults[kind];
    }
    for (unsigned kind = 0; kind < VIOLATION_KINDS; kind++) {
        violations[kind] += counts->violations[kind];
    }
}

static uint32_t print(void)
{
    uint32_t sum = 0;
    totals[MINUTES] /= 1000u;
    for (unsigned i = 0; i < TOTALS; i++) {
        char fault[40];
        (void)snprintf(
            fault, sizeof fault, "faults of the line: %s",
            total_names[i] == NULL ? sim_link_kind_name((sim_link_kind_t)(i - LINE_FAULTS)) : "");
        printf("%-44s %12llu\n", total_names[i] == NULL ? fault : total_names[i],
               (unsigned long long)totals[i]);
    }
    for (unsigned kind = 0; kind < VIOLATION_KINDS; kind++) {
        printf("VIOLATIONS: %-32s %12u\n", world_violation_name((violation_t)kind),
               (unsigned)violations[kind]);
        sum += violations[kind];
    }
    return sum;
}

int main(int argc, char **argv)
{
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
        random_seed(&dice, life);
        const world_config_t config = draw_config(life);
        world_init(&world, &config);
        live(left_ms < LIFE_MS ? (uint32_t)left_ms : LIFE_MS);
        add_up();
    }
    return print() == 0 ? 0 : 1;
}
