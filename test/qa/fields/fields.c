/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How soon fields see a pillar, how often they lose it, and how often noise stops a robot, for each
 * K (points) and N (scans): the table of docs/robotics.md.
 *
 *     fields HOURS [SEED]
 *
 * In an empty hall for HOURS hours, false alarms are counted: fields that do not stay free. Then a
 * pillar appears 200 times, within 10 degrees of ahead (5 for the far one), for 5 seconds. */

#include "rover.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KS 4u
#define NS 3u
#define TRIALS 200u
#define FOUND_MS 500u
#define STAY_MS 5000u
#define REST_MS 1500u

/* A box for each pillar, and in it a field for each K and N. */
typedef struct {
    tmini_xy_t box[2];
    double mm;
    double wide_mm;
    unsigned most_deg;
} place_t;

static const place_t places[] = {
    {{{0, -300}, {1200, 300}}, 1000, 30, 10},
    {{{0, -500}, {3300, 500}}, 3000, 100, 5},
};

typedef struct {
    uint32_t alarms; /* In the empty hall. */
    uint32_t found;  /* Pillars, within FOUND_MS. */
    uint32_t freed;  /* Although the pillar was there. */
} result_t;

/* One for each place, K and N, in this order. */
#define ALL (2 * KS * NS)

static const rover_hall_t empty = {0};
static tmini_field_t fields[ALL];
static tmini_field_state_t before[ALL];
static result_t results[ALL];

typedef enum { NOTHING, ALARMS, FREED } counted_t;

static void pass(uint32_t ms, counted_t counted)
{
    while (ms-- > 0) {
        for (unsigned i = rover_pass() ? 0 : ALL; i < ALL; i++) {
            const tmini_field_state_t now = tmini_field_state(&fields[i], rover_now_ms());
            results[i].alarms +=
                counted == ALARMS && now != before[i] && before[i] == TMINI_FIELD_FREE;
            results[i].freed += counted == FREED && now != before[i] && now == TMINI_FIELD_FREE;
            before[i] = now;
        }
    }
}

static void show_pillar(unsigned place)
{
    const place_t *const at = &places[place];
    const unsigned most = at->most_deg * 100;
    const rover_hall_t hall = {.pillar_mm = at->mm,
                               .pillar_wide_mm = at->wide_mm,
                               .pillar_deg =
                                   ((double)random_below(&rover_random, 2 * most) - most) / 100.0};
    rover_furnish(&hall);
    pass(FOUND_MS, NOTHING);
    for (unsigned i = place * KS * NS; i < (place + 1) * KS * NS; i++) {
        results[i].found += before[i] == TMINI_FIELD_OCCUPIED;
    }
    pass(STAY_MS - FOUND_MS, FREED);
    rover_furnish(&empty);
    pass(REST_MS + random_below(&rover_random, 200), NOTHING);
}

static void print_by_n(uint32_t one, uint32_t three, uint32_t five, double hours)
{
    (void)printf(" | %.0f / %.0f / %.0f", one / hours, three / hours, five / hours);
}

/* The rows of one frequency, from `quiet`, without random points, and from `noisy`. */
static void print_places(unsigned hertz, const result_t *quiet, const result_t *noisy,
                         unsigned hours)
{
    static const double shown_hours = (double)TRIALS * (STAY_MS - FOUND_MS) / 3600000.0;
    for (unsigned i = 0; i < 2 * KS; i++) {
        const result_t *const without = &quiet[i * NS];
        const result_t *const with = &noisy[i * NS];
        (void)printf("| %g mm at %g m | %u Hz | %u | %.0f %% | %.0f %%", places[i / KS].wide_mm,
                     places[i / KS].mm / 1000, hertz, 1 + i % KS, 100.0 * without->found / TRIALS,
                     100.0 * with->found / TRIALS);
        print_by_n(without[0].freed, without[1].freed, without[2].freed, shown_hours);
        (void)printf(" | %.0f", (double)without->alarms / hours);
        print_by_n(with[0].alarms, with[1].alarms, with[2].alarms, hours);
        (void)puts(" |");
    }
}

static void measure(const rover_config_t *config, unsigned hours)
{
    static const tmini_fields_t all = {.list = fields, .count = ALL};
    for (unsigned i = 0; i < ALL; i++) {
        fields[i] = (tmini_field_t){.corners = places[i / (KS * NS)].box,
                                    .corner_count = 2,
                                    .points = (uint8_t)(1 + i / NS % KS),
                                    .scans = (uint8_t)(1 + i % NS * 2), /* 1, 3, 5. */
                                    .max_age_ms = 600};
        before[i] = TMINI_FIELD_BLIND;
        results[i] = (result_t){0};
    }
    rover_init(config, &all);
    rover_furnish(&empty);
    pass(10000, NOTHING);
    pass(hours * 3600000u, ALARMS);
    for (unsigned i = 0; i < 2 * TRIALS; i++) {
        show_pillar(i % 2);
    }
}

static void measure_frequency(uint16_t hertz, unsigned hours, unsigned seed)
{
    static result_t quiet[ALL];
    rover_config_t config = {(uint16_t)(hertz * 100u), 0, seed};
    measure(&config, hours);
    memcpy(quiet, results, sizeof quiet);
    config.random_percent = 5;
    measure(&config, hours);
    print_places(hertz, quiet, results, hours);
}

int main(int argc, char **argv)
{
    const unsigned hours = argc > 1 ? (unsigned)atoi(argv[1]) : 0;
    const unsigned seed = argc > 2 ? (unsigned)atoi(argv[2]) : 1;
    if (hours == 0 || hours > 1000) {
        (void)fprintf(stderr, "usage: fields HOURS [SEED]\n");
        return 2;
    }
    (void)puts("| pillar | | K | found | found, 5 % | freed though there, N 1 / 3 / 5 "
               "| false alarms | false alarms, 5 %, N 1 / 3 / 5 |");
    (void)puts("|---|---|---:|---:|---:|---:|---:|---:|");
    measure_frequency(6, hours, seed);
    measure_frequency(10, hours, seed);
    return 0;
}
