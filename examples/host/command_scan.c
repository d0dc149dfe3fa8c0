/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini scan: scans as they come, as a line each, as CSV or as JSON. */

#include "commands.h"

#include <stdio.h>

#include "device.h"
#include "direction.h"
#include "message.h"
#include "rows.h"

static void print_line(unsigned number, const tmini_scan_t *scan)
{
    const tmini_point_t *const nearest = scan_nearest(scan);
    (void)printf("scan %-4u  %2d.%d Hz  %3d points, %3zu with a distance", number,
                 scan->frequency_chz / 100, scan->frequency_chz / 10 % 10, scan->count,
                 scan_valid_points(scan));
    if (nearest != NULL) {
        (void)printf("  nearest %d.%03d m at %3d degrees, %s", nearest->distance_mm / 1000,
                     nearest->distance_mm % 1000, nearest->angle_q6 / 64,
                     direction_name(nearest->angle_q6));
    }
    (void)puts(scan->complete ? "" : "  (incomplete)");
}

static void print_csv(unsigned number, const tmini_scan_t *scan)
{
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        (void)printf("%u,%zu," ANGLE_FORMAT ",%d,%d,%d\n", number, i, ANGLE_VALUES(point->angle_q6),
                     point->distance_mm, point->intensity, point->flag);
    }
}

static void print_json(unsigned number, const tmini_scan_t *scan)
{
    (void)printf("{\"scan\":%u,\"timestamp_ms\":%" PRIu32 ",\"frequency_hz\":%d.%02d,"
                 "\"complete\":%s,\"packets\":%d,\"gaps\":%d,\"dropped\":%d,"
                 "\"checksum_errors\":%d,\"points\":",
                 number, scan->timestamp_ms, scan->frequency_chz / 100, scan->frequency_chz % 100,
                 scan->complete ? "true" : "false", scan->packets, scan->gaps, scan->dropped,
                 scan->checksum_errors);
    row_print_json(scan->points, scan->count);
    (void)puts("}");
}

static void print(unsigned number, const tmini_scan_t *scan, format_t format)
{
    switch (format) {
    case FORMAT_CSV:
        print_csv(number, scan);
        break;
    case FORMAT_JSON:
        print_json(number, scan);
        break;
    default:
        print_line(number, scan);
        break;
    }
    (void)fflush(stdout); /* So that who reads along does so at once. */
}

static int print_scans(device_t *device, const options_t *options)
{
    if (options->format == FORMAT_CSV) {
        (void)puts("scan,point,angle_deg,distance_mm,intensity,flag");
    }
    unsigned number = 0;
    while (options->count == 0 || number < options->count) {
        const tmini_scan_t *const scan = device_next_scan(device);
        if (scan == NULL) {
            const bool was_asked_to_end =
                device->serial.state == TMINI_POSIX_OK && !device_is_usable(device);
            return was_asked_to_end && options->count == 0 ? STATUS_OK : device_why(device);
        }
        number++;
        print(number, scan, options->format);
        if (ferror(stdout) != 0) {
            return STATUS_FAILED; /* main() says why. */
        }
    }
    return STATUS_OK;
}

static int run(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    int status = device_start(device);
    if (status == STATUS_OK) {
        status = print_scans(device, options);
    }
    device_close(device);
    return status;
}

const command_t command_scan = {
    .name = "scan",
    .usage = "-p PORT [-n N] [--csv|--json]",
    .summary = "scans as they come, until Ctrl-C or N of them",
    .details =
        "\n"
        "Without --csv or --json: a line a scan.\n"
        "--csv   scan,point,angle_deg,distance_mm,intensity,flag\n"
        "--json  an object a line for each scan; points are\n"
        "        [angle in degrees, distance in mm, intensity, flag].\n"
        "Distance 0: no valid range. Angles count clockwise, seen from above. While the motor\n"
        "comes up to speed, the first scans have more points than the later ones.",
    .accepts = "pnCJq",
    .operand = NULL,
    .run = run,
};
