/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* campaign SCANS [SEED [MODE [TRIAL]]]
 *
 * Checks that no scan reports anything wrong. Runs the library in virtual time with a line that
 * falls silent in mid-scan, with programs that are busy for too long, and with receivers that
 * lose bytes. Time also passes at each access to an index that both sides share
 * (interrupting_atomic.h): bytes arrive and interrupts come during tmini_poll(), which may also be
 * pre-empted for longer. Checks SCANS scans in each mode (or in the given one): see watch.h. Exit
 * status: 0 no scan was wrong, 1 some were, 2 wrong usage. The same seed gives the same run; TRIAL
 * runs only that trial.
 *
 * campaign soak HOURS [SEED]    see soak.c */

#include "campaign.h"

#include "bed.h"
#include "interrupting_atomic.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 2048u
#define GRAIN_US 500u
#define BYTE_US 76u     /* Mean time per byte of a scanning lidar (section 1). */
#define SILENCE_MS 300u /* Longer than the parser waits for the rest of a packet. */
#define MOST_TURNS 20u
#define MOST_HOLES 4u
#define MOST_LAPS 9u     /* That DMA receives while the CPU stops. */
#define MOST_WRONGS 100u /* Then a mode ends: to look at each takes long. */
#define SPIN_UP_CHZ 240u
#define PACKETS_SIZE 230u /* Of the one that waits, and of what comes during the next poll. */

/* What is counted, and as what it is printed. */
typedef enum {
    SCANS,
    COMPLETE,
    UNTOUCHED,     /* Turns. */
    INTACT,        /* Points of packets certainly without losses. */
    IN_ONE,        /* Those of them that are in exactly one scan. */
    WITHHELD,      /* Points that the library withheld, because the program was behind. */
    MIXED_UNTIMED, /* Incomplete scans of two turns, because max_pause_ms is 0. */
    MIXED_UNSEEN,  /* Likewise, a poll or a hand-over between the turns may have come late. */
    MIXED_DRIBBLE, /* Likewise, remains of damaged packets came: no silence was long enough. */
    SUMS
} sum_t;

static const char *const sum_names[SUMS] = {
    "scans",
    "of them complete",
    "turns came whole for certain",
    "intact points",
    "of them in exactly one scan",
    "points withheld",
    "incomplete of two turns: pauses are not judged",
    "incomplete of two turns: a poll or hand-over came late",
    "incomplete of two turns: silences too short to count",
};

typedef struct {
    const char *name;
    const char *what;
    enum {
        WHOLE, /* Each turn without losses must be delivered as complete. */
        LINE,  /* The line has holes. */
        OTHER
    } losses;
    void (*draw)(void);
} campaign_mode_t;

/* The controller: bed, held, and this. */
static struct {
    uint32_t access_ns;      /* Time per access to a shared index. */
    bool is_bridged;         /* The program is never busy so long that the layer overflows. */
    uint32_t handler_us;     /* The longest work on a scan; from 1 ms. */
    uint32_t handle_one_in;  /* It works on one scan in N; 0: on none. */
    uint32_t preempt_us;     /* The longest pre-emption of a poll. */
    uint32_t preempt_one_in; /* One poll in N is pre-empted; 0: none. */
    uint32_t stall_one_in;   /* The CPU stops in one poll or pause in N; 0: never. */
} program;

/* What happens in the trial. */
static struct {
    uint32_t polls;
    uint32_t accesses;     /* Of the present poll. */
    uint32_t preempted_at; /* The access at which it is pre-empted; 0: none. */
    uint32_t ns;           /* Less than a microsecond. */
    bool may_have_overwritten;
    bool is_interrupted; /* An interrupt cannot be interrupted. */
} now;

static bed_t bed;
static bed_held_t held;
static watch_t watch;
static uint8_t rx[65536];
static tmini_point_t points[POINTS];

random_t dice;

static struct {
    uint64_t sums[SUMS];
    uint64_t wrongs[WRONG_KINDS];
    uint64_t first_trial[WRONG_KINDS]; /* The first trial with this error. */
} verdicts;

/* ---- Random settings: those of all modes, then those of each mode ---- */

static uint32_t one_of(const uint32_t *values, size_t count)
{
    return values[below((uint32_t)count)];
}

static sim_config_t draw_lidar(void)
{
    sim_config_t lidar = sim_default_config();
    lidar.seed = random_u64(&dice);
    lidar.marked = true;
    lidar.ct_information = one_in(2);
    lidar.frequency_chz = (uint16_t)one_of((const uint32_t[]){600, 800, 1000, 1200}, 4);
    lidar.start_angle_q6 = (uint16_t)(one_in(2) ? 0 : below(23040));
    lidar.lone_packet_permille = 3;
    lidar.first_packet_ms = 12;
    lidar.spin_up_percent = (uint8_t)(one_in(8) ? 100u * SPIN_UP_CHZ / lidar.frequency_chz : 100u);
    return lidar;
}

typedef enum { BYTES, BLOCKS, DMA } feed_t;

static void feed_by(feed_t feed)
{
    bed.held = feed == BLOCKS ? &held : NULL;
    bed.config.rx_dma = feed == DMA;
}

/* A controller that keeps up. */
static void draw_program(void)
{
    feed_by((feed_t)below(3));
    bed.config.rx_size = bed.config.rx_dma ? 2048 : 1024;
    bed.poll_ms = between(1, 20);
    bed.clock_ms = random_u32(&dice); /* It may wrap around. */
    bed.clock_ppm = (int32_t)below(60001) - 30000;
    bed.timing.max_pause_ms = 30;
    bed.reports_twice = one_in(2);
    held.size = 2048;
    held.every_us = between(500, 10000);
    held.ignores_room = one_in(2);
    held.is_mute = one_in(2);
    held.reported_max = SIZE_MAX;
    program.access_ns = one_of((const uint32_t[]){50, 200, 1000, 3000}, 4);
    program.preempt_us = 5000;
    program.preempt_one_in = 20;
}

static void draw_nothing(void) {}

/* The program is busy for up to nine tenths of the time that the layer below can bridge; this layer
 * reports its bytes. */
static void draw_bridged(void)
{
    feed_by(BLOCKS);
    bed.poll_ms = between(1, 10);
    held.every_us = between(200, 2000);
    held.ignores_room = false;
    held.size = one_in(2) ? 2048 : 8192;
    program.handle_one_in = between(1, 20);
    program.handler_us = 600000;
    program.is_bridged = true;
}

/* The clock is set back at some time in the line's first 1.5 s. */
static void draw_set_back(void)
{
    bed.poll_ms = between(1, 10);
    bed.back_ms = between(1, 1000);
    bed.back_at_us = between(100000, 1500000);
}

static void draw_overflow(void)
{
    const uint32_t smallest = bed.config.rx_dma ? 9 : 8;
    bed.config.rx_size = (size_t)1 << between(smallest, 13);
    program.handle_one_in = between(1, 4);
    program.handler_us = between(1, 6) * 100000;
    if (bed.held != NULL && one_in(3)) {
        held.size = 128; /* A UART's FIFO, emptied too late. */
        held.every_us = between(5000, 15000);
    }
}

static void draw_stalls(void)
{
    feed_by(DMA);
    bed.config.rx_size = (size_t)1 << between(9, 13);
    bed.false_gap_one_in = one_in(2) ? 100 : 0;
    program.stall_one_in = between(50, 400);
    program.preempt_one_in = between(20, 400);
}

/* The task that hands over bytes is delayed again and again. */
static void draw_hold_ups(void)
{
    feed_by(BLOCKS);
    bed.config.rx_size = (size_t)1 << between(10, 16);
    bed.poll_ms = 1;
    held.every_us = 1000;
    held.size = 4096;
    held.late_one_in = between(20, 400);
}

/* The program polls rarely, and the ring is large. */
static void draw_rare_polls(void)
{
    bed.poll_ms = one_of((const uint32_t[]){100, 350, 500, 700, 1100}, 5);
    bed.config.rx_size = (size_t)1 << between(13, 16);
}

static void draw_limits(void)
{
    bed.timing.max_pause_ms = (uint16_t)one_of((const uint32_t[]){0, 70, 250}, 3);
    bed.config.rx_size = (size_t)1 << between(11, 16);
    if (one_in(3)) {
        draw_hold_ups();
    }
}

/* A layer below holds all bytes, and the program fetches them only from time to time. */
static void draw_held(void)
{
    feed_by(BLOCKS);
    bed.config.rx_size = 8192;
    held.every_us = 0;
    bed.polls_first = true; /* A useless poll. */
    held.size = 8192;
    bed.poll_ms = between(100, 250);
}

static void draw_everything(void)
{
    if (one_in(4)) {
        draw_stalls();
    }
    draw_overflow();
    if (one_in(4)) {
        draw_held();
    } else if (one_in(4)) {
        draw_hold_ups();
    } else if (one_in(4)) {
        draw_limits();
    }
    if (one_in(8)) {
        bed.config.max_points = between(1, 500);
    }
}

static const campaign_mode_t modes[] = {
    {"healthy", "nothing goes wrong", WHOLE, draw_nothing},
    {"held", "nothing goes wrong; 100 to 250 ms between polls, bytes held below", WHOLE, draw_held},
    {"bridged",
     "nothing goes wrong; the program is busy for as long as a layer below can hold bytes", WHOLE,
     draw_bridged},
    {"pause", "the line falls silent for 0 to 5 turns", LINE, draw_nothing},
    {"hold-up", "the same; polled each millisecond, and what comes is held up for 20 to 95 ms",
     LINE, draw_hold_ups},
    {"rare", "the same; polled each 100 to 1100 ms, ring of 8192 to 65536", LINE, draw_rare_polls},
    {"limits", "the same; max_pause_ms of 0, 70 or 250", LINE, draw_limits},
    {"waiting", "the same, while a layer below holds bytes and reports them", LINE, draw_bridged},
    {"set back", "the same, and once the clock steps back by up to a second", LINE, draw_set_back},
    {"overflow", "the program is busy for 1 to 600 ms, ring of 256 to 8192", OTHER, draw_overflow},
    {"stall", "DMA goes on for 0 to 9 laps while the CPU stands still", OTHER, draw_stalls},
    {"mixed", "all of it at once", LINE, draw_everything},
};

#define MODES (sizeof modes / sizeof modes[0])

/* ---- Time inside tmini_poll() ---- */

/* The CPU stops while DMA receives any number of bytes, often nearly whole laps. */
static bool stalls(void)
{
    const uint32_t lap = (uint32_t)bed.config.rx_size;
    if (!bed.config.rx_dma || !one_in(program.stall_one_in)) {
        return false;
    }
    const uint32_t laps = between(0, MOST_LAPS);
    const uint32_t most = one_in(2) ? lap : 64;
    bed_stall(&bed, laps * (uint64_t)lap + below(most));
    return true;
}

void interrupt(void)
{
    if (!bed.is_polling || now.is_interrupted || program.access_ns == 0) {
        return;
    }
    now.is_interrupted = true;
    if (now.polls != bed.polls) { /* Another poll. */
        now.polls = bed.polls;
        now.accesses = 0;
        now.preempted_at = one_in(program.preempt_one_in) ? between(1, 200) : 0;
    }
    now.ns += program.access_ns;
    bed_pass_us(&bed, now.ns / 1000u);
    now.ns %= 1000u;
    if (++now.accesses == now.preempted_at && !stalls()) {
        bed_pass_us(&bed, between(1, program.preempt_us));
    }
    now.is_interrupted = false;
}

/* ---- What a scan costs and shows ---- */

static bool is_fetched_rarely(void)
{
    return bed.held != NULL && held.every_us == 0;
}

/* True if a poll or a hand-over may come later than the longest pause allowed. */
static bool may_be_late(void)
{
    const uint32_t pause_ms = bed.timing.max_pause_ms;
    return bed.poll_ms > pause_ms || held.every_us > pause_ms * 1000u || held.late_one_in > 0 ||
           is_fetched_rarely() || program.stall_one_in > 0 ||
           (program.handle_one_in > 0 && program.handler_us > pause_ms * 1000u);
}

/* When this sample's packet had come. */
static uint64_t came_us(uint32_t place)
{
    uint32_t i = 0;
    while (i + 1 < watch.count &&
           watch.packets[(watch.first + i + 1) % WATCH_PACKETS].place <= place) {
        i++;
    }
    return watch.packets[(watch.first + i) % WATCH_PACKETS].at_us;
}

static bool is_touched(uint32_t place)
{
    return watch.turns[sim_judge_sample(&watch.judge, place)->turn % WATCH_TURNS].is_touched;
}

/* It is not known here which bytes DMA has overwritten. */
static bool may_be_overwritten(void)
{
    tmini_counters_t counters;
    tmini_counters(&bed.lidar, &counters);
    return bed.config.rx_dma && (counters.bytes_overrun > 0 || bed.gaps > 0);
}

/* Returns why an incomplete scan may have points of two turns: something is lost between them, and
 * the library measures a silence only by the times of polls and hand-overs. SUMS: it may not. */
static sum_t explain(const sim_reading_t *reading)
{
    const uint32_t pause_us = bed.timing.max_pause_ms * 1040u + bed.poll_ms * 1000u +
                              program.preempt_us + (bed.held != NULL ? held.every_us : 0) + 10000u;
    if (!is_touched(reading->before) && !is_touched(reading->odd) && !may_be_overwritten()) {
        return SUMS;
    }
    if (bed.timing.max_pause_ms == 0) {
        return MIXED_UNTIMED;
    }
    if (may_be_late()) {
        return MIXED_UNSEEN;
    }
    return holes_longest_us(came_us(reading->before), came_us(reading->odd)) < pause_us
               ? MIXED_DRIBBLE
               : SUMS;
}

/* While the program works on a scan, DMA may overwrite the packet that ended it and waits to be
 * added to the next one, which then has a gap. Half a lap counts as overwritten. */
static void handle_scan(void)
{
    tmini_counters_t counters;
    const size_t free = held.size - held.count;
    const uint32_t bridged_us = (uint32_t)free * 9 / 10 * BYTE_US;
    const uint32_t most_us =
        program.is_bridged && bridged_us < program.handler_us ? bridged_us : program.handler_us;
    bed_pass_us(&bed, between(1000, most_us > 1000 ? most_us : 1000));
    tmini_counters(&bed.lidar, &counters);
    now.may_have_overwritten |=
        bed.config.rx_dma && counters.bytes_pending + PACKETS_SIZE > bed.config.rx_size / 2;
}

static void see_scan(bed_t *same, sim_reading_t *reading)
{
    const tmini_scan_t *const scan = tmini_scan(&bed.lidar);
    const unsigned mixed = SIM_LIE(SIM_LIE_MIXED);
    const uint32_t turn = sim_judge_sample(&watch.judge, reading->first)->turn;
    bed_tell(same, "scan of turn %u: %u points, %u packets, %u gaps, %u dropped%s", turn,
             scan->count, scan->packets, scan->gaps, scan->dropped,
             scan->complete ? ", complete" : "");
    verdicts.sums[SCANS]++;
    verdicts.sums[COMPLETE] += scan->complete ? 1 : 0;
    if ((reading->lies & mixed) != 0 && !scan->complete && explain(reading) != SUMS) {
        verdicts.sums[explain(reading)]++;
        reading->lies &= ~mixed;
    }
    watch.turns[turn % WATCH_TURNS].is_delivered |= scan->complete && reading->missing == 0;
    if (one_in(program.handle_one_in)) {
        handle_scan();
    }
}

/* ---- A trial ---- */

/* A trial's first and last turns may be incomplete scans: with rare polls and a layer below, the
 * library cannot know how long the line was silent before the first bytes and after the last. At
 * the end, bytes that waited for room come after the line is silent. */
#define UNCERTAIN_MS 250u
#define WATCHED_MS 30u

static bool is_certain(uint32_t turn)
{
    const uint32_t turn_ms = holes.turn_us / 1000u;
    const uint32_t waits_ms = held.ignores_room ? 0 : (uint32_t)held.size * BYTE_US / 1000u;
    const uint32_t look_ms = bed.poll_ms > UNCERTAIN_MS ? bed.poll_ms : UNCERTAIN_MS;
    const bool is_watched = bed.poll_ms <= WATCHED_MS && !is_fetched_rarely();
    return turn > (is_watched ? 0 : look_ms / turn_ms + 2) &&
           turn + 2 + (look_ms + waits_ms) / turn_ms < holes.turns;
}

static void judge_cost(void)
{
    for (uint32_t i = 0; i < holes.turns; i++) {
        const watch_turn_t *const turn = &watch.turns[i];
        if (!turn->is_touched && turn->samples <= bed.config.max_points && is_certain(i)) {
            verdicts.sums[UNTOUCHED]++;
            if (!turn->is_delivered) {
                watch_complain(&bed, WRONG_COST);
            }
        }
    }
}

static void judge_end(void)
{
    const watch_end_t end = watch_end(&bed);
    tmini_counters_t counters;
    tmini_counters(&bed.lidar, &counters);
    if (may_be_overwritten()) {
        return;
    }
    judge_cost();
    if (bed.events[TMINI_EVENT_LOST] > 0 || bed.config.max_points < POINTS) {
        return;
    }
    verdicts.sums[INTACT] += end.intact;
    verdicts.sums[IN_ONE] += end.in_one;
    verdicts.sums[WITHHELD] += counters.points_withheld;
    if (end.intact - end.in_one > counters.points_withheld && !now.may_have_overwritten) {
        watch_complain(&bed, WRONG_LOST_PACKET);
    }
}

static void begin_trial(const campaign_mode_t *mode, bool is_told)
{
    memset(&program, 0, sizeof program);
    memset(&now, 0, sizeof now);
    memset(&held, 0, offsetof(bed_held_t, bytes));
    memset(&watch, 0, sizeof watch);
    bed_prepare(&bed);
    bed.is_told = is_told;
    bed.grain_us = GRAIN_US;
    bed.watch = &watch;
    bed.config.rx_buffer = rx;
    bed.config.points = points;
    bed.config.max_points = POINTS;
    bed.config.recovery = TMINI_RECOVERY_OFF;
    const sim_config_t lidar = draw_lidar();
    const uint32_t turns = between(10, MOST_TURNS);
    draw_program();
    mode->draw();
    held.is_mute = held.is_mute && held.ignores_room; /* tmini_feed() requires this. */
    holes_begin(mode->losses == LINE ? between(1, MOST_HOLES) : 0, turns,
                100000000u / lidar.frequency_chz);
    watch.line = sim_link_default_config();
    watch.is_trial = true;
    watch.may_lose = true;
    watch.loses = holes_take;
    watch.on_scan = see_scan;
    if (!bed_init(&bed, &lidar)) {
        abort();
    }
}

static void tell_settings(void)
{
    bed_tell(&bed, "%u turns of %u us, %s, ring %zu, polled every %u ms, %zu held, every %u us",
             holes.turns, holes.turn_us,
             bed.config.rx_dma  ? "DMA"
             : bed.held != NULL ? "blocks"
                                : "bytes",
             bed.config.rx_size, bed.poll_ms, held.size, held.every_us);
    bed_tell(&bed, "busy for %u us, one scan in %u; clock %d ppm, back by %u ms; max_pause_ms %u",
             program.handler_us, program.handle_one_in, (int)bed.clock_ppm, bed.back_ms,
             bed.timing.max_pause_ms);
}

/* The driver starts the lidar; only then the trial's settings hold. */
static void start(void)
{
    const uint32_t poll_ms = bed.poll_ms;
    const uint32_t access_ns = program.access_ns;
    bed.poll_ms = 1;
    program.access_ns = 0;
    (void)bed_start(&bed);
    while (bed.heard.starts == 0) {
        if (bed_ms(&bed) >= 10000) {
            (void)fprintf(stderr, "campaign: the driver does not start the lidar\n");
            exit(1);
        }
        bed_step(&bed);
    }
    bed.poll_ms = poll_ms;
    program.access_ns = access_ns;
    bed.back_at_us += bed.now_us;
}

/* It is polled often enough to give up what is left of a packet. */
static void be_silent(void)
{
    const uint32_t poll_ms = bed.poll_ms;
    program.access_ns = 0;
    bed.poll_ms = 10;
    for (uint32_t ms = 0; ms < SILENCE_MS + bed.back_ms; ms += bed.poll_ms) {
        bed_step(&bed); /* Work on a scan takes more time. */
    }
    bed.poll_ms = poll_ms;
}

static void run_trial(const campaign_mode_t *mode, uint64_t seed, uint64_t trial, bool is_told)
{
    random_seed(&dice, seed * 1000003u + trial);
    begin_trial(mode, is_told);
    tell_settings();
    start();
    while ((!holes.is_over && sim_mode(&bed.sim) == SIM_SCANNING) || held.count > 0) {
        bed_step(&bed);
        (void)stalls();
    }
    be_silent();
    judge_end();
    for (unsigned wrong = 0; wrong < WRONG_KINDS; wrong++) {
        if (verdicts.wrongs[wrong] == 0) {
            verdicts.first_trial[wrong] = trial;
        }
        verdicts.wrongs[wrong] += watch.counts.wrongs[wrong];
    }
}

/* ---- Reports ---- */

static uint64_t wrongs_of(const campaign_mode_t *mode)
{
    uint64_t wrongs = 0;
    for (unsigned wrong = 0; wrong < WRONG_KINDS; wrong++) {
        /* With all at once, half a packet may be held for longer than frame_timeout_ms. */
        const bool is_unjudged = (wrong == WRONG_COST && mode->losses != WHOLE) ||
                                 (wrong == WRONG_LOST_PACKET && mode->draw == draw_everything);
        wrongs += is_unjudged ? 0 : verdicts.wrongs[wrong];
    }
    return wrongs;
}

static void report(const campaign_mode_t *mode)
{
    printf("%s: %s\n", mode->name, mode->what);
    for (unsigned sum = 0; sum < SUMS; sum++) {
        printf("  %12llu %s\n", (unsigned long long)verdicts.sums[sum], sum_names[sum]);
    }
    for (unsigned wrong = 0; wrong < WRONG_KINDS; wrong++) {
        printf("  %12llu %s", (unsigned long long)verdicts.wrongs[wrong], watch_name(wrong));
        if (verdicts.wrongs[wrong] > 0) {
            printf(" (first in trial %llu)", (unsigned long long)verdicts.first_trial[wrong]);
        }
        printf("\n");
    }
    (void)fflush(stdout);
}

static bool run_mode(const campaign_mode_t *mode, uint64_t scans, uint64_t seed, const char *only)
{
    memset(&verdicts, 0, sizeof verdicts);
    if (only != NULL) {
        run_trial(mode, seed, strtoull(only, NULL, 10), true);
    } else {
        for (uint64_t trial = 0; verdicts.sums[SCANS] < scans && wrongs_of(mode) < MOST_WRONGS;
             trial++) {
            run_trial(mode, seed, trial, false);
        }
    }
    report(mode);
    return wrongs_of(mode) == 0;
}

int main(int argc, char **argv)
{
    const uint64_t scans = argc > 1 ? strtoull(argv[1], NULL, 10) : 0;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    bool found = false;
    bool honest = true;
    if (argc > 1 && strcmp(argv[1], "soak") == 0) {
        return soak(argc - 1, argv + 1);
    }
    for (size_t i = 0; scans > 0 && i < MODES; i++) {
        if (argc <= 3 || strcmp(argv[3], modes[i].name) == 0 || strcmp(argv[3], "all") == 0) {
            found = true;
            honest &= run_mode(&modes[i], scans, seed, argc > 4 ? argv[4] : NULL);
        }
    }
    if (!found) {
        (void)fprintf(stderr, "usage: campaign SCANS [SEED [MODE [TRIAL]]]\n"
                              "       campaign soak HOURS [SEED]\n");
        return 2;
    }
    return honest ? 0 : 1;
}
