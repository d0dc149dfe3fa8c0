/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of the driver, from any sound state: in any phase and operation, with any configuration,
 * any result of the port and any time. Each step of tmini_poll() and each public function leaves a
 * sound state; only existing events become pending; and only whole commands of two bytes are sent.
 * stubs.c replaces parser, packets, scans and CT information by their contracts. The source is
 * included, because the steps are private. */

#include "tmini.c"

#include "proof.h"

#define POINTS 4u

static tmini_t lidar;
static tmini_timing_t timing;
static tmini_point_t points[POINTS];
static tmini_point_t spare_points[POINTS];
static bool is_half_sent; /* Only the first byte of a command has been sent. */

tmini_t nondet_lidar(void);
tmini_timing_t nondet_timing(void);

/* The commands of section 3. */
static bool is_command(uint8_t code)
{
    return code == 0x60 || code == 0x65 || code == 0x90 || code == 0x92 || code == 0x40 ||
           (code >= 0x09 && code <= 0x0D);
}

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const int taken = nondet_int();
    (void)context;
    CLAIM(!lidar.is_listen_only);
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

static void port_restart(void *context)
{
    (void)context;
}

static tmini_port_t port = {.write = port_write, .now_ms = port_now_ms};

/* The user's step gets the finished scan, which the driver does not change meanwhile. */
static void step(const void *data, tmini_scan_t *scan)
{
    CLAIM(data == lidar.link.step_data && scan == &lidar.scan);
    CLAIM(scan->count <= lidar.decoder.builder.capacity);
    CLAIM(lidar.link.spare_points == NULL || scan->points != lidar.decoder.builder.scan.points);
}

/* The first byte of a command has been sent, and the second has not. */
static bool is_half(void)
{
    return (lidar.command.unsent & 1u) != 0;
}

/* In listen-only mode, no command is being sent. Without a wanted frequency, there is no frequency
 * fault. */
static bool wish_fits(void)
{
    const uint8_t phase = lidar.command.phase;
    return (!lidar.is_listen_only ||
            (lidar.command.unsent == 0 &&
             (phase >= TMINI_PHASE_LISTENING || phase == TMINI_PHASE_NONE))) &&
           (lidar.command.wanted_chz != 0 || (lidar.monitor.faults & TMINI_FAULT_FREQUENCY) == 0);
}

/* The next scan and the delivered scan are in different buffers. */
static bool buffers_are_apart(void)
{
    return lidar.link.spare_points == NULL ||
           lidar.link.spare_points != lidar.decoder.builder.scan.points;
}

static bool is_sound(void)
{
    return lidar_is_sound(&lidar) && is_half_sent == is_half() && wish_fits() &&
           buffers_are_apart();
}

static void any_link(void)
{
    port.restart = any_bool() ? port_restart : NULL;
    lidar.link.port = &port;
    lidar.link.timing = &timing;
    lidar.link.step = any_bool() ? step : NULL;
    lidar.link.spare_points = any_bool() ? spare_points : NULL;
}

static void any_decoder(void)
{
    tmini_decoder_t *const decoder = &lidar.decoder;
    decoder->parser.frame.ring = &lidar.ring;
    decoder->parser.awaiting = any_bool();
    decoder->packet.frame = &decoder->parser.frame;
    decoder->builder.open = any_bool();
    decoder->builder.ended = any_bool();
    decoder->builder.scan.complete = any_bool();
    decoder->builder.scan.upside_down = any_bool();
    decoder->builder.scan.points = points;
    ASSUME(decoder->builder.capacity <= POINTS);
}

static void any_lidar(void)
{
    lidar = nondet_lidar();
    timing = nondet_timing();
    lidar.ring = any_early_ring(LARGE_RING_SIZE);
    lidar.is_recovery_off = any_bool();
    lidar.is_listen_only = any_bool();
    lidar.line.late_ms = nondet_half();
    lidar.command.is_repeated = any_bool();
    lidar.recovery.is_lost = any_bool();
    lidar.decoder.is_whole = any_bool();
    lidar.decoder.was_whole = any_bool();
    lidar.monitor.ranges = nondet_byte();
    any_link();
    any_decoder();
    is_half_sent = is_half();
    ASSUME(is_sound());
}

void prove_driver_init(void)
{
    tmini_config_t config;
    config.port = &port;
    config.port_context = NULL;
    config.rx_buffer = any_bool() ? ring_memory : NULL;
    config.rx_size = nondet_size();
    config.rx_dma = any_bool();
    config.points = any_bool() ? points : NULL;
    config.spare_points = any_bool() ? spare_points : NULL;
    config.max_points = nondet_size();
    config.max_samples = nondet_byte();
    config.filter = nondet_byte();
    config.frequency_chz = nondet_half();
    config.listen_only = any_bool();
    config.recovery = any_bool() ? TMINI_RECOVERY_OFF : TMINI_RECOVERY_ON;
    config.step = any_bool() ? step : NULL;
    config.step_data = any_bool() ? &timing : NULL;
    config.timing = any_bool() ? &timing : NULL;
    ASSUME(config.rx_size <= LARGE_RING_SIZE);
    const tmini_status_t status = tmini_init(&lidar, &config);
    CLAIM(is_sound());
    CLAIM((status == TMINI_OK) == (lidar.link.port != NULL));
    CLAIM(status != TMINI_OK || (config.points == NULL) == (config.max_points == 0));
    CLAIM(status != TMINI_OK || config.frequency_chz == 0 || !config.listen_only);
    CLAIM(status != TMINI_OK ||
          lidar.command.wanted_chz == (config.frequency_chz + 5u) / 10u * 10u);
    CLAIM(tmini_init(NULL, &config) == TMINI_ERROR_ARGUMENT);
}

/* ---- The steps of a poll ---- */

static void any_polled_lidar(void)
{
    any_lidar();
    ASSUME(lidar.idle_ms == 0);
}

static void any_receiving_lidar(void)
{
    any_polled_lidar();
    ASSUME(!lidar.decoder.builder.ended && lidar.pending == 0);
}

void prove_driver_look(void)
{
    any_polled_lidar();
    look(&lidar);
    CLAIM(is_sound());
}

void prove_driver_take_event(void)
{
    any_polled_lidar();
    ASSUME(lidar.pending != 0);
    const unsigned before = lidar.pending;
    const tmini_event_t event = take_event(&lidar);
    CLAIM(is_sound());
    CLAIM(event >= TMINI_EVENT_STARTED && event <= TMINI_EVENT_LOST);
    CLAIM((before & ((1u << event) - 1)) == 0); /* It is the first one. */
    CLAIM(lidar.pending == (before ^ 1u << event));
}

/* A waiting packet is added before the next frame is searched for. */
void prove_driver_next(void)
{
    any_polled_lidar();
    ASSUME(lidar.pending == 0);
    const tmini_frame_type_t type = tmini_decoder_next(&lidar.decoder, 0);
    CLAIM(!lidar.decoder.builder.ended);
    CLAIM(type == TMINI_FRAME_REPLY || is_sound());
}

void prove_driver_packet(void)
{
    any_receiving_lidar();
    ASSUME(tmini_decoder_next(&lidar.decoder, 0) == TMINI_FRAME_PACKET);
    take_packet(&lidar);
    CLAIM(is_sound());
}

void prove_driver_reply(void)
{
    any_receiving_lidar();
    ASSUME(tmini_decoder_next(&lidar.decoder, 0) == TMINI_FRAME_REPLY);
    take_reply(&lidar);
    CLAIM(is_sound());
}

void prove_driver_nothing(void)
{
    any_receiving_lidar();
    const tmini_frame_type_t type = tmini_decoder_next(&lidar.decoder, 0);
    ASSUME(type == TMINI_FRAME_NONE || type == TMINI_FRAME_MORE);
    if (type == TMINI_FRAME_NONE) {
        (void)give_up_candidate(&lidar);
    }
    CLAIM(is_sound());
}

void prove_driver_advance(void)
{
    any_receiving_lidar();
    (void)advance(&lidar);
    CLAIM(is_sound());
}

/* Proves tmini_poll() itself; its steps do nothing here. */
void prove_driver_poll(void)
{
    any_lidar();
    ASSUME(!lidar.decoder.builder.ended); /* receive() has added the waiting packet. */
    const unsigned before = lidar.pending;
    const tmini_event_t event = tmini_poll(&lidar);
    CLAIM(is_sound());
    CLAIM(event <= TMINI_EVENT_MORE);
    CLAIM(before == 0 || (before >> event & 1u) != 0);
    CLAIM(before != 0 || event == TMINI_EVENT_NONE || event == TMINI_EVENT_MORE);
    CLAIM(event == TMINI_EVENT_NONE ? lidar.idle_ms > 0 || tmini_command_is_sending(&lidar)
                                    : lidar.idle_ms == 0);
}

/* ---- Commands ---- */

/* A question is accepted unless the lidar is to scan; otherwise nothing is changed. */
static void prove_question(tmini_status_t (*question)(tmini_t *), tmini_event_t event)
{
    any_lidar();
    const tmini_t before = lidar;
    const bool may_send = !lidar.is_listen_only;
    const bool is_to_scan_before = tmini_state(&before) >= TMINI_STATE_STARTING;
    const tmini_status_t status = question(&lidar);
    CLAIM(is_sound());
    CLAIM((status == TMINI_ERROR_LISTEN_ONLY) == !may_send);
    CLAIM((status == TMINI_ERROR_STATE) == (may_send && is_to_scan_before));
    CLAIM((status == TMINI_OK) == (may_send && !is_to_scan_before));
    CLAIM(status == TMINI_OK ||
          (lidar.pending == before.pending && lidar.command.phase == before.command.phase &&
           lidar.command.unsent == before.command.unsent &&
           lidar.line.now_ms == before.line.now_ms));
    CLAIM(status != TMINI_OK ||
          (tmini_recovery_wishes(&lidar, event) && tmini_state(&lidar) < TMINI_STATE_STARTING));
}

void prove_driver_request_info(void)
{
    prove_question(tmini_request_info, TMINI_EVENT_INFO);
}

void prove_driver_request_health(void)
{
    prove_question(tmini_request_health, TMINI_EVENT_HEALTH);
}

void prove_driver_request_frequency(void)
{
    prove_question(tmini_request_frequency, TMINI_EVENT_FREQUENCY);
}

void prove_driver_reboot(void)
{
    prove_question(tmini_reboot, TMINI_EVENT_REBOOTED);
}

/* A start begins at once, or after the current operation. It does nothing if the lidar is already
 * starting, scanning or being recovered. */
void prove_driver_start(void)
{
    any_lidar();
    const uint8_t phase = lidar.command.phase;
    const bool is_wanted = is_to_scan(&lidar);
    CLAIM(tmini_start(&lidar) == TMINI_OK);
    CLAIM(is_sound() && is_to_scan(&lidar));
    CLAIM(!is_wanted || lidar.command.phase == phase);
    CLAIM(tmini_state(&lidar) >= TMINI_STATE_STARTING);
}

void prove_driver_set_frequency(void)
{
    any_lidar();
    const uint16_t frequency_chz = nondet_half();
    const uint16_t before_chz = lidar.command.wanted_chz;
    const bool is_permitted = frequency_chz >= 600 && frequency_chz <= 1200;
    const tmini_status_t status = tmini_set_frequency(&lidar, frequency_chz);
    CLAIM(is_sound());
    CLAIM((status == TMINI_ERROR_ARGUMENT) == !is_permitted);
    CLAIM((status == TMINI_ERROR_LISTEN_ONLY) == (is_permitted && lidar.is_listen_only));
    CLAIM((status == TMINI_OK) == (is_permitted && !lidar.is_listen_only));
    CLAIM(lidar.command.wanted_chz ==
          (status == TMINI_OK ? (frequency_chz + 5u) / 10u * 10u : before_chz));
}

void prove_driver_stop(void)
{
    any_lidar();
    CLAIM(tmini_stop(&lidar) == TMINI_OK);
    CLAIM(is_sound() && !is_to_scan(&lidar));
    CLAIM(tmini_state(&lidar) ==
          (lidar.is_listen_only ? TMINI_STATE_UNKNOWN : TMINI_STATE_STOPPING));
}

void prove_driver_withdraw(void)
{
    any_lidar();
    const uint8_t query = nondet_byte();
    ASSUME(query >= TMINI_EVENT_INFO && query <= TMINI_EVENT_FREQUENCY);
    tmini_withdraw(&lidar, (tmini_event_t)query);
    CLAIM(is_sound() && !tmini_recovery_wishes(&lidar, (tmini_event_t)query));
}

/* The age never shrinks by the clock alone, and a task may sleep for a minute at most. */
void prove_driver_time(void)
{
    any_lidar();
    CLAIM(tmini_scan_age_ms(&lidar) <= UINT32_MAX / 2);
    CLAIM(tmini_next_poll_ms(&lidar) <= UINT16_MAX);
}
