/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a program wishes, what happens to its lidar, and what comes of it, as text: each row is a
 * claim (claims.h).
 *
 * A script is a list of steps: one of words[] and a number, or one of these claims: "in scanning":
 * the driver's state; "lost 1": how often an event has come. Steps before "begin" are
 * configuration; a script without it begins at once. */

#include "bed.h"
#include "claims.h"

#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void play(const char *script);

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
     "no recovery, begin, power 0, start, run 60000, command failed 1, in unknown, power 1, "
     "run 5000, start, run 5000, scans 600"},
    {"without_recovery_a_loss_is_only_reported", play,
     "no recovery, begin, start, run 4000, power 0, run 2000, power 1, run 30000, lost 1, "
     "in recovering, lidar idle, stop, run 1000, stopped 1, start, run 5000, scans 600"},
    {"a_lost_answer_is_asked_for_again", play,
     "lose reply, ask, run 3000, information 1, command failed 0"},
    {"a_lidar_that_streams_already_is_stopped", play,
     "others start, run 3000, stop, run 1000, stopped 1, lidar idle, in idle"},
    {"a_listener_waits_and_takes_what_comes",
     play, /* It fails after 3, 3.5, 4.5, 6.5 and 8.5 seconds. */
     "listen, begin, start, run 10000, in starting, command failed 5, others start, run 5000, "
     "scans 600, power 0, run 3000, power 1, in recovering, run 10000, others start, run 5000, "
     "scans 600, sent 0"},
    {"a_listener_stops_at_once_and_has_sent_nothing", play,
     "listen, begin, others start, start, run 5000, scans 600, stop, run 5000, in unknown, "
     "stopped 1, command failed 0, unwanted scanning 0, sent 0"},
};

static bed_t bed;
static sim_config_t lidar;

static void configure_wish(uint32_t chz)
{
    bed.config.frequency_chz = (uint16_t)chz;
}

static void configure_points(uint32_t points)
{
    bed.config.max_points = points;
}

static void configure_no_recovery(uint32_t unused)
{
    (void)unused;
    bed.config.recovery = TMINI_RECOVERY_OFF;
}

static void configure_listening(uint32_t unused)
{
    (void)unused;
    bed.config.listen_only = true;
}

static void configure_most(uint32_t chz)
{
    lidar.max_frequency_chz = (uint16_t)chz;
}

static void configure_motor(uint32_t percent)
{
    lidar.motor_percent = (uint8_t)percent;
}

static void begin(uint32_t unused)
{
    (void)unused;
    expect(bed_init(&bed, &lidar), "the configuration is refused");
}

static void do_start(uint32_t unused)
{
    (void)unused;
    expect(bed_start(&bed) == TMINI_OK, "start is refused");
}

static void do_stop(uint32_t unused)
{
    (void)unused;
    expect(bed_stop(&bed) == TMINI_OK, "stop is refused");
}

static void do_set(uint32_t chz)
{
    expect(bed_set_frequency(&bed, (uint16_t)chz) == TMINI_OK, "%u is refused", chz);
}

static void do_ask(uint32_t unused)
{
    (void)unused;
    expect(bed_request_info(&bed) == TMINI_OK, "a question is refused");
}

static void do_run(uint32_t ms)
{
    bed_run_ms(&bed, ms);
}

static void switch_power(uint32_t is_on)
{
    sim_power(&bed.sim, is_on != 0, bed.now_us);
}

static void make_deaf(uint32_t ms)
{
    sim_befall(&bed.sim, SIM_DEAF, ms, bed.now_us);
}

static void lose_reply(uint32_t unused)
{
    (void)unused;
    sim_lose_next_reply(&bed.sim);
}

static void forget_frequency(uint32_t chz)
{
    bed.sim.frequency_chz = (uint16_t)chz;
}

static void let_others_start(uint32_t unused)
{
    static const uint8_t command[] = {0xA5, SIM_COMMAND_START};

    (void)unused;
    sim_receive(&bed.sim, command, sizeof command, bed.now_us);
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

static void expect_faults(uint32_t faults)
{
    expect(tmini_faults(&bed.lidar) == faults, "faults %u", tmini_faults(&bed.lidar));
}

static void expect_idle_lidar(uint32_t unused)
{
    (void)unused;
    expect(sim_mode(&bed.sim) == SIM_IDLE, "the lidar is not idle");
}

static void expect_sent(uint32_t bytes)
{
    expect(bed.sent == bytes, "%u bytes were sent", bed.sent);
}

static const struct {
    const char *word;
    void (*run)(uint32_t number);
} words[] = {
    {"wants", configure_wish},
    {"points", configure_points},
    {"no recovery", configure_no_recovery},
    {"listen", configure_listening},
    {"most", configure_most},
    {"motor", configure_motor},
    {"begin", begin},
    {"start", do_start},
    {"stop", do_stop},
    {"set", do_set},
    {"ask", do_ask},
    {"run", do_run},
    {"power", switch_power},
    {"deaf", make_deaf},
    {"lose reply", lose_reply},
    {"forgets", forget_frequency},
    {"others start", let_others_start},
    {"scans", expect_scans},
    {"faults", expect_faults},
    {"lidar idle", expect_idle_lidar},
    {"sent", expect_sent},
};

static void play_step(const char *word, uint32_t number)
{
    const unsigned event = bed_event_named(word);

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i].word, word) == 0) {
            words[i].run(number);
            return;
        }
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

    lidar = bed_quiet_lidar();
    lidar.marked = true;
    bed_prepare(&bed);
    if (strstr(script, "begin, ") == NULL) {
        begin(0);
    }
    while (script != NULL && is_right()) {
        script = take_step(script, word, sizeof word, &number);
        play_step(word, number);
    }
    expect(bed_misdeed(&bed) == NULL, "%s", bed_misdeed(&bed));
}

int main(int argc, char **argv)
{
    return claims_main(argc, argv, claims, sizeof claims / sizeof claims[0]);
}
