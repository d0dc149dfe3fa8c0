/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* campaign soak HOURS [SEED]
 *
 * Runs the library with the simulated lidar for HOURS of virtual time, half an hour for each of
 * many configurations, with all kinds of faults: on the line, in the lidar, in the program that
 * uses the library. Prints what happened. Exit status: 0 if the library did nothing wrong
 * (watch.h lists the checks), 1 if it did, 2 wrong usage. The same seed gives the same run. */

#include "soak.h"

#include "bed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIFE_MS 1800000u
#define MAX_HOURS 1000.0

static bed_t bed;
static watch_t watch;
static uint8_t rx[8192];
static tmini_point_t points[4000];

/* What the program did, in all lives. */
static struct {
    uint32_t lives, lidar_faults, restarts, commands, failures;
} done;

/* ---- Configuration: each life has another lidar, another line and another program ---- */

static sim_config_t draw_lidar(uint64_t seed)
{
    sim_config_t lidar = sim_default_config();
    lidar.seed = seed;
    lidar.marked = true;
    lidar.ct_information = !one_in(3);
    lidar.frequency_chz = (uint16_t)(600 + 10 * between(0, 60));
    lidar.stop_tail_ms = (uint16_t)between(10, 300);
    lidar.reply_latency_ms = (uint16_t)between(1, 40);
    lidar.start_angle_q6 = one_in(2) ? 0 : (uint16_t)between(0, 23039);
    lidar.blocked_sends_starts = one_in(2);
    lidar.boot_ms = (uint16_t)between(500, 4000);
    lidar.beginning = (sim_beginning_t)between(SIM_BEGINS_ANYWHERE, SIM_BEGINS_WITH_A_START);
    lidar.information.firmware_minor = one_in(2) ? 3 : 2;
    return lidar;
}

static void begin_life(uint64_t seed)
{
    const sim_config_t lidar = draw_lidar(seed);
    memset(&watch, 0, sizeof watch);
    watch.line = sim_link_default_config();
    watch.line.seed = seed;
    bed_prepare(&bed);
    bed.watch = &watch;
    bed.config.rx_buffer = rx;
    bed.config.rx_dma = one_in(2);
    bed.config.rx_size = bed.config.rx_dma ? sizeof rx : 2048;
    bed.config.points = one_in(3) ? NULL : points;
    bed.config.max_points = bed.config.points == NULL ? 0 : sizeof points / sizeof points[0];
    bed.writes_short = one_in(3);
    bed.busy_one_in = one_in(3) ? 0 : (uint16_t)between(20, 500);
    bed.busy_ms = 60;
    if (!bed_init(&bed, &lidar)) {
        watch_complain(&bed, WRONG_STATE);
    }
}

/* ---- The program that uses the library: it always wants scans ---- */

static void keep_scanning(void)
{
    const tmini_state_t state = tmini_state(&bed.lidar);
    if ((state == TMINI_STATE_UNKNOWN || state == TMINI_STATE_IDLE) && bed.now_us % 100000u == 0) {
        (void)tmini_start(&bed.lidar);
    }
}

static void run_ms(uint32_t ms)
{
    for (; ms > 0; ms--) {
        bed_step(&bed);
        keep_scanning();
    }
}

/* Waits for the end of a command that has begun. Returns true if it ended with the event `end`. */
static bool carry_out(tmini_status_t begun, tmini_event_t end, uint32_t limit_ms)
{
    const uint64_t begun_us = bed.now_us;
    done.commands++;
    if (begun != TMINI_OK) {
        watch_complain(&bed, WRONG_ANSWER);
        return false;
    }
    unsigned events = bed_run_until(&bed, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    if ((events & BIT(end)) == 0 && tmini_command_error(&bed.lidar) == TMINI_ERROR_ABORTED) {
        /* This was only the end of an earlier start: wait again. */
        events |= bed_run_until(&bed, BIT(end) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);
    }
    if ((events & BIT(end)) != 0) {
        return true;
    }
    done.failures++;
    if (watch_is_undisturbed_since(&bed, begun_us)) {
        watch_complain(&bed, WRONG_ANSWER);
    }
    return false;
}

static void check_answer(bool right, uint64_t since_us)
{
    if (!right && watch_is_undisturbed_since(&bed, since_us)) {
        watch_complain(&bed, WRONG_ANSWER);
    }
}

static void ask_for_info(void)
{
    const uint64_t since_us = bed.now_us;
    const encode_information_t *const truth = &bed.sim.config.information;
    if (carry_out(tmini_request_info(&bed.lidar), TMINI_EVENT_INFO, 10000)) {
        const tmini_info_t *const info = tmini_info(&bed.lidar);
        check_answer(info->model == truth->model && info->hardware == truth->hardware &&
                         info->firmware_major == truth->firmware_major &&
                         info->firmware_minor == truth->firmware_minor &&
                         memcmp(info->serial, truth->serial, sizeof info->serial) == 0,
                     since_us);
    }
}

static void ask_for_health(void)
{
    const uint64_t since_us = bed.now_us;
    if (carry_out(tmini_request_health(&bed.lidar), TMINI_EVENT_HEALTH, 10000)) {
        check_answer(tmini_health(&bed.lidar)->faults == sim_health(&bed.sim), since_us);
    }
}

/* What the lidar is set to is what the driver knows, and what was wanted; 0: only asked. */
static void settle_frequency(uint16_t wanted_chz)
{
    const uint64_t since_us = bed.now_us;
    const tmini_status_t begun = wanted_chz == 0 ? tmini_request_frequency(&bed.lidar)
                                                 : tmini_set_frequency(&bed.lidar, wanted_chz);
    if (carry_out(begun, TMINI_EVENT_FREQUENCY, wanted_chz == 0 ? 10000 : 20000)) {
        const uint16_t set_chz = sim_frequency_chz(&bed.sim);
        check_answer(set_chz == (wanted_chz == 0 ? tmini_frequency_chz(&bed.lidar) : wanted_chz),
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
    (void)carry_out(tmini_reboot(&bed.lidar), TMINI_EVENT_REBOOTED, 10000);
}

static void (*const requests[])(void) = {ask_for_info, ask_for_health, ask_for_frequency,
                                         set_frequency, reboot};

/* Stops the lidar and makes some requests. After that, keep_scanning() starts it again. */
static void make_requests(void)
{
    if (!carry_out(tmini_stop(&bed.lidar), TMINI_EVENT_STOPPED, 5000)) {
        return;
    }
    for (uint32_t left = between(0, 4); left > 0; left--) {
        requests[between(0, 4)]();
        if (tmini_state(&bed.lidar) == TMINI_STATE_BUSY) {
            return; /* The request has not ended in time: make no others. */
        }
    }
}

static void restart_library(void)
{
    done.restarts++;
    (void)bed_restart(&bed);
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
    sim_link_set_mean_gap(&watch.link, kind, draw_gap(low, high), bed.now_us);
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
    sim_link_calm(&watch.link, bed.now_us);
}

/* ---- The lidar ---- */

typedef enum { BLOCKED, COVERED, SICK, LIDAR_FAULTS } lidar_fault_t;

static void set_fault(lidar_fault_t fault, bool on)
{
    if (fault == BLOCKED) {
        sim_block_rotor(&bed.sim, on);
    } else if (fault == COVERED) {
        sim_cover_window(&bed.sim, on);
    } else {
        sim_set_health(&bed.sim, on ? SIM_HEALTH_SENSOR | SIM_HEALTH_LD : 0);
    }
}

/* The faults that the library must report (tmini_faults() in tmini.h). */
static uint8_t expected_faults(lidar_fault_t fault)
{
    const sim_config_t *const sim = &bed.sim.config;
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
    const uint8_t faults = tmini_faults(&bed.lidar) & TMINI_FAULT_MASK;
    if (faults != expected && watch_is_undisturbed_since(&bed, since_us)) {
        watch_complain(&bed, WRONG_MISSED_FAULT);
    }
}

static void live_through_a_fault(void)
{
    const lidar_fault_t fault = (lidar_fault_t)between(0, LIDAR_FAULTS - 1);
    const uint64_t since_us = bed.now_us;
    done.lidar_faults++;
    set_fault(fault, true);
    run_ms(WATCH_FAULT_MS + between(0, 20000));
    expect_faults(expected_faults(fault), since_us);
    set_fault(fault, false);
    run_ms(WATCH_FAULT_MS);
    expect_faults(0, since_us);
}

/* ---- */

static void live(uint32_t ms)
{
    while (bed.now_us < (uint64_t)ms * 1000u) {
        live_through_bad_weather();
        /* After any faults, scans must have resumed by then. */
        run_ms(WATCH_RECOVERY_MS + 5000u);
        if (tmini_state(&bed.lidar) != TMINI_STATE_SCANNING) {
            watch_complain(&bed, WRONG_SLOW_RECOVERY);
        }
        if (one_in(2)) {
            live_through_a_fault();
        }
        if (one_in(3)) {
            make_requests();
            run_ms(WATCH_RECOVERY_MS);
        }
    }
}

/* ---- The report ---- */

static void print(const char *what, const char *kind, uint64_t number)
{
    char name[60];

    (void)snprintf(name, sizeof name, "%s%s", what, kind);
    printf("%-44s %12llu\n", name, (unsigned long long)number);
}

static uint64_t seconds;
static uint64_t bytes;
static uint32_t events[BED_EVENTS];
static uint32_t line_faults[SIM_LINK_KINDS];
static uint32_t commands_in_tail;
static watch_counts_t sums;

static void add_up(void)
{
    const watch_counts_t *const counts = &watch.counts;
    done.lives++;
    seconds += bed.now_us / 1000000u;
    bytes += watch.arrived;
    commands_in_tail += bed.sim.counts.commands_in_tail;
    sums.points += counts->points;
    sums.packets += counts->packets;
    sums.by_chance += counts->by_chance;
    sums.split += counts->split;
    sums.recoveries += counts->recoveries;
    if (counts->worst_recovery_ms > sums.worst_recovery_ms) {
        sums.worst_recovery_ms = counts->worst_recovery_ms;
    }
    for (unsigned event = 0; event < BED_EVENTS; event++) {
        events[event] += bed.events[event];
    }
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        line_faults[kind] += watch.link.counts.faults[kind];
    }
    for (unsigned kind = 0; kind < WRONG_KINDS; kind++) {
        sums.wrongs[kind] += counts->wrongs[kind];
    }
}

/* Returns whether nothing was wrong. */
static bool report(void)
{
    bool is_right = true;
    print("minutes of virtual time", "", seconds / 60u);
    print("lidars, lines and programs", "", done.lives);
    print("bytes", "", bytes);
    print("scans", "", events[TMINI_EVENT_SCAN]);
    print("packets compared with what was sent", "", sums.packets);
    print("points compared", "", sums.points);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        print("faults of the line: ", sim_link_kind_name((sim_link_kind_t)kind), line_faults[kind]);
    }
    print("faults of the lidar", "", done.lidar_faults);
    print("fault events", "", events[TMINI_EVENT_FAULTS_CHANGED]);
    print("losses", "", events[TMINI_EVENT_LOST]);
    print("recoveries", "", sums.recoveries);
    print("worst time to recover, ms", "", sums.worst_recovery_ms);
    print("restarts of the program", "", done.restarts);
    print("commands besides start", "", done.commands);
    print("of which failed", "", done.failures);
    print("commands into the tail of a stop", "", commands_in_tail);
    print("damaged, but valid by chance", "", sums.by_chance);
    print("given up in a silence", "", sums.split);
    for (unsigned kind = 0; kind < WRONG_KINDS; kind++) {
        print("WRONG: ", watch_name(kind), sums.wrongs[kind]);
        is_right = is_right && sums.wrongs[kind] == 0;
    }
    return is_right;
}

int soak(int argc, char **argv)
{
    const double hours = argc > 1 ? strtod(argv[1], NULL) : 0;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    if (argc > 3 || !(hours > 0 && hours <= MAX_HOURS)) {
        fprintf(stderr,
                "usage: campaign soak HOURS [SEED]: hours of virtual time, above 0 to 1000\n");
        return 2;
    }
    const uint64_t all_ms = (uint64_t)(hours * 3600000.0);
    for (uint64_t ms = 0; ms < all_ms; ms += LIFE_MS) {
        const uint64_t left_ms = all_ms - ms;
        const uint64_t life = seed * 1000000u + ms / LIFE_MS;
        random_seed(&dice, life);
        begin_life(life);
        live(left_ms < LIFE_MS ? (uint32_t)left_ms : LIFE_MS);
        add_up();
    }
    return report() ? 0 : 1;
}
