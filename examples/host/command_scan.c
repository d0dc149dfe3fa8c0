/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini scan: prints scans as they come: a line for each, or CSV, or JSON. */

#include <stdio.h>

#include "device.h"
#include "interrupt.h"
#include "output.h"
#include "points.h"

static count_t scans_with_range;
static unsigned wanted_scans; /* 0: without end. */

static void print_scan(const stream_t *stream, const options_t *options)
{
    const survey_t survey = points_survey(stream->scan.points, stream->scan.count);
    scans_with_range += survey.valid > 0 ? 1 : 0;
    if (options->json) {
        rows_print_scan(stream);
    } else if (!options->csv) {
        (void)printf("%s %-4llu  %7s  %3zu/%3zu points%s%s\n",
                     stream->scan.complete ? "scan" : "part", stream->number,
                     frequency_text(stream->scan.frequency_chz), survey.valid, survey.count,
                     survey.nearest != NULL ? "  nearest " : "",
                     survey.nearest != NULL ? place_text(survey.nearest) : "");
    }
    (void)fflush(stdout); /* So that a program that reads the pipe gets it at once. */
}

static bool is_enough(const stream_t *stream)
{
    return wanted_scans > 0 && stream->scans >= wanted_scans;
}

/* Packets before the first start packet belong to no scan; the start packet that ends the last scan
 * belongs to the next one. */
static void print_packet(const stream_t *stream)
{
    if (stream->start_packets > 0 && !is_enough(stream)) {
        rows_print_packet(stream);
    }
}

static int print_scans(device_t *device, const options_t *options)
{
    wanted_scans = options->count;
    if (options->csv) {
        (void)puts(ROWS_HEADER);
    }
    while (ferror(stdout) == 0 && !is_enough(&device->stream)) {
        if (!device_next_scan(device, options->csv ? print_packet : NULL)) {
            return wanted_scans == 0 && interrupt_has_come() ? STATUS_OK : device_why(device);
        }
        print_scan(&device->stream, options);
    }
    return ferror(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static int scan(device_t *device, const options_t *options)
{
    const stream_t *const stream = &device->stream;
    int status = device_start(device);
    if (status != STATUS_OK) {
        return status;
    }
    status = print_scans(device, options);
    message_note("scans: %s; %llu with a distance; %s of the packets damaged", scans_text(stream),
                 scans_with_range, damaged_text(stream));
    if (status == STATUS_OK && stream->scans > 0 && scans_with_range == 0) {
        return message_fail("no scan had a distance: is the window covered, or the rotor blocked? "
                            "`tmini health` shows more");
    }
    return status;
}

const command_t command_scan = {
    .name = "scan",
    .usage = "[-p PORT] [-n N] [--csv|--json] [--wait] [--listen] [--front DEG]\n"
             "           [--upside-down] [--offset MM] [--mask FROM:TO]",
    .summary = "scans as they come, until Ctrl-C or N of them",
    .details = "A line per scan: its number, the frequency, the points with a distance of all\n"
               "points, and the nearest one; \"part\": packets of it are missing. Or, with the\n"
               "same columns and members as `tmini decode`, --csv or --json. Exit status 1 also\n"
               "when no scan had a distance. While the motor comes up to speed, the first scans\n"
               "have more points.",
    .accepts = "pnCJWLFUOKq",
    .use = scan,
};
