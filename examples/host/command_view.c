/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini view: a live picture in the terminal, of a lidar or of a recording. */

#include "commands.h"

#include "device.h"
#include "faults.h"
#include "message.h"
#include "viewer.h"

#define SLICE_MS 10u

/* Takes the next event. Returns true if there is something to show. */
static bool follow(device_t *device, viewer_t *viewer)
{
    switch (device_wait(device, SLICE_MS)) {
    case TMINI_EVENT_SCAN:
        viewer_keep(viewer, tmini_scan(&device->lidar));
        viewer->view.state = "scanning";
        viewer->view.scans++;
        return true;
    case TMINI_EVENT_LOST:
        viewer->view.state = "LOST: no packets; starting the lidar again";
        return true;
    case TMINI_EVENT_RECOVERED:
    case TMINI_EVENT_STARTED:
        viewer->view.state = "scanning";
        return true;
    case TMINI_EVENT_FAULT:
        return true;
    default:
        return false;
    }
}

static void tell(const device_t *device, view_t *view, char health[FAULTS_TEXT_SIZE])
{
    tmini_counters_t counters;
    tmini_turn_info_t info;
    tmini_counters(&device->lidar, &counters);
    tmini_turn(&device->lidar, &info);
    const uint8_t faults = tmini_faults(&device->lidar);
    view->is_faulty = faults != 0;
    if (faults != 0 || (info.known & TMINI_KNOWN_FAULTS) != 0) {
        view->health = faults_text(faults, health);
    }
    view->packets = counters.parser.packets;
    view->checksum_errors = counters.parser.checksum_errors;
    view->bytes_lost = counters.parser.bytes_overrun;
}

static int watch(device_t *device)
{
    static viewer_t viewer;
    char health[FAULTS_TEXT_SIZE];
    if (!viewer_open(&viewer, device->path)) {
        return STATUS_FAILED;
    }
    viewer.view.state = "starting";
    while (!viewer.is_over && device->serial.state == TMINI_POSIX_OK) {
        const bool is_news = follow(device, &viewer);
        tell(device, &viewer.view, health);
        viewer_attend(&viewer, is_news);
    }
    viewer_close(&viewer);
    return viewer.is_over ? STATUS_OK : device_why(device);
}

static int view_device(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    int status = device_start(device);
    if (status == STATUS_OK) {
        status = watch(device);
    }
    device_close(device);
    return status;
}

static int run(const options_t *options)
{
    if ((options->operand == NULL) == (options->port == NULL)) {
        return message_usage("view what? Usage: tmini view %s", command_view.usage);
    }
    return options->port != NULL ? view_device(options) : view_recording(options);
}

const command_t command_view = {
    .name = "view",
    .usage = "-p PORT|FILE",
    .summary = "a live picture in the terminal, of a lidar or a recording",
    .details =
        "\n"
        "Keys: + and - zoom, a chooses the range automatically, q ends. The marked point is "
        "the\nnearest obstacle; the numbers around the triangle are the nearest ones of each\n"
        "sector, in metres. Needs a terminal with UTF-8; NO_COLOR=1 does without colours.",
    .accepts = "pMq",
    .operand = "FILE",
    .run = run,
};
