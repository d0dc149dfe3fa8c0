/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini check: is this lidar, with its wires and its supply, fit for use? A line a question, and
 * one verdict. */

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "interrupt.h"
#include "message.h"
#include "points.h"

#define WATCH_SECONDS 10u

/* Tolerances: damaged packets in a thousand; a motor's deviation in percent (real units at 6 Hz are
 * told of at 5.8 to 6.5); the motor's time to its speed; the longest pause between two packets,
 * which are 10 ms apart; points with a distance, in percent. */
#define DAMAGED_PERMILLE 10u
#define SPEED_REMARK_PERCENT 10u
#define SPEED_PERCENT 25u
#define SPIN_UP_MS 3000u
#define PAUSE_MS 60u
#define FEW_PERCENT 10u

typedef enum { GOOD, REMARK, BAD, GRADES } grade_t;

typedef struct {
    device_t *device;
    unsigned seconds;
    unsigned set_chz; /* The scan frequency; 0: not told. */
    uint32_t start_ms;
    uint32_t full_speed_ms; /* 0: not reached. */
    unsigned speed_chz;     /* Of the latest scan. */
    unsigned idle_faults;   /* Told before scanning, */
    unsigned faults;        /* and since. */
    uint64_t points;
    uint64_t valid;
    char remarks[160]; /* The names of the questions with this answer. */
    char bads[160];
} check_t;

static const char *const grade_names[GRADES] = {"ok", "look", "BAD"};

/* Answers a question: what was seen, and what to do about it, or NULL. */
static void answer(check_t *check, grade_t grade, const char *name, const char *advice,
                   const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)printf("%-5s %-10s ", grade_names[grade], name);
    (void)vprintf(format, arguments);
    (void)putchar('\n');
    va_end(arguments);
    for (const char *line = advice; line != NULL && grade != GOOD; line = strchr(line, '\n')) {
        line += line[0] == '\n' ? 1 : 0;
        (void)printf("                 %.*s\n", (int)strcspn(line, "\n"), line);
    }
    (void)fflush(stdout); /* The next one may take some seconds. */
    if (grade != GOOD) {
        char *const list = grade == BAD ? check->bads : check->remarks;
        const size_t length = strlen(list);
        (void)snprintf(list + length, sizeof check->bads - length, "%s%s", length > 0 ? ", " : "",
                       name);
    }
}

/* Returns false if the lidar does not answer at all. */
static bool ask_info(check_t *check)
{
    device_t *const device = check->device;
    char serial[TMINI_SERIAL_DIGITS + 1];
    const bool answers = device_await(device, tmini_request_info(&device->lidar), TMINI_EVENT_INFO);
    if (answers) {
        const tmini_info_t *const info = tmini_info(&device->lidar);
        const bool is_known =
            info->model == TMINI_MODEL_T_MINI_PLUS || info->model == TMINI_MODEL_T_MINI_PRO;
        tmini_serial_text(info, serial);
        answer(check, is_known ? GOOD : REMARK, "answers",
               "this model is not one that this program knows: it may speak another protocol",
               "model %d, firmware %d.%d, hardware %d, serial %s", info->model,
               info->firmware_major, info->firmware_minor, info->hardware, serial);
        return true;
    }
    const trouble_t trouble = trouble_find(&device->serial, &device->lidar);
    static const char *const names[] = {"wiring", "baud", "command", "answers"};
    const bool is_gone = device->serial.state != TMINI_POSIX_OK;
    answer(check, BAD, is_gone ? "port" : names[trouble],
           is_gone ? "plug it in again; give the lidar a supply of its own" : trouble_text(trouble),
           is_gone ? "it has gone: unplugged, or its supply has failed" : "no device information");
    return false;
}

static const char *advice_for(unsigned faults)
{
    return (faults & TMINI_FAULT_ENCODER) != 0
               ? "let the rotor turn freely: a hair, a cable, the housing? Then start again"
           : (faults & TMINI_FAULT_DATA) != 0
               ? "uncover or clean the window; nothing within 12 m is no fault"
               : "cut the supply for a moment; if it stays, the unit is broken: ask its maker";
}

static void ask_health(check_t *check)
{
    device_t *const device = check->device;
    char text[FAULTS_TEXT_SIZE];
    if (!device_await(device, tmini_request_health(&device->lidar), TMINI_EVENT_HEALTH)) {
        answer(check, REMARK, "health", "its firmware may not know the question", "not answered");
        return;
    }
    const uint8_t faults = tmini_health(&device->lidar)->faults;
    check->idle_faults = faults;
    answer(check, faults == 0 ? GOOD : BAD, "health", advice_for(faults), "%s",
           faults_text(faults, text));
}

static void ask_frequency(check_t *check)
{
    device_t *const device = check->device;
    tmini_counters_t counters;
    if (device_await(device, tmini_request_frequency(&device->lidar), TMINI_EVENT_FREQUENCY)) {
        check->set_chz = tmini_frequency_chz(&device->lidar);
    } else {
        answer(check, REMARK, "frequency", "its firmware may not know the question",
               "not answered");
    }
    tmini_counters(&device->lidar, &counters);
    if (counters.timeouts > 0) {
        answer(check, REMARK, "replies", "check both data wires, their length, and GND",
               "%d came late or not at all", counters.timeouts);
    }
}

static void see_scan(check_t *check)
{
    const stream_t *const stream = &check->device->stream;
    const tmini_scan_t *const scan = &stream->scan;
    check->points += scan->count;
    check->valid += points_valid(scan->points, scan->count);
    check->speed_chz = scan->frequency_chz > 0 ? scan->frequency_chz : check->speed_chz;
    const unsigned nearly = check->set_chz - check->set_chz * SPEED_REMARK_PERCENT / 100;
    if (check->full_speed_ms == 0 && check->speed_chz >= nearly && check->speed_chz > 0) {
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
    }
}

static void judge_supply(check_t *check)
{
    const device_t *const device = check->device;
    static const char advice[] =
        "a supply of its own (5 V, up to 1 A) and short wires; a loose plug does the same";
    if (device->serial.state != TMINI_POSIX_OK) {
        answer(check, BAD, "supply", advice, "the port went away while the motor was on");
    } else if (device->silences > 0) {
        answer(check, BAD, "supply", advice, "the lidar fell silent %u times in %u s",
               (unsigned)device->silences, check->seconds);
    } else if (check->full_speed_ms > SPIN_UP_MS) {
        answer(check, REMARK, "supply", advice, "the motor took %u.%u s to come up to speed",
               (unsigned)check->full_speed_ms / 1000, (unsigned)check->full_speed_ms / 100 % 10);
    } else {
        answer(check, GOOD, "supply", NULL,
               "no restart; first packet after %u.%02u s, full speed "
               "after %u.%u s",
               (unsigned)check->start_ms / 1000, (unsigned)check->start_ms / 10 % 100,
               (unsigned)check->full_speed_ms / 1000, (unsigned)check->full_speed_ms / 100 % 10);
    }
}

static void judge_line(check_t *check)
{
    const device_t *const device = check->device;
    const stream_t *const stream = &device->stream;
    const unsigned permille = stream_damaged_permille(stream);
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    answer(check,
           permille >= DAMAGED_PERMILLE || device->noises > 0 ? BAD
           : stream->damaged > 0                              ? REMARK
                                                              : GOOD,
           "line",
           device->noises > 0
               ? "bytes came that are no lidar's: a wrong baud rate for a while, GND, interference"
               : "shorter wires, GND beside them, away from motors; another adapter; 3.3 V levels",
           "%u.%u %% of %" PRIu64 " packets damaged, %" PRIu32 " wrong checksums", permille / 10,
           permille % 10, stream->packets, counters.parser.checksum_errors);
    if (counters.parser.bytes_overrun > 0) {
        answer(check, REMARK, "computer", "end other programs",
               "%" PRIu32 " bytes lost here: too busy", counters.parser.bytes_overrun);
    }
    if (stream->longest_ms > PAUSE_MS && device->silences + device->noises == 0) {
        answer(check, REMARK, "pace",
               "nothing is lost by it; for fresher data: the adapter's latency timer, no USB hub,\n"
               "a less busy computer",
               "packets came up to %u ms late", (unsigned)stream->longest_ms);
    }
}

static void judge_speed(check_t *check)
{
    const unsigned set = check->set_chz;
    const unsigned speed = check->speed_chz;
    const unsigned off = set > speed ? set - speed : speed - set;
    char told[24];
    (void)snprintf(told, sizeof told, "%s", frequency_text(speed));
    if (speed == 0) {
        answer(check, BAD, "frequency", "does it turn? Is something in its way?",
               "no revolution was completed");
    } else if (set > 0) {
        const unsigned percent = off * 100 / set;
        answer(check,
               percent > SPEED_PERCENT          ? BAD
               : percent > SPEED_REMARK_PERCENT ? REMARK
                                                : GOOD,
               "frequency", "the supply may be weak, or something may brake the rotor",
               "%s measured, %s set", told, frequency_text(set));
    }
}

static void judge_scans(check_t *check)
{
    char text[FAULTS_TEXT_SIZE];
    const unsigned percent = check->points > 0 ? (unsigned)(check->valid * 100 / check->points) : 0;
    const stream_t *const stream = &check->device->stream;
    if ((check->faults & ~check->idle_faults) != 0) {
        answer(check, BAD, "faults", advice_for(check->faults), "%s",
               faults_text(check->faults, text));
    } else if (check->faults != 0) {
        return; /* It has been said. */
    } else {
        answer(check, GOOD, "faults", NULL, "%s",
               stream->faults != FAULTS_UNKNOWN          ? "none told while scanning"
               : stream_telling(stream) == TELLS_NOTHING ? "this unit tells none while scanning"
                                                         : "unknown: no revolution arrived whole");
    }
    if (check->points > 0 && check->faults == 0) {
        answer(check,
               check->valid == 0       ? BAD
               : percent < FEW_PERCENT ? REMARK
                                       : GOOD,
               "ranges", "uncover or clean the window; or there is nothing within 12 m",
               "%u %% of the points have a distance", percent);
    }
}

static void judge(check_t *check)
{
    judge_supply(check);
    judge_line(check);
    judge_speed(check);
    judge_scans(check);
    if (check->device->serial.state == TMINI_POSIX_OK && !device_stop(check->device)) {
        answer(check, BAD, "stop", "check the wire from the adapter's TX to the lidar's RX",
               "the lidar does not stop");
    }
}

static int conclude(const check_t *check)
{
    if (interrupt_has_come()) {
        return message_fail("interrupted: no verdict");
    }
    if (check->bads[0] != '\0') {
        (void)printf("verdict: not good: %s\n", check->bads);
        return STATUS_FAILED;
    }
    if (check->remarks[0] != '\0') {
        (void)printf("verdict: usable, but look at: %s\n", check->remarks);
    } else {
        (void)puts("verdict: good");
    }
    return STATUS_OK;
}

static void examine(check_t *check)
{
    device_t *const device = check->device;
    answer(check, GOOD, "port", NULL, "%s", device->path);
    if (!ask_info(check)) {
        return;
    }
    ask_health(check);
    ask_frequency(check);
    message_note("scanning for %u s …", check->seconds);
    device_begin(device);
    if (!device_await(device, tmini_start(&device->lidar), TMINI_EVENT_STARTED)) {
        answer(check, BAD, "start", "its supply may fail when the motor starts (5 V, up to 1 A)",
               "it answers, but does not scan");
        return;
    }
    check->start_ms = device_ms(device);
    watch(check);
    judge(check);
}

static int run(const options_t *options)
{
    check_t check = {.seconds = options->seconds > 0 ? options->seconds : WATCH_SECONDS};
    const int status = device_open(&check.device, options);
    if (status != STATUS_OK) {
        (void)puts("verdict: cannot tell: there is no port to look at");
        return status;
    }
    examine(&check);
    device_close(check.device);
    return conclude(&check);
}

const command_t command_check = {
    .name = "check",
    .usage = "[-p PORT] [--seconds N]",
    .summary = "ten seconds, one verdict: port, wires, supply, lidar",
    .details =
        "A line a question: ok; look (it works, but could be better); BAD. Each that is not ok "
        "says\n"
        "what to do about it. Watches for 10 seconds, or N. Exit status 1 if anything is BAD.",
    .accepts = "psq",
    .run = run,
};
