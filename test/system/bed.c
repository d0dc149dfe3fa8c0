/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "bed.h"

#include "tmini/tmini_names.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOCK_AT_THE_BEGINNING 0xFFFFE000u /* It wraps around after eight seconds. */
#define STOP 0x65u
#define TIMER_US 10000u
#define BYTE_US 44u
#define SCANS 5u         /* In a row, before a wish counts as fulfilled. */
#define IDLE_US 1500000u /* Idle, before it does. */
/* Announced by LOST: a second after the last packet. A damaged one may hide it for 100 ms more,
 * until it is given up. */
#define SILENCE_US 1150000u
#define MOST_EVENTS_PER_SECOND 10u

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    bed_t *const bed = context;
    const size_t room = sizeof bed->outbox - bed->outbox_count;
    const size_t most = bed->write_max == 0 || bed->write_max > room ? room : bed->write_max;
    const size_t all = count < most ? count : most;
    const size_t taken = bed->writes_short ? random_below(&bed->random, (uint32_t)all + 1) : all;
    for (size_t i = 0; i < taken; i++) {
        bed->outbox[bed->outbox_count++] = bytes[i];
        bed->stop_sent = bed->stop_sent || bytes[i] == STOP;
    }
    bed->sent += (uint32_t)taken;
    return (int)taken;
}

static uint32_t port_now_ms(void *context)
{
    const bed_t *const bed = context;
    const uint64_t us = bed->now_us * (uint64_t)(1000000 + bed->clock_ppm) / 1000000u;
    return (uint32_t)(us / 1000u) + bed->clock_ms -
           (bed->now_us >= bed->back_at_us ? bed->back_ms : 0);
}

void bed_prepare(bed_t *bed)
{
    memset(bed, 0, sizeof *bed);
    bed->poll_ms = 1;
    bed->grain_us = 50000; /* A line of a simulator holds 160 ms. */
    bed->clock_ms = CLOCK_AT_THE_BEGINNING;
    bed->timing = tmini_timing_default;
    bed->config.rx_size = 1024;
    bed->config.max_points = sizeof bed->points / sizeof bed->points[0];
}

static void hear_command(void *context, uint8_t code, uint64_t now_us)
{
    bed_t *const bed = context;
    bed_heard_t *const heard = &bed->heard;
    bed_tell(bed, "the lidar obeys %02X", code);
    heard->commands++;
    if (code == SIM_COMMAND_START && heard->starts++ == 0) {
        heard->start_us = now_us;
        heard->start_chz = sim_frequency_chz(&bed->sim);
    } else if (code == SIM_COMMAND_STOP) {
        heard->stops++;
        heard->stops_while_scanning += sim_mode(&bed->sim) == SIM_SCANNING ? 1u : 0u;
    } else if (code == SIM_COMMAND_REBOOT) {
        heard->reboots++;
    }
}

static sim_trouble_t spoil_event(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms)
{
    static const char *const texts[] = {"command", "reply", "beginning of a scan", "start packet"};
    bed_t *const bed = context;
    const sim_trouble_t trouble = bed->spoil != NULL ? bed->spoil(bed, ms) : SIM_SOUND;
    (void)now_us;
    bed_tell(bed, "%u: %s%s%s", bed->wire_events++, texts[event], trouble != SIM_SOUND ? ": " : "",
             trouble != SIM_SOUND ? sim_trouble_name(trouble) : "");
    return trouble;
}

bool bed_init(bed_t *bed, const sim_config_t *sim)
{
    const sim_observer_t observer = {
        .context = bed, .on_command = hear_command, .on_event = spoil_event};
    bed->port.write = port_write;
    bed->port.now_ms = port_now_ms;
    bed->config.port = &bed->port;
    bed->config.port_context = bed;
    bed->config.rx_buffer = bed->config.rx_buffer != NULL ? bed->config.rx_buffer : bed->rx;
    if (bed->config.points == NULL && bed->config.max_points > 0) {
        bed->config.points = bed->points;
    }
    bed->config.timing = &bed->timing;
    bed->wants_chz = bed->config.frequency_chz;
    random_seed(&bed->random, sim->seed);
    sim_init(&bed->sim, sim);
    sim_observe(&bed->sim, &observer);
    if (bed->watch != NULL) {
        watch_begin(bed);
    }
    return bed_restart(bed);
}

bool bed_restart(bed_t *bed)
{
    bed->known = 0;
    bed->come = 0;
    bed->published = 0;
    bed->dma_position = 0;
    bed->may_flow = false;
    bed->flows = false;
    if (bed->watch != NULL) {
        watch_restart(bed);
    }
    return tmini_init(&bed->lidar, &bed->config) == TMINI_OK;
}

sim_config_t bed_quiet_lidar(void)
{
    sim_config_t config = sim_default_config();
    config.noise_mm = 0;
    config.invalid_permille = 0;
    config.flagged_permille = 0;
    config.lone_packet_permille = 0;
    config.angle_jitter_q6 = 0;
    return config;
}

uint32_t bed_ms(const bed_t *bed)
{
    return (uint32_t)(bed->now_us / 1000u);
}

void bed_tell(const bed_t *bed, const char *format, ...)
{
    va_list arguments;
    if (!bed->is_told) {
        return;
    }
    printf("%8.3f  ", (double)bed->sim.now_us / 1e6);
    va_start(arguments, format);
    (void)vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

void bed_tell_state(const bed_t *bed)
{
    bed_tell(bed, "driver %s, %u * 0.01 Hz; lidar %s, %u * 0.01 Hz",
             tmini_state_name(tmini_state(&bed->lidar)), tmini_frequency_chz(&bed->lidar),
             sim_mode_name(sim_mode(&bed->sim)), sim_frequency_chz(&bed->sim));
}

unsigned bed_event_named(const char *name)
{
    unsigned event = 0;
    while (event < BED_EVENTS - 1u && strcmp(tmini_event_name((tmini_event_t)event), name) != 0) {
        event++;
    }
    return event;
}

/* ---- Wishes ---- */

tmini_status_t bed_start(bed_t *bed)
{
    bed->wants_scans = true;
    bed->wished_us = bed->now_us;
    return tmini_start(&bed->lidar);
}

tmini_status_t bed_stop(bed_t *bed)
{
    bed->wants_scans = false;
    bed->wished_us = bed->now_us;
    bed->stop_us = bed->now_us;
    bed->may_flow = false;
    bed->flows = false;
    return tmini_stop(&bed->lidar);
}

tmini_status_t bed_set_frequency(bed_t *bed, uint16_t frequency_chz)
{
    const tmini_status_t status = tmini_set_frequency(&bed->lidar, frequency_chz);
    if (status == TMINI_OK) {
        bed->wants_chz = (uint16_t)((frequency_chz + 5u) / 10u * 10u);
        bed->wished_us = bed->now_us;
    }
    return status;
}

tmini_status_t bed_request_info(bed_t *bed)
{
    const tmini_status_t status = tmini_request_info(&bed->lidar);
    if (status == TMINI_OK) {
        bed->asked_us = bed->now_us + 1u;
        bed->wished_us = bed->now_us;
    }
    return status;
}

/* ---- What the program sees ---- */

static void note_scan(bed_t *bed)
{
    const tmini_scan_t *const scan = tmini_scan(&bed->lidar);
    bed->scan = *scan;
    bed->flows = bed->may_flow;
    bed->small += scan->packets == 1 ? 1u : 0u;
    if (!scan->complete) {
        bed->complete_in_a_row = 0;
        return;
    }
    bed->row_chz[bed->complete_in_a_row++ % BED_ROW] = scan->frequency_chz;
    bed->complete++;
    bed->complete_us = bed->now_us;
}

static void note_rate(bed_t *bed)
{
    uint32_t in_second = 0;
    bed->recent_us[bed->recent++ % BED_RECENT] = bed->now_us;
    for (uint32_t i = 0; i < BED_RECENT && i < bed->recent; i++) {
        in_second += bed->now_us - bed->recent_us[i] < 1000000u ? 1u : 0u;
    }
    bed->most_per_second = in_second > bed->most_per_second ? in_second : bed->most_per_second;
}

static void note(bed_t *bed, tmini_event_t event)
{
    if (event == TMINI_EVENT_MORE) {
        return;
    }
    bed->latest |= BIT(event);
    bed->events[event]++;
    bed->event_us[event] = bed->now_us;
    if (bed->watch != NULL) {
        watch_event(bed, event);
    }
    if (event == TMINI_EVENT_SCAN) {
        note_scan(bed);
        bed_pause_ms(bed, bed->work_ms);
    } else if (event != TMINI_EVENT_PACKET) {
        note_rate(bed);
        bed_tell(bed, "%s%s%s", tmini_event_name(event),
                 event == TMINI_EVENT_COMMAND_FAILED ? ": " : "",
                 event == TMINI_EVENT_COMMAND_FAILED
                     ? tmini_status_name(tmini_command_error(&bed->lidar))
                     : "");
    }
    if (event == TMINI_EVENT_LOST || event == bed_event_named("paused")) {
        bed->may_flow = false;
        bed->flows = false;
        bed->complete_in_a_row = 0;
    } else if (event == TMINI_EVENT_STARTED || event == TMINI_EVENT_RECOVERED) {
        bed->may_flow = true;
    }
}

/* The driver announces its own stops before, a silent line within a second. */
static void note_gaps(bed_t *bed)
{
    if (bed->flows && bed->stop_sent) {
        bed->unheard = "the driver stopped the lidar without an event";
    } else if (bed->flows && bed->held == NULL &&
               bed->now_us - bed->heard_us > SILENCE_US + bed->poll_ms * 1000u) {
        bed->unheard = "a second of silence without an event";
    }
    bed->stop_sent = false;
}

/* ---- Time ---- */

static uint64_t arrived(const bed_t *bed)
{
    return bed->watch != NULL ? bed->watch->arrived : 0;
}

/* Of the bytes that have come, the last ones before `to`. */
static void lose(bed_t *bed, size_t count, uint64_t to)
{
    if (bed->watch != NULL && count > 0) {
        watch_lose(bed, to - count, to);
    }
}

static void hold(bed_t *bed, const uint8_t *bytes, size_t count)
{
    bed_held_t *const held = bed->held;
    const size_t size = held->size > 0 ? held->size : BED_HELD_MAX;
    const size_t room = held->has_overflowed ? 0 : size - held->count;
    const size_t stored = count < room ? count : room;
    memcpy(held->bytes + held->count, bytes, stored);
    held->count += stored;
    held->has_overflowed |= stored < count;
    held->to = stored > 0 ? arrived(bed) - (count - stored) : held->to;
    lose(bed, count - stored, arrived(bed));
}

static void report_gap(bed_t *bed)
{
    bed->gaps++;
    tmini_feed_gap(&bed->lidar);
    if (bed->reports_twice) {
        tmini_feed_gap(&bed->lidar);
    }
}

static void damage(bed_t *bed, uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count && bed->flip_one_in > 0; i++) {
        if (random_below(&bed->random, bed->flip_one_in) == 0) {
            bytes[i] ^= (uint8_t)(1u << random_below(&bed->random, 8));
        }
    }
}

static void publish(bed_t *bed)
{
    if (bed->published == bed->come) {
        return; /* There was no interrupt. */
    }
    bed->published = bed->come;
    if ((bed->is_half && bed->is_full) ||
        (bed->false_gap_one_in > 0 && random_below(&bed->random, bed->false_gap_one_in) == 0)) {
        report_gap(bed); /* As in a port: a lap may have been lost. */
    }
    bed->is_half = false;
    bed->is_full = false;
    tmini_feed_dma(&bed->lidar, bed->dma_position);
    bed->known = bed->gaps > 0 ? tmini_feed_position(&bed->lidar) : bed->come;
}

/* Publishes in the interrupts for half transfer and transfer complete. */
static void write_by_dma(bed_t *bed, uint8_t byte)
{
    bed->config.rx_buffer[bed->dma_position++] = byte;
    bed->come++;
    bed->dma_position %= bed->config.rx_size;
    bed->is_full |= bed->dma_position == 0;
    bed->is_half |= bed->dma_position == bed->config.rx_size / 2;
    if ((bed->is_half || bed->is_full) && !bed->is_stalled) {
        publish(bed);
    }
}

/* The last ones before `to` of the bytes that have come. */
static void feed(bed_t *bed, const uint8_t *bytes, size_t count, uint64_t to)
{
    const size_t stored = tmini_feed(&bed->lidar, bytes, count);
    lose(bed, count - stored, to);
    bed->known += count;
}

static size_t read_line(bed_t *bed, uint8_t *bytes, size_t max)
{
    return bed->watch != NULL ? sim_link_read(&bed->watch->link, bed->now_us, bytes, max)
                              : sim_transmit(&bed->sim, bed->now_us, bytes, max);
}

static void receive(bed_t *bed, const uint8_t *bytes, size_t count)
{
    bed->heard_us = bed->now_us;
    if (bed->watch != NULL) {
        watch_arrive(bed, bytes, count);
    }
    if (bed->held != NULL) {
        hold(bed, bytes, count);
    } else if (!bed->config.rx_dma) {
        feed(bed, bytes, count, arrived(bed));
    } else {
        for (size_t i = 0; i < count; i++) {
            write_by_dma(bed, bytes[i]);
        }
    }
}

/* As port/posix does. */
static void read_held(bed_t *bed)
{
    bed_held_t *const held = bed->held;
    const size_t room = held->ignores_room ? SIZE_MAX : tmini_feed_room(&bed->lidar);
    const size_t count = held->count < room ? held->count : room;
    held->count -= count;
    feed(bed, held->bytes, count, held->to - held->count);
    memmove(held->bytes, held->bytes + count, held->count);
    if (held->has_overflowed && held->count == 0) {
        held->has_overflowed = false;
        report_gap(bed);
    }
    if (!held->is_mute) {
        tmini_feed_held(&bed->lidar,
                        held->count < held->reported_max ? held->count : held->reported_max);
    }
}

static void read_in_time(bed_t *bed)
{
    bed_held_t *const held = bed->held;
    if (held != NULL && held->every_us > 0 && held->due_us <= bed->now_us) {
        read_held(bed);
        held->due_us = bed->now_us +
                       (held->late_one_in > 0 && random_below(&bed->random, held->late_one_in) == 0
                            ? random_between(&bed->random, 20000, 95000)
                            : held->every_us);
    }
}

/* DMA also publishes when the line is idle, and by a timer: otherwise a large buffer would be
 * published so rarely that the library would detect silence. */
static void carry_bytes(bed_t *bed)
{
    uint8_t bytes[512];
    size_t count;
    while ((count = read_line(bed, bytes, sizeof bytes)) > 0) {
        damage(bed, bytes, count);
        receive(bed, bytes, count);
    }
    if (bed->config.rx_dma && !bed->is_stalled &&
        (bed->heard_us != bed->now_us || bed->now_us % TIMER_US == 0)) {
        publish(bed);
    }
}

static void empty_outbox(bed_t *bed)
{
    const size_t count = bed->outbox_count;
    bed->outbox_count = 0;
    if (count > 0 && bed->watch != NULL) {
        sim_link_write(&bed->watch->link, bed->outbox, count, bed->now_us);
    } else if (count > 0) {
        sim_receive(&bed->sim, bed->outbox, count, bed->now_us);
    }
}

void bed_pass_us(bed_t *bed, uint64_t us)
{
    const uint64_t end_us = bed->now_us + us;
    while (bed->now_us < end_us) {
        bed->now_us += end_us - bed->now_us < bed->grain_us ? end_us - bed->now_us : bed->grain_us;
        carry_bytes(bed);
        read_in_time(bed);
    }
}

void bed_pause_ms(bed_t *bed, uint32_t ms)
{
    bed_pass_us(bed, ms * UINT64_C(1000));
}

void bed_stall(bed_t *bed, uint64_t bytes)
{
    const uint64_t enough = bed->come + bytes;
    const uint64_t end_us = bed->now_us + 3000000u;
    bed->is_stalled = true;
    while (bed->come < enough && bed->now_us < end_us) {
        bed_pass_us(bed, BYTE_US);
    }
    bed->is_stalled = false;
    publish(bed);
}

static tmini_event_t poll_once(bed_t *bed)
{
    bed->polls++;
    bed->known_at_poll = bed->known;
    bed->is_polling = true;
    const tmini_event_t event = tmini_poll(&bed->lidar);
    bed->is_polling = false;
    return event;
}

static void poll(bed_t *bed)
{
    tmini_event_t event;
    bed->wakes++;
    if (bed->watch != NULL) {
        watch_before_polls(bed);
    }
    while ((event = poll_once(bed)) != TMINI_EVENT_NONE) {
        note(bed, event);
    }
    if (bed->watch != NULL) {
        watch_after_polls(bed);
    }
    if (bed->sleeps) {
        bed->due_us = bed->now_us + tmini_next_poll_ms(&bed->lidar) * (uint64_t)1000u;
    }
}

/* Between two busy periods there is at least one poll. */
static bool is_busy(bed_t *bed)
{
    if (bed->now_us > bed->busy_until_us && bed->busy_one_in > 0 &&
        random_below(&bed->random, bed->busy_one_in) == 0) {
        bed->busy_until_us = bed->now_us + random_between(&bed->random, 1, bed->busy_ms) * 1000u;
    }
    return bed->now_us < bed->busy_until_us;
}

void bed_step(bed_t *bed)
{
    empty_outbox(bed);
    bed_pass_us(bed, bed->poll_ms * UINT64_C(1000) + bed->later_us);
    if (bed->polls_first) {
        poll(bed);
    }
    if (bed->held != NULL && bed->held->every_us == 0) {
        read_held(bed);
    }
    if (bed->watch != NULL) {
        watch_step(bed);
    }
    if (!is_busy(bed) && (bed->now_us >= bed->due_us || bed->heard_us == bed->now_us)) {
        poll(bed);
    }
    note_gaps(bed);
    if (sim_mode(&bed->sim) != SIM_IDLE || (tmini_state(&bed->lidar) != TMINI_STATE_IDLE &&
                                            tmini_state(&bed->lidar) != TMINI_STATE_UNKNOWN)) {
        bed->busy_since_us = bed->now_us;
    }
}

void bed_run_ms(bed_t *bed, uint32_t ms)
{
    const uint64_t end_us = bed->now_us + ms * 1000u;
    while (bed->now_us < end_us) {
        bed_step(bed);
    }
}

unsigned bed_run_until(bed_t *bed, unsigned events, uint32_t ms)
{
    const uint64_t end_us = bed->now_us + ms * 1000u;
    bed->latest = 0;
    while (bed->now_us < end_us && (bed->latest & events) == 0) {
        bed_step(bed);
    }
    return bed->latest;
}

/* ---- Whether a wish is fulfilled ---- */

static bool is_row_near(const bed_t *bed, uint16_t frequency_chz, uint32_t scans)
{
    for (uint32_t i = 1; i <= scans; i++) {
        const int off = bed->row_chz[(bed->complete_in_a_row - i) % BED_ROW] - frequency_chz;
        if (abs(off) > frequency_chz / 20) {
            return false;
        }
    }
    return true;
}

/* As exactly as the driver wants it: replies have no checksum. */
static bool is_known(const bed_t *bed, uint16_t frequency_chz)
{
    return abs(tmini_frequency_chz(&bed->lidar) - frequency_chz) <= 5;
}

bool bed_scans_at(const bed_t *bed, uint16_t frequency_chz, uint32_t scans)
{
    if (bed->complete_in_a_row < scans || bed->now_us - bed->complete_us > 400000u ||
        tmini_state(&bed->lidar) != TMINI_STATE_SCANNING || sim_mode(&bed->sim) != SIM_SCANNING) {
        return false;
    }
    return frequency_chz == 0 ||
           (sim_frequency_chz(&bed->sim) == frequency_chz && is_known(bed, frequency_chz) &&
            is_row_near(bed, frequency_chz, scans));
}

static const char *shortcoming_of_scans(const bed_t *bed)
{
    if (!bed_scans_at(bed, 0, SCANS)) {
        return sim_sound_us(&bed->sim) == SIM_NEVER ? "no reboot" : "no complete scans";
    }
    if (bed->wants_chz != 0 && sim_frequency_chz(&bed->sim) != bed->wants_chz) {
        return "at another frequency";
    }
    if (bed->wants_chz != 0 && !is_known(bed, bed->wants_chz)) {
        return "the frequency is not known";
    }
    return bed_scans_at(bed, bed->wants_chz, SCANS) ? NULL : "not yet at the frequency";
}

/* A driver that is unsure because a late byte came, or that reported a stop as failed, may be in
 * TMINI_STATE_UNKNOWN: the lidar is idle. */
static const char *shortcoming_of_stop(const bed_t *bed)
{
    if (bed->event_us[TMINI_EVENT_STOPPED] < bed->stop_us &&
        bed->event_us[TMINI_EVENT_COMMAND_FAILED] < bed->stop_us) {
        return "no stop was reported";
    }
    return bed->now_us - bed->busy_since_us >= IDLE_US ? NULL : "not idle";
}

const char *bed_shortcoming(const bed_t *bed)
{
    const uint64_t sound_us = sim_sound_us(&bed->sim);
    if (sound_us != SIM_NEVER && sound_us > bed->now_us) {
        return "in trouble";
    }
    /* Repeated in vain, a question is reported as failed. */
    if (bed->event_us[TMINI_EVENT_INFO] < bed->asked_us &&
        bed->event_us[TMINI_EVENT_COMMAND_FAILED] < bed->asked_us) {
        return "a question was not answered";
    }
    return bed->wants_scans ? shortcoming_of_scans(bed) : shortcoming_of_stop(bed);
}

const char *bed_misdeed(const bed_t *bed)
{
    if (bed->watch != NULL && bed->watch->wrong != NULL) {
        return bed->watch->wrong;
    }
    return bed->most_per_second > MOST_EVENTS_PER_SECOND ? "more than ten events in a second"
                                                         : bed->unheard;
}
