/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini check: are the lidar, its wires and its supply in order? Prints a line per question and one
 * verdict. */

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tmini/tmini_names.h"
#include "device.h"
#include "interrupt.h"
#include "mount.h"
#include "output.h"
#include "points.h"

#define WATCH_SECONDS 10u
#define REST_MS 100u
#define COLUMNS 80
#define INDENT 17 /* The column after the grade and the question's name. */

/* Limits, in this order: damaged packets per thousand; the motor's deviation in percent (real units
 * set to 6 Hz have been seen at 5.8 to 6.5); the motor's time to reach its speed; the longest pause
 * between two packets (normal: 10 ms); points with a distance, in percent. */
#define DAMAGED_PERMILLE 10u
#define SPEED_REMARK_PERCENT 10u
#define SPEED_PERCENT 25u
#define SPIN_UP_MS 3000u
#define PAUSE_MS 60u
#define FEW_PERCENT 10u

typedef enum { GOOD, REMARK, BAD, GRADES } grade_t;

/* What was seen, and what to do unless the grade is good; `headline` explains the name. */
typedef struct {
    grade_t grade;
    const char *name;
    const char *headline;
    const char *advice;
    char text[CAUSE_TEXT_SIZE];
} answer_t;

#define ANSWERS_MAX 16u

typedef struct {
    device_t *device; /* NULL: there is no port. */
    unsigned seconds;
    unsigned set_chz; /* The scan frequency; 0: not reported. */
    uint32_t start_ms;
    uint32_t full_speed_ms; /* When the motor reached its speed; 0: not yet. */
    unsigned speed_chz;     /* Of the latest scan. */
    unsigned idle_faults;   /* Faults reported before scanning. */
    unsigned faults;        /* Faults reported since. */
    count_t points;
    count_t valid;
    uint32_t longest_ms;         /* The longest time without a byte. */
    unsigned turns, blind_turns; /* Blind: without one distance. */
    tmini_point_t nearest;       /* Of the latest scan; a distance of 0: none. */
    answer_t answers[ANSWERS_MAX];
    size_t answer_count;
} check_t;

/* Prints a text after INDENT columns, in lines of at most COLUMNS. */
static void print_indented(const char *text)
{
    size_t column = INDENT;
    for (const char *word = text; *word != '\0'; word += *word != '\0' ? 1 : 0) {
        const size_t length = strcspn(word, " \n");
        const bool is_new_line = word > text && (word[-1] == '\n' || column + 1 + length > COLUMNS);
        const int gap = is_new_line ? INDENT : word > text ? 1 : 0;
        (void)printf("%s%*s%.*s", is_new_line ? "\n" : "", gap, "", (int)length, word);
        column = (is_new_line ? 0 : column) + (size_t)gap + length;
        word += length;
    }
    (void)putchar('\n');
}

static void print_answer(const answer_t *answer)
{
    static const char *const words[GRADES] = {"ok", "look", "BAD"};
    (void)printf("%-5s %-10s ", words[answer->grade], answer->name);
    print_indented(answer->text);
    if (answer->advice != NULL && answer->grade != GOOD) {
        (void)printf("%*s", INDENT, "");
        print_indented(answer->advice);
    }
}

/* The answer to a question. */
static void answer(check_t *check, grade_t grade, const char *name, const char *advice,
                   const char *format, ...)
{
    answer_t *const answer = &check->answers[check->answer_count++];
    *answer = (answer_t){.grade = grade, .name = name, .advice = advice};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(answer->text, sizeof answer->text, format, arguments);
    va_end(arguments);
}

static grade_t grade(bool is_bad, bool is_remarkable)
{
    return is_bad ? BAD : is_remarkable ? REMARK : GOOD;
}

static void answer_cause(check_t *check, const cause_t *cause, const facts_t *facts)
{
    char text[CAUSE_TEXT_SIZE];
    answer(check, BAD, cause->name, cause->advice, "%s", cause_text(cause, facts, text));
    check->answers[check->answer_count - 1].headline = cause->headline;
}

/* The lidar does not do what was expected. Returns false if nothing shows why. */
static bool answer_trouble(check_t *check)
{
    device_t *const device = check->device;
    facts_t facts;
    if (device->port.state != TMINI_POSIX_OK) {
        answer(check, BAD, "port", "plug it in again; give the lidar a supply of its own",
               "it has gone: unplugged, or its supply has failed");
        return true;
    }
    device_facts(device, &facts);
    const cause_t *const cause = cause_find(&facts);
    if (cause != NULL && cause->text != NULL) {
        answer_cause(check, cause, &facts);
    }
    return cause != NULL && cause->text != NULL;
}

static void answer_info(check_t *check)
{
    const device_t *const device = check->device;
    const tmini_info_t *const info = tmini_info(&device->lidar);
    const bool is_known =
        info->model == TMINI_MODEL_T_MINI_PLUS || info->model == TMINI_MODEL_T_MINI_PRO;
    char serial[TMINI_SERIAL_DIGITS + 1];
    char late[60] = "";
    tmini_serial_text(info, serial);
    if (device->woken_ms > 0) {
        (void)snprintf(late, sizeof late, "; it answered after %.1f s: it was still booting",
                       device->woken_ms / 1000.0);
    }
    answer(check, grade(false, !is_known), "answers",
           info->model == 152 ? model_text(info->model)
                              : "this program does not know the model: it may speak another "
                                "protocol",
           "model %d, firmware %d.%d, hardware %d, serial %s%s", info->model, info->firmware_major,
           info->firmware_minor, info->hardware, serial, late);
}

/* Returns false if the lidar does not answer at all. */
static bool ask_info(check_t *check)
{
    if (device_ask(check->device, tmini_request_info, TMINI_EVENT_INFO)) {
        answer_info(check);
        return true;
    }
    if (!answer_trouble(check)) {
        answer(check, BAD, "answers", "try again; or cut the lidar's supply for a moment",
               "no device information");
    }
    return false;
}

static const char *advice_for(unsigned faults)
{
    return (faults & TMINI_FAULT_ENCODER) != 0
               ? "let the rotor turn freely: a hair, a cable, the housing? Then start again"
           : (faults & TMINI_FAULT_DATA) != 0
               ? "uncover or clean the window; an open space of 12 m is no fault"
               : "cut the supply for a moment; if it stays, the unit is broken: ask its maker";
}

static const char not_known[] = "its firmware may not know the question";

static void ask_health(check_t *check)
{
    device_t *const device = check->device;
    char text[FAULTS_TEXT_SIZE];
    if (!device_await(device, tmini_request_health(&device->lidar), TMINI_EVENT_HEALTH)) {
        answer(check, REMARK, "health", not_known, "not answered");
        return;
    }
    check->idle_faults = tmini_health(&device->lidar)->faults;
    answer(check, grade(check->idle_faults != 0, false), "health", advice_for(check->idle_faults),
           "%s", faults_text(check->idle_faults, text));
}

static void ask_frequency(check_t *check)
{
    device_t *const device = check->device;
    if (device_await(device, tmini_request_frequency(&device->lidar), TMINI_EVENT_FREQUENCY)) {
        check->set_chz = tmini_frequency_chz(&device->lidar);
    } else {
        answer(check, REMARK, "frequency", not_known, "not answered");
    }
}

/* False for directions in which the lidar sees the robot itself: such points are not counted as
 * missing. */
static bool is_seen(const check_t *check, const tmini_point_t *point)
{
    const tmini_mount_t *const mount = check->device->stream.mount;
    return mount == NULL || !mount_hides(mount, point->angle_q6);
}

/* A packet alone says nothing about a turn. */
#define TURN_POINTS 100u

static void see_scan(check_t *check)
{
    const tmini_scan_t *const scan = &check->device->stream.scan;
    const unsigned nearly_chz = check->set_chz - check->set_chz * SPEED_REMARK_PERCENT / 100;
    const survey_t survey = points_survey(scan->points, scan->count);
    for (size_t i = 0; i < scan->count; i++) {
        check->points += is_seen(check, &scan->points[i]) ? 1 : 0;
    }
    check->valid += survey.valid;
    check->turns += scan->count >= TURN_POINTS ? 1 : 0;
    check->blind_turns += scan->count >= TURN_POINTS && survey.valid == 0 ? 1 : 0;
    check->nearest = survey.nearest != NULL ? *survey.nearest : (tmini_point_t){0};
    check->speed_chz = scan->frequency_chz > 0 ? scan->frequency_chz : check->speed_chz;
    if (check->full_speed_ms == 0 && check->speed_chz > 0 && check->speed_chz >= nearly_chz) {
        check->full_speed_ms = device_ms(check->device);
    }
}

/* Takes the packets that have come and that the driver has not yet reported. */
static void take_rest(device_t *device)
{
    const uint32_t begun_ms = device_ms(device);
    count_t before = 0;
    tmini_event_t event = TMINI_EVENT_NONE;
    do {
        before = device->witness.tape.stream.packets;
        event = device_wait(device, 1);
    } while ((event != TMINI_EVENT_NONE || device->witness.tape.stream.packets > before) &&
             device_ms(device) - begun_ms < REST_MS);
}

static void watch(check_t *check)
{
    device_t *const device = check->device;
    const uint32_t begun_ms = device_ms(device);
    while (device_is_usable(device) && device_ms(device) - begun_ms < check->seconds * 1000) {
        if (device_wait(device, 50) == TMINI_EVENT_SCAN) {
            see_scan(check);
        }
        check->faults |= tmini_faults(&device->lidar);
        message_progress(false, "%2u s of %u, %llu packets",
                         (unsigned)(device_ms(device) - begun_ms) / 1000, check->seconds,
                         device->stream.packets);
    }
    take_rest(device);
    check->longest_ms = device->witness.longest_ms;
    message_progress(true, "%u s watched, %llu packets",
                     (unsigned)(device_ms(device) - begun_ms) / 1000, device->stream.packets);
}

static void judge_supply(check_t *check)
{
    static const char advice[] =
        "a supply of its own (5 V, up to 1 A) and short wires; a loose plug does the same";
    const device_t *const device = check->device;
    const double full_speed_s = check->full_speed_ms / 1000.0;
    if (device->port.state != TMINI_POSIX_OK) {
        answer(check, BAD, "supply", advice, "the port went away while the motor was on");
    } else if (device->silences > 0) {
        answer(check, BAD, "supply", advice, "the lidar fell silent %u time%s in %u s",
               (unsigned)device->silences, device->silences == 1 ? "" : "s", check->seconds);
    } else if (check->full_speed_ms > SPIN_UP_MS && device->noises == 0) {
        answer(check, REMARK, "supply", advice, "the motor took %.1f s to come up to speed",
               full_speed_s);
    } else {
        char until[40] = "";
        if (check->full_speed_ms > 0 &&
            ((check->faults | check->idle_faults) & TMINI_FAULT_ENCODER) == 0) {
            (void)snprintf(until, sizeof until, ", full speed after %.1f s", full_speed_s);
        }
        answer(check, GOOD, "supply", NULL, "no restart; first packet after %.2f s%s",
               check->start_ms / 1000.0, until);
    }
}

/* What is lost or wrong in the bytes themselves, whenever they came. */
static void judge_line(check_t *check)
{
    device_t *const device = check->device;
    const stream_t *const stream = &device->witness.tape.stream;
    const bool is_noisy = device->noises > 0;
    const bool is_bad = is_noisy || stream_damaged_permille(stream) >= DAMAGED_PERMILLE;
    facts_t facts;
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    device_facts(device, &facts);
    facts.has_replied = true; /* Or it listens. */
    const cause_t *const cause = cause_find(&facts);
    const bool is_sign = is_bad && cause != NULL && cause->is_sign;
    if (is_sign) {
        answer_cause(check, cause, &facts);
    }
    answer(check, grade(is_bad, stream->damaged > 0), "line",
           is_noisy ? "bytes came that no lidar sends: a wrong baud rate for a while, GND, "
                      "interference"
           : cause != NULL && !is_sign ? cause->advice
                                       : NULL,
           "%s of %llu packets damaged, %u wrong checksums", damaged_text(stream), stream->packets,
           (unsigned)tape_checksum_errors(&device->witness.tape));
    if (counters.bytes_overrun > 0) {
        answer(check, REMARK, "computer", "end other programs", "%u bytes lost here: too busy",
               (unsigned)counters.bytes_overrun);
    }
}

static bool was_lost(const device_t *device)
{
    return device->silences + device->noises > 0;
}

/* When the bytes came. A program that does not run receives nothing, either. */
static void judge_pace(check_t *check)
{
    const device_t *const device = check->device;
    const uint32_t longest_ms = check->longest_ms;
    const count_t witnessed = device->witness.tape.stream.packets - device->witness.packets_before;
    const count_t late =
        witnessed > device->stream.packets ? witnessed - device->stream.packets : 0;
    char halves[80] = "";
    if (longest_ms <= PAUSE_MS || was_lost(device)) {
        return;
    }
    if (2 * device->absent_ms > longest_ms) {
        answer(check, REMARK, "computer", "end other programs",
               "too busy: this program did not run for %u ms", (unsigned)device->absent_ms);
        return;
    }
    if (late > 0) {
        (void)snprintf(halves, sizeof halves, "; late halves of %llu packet%s were dropped", late,
                       late == 1 ? "" : "s");
    }
    answer(check, REMARK, "pace",
           strncmp(device->path, "tcp:", 4) == 0
               ? "nothing is lost: the network or the bridge delivers late (Wi-Fi power saving, "
                 "many small packets)"
               : "nothing is lost on the line; for fresher data: the adapter's latency timer, no "
                 "USB hub, a less busy computer",
           "bytes come in bursts, up to %u ms apart%s", (unsigned)longest_ms, halves);
}

static void judge_speed(check_t *check)
{
    const unsigned faults = check->faults | check->idle_faults;
    const unsigned set_chz = check->set_chz;
    const unsigned speed_chz = check->speed_chz;
    const unsigned off_chz = set_chz > speed_chz ? set_chz - speed_chz : speed_chz - set_chz;
    const unsigned percent = set_chz > 0 ? off_chz * 100 / set_chz : 0;
    const bool is_slow = speed_chz < set_chz;
    const bool is_blocked = (faults & TMINI_FAULT_ENCODER) != 0; /* This has been reported. */
    const bool comes_up = is_slow && check->full_speed_ms != 0 && was_lost(check->device);
    if (speed_chz == 0) {
        answer(check, BAD, "frequency", "does it turn? Is something in its way?",
               "no revolution was completed");
    } else if (is_blocked || comes_up) {
        return;
    } else if (set_chz == 0) {
        answer(check, GOOD, "frequency", NULL, "%.1f Hz measured", speed_chz / 100.0);
    } else {
        const grade_t how = grade(percent > SPEED_PERCENT, percent > SPEED_REMARK_PERCENT);
        answer(check, how, "frequency",
               is_slow ? "the supply may be weak, or something may brake the rotor"
                       : "its speed control has failed; no supply and no brake does that",
               "%.1f Hz measured, %.1f Hz set%s", speed_chz / 100.0, set_chz / 100.0,
               how == GOOD ? ""
               : is_slow   ? ": it turns too slowly"
                           : ": it turns too fast");
    }
}

/* Faults found before scanning have been printed already. */
static void judge_scans(check_t *check)
{
    char text[FAULTS_TEXT_SIZE];
    const unsigned percent = check->points > 0 ? (unsigned)(check->valid * 100 / check->points) : 0;
    if ((check->faults & ~check->idle_faults) != 0) {
        answer(check, BAD, "faults", advice_for(check->faults), "%s",
               faults_text(check->faults, text));
    }
    if (check->faults == 0) {
        answer(check, GOOD, "faults", NULL, "%s", health_text(&check->device->stream, text));
    }
    if (check->faults == 0 && check->blind_turns > 0 && check->valid > 0) {
        answer(check, grade(check->blind_turns * 10 >= check->turns, true), "ranges",
               "something covers the window at times, or the laser fails: a supply of its own; if "
               "it stays, the unit is broken",
               "%u of %u turns saw nothing; %u %% of all points valid", check->blind_turns,
               check->turns, percent);
    } else if (check->faults == 0 && check->points > 0) {
        answer(check, grade(check->valid == 0, percent < FEW_PERCENT), "ranges",
               "uncover or clean the window; or there is nothing within 12 m", "%u %% valid%s%s",
               percent, check->nearest.distance_mm > 0 ? "; nearest " : "",
               check->nearest.distance_mm > 0 ? place_text(&check->nearest) : "");
    }
}

/* If bytes come so late, those after a stop may have been on their way. */
#define LATE_MS 200u

static void judge_stop(check_t *check)
{
    static const char advice[] = "check the wire from the adapter's TX to the lidar's RX";
    device_t *const device = check->device;
    if (device->port.state != TMINI_POSIX_OK || device->listens) {
        return;
    }
    if (!device_stop(device)) {
        answer(check, BAD, "stop", advice, "the lidar does not stop");
    } else if (device->strays > 0 && check->longest_ms < LATE_MS) {
        answer(check, REMARK, "stop", advice, "the lidar went on after it had been stopped");
    }
}

/* The names of the answers with that grade; the first one's headline explains it. */
static void print_names(const check_t *check, grade_t wanted)
{
    const char *headline = NULL;
    const char *comma = "";
    for (size_t i = 0; i < check->answer_count; i++) {
        const answer_t *const one = &check->answers[i];
        if (one->grade == wanted) {
            (void)printf("%s%s", comma, one->name);
            comma = ", ";
            headline = headline == NULL ? one->headline : headline;
        }
    }
    (void)printf(headline != NULL ? " (%s)\n" : "\n", headline);
}

/* The verdict comes first, then the worst answers. */
static int conclude(const check_t *check)
{
    static const char *const verdicts[GRADES] = {"good\n", "usable, but look at: ", "not good: "};
    grade_t worst = GOOD;
    for (size_t i = 0; i < check->answer_count; i++) {
        worst = check->answers[i].grade > worst ? check->answers[i].grade : worst;
    }
    if (interrupt_has_come()) {
        return message_fail("interrupted: no verdict");
    }
    (void)printf("verdict: %s", verdicts[worst]);
    if (worst != GOOD) {
        print_names(check, worst);
    }
    for (int shown = BAD; shown >= GOOD; shown--) {
        for (size_t i = 0; i < check->answer_count; i++) {
            if (check->answers[i].grade == (grade_t)shown) {
                print_answer(&check->answers[i]);
            }
        }
    }
    return worst == BAD ? STATUS_FAILED : STATUS_OK;
}

/* Returns false if the lidar does not answer at all. */
static bool ask(check_t *check)
{
    if (check->device->listens) {
        return true;
    }
    if (!ask_info(check)) {
        return false;
    }
    ask_health(check);
    ask_frequency(check);
    return true;
}

static void examine(check_t *check)
{
    device_t *const device = check->device;
    answer(check, GOOD, "port", NULL, "%s", device->path);
    if (!ask(check)) {
        return;
    }
    message_note(device->listens ? "listening for %u s …" : "scanning for %u s …", check->seconds);
    device_begin(device);
    if (!device_await(device, tmini_start(&device->lidar), TMINI_EVENT_STARTED)) {
        if (answer_trouble(check)) {
            return;
        }
        answer(check, BAD, "start", "its supply may fail when the motor starts (5 V, up to 1 A)",
               "it answers, but does not scan");
        return;
    }
    check->start_ms = device_ms(device);
    watch(check);
    judge_supply(check);
    judge_line(check);
    judge_pace(check);
    judge_speed(check);
    judge_scans(check);
    judge_stop(check);
}

static check_t check;

static int run_check(device_t *device, const options_t *options)
{
    check.device = device;
    check.seconds = options->seconds > 0 ? options->seconds : WATCH_SECONDS;
    device->is_secretive = true; /* This command itself reports what happens. */
    examine(&check);
    return conclude(&check);
}

static int run(const options_t *options)
{
    const int status = device_use(options, run_check);
    if (check.device == NULL) {
        (void)puts("verdict: none, because there is no port to look at");
    }
    return status;
}

const command_t command_check = {
    .name = "check",
    .usage = "[-p PORT] [--seconds N] [--listen] [--front DEG] [--upside-down]\n"
             "            [--offset MM] [--mask FROM:TO]",
    .summary = "ten seconds, one verdict: port, wires, supply, lidar",
    .details = "A line per question: ok; look (it works, but could be better); BAD. After each\n"
               "that is not ok, what to do about it. Watches for 10 seconds, or N. Exit status\n"
               "1 if anything is BAD.",
    .accepts = "psLFUOKq",
    .run = run,
};
