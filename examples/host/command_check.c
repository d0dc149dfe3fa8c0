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
    tmini_point_t nearest;   /* Of the latest scan; a distance of 0: none. */
    char names[GRADES][160]; /* The questions with each grade. */
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

/* Prints the answer to a question: what was seen and, unless the grade is good, what to do. */
static void answer(check_t *check, grade_t grade, const char *name, const char *advice,
                   const char *format, ...)
{
    static const char *const words[GRADES] = {"ok", "look", "BAD"};
    char *const names = check->names[grade];
    const size_t length = strlen(names);
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)printf("%-5s %-10s ", words[grade], name);
    print_indented(text);
    if (advice != NULL && grade != GOOD) {
        (void)printf("%*s", INDENT, "");
        print_indented(advice);
    }
    (void)fflush(stdout); /* The next answer may take some seconds. */
    (void)snprintf(names + length, sizeof check->names[grade] - length, "%s%s",
                   length > 0 ? ", " : "", name);
}

static grade_t grade(bool is_bad, bool is_remarkable)
{
    return is_bad ? BAD : is_remarkable ? REMARK : GOOD;
}

static void answer_trouble(check_t *check, const char *missing)
{
    static const char *const names[] = {"wiring", "baud", "command", "answers"};
    const device_t *const device = check->device;
    if (device->port.state != TMINI_POSIX_OK) {
        answer(check, BAD, "port", "plug it in again; give the lidar a supply of its own",
               "it has gone: unplugged, or its supply has failed");
    } else {
        const trouble_t trouble = trouble_find(device);
        answer(check, BAD, names[trouble], trouble_text(trouble), "%s", missing);
    }
}

/* Returns false if the lidar does not answer at all. */
static bool ask_info(check_t *check)
{
    device_t *const device = check->device;
    if (device_await(device, tmini_request_info(&device->lidar), TMINI_EVENT_INFO)) {
        const tmini_info_t *const info = tmini_info(&device->lidar);
        const bool is_known =
            info->model == TMINI_MODEL_T_MINI_PLUS || info->model == TMINI_MODEL_T_MINI_PRO;
        char serial[TMINI_SERIAL_DIGITS + 1];
        tmini_serial_text(info, serial);
        answer(check, grade(false, !is_known), "answers",
               "this program does not know the model: it may speak another protocol",
               "model %d, firmware %d.%d, hardware %d, serial %s", info->model,
               info->firmware_major, info->firmware_minor, info->hardware, serial);
        return true;
    }
    answer_trouble(check, "no device information");
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

static void see_scan(check_t *check)
{
    const tmini_scan_t *const scan = &check->device->stream.scan;
    const unsigned nearly_chz = check->set_chz - check->set_chz * SPEED_REMARK_PERCENT / 100;
    const survey_t survey = points_survey(scan->points, scan->count);
    for (size_t i = 0; i < scan->count; i++) {
        check->points += is_seen(check, &scan->points[i]) ? 1 : 0;
    }
    check->valid += survey.valid;
    check->nearest = survey.nearest != NULL ? *survey.nearest : (tmini_point_t){0};
    check->speed_chz = scan->frequency_chz > 0 ? scan->frequency_chz : check->speed_chz;
    if (check->full_speed_ms == 0 && check->speed_chz > 0 && check->speed_chz >= nearly_chz) {
        check->full_speed_ms = device_ms(check->device);
    }
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
        answer(check, BAD, "supply", advice, "the lidar fell silent %u times in %u s",
               (unsigned)device->silences, check->seconds);
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

static void judge_line(check_t *check)
{
    const device_t *const device = check->device;
    const stream_t *const stream = &device->stream;
    const bool is_noisy = device->noises > 0;
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    answer(
        check,
        grade(is_noisy || stream_damaged_permille(stream) >= DAMAGED_PERMILLE, stream->damaged > 0),
        "line",
        is_noisy
            ? "bytes came that no lidar sends: a wrong baud rate for a while, GND, interference"
            : "shorter wires, GND beside them, away from motors; another adapter; 3.3 V levels",
        "%s of %llu packets damaged, %u wrong checksums", damaged_text(stream), stream->packets,
        (unsigned)counters.checksum_errors);
    if (counters.bytes_overrun > 0) {
        answer(check, REMARK, "computer", "end other programs", "%u bytes lost here: too busy",
               (unsigned)counters.bytes_overrun);
    }
    if (stream->longest_ms > PAUSE_MS && device->silences + device->noises == 0) {
        answer(check, REMARK, "pace",
               "nothing is lost; for fresher data: the adapter's latency timer, no USB hub, "
               "a less busy computer",
               "packets came up to %u ms late", (unsigned)stream->longest_ms);
    }
}

static void judge_speed(check_t *check)
{
    const unsigned faults = check->faults | check->idle_faults;
    const unsigned set_chz = check->set_chz;
    const unsigned speed_chz = check->speed_chz;
    const unsigned off_chz = set_chz > speed_chz ? set_chz - speed_chz : speed_chz - set_chz;
    const unsigned percent = set_chz > 0 ? off_chz * 100 / set_chz : 0;
    if (speed_chz == 0) {
        answer(check, BAD, "frequency", "does it turn? Is something in its way?",
               "no revolution was completed");
    } else if ((faults & TMINI_FAULT_ENCODER) != 0) {
        return; /* The rotor is blocked, which has been reported. */
    } else if (set_chz == 0) {
        answer(check, GOOD, "frequency", NULL, "%.1f Hz measured", speed_chz / 100.0);
    } else {
        answer(check, grade(percent > SPEED_PERCENT, percent > SPEED_REMARK_PERCENT), "frequency",
               "the supply may be weak, or something may brake the rotor",
               "%.1f Hz measured, %.1f Hz set", speed_chz / 100.0, set_chz / 100.0);
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
    if (check->faults == 0 && check->points > 0) {
        answer(check, grade(check->valid == 0, percent < FEW_PERCENT), "ranges",
               "uncover or clean the window; or there is nothing within 12 m", "%u %% valid%s%s",
               percent, check->nearest.distance_mm > 0 ? "; nearest " : "",
               check->nearest.distance_mm > 0 ? place_text(&check->nearest) : "");
    }
}

static void judge_stop(check_t *check)
{
    static const char advice[] = "check the wire from the adapter's TX to the lidar's RX";
    device_t *const device = check->device;
    if (device->port.state != TMINI_POSIX_OK || device->listens) {
        return;
    }
    if (!device_stop(device)) {
        answer(check, BAD, "stop", advice, "the lidar does not stop");
    } else if (device->strays > 0) {
        answer(check, REMARK, "stop", advice, "the lidar went on after it had been stopped");
    }
}

static int conclude(const check_t *check)
{
    static const char *const verdicts[GRADES] = {"good", "usable, but look at: ", "not good: "};
    const grade_t worst = grade(check->names[BAD][0] != '\0', check->names[REMARK][0] != '\0');
    if (interrupt_has_come()) {
        return message_fail("interrupted: no verdict");
    }
    (void)printf("verdict: %s%s\n", verdicts[worst], worst == GOOD ? "" : check->names[worst]);
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
        if (device->listens) {
            answer_trouble(check, "no packet; has another program or controller started it?");
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
