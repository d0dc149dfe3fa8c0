/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini plot: a picture of a scan, or of all scans, of a recording or of a lidar. */

#include <stdio.h>
#include <string.h>

#include "device.h"
#include "output.h"
#include "picture.h"
#include "points.h"
#include "recording.h"

/* With a lidar: when this scan comes, the motor has reached its speed. */
#define DEVICE_SCANS 4u

/* On a noisy line perhaps no scan is complete: the command gives up after this many more. */
#define PATIENCE_SCANS 40u

/* More points than can be distinguished in one picture. */
#define POINTS_MAX 65536u

/* What is to be drawn: the last complete scan, the wanted one, or points of all. */
typedef struct {
    tmini_scan_t scan;
    count_t number; /* The scan's number; 0: there is none yet. */
    count_t first;  /* The numbers of the first and the last scan. */
    count_t last;
    count_t every; /* Of all scans' points, one in N is kept. */
    count_t seen;  /* All points so far. */
    size_t count;
    tmini_point_t points[POINTS_MAX];
} drawing_t;

static drawing_t drawing = {.every = 1};

/* When there is no room left, keeps every second point, and from then on takes half as many new
 * ones. */
static void add_thinned(const tmini_point_t *point)
{
    if (drawing.seen++ % drawing.every != 0) {
        return;
    }
    if (drawing.count == POINTS_MAX) {
        drawing.count /= 2;
        for (size_t i = 0; i < drawing.count; i++) {
            drawing.points[i] = drawing.points[2 * i];
        }
        drawing.every *= 2;
    }
    drawing.points[drawing.count++] = *point;
}

static void take_scan(const stream_t *stream, const options_t *options)
{
    const tmini_scan_t *const scan = &stream->scan;
    const bool is_wanted =
        options->scan > 0 ? stream->number == options->scan : stream->scan.complete;
    drawing.first = drawing.first == 0 ? stream->number : drawing.first;
    drawing.last = stream->number;
    if (options->all) {
        for (size_t i = 0; i < scan->count; i++) {
            add_thinned(&scan->points[i]);
        }
    } else if (is_wanted) {
        drawing.scan = *scan;
        drawing.number = stream->number;
        drawing.count = scan->count;
        memcpy(drawing.points, scan->points, scan->count * sizeof *scan->points);
    }
}

static void name_all(figure_t *figure, const char *source)
{
    char thinned[40] = "";
    if (drawing.every > 1) {
        (void)snprintf(thinned, sizeof thinned, ", one in %llu", drawing.every);
    }
    (void)snprintf(figure->title, sizeof figure->title, "Scans %llu to %llu", drawing.first,
                   drawing.last);
    (void)snprintf(figure->subtitle, sizeof figure->subtitle,
                   "%zu points with a distance%s \xC2\xB7 %s", figure->survey.valid, thinned,
                   source);
}

static void name_one(figure_t *figure, const char *source)
{
    const unsigned frequency_chz = drawing.scan.frequency_chz;
    (void)snprintf(figure->title, sizeof figure->title, "Scan %llu%s", drawing.number,
                   drawing.scan.complete ? "" : " (incomplete)");
    (void)snprintf(figure->subtitle, sizeof figure->subtitle,
                   "%s%s \xC2\xB7 %zu points, %zu with a distance \xC2\xB7 %s",
                   frequency_chz == 0 ? "frequency " : "", frequency_text(frequency_chz),
                   figure->survey.count, figure->survey.valid, source);
}

static int write_picture(const options_t *options, const char *source)
{
    figure_t figure = {.points = drawing.points,
                       .survey = points_survey(drawing.points, drawing.count)};
    const survey_t *const survey = &figure.survey;
    const char *const name = options->operand != NULL ? recording_base_name(source) : source;
    (options->all ? name_all : name_one)(&figure, name);
    if (picture_write(options->output, &figure) != STATUS_OK) {
        return STATUS_FAILED;
    }
    message_note("%s: %s; %s; rings to %g m", options->output, figure.title, figure.subtitle,
                 picture_range_mm(survey) / 1000.0);
    if (survey->valid == 0) {
        message_note("no point has a distance: is the window covered?");
    } else if (!picture_marks_flags(survey)) {
        message_note("%zu of %zu points flagged: not marked in the picture",
                     survey->specular + survey->ambient, survey->valid);
    }
    return STATUS_OK;
}

static int draw(const options_t *options, const char *source)
{
    if (drawing.last == 0) {
        return message_fail("%s has no start packet, so no scan: record for at least a second",
                            source);
    }
    if (options->all || drawing.number > 0) {
        return write_picture(options, source);
    }
    return options->scan > 0
               ? message_fail("%s has no scan %u, only %llu to %llu", source, options->scan,
                              drawing.first, drawing.last)
               : message_fail("%s has no complete scan; --scan %llu draws an incomplete one",
                              source, drawing.last);
}

static int plot_recording(const options_t *options)
{
    static recording_t recording;
    stream_t *const stream = &recording.tape.stream;
    int status = recording_open(&recording, options);
    if (status != STATUS_OK) {
        return status;
    }
    while (recording_next(&recording)) {
        if (stream->has_scan) {
            take_scan(stream, options);
        }
    }
    if (stream_end(stream)) {
        take_scan(stream, options);
    }
    recording_close(&recording);
    status = recording_verdict(&recording);
    return status == STATUS_OK ? draw(options, recording.name) : status;
}

/* Waits for the wanted scan, or for a complete one at full speed. */
static int plot_device(device_t *device, const options_t *options)
{
    const unsigned wanted = options->scan > 0 ? options->scan : DEVICE_SCANS;
    const unsigned enough = wanted + (options->scan > 0 || options->all ? 0 : PATIENCE_SCANS);
    int status = device_start(device);
    while (status == STATUS_OK && drawing.last < enough && drawing.number < wanted) {
        if (device_next_scan(device, NULL)) {
            take_scan(&device->stream, options);
        } else {
            status = device_why(device);
        }
    }
    (void)device_stop(device);
    return status == STATUS_OK ? draw(options, device->path) : status;
}

static int run(const options_t *options)
{
    if ((options->operand != NULL && options->port != NULL) || options->output == NULL) {
        return message_usage("plot what, and into which picture (-o)? Usage: tmini plot %s",
                             command_plot.usage);
    }
    if (!picture_is_known(options->output)) {
        return message_usage("%s: the picture's name must end in .svg, .png or .pdf",
                             options->output);
    }
    if (options->all && options->scan > 0) {
        return message_usage("either --all or --scan N, not both");
    }
    return options->operand != NULL ? plot_recording(options) : device_use(options, plot_device);
}

const command_t command_plot = {
    .name = "plot",
    .usage = "[FILE|-|-p PORT] -o OUT.svg|OUT.png|OUT.pdf|- [--scan N|--all]\n"
             "           [--front DEG] [--upside-down] [--offset MM] [--mask FROM:TO]",
    .summary = "a picture of a scan",
    .details = "Draws the last complete scan, seen from above with the lidar's front up: range\n"
               "rings in metres, points coloured by intensity, interference marked. From a\n"
               "lidar, waits some scans until it is up to speed. -o - writes SVG to standard\n"
               "output.",
    .accepts = "poNAMFUOKq",
    .has_operand = true,
    .run = run,
};
