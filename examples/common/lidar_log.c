/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar_log.h"

#include "tmini/tmini_names.h"

#define PERIOD_MS 1000u
#define DIGITS 10u

static void print_number(const lidar_log_t *log, uint32_t number)
{
    char text[DIGITS + 1];
    char *first = &text[DIGITS];
    *first = '\0';
    do {
        *--first = (char)('0' + number % 10u);
        number /= 10u;
    } while (number > 0);
    log->print(first);
}

static void print_value(const lidar_log_t *log, const char *before, uint32_t number)
{
    log->print(before);
    print_number(log, number);
}

static void print_info(const lidar_log_t *log, const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    print_value(log, "model ", info->model);
    print_value(log, ", firmware ", info->firmware_major);
    print_value(log, ".", info->firmware_minor);
    print_value(log, ", hardware ", info->hardware);
    log->print(", serial ");
    log->print(serial);
    log->print("\n");
}

static void print_faults(const lidar_log_t *log, uint8_t faults)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    log->print("faults: ");
    log->print(tmini_faults_text(faults, text, sizeof text));
    log->print("\n");
}

static void print_failure(const lidar_log_t *log, tmini_status_t error)
{
    log->print("no answer: ");
    log->print(tmini_status_name(error));
    log->print(". Wiring, 5 V?\n");
}

void lidar_log_event(lidar_log_t *log, tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_INFO:
        print_info(log, tmini_info(log->lidar));
        break;
    case TMINI_EVENT_SCAN:
        log->gaps += tmini_scan(log->lidar)->gaps;
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        print_faults(log, tmini_faults(log->lidar));
        break;
    case TMINI_EVENT_PAUSED:
        log->print("paused, to set the frequency\n");
        break;
    case TMINI_EVENT_LOST:
        log->print("lost; trying to get it back\n");
        break;
    case TMINI_EVENT_RECOVERED:
        log->print("back again\n");
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        print_failure(log, tmini_command_error(log->lidar));
        break;
    default:
        break;
    }
}

bool lidar_log_is_due(lidar_log_t *log, uint32_t now_ms)
{
    if (now_ms - log->reported_ms < PERIOD_MS) {
        return false;
    }
    log->reported_ms += PERIOD_MS;
    return true;
}

void lidar_log_status(const lidar_log_t *log, uint16_t ahead_mm, bool stop, uint32_t bytes,
                      uint32_t lost)
{
    tmini_counters_t counters;
    tmini_counters(log->lidar, &counters);
    print_number(log, counters.scans);
    print_value(log, " scans, nearest in front ", ahead_mm);
    log->print(stop ? " mm, STOP" : " mm, go");
    print_value(log, "; bytes ", bytes);
    print_value(log, ", lost: ", counters.checksum_errors);
    print_value(log, " checksums, ", counters.bytes_overrun + lost);
    print_value(log, " bytes, ", log->gaps);
    log->print(" gaps\n");
}
