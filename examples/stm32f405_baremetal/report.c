/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "report.h"

#include "board.h"
#include "console.h"
#include "tmini/tmini_names.h"

#define CYCLES_PER_US (BOARD_CLOCK_HZ / 1000000u)

void report_start(void)
{
    console_text("tmini on STM32F405; keys: s stop, g go, c counters, d scans' digests");
    console_line_end();
}

void report_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    console_text("info");
    console_value("model", info->model);
    console_version("firmware", info->firmware_major, info->firmware_minor);
    console_value("hardware", info->hardware);
    console_text(" serial ");
    console_text(serial);
    console_line_end();
}

void report_health(const tmini_health_t *health)
{
    console_text("health");
    console_value("faults", health->faults);
    console_value("code", health->error_code);
    console_line_end();
}

void report_frequency(uint16_t frequency_chz)
{
    console_text("frequency");
    console_hundredths("hz", frequency_chz);
    console_line_end();
}

void report_failure(tmini_status_t status)
{
    console_text("failed: ");
    console_text(tmini_status_name(status));
    console_line_end();
}

void report_faults(uint8_t faults)
{
    console_text("fault");
    console_value("bits", faults);
    console_line_end();
}

void report_word(const char *word)
{
    console_text(word);
    console_line_end();
}

/* The CRC-32 of IEEE 802.3, computed four bits at a time. */
static uint32_t add_byte(uint32_t crc, unsigned byte)
{
    static const uint32_t table[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
        0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
        0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
    };
    crc ^= byte & 0xFFu;
    crc = crc >> 4 ^ table[crc & 15u];
    return crc >> 4 ^ table[crc & 15u];
}

static uint32_t add_point(uint32_t crc, const tmini_point_t *point)
{
    crc = add_byte(crc, point->angle_q6);
    crc = add_byte(crc, (unsigned)point->angle_q6 >> 8);
    crc = add_byte(crc, point->distance_mm);
    crc = add_byte(crc, (unsigned)point->distance_mm >> 8);
    crc = add_byte(crc, point->intensity);
    return add_byte(crc, point->flag);
}

void report_digest(const tmini_scan_t *scan)
{
    uint32_t crc = 0xFFFFFFFFu;
    for (unsigned i = 0; i < scan->count; i++) {
        crc = add_point(crc, &scan->points[i]);
    }
    console_text("scan");
    console_value("points", scan->count);
    console_hex("crc", ~crc);
    console_value("gaps", scan->gaps);
    console_value("complete", scan->complete);
    console_hundredths("hz", scan->frequency_chz);
    console_line_end();
}

static uint16_t nearest(const obstacle_t *obstacle)
{
    uint16_t least_mm = 0;
    for (unsigned i = 0; i < OBSTACLE_SECTORS; i++) {
        const uint16_t mm = obstacle->sectors[i].nearest_mm;
        if (mm != 0 && (least_mm == 0 || mm < least_mm)) {
            least_mm = mm;
        }
    }
    return least_mm;
}

void report_status(const tmini_counters_t *counters, const obstacle_t *obstacle,
                   const report_status_t *status)
{
    console_text("status");
    console_value("scans", counters->scans);
    console_value("points", status->points);
    console_value("nearest_mm", nearest(obstacle));
    console_value("ahead_mm", obstacle->sectors[0].nearest_mm);
    console_text(status->may_move ? " drive on" : " drive off");
    console_value("errors", counters->checksum_errors);
    console_value("overrun", counters->bytes_overrun);
    console_hundredths("isr_us", status->worst_cycles * 100u / CYCLES_PER_US);
    console_line_end();
}

/* Bytes continue to come in. So this repeats until none has come while the counters were read. */
static void take_counters(const tmini_t *lidar, const tmini_stm32_usart_t *port,
                          tmini_counters_t *counters, tmini_stm32_usart_counters_t *received)
{
    uint32_t bytes;
    do {
        tmini_stm32_usart_counters(port, received);
        bytes = received->bytes;
        tmini_counters(lidar, counters);
        tmini_stm32_usart_counters(port, received);
    } while (bytes != received->bytes);
}

void report_counters(const tmini_t *lidar, const tmini_stm32_usart_t *port)
{
    tmini_counters_t counters;
    tmini_stm32_usart_counters_t received;
    take_counters(lidar, port, &counters, &received);
    console_text("counters");
    console_value("bytes", received.bytes);
    console_value("in_packets", counters.bytes_in_packets);
    console_value("in_replies", counters.bytes_in_replies);
    console_value("skipped", counters.bytes_skipped);
    console_value("overrun", counters.bytes_overrun);
    console_value("pending", counters.bytes_pending);
    console_value("packets", counters.packets);
    console_value("checksum_errors", counters.checksum_errors);
    console_value("scans", counters.scans);
    console_value("timeouts", counters.timeouts);
    console_value("losses", counters.losses);
    console_value("recoveries", counters.recoveries);
    console_value("restarts", counters.restarts);
    console_value("usart_overruns", received.overruns);
    console_value("stack", board_stack_used());
    console_line_end();
}
