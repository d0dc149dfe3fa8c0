/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini decode: what a recording holds, as a summary, as CSV or as JSON. */

#include "commands.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "message.h"
#include "recording.h"
#include "rows.h"
#include "summary.h"

static void print_rows(const decoder_t *decoder)
{
    tmini_point_t point;
    for (size_t i = 0; tmini_packet_point(&decoder->packet, i, &point); i++) {
        row_print(decoder->totals.start_packets, decoder->totals.packets - 1, i, &point);
    }
}

static void print_json(const decoder_t *decoder)
{
    const tmini_packet_t *const packet = &decoder->packet;
    tmini_point_t points[UINT8_MAX];
    const size_t count =
        tmini_packet_points(packet, TMINI_FILTER_NONE, points, sizeof points / sizeof points[0]);
    (void)printf("{\"scan\":%" PRIu64 ",\"packet\":%" PRIu64 ",\"start\":%s,\"ct\":%d,\"points\":",
                 decoder->totals.start_packets, decoder->totals.packets - 1,
                 tmini_packet_is_start(packet) ? "true" : "false", packet->ct);
    row_print_json(points, count);
    (void)fputs("}\n", stdout);
}

static void print_counters(const decoder_t *decoder)
{
    const decoder_totals_t *const totals = &decoder->totals;
    message_note("packets %" PRIu64 ", start packets %" PRIu64 ", points %" PRIu64
                 ", checksum errors %" PRIu64 ", bytes %" PRIu64 ", bytes skipped %" PRIu64,
                 totals->packets, totals->start_packets, totals->points, totals->checksum_errors,
                 totals->bytes, decoder_bytes_skipped(decoder));
}

static int write_counters(const char *path, const decoder_t *decoder)
{
    const decoder_totals_t *const totals = &decoder->totals;
    FILE *const file = fopen(path, "w");
    if (file == NULL) {
        return message_fail("cannot write %s: %s", path, strerror(errno));
    }
    (void)fprintf(file,
                  "{\"packets\":%" PRIu64 ",\"start_packets\":%" PRIu64 ",\"points\":%" PRIu64
                  ",\"checksum_errors\":%" PRIu64 ",\"bytes\":%" PRIu64
                  ",\"bytes_skipped\":%" PRIu64 "}\n",
                  totals->packets, totals->start_packets, totals->points, totals->checksum_errors,
                  totals->bytes, decoder_bytes_skipped(decoder));
    return fclose(file) == 0 ? STATUS_OK : message_fail("cannot write %s", path);
}

static void print_packets(decoder_t *decoder, format_t format)
{
    if (format == FORMAT_CSV) {
        (void)puts(ROW_HEADER);
    }
    while (decoder_next(decoder)) {
        if (format == FORMAT_CSV) {
            print_rows(decoder);
        } else {
            print_json(decoder);
        }
    }
}

static int summarise(decoder_t *decoder)
{
    summary_t summary;
    bool done = summary_init(&summary);
    while (done && decoder_next(decoder)) {
        done = summary_add(&summary, decoder);
    }
    if (done && decoder->totals.packets > 0) {
        done = summary_print(&summary, decoder);
    }
    summary_free(&summary);
    return done ? STATUS_OK : message_fail("not enough memory for this recording");
}

static int decode(const options_t *options, decoder_t *decoder)
{
    int status = STATUS_OK;
    if (options->format == FORMAT_TEXT) {
        status = summarise(decoder);
    } else {
        print_packets(decoder, options->format);
    }
    if (status == STATUS_OK && options->stats != NULL) {
        status = write_counters(options->stats, decoder);
    } else if (options->format != FORMAT_TEXT) {
        print_counters(decoder);
    }
    return status == STATUS_OK ? recording_verdict(options->operand, decoder) : status;
}

static int run(const options_t *options)
{
    if (options->operand == NULL) {
        return message_usage("decode what? Usage: tmini decode %s", command_decode.usage);
    }
    FILE *const file = recording_open(options->operand);
    if (file == NULL) {
        return STATUS_FAILED;
    }
    decoder_t decoder;
    decoder_init(&decoder, file, (uint8_t)options->max_samples);
    const int status = decode(options, &decoder);
    recording_close(file);
    return status;
}

const command_t command_decode = {
    .name = "decode",
    .usage = "FILE|- [--csv|--json] [--stats FILE] [--max-samples N]",
    .summary = "what a recording holds: a summary, or every sample",
    .details =
        "\n"
        "Without --csv or --json: scans, points, frequency, nearest obstacle, errors.\n"
        "--csv   " ROW_HEADER "\n"
        "        a row for each sample of each valid packet; `scan` counts start packets so\n"
        "        far, `packet` counts valid packets from 0.\n"
        "--json  an object a line for each packet; points are\n"
        "        [angle in degrees, distance in mm, intensity, flag].\n"
        "Distance 0: no valid range. Flag 2: specular interference, 3: ambient light.\n"
        "Angles count clockwise, seen from above.",
    .accepts = "CJSMq",
    .operand = "FILE",
    .run = run,
};
