/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The driver, with JavaScript as its port. */

#include "web.h"

#include <stdbool.h>

#include "tape.h"
#include "tmini/tmini.h"
#include "tmini/tmini_names.h"

/* More than two seconds of data: a page in the background runs rarely. */
#define RX_SIZE 32768u

/* Commands have two bytes; JavaScript takes them after each poll. */
#define SENT_MAX 64u

static struct {
    tmini_t lidar;
    tmini_timing_t timing;
    uint8_t rx[RX_SIZE];
    tmini_point_t points[WEB_SCAN_POINTS];
    uint8_t sent[SENT_MAX];
    uint32_t sent_count;
    uint32_t received;
    uint32_t now_ms;
    tape_t tape; /* Counts LastCRC bytes, which the driver counts as skipped. */
} live;

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    size_t taken = 0;
    (void)context;
    while (taken < count && live.sent_count < SENT_MAX) {
        live.sent[live.sent_count++] = bytes[taken++];
    }
    return (int)taken;
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return live.now_ms;
}

/* A browser delivers bytes late and in blocks of any size, so a pause means nothing. A lidar that
 * has just been plugged in needs some seconds before it receives commands. */
static const tmini_timing_t *patience(void)
{
    live.timing = tmini_timing_default;
    live.timing.frame_timeout_ms = 500;
    live.timing.max_pause_ms = 0;
    live.timing.reply_timeout_ms = 1000;
    live.timing.max_attempts = 5;
    live.timing.back_off_max_ms = 2000;
    return &live.timing;
}

EXPORTED int lidar_init(uint32_t now_ms, uint32_t listen_only)
{
    static const tmini_port_t port = {port_write, port_now_ms, NULL, NULL};
    const tmini_config_t config = {
        .port = &port,
        .rx_buffer = live.rx,
        .rx_size = sizeof live.rx,
        .points = live.points,
        .max_points = WEB_SCAN_POINTS,
        .listen_only = listen_only != 0,
        .timing = patience(),
    };
    live.now_ms = now_ms;
    live.sent_count = 0;
    live.received = 0;
    tape_begin(&live.tape, NULL, 0);
    shown_clear();
    return tmini_init(&live.lidar, &config);
}

/* `count` bytes in `transfer` have been received. */
EXPORTED void lidar_feed(uint32_t count)
{
    live.received += count;
    (void)tmini_feed(&live.lidar, web_transfer, count);
    (void)tape_feed(&live.tape, web_transfer, count);
    while (tape_next(&live.tape) != TAPE_NEEDS_BYTES) {
    }
}

/* Bytes were lost before they reached the page, after those fed so far. */
EXPORTED void lidar_gap(void)
{
    tmini_feed_gap(&live.lidar);
}

/* The next event; if it is a scan, this scan is shown. */
EXPORTED uint32_t lidar_poll(uint32_t now_ms)
{
    live.now_ms = now_ms;
    const tmini_event_t event = tmini_poll(&live.lidar);
    if (event == TMINI_EVENT_SCAN) {
        shown_take(tmini_scan(&live.lidar));
    }
    return event;
}

/* Copies to `transfer` what the driver has sent since the last call. */
EXPORTED uint32_t lidar_sent(void)
{
    const uint32_t count = live.sent_count;
    for (uint32_t i = 0; i < count; i++) {
        web_transfer[i] = live.sent[i];
    }
    live.sent_count = 0;
    return count;
}

EXPORTED int lidar_start(void)
{
    return tmini_start(&live.lidar);
}

EXPORTED int lidar_stop(void)
{
    return tmini_stop(&live.lidar);
}

EXPORTED int lidar_info(void)
{
    return tmini_request_info(&live.lidar);
}

EXPORTED int lidar_health(void)
{
    return tmini_request_health(&live.lidar);
}

EXPORTED int lidar_frequency(void)
{
    return tmini_request_frequency(&live.lidar);
}

EXPORTED int lidar_set_frequency(uint32_t frequency_chz)
{
    return tmini_set_frequency(&live.lidar, (uint16_t)frequency_chz);
}

EXPORTED int lidar_reboot(void)
{
    return tmini_reboot(&live.lidar);
}

EXPORTED uint32_t lidar_state(void)
{
    return tmini_state(&live.lidar);
}

EXPORTED uint32_t lidar_faults(void)
{
    return tmini_faults(&live.lidar);
}

EXPORTED int lidar_error(void)
{
    return tmini_command_error(&live.lidar);
}

EXPORTED uint32_t lidar_frequency_chz(void)
{
    return tmini_frequency_chz(&live.lidar);
}

EXPORTED uint32_t lidar_numbers(void)
{
    tmini_counters_t counters;
    tmini_ct_info_t ct;
    tmini_counters(&live.lidar, &counters);
    tmini_ct_info(&live.lidar, &ct);
    uint32_t last_crc_bytes = (uint32_t)live.tape.stream.last_crc_bytes;
    last_crc_bytes =
        last_crc_bytes < counters.bytes_skipped ? last_crc_bytes : counters.bytes_skipped;
    numbers_clear();
    numbers_put("bytes", live.received);
    numbers_put("packets", counters.packets);
    numbers_put("checksumErrors", counters.checksum_errors);
    numbers_put("bytesInPackets", counters.bytes_in_packets);
    numbers_put("bytesInReplies", counters.bytes_in_replies);
    numbers_put("bytesSkipped", counters.bytes_skipped - last_crc_bytes);
    numbers_put("lastCrcBytes", last_crc_bytes);
    numbers_put("bytesOverrun", counters.bytes_overrun);
    numbers_put("scans", counters.scans);
    numbers_put("timeouts", counters.timeouts);
    numbers_put("losses", counters.losses);
    numbers_put("recoveries", counters.recoveries);
    numbers_put("restarts", counters.restarts);
    numbers_put("reboots", counters.reboots);
    numbers_put_ct(&ct);
    return numbers_count();
}

/* The serial number's characters are in `transfer`. */
EXPORTED uint32_t lidar_info_numbers(void)
{
    const tmini_info_t *info = tmini_info(&live.lidar);
    tmini_serial_text(info, (char *)web_transfer);
    numbers_clear();
    numbers_put("model", info->model);
    numbers_put("firmwareMajor", info->firmware_major);
    numbers_put("firmwareMinor", info->firmware_minor);
    numbers_put("hardware", info->hardware);
    return numbers_count();
}

EXPORTED uint32_t lidar_health_numbers(void)
{
    const tmini_health_t *health = tmini_health(&live.lidar);
    numbers_clear();
    numbers_put("faults", health->faults);
    numbers_put("errorCode", health->error_code);
    return numbers_count();
}
