/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini survey: compares a unit with what is known about the T-mini Plus, and writes a report. */

#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "chunk.h"
#include "device.h"
#include "interrupt.h"
#include "output.h"
#include "survey.h"

#define SLICE_US 10000u

/* Bytes that the port has received and the survey has not taken. The port's blocks always fit. */
typedef struct {
    device_t *device;
    FILE *recording; /* NULL: none. */
    uint64_t stamp_us;
    size_t count;
    uint8_t bytes[1024];
} line_t;

static line_t line;
static survey_t survey;

static uint64_t now_us(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static void take(void *context, const uint8_t *bytes, size_t count)
{
    const uint64_t now = now_us(NULL);
    uint8_t head[CHUNK_HEAD_SIZE];
    (void)context;
    if (count <= sizeof line.bytes - line.count) {
        memcpy(line.bytes + line.count, bytes, count);
        line.count += count;
    }
    if (line.recording != NULL) {
        tmini_timed_write_head(head, (uint32_t)(now - line.stamp_us), bytes, count);
        (void)fwrite(head, 1, sizeof head, line.recording);
        (void)fwrite(bytes, 1, count, line.recording);
    }
    line.stamp_us = now;
}

static void send_bytes(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    (void)tmini_posix_port.write(&line.device->port, bytes, count);
}

static size_t receive(void *context, uint8_t *bytes, size_t max, uint64_t until_us)
{
    while (line.count == 0 && device_is_usable(line.device) && now_us(context) < until_us) {
        const uint64_t left_us = until_us - now_us(context);
        const uint64_t wait_us = left_us < SLICE_US ? left_us : SLICE_US;
        (void)tmini_posix_wait(&line.device->port, (int)((wait_us + 999) / 1000));
    }
    const size_t count = line.count < max ? line.count : max;
    memcpy(bytes, line.bytes, count);
    line.count -= count;
    memmove(line.bytes, line.bytes + count, line.count);
    return count;
}

static bool is_over(void *context)
{
    (void)context;
    return !device_is_usable(line.device);
}

static void say(void *context, const char *text)
{
    (void)context;
    message_note("%s …", text);
}

static const survey_wire_t wire = {
    .now_us = now_us, .send = send_bytes, .receive = receive, .is_over = is_over, .say = say};

/* During the survey the port's bytes go only to the tap; after it they go to the driver again,
 * which stops the lidar. */
static bool ask_everything(device_t *device, uint32_t seconds)
{
    device_tap(device, take, NULL);
    bool is_good = tmini_posix_start(&device->port, NULL) == TMINI_POSIX_OK;
    device_begin(device);
    line.device = device;
    line.stamp_us = now_us(NULL);
    is_good = is_good && survey_run(&survey, &wire, seconds);
    if (interrupt_has_come() && survey.wire != NULL) {
        message_note("giving the lidar back as it was …");
        device->ignores_interrupt = true;
        survey_restore(&survey);
        device->ignores_interrupt = false;
    }
    device_tap(device, NULL, NULL);
    if (device->port.state == TMINI_POSIX_OK) {
        (void)tmini_posix_start(&device->port, &device->lidar);
    }
    return is_good;
}

static int write_report(const options_t *options)
{
    FILE *const file = output_open(options->operand);
    if (file == NULL) {
        return STATUS_FAILED;
    }
    survey_print_report(&survey, file, options->with_serial);
    return output_close(file, options->operand, STATUS_OK);
}

/* Beside the report; only with the serial number, because a recording contains it. */
static int open_recording(const options_t *options, char *name, size_t size)
{
    if (!options->with_serial || options->operand == NULL || strcmp(options->operand, "-") == 0) {
        return STATUS_OK;
    }
    (void)snprintf(name, size, "%s.tmini", options->operand);
    line.recording = output_open(name);
    if (line.recording == NULL) {
        return STATUS_FAILED;
    }
    (void)fwrite(tmini_timed_magic, 1, sizeof tmini_timed_magic, line.recording);
    return STATUS_OK;
}

/* Asks once more by the driver, and prints why there is no answer. */
static int explain(device_t *device)
{
    if (interrupt_has_come()) {
        return message_fail("interrupted: no report");
    }
    const int status = device_finish(device, tmini_request_info, TMINI_EVENT_INFO);
    return status == STATUS_OK
               ? message_fail("the lidar answers now, but did not before; try again")
               : status;
}

static int use_survey(device_t *device, const options_t *options)
{
    char name[600] = "";
    if (tmini_posix_is_timed(&device->port)) {
        return device_finish(device, tmini_request_info, TMINI_EVENT_INFO);
    }
    if (options->seconds > 0 && options->seconds < SURVEY_SECONDS_MIN) {
        return message_usage("--seconds: %u at least, so that the motor is up to speed",
                             SURVEY_SECONDS_MIN);
    }
    if (options->operand != NULL && !output_may_open(options->operand, options->force)) {
        return STATUS_FAILED;
    }
    int status = open_recording(options, name, sizeof name);
    if (status != STATUS_OK) {
        return status;
    }
    const bool is_good =
        ask_everything(device, options->seconds > 0 ? options->seconds : SURVEY_SECONDS);
    if (line.recording != NULL) {
        status = output_close(line.recording, name, status);
    }
    if (!is_good) {
        return explain(device);
    }
    if (options->operand == NULL || strcmp(options->operand, "-") != 0) {
        survey_print_table(&survey, stdout, "");
    }
    return options->operand != NULL && status == STATUS_OK ? write_report(options) : status;
}

const command_t command_survey = {
    .name = "survey",
    .usage = "[-p PORT] [REPORT|-] [--seconds N] [--with-serial] [--force]",
    .summary = "compares this unit with docs/protocol.md in two minutes",
    .details = "A line per statement of docs/protocol.md: as expected, differs or unknown. The\n"
               "REPORT also has each answer as `key = value`, for an issue and for `tmini-sim\n"
               "--like REPORT`. The lidar is rebooted; its frequency is left as it was. The\n"
               "serial number is left out. --with-serial includes it, and writes all that was\n"
               "received to REPORT.tmini. --seconds: how long to scan at 6 Hz (40).\n"
               "An existing REPORT is overwritten only with --force.",
    .accepts = "psIXq",
    .has_operand = true,
    .use = use_survey,
};
