/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "summary.h"

#include <inttypes.h>
#include <stdio.h>

#include "direction.h"
#include "faults.h"

bool summary_init(summary_t *summary)
{
    *summary = (summary_t){.scans = scan_list_new()};
    tmini_turn_init(&summary->turn);
    return summary->scans != NULL;
}

void summary_free(summary_t *summary)
{
    scan_list_free(summary->scans);
}

bool summary_add(summary_t *summary, const decoder_t *decoder)
{
    const tmini_packet_t *const packet = &decoder->packet;
    if (tmini_packet_is_start(packet) && packet->gap == 1) {
        summary->guard_bytes++;
    }
    summary->bytes_until = decoder_bytes_skipped(decoder);
    if (decoder->totals.packets == 1) {
        summary->bytes_before = summary->bytes_until;
    }
    (void)tmini_turn_add(&summary->turn, packet);
    return scan_list_add(summary->scans, decoder);
}

static void print_scans(const scan_list_t *list)
{
    size_t complete = 0;
    for (size_t i = 0; i < list->count; i++) {
        complete += list->scans[i].scan.complete ? 1 : 0;
    }
    (void)printf("scans       %zu complete, %zu cut short or with packets missing\n", complete,
                 list->count - complete);
}

static void print_points(const scan_list_t *list)
{
    uint64_t points = 0;
    uint64_t valid = 0;
    for (size_t i = 0; i < list->count; i++) {
        points += list->scans[i].scan.count;
        valid += scan_valid_points(&list->scans[i].scan);
    }
    (void)printf("points      %" PRIu64 " in these scans, %" PRIu64 " of them with a distance\n",
                 points, valid);
}

static void print_frequency(const scan_list_t *list)
{
    unsigned lowest = 0;
    unsigned highest = 0;
    for (size_t i = 0; i < list->count; i++) {
        const unsigned frequency_chz = list->scans[i].scan.frequency_chz;
        lowest =
            frequency_chz > 0 && (lowest == 0 || frequency_chz < lowest) ? frequency_chz : lowest;
        highest = frequency_chz > highest ? frequency_chz : highest;
    }
    if (lowest == highest) {
        (void)printf("frequency   %u.%u Hz\n", lowest / 100, lowest / 10 % 10);
    } else {
        (void)printf("frequency   %u.%u to %u.%u Hz\n", lowest / 100, lowest / 10 % 10,
                     highest / 100, highest / 10 % 10);
    }
}

static void print_nearest(const scan_list_t *list)
{
    const kept_scan_t *const last = scan_list_last_complete(list);
    const tmini_point_t *const nearest = last != NULL ? scan_nearest(&last->scan) : NULL;
    if (nearest == NULL) {
        (void)printf("nearest     nothing in sight in a complete scan\n");
        return;
    }
    (void)printf("nearest     %d.%03d m at %d.%d degrees clockwise: %s (scan %" PRIu64 ")\n",
                 nearest->distance_mm / 1000, nearest->distance_mm % 1000, nearest->angle_q6 / 64,
                 nearest->angle_q6 % 64 * 10 / 64, direction_name(nearest->angle_q6), last->number);
}

static void print_unit(const tmini_turn_t *turn)
{
    tmini_turn_info_t info;
    tmini_turn_info(turn, &info);
    if ((info.known & TMINI_KNOWN_FIRMWARE) != 0) {
        (void)printf("unit        firmware %d.%d, hardware %d\n", info.firmware_major,
                     info.firmware_minor, info.hardware);
    }
    if ((info.known & TMINI_KNOWN_FAULTS) != 0) {
        char text[FAULTS_TEXT_SIZE];
        (void)printf("health      %s\n", faults_text(info.faults, text));
    } else {
        (void)printf("health      not told: this unit sends no information within the stream\n");
    }
}

static void print_errors(const summary_t *summary, const decoder_totals_t *totals)
{
    const uint64_t between = summary->bytes_until - summary->bytes_before - summary->guard_bytes;
    (void)printf("errors      %" PRIu64 " wrong checksums, %" PRIu64
                 " stray bytes between packets\n",
                 totals->checksum_errors, between);
}

static void print_stream(const summary_t *summary, const decoder_t *decoder)
{
    (void)printf("stream      %" PRIu64 " bytes: %" PRIu64 " packets, %" PRIu64
                 " guard bytes; %" PRIu64 " bytes before the first packet, %" PRIu64
                 " after the last\n",
                 decoder->totals.bytes, decoder->totals.packets, summary->guard_bytes,
                 summary->bytes_before, decoder_bytes_skipped(decoder) - summary->bytes_until);
}

bool summary_print(summary_t *summary, const decoder_t *decoder)
{
    const decoder_totals_t *const totals = &decoder->totals;
    if (!scan_list_end(summary->scans)) {
        return false;
    }
    print_scans(summary->scans);
    print_points(summary->scans);
    print_frequency(summary->scans);
    print_nearest(summary->scans);
    print_unit(&summary->turn);
    print_errors(summary, totals);
    print_stream(summary, decoder);
    return true;
}
