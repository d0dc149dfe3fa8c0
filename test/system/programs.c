/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs as a user writes them, with lidars as they are (sections 9.10 to 9.17, 9.20): what they
 * wish, what happens, and what comes of it. Each row is a claim (claims.h).
 *
 * A row is a script, or a function where power may come or fail at every moment. A script is a list
 * of steps: a word (store(), act(), judge()) and a number, or one of these claims: "in scanning":
 * the driver's state; "lost 1": how often an event has come. Steps before "begin" are
 * configuration; a script without it begins at once. */

#include "bed.h"
#include "claims.h"
#include "members.h"

#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bed_t bed;
static bed_held_t held;
static sim_config_t lidar;

static void expect_good_behaviour(uint32_t moment)
{
    const char *const misdeed = bed_misdeed(&bed);

    expect(misdeed == NULL, "at %u: %s", moment, misdeed);
}

/* ---- What the lidar has heard ---- */

static struct {
    uint32_t starts, stops, reboots;
    uint64_t start_us;  /* The first one. */
    uint16_t start_chz; /* What was set then. */
    uint32_t stops_while_scanning;
} heard;

static void hear(void *context, uint8_t code, uint64_t now_us)
{
    (void)context;
    switch (code) {
    case SIM_COMMAND_START:
        if (heard.starts++ == 0) {
            heard.start_us = now_us;
            heard.start_chz = sim_frequency_chz(&bed.sim);
        }
        break;
    case SIM_COMMAND_STOP:
        heard.stops++;
        heard.stops_while_scanning += sim_mode(&bed.sim) == SIM_SCANNING ? 1u : 0u;
        break;
    case SIM_COMMAND_REBOOT:
        heard.reboots++;
        break;
    default:
        break;
    }
}

static void forget_heard(void)
{
    memset(&heard, 0, sizeof heard);
}

static void prepare(uint16_t frequency_chz)
{
    lidar = bed_quiet_lidar();
    lidar.seed = 3;
    lidar.marked = true;
    bed_prepare(&bed);
    bed.config.frequency_chz = frequency_chz;
    forget_heard();
}

static void begin(void)
{
    const sim_observer_t observer = {.on_command = hear};

    expect(bed_init(&bed, &lidar), "the library refuses the configuration");
    sim_observe(&bed.sim, &observer);
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
    for (uint32_t deaf_ms = 0; deaf_ms <= 6000 && is_right(); deaf_ms += step_ms) {
        prepare(frequency_chz);
        begin_together(deaf_ms);
        start();
        (void)run_until_scans(12000);
        expect(bed_scans_at(&bed, frequency_chz, 3), "deaf for %u: no scans", deaf_ms);
        expect(heard.start_us <= deaf_ms * 1000u + 600000u, "deaf for %u: started at %u", deaf_ms,
               (uint32_t)(heard.start_us / 1000u));
        expect(heard.starts == 1, "deaf for %u: %u starts", deaf_ms, heard.starts);
        expect(frequency_chz == 0 || heard.start_chz == frequency_chz,
               "deaf for %u: started at %u * 0.01 Hz", deaf_ms, heard.start_chz);
        bed_run_ms(&bed, 2000);
        expect(heard.stops_while_scanning == 0, "deaf for %u: stopped while scanning", deaf_ms);
        expect_good_behaviour(deaf_ms);
    }
}

static void power_up_at_10_hz(const char *unused)
{
    (void)unused;
    power_up_together(1000, 20);
}

static void power_up_without_a_frequency(const char *unused)
{
    (void)unused;
    power_up_together(0, 20);
}

/* ---- Supply ---- */

/* `moment_ms` after the start, `off_ms` long. */
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
    forget_heard();
    fail_supply(off_ms);
    bed_run_ms(&bed, boot_ms);
    const uint32_t listens_ms = bed_ms(&bed);
    const uint32_t complete = bed.complete;
    while (bed.complete == complete && bed_ms(&bed) < listens_ms + 15000) {
        bed_step(&bed);
    }
    expect(bed_ms(&bed) <= listens_ms + 4000, "off for %u, boots for %u: scans after %u", off_ms,
           boot_ms, bed_ms(&bed) - listens_ms);
    expect(heard.starts == 1 && heard.start_chz == 1000,
           "off for %u, boots for %u: %u starts, at %u * 0.01 Hz", off_ms, boot_ms, heard.starts,
           heard.start_chz);
    bed_run_ms(&bed, 3000);
    expect(bed_scans_at(&bed, 1000, 3), "off for %u: not at 10 Hz", off_ms);
    expect(bed.events[TMINI_EVENT_LOST] <= 1 &&
               bed.events[TMINI_EVENT_LOST] == bed.events[TMINI_EVENT_RECOVERED],
           "off for %u: lost %u times", off_ms, bed.events[TMINI_EVENT_LOST]);
    expect_good_behaviour(off_ms);
}

static void supply_fails_for_any_time(const char *unused)
{
    (void)unused;
    static const uint16_t boots_ms[] = {100, 700, 2500};

    for (unsigned i = 0; i < 3 && is_right(); i++) {
        for (uint32_t ms = 20; ms <= 60000 && is_right(); ms += ms < 2000 ? 60 : ms / 16) {
            supply_fails_for(ms, boots_ms[i]);
        }
    }
}

static void odd_frequency_and_supply(uint16_t chz)
{
    for (uint32_t moment_ms = 0; moment_ms < 6000 && is_right(); moment_ms += 20) {
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

static void odd_frequencies_and_supply(const char *unused)
{
    (void)unused;
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
static void any_quiet_line(const char *unused)
{
    (void)unused;
    for (uint16_t quiet_ms = 50; quiet_ms < 1000 && is_right(); quiet_ms += 5) {
        prepare(1000);
        lidar.stop_tail_ms = 300;
        bed.timing.quiet_line_ms = quiet_ms;
        const sim_observer_t observer = {.on_command = hear};
        if (!bed_init(&bed, &lidar)) {
            continue; /* Refused. */
        }
        sim_observe(&bed.sim, &observer);
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

static void sleep_as_long_as_allowed(const char *unused)
{
    static bed_t awake;

    (void)unused;
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
    uint32_t complete, small;
} marked;

static bool store(const char *word, uint32_t number)
{
    const struct {
        const char *word;
        void *member;
        size_t size;
    } members[] = {
        {"wants", MEMBER(bed.config.frequency_chz)},
        {"points", MEMBER(bed.config.max_points)},
        {"ring", MEMBER(bed.config.rx_size)},
        {"recovery off", MEMBER(bed.config.recovery)},
        {"listen", MEMBER(bed.config.listen_only)},
        {"max pause", MEMBER(bed.timing.max_pause_ms)},
        {"reports", MEMBER(held.reported_max)}, /* Of the bytes that a layer below holds. */
        {"writes", MEMBER(bed.write_max)},
        {"polls", MEMBER(bed.poll_ms)},
        {"works", MEMBER(bed.work_ms)},
        {"damage", MEMBER(bed.flip_one_in)},
        {"most", MEMBER(lidar.max_frequency_chz)},
        {"motor", MEMBER(lidar.motor_percent)},
        {"never answers", MEMBER(lidar.never_answers)},
        {"marked", MEMBER(lidar.marked)},
        {"forgets", MEMBER(bed.sim.frequency_chz)},
    };
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++) {
        if (strcmp(members[i].word, word) == 0) {
            member_store(members[i].member, members[i].size, number);
            return true;
        }
    }
    return false;
}

static void ask_all(void)
{
    expect(bed_request_info(&bed) == TMINI_OK, "information is refused");
    expect(tmini_request_health(&bed.lidar) == TMINI_OK, "health is refused");
    expect(tmini_request_frequency(&bed.lidar) == TMINI_OK, "frequency is refused");
}

static void set(uint32_t chz)
{
    expect(bed_set_frequency(&bed, (uint16_t)chz) == TMINI_OK, "%u is refused", chz);
}

/* Wishes from 6 to 12 Hz, a tenth of a second apart. */
static void slide(uint32_t wishes)
{
    for (uint32_t i = 0; i < wishes; i++) {
        const uint32_t place = i * 37u % 1200u;

        set(600u + (place < 600u ? place : 1200u - place));
        bed_run_ms(&bed, 100);
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

static void mark(void)
{
    marked.complete = bed.complete;
    marked.small = bed.small;
    forget_heard();
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

static bool act(const char *word, uint32_t number)
{
    if (strcmp(word, "begin") == 0) {
        begin();
    } else if (strcmp(word, "boots together") == 0) {
        begin_together(number);
    } else if (strcmp(word, "holds") == 0) {
        memset(&held, 0, sizeof held);
        bed.held = &held;
    } else if (strcmp(word, "start") == 0) {
        start();
    } else if (strcmp(word, "stop") == 0) {
        expect(bed_stop(&bed) == TMINI_OK, "stop is refused");
    } else if (strcmp(word, "set") == 0) {
        set(number);
    } else if (strcmp(word, "ask") == 0) {
        expect(bed_request_info(&bed) == TMINI_OK, "a question is refused");
    } else if (strcmp(word, "ask all") == 0) {
        ask_all();
    } else if (strcmp(word, "slide") == 0) {
        slide(number);
    } else if (strcmp(word, "run") == 0) {
        bed_run_ms(&bed, number);
    } else if (strcmp(word, "pause") == 0) {
        bed_pause_ms(&bed, number);
    } else if (strcmp(word, "power") == 0) {
        sim_power(&bed.sim, number != 0, bed.now_us);
    } else if (strcmp(word, "deaf") == 0) {
        sim_befall(&bed.sim, SIM_DEAF, number, bed.now_us);
    } else if (strcmp(word, "no scans") == 0) {
        sim_befall(&bed.sim, SIM_NO_SCANS, 0, bed.now_us);
    } else if (strcmp(word, "no starts") == 0) {
        sim_befall(&bed.sim, SIM_NO_STARTS, 0, bed.now_us);
    } else if (strcmp(word, "silences") == 0) {
        be_silent(number);
    } else if (strcmp(word, "lose reply") == 0) {
        sim_lose_next_reply(&bed.sim);
    } else if (strcmp(word, "others start") == 0) {
        let_others_start();
    } else if (strcmp(word, "mark") == 0) {
        mark();
    } else if (strcmp(word, "within") == 0) {
        scans_within(number);
    } else if (strcmp(word, "scans") == 0) {
        expect_scans(number);
    } else {
        return false;
    }
    return true;
}

static bool judge(const char *word, uint32_t number)
{
    tmini_counters_t counters;

    tmini_counters(&bed.lidar, &counters);
    const struct {
        const char *word;
        uint32_t number;
        uint32_t most; /* 0: exactly the step's number; otherwise from that to this. */
    } facts[] = {
        {"faults", tmini_faults(&bed.lidar), 0},
        {"model", tmini_info(&bed.lidar)->model, 0},
        {"withheld", counters.points_withheld, 0},
        {"lidar idle", sim_mode(&bed.sim) == SIM_IDLE ? 0 : 1, 0},
        {"lidar at", sim_frequency_chz(&bed.sim), 0},
        {"sent", bed.sent, 0},
        {"reboots", heard.reboots, 0},
        {"stops", heard.stops, 0},
        {"complete", bed.complete - marked.complete, UINT32_MAX},
        {"small", bed.small - marked.small, UINT32_MAX},
        {"five small at most", bed.small - marked.small, 5},
    };
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++) {
        if (strcmp(facts[i].word, word) == 0) {
            expect(facts[i].most > 0 ? facts[i].number >= number && facts[i].number <= facts[i].most
                                     : facts[i].number == number,
                   "%s is %u", word, facts[i].number);
            return true;
        }
    }
    return false;
}

static void play_step(const char *word, uint32_t number)
{
    const unsigned event = bed_event_named(word);

    if (store(word, number) || act(word, number) || judge(word, number)) {
        return;
    }
    if (strncmp(word, "in ", 3) == 0) {
        expect(strcmp(tmini_state_name(tmini_state(&bed.lidar)), word + 3) == 0, "not %s", word);
    } else {
        expect(event < BED_EVENTS - 1u, "\"%s\" is no step", word);
        expect(bed.events[event] == number, "%s came %u times", word, bed.events[event]);
    }
}

/* The next step of a script as a word without its number; returns what follows it. */
static const char *take_step(const char *script, char *word, size_t size, uint32_t *number)
{
    const char *const comma = strchr(script, ',');
    const size_t length = comma != NULL ? (size_t)(comma - script) : strlen(script);
    char *last;

    (void)snprintf(word, size, "%.*s", (int)length, script);
    last = strrchr(word, ' ');
    *number = 0;
    if (last != NULL && last[1] >= '0' && last[1] <= '9') {
        *number = (uint32_t)strtoul(last, NULL, 10);
        *last = '\0';
    }
    return comma != NULL ? comma + 2 : NULL;
}

static void play(const char *script)
{
    char word[40];
    uint32_t number;

    prepare(0);
    memset(&marked, 0, sizeof marked);
    if (strstr(script, "begin, ") == NULL && strstr(script, "together") == NULL) {
        begin();
    }
    while (script != NULL && is_right()) {
        script = take_step(script, word, sizeof word, &number);
        play_step(word, number);
    }
    expect_good_behaviour(bed_ms(&bed));
}

/* ---- Rows ---- */

static const claim_t claims[] = {
    {"set_10_hz_and_start_scans_at_10_hz", play,
     "set 1000, start, run 5000, scans 1000, command failed 0"},
    {"start_and_set_10_hz_scans_at_10_hz", play, "start, set 1000, run 5000, scans 1000"},
    {"a_configured_frequency_is_set_by_the_start", play,
     "wants 1000, begin, start, run 5000, scans 1000, faults 0"},
    {"a_frequency_set_while_scanning_stops_sets_and_starts_again", play,
     "start, run 4000, set 1200, set 1200, run 5000, scans 1200, frequency 1, started 2"},
    {"a_frequency_wanted_during_a_query_is_set_by_the_next_start", play,
     "ask, set 800, start, run 6000, scans 800, information 1"},
    {"a_start_follows_a_query_however_it_ends", play,
     "lose reply, ask, start, run 9000, scans 600"},
    {"a_supply_that_fails_for_300_ms_leaves_10_hz_and_complete_scans", play,
     "wants 1000, points 450, begin, start, run 5000, power 0, run 300, power 1, run 20000, "
     "scans 1000, lost 1, recovered 1"},
    {"a_lidar_that_is_powered_a_minute_later_scans", play,
     "wants 1000, begin, power 0, start, run 60000, in starting, power 1, run 20000, scans 1000"},
    {"a_frequency_that_cannot_be_set_is_tried_again_and_the_lidar_scans", play,
     "wants 1000, most 800, begin, start, run 70000, faults 64, started 2, command failed 2, "
     "in scanning"},
    {"a_lidar_that_loses_its_frequency_unnoticed_gets_it_again", play,
     "wants 1000, begin, start, run 5000, forgets 600, run 15000, faults changed 2, lost 0, "
     "scans 1000"},
    {"a_frequency_that_is_four_percent_off_is_no_fault", play,
     "wants 1000, motor 96, begin, start, run 20000, faults 0"},
    {"a_frequency_that_is_seven_percent_off_is_a_fault", play,
     "wants 1000, motor 93, begin, start, run 20000, faults 64"},
    {"a_stop_that_is_lost_six_times_still_stops_the_lidar", play,
     "start, run 4000, deaf 3600, stop, run 5600, in idle, lidar idle, stopped 1"},
    {"a_stop_ends_a_start_that_waits_for_power", play,
     "power 0, start, run 10000, stop, run 1000, power 1, run 30000, lidar idle, started 0"},
    {"without_recovery_a_start_fails_once_and_can_be_asked_for_again", play,
     "recovery off 1, begin, power 0, start, run 60000, command failed 1, in unknown, power 1, "
     "run 5000, start, run 5000, scans 600"},
    {"without_recovery_a_loss_is_only_reported", play,
     "recovery off 1, begin, start, run 4000, power 0, run 2000, power 1, run 30000, lost 1, "
     "in recovering, lidar idle, stop, run 1000, stopped 1, start, run 5000, scans 600"},
    {"a_lost_answer_is_asked_for_again", play,
     "lose reply, ask, run 3000, information 1, command failed 0"},
    {"a_lidar_that_streams_already_is_stopped", play,
     "others start, run 3000, stop, run 1000, stopped 1, lidar idle, in idle"},
    {"a_listener_waits_and_takes_what_comes", play, /* It fails after 3, 3.5, 4.5, 6.5, 8.5 s. */
     "listen 1, begin, start, run 10000, in starting, command failed 5, others start, run 5000, "
     "scans 600, power 0, run 3000, power 1, in recovering, run 10000, others start, run 5000, "
     "scans 600, sent 0"},
    {"a_listener_stops_at_once_and_has_sent_nothing", play,
     "listen 1, begin, others start, start, run 5000, scans 600, stop, run 5000, in unknown, "
     "stopped 1, command failed 0, unwanted scanning 0, sent 0"},
    {"a_lidar_that_listens_later_is_started_once_and_soon", power_up_at_10_hz, NULL},
    {"without_a_frequency_a_lidar_that_listens_later_is_started_once_and_soon",
     power_up_without_a_frequency, NULL},
    {"a_lidar_that_never_answers_scans_within_9_s", play,
     "wants 1000, never answers 1, boots together 300, start, run 9000, complete 3, run 2000, "
     "command failed 1"},
    {"after_any_supply_failure_scans_come_within_4_s_at_10_hz", supply_fails_for_any_time, NULL},
    {"a_wish_near_the_lidars_own_frequency_survives_a_supply_failure", odd_frequencies_and_supply,
     NULL},
    {"a_lidar_that_answers_and_does_not_scan_is_rebooted", play,
     "wants 1000, begin, no scans, start, within 30000, reboots 1"},
    {"a_lidar_that_does_not_scan_after_a_loss_is_rebooted", play,
     "wants 1000, begin, start, within 5000, power 0, run 300, power 1, run 2500, no scans, "
     "within 30000, reboots 1"},
    {"a_lidar_whose_start_packets_stop_is_rebooted_and_lost_once", play,
     "wants 1000, begin, start, within 5000, no starts, run 15000, lost 1, recovered 0, run 16000, "
     "reboots 1, within 12000, lost 1, recovered 1"},
    {"a_lidar_that_begins_without_start_packets_is_rebooted", play,
     "wants 1000, begin, no starts, start, within 42000, reboots 1"},
    /* Every second packet of 40 samples is damaged, and one start packet in 16. */
    {"a_lidar_that_sends_start_packets_on_a_bad_line_is_not_stopped", play,
     "wants 1000, marked 0, begin, start, within 5000, mark, damage 200, run 60000, stops 0, "
     "lost 0"},
    {"a_slider_leaves_scans_and_its_last_wish_is_reached", play,
     "wants 1000, begin, start, within 5000, mark, slide 88, complete 30, within 15000"},
    {"a_frequency_is_rounded_up_to_the_nearest_step", play, "set 847, start, run 5000, scans 850"},
    {"a_frequency_is_rounded_down_to_the_nearest_step", play,
     "set 844, start, run 5000, scans 840"},
    {"questions_are_answered_one_after_the_other", play,
     "wants 1000, begin, ask all, start, within 5000, information 1, health 1, frequency 1, "
     "command failed 0, model 151"},
    {"a_port_that_takes_one_byte_per_write_starts", play,
     "wants 1000, ring 4096, writes 1, begin, start, run 10000, complete 10, lidar at 1000"},
    {"a_port_that_takes_one_byte_per_write_starts_polled_each_99_ms", play,
     "wants 1000, ring 4096, writes 1, polls 99, begin, start, run 10000, complete 10, "
     "lidar at 1000"},
    {"a_port_that_takes_one_byte_per_write_starts_polled_each_150_ms", play,
     "wants 1000, ring 4096, writes 1, polls 150, begin, start, run 10000, complete 10, "
     "lidar at 1000"},
    {"a_quiet_line_time_works_or_is_refused", any_quiet_line, NULL},
    {"a_program_with_a_small_ring_catches_up_after_a_pause", play,
     "wants 1000, holds, reports 4095, max pause 250, begin, start, within 5000, works 50, run "
     "3000, mark, "
     "pause 700, run 30000, complete 140, five small at most 0"},
    {"a_program_with_a_large_ring_catches_up_after_a_pause", play,
     "wants 1000, holds, reports 4095, ring 4096, begin, start, within 5000, works 20, run 3000, "
     "mark, "
     "pause 1500, run 30000, complete 140, five small at most 0"},
    /* Each silence puts all bytes of a poll in doubt, so that each packet is a scan of its own. */
    {"a_program_that_polls_rarely_gets_every_point", play, /* The ring lasts 312 ms. */
     "start, within 5000, polls 200, mark, silences 10, small 50, withheld 0"},
    {"a_task_that_sleeps_as_long_as_it_may_gets_the_same_events", sleep_as_long_as_allowed, NULL},
};

int main(int argc, char **argv)
{
    return claims_main(argc, argv, claims, sizeof claims / sizeof claims[0]);
}
