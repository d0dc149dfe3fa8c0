/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The driver, from any sound state: whatever phase and operation, whatever the port answers and the
 * clock says, whatever is set up. Each step of tmini_poll() and each public function leaves a sound
 * state; only events that there are become pending; and only whole commands of two bytes leave.
 * stubs.c stands in for parser, packets, scans and CT information, by their contracts. The steps
 * are private, so the source is included. */

#include "tmini.c"

#include "proof.h"

#define POINTS 4u

static tmini_t lidar;
static tmini_timing_t timing;
static tmini_point_t points[POINTS];
static bool is_half_sent; /* A command's first byte has left, and not its second. */

tmini_t nondet_lidar(void);
tmini_timing_t nondet_timing(void);

/* Section 3. */
static bool is_command(uint8_t code)
{
    return code == 0x60 || code == 0x65 || code == 0x90 || code == 0x92 || code == 0x40 ||
           (code >= 0x09 && code <= 0x0D);
}

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const int taken = nondet_int();
    (void)context;
    CLAIM(count == (is_half_sent ? 1 : 2));
    CLAIM(is_half_sent || bytes[0] == 0xA5);
    CLAIM(is_command(bytes[count - 1]));
    if (taken >= 1) {
        is_half_sent = count == 2 && taken == 1;
    }
    return taken;
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return nondet_word();
}

static const tmini_port_t port = {.write = port_write, .now_ms = port_now_ms};

static bool is_sound(void)
{
    return lidar_is_sound(&lidar) && is_half_sent == lidar.command.sync_sent;
}

static void any_lidar(void)
{
    lidar = nondet_lidar();
    timing = nondet_timing();
    lidar.ring = any_early_ring(LARGE_RING_SIZE);
    lidar.parser.frame.ring = &lidar.ring;
    lidar.parser.awaiting = any_bool();
    lidar.packet_waits = any_bool();
    lidar.is_settled = any_bool();
    lidar.is_recovery_off = any_bool();
    lidar.are_held = any_bool();
    lidar.command.sync_sent = any_bool();
    lidar.builder.open = any_bool();
    lidar.builder.scan.complete = any_bool();
    lidar.monitor.is_complete = any_bool();
    lidar.monitor.has_range = any_bool();
    lidar.link.port = &port;
    lidar.link.timing = &timing;
    lidar.builder.scan.points = points;
    lidar.latest.packet.frame = &lidar.parser.frame;
    is_half_sent = lidar.command.sync_sent;
    ASSUME(lidar.builder.capacity <= POINTS);
    ASSUME(lidar_is_sound(&lidar));
}

void prove_driver_init(void)
{
    tmini_config_t config;
    config.port = &port;
    config.rx_buffer = any_bool() ? ring_memory : NULL;
    config.rx_size = nondet_size();
    config.rx_dma = any_bool();
    config.points = any_bool() ? points : NULL;
    config.max_points = nondet_size();
    config.filter = nondet_byte();
    config.max_samples = nondet_byte();
    config.timing = any_bool() ? &timing : NULL;
    config.recovery = any_bool() ? TMINI_RECOVERY_OFF : TMINI_RECOVERY_ON;
    ASSUME(config.rx_size <= LARGE_RING_SIZE);
    const tmini_status_t status = tmini_init(&lidar, &config);
    CLAIM(is_sound());
    CLAIM((status == TMINI_OK) == (lidar.link.port != NULL));
    CLAIM(status != TMINI_OK || (config.points == NULL) == (config.max_points == 0));
    CLAIM(tmini_init(NULL, &config) == TMINI_ERROR_ARGUMENT);
    REACHED();
}

/* ---- The steps of a poll ---- */

static void any_polled_lidar(void)
{
    any_lidar();
    ASSUME(!lidar.is_settled);
}

static void any_receiving_lidar(void)
{
    any_polled_lidar();
    ASSUME(!lidar.packet_waits && lidar.pending == 0);
}

void prove_driver_update_time(void)
{
    any_polled_lidar();
    update_time(&lidar);
    CLAIM(is_sound());
    REACHED();
}

void prove_driver_take_event(void)
{
    any_polled_lidar();
    ASSUME(lidar.pending != 0);
    const unsigned before = lidar.pending;
    const tmini_event_t event = take_event(&lidar);
    CLAIM(is_sound());
    CLAIM(event >= TMINI_EVENT_STARTED && event <= TMINI_EVENT_SCAN);
    CLAIM((before & ((1u << event) - 1)) == 0); /* The first. */
    CLAIM(lidar.pending == (before ^ 1u << event));
    REACHED();
}

void prove_driver_add_waiting_packet(void)
{
    any_polled_lidar();
    add_waiting_packet(&lidar);
    CLAIM(is_sound() && !lidar.packet_waits);
    REACHED();
}

void prove_driver_packet(void)
{
    any_receiving_lidar();
    ASSUME(tmini_parser_next(&lidar.parser) == TMINI_FRAME_PACKET);
    take_packet(&lidar);
    CLAIM(is_sound());
    REACHED();
}

void prove_driver_reply(void)
{
    any_receiving_lidar();
    ASSUME(tmini_parser_next(&lidar.parser) == TMINI_FRAME_REPLY);
    take_reply(&lidar);
    CLAIM(is_sound());
    REACHED();
}

void prove_driver_nothing(void)
{
    any_receiving_lidar();
    const tmini_frame_type_t type = tmini_parser_next(&lidar.parser);
    ASSUME(type == TMINI_FRAME_NONE || type == TMINI_FRAME_MORE);
    if (type == TMINI_FRAME_NONE) {
        (void)give_up_candidate(&lidar);
    }
    CLAIM(is_sound());
    REACHED();
}

void prove_driver_keep_time(void)
{
    any_receiving_lidar();
    keep_time(&lidar);
    CLAIM(is_sound());
    REACHED();
}

/* What tmini_poll() adds to its steps, which do nothing here. */
void prove_driver_poll(void)
{
    any_lidar();
    ASSUME(!lidar.packet_waits); /* receive() has added it. */
    const unsigned before = lidar.pending;
    const tmini_event_t event = tmini_poll(&lidar);
    CLAIM(is_sound());
    CLAIM(event <= TMINI_EVENT_MORE);
    CLAIM(before == 0 || (before >> event & 1u) != 0);
    CLAIM(before != 0 || event == TMINI_EVENT_NONE || event == TMINI_EVENT_MORE);
    REACHED();
}

/* ---- Commands ---- */

static void prove_command(tmini_status_t (*command)(tmini_t *))
{
    any_lidar();
    const tmini_t before = lidar;
    const tmini_status_t status = command(&lidar);
    CLAIM(is_sound());
    CLAIM(status == TMINI_OK || status == TMINI_ERROR_STATE || status == TMINI_ERROR_BUSY);
    CLAIM((status == TMINI_OK) == (before.state <= TMINI_STATE_IDLE));
    CLAIM((status == TMINI_ERROR_STATE) == (before.state >= TMINI_STATE_SCANNING));
    CLAIM(status == TMINI_OK || (lidar.state == before.state && lidar.pending == before.pending &&
                                 lidar.command.phase == before.command.phase &&
                                 lidar.command.unsent == before.command.unsent &&
                                 lidar.link.now_ms == before.link.now_ms));
    CLAIM(status != TMINI_OK || lidar.state != TMINI_STATE_SCANNING);
}

void prove_driver_start(void)
{
    prove_command(tmini_start);
    REACHED();
}

void prove_driver_request_info(void)
{
    prove_command(tmini_request_info);
    REACHED();
}

void prove_driver_request_health(void)
{
    prove_command(tmini_request_health);
    REACHED();
}

void prove_driver_request_frequency(void)
{
    prove_command(tmini_request_frequency);
    REACHED();
}

void prove_driver_reboot(void)
{
    prove_command(tmini_reboot);
    REACHED();
}

void prove_driver_set_frequency(void)
{
    any_lidar();
    const uint16_t frequency_chz = nondet_half();
    const tmini_status_t status = tmini_set_frequency(&lidar, frequency_chz);
    CLAIM(is_sound());
    CLAIM(status == TMINI_ERROR_ARGUMENT || (frequency_chz >= 600 && frequency_chz <= 1200));
    REACHED();
}

void prove_driver_stop(void)
{
    any_lidar();
    CLAIM(tmini_stop(&lidar) == TMINI_OK);
    CLAIM(is_sound());
    CLAIM(lidar.state == TMINI_STATE_STOPPING || lidar.state == TMINI_STATE_UNKNOWN ||
          lidar.state == TMINI_STATE_IDLE);
    REACHED();
}

void prove_driver_cancel(void)
{
    any_lidar();
    tmini_cancel(&lidar);
    CLAIM(is_sound());
    REACHED();
}
