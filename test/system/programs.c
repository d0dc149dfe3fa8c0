/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs as a user writes them, with lidars as they are (sections 9.10 to 9.17, 9.20), at every
 * moment at which power may come or fail. Each row is a claim (claims.h). */

#include "bed.h"
#include "claims.h"

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
    uint64_t no_starts_us; /* The latest moment at which it sent no start packets. */
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

static void command_lidar(uint8_t code)
{
    const uint8_t command[] = {0xA5, code};

    sim_receive(&bed.sim, command, sizeof command, bed.now_us);
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

static void never_answers(const char *unused)
{
    (void)unused;
    prepare(1000);
    lidar.never_answers = true;
    begin_together(300);
    start();
    while (bed.complete < 3 && bed_ms(&bed) < 9000) {
        bed_step(&bed);
    }
    expect(bed.complete >= 3, "no scans after 9 s");
    bed_run_ms(&bed, 2000);
    expect(bed.events[TMINI_EVENT_COMMAND_FAILED] > 0, "the frequency was not reported");
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

/* ---- A reboot helps ---- */

static void only_a_reboot_helps(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    sim_befall(&bed.sim, SIM_NO_SCANS, 0, 0);
    start();
    scans_within(30000);
    expect(heard.reboots == 1, "%u reboots", heard.reboots);
    expect_good_behaviour(0);
}

static void a_reboot_helps_after_a_loss(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    start();
    scans_within(5000);
    fail_supply(300);
    bed_run_ms(&bed, lidar.boot_ms);
    sim_befall(&bed.sim, SIM_NO_SCANS, 0, bed.now_us);
    scans_within(30000);
    expect(heard.reboots == 1, "%u reboots", heard.reboots);
    expect_good_behaviour(0);
}

static void start_packets_stop_coming(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    start();
    scans_within(5000);
    sim_befall(&bed.sim, SIM_NO_STARTS, 0, bed.now_us);
    const uint32_t before_ms = bed_ms(&bed);
    uint64_t last_us = 0;
    while (heard.reboots == 0 && bed_ms(&bed) < before_ms + 31000) {
        last_us = bed.now_us;
        bed_step(&bed);
    }
    expect(heard.reboots == 1, "no reboot within 30 s");
    scans_within(12000);
    expect(bed.events[TMINI_EVENT_LOST] == 1, "lost %u times", bed.events[TMINI_EVENT_LOST]);
    expect(bed.events[TMINI_EVENT_RECOVERED] == 1, "recovered %u times",
           bed.events[TMINI_EVENT_RECOVERED]);
    expect(bed.event_us[TMINI_EVENT_RECOVERED] > last_us, "recovered without a start packet");
    expect_good_behaviour(0);
}

static void start_packets_never_come(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    sim_befall(&bed.sim, SIM_NO_STARTS, 0, 0);
    start();
    scans_within(42000);
    expect(heard.reboots == 1, "%u reboots", heard.reboots);
    expect_good_behaviour(0);
}

/* Every second packet of 40 samples is damaged, and one start packet in 16. */
static void bad_line(const char *unused)
{
    (void)unused;
    prepare(1000);
    lidar.marked = false; /* Some damage is not seen. */
    begin();
    start();
    scans_within(5000);
    forget_heard();
    bed.flip_one_in = 200;
    bed_run_ms(&bed, 60000);
    expect(heard.stops == 0, "stopped %u times", heard.stops);
    expect(bed.events[TMINI_EVENT_LOST] == 0, "lost");
}

/* ---- Many wishes ---- */

static uint16_t from_slider(uint32_t i)
{
    const uint32_t place = i * 37u % 1200u;

    return (uint16_t)(600u + (place < 600u ? place : 1200u - place));
}

static void slider(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    start();
    scans_within(5000);
    const uint32_t complete = bed.complete;
    for (uint32_t i = 0; i < 88; i++) {
        expect(bed_set_frequency(&bed, from_slider(i)) == TMINI_OK, "%u * 0.01 Hz is refused",
               from_slider(i));
        bed_run_ms(&bed, 100);
    }
    expect(bed.complete - complete >= 30, "%u scans in 8.8 s", bed.complete - complete);
    scans_within(15000);
    expect_good_behaviour(0);
}

static void frequencies_are_rounded(const char *unused)
{
    (void)unused;
    static const struct {
        uint16_t wish, set;
    } rows[] = {{847, 850}, {844, 840}, {604, 600}, {1196, 1200}, {600, 600}};

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        prepare(0);
        begin();
        expect(bed_set_frequency(&bed, rows[i].wish) == TMINI_OK, "%u is refused", rows[i].wish);
        start();
        bed_run_ms(&bed, 5000);
        expect(bed_scans_at(&bed, rows[i].set, 3), "%u became %u", rows[i].wish,
               sim_frequency_chz(&bed.sim));
    }
    prepare(0);
    begin();
    expect(tmini_set_frequency(&bed.lidar, 599) == TMINI_ERROR_ARGUMENT, "599 is taken");
    expect(tmini_set_frequency(&bed.lidar, 1201) == TMINI_ERROR_ARGUMENT, "1201 is taken");
}

static void questions_wait(const char *unused)
{
    (void)unused;
    prepare(1000);
    begin();
    expect(tmini_request_info(&bed.lidar) == TMINI_OK, "info is refused");
    expect(tmini_request_health(&bed.lidar) == TMINI_OK, "health is refused");
    expect(tmini_request_frequency(&bed.lidar) == TMINI_OK, "frequency is refused");
    start();
    scans_within(5000);
    expect(bed.events[TMINI_EVENT_INFO] == 1, "%u answers", bed.events[TMINI_EVENT_INFO]);
    expect(bed.events[TMINI_EVENT_HEALTH] == 1, "%u states", bed.events[TMINI_EVENT_HEALTH]);
    expect(bed.events[TMINI_EVENT_FREQUENCY] >= 1, "no frequency");
    expect(bed.events[TMINI_EVENT_COMMAND_FAILED] == 0, "something failed");
    expect(tmini_info(&bed.lidar)->model == 151, "model %u", tmini_info(&bed.lidar)->model);
}

/* ---- Ports ---- */

static void one_byte_per_write(const char *unused)
{
    (void)unused;
    static const uint32_t polls_ms[] = {1, 50, 99, 100, 150};

    for (size_t i = 0; i < sizeof polls_ms / sizeof polls_ms[0]; i++) {
        prepare(1000);
        bed.config.rx_size = sizeof bed.rx;
        bed.write_max = 1;
        bed.poll_ms = polls_ms[i];
        begin();
        start();
        bed_run_ms(&bed, 10000);
        expect(bed.complete >= 10 && sim_frequency_chz(&bed.sim) == 1000,
               "polled each %u ms: %u complete scans, %u * 0.01 Hz", polls_ms[i], bed.complete,
               sim_frequency_chz(&bed.sim));
    }
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
        command_lidar(SIM_COMMAND_START);
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

/* ---- A slow program ---- */

static void one_pause(size_t rx_size, uint16_t max_pause_ms, uint32_t pause_ms, uint32_t work_ms)
{
    prepare(1000);
    memset(&held, 0, sizeof held);
    held.reported_max = 4095;
    bed.held = &held;
    bed.config.rx_size = rx_size;
    bed.timing.max_pause_ms = max_pause_ms;
    begin();
    start();
    scans_within(5000);
    bed.work_ms = work_ms;
    bed_run_ms(&bed, 3000);
    const uint32_t complete = bed.complete;
    const uint32_t small = bed.small;
    bed_pause_ms(&bed, pause_ms);
    bed_run_ms(&bed, 30000);
    expect(bed.complete - complete >= 140, "%u complete scans in 30 s", bed.complete - complete);
    expect(bed.small - small <= 5, "%u scans of one packet", bed.small - small);
    expect(bed.mixed == 0, "%u scans of two revolutions", bed.mixed);
}

static uint32_t points_withheld(void)
{
    tmini_counters_t counters;

    tmini_counters(&bed.lidar, &counters);
    return counters.points_withheld;
}

/* Each silence puts all bytes of a poll in doubt, so that each packet is a scan of its own. */
static void rare_polls(const char *unused)
{
    (void)unused;
    prepare(0);
    begin();
    start();
    scans_within(5000);
    bed.poll_ms = 200; /* The ring lasts 312 ms. */
    const uint32_t small = bed.small;
    for (uint32_t i = 0; i < 10; i++) {
        sim_befall(&bed.sim, SIM_SILENT, 100, bed.now_us);
        bed_run_ms(&bed, 1000);
    }
    expect(bed.small - small >= 50, "only %u scans of one packet", bed.small - small);
    expect(points_withheld() == 0, "%u points withheld", points_withheld());
}

static void pause_with_a_small_ring(const char *unused)
{
    (void)unused;
    one_pause(1024, 250, 700, 50);
}

static void pause_with_a_large_ring(const char *unused)
{
    (void)unused;
    one_pause(4096, 30, 1500, 20);
}

/* ---- A task that sleeps ---- */

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

/* ---- Rows ---- */

static const claim_t claims[] = {
    {"a_lidar_that_listens_later_is_started_once_and_soon", power_up_at_10_hz, NULL},
    {"without_a_frequency_a_lidar_that_listens_later_is_started_once_and_soon",
     power_up_without_a_frequency, NULL},
    {"a_lidar_that_never_answers_scans_within_9_s", never_answers, NULL},
    {"after_any_supply_failure_scans_come_within_4_s_at_10_hz", supply_fails_for_any_time, NULL},
    {"a_wish_near_the_lidars_own_frequency_survives_a_supply_failure", odd_frequencies_and_supply,
     NULL},
    {"a_lidar_that_answers_and_does_not_scan_is_rebooted", only_a_reboot_helps, NULL},
    {"a_lidar_that_does_not_scan_after_a_loss_is_rebooted", a_reboot_helps_after_a_loss, NULL},
    {"a_lidar_whose_start_packets_stop_is_rebooted_and_lost_once", start_packets_stop_coming, NULL},
    {"a_lidar_that_begins_without_start_packets_is_rebooted", start_packets_never_come, NULL},
    {"a_lidar_that_sends_start_packets_on_a_bad_line_is_not_stopped", bad_line, NULL},
    {"a_slider_leaves_scans_and_its_last_wish_is_reached", slider, NULL},
    {"a_frequency_is_rounded_to_the_nearest_step", frequencies_are_rounded, NULL},
    {"questions_are_answered_one_after_the_other", questions_wait, NULL},
    {"a_port_that_takes_one_byte_per_write_starts", one_byte_per_write, NULL},
    {"a_quiet_line_time_works_or_is_refused", any_quiet_line, NULL},
    {"a_program_with_a_small_ring_catches_up_after_a_pause", pause_with_a_small_ring, NULL},
    {"a_program_with_a_large_ring_catches_up_after_a_pause", pause_with_a_large_ring, NULL},
    {"a_program_that_polls_rarely_gets_every_point", rare_polls, NULL},
    {"a_task_that_sleeps_as_long_as_it_may_gets_the_same_events", sleep_as_long_as_allowed, NULL},
};

int main(int argc, char **argv)
{
    return claims_main(argc, argv, claims, sizeof claims / sizeof claims[0]);
}
