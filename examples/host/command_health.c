/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini health: is the lidar well? */

#include "commands.h"

#include <stdio.h>

#include "device.h"
#include "faults.h"
#include "message.h"

static void print(const tmini_health_t *health, format_t format)
{
    char text[FAULTS_TEXT_SIZE];
    if (format == FORMAT_JSON) {
        (void)printf("{\"healthy\":%s,\"faults\":%d,\"error_code\":%d}\n",
                     health->faults == 0 ? "true" : "false", health->faults, health->error_code);
    } else if (health->faults == 0) {
        (void)puts("healthy");
    } else {
        (void)printf("%s; error code %d\n", faults_text(health->faults, text), health->error_code);
    }
}

static int run(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    int status = device_finish(device, tmini_request_health(&device->lidar), TMINI_EVENT_HEALTH);
    if (status == STATUS_OK) {
        print(tmini_health(&device->lidar), options->format);
        status = tmini_health(&device->lidar)->faults == 0 ? STATUS_OK : STATUS_FAILED;
    }
    device_close(device);
    return status;
}

const command_t command_health = {
    .name = "health",
    .usage = "-p PORT [--json]",
    .summary = "whether the lidar is well",
    .details = "\nExit status 1 also when the lidar is faulty.",
    .accepts = "pJq",
    .operand = NULL,
    .run = run,
};
