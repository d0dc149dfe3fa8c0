/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini.h"

#include "tmini_driver.h"

const tmini_timing_t tmini_timing_default = {
    .frame_timeout_ms = 100, /* A line at work: 5 ms; but a task or bridge may hold bytes back. */
    .max_pause_ms = 30,      /* A line at work: a packet every 10 ms. */
    .quiet_line_ms = 50,
    .stop_timeout_ms = 600, /* Twice the longest tail seen after a stop (section 9.10). */
    .reply_timeout_ms = 2000,
    .write_timeout_ms = 100,
    .spin_up_timeout_ms = 3000,
    .data_timeout_ms = 1000,
    .rotation_timeout_ms = 3000,
    .reboot_time_ms = 5000,
    .back_off_ms = 500,
    .back_off_max_ms = 4000,
    .max_attempts = 3,
};

/* Nobody knows what happened on the line, or in layers below that hold bytes back, since the last
 * look at it: it counts as no more silence than this. */
#define UNSEEN_SILENCE_MAX_MS 50

/* The events with which commands end. */
#define END_EVENTS                                                                         \
    (1u << TMINI_EVENT_STARTED | 1u << TMINI_EVENT_STOPPED | 1u << TMINI_EVENT_INFO |      \
     1u << TMINI_EVENT_HEALTH | 1u << TMINI_EVENT_FREQUENCY | 1u << TMINI_EVENT_REBOOTED | \
     1u << TMINI_EVENT_COMMAND_FAILED)

/* Each event has a bit in tmini_t.pending. */
typedef char events_fit_their_mask[TMINI_EVENT_MORE <= 16 ? 1 : -1];

/* More bytes at a look than the wire can have brought since the last one, and in a UART's FIFO,
 * come from a layer that holds them back. */
#define HELD_MS 16u

/* What becomes of a frame costs as much as looking at its bytes once again, and at so many more: a
 * packet's samples are read for its points, its time is told, and its place in the scan found. */
#define FRAME_EFFORT 44u

/* Bytes are doubtful if the line has paused at them, or nobody knows how many came. Others may then
 * be missing before each packet that begins among them. As for the first packet behind them:
 *
 *   AHEAD   the pause was before them: there too, if no packet begins among them
 *   MARKED  the same, and one has begun among them: not there
 *   AROUND  the pause may as well have been behind them: there in any case */
enum { DOUBT_NONE, DOUBT_AHEAD, DOUBT_MARKED, DOUBT_AROUND };

static bool is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && lidar->link.port != NULL;
}

/* ------------------------------------------------------------------------------------- events */

TMINI_NOINLINE static void raise_event(tmini_t *lidar, tmini_event_t event)
{
    lidar->pending |= (uint16_t)(1u << event);
}

/* Of the events that are pending, the first in the order of tmini_event_t. Scan and packet are
 * last: they are valid until parsing goes on. */
static tmini_event_t take_event(tmini_t *lidar)
{
    unsigned event = TMINI_EVENT_STARTED;
    while ((lidar->pending >> event & 1u) == 0) {
        event++;
    }
    lidar->pending = (uint16_t)(lidar->pending & ~(1u << event));
    return (tmini_event_t)event;
}

/* --------------------------------------------------------------------------------------- time */

/* How long so many bytes take a lidar that scans: 13.1 a millisecond (section 1), less some for the
 * clocks' sake; 12.5. */
static uint32_t transit_ms(size_t bytes)
{
    return (uint32_t)bytes * 41u >> 9;
}

/* How long they take on the wire at least: 23 a millisecond. */
static uint32_t wire_ms(size_t bytes)
{
    return (uint32_t)bytes * 45u >> 10;
}

/* Bytes have come, `passed_ms` after the last look. While the lidar scans they never pause for
 * long: if they are too few for the time since others came, then others may be missing, before
 * or among them. If they do not come straight from the wire, but a layer below has held them
 * back, the pause may as well be behind them, or go on: what is left of the time counts for the
 * next ones. And if there are more than the ring holds, a gap of DMA, nobody knows how many
 * there were. */
static void note_bytes(tmini_t *lidar, size_t count, uint32_t passed_ms)
{
    tmini_link_t *const link = &lidar->link;
    const uint16_t max_pause_ms = link->timing->max_pause_ms;
    const uint32_t due_ms = transit_ms(count);
    const uint32_t pause_ms = link->now_ms - link->heard_ms;
    const bool is_gap = count > lidar->ring.size;
    if (is_gap || wire_ms(count) > passed_ms + HELD_MS) {
        lidar->are_held = true;
    }
    const bool are_held = lidar->are_held;
    lidar->silent_ms = 0;
    lidar->are_held = false;
    if (is_gap || (max_pause_ms > 0 && pause_ms > max_pause_ms + due_ms)) {
        lidar->doubt = are_held ? DOUBT_AROUND : DOUBT_AHEAD;
        lidar->doubtful_to = link->received;
    } else if (are_held && pause_ms > due_ms) {
        link->heard_ms += due_ms;
        return;
    }
    link->heard_ms = link->now_ms;
}

static void note_silence(tmini_t *lidar, uint32_t passed_ms)
{
    const uint32_t seen_ms = passed_ms < UNSEEN_SILENCE_MAX_MS ? passed_ms : UNSEEN_SILENCE_MAX_MS;
    const uint32_t silent_ms = lidar->silent_ms + seen_ms;
    lidar->silent_ms = (uint16_t)(silent_ms < UINT16_MAX ? silent_ms : UINT16_MAX);
}

/* Reads the clock and notes whether bytes have come, or may have. */
static void update_time(tmini_t *lidar)
{
    tmini_link_t *const link = &lidar->link;
    const size_t head = tmini_ring_head(&lidar->ring);
    const size_t count = tmini_ring_distance(link->received, head);
    const uint32_t now_ms = link->port->now_ms(link->port_context);
    const uint32_t passed_ms = now_ms - link->now_ms;
    link->now_ms = now_ms;
    link->received = head;
    if (passed_ms > link->timing->max_pause_ms) {
        lidar->are_held = true;
    }
    if (count > 0) {
        note_bytes(lidar, count, passed_ms);
    } else if (tmini_ring_is_full(&lidar->ring)) {
        lidar->silent_ms = 0; /* Who knows what there was no room for? */
    } else {
        note_silence(lidar, passed_ms);
        return;
    }
    if (lidar->state == TMINI_STATE_IDLE) {
        lidar->state = TMINI_STATE_UNKNOWN;
    }
}

/* When the packet delivered last came: before the bytes behind it. Those that came during this poll
 * have not been noted yet: a pause before them is to be known first. */
static uint32_t arrival_ms(tmini_t *lidar)
{
    const size_t position = tmini_parser_position(&lidar->parser);
    if (tmini_ring_head(&lidar->ring) != lidar->link.received) {
        update_time(lidar);
    }
    return lidar->link.now_ms - transit_ms(tmini_ring_distance(position, lidar->link.received));
}

/* ----------------------------------------------------------------------------------- commands */

static void fail(tmini_t *lidar, tmini_status_t status)
{
    lidar->command_error = (int8_t)status;
    raise_event(lidar, TMINI_EVENT_COMMAND_FAILED);
}

static void lose(tmini_t *lidar)
{
    lidar->state = TMINI_STATE_RECOVERING;
    raise_event(lidar, TMINI_EVENT_LOST);
    tmini_recovery_begin(lidar);
}

/* The user's command has ended. What has been heard behind its last reply leaves the line not
 * surely quiet. */
static void end_command(tmini_t *lidar, int result)
{
    const bool is_quiet = tmini_parser_pending(&lidar->parser) == 0;
    lidar->state = is_quiet && lidar->command.phase == TMINI_PHASE_IDLE ? TMINI_STATE_IDLE
                                                                        : TMINI_STATE_UNKNOWN;
    if (result == TMINI_OK) {
        raise_event(lidar, (tmini_event_t)lidar->end_event);
    } else {
        fail(lidar, (tmini_status_t)result);
    }
}

/* Draws the consequences of how what is under way stands. While scanning, what ends is the time in
 * which a packet should have come. */
static void take_result(tmini_t *lidar, int result)
{
    if (result == TMINI_UNDER_WAY) {
        return;
    }
    tmini_command_end(lidar, result);
    if (lidar->state == TMINI_STATE_RECOVERING) {
        tmini_recovery_go_on(lidar, result);
    } else if (lidar->state == TMINI_STATE_SCANNING) {
        lose(lidar);
    } else {
        end_command(lidar, result);
    }
}

static tmini_state_t state_until(tmini_event_t end_event)
{
    switch (end_event) {
    case TMINI_EVENT_STARTED:
        return TMINI_STATE_STARTING;
    case TMINI_EVENT_STOPPED:
        return TMINI_STATE_STOPPING;
    default:
        return TMINI_STATE_BUSY;
    }
}

/* The first bytes leave at once, as far as the port takes them. If it refuses, it is asked once
 * more when time has passed, and until then there is nothing to do: a loop that polls until then,
 * and asks again whenever a command has failed, comes to an end. A lidar that is known to be idle
 * needs no stop before. */
static void begin(tmini_t *lidar, tmini_command_code_t operation, tmini_event_t end_event,
                  uint16_t frequency_chz)
{
    const bool is_idle = lidar->state == TMINI_STATE_IDLE;
    lidar->state = (uint8_t)state_until(end_event);
    lidar->end_event = (uint8_t)end_event;
    tmini_command_begin(lidar, operation, lidar->link.timing->max_attempts, frequency_chz);
    if (is_idle) {
        (void)tmini_command_proceed(lidar);
    }
    lidar->is_settled = tmini_command_poll(lidar) != TMINI_UNDER_WAY && lidar->pending == 0;
}

/* Begins a command, if it may be begun now; stop may always, and aborts another. The end of an
 * earlier one, not polled yet, is not the end of this one. */
static tmini_status_t request(tmini_t *lidar, tmini_command_code_t operation,
                              tmini_event_t end_event, uint16_t frequency_chz)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const bool is_under_way =
        lidar->state > TMINI_STATE_IDLE && lidar->state < TMINI_STATE_SCANNING;
    if (operation == TMINI_COMMAND_STOP) {
        if (lidar->state == TMINI_STATE_STOPPING) {
            return TMINI_OK; /* It is being stopped already. */
        }
    } else if (lidar->state >= TMINI_STATE_SCANNING) {
        return TMINI_ERROR_STATE;
    } else if (is_under_way) {
        return TMINI_ERROR_BUSY;
    }
    update_time(lidar);
    tmini_recovery_forget(lidar);
    lidar->pending = (uint16_t)(lidar->pending & ~END_EVENTS);
    if (is_under_way) {
        fail(lidar, TMINI_ERROR_ABORTED);
    }
    begin(lidar, operation, end_event, frequency_chz);
    return TMINI_OK;
}

/* Not inlined, so that its content does not lie on the stack below a packet's points. */
TMINI_NOINLINE static void take_reply(tmini_t *lidar)
{
    uint8_t content[TMINI_INFO_SIZE];
    const tmini_reply_header_t *const header = &lidar->parser.awaited;
    update_time(lidar); /* What came during this poll has not been noted yet. */
    if (!tmini_frame_content(tmini_parser_frame(&lidar->parser), content, header->length)) {
        (void)tmini_parser_await(&lidar->parser, header); /* DMA was faster: it has not come. */
        return;
    }
    if (lidar->command.operation == TMINI_COMMAND_GET_INFO) {
        tmini_reply_info(content, &lidar->latest.info);
    } else if (lidar->command.operation == TMINI_COMMAND_GET_HEALTH) {
        tmini_reply_health(content, &lidar->latest.health);
    }
    take_result(lidar, tmini_command_reply(lidar, content));
}

/* ------------------------------------------------------------------------------------ scanning */

/* The lidar is lost if this is not called again in time. */
static void expect_packet(tmini_t *lidar)
{
    tmini_command_wait(lidar, lidar->link.timing->data_timeout_ms);
}

/* A start that is no longer needed is not sent, and its reply not awaited (section 2). */
static void begin_scanning(tmini_t *lidar)
{
    tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    if (lidar->state == TMINI_STATE_RECOVERING) {
        tmini_recovery_end(lidar);
        raise_event(lidar, TMINI_EVENT_RECOVERED);
    } else {
        raise_event(lidar, TMINI_EVENT_STARTED);
    }
    lidar->state = TMINI_STATE_SCANNING;
    tmini_builder_discard(&lidar->builder);
    tmini_monitor_begin(lidar);
}

/* A lidar that was left idle streams: the stop was lost on the wire. Nobody polls for its scans, so
 * it would wear out its motor unnoticed. */
static void stop_again(tmini_t *lidar)
{
    raise_event(lidar, TMINI_EVENT_UNWANTED_SCANNING);
    (void)tmini_stop(lidar);
}

/* A packet has come: does it mean that the lidar has begun to scan, or scans again? Not so the tail
 * behind a stop (section 9.10); in other phases the reply to the start may have been lost. */
static void note_scanning(tmini_t *lidar)
{
    const uint8_t phase = lidar->command.phase;
    if (lidar->state == TMINI_STATE_RECOVERING || lidar->state == TMINI_STATE_STARTING) {
        if (phase != TMINI_PHASE_QUIESCING) {
            begin_scanning(lidar);
        }
    } else if (phase == TMINI_PHASE_IDLE) {
        stop_again(lidar);
    }
}

/* Others may be missing before the packet that has come: it begins among the doubtful bytes, or is
 * the first one behind them. */
static bool is_doubtful(tmini_t *lidar)
{
    const size_t left = tmini_ring_distance(tmini_ring_tail(&lidar->ring), lidar->doubtful_to);
    const uint8_t doubt = lidar->doubt;
    if (doubt == DOUBT_NONE) {
        return false;
    }
    if (left > 0 && left <= TMINI_RING_CLOSED / 2) {
        lidar->doubt = doubt == DOUBT_AHEAD ? DOUBT_MARKED : doubt;
        return true;
    }
    lidar->doubt = DOUBT_NONE;
    return doubt != DOUBT_MARKED;
}

/* Since the last packet of the scan, damaged ones may have come instead of others, a few bytes of
 * each: neither silence nor many bytes, but too long. */
static bool is_late(const tmini_t *lidar, uint32_t came_ms)
{
    const uint16_t max_pause_ms = lidar->link.timing->max_pause_ms;
    const uint32_t due_ms = transit_ms(tmini_parser_frame(&lidar->parser)->size);
    const int32_t since_ms = (int32_t)(came_ms - lidar->builder.scan.end_ms);
    return lidar->builder.open && max_pause_ms > 0 && since_ms > (int32_t)(max_pause_ms + due_ms);
}

static void open_packet(tmini_t *lidar, uint32_t came_ms)
{
    tmini_packet_open(&lidar->latest.packet, tmini_parser_frame(&lidar->parser));
    if (is_doubtful(lidar) || is_late(lidar, came_ms)) {
        lidar->latest.packet.gap = TMINI_GAP_UNKNOWN;
    }
}

static void monitor_packet(tmini_t *lidar)
{
    const tmini_ct_verdict_t verdict = tmini_ct_add(&lidar->ct, &lidar->latest.packet);
    if (verdict == TMINI_CT_REFUTED) {
        tmini_builder_refute(&lidar->builder);
    }
    if (tmini_monitor_packet(lidar, verdict)) {
        tmini_recovery_forget(lidar); /* It has truly recovered, if it was lost. */
    }
}

static void deliver_packet(tmini_t *lidar, uint32_t came_ms)
{
    const tmini_packet_t *const packet = &lidar->latest.packet;
    if (lidar->builder.capacity == 0) {
        raise_event(lidar, TMINI_EVENT_PACKET);
    } else if (tmini_builder_add(&lidar->builder, packet, came_ms)) {
        lidar->packet_waits = true;
        lidar->scans++;
        raise_event(lidar, TMINI_EVENT_SCAN);
    }
}

static void take_packet(tmini_t *lidar)
{
    const uint32_t came_ms = arrival_ms(lidar);
    note_scanning(lidar);
    if (lidar->state != TMINI_STATE_SCANNING) {
        return; /* The tail behind a stop, or a stream that nobody asked for. */
    }
    expect_packet(lidar);
    open_packet(lidar, came_ms);
    monitor_packet(lidar);
    deliver_packet(lidar, came_ms);
}

/* The packet that closed the scan which has been returned begins the next one. It had to wait,
 * because the application reads the scan until it polls again. */
static void add_waiting_packet(tmini_t *lidar)
{
    if (lidar->packet_waits) {
        lidar->packet_waits = false;
        (void)tmini_builder_add(&lidar->builder, &lidar->latest.packet, lidar->builder.scan.end_ms);
    }
}

/* ------------------------------------------------------------------------------------- polling */

/* A candidate that has stopped coming is given up, so that what it hides is looked at. */
static bool give_up_candidate(tmini_t *lidar)
{
    const tmini_link_t *const link = &lidar->link;
    if (lidar->silent_ms == 0 || lidar->silent_ms < link->timing->frame_timeout_ms ||
        tmini_ring_head(&lidar->ring) != link->received ||
        tmini_parser_pending(&lidar->parser) == 0) {
        return false;
    }
    tmini_parser_abandon(&lidar->parser);
    return true;
}

/* Handles frames until one raises an event or none is left. Returns false if that takes more work
 * than one poll may do. */
static bool receive(tmini_t *lidar)
{
    size_t effort = 0;
    add_waiting_packet(lidar);
    while (lidar->pending == 0) {
        if (effort >= TMINI_PARSER_EFFORT) {
            return false;
        }
        const tmini_frame_type_t type = tmini_parser_next_after(&lidar->parser, effort);
        if (type == TMINI_FRAME_PACKET) {
            take_packet(lidar);
        } else if (type == TMINI_FRAME_REPLY) {
            take_reply(lidar);
        } else if (type == TMINI_FRAME_NONE && !give_up_candidate(lidar)) {
            return true;
        }
        effort = FRAME_EFFORT + lidar->parser.effort + tmini_parser_frame(&lidar->parser)->size;
    }
    return true;
}

/* Looks after what is due by time, or by the line's quiet. */
static void keep_time(tmini_t *lidar)
{
    take_result(lidar, tmini_command_poll(lidar));
    if (lidar->state == TMINI_STATE_SCANNING) {
        tmini_monitor_poll(lidar);
    }
}

/* True if something has happened since the last poll: bytes have come, or were lost, or time has
 * passed. Most polls of a fast loop end here. */
static bool has_news(const tmini_t *lidar)
{
    const tmini_link_t *const link = &lidar->link;
    return tmini_ring_head(&lidar->ring) != link->received ||
           link->port->now_ms(link->port_context) != link->now_ms;
}

tmini_event_t tmini_poll(tmini_t *lidar)
{
    if (!is_set_up(lidar) || (lidar->is_settled && !has_news(lidar))) {
        return TMINI_EVENT_NONE;
    }
    const uint8_t faults = lidar->monitor.faults;
    lidar->is_settled = false;
    update_time(lidar);
    const bool is_done = lidar->pending != 0 || receive(lidar);
    if (lidar->pending == 0) {
        keep_time(lidar);
    }
    if (lidar->monitor.faults != faults) {
        raise_event(lidar, TMINI_EVENT_FAULTS_CHANGED);
    }
    if (lidar->pending != 0) {
        return take_event(lidar);
    }
    if (!is_done) {
        return TMINI_EVENT_MORE;
    }
    lidar->is_settled = lidar->command.unsent == 0;
    return TMINI_EVENT_NONE;
}

/* ---------------------------------------------------------------------------------- life cycle */

static bool has_required_members(const tmini_config_t *config)
{
    return config != NULL && config->port != NULL && config->port->write != NULL &&
           config->port->now_ms != NULL;
}

/* Ring, parser and builder check their own parts of the configuration. */
static bool init_modules(tmini_t *lidar, const tmini_config_t *config)
{
    return tmini_ring_init(&lidar->ring, config->rx_buffer, config->rx_size, config->rx_dma) ==
               TMINI_OK &&
           tmini_parser_init(&lidar->parser, &lidar->ring, config->max_samples) == TMINI_OK &&
           ((config->points == NULL && config->max_points == 0) || /* By packets. */
            tmini_builder_init(&lidar->builder, config->points, config->max_points, config->filter) ==
                TMINI_OK);
}

tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config)
{
    if (lidar == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *lidar = (tmini_t){0}; /* Also state, phase and CT information: unknown, none, nothing known. */
    if (!has_required_members(config) || !init_modules(lidar, config)) {
        return TMINI_ERROR_ARGUMENT;
    }
    lidar->link.port = config->port; /* From now on the lidar is set up. */
    lidar->link.port_context = config->port_context;
    lidar->link.timing = config->timing != NULL ? config->timing : &tmini_timing_default;
    lidar->is_recovery_off = config->recovery == TMINI_RECOVERY_OFF;
    return TMINI_OK;
}

/* ------------------------------------------------------------------------- the user's commands */

tmini_status_t tmini_start(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_START, TMINI_EVENT_STARTED, 0);
}

tmini_status_t tmini_stop(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_STOP, TMINI_EVENT_STOPPED, 0);
}

tmini_status_t tmini_request_info(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_GET_INFO, TMINI_EVENT_INFO, 0);
}

tmini_status_t tmini_request_health(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_GET_HEALTH, TMINI_EVENT_HEALTH, 0);
}

tmini_status_t tmini_request_frequency(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_GET_FREQUENCY, TMINI_EVENT_FREQUENCY, 0);
}

tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz)
{
    if (frequency_chz < TMINI_FREQUENCY_MIN_CHZ || frequency_chz > TMINI_FREQUENCY_MAX_CHZ ||
        frequency_chz % TMINI_FREQUENCY_STEP_CHZ != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    return request(lidar, TMINI_COMMAND_GET_FREQUENCY, TMINI_EVENT_FREQUENCY, frequency_chz);
}

tmini_status_t tmini_reboot(tmini_t *lidar)
{
    return request(lidar, TMINI_COMMAND_REBOOT, TMINI_EVENT_REBOOTED, 0);
}

void tmini_cancel(tmini_t *lidar)
{
    tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    lidar->is_settled = false;
    lidar->state = TMINI_STATE_UNKNOWN;
}

/* ------------------------------------------------------------------------------------- results */

tmini_state_t tmini_state(const tmini_t *lidar)
{
    return lidar != NULL ? (tmini_state_t)lidar->state : TMINI_STATE_UNKNOWN;
}

const tmini_scan_t *tmini_scan(const tmini_t *lidar)
{
    return &lidar->builder.scan;
}

const tmini_packet_t *tmini_packet(const tmini_t *lidar)
{
    return &lidar->latest.packet;
}

const tmini_info_t *tmini_info(const tmini_t *lidar)
{
    return &lidar->latest.info;
}

const tmini_health_t *tmini_health(const tmini_t *lidar)
{
    return &lidar->latest.health;
}

uint16_t tmini_frequency_chz(const tmini_t *lidar)
{
    return lidar->command.frequency_chz;
}

tmini_status_t tmini_command_error(const tmini_t *lidar)
{
    return (tmini_status_t)lidar->command_error;
}

uint8_t tmini_faults(const tmini_t *lidar)
{
    return lidar->monitor.faults;
}

void tmini_ct_info(const tmini_t *lidar, tmini_ct_info_t *info)
{
    tmini_ct_read(&lidar->ct, info);
}

/* The ring is asked directly: before tmini_init() the parser knows none. */
void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters)
{
    const tmini_ring_t *const ring = &lidar->ring;
    const tmini_parser_counters_t *const parser = &lidar->parser.counters;
    const size_t pending = tmini_ring_unread(ring) - tmini_parser_frame(&lidar->parser)->size;
    counters->packets = parser->packets;
    counters->checksum_errors = parser->checksum_errors;
    counters->bytes_in_packets = parser->bytes_in_packets;
    counters->bytes_in_replies = parser->bytes_in_replies;
    counters->bytes_skipped = parser->bytes_skipped;
    counters->bytes_overrun = parser->bytes_overrun + (uint32_t)tmini_ring_overrun(ring);
    counters->bytes_pending = (uint32_t)pending;
    counters->scans = lidar->scans;
    counters->timeouts = lidar->command.timeouts;
    counters->losses = lidar->recovery.losses;
    counters->recoveries = lidar->recovery.recoveries;
    counters->restarts = lidar->recovery.restarts;
    counters->reboots = lidar->recovery.reboots;
}
