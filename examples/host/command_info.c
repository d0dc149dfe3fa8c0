/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini info: which lidar is there. */

#include "commands.h"

#include <stdio.h>

#include "device.h"
#include "message.h"

static const char *model_name(uint8_t model)
{
    switch (model) {
    case TMINI_MODEL_T_MINI_PLUS:
        return "T-mini Plus";
    case TMINI_MODEL_T_MINI_PRO:
        return "T-mini Pro";
    default:
        return "unknown: not a T-mini Plus or Pro, perhaps with another protocol";
    }
}

static void print(const tmini_info_t *info, format_t format)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    if (format == FORMAT_JSON) {
        (void)printf("{\"model\":%d,\"firmware\":\"%d.%d\",\"hardware\":%d,\"serial\":\"%s\"}\n",
                     info->model, info->firmware_major, info->firmware_minor, info->hardware,
                     serial);
        return;
    }
    (void)printf("model       %d (%s)\n", info->model, model_name(info->model));
    (void)printf("firmware    %d.%d\n", info->firmware_major, info->firmware_minor);
    (void)printf("hardware    %d\n", info->hardware);
    (void)printf("serial      %s\n", serial);
}

static int run(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    const int status = device_finish(device, tmini_request_info(&device->lidar), TMINI_EVENT_INFO);
    if (status == STATUS_OK) {
        print(tmini_info(&device->lidar), options->format);
    }
    device_close(device);
    return status;
}

const command_t command_info = {
    .name = "info",
    .usage = "-p PORT [--json]",
    .summary = "model, firmware, hardware and serial number",
    .details = "",
    .accepts = "pJq",
    .operand = NULL,
    .run = run,
};
