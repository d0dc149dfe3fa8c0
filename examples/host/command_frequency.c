/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini frequency: reads or sets the scan frequency. */

#include "commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "device.h"
#include "message.h"

/* "7.5" as 750. Returns false if it is no permitted frequency. */
static bool read_frequency(const char *text, uint16_t *frequency_chz)
{
    char *end = NULL;
    const double frequency = strtod(text, &end);
    const double steps = frequency * 10;
    if (end == text || *end != '\0' || !(frequency >= TMINI_FREQUENCY_MIN_CHZ / 100.0) ||
        !(frequency <= TMINI_FREQUENCY_MAX_CHZ / 100.0) || fabs(steps - round(steps)) > 1e-6) {
        return false;
    }
    *frequency_chz = (uint16_t)(lround(steps) * (long)TMINI_FREQUENCY_STEP_CHZ);
    return true;
}

static void print(uint16_t frequency_chz, format_t format)
{
    (void)printf(format == FORMAT_JSON ? "{\"frequency_hz\":%d.%02d}\n" : "%d.%02d Hz\n",
                 frequency_chz / 100, frequency_chz % 100);
}

static int run(const options_t *options)
{
    uint16_t wanted_chz = 0;
    if (options->operand != NULL && !read_frequency(options->operand, &wanted_chz)) {
        return message_usage("\"%s\" is not a scan frequency: 6 to 12 Hz, in steps of 0.1",
                             options->operand);
    }
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    const tmini_status_t begun = wanted_chz > 0 ? tmini_set_frequency(&device->lidar, wanted_chz)
                                                : tmini_request_frequency(&device->lidar);
    const int status = device_finish(device, begun, TMINI_EVENT_FREQUENCY);
    if (status == STATUS_OK) {
        print(tmini_frequency_chz(&device->lidar), options->format);
    }
    device_close(device);
    return status;
}

const command_t command_frequency = {
    .name = "frequency",
    .usage = "[HZ] -p PORT [--json]",
    .summary = "reads the scan frequency, or sets it",
    .details =
        "\n"
        "HZ: 6 to 12, in steps of 0.1. The lidar forgets it when it loses power. Prints what\n"
        "is set, which `tmini scan` shows the motor to come close to.",
    .accepts = "pJq",
    .operand = "HZ",
    .run = run,
};
