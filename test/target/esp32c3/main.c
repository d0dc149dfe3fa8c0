/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The firmware requests information and health, receives four scans at 12 Hz and stops the lidar.
 * It writes its results as text to `log_text`, which the test reads from memory: the UART is in use
 * for the lidar. */

#include "tmini/tmini_names.h"
#include "board.h"

#define SCANS 4u

char log_text[128 * 1024];
volatile uint32_t log_length;
volatile uint32_t finished;

static tmini_t lidar;
static uint8_t rx[512];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static unsigned step;
static unsigned scans;

/* ------------------------------------------------------------------------------------- the log */

static void put(char character)
{
    if (log_length < sizeof log_text) {
        log_text[log_length] = character;
        log_length++;
    }
}

static void put_text(const char *text)
{
    while (*text != '\0') {
        put(*text++);
    }
}

static void put_number(uint32_t number)
{
    char digits[10];
    unsigned count = 0;
    do {
        digits[count++] = (char)('0' + number % 10u);
        number /= 10u;
    } while (number > 0);
    while (count > 0) {
        put(digits[--count]);
    }
}

static void put_named(const char *name, uint32_t number)
{
    put_text(name);
    put(' ');
    put_number(number);
    put('\n');
}

static void log_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    put_named("model", info->model);
    put_named("firmware_major", info->firmware_major);
    put_named("firmware_minor", info->firmware_minor);
    put_text("serial ");
    put_text(serial);
    put('\n');
}

static void log_scan(const tmini_scan_t *scan)
{
    put_named("scan", scan->count);
    put_named("complete", scan->complete);
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        put_text("point ");
        put_number(point->angle_q6);
        put(' ');
        put_number(point->distance_mm);
        put(' ');
        put_number(point->intensity);
        put(' ');
        put_number(point->flag);
        put('\n');
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
    switch (step++) {
    case 0:
        (void)tmini_request_info(&lidar);
        break;
    case 1:
        (void)tmini_request_health(&lidar);
        break;
    case 2:
        (void)tmini_start(&lidar);
        break;
    case 3:
        (void)tmini_stop(&lidar);
        break;
    default:
        log_totals();
        finished = 1;
        break;
    }
}

static void take_scan(void)
{
    if (scans < SCANS) {
        scans++;
        log_scan(tmini_scan(&lidar));
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
        put_text("started\n");
        break;
    case TMINI_EVENT_SCAN:
        take_scan();
        break;
    case TMINI_EVENT_STOPPED:
        put_text("stopped\n");
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
        put_text("not set up\n");
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
