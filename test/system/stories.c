/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Random stories of wishes and trouble: 45 s after the last trouble each wish is fulfilled, every
 * gap in the scans was announced, and there were at most ten events a second.
 *
 *     stories [COUNT [FIRST]]    seeds from FIRST on; a failure prints its seed
 *     stories --tell SEED        one story, with what happens in it */

#include "bed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ACTS 12u
#define LIMIT_MS 45000u
#define MOST_FAILURES 10u /* Printed. */

static bed_t bed;
static random_t dice;
static uint32_t spoils_one_in; /* Of the events on the wire; 0: none. */
static uint64_t damaged_until_us;

static uint32_t below(uint32_t limit)
{
    return random_below(&dice, limit);
}

/* ---- Trouble ---- */

/* The first four spoil only something that happens on the wire. */
static const sim_trouble_t troubles[] = {SIM_LOST,      SIM_LOST,    SIM_LATE,   SIM_DOUBLED,
                                         SIM_POWER_CUT, SIM_DEAF,    SIM_SILENT, SIM_REBOOTS,
                                         SIM_NO_STARTS, SIM_NO_SCANS};
#define TROUBLES (sizeof troubles / sizeof troubles[0])
#define OF_THE_WIRE 4u

static sim_trouble_t spoil(bed_t *story, uint32_t *ms)
{
    const sim_trouble_t trouble = troubles[below(TROUBLES)];
    (void)story;
    if (spoils_one_in == 0 || below(spoils_one_in) > 0) {
        return SIM_SOUND;
    }
    *ms = below(3000);
    return trouble;
}

static void befall(void)
{
    const sim_trouble_t trouble = troubles[OF_THE_WIRE + below(TROUBLES - OF_THE_WIRE)];
    const uint32_t ms = below(5000);
    bed_tell(&bed, "%s, %u ms", sim_trouble_name(trouble), ms);
    sim_befall(&bed.sim, trouble, ms, bed.now_us);
}

static void make_trouble(void)
{
    switch (below(8)) {
    case 0:
        bed.flip_one_in = 2 + below(200);
        bed_tell(&bed, "one byte in %u is damaged", bed.flip_one_in);
        break;
    case 1:
        bed.sim.config.refuses_steps = true;
        bed_tell(&bed, "refuses its frequency");
        break;
    case 2:
        bed.sim.config.never_answers = true;
        bed_tell(&bed, "answers nothing");
        break;
    default:
        befall();
        break;
    }
}

static void end_trouble(void)
{
    if (bed.flip_one_in > 0) {
        damaged_until_us = bed.now_us;
        bed.flip_one_in = 0;
    }
    bed.sim.config.refuses_steps = false;
    bed.sim.config.never_answers = false;
}

/* ---- Stories ---- */

static void begin(uint32_t seed, bool is_told)
{
    sim_config_t lidar = bed_quiet_lidar();
    random_seed(&dice, seed);
    bed_prepare(&bed);
    bed.is_told = is_told;
    lidar.seed = seed;
    lidar.boot_ms = (uint16_t)(50 + below(4000));
    lidar.stop_tail_ms = (uint16_t)below(300);
    lidar.reply_latency_ms = (uint16_t)(1 + below(below(4) == 0 ? 400 : 20));
    lidar.first_packet_ms = (uint16_t)below(500);
    lidar.beginning = (sim_beginning_t)below(3);
    lidar.ct_information = below(2) == 0;
    lidar.keeps_frequency = below(4) == 0;
    bed.poll_ms = 1 + below(20);
    bed.spoil = spoil;
    bed.config.frequency_chz = (uint16_t)(below(2) == 0 ? 0 : 600 + 10 * below(61));
    spoils_one_in = below(3) == 0 ? 0 : 3 + below(40);
    damaged_until_us = 0;
    if (!bed_init(&bed, &lidar)) {
        printf("the library was not set up\n");
        exit(2);
    }
}

static void act(void)
{
    static const char *const names[] = {"start", "start",  "start", "stop",   "ask",
                                        "set",   "reboot", "calm",  "trouble"};
    const uint32_t choice = below(9);
    bed_tell(&bed, "--- %s", names[choice]);
    switch (choice) {
    case 0:
    case 1:
    case 2:
        (void)bed_start(&bed);
        break;
    case 3:
        (void)bed_stop(&bed);
        break;
    case 4:
        (void)bed_request_info(&bed);
        break;
    case 5:
        (void)bed_set_frequency(&bed, (uint16_t)(600 + 10 * below(61)));
        break;
    case 6:
        (void)tmini_reboot(&bed.lidar);
        break;
    case 7:
        end_trouble();
        break;
    default:
        make_trouble();
        break;
    }
}

/* A reply has no checksum: a damaged one has reported the wanted frequency. That shows only if the
 * revolutions are off by more than 5 % (seed 19201: 930 becomes 898 by one bit, 900 is wanted). */
static bool is_deceived(void)
{
    const int off_chz = abs(sim_frequency_chz(&bed.sim) - bed.wants_chz);
    return bed.event_us[TMINI_EVENT_FREQUENCY] < damaged_until_us &&
           abs(tmini_frequency_chz(&bed.lidar) - bed.wants_chz) <= 5 &&
           off_chz * 20 <= bed.wants_chz;
}

/* That the frequency could not be set was reported with the latest start. */
static bool could_not_set(void)
{
    const uint64_t failed_us = bed.event_us[TMINI_EVENT_COMMAND_FAILED];
    return failed_us > 0 && failed_us >= bed.event_us[TMINI_EVENT_STARTED] &&
           failed_us >= bed.event_us[TMINI_EVENT_RECOVERED];
}

static bool is_excused(const char *shortcoming)
{
    return bed.wants_scans && bed_scans_at(&bed, 0, 5) &&
           strstr(shortcoming, "frequency") != NULL && (could_not_set() || is_deceived());
}

static void run_ms(uint32_t ms)
{
    const uint64_t end_us = bed.now_us + ms * 1000u;
    while (bed.now_us < end_us && bed_misdeed(&bed) == NULL) {
        bed_step(&bed);
    }
}

/* Returns what is wrong, or NULL. */
static const char *tell(uint32_t seed, bool is_told)
{
    begin(seed, is_told);
    for (unsigned i = 0; i < ACTS; i++) {
        act();
        run_ms(below(4000));
    }
    end_trouble();
    bed_tell(&bed, "the trouble ends");
    spoils_one_in = 0;
    const bool needs_reboot = sim_sound_us(&bed.sim) == SIM_NEVER;
    const uint64_t sound_us = needs_reboot ? 0 : sim_sound_us(&bed.sim);
    const uint64_t end_us = (sound_us > bed.now_us ? sound_us : bed.now_us) +
                            (needs_reboot ? 2u : 1u) * LIMIT_MS * UINT64_C(1000);
    do { /* Fulfilled, and stays so. */
        while (bed_shortcoming(&bed) != NULL && bed.now_us < end_us && bed_misdeed(&bed) == NULL) {
            bed_step(&bed);
        }
        run_ms(3000);
    } while (bed_shortcoming(&bed) != NULL && bed.now_us < end_us && bed_misdeed(&bed) == NULL);
    bed_tell_state(&bed);
    const char *const shortcoming = bed_shortcoming(&bed);
    if (bed_misdeed(&bed) != NULL) {
        return bed_misdeed(&bed);
    }
    return shortcoming == NULL || is_excused(shortcoming) ? NULL : shortcoming;
}

int main(int argc, char **argv)
{
    const bool is_told = argc == 3 && strcmp(argv[1], "--tell") == 0;
    const uint32_t count = is_told ? 1 : argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 20000;
    const uint32_t first = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
    uint32_t failures = 0;
    for (uint32_t seed = first; seed < first + count; seed++) {
        const char *const what = tell(seed, is_told);
        if (what != NULL && ++failures <= MOST_FAILURES) {
            printf("stories --tell %u    # %s\n", seed, what);
        }
    }
    printf("%u stories, %u failed\n", count, failures);
    return failures == 0 ? 0 : 1;
}
