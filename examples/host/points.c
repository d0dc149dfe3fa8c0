/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "points.h"

#include <math.h>
#include <stdio.h>

#include "tmini/tmini_names.h"

/* Exact: multiples of 1/64 degree have at most six decimals. */
#define DEGREES "%.6f"

#define EIGHTH_Q6 (TMINI_FULL_CIRCLE_Q6 / 8)

static void look_at(survey_t *survey, const tmini_point_t *point)
{
    survey->valid++;
    survey->specular += point->flag == TMINI_FLAG_SPECULAR ? 1 : 0;
    survey->ambient += point->flag == TMINI_FLAG_AMBIENT ? 1 : 0;
    if (survey->nearest == NULL || point->distance_mm < survey->nearest->distance_mm) {
        survey->nearest = point;
    }
    if (point->distance_mm > survey->farthest_mm) {
        survey->farthest_mm = point->distance_mm;
    }
    survey->darkest = point->intensity < survey->darkest ? point->intensity : survey->darkest;
    survey->brightest = point->intensity > survey->brightest ? point->intensity : survey->brightest;
}

survey_t points_survey(const tmini_point_t *points, size_t count)
{
    survey_t survey = {.count = count, .darkest = UINT8_MAX};
    for (size_t i = 0; i < count; i++) {
        if (points[i].distance_mm > 0) {
            look_at(&survey, &points[i]);
        }
    }
    return survey;
}

colour_t points_colour(const survey_t *survey, uint8_t intensity)
{
    static const colour_t stops[] = {
        {0.32, 0.36, 0.89}, {0.13, 0.59, 0.89}, {0.18, 0.80, 0.67},
        {0.66, 0.89, 0.36}, {1.00, 0.84, 0.33},
    };
    const int last = (int)(sizeof stops / sizeof stops[0]) - 1;
    const double span = fmax(survey->brightest - survey->darkest, 1);
    const double place = fmin(fmax((intensity - survey->darkest) / span, 0), 1) * last;
    const int below = (int)fmin(floor(place), last - 1);
    const double share = place - below;
    const colour_t from = stops[below];
    const colour_t to = stops[below + 1];
    return (colour_t){from.red + (to.red - from.red) * share,
                      from.green + (to.green - from.green) * share,
                      from.blue + (to.blue - from.blue) * share};
}

const char *direction_name(uint16_t angle_q6)
{
    static const char *const names[8] = {
        "ahead",  "ahead right", "right", "behind right",
        "behind", "behind left", "left",  "ahead left",
    };
    return names[(angle_q6 + EIGHTH_Q6 / 2) / EIGHTH_Q6 % 8];
}

double points_degrees(const tmini_point_t *point)
{
    return floor(point->angle_q6 / 64.0 * 10) / 10;
}

const char *place_text(const tmini_point_t *point)
{
    static char text[64];
    (void)snprintf(text, sizeof text, "%.3f m at %.1f deg, %s", point->distance_mm / 1000.0,
                   points_degrees(point), direction_name(point->angle_q6));
    return text;
}

const char *faults_text(unsigned faults, char text[FAULTS_TEXT_SIZE])
{
    char names[TMINI_FAULTS_TEXT_SIZE];
    (void)snprintf(text, FAULTS_TEXT_SIZE, "faulty: %s%s%s",
                   tmini_faults_text((uint8_t)faults, names, sizeof names),
                   (faults & TMINI_FAULT_ENCODER) != 0 ? " (is the rotor blocked?)" : "",
                   (faults & TMINI_FAULT_DATA) != 0 ? " (is the window covered?)" : "");
    return faults == 0 ? "healthy" : text;
}

const char *health_text(const stream_t *stream, char text[FAULTS_TEXT_SIZE])
{
    const unsigned faults = stream_faults(stream);
    if (faults != TMINI_FAULTS_UNKNOWN) {
        return faults_text(faults, text);
    }
    return stream_reports_nothing(stream)
               ? "not reported: this unit sends no information within the stream"
               : "unknown: no revolution arrived whole";
}

/* Section 9.15. */
const char *model_text(uint8_t model)
{
    return model == TMINI_MODEL_T_MINI_PLUS  ? "T-mini Plus"
           : model == TMINI_MODEL_T_MINI_PRO ? "T-mini Pro"
           : model == 152 ? "T-mini Plus SH: four-byte samples, which this version does not read"
                          : "unknown: it may speak another protocol";
}

const char *scans_text(const stream_t *stream)
{
    static char text[80];
    const count_t incomplete = stream->scans - stream->complete;
    const int length = snprintf(text, sizeof text, "%llu complete", stream->complete);
    if (incomplete > 0) {
        (void)snprintf(text + length, sizeof text - (size_t)length, ", %llu with packets missing",
                       incomplete);
    }
    return text;
}

const char *frequency_text(unsigned frequency_chz)
{
    static char text[24];
    (void)snprintf(text, sizeof text, "%u.%u Hz", frequency_chz / 100, frequency_chz / 10 % 10);
    return frequency_chz > 0 ? text : "unknown";
}

const char *damaged_text(const stream_t *stream)
{
    static char text[24];
    const unsigned permille = stream_damaged_permille(stream);
    (void)snprintf(text, sizeof text, "%u.%u %%", permille / 10, permille % 10);
    return stream->damaged > 0 && permille == 0 ? "under 0.1 %" : text;
}

const char rows_help[] =
    "--csv:  a row for each sample of each valid packet. scan counts start packets so\n"
    "        far, packet counts packets from 0; time_ms: when the packet came, since\n"
    "        the beginning; frequency_hz: as the lidar reported last, empty before.\n"
    "  " ROWS_HEADER "\n"
    "--json: a line for each scan, an object: scan, time_ms (when it began),\n"
    "        frequency_hz, complete, packets, gaps (places where bytes are missing),\n"
    "        dropped (points), checksum_errors, faults (the health bits, 0: healthy)\n"
    "        and points: [angle in degrees, distance in mm, intensity, flag].\n"
    "        null: not known.\n"
    "Distance 0: no valid range. Flag 2: specular interference, 3: ambient light.\n"
    "Angles count clockwise, seen from above.";

static const char *hertz(unsigned frequency_chz, const char *unknown)
{
    static char text[24];
    (void)snprintf(text, sizeof text, "%u.%02u", frequency_chz / 100, frequency_chz % 100);
    return frequency_chz > 0 ? text : unknown;
}

void rows_print_packet(const stream_t *stream)
{
    const char *const reported = hertz(stream->frequency_chz, "");
    tmini_point_t point;
    for (size_t i = 0; tmini_packet_point(&stream->decoder.packet, i, &point); i++) {
        if (stream->mount != NULL) {
            tmini_mount_point(stream->mount, &point);
        }
        (void)printf("%llu,%llu,%zu," DEGREES ",%d,%d,%d,%u,%s\n", stream->start_packets,
                     stream->packets - 1, i, point.angle_q6 / 64.0, point.distance_mm,
                     point.intensity, point.flag, stream->packet_ms, reported);
    }
}

void rows_print_scan(const stream_t *stream)
{
    const tmini_scan_t *const scan = &stream->scan;
    const unsigned faults = stream_faults(stream);
    char number[16];
    (void)snprintf(number, sizeof number, "%u", faults);
    (void)printf("{\"scan\":%llu,\"time_ms\":%u"
                 ",\"frequency_hz\":%s,\"complete\":%s,\"packets\":%d,\"gaps\":%d,\"dropped\":%d,"
                 "\"checksum_errors\":%d,\"faults\":%s,\"points\":[",
                 stream->number, scan->start_ms, hertz(scan->frequency_chz, "null"),
                 scan->complete ? "true" : "false", scan->packets, scan->gaps, scan->dropped,
                 scan->checksum_errors, faults != TMINI_FAULTS_UNKNOWN ? number : "null");
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        (void)printf("%s[" DEGREES ",%d,%d,%d]", i > 0 ? "," : "", point->angle_q6 / 64.0,
                     point->distance_mm, point->intensity, point->flag);
    }
    (void)fputs("]}\n", stdout);
}
