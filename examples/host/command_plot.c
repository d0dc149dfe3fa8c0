/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini plot: a picture of a scan, or of all scans, of a recording. */

#include "commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "message.h"
#include "picture.h"
#include "recording.h"
#include "scan_list.h"

#define TITLE_SIZE 64
#define SUBTITLE_SIZE 256

static const char *base_name(const char *path)
{
    const char *name = path;
    for (; *path != '\0'; path++) {
        if ((*path == '/' || *path == '\\') && path[1] != '\0') {
            name = path + 1;
        }
    }
    return name;
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
                   scan_valid_points(scan), base_name(options->operand));
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
                   base_name(options->operand));
    const int status =
        picture_write(options->output, &(figure_t){title, subtitle, scans, list->count});
    free(scans);
    return status;
}

static int draw(const scan_list_t *list, const options_t *options)
{
    if (list->count == 0) {
        return message_fail("%s has no start packet, so no scan: record for at least a second",
                            options->operand);
    }
    if (options->all) {
        return draw_all(list, options);
    }
    if (options->scan > 0) {
        const kept_scan_t *const scan = scan_list_find(list, options->scan);
        return scan != NULL ? draw_one(scan, options)
                            : message_fail("%s has no scan %u, only %" PRIu64 " to %" PRIu64,
                                           options->operand, options->scan, list->scans[0].number,
                                           list->scans[list->count - 1].number);
    }
    const kept_scan_t *const scan = scan_list_last_complete(list);
    return scan != NULL
               ? draw_one(scan, options)
               : message_fail("%s has no complete scan; --scan %" PRIu64 " draws an incomplete one",
                              options->operand, list->scans[list->count - 1].number);
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

static int run(const options_t *options)
{
    if (options->operand == NULL || options->output == NULL) {
        return message_usage("plot what, and where to? Usage: tmini plot %s", command_plot.usage);
    }
    if (!picture_is_known(options->output)) {
        return message_usage("%s: the picture's name must end in .svg or .png", options->output);
    }
    if (options->all && options->scan > 0) {
        return message_usage("either --all or --scan N, not both");
    }
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

const command_t command_plot = {
    .name = "plot",
    .usage = "FILE|- -o OUT.svg|OUT.png [--scan N|--all]",
    .summary = "a picture of a scan",
    .details = "\n"
               "Draws the last complete scan, seen from above with the lidar's front up: range\n"
               "rings in metres, points coloured by intensity, interference marked.",
    .accepts = "oNAMq",
    .operand = "FILE",
    .run = run,
};
