/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Wishes, the state of the lidar, events, and the public functions. */

#include "tmini/tmini.h"

#include "tmini_driver.h"

const tmini_timing_t tmini_timing_default = {
    .frame_timeout_ms = 100, /* A scanning lidar pauses for 5 ms; tasks or bridges delay
                              * bytes. */
    .max_pause_ms = 30,      /* A scanning lidar sends a packet every 10 ms. */
    .quiet_line_ms = 50,
    .reply_timeout_ms = 2000,
    .back_off_max_ms = 4000,
    .max_attempts = 3,
};

/* The events that end a command. */
#define END_EVENTS                                                                         \
    (1u << TMINI_EVENT_STARTED | 1u << TMINI_EVENT_STOPPED | 1u << TMINI_EVENT_INFO |      \
     1u << TMINI_EVENT_HEALTH | 1u << TMINI_EVENT_FREQUENCY | 1u << TMINI_EVENT_REBOOTED | \
     1u << TMINI_EVENT_COMMAND_FAILED)

/* Each event has a bit in tmini_t.pending. */
typedef char events_fit_their_mask[TMINI_EVENT_MORE <= 16 ? 1 : -1];

/* Handling a frame of n bytes costs as much as parsing n + 44 bytes: samples become points, and the
 * packet's time and place in the scan are computed. */
#define FRAME_EFFORT 44u

/* The longest time between two looks at the line, also when there is nothing to do: about one
 * packet. */
#define IDLE_MAX_MS 10u

static bool is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && lidar->link.port != NULL;
}

/* A command of the user, or a start, is in progress: an event will end it. */
static bool is_busy(const tmini_t *lidar)
{
    return lidar->state > TMINI_STATE_IDLE && lidar->state < TMINI_STATE_SCANNING;
}

/* The lidar scans, or the driver tries to make it scan. */
static bool is_to_scan(const tmini_t *lidar)
{
    return lidar->state >= TMINI_STATE_STARTING &&
           (lidar->state != TMINI_STATE_RECOVERING || !lidar->is_recovery_off);
}

/* ------------------------------------------------------------------------------------- events */

TMINI_NOINLINE static void raise_event(tmini_t *lidar, tmini_event_t event)
{
    lidar->pending |= (uint16_t)(1u << event);
}

/* Removes and returns the first pending event in the order of tmini_event_t, or
 * TMINI_EVENT_NONE. */
TMINI_NOINLINE static tmini_event_t take_event(tmini_t *lidar)
{
    uint16_t pending = lidar->pending;
    unsigned event = TMINI_EVENT_NONE;
    lidar->pending = (uint16_t)(pending & (pending - 1)); /* Without the lowest bit. */
    for (; pending != 0 && (pending & 1u) == 0; pending >>= 1) {
        event++;
    }
    return (tmini_event_t)event;
}

static void fail(tmini_t *lidar, int status)
{
    lidar->command_error = (int8_t)status;
    raise_event(lidar, TMINI_EVENT_COMMAND_FAILED);
}

/* Looks at the line. Once bytes have come, the lidar is no longer known to be idle. */
TMINI_NOINLINE static void look(tmini_t *lidar)
{
    if (tmini_line_look(lidar) && lidar->state == TMINI_STATE_IDLE) {
        lidar->state = TMINI_STATE_UNKNOWN;
    }
}

/* ------------------------------------------------------------------------------ wanted to scan */

/* Begins the ladder (tmini_recovery.c) at its first step. */
TMINI_NOINLINE static void begin_start(tmini_t *lidar)
{
    const bool is_idle = lidar->state == TMINI_STATE_IDLE;
    lidar->start_follows = false;
    lidar->state = TMINI_STATE_STARTING;
    tmini_recovery_start(lidar, is_idle);
}

/* Begins the ladder for a lidar that scans or is to scan: stops it and sets the wanted
 * frequency. */
TMINI_NOINLINE static void restart(tmini_t *lidar)
{
    if (lidar->state != TMINI_STATE_RECOVERING) {
        lidar->state = TMINI_STATE_STARTING;
    }
    tmini_recovery_start(lidar, false);
}

/* The lidar is lost. Another unit may come back, so what is known about this one is forgotten. */
static void lose(tmini_t *lidar)
{
    lidar->state = TMINI_STATE_RECOVERING;
    raise_event(lidar, TMINI_EVENT_LOST);
    tmini_command_forget_frequency(lidar);
    tmini_monitor_forget_frequency(&lidar->monitor);
    tmini_ct_init(&lidar->decoder.ct);
    tmini_recovery_begin(lidar);
}

/* If the lidar does not answer, its frequency is unknown. TMINI_ERROR_REPLY is an answer: it has
 * refused a step. */
static void end_frequency(tmini_t *lidar, int result, bool is_start)
{
    if (result == TMINI_OK) {
        raise_event(lidar, TMINI_EVENT_FREQUENCY);
        return;
    }
    if (result != TMINI_ERROR_REPLY) {
        tmini_command_forget_frequency(lidar);
    }
    if (is_start) {
        lidar->command_error = (int8_t)result;
    }
}

/* Each failed attempt to start is reported. During recovery none is, because the loss has been
 * reported. */
static void fail_attempt(tmini_t *lidar, int result, bool is_start)
{
    tmini_recovery_restart_reception(lidar);
    if (is_start) {
        fail(lidar, result);
        if (lidar->is_recovery_off) {
            lidar->state = TMINI_STATE_UNKNOWN;
            return;
        }
    }
    tmini_recovery_back_off(lidar);
}

/* A step of the ladder has ended, and no packet has come yet. A successful start does not come
 * here: it ends with the first packet. A frequency that could not be set is reported when scanning
 * begins; the start follows even then. */
static void climb(tmini_t *lidar, tmini_event_t operation, int result, bool is_idle)
{
    const bool is_start = lidar->state == TMINI_STATE_STARTING;
    if (operation == TMINI_EVENT_FREQUENCY) {
        end_frequency(lidar, result, is_start);
    } else if (result != TMINI_OK) {
        fail_attempt(lidar, result, is_start);
        return;
    }
    tmini_recovery_go_on(lidar, operation, is_idle);
}

/* The first packet has come. So the start command is not sent again, and its reply is not awaited
 * (section 2). */
static void begin_scanning(tmini_t *lidar)
{
    (void)tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    if (lidar->state == TMINI_STATE_RECOVERING) {
        tmini_recovery_end(lidar);
        raise_event(lidar, TMINI_EVENT_RECOVERED);
    } else {
        tmini_recovery_forget(lidar);
        raise_event(lidar, TMINI_EVENT_STARTED);
        if (!tmini_command_has_frequency(lidar)) {
            fail(lidar, lidar->command_error);
        }
    }
    lidar->state = TMINI_STATE_SCANNING;
    tmini_decoder_restart(&lidar->decoder);
    tmini_monitor_begin(&lidar->monitor);
}

/* ------------------------------------------------------------------------------------- commands */

static void end_command(tmini_t *lidar, tmini_event_t operation, int result, bool is_idle)
{
    lidar->state = is_idle ? TMINI_STATE_IDLE : TMINI_STATE_UNKNOWN;
    if (result == TMINI_OK) {
        raise_event(lidar, operation);
    } else {
        fail(lidar, result);
    }
    if (lidar->start_follows) {
        begin_start(lidar);
    }
}

/* Acts on the result of the current operation. While scanning, the operation is to wait for the
 * next packet; if it ends, the lidar is lost. The line is quiet only if no bytes have come after
 * the last reply. */
static void take_result(tmini_t *lidar, int result)
{
    const tmini_event_t operation = (tmini_event_t)lidar->command.operation;
    if (result == TMINI_UNDER_WAY) {
        return;
    }
    const bool is_idle =
        tmini_command_end(lidar, result) &&
        tmini_ring_head(&lidar->ring) == tmini_parser_position(&lidar->decoder.parser);
    if (lidar->state == TMINI_STATE_SCANNING) {
        lose(lidar);
    } else if (lidar->state == TMINI_STATE_STARTING || lidar->state == TMINI_STATE_RECOVERING) {
        climb(lidar, operation, result, is_idle);
    } else {
        end_command(lidar, operation, result, is_idle);
    }
}

/* The first part of every command from the user. Drops an event that ended an earlier command and
 * has not been polled: the program would think that it ends this one. */
TMINI_NOINLINE static void take_over(tmini_t *lidar)
{
    look(lidar);
    lidar->pending = (uint16_t)(lidar->pending & ~END_EVENTS);
}

/* Offers the first bytes to the port at once. If the port reports a failure, it is asked again when
 * time has passed; until then a poll has nothing to do. So a loop that polls until TMINI_EVENT_NONE
 * ends, even if it repeats each failed command. */
static void send_first(tmini_t *lidar)
{
    const bool has_failed = tmini_command_poll(lidar) != TMINI_UNDER_WAY;
    lidar->idle_ms = has_failed && lidar->pending == 0 ? 1 : 0;
}

/* A lidar that is known to be idle is not stopped first. */
static void begin_command(tmini_t *lidar, tmini_event_t operation)
{
    const bool is_idle = lidar->state == TMINI_STATE_IDLE;
    lidar->state =
        operation == TMINI_EVENT_STOPPED ? TMINI_STATE_STOPPING : (uint8_t)TMINI_STATE_BUSY;
    tmini_command_begin(lidar, operation, is_idle);
    send_first(lidar);
}

/* Begins a query or a reboot, if the state permits it. */
static tmini_status_t request_command(tmini_t *lidar, tmini_event_t operation)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->is_listen_only) {
        return TMINI_ERROR_LISTEN_ONLY;
    }
    if (lidar->state >= TMINI_STATE_SCANNING) {
        return TMINI_ERROR_STATE;
    }
    if (is_busy(lidar)) {
        return TMINI_ERROR_BUSY;
    }
    take_over(lidar);
    begin_command(lidar, operation);
    return TMINI_OK;
}

/* Not inlined, so that its buffer takes no stack while packets are processed. */
TMINI_NOINLINE static void take_reply(tmini_t *lidar)
{
    uint8_t content[TMINI_INFO_SIZE];
    tmini_parser_t *const parser = &lidar->decoder.parser;
    look(lidar); /* Notes the bytes that came during this poll. */
    if (!tmini_frame_content(tmini_parser_frame(parser), content, parser->awaited.length)) {
        tmini_parser_await_again(parser); /* DMA has overwritten it. */
        return;
    }
    take_result(lidar, tmini_command_reply(lidar, content));
}

/* ------------------------------------------------------------------------------------ scanning */

/* The lidar is lost if this is not called again in time. */
static void expect_packet(tmini_t *lidar)
{
    tmini_command_wait(lidar, TMINI_DATA_TIMEOUT_MS);
}

/* The lidar scans although it was stopped: the stop was lost on the wire. The program expects no
 * scans, so the motor would wear out unnoticed. */
static void stop_again(tmini_t *lidar)
{
    raise_event(lidar, TMINI_EVENT_UNWANTED_SCANNING);
    begin_command(lidar, TMINI_EVENT_STOPPED);
}

/* Decides whether a packet means that the lidar scans now. It does not in the tail after a stop
 * (section 9.10), nor while the frequency is being set. In all other phases of a start it does,
 * because the reply to the start may have been lost. */
static void note_scanning(tmini_t *lidar)
{
    const uint8_t phase = lidar->command.phase;
    if (lidar->state == TMINI_STATE_RECOVERING || lidar->state == TMINI_STATE_STARTING) {
        if (phase != TMINI_PHASE_QUIESCING && lidar->command.operation != TMINI_EVENT_FREQUENCY) {
            begin_scanning(lidar);
        }
    } else if (phase == TMINI_PHASE_IDLE) {
        stop_again(lidar);
    }
}

/* A wrong frequency is set again once. As long as the lidar does not answer, this is repeated at
 * growing intervals. With TMINI_RECOVERY_OFF it is never set again. */
static bool is_worth_a_restart(const tmini_t *lidar)
{
    return !lidar->is_recovery_off &&
           (lidar->monitor.off_times == 1 || tmini_frequency_chz(lidar) == 0);
}

static void monitor_packet(tmini_t *lidar)
{
    const tmini_turn_t turn =
        tmini_monitor_packet(&lidar->monitor, &lidar->decoder, lidar->command.wanted_chz);
    if (turn == TMINI_TURN_WHOLE) {
        tmini_recovery_forget(lidar); /* A lost lidar has recovered now. */
    } else if (turn == TMINI_TURN_ENDLESS) {
        lose(lidar);
    } else if (turn == TMINI_TURN_OFF && is_worth_a_restart(lidar)) {
        tmini_command_forget_frequency(lidar); /* The reported value is wrong. */
        restart(lidar);
    }
}

/* Copies the scan's structure, so that the builder can begin the next scan; it uses the spare
 * buffer if there is one. */
static void deliver_scan(tmini_t *lidar)
{
    lidar->scan = lidar->decoder.builder.scan;
    if (lidar->link.spare_points != NULL) {
        tmini_builder_use(&lidar->decoder.builder, lidar->link.spare_points);
        lidar->link.spare_points = lidar->scan.points;
    }
    if (lidar->link.step != NULL) {
        lidar->link.step(lidar->link.step_data, &lidar->scan);
    }
    lidar->scans++;
    raise_event(lidar, TMINI_EVENT_SCAN);
}

/* Returns when the packet came, which is before the bytes that follow it. Bytes that came during
 * this poll are noted first, because the line may have paused before them. */
static uint32_t arrival_ms(tmini_t *lidar)
{
    if (tmini_ring_head(&lidar->ring) != lidar->line.received) {
        look(lidar);
    }
    return tmini_line_arrival_ms(lidar);
}

static void take_packet(tmini_t *lidar)
{
    const uint32_t came_ms = arrival_ms(lidar);
    note_scanning(lidar);
    const bool is_doubtful = tmini_line_is_doubtful(lidar, came_ms);
    if (lidar->state != TMINI_STATE_SCANNING) {
        return; /* A packet of the tail after a stop, or of a lidar that is not to scan. */
    }
    expect_packet(lidar);
    if (tmini_decoder_take(&lidar->decoder, is_doubtful, came_ms, lidar->line.late_ms)) {
        deliver_scan(lidar);
    } else if (lidar->decoder.builder.capacity == 0) {
        raise_event(lidar, TMINI_EVENT_PACKET);
    }
    monitor_packet(lidar);
}

/* ------------------------------------------------------------------------------------- polling */

/* Gives up a candidate whose bytes have stopped coming, so that the bytes after its first one are
 * examined. */
static bool give_up_candidate(tmini_t *lidar)
{
    const uint16_t silent_ms = lidar->line.silent_ms;
    if (silent_ms == 0 || silent_ms < lidar->link.timing->frame_timeout_ms ||
        tmini_ring_head(&lidar->ring) != lidar->line.received) {
        return false;
    }
    return tmini_parser_abandon(&lidar->decoder.parser);
}

/* Handles frames until one raises an event or none is left. Returns false if that takes more work
 * than one poll may do. */
static bool receive(tmini_t *lidar)
{
    const tmini_parser_t *const parser = &lidar->decoder.parser;
    uint16_t effort = 0;
    while (lidar->pending == 0) {
        if (effort >= TMINI_PARSER_EFFORT) {
            return false;
        }
        const tmini_frame_type_t type = tmini_decoder_next(&lidar->decoder, effort);
        if (type == TMINI_FRAME_PACKET) {
            take_packet(lidar);
        } else if (type == TMINI_FRAME_REPLY) {
            take_reply(lidar);
        } else if (type == TMINI_FRAME_NONE && !give_up_candidate(lidar)) {
            return true;
        }
        effort = (uint16_t)(FRAME_EFFORT + parser->effort + tmini_parser_frame(parser)->size);
    }
    return true;
}

/* Does what is due because time has passed or the line is quiet. */
static void keep_time(tmini_t *lidar)
{
    take_result(lidar, tmini_command_poll(lidar));
}

/* There is nothing to do until a frame may be complete, or until the next time-out. This time-out
 * is computed once, here, not at each poll. */
static void settle(tmini_t *lidar)
{
    const uint16_t frame_ms = lidar->link.timing->frame_timeout_ms;
    const int32_t left_ms = (int32_t)frame_ms - lidar->line.silent_ms;
    const uint16_t give_up_ms = left_ms > 0 ? (uint16_t)left_ms : frame_ms;
    const uint16_t command_ms = tmini_command_idle_ms(lidar);
    const uint16_t due_ms = give_up_ms < command_ms ? give_up_ms : command_ms;
    const uint8_t idle_ms = (uint8_t)(due_ms < IDLE_MAX_MS ? due_ms : IDLE_MAX_MS);
    if (lidar->command.unsent == 0) {
        lidar->idle_ms = idle_ms > 0 ? idle_ms : 1;
    }
}

/* True if a settled lidar has been idle for long enough, or a frame may be complete. The clock is
 * read first, because a port may feed bytes when its clock is read. Most polls of a fast loop end
 * here. */
static bool has_news(const tmini_t *lidar)
{
    const tmini_link_t *const link = &lidar->link;
    const uint32_t passed_ms = link->port->now_ms(link->port_context) - lidar->line.now_ms;
    return passed_ms >= lidar->idle_ms || tmini_parser_has_work(&lidar->decoder.parser);
}

/* The rest of a poll, after it has looked at the line. */
TMINI_NOINLINE static tmini_event_t work(tmini_t *lidar)
{
    const uint8_t faults = lidar->monitor.faults;
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
    settle(lidar);
    return TMINI_EVENT_NONE;
}

tmini_event_t tmini_poll(tmini_t *lidar)
{
    if (lidar == NULL) {
        return TMINI_EVENT_NONE;
    }
    if (lidar->idle_ms > 0) {
        if (!has_news(lidar)) {
            return TMINI_EVENT_NONE;
        }
    } else if (lidar->link.port == NULL) {
        return take_event(lidar); /* Not set up. */
    }
    look(lidar);
    lidar->idle_ms = 0;
    return work(lidar);
}

/* ---------------------------------------------------------------------------------- life cycle */

TMINI_NOINLINE static bool is_frequency(uint16_t frequency_chz)
{
    return frequency_chz >= TMINI_FREQUENCY_MIN_CHZ && frequency_chz <= TMINI_FREQUENCY_MAX_CHZ &&
           frequency_chz % TMINI_FREQUENCY_STEP_CHZ == 0;
}

static bool has_port(const tmini_config_t *config)
{
    const tmini_port_t *const port = config->port;
    return port != NULL && port->now_ms != NULL && (port->write != NULL || config->listen_only);
}

/* Checks members that require or exclude each other. The line must become quiet before a stop times
 * out. */
static bool fits_together(const tmini_config_t *config)
{
    return (config->frequency_chz == 0 ||
            (is_frequency(config->frequency_chz) && !config->listen_only)) &&
           (config->points != NULL ? config->spare_points != config->points
                                   : config->step == NULL && config->spare_points == NULL) &&
           (config->step != NULL || config->step_data == NULL) &&
           (config->timing == NULL || config->timing->quiet_line_ms < TMINI_STOP_TIMEOUT_MS);
}

/* Ring and decoder check their own parts of the configuration. */
static bool init_modules(tmini_t *lidar, const tmini_config_t *config)
{
    return tmini_ring_init(&lidar->ring, config->rx_buffer, config->rx_size, config->rx_dma) ==
               TMINI_OK &&
           tmini_decoder_init(&lidar->decoder, &lidar->ring, config->max_samples) == TMINI_OK &&
           ((config->points == NULL && config->max_points == 0) || /* No scans. */
            tmini_builder_init(&lidar->decoder.builder, config->points, config->max_points,
                               config->filter) == TMINI_OK);
}

tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config)
{
    if (lidar == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *lidar = (tmini_t){0}; /* State unknown, no phase, no CT information. */
    if (config == NULL || !has_port(config) || !fits_together(config) ||
        !init_modules(lidar, config)) {
        fail(lidar, TMINI_ERROR_ARGUMENT);
        return TMINI_ERROR_ARGUMENT;
    }
    lidar->link = (tmini_link_t){
        .port = config->port, /* From now on the lidar is set up. */
        .port_context = config->port_context,
        .timing = config->timing != NULL ? config->timing : &tmini_timing_default,
        .step = config->step,
        .step_data = config->step_data,
        .spare_points = config->spare_points,
    };
    tmini_command_want(lidar, config->frequency_chz);
    lidar->is_recovery_off = config->recovery == TMINI_RECOVERY_OFF;
    lidar->is_listen_only = config->listen_only;
    return TMINI_OK;
}

/* -------------------------------------------------------------------------- wishes and queries */

tmini_status_t tmini_start(tmini_t *lidar)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->state == TMINI_STATE_BUSY || lidar->state == TMINI_STATE_STOPPING) {
        lidar->start_follows = true;
    } else if (!is_to_scan(lidar)) {
        take_over(lidar);
        begin_start(lidar);
        send_first(lidar);
    }
    return TMINI_OK;
}

tmini_status_t tmini_stop(tmini_t *lidar)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    lidar->start_follows = false;
    if (lidar->state == TMINI_STATE_STOPPING) {
        return TMINI_OK;
    }
    const bool was_busy = is_busy(lidar);
    take_over(lidar);
    if (was_busy) {
        fail(lidar, TMINI_ERROR_ABORTED);
    }
    if (lidar->is_listen_only) {
        tmini_cancel(lidar); /* Nothing was sent, so nothing is stopped. */
        raise_event(lidar, TMINI_EVENT_STOPPED);
    } else {
        begin_command(lidar, TMINI_EVENT_STOPPED);
    }
    return TMINI_OK;
}

/* An unchanged wish makes the driver ask again only while the lidar is idle or its state unknown.
 * Otherwise it changes nothing: it must not interrupt a scan or clear the frequency fault. */
tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz)
{
    if (!is_set_up(lidar) || !is_frequency(frequency_chz)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->is_listen_only) {
        return TMINI_ERROR_LISTEN_ONLY;
    }
    if (lidar->command.wanted_chz == frequency_chz && lidar->state > TMINI_STATE_IDLE) {
        return TMINI_OK;
    }
    tmini_command_want(lidar, frequency_chz);
    if ((lidar->monitor.faults & TMINI_FAULT_FREQUENCY) != 0) {
        raise_event(lidar, TMINI_EVENT_FAULTS_CHANGED);
        lidar->idle_ms = 0;
    }
    tmini_monitor_forget_frequency(&lidar->monitor);
    if (lidar->state <= TMINI_STATE_IDLE) {
        return request_command(lidar, TMINI_EVENT_FREQUENCY);
    }
    if (is_to_scan(lidar)) {
        look(lidar);
        restart(lidar);
        send_first(lidar);
    }
    return TMINI_OK;
}

tmini_status_t tmini_request_info(tmini_t *lidar)
{
    return request_command(lidar, TMINI_EVENT_INFO);
}

tmini_status_t tmini_request_health(tmini_t *lidar)
{
    return request_command(lidar, TMINI_EVENT_HEALTH);
}

tmini_status_t tmini_request_frequency(tmini_t *lidar)
{
    return request_command(lidar, TMINI_EVENT_FREQUENCY);
}

tmini_status_t tmini_reboot(tmini_t *lidar)
{
    return request_command(lidar, TMINI_EVENT_REBOOTED);
}

void tmini_cancel(tmini_t *lidar)
{
    (void)tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    lidar->idle_ms = 0;
    lidar->start_follows = false;
    lidar->state = TMINI_STATE_UNKNOWN;
}

/* ------------------------------------------------------------------------------------- results */

/* The parser's counters come first, in the same order: they are copied in one piece. */
typedef char
    counters_begin_with_the_parsers[offsetof(tmini_counters_t, bytes_overrun) ==
                                                offsetof(tmini_parser_counters_t, bytes_overrun) &&
                                            offsetof(tmini_counters_t, bytes_pending) ==
                                                sizeof(tmini_parser_counters_t)
                                        ? 1
                                        : -1];

/* Reads the ring directly, because before tmini_init() the parser has no ring. */
void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters)
{
    const tmini_ring_t *const ring = &lidar->ring;
    const tmini_parser_counters_t *const parser = &lidar->decoder.parser.counters;
    const size_t pending =
        tmini_ring_unread(ring) - tmini_parser_frame(&lidar->decoder.parser)->size;
    TMINI_COPY(counters, parser, sizeof *parser);
    counters->bytes_overrun += (uint32_t)tmini_ring_overrun(ring);
    counters->bytes_pending = (uint32_t)pending;
    counters->scans = lidar->scans;
    counters->late_scans = lidar->decoder.builder.late_scans;
    counters->timeouts = lidar->command.timeouts;
    counters->losses = lidar->recovery.losses;
    counters->recoveries = lidar->recovery.recoveries;
    counters->restarts = lidar->recovery.restarts;
    counters->reboots = lidar->recovery.reboots;
}
