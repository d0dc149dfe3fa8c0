/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* No wish is ever lost. Stories of wishes are played to a lidar; at each event on the wire each
 * trouble comes, then at each later event a second one, and so on. Within 15 s after the lidar is
 * sound again each wish must be fulfilled.
 *
 *     explore [--depth N] [--every N] [STORY …]   N troubles, 2 unless given; each, or each Nth, of
 *                                                 the last ones; all stories
 *     explore --replay STORY 7:cut50 12:lost      one run, with what happens in it
 *
 * A failure is printed as the arguments of --replay. The state before each event is kept, so that
 * a run begins there and not with the story (bed.h). */

#include "bed.h"

#include "tmini/tmini_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POLL_MS 10u
#define LIMIT_US 15000000u        /* From a sound lidar on. */
#define REBOOT_LIMIT_US 30000000u /* Until a lidar that needs a reboot gets it. */
#define DEPTH_MAX 3u
#define POINTS_MAX 400u
#define MOST_FAILURES 10u /* Printed per story. */

/* ---- Stories ---- */

typedef enum { NOTHING, START, STOP, SET, ASK } act_t;

typedef struct {
    uint32_t at_ms;
    act_t act;
    uint16_t frequency_chz;
} scene_t;

typedef struct {
    const char *name;
    uint16_t frequency_chz; /* In the configuration. */
    scene_t scenes[6];
} story_t;

static const story_t stories[] = {
    {"10hz", 1000, {{0, START, 0}}},
    {"6.1hz", 610, {{0, START, 0}}},
    {"no-wish", 0, {{0, START, 0}}},
    {"change", 1000, {{0, START, 0}, {3000, SET, 800}}},
    {"stop", 1000, {{0, START, 0}, {3000, STOP, 0}}},
    {"stop-set-start", 1000, {{0, START, 0}, {3000, STOP, 0}, {3000, SET, 800}, {3000, START, 0}}},
    {"ask", 1000, {{0, ASK, 0}, {0, START, 0}}},
};
#define STORIES (sizeof stories / sizeof stories[0])

/* ---- Troubles ---- */

/* With milliseconds. */
static const char *const spoils[] = {"lost",       "late700",   "late2300", "doubled",
                                     "cut50",      "cut2500",   "deaf400",  "deaf3000",
                                     "silent1500", "no-starts", "reboots",  "no-scans"};
#define SPOILS (sizeof spoils / sizeof spoils[0])

typedef struct {
    uint32_t event; /* The number of the event on the wire, from 0. */
    const char *spoil;
} plan_t;

/* ---- One run ---- */

/* All that a run consists of: copied as a whole. */
typedef struct {
    bed_t bed;
    const story_t *story;
    uint32_t scene; /* The next one. */
    plan_t plan[DEPTH_MAX];
    uint32_t troubles;
} run_t;

static run_t run;

static sim_trouble_t spoil(bed_t *bed, uint32_t *ms)
{
    for (uint32_t i = 0; i < run.troubles; i++) {
        if (run.plan[i].event == bed->wire_events) {
            return sim_trouble_named(run.plan[i].spoil, ms);
        }
    }
    return SIM_SOUND;
}

static void begin(const story_t *story)
{
    const sim_config_t config = bed_quiet_lidar();
    memset(&run, 0, sizeof run);
    bed_prepare(&run.bed);
    run.bed.poll_ms = POLL_MS;
    run.bed.spoil = spoil;
    run.bed.config.frequency_chz = story->frequency_chz;
    if (!bed_init(&run.bed, &config)) {
        printf("the library was not set up\n");
        exit(2);
    }
    run.story = story;
}

static tmini_status_t act(const scene_t *scene)
{
    switch (scene->act) {
    case START:
        return bed_start(&run.bed);
    case STOP:
        return bed_stop(&run.bed);
    case SET:
        return bed_set_frequency(&run.bed, scene->frequency_chz);
    default:
        return bed_request_info(&run.bed);
    }
}

static void act_next(void)
{
    const tmini_status_t status = act(&run.story->scenes[run.scene++]);
    if (status != TMINI_OK) {
        printf("a wish was refused: %s\n", tmini_status_name(status));
        exit(2);
    }
}

static bool has_scene(void)
{
    return run.scene < sizeof run.story->scenes / sizeof run.story->scenes[0] &&
           run.story->scenes[run.scene].act != NOTHING;
}

static void step(void)
{
    bed_step(&run.bed);
    while (has_scene() && bed_ms(&run.bed) >= run.story->scenes[run.scene].at_ms) {
        act_next();
    }
}

static bool is_fulfilled(void)
{
    return !has_scene() && bed_shortcoming(&run.bed) == NULL;
}

static uint64_t later(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* NULL: goes on. Otherwise what is wrong. */
static const char *complaint(void)
{
    const uint64_t since_us = later(run.bed.wished_us, run.bed.sim.sound_us);
    const bool needs_reboot = sim_sound_us(&run.bed.sim) == SIM_NEVER && run.bed.wants_scans;
    const uint64_t limit_us = needs_reboot ? REBOOT_LIMIT_US : LIMIT_US;
    if (bed_misdeed(&run.bed) != NULL) {
        return bed_misdeed(&run.bed);
    }
    return !has_scene() && run.bed.now_us > since_us + limit_us ? bed_shortcoming(&run.bed) : NULL;
}

/* ---- Exploring ---- */

/* The state before a step that had events, and their numbers. */
typedef struct {
    run_t before;
    uint32_t first;
    uint32_t end;
} place_t;

/* The places of one run, and the next choice among them: an event and what spoils it. */
typedef struct {
    place_t places[POINTS_MAX];
    uint32_t count;
    uint32_t place;
    uint32_t event;
    size_t spoil;
} trail_t;

static trail_t trails[DEPTH_MAX];
static uint32_t every; /* Of the last troubles, one in this many is played. */
static uint64_t last_troubles;
static uint64_t runs;
static uint64_t failures;

static void report(const char *what)
{
    failures++;
    if (failures > MOST_FAILURES) {
        return;
    }
    printf("explore --replay %s", run.story->name);
    for (uint32_t i = 0; i < run.troubles; i++) {
        printf(" %u:%s", run.plan[i].event, run.plan[i].spoil);
    }
    printf("    # %s\n", what);
}

static bool may_have_events(void)
{
    return run.bed.outbox_count > 0 || run.bed.sim.late.count > 0 ||
           sim_expects_event(&run.bed.sim);
}

static bool keep_place(trail_t *trail)
{
    const bool is_kept = trail->count < POINTS_MAX && may_have_events();
    if (is_kept) {
        trail->places[trail->count].before = run;
    }
    return is_kept;
}

static void close_place(trail_t *trail, bool is_kept, uint32_t events_before)
{
    if (run.bed.wire_events > events_before) {
        if (!is_kept) {
            printf("an event came unexpectedly, or there were too many\n");
            exit(2);
        }
        trail->places[trail->count].first = events_before;
        trail->places[trail->count].end = run.bed.wire_events;
        trail->count++;
    }
}

/* Runs to the end, and keeps the places of events in `trail`, unless it is NULL. */
static void play(trail_t *trail)
{
    const char *what = NULL;
    runs++;
    while (!is_fulfilled() && (what = complaint()) == NULL) {
        const uint32_t events_before = run.bed.wire_events;
        const bool is_kept = trail != NULL && keep_place(trail);
        step();
        if (trail != NULL) {
            close_place(trail, is_kept, events_before);
        }
    }
    if (what != NULL) {
        report(what);
    }
}

/* The same event is spoilt in each way, then the next one. False: there is none. */
static bool choose_next(trail_t *trail)
{
    if (++trail->spoil == SPOILS) {
        trail->spoil = 0;
        trail->event++;
    }
    while (trail->place < trail->count && trail->event >= trail->places[trail->place].end) {
        trail->place++;
    }
    return trail->place < trail->count;
}

/* Goes back to before the chosen event, and plans its trouble. */
static void go_back(const trail_t *trail)
{
    run = trail->places[trail->place].before;
    run.plan[run.troubles].event = trail->event;
    run.plan[run.troubles].spoil = spoils[trail->spoil];
    run.troubles++;
}

/* Plays on, with further choices at events from number `from` on. */
static void play_on(trail_t *trail, uint32_t from)
{
    trail->count = 0;
    trail->place = 0;
    trail->event = from - 1u;
    trail->spoil = SPOILS - 1u;
    play(trail);
}

/* Every run with up to `depth` troubles: a walk through a tree, whose branches from one run are in
 * one trail. */
static void explore(uint32_t depth)
{
    uint32_t level = 0;
    play_on(&trails[0], 0);
    for (;;) {
        trail_t *const trail = &trails[level];
        if (!choose_next(trail) && level == 0) {
            return;
        }
        if (trail->place == trail->count) {
            level--;
            continue;
        }
        if (level + 1u < depth) {
            go_back(trail);
            level++;
            play_on(&trails[level], trail->event + 1u);
        } else if (last_troubles++ % every == 0) {
            go_back(trail);
            play(NULL);
        }
    }
}

static bool tell(const story_t *story, uint32_t depth)
{
    runs = 0;
    failures = 0;
    begin(story);
    explore(depth);
    printf("%-16s %8llu runs, %llu failed\n", story->name, (unsigned long long)runs,
           (unsigned long long)failures);
    return failures == 0;
}

/* ---- The command line ---- */

static const story_t *story_named(const char *name)
{
    for (size_t i = 0; i < STORIES; i++) {
        if (strcmp(name, stories[i].name) == 0) {
            return &stories[i];
        }
    }
    printf("no such story: %s\n", name);
    exit(2);
}

static void plan_one(const char *text)
{
    const char *const colon = strchr(text, ':');
    for (size_t i = 0; colon != NULL && i < SPOILS && run.troubles < DEPTH_MAX; i++) {
        if (strcmp(colon + 1, spoils[i]) == 0) {
            run.plan[run.troubles].event = (uint32_t)strtoul(text, NULL, 10);
            run.plan[run.troubles].spoil = spoils[i];
            run.troubles++;
            return;
        }
    }
    printf("not understood: %s\n", text);
    exit(2);
}

static int replay(int count, char **texts)
{
    if (count == 0) {
        printf("explore --replay STORY [EVENT:TROUBLE …]\n");
        return 2;
    }
    begin(story_named(texts[0]));
    for (int i = 1; i < count; i++) {
        plan_one(texts[i]);
    }
    run.bed.is_told = true;
    play(NULL);
    bed_tell_state(&run.bed);
    return failures > 0 ? 1 : 0;
}

/* The number after this option, if the option comes next. */
static uint32_t option(int argc, char **argv, int *next, const char *name, uint32_t otherwise)
{
    if (argc <= *next + 1 || strcmp(argv[*next], name) != 0) {
        return otherwise;
    }
    *next += 2;
    return (uint32_t)strtoul(argv[*next - 1], NULL, 10);
}

int main(int argc, char **argv)
{
    int first = 1;
    bool is_right = true;
    if (argc > first && strcmp(argv[first], "--replay") == 0) {
        return replay(argc - 2, argv + 2);
    }
    const uint32_t depth = option(argc, argv, &first, "--depth", 2);
    every = option(argc, argv, &first, "--every", 1);
    if (depth == 0 || depth > DEPTH_MAX || every == 0) {
        printf("1 to %u troubles, every from 1\n", DEPTH_MAX);
        return 2;
    }
    for (size_t i = 0; first >= argc && i < STORIES; i++) {
        is_right = tell(&stories[i], depth) && is_right;
    }
    for (int i = first; i < argc; i++) {
        is_right = tell(story_named(argv[i]), depth) && is_right;
    }
    return is_right ? 0 : 1;
}
