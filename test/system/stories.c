/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Random stories of wishes and trouble: 45 s after the last trouble each wish is fulfilled, every
 * gap in the scans was announced, and there were at most ten events a second.
 *
 *     stories [COUNT [FIRST]]    seeds from FIRST on; a failure prints its seed */

#include "bed.h"

#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ACTS 12u
#define LIMIT_MS 45000u
#define MOST_FAILURES 10u /* Printed. */

/* Stories fail today. It is an error if none does: then this is to be removed. */
#define EXPECTED_RED 1

static bed_t bed;
static random_t dice;
static uint32_t spoils_one_in; /* Of the events on the wire; 0: none. */
static bool was_refused;       /* The lidar refused to set its frequency for a while. */

static uint32_t below(uint32_t limit)
{
    return random_below(&dice, limit);
}

/* ---- Trouble ---- */

static sim_trouble_t on_event(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms)
{
    static const sim_trouble_t troubles[] = {SIM_LOST,    SIM_LOST,      SIM_LATE,    SIM_LATE,
                                             SIM_DOUBLED, SIM_POWER_CUT, SIM_DEAF,    SIM_SILENT,
                                             SIM_REBOOTS, SIM_NO_STARTS, SIM_NO_SCANS};

    (void)context;
    (void)event;
    (void)now_us;
    *ms = below(3000);
    return spoils_one_in > 0 && below(spoils_one_in) == 0
               ? troubles[below(sizeof troubles / sizeof troubles[0])]
               : SIM_SOUND;
}

static void make_trouble(void)
{
    static const sim_trouble_t troubles[] = {SIM_POWER_CUT, SIM_DEAF,      SIM_SILENT,
                                             SIM_REBOOTS,   SIM_NO_STARTS, SIM_NO_SCANS};

    switch (below(8)) {
    case 0:
        bed.flip_one_in = 2 + below(200);
        break;
    case 1:
        bed.sim.config.refuses_steps = true;
        was_refused = true;
        break;
    case 2:
        bed.sim.config.never_answers = true;
        break;
    default:
        sim_befall(&bed.sim, troubles[below(sizeof troubles / sizeof troubles[0])], below(5000),
                   bed.now_us);
        break;
    }
}

static void end_trouble(void)
{
    bed.flip_one_in = 0;
    bed.sim.config.refuses_steps = false;
    bed.sim.config.never_answers = false;
}

/* ---- Stories ---- */

static void begin(uint32_t seed)
{
    const sim_observer_t observer = {.on_event = on_event};
    sim_config_t lidar = bed_quiet_lidar();

    random_seed(&dice, seed);
    bed_prepare(&bed);
    lidar.seed = seed;
    lidar.boot_ms = (uint16_t)(50 + below(4000));
    lidar.stop_tail_ms = (uint16_t)below(300);
    lidar.reply_latency_ms = (uint16_t)(1 + below(below(4) == 0 ? 400 : 20));
    lidar.first_packet_ms = (uint16_t)below(500);
    lidar.beginning = (sim_beginning_t)below(3);
    lidar.ct_information = below(2) == 0;
    lidar.keeps_frequency = below(4) == 0;
    bed.poll_ms = 1 + below(20);
    bed.config.frequency_chz = (uint16_t)(below(2) == 0 ? 0 : 600 + 10 * below(61));
    spoils_one_in = below(3) == 0 ? 0 : 3 + below(40);
    was_refused = false;
    if (!bed_init(&bed, &lidar)) {
        printf("the library was not set up\n");
        exit(2);
    }
    sim_observe(&bed.sim, &observer);
}

static void act(void)
{
    switch (below(9)) {
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

/* A lidar that refused its frequency had that reported, and scans at its own. */
static bool is_excused(const char *shortcoming)
{
    return was_refused && bed.events[TMINI_EVENT_COMMAND_FAILED] > 0 && bed.wants_scans &&
           bed_scans_at(&bed, 0, 5) && strstr(shortcoming, "frequency") != NULL;
}

static void run_ms(uint32_t ms)
{
    const uint64_t end_us = bed.now_us + ms * 1000u;

    while (bed.now_us < end_us && bed_misdeed(&bed) == NULL) {
        bed_step(&bed);
    }
}

/* Returns what is wrong, or NULL. */
static const char *tell(uint32_t seed)
{
    begin(seed);
    for (unsigned i = 0; i < ACTS; i++) {
        act();
        run_ms(below(4000));
    }
    end_trouble();
    spoils_one_in = 0;
    const bool needs_reboot = sim_sound_us(&bed.sim) == SIM_NEVER;
    const uint64_t sound_us = needs_reboot ? 0 : sim_sound_us(&bed.sim);
    const uint64_t end_us = (sound_us > bed.now_us ? sound_us : bed.now_us) +
                            (needs_reboot ? 2u : 1u) * LIMIT_MS * UINT64_C(1000);
    while (bed_shortcoming(&bed) != NULL && bed.now_us < end_us && bed_misdeed(&bed) == NULL) {
        bed_step(&bed);
    }
    run_ms(3000); /* And stays so. */
    const char *const shortcoming = bed_shortcoming(&bed);
    if (bed_misdeed(&bed) != NULL) {
        return bed_misdeed(&bed);
    }
    return shortcoming == NULL || is_excused(shortcoming) ? NULL : shortcoming;
}

int main(int argc, char **argv)
{
    const uint32_t count = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 20000;
    const uint32_t first = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
    uint32_t failures = 0;

    for (uint32_t seed = first; seed < first + count; seed++) {
        const char *const what = tell(seed);

        if (what != NULL && ++failures <= MOST_FAILURES) {
            printf("stories 1 %u    # %s\n", seed, what);
        }
    }
    printf("%u stories, %u failed\n", count, failures);
    return (failures > 0) == (EXPECTED_RED != 0) ? 0 : 1;
}
