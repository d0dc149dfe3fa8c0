/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "points.h"

#include <stdio.h>

#include "tmini/tmini_names.h"

#define EIGHTH_Q6 (TMINI_FULL_CIRCLE_Q6 / 8)

const tmini_point_t *points_nearest(const tmini_point_t *points, size_t count)
{
    const tmini_point_t *nearest = NULL;
    for (size_t i = 0; i < count; i++) {
        const bool is_nearer = nearest == NULL || points[i].distance_mm < nearest->distance_mm;
        if (points[i].distance_mm > 0 && is_nearer) {
            nearest = &points[i];
        }
    }
    return nearest;
}

size_t points_valid(const tmini_point_t *points, size_t count)
{
    size_t valid = 0;
    for (size_t i = 0; i < count; i++) {
        valid += points[i].distance_mm > 0 ? 1 : 0;
    }
    return valid;
}

const char *direction_name(uint16_t angle_q6)
{
    static const char *const names[8] = {
        "ahead",  "ahead to the right", "right", "behind to the right",
        "behind", "behind to the left", "left",  "ahead to the left",
    };
    return names[(angle_q6 + EIGHTH_Q6 / 2) / EIGHTH_Q6 % 8];
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

const char *frequency_text(unsigned frequency_chz)
{
    static char text[24];
    if (frequency_chz == 0) {
        return "unknown";
    }
    (void)snprintf(text, sizeof text, "%u.%u Hz", frequency_chz / 100, frequency_chz / 10 % 10);
    return text;
}

const char rows_help[] =
    "--csv   " ROWS_HEADER "\n"
    "        a row for each sample of each valid packet. scan counts start packets so far,\n"
    "        packet counts packets from 0; time_ms: when the packet came, since the beginning;\n"
    "        frequency_hz: as the lidar told last, empty before.\n"
    "--json  an object a line for each scan: scan, time_ms (when it began), frequency_hz,\n"
    "        complete, packets, gaps (places where bytes are missing), dropped (points),\n"
    "        checksum_errors, faults (the health bits, 0: healthy) and points:\n"
    "        [angle in degrees, distance in mm, intensity, flag]. null: not known.\n"
    "Distance 0: no valid range. Flag 2: specular interference, 3: ambient light.\n"
    "Angles count clockwise, seen from above.";

void rows_print_packet(const stream_t *stream, const tmini_packet_t *packet)
{
    char told[24] = "";
    tmini_point_t point;
    if (stream->frequency_chz > 0) {
        (void)snprintf(told, sizeof told, "%u.%02u", stream->frequency_chz / 100,
                       stream->frequency_chz % 100);
    }
    for (size_t i = 0; tmini_packet_point(packet, i, &point); i++) {
        (void)printf("%" PRIu64 ",%" PRIu64 ",%zu," ANGLE_FORMAT ",%d,%d,%d,%" PRIu32 ",%s\n",
                     stream->start_packets, stream->packets - 1, i, ANGLE_VALUES(point.angle_q6),
                     point.distance_mm, point.intensity, point.flag, stream->packet_ms, told);
    }
}

static void print_or_null(const char *name, bool is_known, unsigned whole, const char *rest)
{
    if (is_known) {
        (void)printf("\"%s\":%u%s,", name, whole, rest);
    } else {
        (void)printf("\"%s\":null,", name);
    }
}

void rows_print_scan(const stream_t *stream)
{
    const tmini_scan_t *const scan = &stream->scan;
    char hundredths[8];
    (void)snprintf(hundredths, sizeof hundredths, ".%02d", scan->frequency_chz % 100);
    (void)printf("{\"scan\":%" PRIu64 ",\"time_ms\":%" PRIu32 ",", stream->number, scan->start_ms);
    print_or_null("frequency_hz", scan->frequency_chz > 0, scan->frequency_chz / 100u, hundredths);
    (void)printf(
        "\"complete\":%s,\"packets\":%d,\"gaps\":%d,\"dropped\":%d,\"checksum_errors\":%d,",
        scan->complete ? "true" : "false", scan->packets, scan->gaps, scan->dropped,
        scan->checksum_errors);
    print_or_null("faults", stream->faults != FAULTS_UNKNOWN, stream->faults, "");
    (void)fputs("\"points\":[", stdout);
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        (void)printf("%s[" ANGLE_FORMAT ",%d,%d,%d]", i > 0 ? "," : "",
                     ANGLE_VALUES(point->angle_q6), point->distance_mm, point->intensity,
                     point->flag);
    }
    (void)fputs("]}\n", stdout);
}
