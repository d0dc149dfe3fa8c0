/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "scan_list.h"

#include <stdlib.h>
#include <string.h>

scan_list_t *scan_list_new(void)
{
    scan_list_t *const list = calloc(1, sizeof *list);
    if (list != NULL) {
        (void)tmini_scan_init(&list->builder, list->points, SCAN_CAPACITY, TMINI_FILTER_NONE);
    }
    return list;
}

void scan_list_free(scan_list_t *list)
{
    if (list == NULL) {
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        free((void *)list->scans[i].scan.points);
    }
    free(list->scans);
    free(list);
}

static bool make_room(scan_list_t *list)
{
    if (list->count < list->room) {
        return true;
    }
    const size_t room = list->room == 0 ? 64 : 2 * list->room;
    kept_scan_t *const scans = realloc(list->scans, room * sizeof *scans);
    if (scans == NULL) {
        return false;
    }
    list->scans = scans;
    list->room = room;
    return true;
}

bool scan_list_append(scan_list_t *list, const kept_scan_t *scan)
{
    const size_t size = scan->scan.count * sizeof(tmini_point_t);
    tmini_point_t *const points = malloc(size > 0 ? size : 1);
    if (points == NULL || !make_room(list)) {
        free(points);
        return false;
    }
    memcpy(points, scan->scan.points, size);
    list->scans[list->count] = *scan;
    list->scans[list->count].scan.points = points;
    list->count++;
    return true;
}

static bool keep_current(scan_list_t *list)
{
    list->is_open = false;
    list->current.scan = list->builder.scan;
    return scan_list_append(list, &list->current);
}

bool scan_list_add(scan_list_t *list, const decoder_t *decoder)
{
    const tmini_packet_t *const packet = &decoder->packet;
    if (tmini_scan_close(&list->builder, packet) && !keep_current(list)) {
        return false;
    }
    const uint64_t points_before = decoder->totals.points - packet->count;
    tmini_scan_add(&list->builder, packet, (uint32_t)(points_before / 4));
    if (tmini_packet_is_start(packet)) {
        list->is_open = true;
        list->current.number = decoder->totals.start_packets;
        list->current.first_point = points_before;
    }
    return true;
}

bool scan_list_end(scan_list_t *list)
{
    return !list->is_open || keep_current(list);
}

const kept_scan_t *scan_list_last_complete(const scan_list_t *list)
{
    for (size_t i = list->count; i > 0; i--) {
        if (list->scans[i - 1].scan.complete) {
            return &list->scans[i - 1];
        }
    }
    return NULL;
}

const kept_scan_t *scan_list_find(const scan_list_t *list, uint64_t number)
{
    for (size_t i = 0; i < list->count; i++) {
        if (list->scans[i].number == number) {
            return &list->scans[i];
        }
    }
    return NULL;
}

const tmini_point_t *scan_nearest(const tmini_scan_t *scan)
{
    const tmini_point_t *nearest = NULL;
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const bool is_nearer = nearest == NULL || point->distance_mm < nearest->distance_mm;
        if (point->distance_mm > 0 && is_nearer) {
            nearest = point;
        }
    }
    return nearest;
}

size_t scan_valid_points(const tmini_scan_t *scan)
{
    size_t count = 0;
    for (size_t i = 0; i < scan->count; i++) {
        count += scan->points[i].distance_mm > 0 ? 1 : 0;
    }
    return count;
}
