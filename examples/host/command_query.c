/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini info, health, frequency and reboot: one question to the lidar, one answer. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tmini/tmini_names.h"
#include "device.h"
#include "output.h"
#include "points.h"

static int query_info(device_t *device, const options_t *options)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    const int status = device_finish(device, tmini_request_info, TMINI_EVENT_INFO);
    if (status != STATUS_OK) {
        return status;
    }
    const tmini_info_t *const info = tmini_info(&device->lidar);
    tmini_serial_text(info, serial);
    if (options->json) {
        (void)printf("{\"model\":%d,\"firmware\":\"%d.%d\",\"hardware\":%d,\"serial\":\"%s\"}\n",
                     info->model, info->firmware_major, info->firmware_minor, info->hardware,
                     serial);
        return STATUS_OK;
    }
    (void)printf("model       %d (%s)\n", info->model, model_text(info->model));
    (void)printf("firmware    %d.%d\n", info->firmware_major, info->firmware_minor);
    (void)printf("hardware    %d\n", info->hardware);
    (void)printf("serial      %s\n", serial);
    return STATUS_OK;
}

static int query_health(device_t *device, const options_t *options)
{
    char text[FAULTS_TEXT_SIZE];
    const int status = device_finish(device, tmini_request_health, TMINI_EVENT_HEALTH);
    if (status != STATUS_OK) {
        return status;
    }
    const tmini_health_t *const health = tmini_health(&device->lidar);
    if (options->json) {
        (void)printf("{\"healthy\":%s,\"faults\":%d,\"error_code\":%d}\n",
                     health->faults == 0 ? "true" : "false", health->faults, health->error_code);
    } else if (health->faults == 0) {
        (void)puts("healthy");
    } else {
        (void)printf("%s; error code %d\n", faults_text(health->faults, text), health->error_code);
    }
    return health->faults == 0 ? STATUS_OK : STATUS_FAILED;
}

/* Reads "7.5" as 750; returns 0 if the frequency is not permitted. */
static uint16_t read_frequency(const char *text)
{
    char *end = NULL;
    const double frequency = strtod(text, &end);
    const double steps = frequency * 10;
    if (end == text || *end != '\0' || !(frequency >= TMINI_FREQUENCY_MIN_CHZ / 100.0) ||
        !(frequency <= TMINI_FREQUENCY_MAX_CHZ / 100.0) || fabs(steps - round(steps)) > 1e-6) {
        return 0;
    }
    return (uint16_t)(lround(steps) * (long)TMINI_FREQUENCY_STEP_CHZ);
}

static uint16_t wanted_chz;

static tmini_status_t set_frequency(tmini_t *lidar)
{
    return tmini_set_frequency(lidar, wanted_chz);
}

static int query_frequency(device_t *device, const options_t *options)
{
    wanted_chz = options->operand != NULL ? read_frequency(options->operand) : 0;
    const int status = device_finish(
        device, wanted_chz != 0 ? set_frequency : tmini_request_frequency, TMINI_EVENT_FREQUENCY);
    if (status == STATUS_OK) {
        (void)printf(options->json ? "{\"frequency_hz\":%.2f}\n" : "%.2f Hz\n",
                     tmini_frequency_chz(&device->lidar) / 100.0);
    }
    return status;
}

static int query_reboot(device_t *device, const options_t *options)
{
    (void)options;
    message_note("rebooting; this takes some seconds …");
    int status = device_finish(device, tmini_reboot, TMINI_EVENT_REBOOTED);
    if (status == STATUS_OK) {
        /* A reboot has no reply, so a query shows that it worked. */
        status = device_finish(device, tmini_request_health, TMINI_EVENT_HEALTH);
    }
    if (status == STATUS_OK) {
        message_note("the lidar is back");
    }
    return status;
}

static int run_frequency(const options_t *options)
{
    if (options->operand != NULL && read_frequency(options->operand) == 0) {
        return message_usage("\"%s\" is not a scan frequency: 6 to 12 Hz, in steps of 0.1",
                             options->operand);
    }
    return device_use(options, query_frequency);
}

const command_t command_info = {
    .name = "info",
    .usage = "[-p PORT] [--json]",
    .summary = "model, firmware, hardware and serial number",
    .accepts = "pJq",
    .use = query_info,
};

const command_t command_health = {
    .name = "health",
    .usage = "[-p PORT] [--json]",
    .summary = "whether the lidar is healthy",
    .details = "Exit status 1 also when the lidar is faulty.",
    .accepts = "pJq",
    .use = query_health,
};

const command_t command_frequency = {
    .name = "frequency",
    .usage = "[HZ] [-p PORT] [--json]",
    .summary = "reads the scan frequency, or sets it",
    .details = "HZ: 6 to 12, in steps of 0.1. The lidar forgets it when it loses power. Prints\n"
               "the frequency that is set; `tmini scan` shows the one that is measured.",
    .accepts = "pJq",
    .has_operand = true,
    .run = run_frequency,
};

const command_t command_reboot = {
    .name = "reboot",
    .usage = "[-p PORT]",
    .summary = "restarts the lidar",
    .details = "The lidar stops, and its scan frequency goes back to what it has at power-up.",
    .accepts = "pq",
    .use = query_reboot,
};
