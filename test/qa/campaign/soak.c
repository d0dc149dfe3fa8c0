/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* campaign soak HOURS [SEED]
 *
 * Runs the library with the simulated lidar for HOURS of virtual time, half an hour for each of
 * many configurations, with all kinds of faults: on the line, in the lidar, in the program that
 * uses the library. Prints what happened. Exit status: 0 if the library did nothing wrong
 * (watch.h lists the checks), 1 if it did, 2 wrong usage. The same seed gives the same run. */

#include "bed.h"
#include "campaign.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIFE_MS 1800000u
#define MAX_HOURS 1000.0

static bed_t bed;
static watch_t watch;
static uint8_t rx[8192];
static tmini_point_t points[4000];

/* What happened in all lives. */
static struct {
    uint32_t line_faults[SIM_LINK_KINDS];
    uint32_t lidar_faults, worst_recovery_ms, restarts;
    uint64_t points;
    uint32_t events[BED_EVENTS];
    uint64_t wrongs[WRONG_KINDS];
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

static uint16_t wanted_chz;

static tmini_status_t set_frequency(tmini_t *lidar)
{
    wanted_chz = (uint16_t)(600 + 10 * between(0, 60));
    return tmini_set_frequency(lidar, wanted_chz);
}

static bool knows_information(void)
{
    const encode_information_t *const truth = &bed.sim.config.information;
    const tmini_info_t *const info = tmini_info(&bed.lidar);
    return info->model == truth->model && info->hardware == truth->hardware &&
           info->firmware_major == truth->firmware_major &&
           info->firmware_minor == truth->firmware_minor &&
           memcmp(info->serial, truth->serial, sizeof info->serial) == 0;
}

static bool knows_health(void)
{
    return tmini_health(&bed.lidar)->faults == sim_health(&bed.sim);
}

static bool knows_frequency(void)
{
    return tmini_frequency_chz(&bed.lidar) == sim_frequency_chz(&bed.sim);
}

static bool has_set_frequency(void)
{
    return sim_frequency_chz(&bed.sim) == wanted_chz;
}

typedef struct {
    tmini_status_t (*begin)(tmini_t *lidar);
    tmini_event_t end;
    uint32_t limit_ms;
    bool (*is_right)(void); /* What the driver knows then. NULL: nothing new. */
} request_t;

static const request_t stop = {tmini_stop, TMINI_EVENT_STOPPED, 5000, NULL};
static const request_t requests[] = {
    {tmini_request_info, TMINI_EVENT_INFO, 10000, knows_information},
    {tmini_request_health, TMINI_EVENT_HEALTH, 10000, knows_health},
    {tmini_request_frequency, TMINI_EVENT_FREQUENCY, 10000, knows_frequency},
    {set_frequency, TMINI_EVENT_FREQUENCY, 20000, has_set_frequency},
    {tmini_reboot, TMINI_EVENT_REBOOTED, 10000, NULL},
};

/* Returns true if it ended with its event. On an undisturbed line it must, and with the truth. */
static bool carry_out(const request_t *request)
{
    const uint64_t since_us = bed.now_us;
    const unsigned end = BIT(request->end);
    const unsigned ends = end | BIT(TMINI_EVENT_COMMAND_FAILED);
    const bool has_begun = request->begin(&bed.lidar) == TMINI_OK;
    unsigned events = has_begun ? bed_run_until(&bed, ends, request->limit_ms) : 0;
    if (has_begun && (events & end) == 0 &&
        tmini_command_error(&bed.lidar) == TMINI_ERROR_ABORTED) {
        /* This was only the end of an earlier start: wait again. */
        events |= bed_run_until(&bed, ends, request->limit_ms);
    }
    const bool has_ended = (events & end) != 0;
    const bool is_right = has_ended && (request->is_right == NULL || request->is_right());
    if (!has_begun || (!is_right && watch_is_undisturbed_since(&bed, since_us))) {
        watch_complain(&bed, WRONG_ANSWER);
    }
    return has_ended;
}

/* Stops the lidar and makes some requests. After that, keep_scanning() starts it again. */
static void make_requests(void)
{
    if (!carry_out(&stop)) {
        return;
    }
    for (uint32_t left = between(0, 4); left > 0; left--) {
        (void)carry_out(&requests[between(0, 4)]);
        if (tmini_state(&bed.lidar) == TMINI_STATE_BUSY) {
            return; /* The request has not ended in time: make no others. */
        }
    }
}

/* ---- The line ---- */

static void set_gap(sim_link_kind_t kind, uint32_t low, uint32_t high)
{
    uint32_t gap = low;
    while (gap < high && !one_in(3)) {
        gap *= 2;
    }
    sim_link_set_mean_gap(&watch.link, kind, gap, bed.now_us);
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
            done.restarts++;
            (void)bed_restart(&bed);
        } else if (one_in(4)) {
            make_requests();
        }
    }
    sim_link_calm(&watch.link, bed.now_us);
}

/* ---- The lidar ---- */

typedef enum { BLOCKED, COVERED, SICK, LIDAR_FAULTS } lidar_fault_t;

/* Returns the faults that the library must report while it is on (tmini_faults() in tmini.h). */
static uint8_t set_fault(lidar_fault_t fault, bool on)
{
    const sim_config_t *const sim = &bed.sim.config;
    if (fault == BLOCKED) {
        sim_block_rotor(&bed.sim, on);
        return !sim->ct_information && sim->blocked_sends_starts ? TMINI_FAULT_DATA
                                                                 : TMINI_FAULT_ENCODER;
    }
    if (fault == COVERED) {
        sim_cover_window(&bed.sim, on);
        return TMINI_FAULT_DATA;
    }
    sim_set_health(&bed.sim, on ? SIM_HEALTH_SENSOR | SIM_HEALTH_LD : 0);
    return sim->ct_information ? TMINI_FAULT_SENSOR | TMINI_FAULT_LD : 0;
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
    const uint8_t expected = set_fault(fault, true);
    run_ms(WATCH_FAULT_MS + between(0, 20000));
    expect_faults(expected, since_us);
    (void)set_fault(fault, false);
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

static void add_up(void)
{
    const watch_counts_t *const counts = &watch.counts;
    done.points += counts->points;
    if (counts->worst_recovery_ms > done.worst_recovery_ms) {
        done.worst_recovery_ms = counts->worst_recovery_ms;
    }
    for (unsigned event = 0; event < BED_EVENTS; event++) {
        done.events[event] += bed.events[event];
    }
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        done.line_faults[kind] += watch.link.counts.faults[kind];
    }
    for (unsigned kind = 0; kind < WRONG_KINDS; kind++) {
        done.wrongs[kind] += counts->wrongs[kind];
    }
}

static void print(const char *what, const char *kind, uint64_t number)
{
    printf("%s%-*s %12llu\n", what, 44 - (int)strlen(what), kind, (unsigned long long)number);
}

/* Returns whether nothing was wrong. */
static bool report(void)
{
    bool is_right = true;
    print("scans", "", done.events[TMINI_EVENT_SCAN]);
    print("points compared", "", done.points);
    for (unsigned kind = 0; kind < SIM_LINK_KINDS; kind++) {
        print("faults of the line: ", sim_link_kind_name((sim_link_kind_t)kind),
              done.line_faults[kind]);
    }
    print("faults of the lidar", "", done.lidar_faults);
    print("losses", "", done.events[TMINI_EVENT_LOST]);
    print("worst time to recover, ms", "", done.worst_recovery_ms);
    print("restarts of the program", "", done.restarts);
    for (unsigned kind = 0; kind < WRONG_KINDS; kind++) {
        print("WRONG: ", watch_name(kind), done.wrongs[kind]);
        is_right = is_right && done.wrongs[kind] == 0;
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
