/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini reboot: restarts the lidar, and checks that it is back. */

#include "commands.h"

#include "device.h"
#include "message.h"

static int run(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    message_note("rebooting; this takes some seconds …");
    int status = device_finish(device, tmini_reboot(&device->lidar), TMINI_EVENT_REBOOTED);
    if (status == STATUS_OK) {
        /* A reboot is not answered: ask something that is. */
        status = device_finish(device, tmini_request_health(&device->lidar), TMINI_EVENT_HEALTH);
    }
    if (status == STATUS_OK) {
        message_note("the lidar is back");
    }
    device_close(device);
    return status;
}

const command_t command_reboot = {
    .name = "reboot",
    .usage = "-p PORT",
    .summary = "restarts the lidar",
    .details = "\nThe lidar stops, and its scan frequency goes back to what it has at power-up.",
    .accepts = "pq",
    .operand = NULL,
    .run = run,
};
