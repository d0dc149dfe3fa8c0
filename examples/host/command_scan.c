/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini scan: scans as they come, as a line each, as CSV or as JSON. */

#include <inttypes.h>
#include <stdio.h>

#include "device.h"
#include "interrupt.h"
#include "message.h"
#include "points.h"

static void print_line(const stream_t *stream)
{
    const tmini_scan_t *const scan = &stream->scan;
    const tmini_point_t *const nearest = points_nearest(scan->points, scan->count);
    (void)printf("scan %-4" PRIu64 "  %s  %3d points, %3zu with a distance", stream->number,
                 frequency_text(scan->frequency_chz), scan->count,
                 points_valid(scan->points, scan->count));
    if (nearest != NULL) {
        (void)printf("  nearest %d.%03d m at %3d degrees, %s", nearest->distance_mm / 1000,
                     nearest->distance_mm % 1000, nearest->angle_q6 / 64,
                     direction_name(nearest->angle_q6));
    }
    (void)puts(scan->complete ? "" : "  (incomplete)");
}

/* 0: without end. */
static unsigned wanted_scans;

/* What precedes the first start packet is no scan, and what ends the last one belongs to the
 * next. */
static void print_packet(const stream_t *stream, const tmini_packet_t *packet)
{
    const bool is_over = wanted_scans > 0 && stream->scans >= wanted_scans;
    if (stream->start_packets > 0 && !is_over) {
        rows_print_packet(stream, packet);
    }
}

static void summarise(const stream_t *stream, uint64_t with_range)
{
    message_note("%" PRIu64 " scans, %" PRIu64 " complete, %" PRIu64
                 " with a distance; %u.%u %% of "
                 "the packets damaged",
                 stream->scans, stream->complete, with_range, stream_damaged_permille(stream) / 10,
                 stream_damaged_permille(stream) % 10);
}

/* Returns the status to leave with. */
static int print_scans(device_t *device, const options_t *options)
{
    const stream_t *const stream = &device->stream;
    const bool is_csv = options->format == FORMAT_CSV;
    uint64_t with_range = 0;
    int status = STATUS_OK;
    wanted_scans = options->count;
    if (is_csv) {
        (void)puts(ROWS_HEADER);
    }
    while (status == STATUS_OK && (options->count == 0 || stream->scans < options->count)) {
        if (!device_next_scan(device, is_csv ? print_packet : NULL)) {
            const bool may_end = options->count == 0 && interrupt_has_come();
            status = may_end ? -1 : device_why(device);
            break;
        }
        with_range += points_valid(stream->scan.points, stream->scan.count) > 0 ? 1 : 0;
        if (options->format == FORMAT_JSON) {
            rows_print_scan(stream);
        } else if (!is_csv) {
            print_line(stream);
        }
        /* So that who reads along does so at once. */
        status = fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    summarise(stream, with_range);
    if (status <= 0 && stream->scans > 0 && with_range == 0) {
        return message_fail("no scan had a distance: is the window covered, or the rotor blocked? "
                            "`tmini health` tells more");
    }
    return status < 0 ? STATUS_OK : status;
}

static int run(const options_t *options)
{
    device_t *device = NULL;
    int status = device_open(&device, options);
    if (status == STATUS_OK) {
        status = device_start(device);
        status = status == STATUS_OK ? print_scans(device, options) : status;
        device_close(device);
    }
    return status;
}

const command_t command_scan = {
    .name = "scan",
    .usage = "[-p PORT] [-n N] [--csv|--json]",
    .summary = "scans as they come, until Ctrl-C or N of them",
    .details =
        "A line a scan; or, with the same columns and members as `tmini decode`, --csv or\n"
        "--json. Exit status 1 also when no scan had a distance. While the motor comes up to\n"
        "speed, the first scans have more points than the later ones.",
    .accepts = "pnCJq",
    .run = run,
};
