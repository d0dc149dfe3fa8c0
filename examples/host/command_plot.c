/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini plot: a picture of a scan, or of all scans, of a recording or of a lidar. */

#include "commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "device.h"
#include "message.h"
#include "picture.h"
#include "recording.h"
#include "scan_list.h"

/* From a lidar: by this scan the motor has come up to speed. */
#define DEVICE_SCANS 4u

#define TITLE_SIZE 64
#define SUBTITLE_SIZE 256

static const char *source_of(const options_t *options)
{
    return options->operand != NULL ? options->operand : options->port;
}

static int draw_one(const kept_scan_t *kept, const options_t *options)
{
    const tmini_scan_t *const scan = &kept->scan;
    char title[TITLE_SIZE];
    char subtitle[SUBTITLE_SIZE];
    char frequency[32] = "frequency unknown";
    (void)snprintf(title, sizeof title, "Scan %" PRIu64 "%s", kept->number,
                   scan->complete ? "" : " (incomplete)");
    if (scan->frequency_chz > 0) {
        (void)snprintf(frequency, sizeof frequency, "%d.%d Hz", scan->frequency_chz / 100,
                       scan->frequency_chz / 10 % 10);
    }
    (void)snprintf(subtitle, sizeof subtitle,
                   "%s \xC2\xB7 %d points, %zu with a distance \xC2\xB7 %s", frequency, scan->count,
                   scan_valid_points(scan), recording_base_name(source_of(options)));
    return picture_write(options->output, &(figure_t){title, subtitle, &scan, 1});
}

static int draw_all(const scan_list_t *list, const options_t *options)
{
    const tmini_scan_t **const scans = malloc(list->count * sizeof *scans);
    if (scans == NULL) {
        return message_fail("not enough memory for all scans");
    }
    size_t points = 0;
    for (size_t i = 0; i < list->count; i++) {
        scans[i] = &list->scans[i].scan;
        points += scan_valid_points(scans[i]);
    }
    char title[TITLE_SIZE];
    char subtitle[SUBTITLE_SIZE];
    (void)snprintf(title, sizeof title, "Scans %" PRIu64 " to %" PRIu64, list->scans[0].number,
                   list->scans[list->count - 1].number);
    (void)snprintf(subtitle, sizeof subtitle, "%zu points with a distance \xC2\xB7 %s", points,
                   recording_base_name(source_of(options)));
    const int status =
        picture_write(options->output, &(figure_t){title, subtitle, scans, list->count});
    free(scans);
    return status;
}

static int draw(const scan_list_t *list, const options_t *options)
{
    if (list->count == 0) {
        return message_fail("%s has no start packet, so no scan: record for at least a second",
                            source_of(options));
    }
    if (options->all) {
        return draw_all(list, options);
    }
    if (options->scan > 0) {
        const kept_scan_t *const scan = scan_list_find(list, options->scan);
        return scan != NULL ? draw_one(scan, options)
                            : message_fail("%s has no scan %u, only %" PRIu64 " to %" PRIu64,
                                           source_of(options), options->scan, list->scans[0].number,
                                           list->scans[list->count - 1].number);
    }
    const kept_scan_t *const scan = scan_list_last_complete(list);
    return scan != NULL
               ? draw_one(scan, options)
               : message_fail("%s has no complete scan; --scan %" PRIu64 " draws an incomplete one",
                              source_of(options), list->scans[list->count - 1].number);
}

static int read_and_draw(decoder_t *decoder, const options_t *options)
{
    scan_list_t *const list = scan_list_new();
    bool has_memory = list != NULL;
    while (has_memory && decoder_next(decoder)) {
        has_memory = scan_list_add(list, decoder);
    }
    has_memory = has_memory && scan_list_end(list);
    int status = STATUS_OK;
    if (!has_memory) {
        status = message_fail("not enough memory for this recording");
    } else {
        status = recording_verdict(options->operand, decoder);
    }
    if (status == STATUS_OK) {
        status = draw(list, options);
    }
    scan_list_free(list);
    return status;
}

static int plot_recording(const options_t *options)
{
    FILE *const file = recording_open(options->operand);
    if (file == NULL) {
        return STATUS_FAILED;
    }
    decoder_t decoder;
    decoder_init(&decoder, file, (uint8_t)options->max_samples);
    const int status = read_and_draw(&decoder, options);
    recording_close(file);
    return status;
}

/* Gathers scans until the wanted one, or a complete one at full speed, has come. */
static int gather(device_t *device, const options_t *options, scan_list_t *list)
{
    const size_t wanted = options->scan > 0 ? options->scan : DEVICE_SCANS;
    bool is_enough = false;
    int status = device_start(device);
    while (status == STATUS_OK && !is_enough) {
        const tmini_scan_t *const scan = device_next_scan(device);
        if (scan == NULL) {
            status = device_why(device);
        } else if (!scan_list_append(list, &(kept_scan_t){*scan, list->count + 1, 0})) {
            status = message_fail("not enough memory for so many scans");
        } else {
            is_enough = list->count >= wanted && (scan->complete || options->scan > 0);
        }
    }
    return status;
}

static int plot_device(const options_t *options)
{
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    scan_list_t *const list = scan_list_new();
    int status =
        list != NULL ? gather(device, options, list) : message_fail("not enough memory for scans");
    device_close(device);
    if (status == STATUS_OK) {
        status = draw(list, options);
    }
    scan_list_free(list);
    return status;
}

static int run(const options_t *options)
{
    const bool has_one_source = (options->operand == NULL) != (options->port == NULL);
    if (!has_one_source || options->output == NULL) {
        return message_usage("plot what, and where to? Usage: tmini plot %s", command_plot.usage);
    }
    if (!picture_is_known(options->output)) {
        return message_usage("%s: the picture's name must end in .svg or .png", options->output);
    }
    if (options->all && options->scan > 0) {
        return message_usage("either --all or --scan N, not both");
    }
    return options->port != NULL ? plot_device(options) : plot_recording(options);
}

const command_t command_plot = {
    .name = "plot",
    .usage = "FILE|-|-p PORT -o OUT.svg|OUT.png [--scan N|--all]",
    .summary = "a picture of a scan",
    .details =
        "\n"
        "Draws the last complete scan, seen from above with the lidar's front up: range\n"
        "rings in metres, points coloured by intensity, interference marked. From a lidar, waits\n"
        "some scans until it is up to speed.",
    .accepts = "poNAMq",
    .operand = "FILE",
    .run = run,
};
