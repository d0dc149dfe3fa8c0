/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The firmware requests information and health, receives four scans at 12 Hz and stops the lidar.
 * It writes its results as text to `log_text`, which the test reads from memory: the UART is in use
 * for the lidar. */

#include "tmini/tmini_names.h"
#include "board.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SCANS 4u

char log_text[128 * 1024];
volatile uint32_t log_length;
volatile uint32_t finished;

static tmini_t lidar;
static uint8_t rx[512];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static unsigned step;
static unsigned scans;

/* Printed at the end: the processor would not keep up with the lidar. */
static tmini_scan_t kept[SCANS];
static tmini_point_t kept_points[SCANS][TMINI_SCAN_POINTS_TYPICAL];

/* ------------------------------------------------------------------------------------- the log */

__attribute__((format(printf, 1, 2))) static void put(const char *format, ...)
{
    const size_t room = sizeof log_text - log_length;
    va_list arguments;
    va_start(arguments, format);
    const int count = vsnprintf(&log_text[log_length], room, format, arguments);
    va_end(arguments);
    log_length += (size_t)count < room ? (uint32_t)count : 0;
}

static void put_named(const char *name, uint32_t number)
{
    put("%s %" PRIu32 "\n", name, number);
}

static void log_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    put("model %u\nfirmware_major %u\nfirmware_minor %u\nserial %s\n", info->model,
        info->firmware_major, info->firmware_minor, serial);
}

static void log_scan(const tmini_scan_t *scan)
{
    put_named("scan", scan->count);
    put_named("complete", scan->complete);
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        put("point %u %u %u %u\n", point->angle_q6, point->distance_mm, point->intensity,
            point->flag);
    }
}

static void log_turn(void)
{
    tmini_ct_info_t info;
    tmini_ct_info(&lidar, &info);
    put_named("turn_known", info.known);
    put_named("turn_number", info.number);
}

static void log_totals(void)
{
    const board_statistics_t board = board_statistics();
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    for (unsigned i = 0; i < SCANS; i++) {
        log_scan(&kept[i]);
    }
    put_named("packets", counters.packets);
    put_named("checksum_errors", counters.checksum_errors);
    put_named("bytes_overrun", counters.bytes_overrun);
    put_named("losses", counters.losses);
    put_named("timeouts", counters.timeouts);
    put_named("interrupts", board.interrupts);
    put_named("most_bytes_an_interrupt", board.most_bytes);
    put_named("fifo_overflows", board.overflows);
    put_named("stack_used", board_stack_used());
    put_named("lidar_struct", (uint32_t)sizeof lidar);
}

/* -------------------------------------------------------------------------------------- the job */

static void next_step(void)
{
    static tmini_status_t (*const steps[])(tmini_t *) = {tmini_request_info, tmini_request_health,
                                                         tmini_start, tmini_stop};
    if (step < sizeof steps / sizeof steps[0]) {
        (void)steps[step++](&lidar);
    } else {
        log_totals();
        finished = 1;
    }
}

static void take_scan(void)
{
    if (scans < SCANS) {
        tmini_scan_t *const scan = &kept[scans];
        *scan = *tmini_scan(&lidar);
        memcpy(kept_points[scans], scan->points, scan->count * sizeof *scan->points);
        scan->points = kept_points[scans++];
    }
    if (scans == SCANS) {
        log_turn();
        next_step();
        scans++; /* Scans that arrive after the last wanted one are ignored. */
    }
}

static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_NONE:
        board_sleep();
        break;
    case TMINI_EVENT_INFO:
        log_info(tmini_info(&lidar));
        next_step();
        break;
    case TMINI_EVENT_HEALTH:
        put_named("faults", tmini_health(&lidar)->faults);
        next_step();
        break;
    case TMINI_EVENT_FREQUENCY:
        put_named("frequency_chz", tmini_frequency_chz(&lidar));
        break;
    case TMINI_EVENT_STARTED:
        put("started\n");
        break;
    case TMINI_EVENT_SCAN:
        take_scan();
        break;
    case TMINI_EVENT_STOPPED:
        put("stopped\n");
        next_step();
        break;
    default:
        put_named("unexpected_event", event);
        finished = 1;
        break;
    }
}

int main(void)
{
    const tmini_config_t config = {
        .port = &board_port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1200,
    };
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        put("not set up\n");
        finished = 1;
        return 1;
    }
    board_open(&lidar);
    next_step();
    while (finished == 0) {
        handle(tmini_poll(&lidar));
    }
    return 0;
}
