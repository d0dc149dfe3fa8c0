/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs as a user writes them, with lidars and lines as they are (sections 9.10 to 9.17, 9.20):
 * what they wish, what happens, and what comes of it. All that comes is compared with what was sent
 * (watch.h).
 *
 * A row is told in words (rows.h): a name of store(), act() or judge() with its number, or one of
 * these claims: "in-scanning": the driver's state; "lost:1": how often an event has come. Words
 * before "begin" are configuration; without it all begins at once. Where power may come or fail at
 * every moment, the test is a function. */

#include "bed.h"
#include "rows.h"

#include "tmini/tmini_names.h"
#include "unity.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bed_t bed;
static bed_held_t held;
static sim_config_t lidar;
static watch_t watch;

static void expect(bool is_true, const char *format, ...)
{
    char complaint[200];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(complaint, sizeof complaint, format, arguments);
    va_end(arguments);
    TEST_ASSERT_TRUE_MESSAGE(is_true, complaint);
}

static void expect_good_behaviour(uint32_t moment)
{
    const char *const misdeed = bed_misdeed(&bed);
    expect(misdeed == NULL, "at %u: %s", moment, misdeed);
}

/* All that comes is watched. */
static void prepare(uint16_t frequency_chz)
{
    lidar = bed_quiet_lidar();
    lidar.seed = 3;
    lidar.marked = true;
    memset(&watch, 0, sizeof watch);
    watch.line = sim_link_default_config();
    bed_prepare(&bed);
    bed.watch = &watch;
    bed.config.frequency_chz = frequency_chz;
}

static void begin(void)
{
    expect(bed_init(&bed, &lidar), "the library refuses the configuration");
}

/* Power comes for board and lidar; the lidar listens `deaf_ms` later. */
static void begin_together(uint32_t deaf_ms)
{
    lidar.boot_ms = (uint16_t)deaf_ms;
    begin();
    sim_power(&bed.sim, false, 0);
    sim_power(&bed.sim, true, 0);
}

static void start(void)
{
    expect(bed_start(&bed) == TMINI_OK, "start is refused");
}

/* Runs until `scans` complete scans in a row come at the wished frequency. */
static bool run_until_scans(uint32_t most_ms)
{
    const uint32_t end_ms = bed_ms(&bed) + most_ms;
    while (!bed_scans_at(&bed, bed.wants_chz, 3) && bed_ms(&bed) < end_ms) {
        bed_step(&bed);
    }
    return bed_scans_at(&bed, bed.wants_chz, 3);
}

static void scans_within(uint32_t most_ms)
{
    const uint32_t before_ms = bed_ms(&bed);
    const bool is_scanning = run_until_scans(most_ms);
    expect(is_scanning, "%u ms after %u: %s", most_ms, before_ms, bed_shortcoming(&bed));
}

/* ---- Power-up together ---- */

static void power_up_together(uint16_t frequency_chz, uint32_t step_ms)
{
    for (uint32_t deaf_ms = 0; deaf_ms <= 6000; deaf_ms += step_ms) {
        prepare(frequency_chz);
        begin_together(deaf_ms);
        start();
        (void)run_until_scans(12000);
        expect(bed_scans_at(&bed, frequency_chz, 3), "deaf for %u: no-scans", deaf_ms);
        expect(bed.heard.start_us <= deaf_ms * 1000u + 600000u, "deaf for %u: started at %u",
               deaf_ms, (uint32_t)(bed.heard.start_us / 1000u));
        expect(bed.heard.starts == 1, "deaf for %u: %u starts", deaf_ms, bed.heard.starts);
        expect(frequency_chz == 0 || bed.heard.start_chz == frequency_chz,
               "deaf for %u: started at %u * 0.01 Hz", deaf_ms, bed.heard.start_chz);
        bed_run_ms(&bed, 2000);
        expect(bed.heard.stops_while_scanning == 0, "deaf for %u: stopped while scanning", deaf_ms);
        expect_good_behaviour(deaf_ms);
    }
}

void test_a_lidar_that_listens_later_is_started_once_and_soon(void)
{
    power_up_together(1000, 20);
}

void test_without_a_frequency_a_lidar_that_listens_later_is_started_once_and_soon(void)
{
    power_up_together(0, 20);
}

/* ---- Supply ---- */

static void fail_supply(uint32_t off_ms)
{
    sim_power(&bed.sim, false, bed.now_us);
    bed_run_ms(&bed, off_ms);
    sim_power(&bed.sim, true, bed.now_us);
}

static void supply_fails_for(uint32_t off_ms, uint16_t boot_ms)
{
    prepare(1000);
    lidar.boot_ms = boot_ms;
    bed.poll_ms = 2;
    begin();
    start();
    scans_within(5000);
    memset(&bed.heard, 0, sizeof bed.heard);
    fail_supply(off_ms);
    bed_run_ms(&bed, boot_ms);
    const uint32_t listens_ms = bed_ms(&bed);
    const uint32_t complete = bed.complete;
    while (bed.complete == complete && bed_ms(&bed) < listens_ms + 15000) {
        bed_step(&bed);
    }
    expect(bed_ms(&bed) <= listens_ms + 4000, "off for %u, boots for %u: scans after %u", off_ms,
           boot_ms, bed_ms(&bed) - listens_ms);
    expect(bed.heard.starts == 1 && bed.heard.start_chz == 1000,
           "off for %u, boots for %u: %u starts, at %u * 0.01 Hz", off_ms, boot_ms,
           bed.heard.starts, bed.heard.start_chz);
    bed_run_ms(&bed, 3000);
    expect(bed_scans_at(&bed, 1000, 3), "off for %u: not at 10 Hz", off_ms);
    expect(bed.events[TMINI_EVENT_LOST] <= 1 &&
               bed.events[TMINI_EVENT_LOST] == bed.events[TMINI_EVENT_RECOVERED],
           "off for %u: lost %u times", off_ms, bed.events[TMINI_EVENT_LOST]);
    expect_good_behaviour(off_ms);
}

void test_after_any_supply_failure_scans_come_within_4_s_at_10_hz(void)
{
    static const uint16_t boots_ms[] = {100, 700, 2500};
    for (unsigned i = 0; i < 3; i++) {
        for (uint32_t ms = 20; ms <= 60000; ms += ms < 2000 ? 60 : ms / 16) {
            supply_fails_for(ms, boots_ms[i]);
        }
    }
}

static void odd_frequency_and_supply(uint16_t chz)
{
    for (uint32_t moment_ms = 0; moment_ms < 6000; moment_ms += 20) {
        prepare(chz);
        bed.poll_ms = 5;
        begin();
        start();
        bed_run_ms(&bed, moment_ms);
        fail_supply(50);
        bed_run_ms(&bed, lidar.boot_ms);
        (void)run_until_scans(15000);
        expect(bed_scans_at(&bed, chz, 3), "at %u, wish %u: %s", moment_ms, chz,
               bed_shortcoming(&bed));
        expect_good_behaviour(moment_ms);
    }
}

void test_a_wish_near_the_lidars_own_frequency_survives_a_supply_failure(void)
{
    for (uint16_t chz = 610; chz <= 630; chz += 10) {
        odd_frequency_and_supply(chz);
    }
}

/* ---- A quiet line; a task that sleeps ---- */

static void let_others_start(void)
{
    static const uint8_t command[] = {0xA5, SIM_COMMAND_START};
    sim_receive(&bed.sim, command, sizeof command, bed.now_us);
}

/* A controller restarts while the lidar scans; bytes come for 300 ms after a stop. */
void test_a_quiet_line_time_works_or_is_refused(void)
{
    for (uint16_t quiet_ms = 50; quiet_ms < 1000; quiet_ms += 5) {
        prepare(1000);
        lidar.stop_tail_ms = 300;
        bed.timing.quiet_line_ms = quiet_ms;
        if (!bed_init(&bed, &lidar)) {
            continue; /* Refused. */
        }
        let_others_start();
        bed_run_ms(&bed, 2000);
        start();
        bed_run_ms(&bed, 8000);
        expect(bed_scans_at(&bed, 1000, 3), "%u ms: %s", quiet_ms, bed_shortcoming(&bed));
        expect(bed.events[TMINI_EVENT_COMMAND_FAILED] == 0, "%u ms: the first attempt fails",
               quiet_ms);
    }
    prepare(1000);
    bed.timing.quiet_line_ms = 300;
    expect(bed_init(&bed, &lidar), "300 ms is refused");
}

/* A minute of start, loss and stop. */
static void live_a_minute(bool sleeps)
{
    prepare(1000);
    bed.sleeps = sleeps;
    begin();
    start();
    bed_run_ms(&bed, 10000);
    sim_power(&bed.sim, false, bed.now_us);
    bed_run_ms(&bed, 10000);
    sim_power(&bed.sim, true, bed.now_us);
    bed_run_ms(&bed, 10000);
    bed.due_us = 0; /* A program that states a wish polls after it. */
    expect(bed_stop(&bed) == TMINI_OK, "stop is refused");
    bed_run_ms(&bed, 30000);
}

void test_a_task_that_sleeps_as_long_as_it_may_gets_the_same_events(void)
{
    static bed_t awake;
    live_a_minute(false);
    awake = bed;
    live_a_minute(true);
    for (unsigned event = 0; event < BED_EVENTS; event++) {
        expect(bed.events[event] == awake.events[event], "event %u: %u instead of %u", event,
               bed.events[event], awake.events[event]);
        expect(bed.event_us[event] == awake.event_us[event], "event %u at %llu instead of %llu us",
               event, (unsigned long long)bed.event_us[event],
               (unsigned long long)awake.event_us[event]);
    }
    expect(bed.events[TMINI_EVENT_LOST] == 1 && bed.events[TMINI_EVENT_STOPPED] == 1, "no story");
    expect(bed.sent == awake.sent, "other commands");
    expect(bed.wakes < awake.wakes / 3, "%u wake-ups instead of %u", bed.wakes, awake.wakes);
}

/* ---- Steps ---- */

static struct {
    uint32_t complete, small, scans, events;
} marked;

static bool store(const char *word)
{
    const row_member_t members[] = {
        {"wants", MEMBER(bed.config.frequency_chz)},
        {"points", MEMBER(bed.config.max_points)},
        {"ring", MEMBER(bed.config.rx_size)},
        {"dma", MEMBER(bed.config.rx_dma)},
        {"recovery-off", MEMBER(bed.config.recovery)},
        {"listen", MEMBER(bed.config.listen_only)},
        {"max-pause", MEMBER(bed.timing.max_pause_ms)},
        {"reports", MEMBER(held.reported_max)}, /* Of the bytes that a layer below holds. */
        {"writes", MEMBER(bed.write_max)},
        {"polls", MEMBER(bed.poll_ms)},
        {"works", MEMBER(bed.work_ms)},
        {"busy-one-in", MEMBER(bed.busy_one_in)},
        {"busy", MEMBER(bed.busy_ms)},
        {"may-lose", MEMBER(watch.may_lose)},
        {"ct", MEMBER(lidar.ct_information)},
        {"most", MEMBER(lidar.max_frequency_chz)},
        {"motor", MEMBER(lidar.motor_percent)},
        {"spin-up", MEMBER(lidar.spin_up_ms)},
        {"spin-percent", MEMBER(lidar.spin_up_percent)},
        {"beginning", MEMBER(lidar.beginning)},
        {"first-angle", MEMBER(lidar.first_angle_q6)},
        {"tail", MEMBER(lidar.stop_tail_ms)},
        {"starts-when-blocked", MEMBER(lidar.blocked_sends_starts)},
        {"fatal", MEMBER(lidar.fatal_health)},
        {"never-answers", MEMBER(lidar.never_answers)},
        {"forgets", MEMBER(bed.sim.frequency_chz)},
    };
    return row_stores(word, members);
}

static bool call(const char *word, uint32_t number)
{
    const struct {
        const char *word;
        tmini_status_t (*call)(bed_t *bed);
        tmini_status_t (*ask)(tmini_t *lidar);
    } calls[] = {
        {"start", bed_start, NULL},
        {"stop", bed_stop, NULL},
        {"ask", bed_request_info, NULL},
        {"ask-health", NULL, tmini_request_health},
        {"ask-frequency", NULL, tmini_request_frequency},
        {"reboot", NULL, tmini_reboot},
    };
    if (strcmp(word, "set") == 0) {
        expect(bed_set_frequency(&bed, (uint16_t)number) == TMINI_OK, "%u is refused", number);
        return true;
    }
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        if (strcmp(calls[i].word, word) == 0) {
            expect((calls[i].call != NULL ? calls[i].call(&bed) : calls[i].ask(&bed.lidar)) ==
                       TMINI_OK,
                   "%s is refused", word);
            return true;
        }
    }
    return false;
}

/* What happens to the lidar; or faults of the line (link.h), with this mean gap. */
static bool befall(const char *word, uint32_t number)
{
    uint32_t unused;
    const sim_trouble_t trouble = sim_trouble_named(word, &unused);
    const sim_link_kind_t kind = sim_link_kind_named(word);
    if (kind != SIM_LINK_KINDS) {
        sim_link_set_mean_gap(&watch.link, kind, number, bed.now_us);
        return true;
    }
    if (trouble != SIM_SOUND) {
        sim_befall(&bed.sim, trouble, number, bed.now_us);
        return true;
    }
    if (strcmp(word, "power") == 0) {
        sim_power(&bed.sim, number != 0, bed.now_us);
    } else if (strcmp(word, "sick") == 0) {
        sim_set_health(&bed.sim, (uint8_t)number);
    } else if (strcmp(word, "blocked") == 0) {
        sim_block_rotor(&bed.sim, number != 0);
    } else if (strcmp(word, "covered") == 0) {
        sim_cover_window(&bed.sim, number != 0);
    } else if (strcmp(word, "others-start") == 0) {
        let_others_start();
    } else {
        return false;
    }
    return true;
}

static void ask_all(void)
{
    (void)call("ask", 0);
    (void)call("ask-health", 0);
    (void)call("ask-frequency", 0);
}

/* Wishes from 6 to 12 Hz and back, each by so much farther, so long after the one before. */
static void slide(uint32_t wishes, uint32_t by_chz, uint32_t each_ms)
{
    for (uint32_t i = 0; i < wishes; i++) {
        const uint32_t place = i * by_chz % 1200u;
        (void)call("set", 600u + (place < 600u ? place : 1200u - place));
        bed_run_ms(&bed, each_ms);
    }
}

/* 100 ms each second. */
static void be_silent(uint32_t times)
{
    for (; times > 0; times--) {
        sim_befall(&bed.sim, SIM_SILENT, 100, bed.now_us);
        bed_run_ms(&bed, 1000);
    }
}

static uint32_t events(void)
{
    uint32_t sum = 0;
    for (unsigned event = TMINI_EVENT_NONE + 1; event < BED_EVENTS; event++) {
        sum += bed.events[event];
    }
    return sum;
}

static void mark(void)
{
    marked.complete = bed.complete;
    marked.small = bed.small;
    marked.scans = bed.events[TMINI_EVENT_SCAN];
    marked.events = events();
    memset(&bed.heard, 0, sizeof bed.heard);
}

/* Complete scans, and nothing else, for three seconds. */
static void expect_scans(uint32_t chz)
{
    const uint32_t complete = bed.complete;
    const uint32_t scans = bed.events[TMINI_EVENT_SCAN];
    bed_run_ms(&bed, 3000);
    const uint32_t came = bed.complete - complete;
    expect(came + 1u >= chz * 3u / 100u && came <= chz * 3u / 100u + 1u, "%u complete scans in 3 s",
           came);
    expect(bed.events[TMINI_EVENT_SCAN] - scans == came, "incomplete scans");
    expect(sim_frequency_chz(&bed.sim) == chz, "at %u * 0.01 Hz", sim_frequency_chz(&bed.sim));
}

/* The fault that has just begun is reported, not "repaired"; and its end. */
static void expect_report(uint32_t faults)
{
    mark();
    bed_run_ms(&bed, 25000);
    expect(tmini_faults(&bed.lidar) == faults, "the faults are %02X", tmini_faults(&bed.lidar));
    expect(bed.events[TMINI_EVENT_FAULTS_CHANGED] == 1, "it is reported again");
    sim_block_rotor(&bed.sim, false);
    sim_cover_window(&bed.sim, false);
    sim_set_health(&bed.sim, 0);
    bed_run_ms(&bed, WATCH_FAULT_MS);
    expect(tmini_faults(&bed.lidar) == 0 && bed.events[TMINI_EVENT_FAULTS_CHANGED] == 2,
           "its end is not reported");
    expect(bed.events[TMINI_EVENT_LOST] == 0 && bed.heard.commands == 0, "it was \"repaired\"");
}

static bool act(const char *word, uint32_t number)
{
    if (strcmp(word, "begin") == 0) {
        begin();
    } else if (strcmp(word, "boots-together") == 0) {
        begin_together(number);
    } else if (strcmp(word, "holds") == 0) {
        memset(&held, 0, sizeof held);
        bed.held = &held;
    } else if (strcmp(word, "restart") == 0) {
        expect(bed_restart(&bed), "the library refuses the configuration");
    } else if (strcmp(word, "ask-all") == 0) {
        ask_all();
    } else if (strcmp(word, "slide") == 0) {
        slide(number, 37, 100);
    } else if (strcmp(word, "slide-fast") == 0) {
        slide(number, 110, 50);
    } else if (strcmp(word, "run") == 0) {
        bed_run_ms(&bed, number);
    } else if (strcmp(word, "pause") == 0) {
        bed_pause_ms(&bed, number);
    } else if (strcmp(word, "silences") == 0) {
        be_silent(number);
    } else if (strcmp(word, "mark") == 0) {
        mark();
    } else if (strcmp(word, "within") == 0) {
        scans_within(number);
    } else if (strcmp(word, "scans") == 0) {
        expect_scans(number);
    } else if (strcmp(word, "is-reported") == 0) {
        expect_report(number);
    } else {
        return call(word, number) || befall(word, number);
    }
    return true;
}

/* The last eight digits of the serial number that the lidar has answered. */
static uint32_t serial_number(void)
{
    uint32_t value = 0;
    for (unsigned i = 8; i < TMINI_SERIAL_DIGITS; i++) {
        value = 10 * value + tmini_info(&bed.lidar)->serial[i];
    }
    return value;
}

static bool judge(const char *word)
{
    tmini_counters_t counters;
    tmini_counters(&bed.lidar, &counters);
    const row_number_t facts[] = {
        {"faults", tmini_faults(&bed.lidar)},
        {"has-health", tmini_health(&bed.lidar)->faults},
        {"model", tmini_info(&bed.lidar)->model},
        {"number", serial_number()},
        {"withheld", counters.points_withheld},
        {"overrun", counters.bytes_overrun},
        {"lidar-idle", sim_mode(&bed.sim) == SIM_IDLE},
        {"lidar-at", sim_frequency_chz(&bed.sim)},
        {"sent", bed.sent},
        {"reboots", bed.heard.reboots},
        {"stops", bed.heard.stops},
        {"undelivered", bed.sim.counts.packets - bed.events[TMINI_EVENT_PACKET]},
        {"any-event", events() - marked.events},
        {"came", bed.events[TMINI_EVENT_SCAN] - marked.scans},
        {"complete", bed.complete - marked.complete},
        {"small", bed.small - marked.small},
    };
    return row_expects(word, facts);
}

static void tell(char *word)
{
    const uint32_t number = row_number(word);
    if (store(word) || judge(word)) {
        return;
    }
    word[strcspn(word, ":")] = '\0';
    if (act(word, number)) {
        return;
    }
    if (strncmp(word, "in-", 3) == 0) {
        TEST_ASSERT_EQUAL_STRING(word + 3, tmini_state_name(tmini_state(&bed.lidar)));
        return;
    }
    for (char *dash = word; (dash = strchr(dash, '-')) != NULL;) {
        *dash = ' ';
    }
    const unsigned event = bed_event_named(word);
    expect(event < BED_EVENTS - 1u, "\"%s\" is no step", word);
    expect(bed.events[event] == number, "%s came %u times", word, bed.events[event]);
}

static void play(const row_t *row)
{
    prepare(0);
    memset(&marked, 0, sizeof marked);
    if (strstr(row->steps, "begin ") == NULL && strstr(row->steps, "together") == NULL) {
        begin();
    }
    row_tell(row->steps, tell);
    expect_good_behaviour(bed_ms(&bed));
}

static const row_t rows[] IN_FLASH = {
    ROW(a_cold_start_brings_the_first_scan_within_two_seconds_and_then_six_a_second,
        "start run:2000 came>0 run:2000 scans:600"),
    ROW(a_cold_start_of_a_unit_without_ct_information_is_the_same,
        "ct:0 begin start run:4000 scans:600 came>11 faults-changed:0"),
    ROW(no_packet_of_the_spin_up_is_lost_and_no_loss_is_reported,
        "spin-up:5000 spin-percent:5 points:0 begin start run:10000 lost:0 undelivered:0"),
    ROW(first_packets_that_pass_the_usual_angle_without_a_start_make_true_scans,
        "beginning:1 first-angle:21101 begin start run:4000 came>11 scans:600"),
    ROW(first_packets_that_begin_at_any_angle_make_true_scans,
        "beginning:2 first-angle:5485 begin start run:4000 came>11 scans:600"),
    ROW(first_packets_without_ct_information_make_true_scans,
        "ct:0 beginning:2 first-angle:5485 begin start run:4000 came>11 scans:600"),
    ROW(a_restarted_program_finds_the_lidar_streaming_and_starts_it_again,
        "start run:4000 restart start run:4000 scans:600"),
    ROW(a_restarted_program_that_never_commands_gets_nothing_from_a_streaming_lidar,
        "start run:4000 restart mark run:5000 any-event:0 in-unknown"),
    ROW(information_is_asked_of_a_lidar_that_is_still_streaming,
        "start run:4000 restart ask run:1000 information:1 model:151 number:12345 lidar-idle:1"),
    ROW(health_is_asked_of_a_lidar_that_is_still_streaming,
        "start run:4000 restart sick:16 ask-health run:1000 health:1 has-health:16"),
    ROW(a_frequency_is_set_on_a_lidar_that_is_still_streaming,
        "start run:4000 restart set:940 run:3000 frequency:1 lidar-at:940 start run:4000 "
        "scans:940"),
    ROW(a_lidar_that_is_still_streaming_is_rebooted,
        "start run:4000 restart reboot run:6000 rebooted:1 lidar-idle:1 start run:4000 scans:600"),
    /* The program pauses, so that the ring is full. When bytes are refused, the line must not
     * count as quiet. */
    ROW(a_lidar_whose_bytes_have_filled_the_ring_is_stopped_before_it_is_started,
        "ring:4096 tail:300 may-lose:1 begin start run:4000 restart pause:799 mark start polls:60 "
        "run:300 any-event:0 run:3000 started:2 lost:0"),
    ROW(a_lidar_whose_bytes_have_filled_the_ring_is_reported_stopped_only_when_it_is,
        "ring:4096 tail:300 may-lose:1 begin start run:4000 restart pause:799 mark stop polls:60 "
        "run:300 any-event:0 run:600 any-event:1 stopped:1 lidar-idle:1"),
    ROW(a_late_reply_to_one_query_is_not_taken_as_the_reply_to_another,
        "late:2500 ask-frequency run:2000 stop run:1000 command-failed:1 stopped:1 ask "
        "run:3000 model:151"),
    ROW(set_10_hz_and_start_scans_at_10_hz, "set:1000 start run:5000 scans:1000 command-failed:0"),
    ROW(start_and_set_10_hz_scans_at_10_hz, "start set:1000 run:5000 scans:1000"),
    ROW(a_configured_frequency_is_set_by_the_start,
        "wants:1000 begin start run:5000 scans:1000 faults:0"),
    ROW(a_frequency_set_while_scanning_stops_sets_and_starts_again,
        "start run:4000 set:1200 set:1200 run:5000 scans:1200 frequency:1 started:2"),
    ROW(a_frequency_wanted_during_a_query_is_set_by_the_next_start,
        "ask set:800 start run:6000 scans:800 information:1"),
    ROW(a_start_follows_a_query_however_it_ends, "lost ask start run:9000 scans:600"),
    ROW(a_supply_that_fails_for_300_ms_leaves_10_hz_and_complete_scans,
        "wants:1000 points:450 begin start run:5000 power:0 run:300 power:1 run:20000 scans:1000 "
        "lost:1 recovered:1"),
    ROW(a_lidar_that_is_powered_a_minute_later_scans,
        "wants:1000 begin power:0 start run:60000 in-starting power:1 run:20000 scans:1000"),
    ROW(a_frequency_that_cannot_be_set_is_tried_again_and_the_lidar_scans,
        "wants:1000 most:800 begin start run:70000 faults:64 started:2 command-failed:2 "
        "in-scanning"),
    ROW(a_lidar_that_loses_its_frequency_unnoticed_gets_it_again,
        "wants:1000 begin start run:5000 forgets:600 run:15000 faults-changed:2 lost:0 scans:1000"),
    ROW(a_frequency_that_is_four_percent_off_is_no_fault,
        "wants:1000 motor:96 begin start run:20000 faults:0"),
    ROW(a_frequency_that_is_seven_percent_off_is_a_fault,
        "wants:1000 motor:93 begin start run:20000 faults:64"),
    ROW(a_stop_that_is_lost_six_times_still_stops_the_lidar,
        "start run:4000 deaf:3600 stop run:5600 in-idle lidar-idle:1 stopped:1"),
    ROW(a_stop_ends_a_start_that_waits_for_power,
        "power:0 start run:10000 stop run:1000 power:1 run:30000 lidar-idle:1 started:0"),
    ROW(without_recovery_a_start_fails_once_and_can_be_asked_for_again,
        "recovery-off:1 begin power:0 start run:60000 command-failed:1 in-unknown power:1 "
        "run:5000 start run:5000 scans:600"),
    ROW(without_recovery_a_loss_is_only_reported,
        "recovery-off:1 begin start run:4000 power:0 run:2000 power:1 run:30000 lost:1 "
        "in-recovering lidar-idle:1 stop run:1000 stopped:1 start run:5000 scans:600"),
    ROW(a_lost_answer_is_asked_for_again, "lost ask run:3000 information:1 command-failed:0"),
    ROW(a_lidar_that_streams_already_is_stopped,
        "others-start run:3000 stop run:1000 stopped:1 lidar-idle:1 in-idle"),
    /* It fails after 3, 3.5, 4.5, 6.5, 8.5 s. */
    ROW(a_listener_waits_and_takes_what_comes,
        "listen:1 begin start run:10000 in-starting command-failed:5 others-start run:5000 "
        "scans:600 power:0 run:3000 power:1 in-recovering run:10000 others-start run:5000 "
        "scans:600 sent:0"),
    ROW(a_listener_stops_at_once_and_has_sent_nothing,
        "listen:1 begin others-start start run:5000 scans:600 stop run:5000 in-unknown stopped:1 "
        "command-failed:0 unwanted-scanning:0 sent:0"),
    ROW(a_lidar_that_never_answers_scans_within_9_s,
        "wants:1000 never-answers:1 boots-together:300 start run:9000 complete>2 run:2000 "
        "command-failed:1"),
    ROW(a_lidar_that_answers_and_does_not_scan_is_rebooted,
        "wants:1000 begin no-scans start within:30000 reboots:1"),
    ROW(a_lidar_that_does_not_scan_after_a_loss_is_rebooted,
        "wants:1000 begin start within:5000 power:0 run:300 power:1 run:2500 no-scans "
        "within:30000 reboots:1"),
    ROW(a_lidar_whose_start_packets_stop_is_rebooted_and_lost_once,
        "wants:1000 begin start within:5000 no-starts run:15000 lost:1 recovered:0 run:16000 "
        "reboots:1 within:12000 lost:1 recovered:1"),
    ROW(a_lidar_that_begins_without_start_packets_is_rebooted,
        "wants:1000 begin no-starts start within:42000 reboots:1"),
    /* Every second packet of 40 samples is damaged, and one start packet in 16. */
    ROW(a_lidar_that_sends_start_packets_on_a_bad_line_is_not_stopped,
        "wants:1000 begin start within:5000 mark flip:200 run:60000 stops:0 lost:0"),
    ROW(a_slider_leaves_scans_and_its_last_wish_is_reached,
        "wants:1000 begin start within:5000 mark slide:88 complete>29 within:15000"),
    ROW(a_slider_that_rests_once_and_moves_on_leaves_scans_too,
        "wants:1000 begin start within:5000 slide-fast:20 run:740 mark slide-fast:160 "
        "complete>29 within:15000"),
    ROW(a_frequency_is_rounded_up_to_the_nearest_step, "set:847 start run:5000 scans:850"),
    ROW(a_frequency_is_rounded_down_to_the_nearest_step, "set:844 start run:5000 scans:840"),
    ROW(questions_are_answered_one_after_the_other,
        "wants:1000 begin ask-all start within:5000 information:1 health:1 frequency:1 "
        "command-failed:0 model:151"),
    ROW(a_port_that_takes_one_byte_per_write_starts,
        "wants:1000 ring:4096 writes:1 begin start run:10000 complete>9 lidar-at:1000"),
    ROW(a_port_that_takes_one_byte_per_write_starts_polled_each_99_ms,
        "wants:1000 ring:4096 writes:1 polls:99 begin start run:10000 complete>9 lidar-at:1000"),
    ROW(a_port_that_takes_one_byte_per_write_starts_polled_each_150_ms,
        "wants:1000 ring:4096 writes:1 polls:150 begin start run:10000 complete>9 lidar-at:1000"),
    ROW(a_program_with_a_small_ring_catches_up_after_a_pause,
        "wants:1000 holds reports:4095 max-pause:250 may-lose:1 begin start within:5000 works:50 "
        "run:3000 mark pause:700 run:30000 complete>139 small<6"),
    ROW(a_program_with_a_large_ring_catches_up_after_a_pause,
        "wants:1000 holds reports:4095 ring:4096 may-lose:1 begin start within:5000 works:20 "
        "run:3000 mark pause:1500 run:30000 complete>139 small<6"),
    ROW(a_program_with_the_smallest_ring_catches_up_after_a_pause_at_12_hz,
        "wants:1200 holds reports:4095 ring:256 max-pause:250 may-lose:1 begin start within:5000 "
        "works:70 run:3000 mark pause:2000 run:30000 complete>139 small<6"),
    ROW(a_program_with_the_smallest_ring_catches_up_after_a_pause_at_10_hz,
        "wants:1000 holds reports:4095 ring:256 max-pause:250 may-lose:1 begin start within:5000 "
        "works:80 run:3000 mark pause:3000 run:30000 complete>139 small<6"),
    ROW(a_program_that_never_catches_up_gets_complete_scans_too,
        "wants:1000 holds reports:4095 max-pause:250 may-lose:1 begin start within:5000 works:300 "
        "run:3000 mark run:30000 complete>29"),
    /* Each silence puts all bytes of a poll in doubt, so that each packet is a scan of its own.
     * The ring lasts 312 ms. */
    ROW(a_program_that_polls_rarely_gets_every_point,
        "ring:4096 begin start within:5000 polls:200 mark silences:10 small>49 withheld:0"),
    ROW(a_blocked_rotor_is_reported, "start run:4000 blocked:1 is-reported:2"),
    ROW(a_blocked_rotor_without_start_packets_is_reported,
        "starts-when-blocked:0 begin start run:4000 blocked:1 is-reported:2"),
    ROW(a_blocked_rotor_of_a_unit_without_ct_information_is_reported,
        "ct:0 starts-when-blocked:0 begin start run:4000 blocked:1 is-reported:2"),
    ROW(a_blocked_rotor_with_start_packets_but_no_ct_information_shows_as_no_data,
        "ct:0 begin start run:4000 blocked:1 is-reported:32"),
    ROW(a_covered_window_is_reported, "start run:4000 covered:1 is-reported:32"),
    ROW(a_covered_window_of_a_unit_without_ct_information_is_reported,
        "ct:0 begin start run:4000 covered:1 is-reported:32"),
    ROW(a_fault_that_a_unit_reports_is_reported_sensor, "start run:4000 sick:1 is-reported:1"),
    ROW(a_fault_that_a_unit_reports_is_reported_encoder, "start run:4000 sick:2 is-reported:2"),
    ROW(a_fault_that_a_unit_reports_is_reported_wireless_power,
        "start run:4000 sick:4 is-reported:4"),
    ROW(a_fault_that_a_unit_reports_is_reported_pd, "start run:4000 sick:8 is-reported:8"),
    ROW(a_fault_that_a_unit_reports_is_reported_ld, "start run:4000 sick:16 is-reported:16"),
    ROW(a_fault_that_a_unit_reports_is_reported_data, "start run:4000 sick:32 is-reported:32"),
    ROW(a_lidar_that_shuts_itself_off_is_lost_and_recovered_when_it_is_well_again,
        "fatal:1 begin start run:4000 sick:1 run:2000 lost:1 in-recovering sick:0 run:15000 "
        "recovered:1 in-scanning"),
    ROW(a_small_dma_ring_is_enough_for_a_prompt_main_loop,
        "dma:1 busy-one-in:10 busy:8 begin start run:64000 in-scanning"),
    ROW(a_ring_of_1024_bytes_is_enough_for_a_main_loop_that_is_busy_for_60_ms,
        "busy-one-in:10 busy:60 begin start run:64000 in-scanning"),
    ROW(a_main_loop_that_is_busy_for_too_long_costs_packets_but_accounts_for_them,
        "busy-one-in:10 busy:400 may-lose:1 begin start run:64000 overrun>0 came>0 lost:0"),
    ROW(a_main_loop_that_is_busy_for_too_long_with_dma_accounts_for_them,
        "dma:1 busy-one-in:10 busy:400 may-lose:1 begin start run:64000 overrun>0 came>0 lost:0"),
    /* After the pause a small ring may hold no whole packet. */
    ROW(a_program_that_pauses_for_seconds_does_not_lose_a_lidar_that_streams,
        "dma:1 ring:512 busy-one-in:1000 busy:3000 may-lose:1 begin start run:604000 came>0 "
        "lost:0"),
};

void test_programs(void)
{
    run_rows(rows, play);
}

/* ---- Replies that come late ---- */

void test_every_frequency_can_be_set_from_where_the_last_one_left_it(void)
{
    prepare(0);
    begin();
    for (unsigned i = 0; i < 61; i++) {
        const uint32_t chz = 600 + 10 * (i * 37 % 61);
        (void)call("set", chz);
        expect((bed_run_until(&bed, BIT(TMINI_EVENT_FREQUENCY), 3000) &
                BIT(TMINI_EVENT_FREQUENCY)) != 0,
               "%u is not set", chz);
        expect(sim_frequency_chz(&bed.sim) == chz, "%u is not what is set", chz);
    }
    expect(bed.events[TMINI_EVENT_COMMAND_FAILED] == 0, "it failed");
}

void test_a_late_reply_to_any_frequency_step_does_no_harm(void)
{
    static const uint32_t delays_ms[] = {40, 100, 1900, 2050, 2500};
    for (unsigned i = 0; i < 5 * 6; i++) {
        prepare(0);
        begin();
        (void)call("set", 820);
        while (bed.sim.counts.replies < i % 6) {
            bed_step(&bed);
        }
        sim_befall(&bed.sim, SIM_LATE, delays_ms[i / 6], bed.now_us);
        (void)bed_run_until(&bed, BIT(TMINI_EVENT_FREQUENCY), 8000);
        row_tell("frequency:1 lidar-at:820 command-failed:0", tell);
        expect_good_behaviour(i);
    }
}

/* Another program has just sent A5 98, which real units answer. */
void test_a_late_reply_to_a_command_of_another_program_disturbs_no_answer(void)
{
    static const uint8_t command[2] = {0xA5, SIM_COMMAND_UNDOCUMENTED_98};
    for (uint32_t late_ms = 0; late_ms < 200; late_ms += 9) {
        prepare(0);
        begin();
        sim_befall(&bed.sim, SIM_LATE, 50 + late_ms, bed.now_us);
        sim_receive(&bed.sim, command, 2, bed.now_us);
        row_tell("ask-frequency run:5000 frequency:1 ask run:5000 information:1 model:151", tell);
        expect(tmini_frequency_chz(&bed.lidar) == 600, "another frequency");
        sim_befall(&bed.sim, SIM_LATE, late_ms, bed.now_us);
        sim_receive(&bed.sim, command, 2, bed.now_us);
        row_tell("start run:5000 in-scanning command-failed:0", tell);
        expect_good_behaviour(late_ms);
    }
}

/* ---- Silences and pauses of any length: no scan has points of two turns ---- */

/* Meanwhile the lidar goes on turning: what follows may seem to continue what came before. */
void test_a_silence_of_any_length_mixes_no_turns(void)
{
    for (uint32_t ct = 0; ct <= 1; ct++) {
        prepare(0);
        lidar.ct_information = ct != 0;
        row_tell("begin start within:5000", tell);
        for (uint32_t ms = 20; ms < 860; ms++) {
            sim_befall(&bed.sim, SIM_SILENT, ms, bed.now_us);
            bed_run_ms(&bed, ms + 250);
        }
        row_tell("within:2000", tell);
        expect_good_behaviour(ct);
    }
}

/* The ring overflows during most of them, also again after a short look at it. */
void test_pauses_of_the_program_of_any_length_mix_no_turns(void)
{
    for (uint32_t kind = 0; kind < 9; kind++) {
        prepare(0);
        bed.config.rx_size = (size_t)256 << (kind + 1) / 2;
        bed.config.rx_dma = kind % 2 != 0;
        row_tell("may-lose:1 begin start within:5000", tell);
        for (uint32_t ms = 5; ms < 700; ms += 7) {
            bed_pause_ms(&bed, ms);
            bed_run_ms(&bed, ms % 3);
            bed_pause_ms(&bed, ms * 5 % 300);
            bed_run_ms(&bed, 400);
        }
        row_tell("within:5000", tell);
        expect_good_behaviour(kind);
    }
}

/* ---- Faults of the line, at several rates ---- */

/* A minute of such faults, then none: scans must resume. */
static void survive(sim_link_kind_t kind, uint32_t mean_gap, unsigned mode)
{
    prepare(0);
    lidar = sim_default_config();
    lidar.marked = true;
    lidar.seed = 1 + mode;
    watch.line.seed = 1 + mode;
    lidar.ct_information = mode % 2 == 1;
    bed.config.max_points = (mode & 1u) != 0 ? 0 : bed.config.max_points;
    bed.config.rx_dma = (mode & 2u) != 0;
    bed.config.rx_size = bed.config.rx_dma ? 4096 : 2048;
    row_tell("busy-one-in:100 busy:60 begin start run:4000", tell);
    sim_link_set_mean_gap(&watch.link, kind, mean_gap, bed.now_us);
    bed_run_ms(&bed, 60000);
    expect(watch.link.counts.faults[kind] > 0, "no faults");
    sim_link_calm(&watch.link, bed.now_us);
    row_tell("run:20000 in-scanning faults-changed:0", tell);
    expect_good_behaviour(mean_gap * 10 + mode);
}

/* "drop:200": a kind of fault, and its mean gap. */
static void survive_in_every_mode(char *word)
{
    const uint32_t mean_gap = row_number(word);
    word[strcspn(word, ":")] = '\0';
    for (unsigned mode = 0; mode < 4; mode++) {
        survive(sim_link_kind_named(word), mean_gap, mode);
    }
}

static const row_t lines[] IN_FLASH = {
    ROW(lost_bytes_cost_no_other_packet, "drop:200 drop:2000 drop:50000"),
    ROW(flipped_bits_cost_no_other_packet, "flip:200 flip:2000 flip:50000"),
    ROW(extra_bytes_cost_no_other_packet, "insert:200 insert:2000 insert:50000"),
    ROW(bursts_cost_no_other_packet, "burst:20 burst:200 burst:5000"),
    ROW(stalls_cost_at_most_the_packet_that_they_cut, "stall:200 stall:1000 stall:10000"),
    ROW(packets_cut_short_cost_no_other_packet, "cut:20 cut:200 cut:5000"),
    ROW(loss_of_power_is_recovered_from, "unplug:5000 unplug:15000"),
    ROW(wrong_baud_rates_for_a_while_are_recovered_from, "garble:2000 garble:10000"),
};

void test_faults_of_the_line(void)
{
    tell_rows(lines, survive_in_every_mode);
}
