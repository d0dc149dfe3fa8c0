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
    .back_off_max_ms = 2000,
    .max_attempts = 3,
};

/* Each event has a bit in tmini_t.pending. */
#define BIT(event) (1u << (event))
typedef char events_fit_their_mask[TMINI_EVENT_MORE <= 16 ? 1 : -1];

/* Handling a frame of n bytes costs as much as parsing n + 44 bytes: samples become points, and the
 * packet's time and place in the scan are computed. */
#define FRAME_EFFORT 44u

/* The longest time between two looks at the line, also when there is nothing to do: about one
 * packet. */
#define IDLE_MAX_MS 10u

/* No tail of a stop has longer pauses; and a line that is never quiet must be noticed in time. */
#define QUIET_LINE_LIMIT_MS 600u

/* The greatest age of a scan: half the range of the clock. */
#define AGE_MAX_MS (UINT32_MAX / 2)

TMINI_INLINE bool is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && lidar->link.port != NULL;
}

/* The lidar scans, or the driver tries to make it scan. */
static bool is_to_scan(const tmini_t *lidar)
{
    return tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED) &&
           !(lidar->recovery.is_lost && lidar->is_recovery_off);
}

/* The state follows from the phase and the wishes. */
tmini_state_t tmini_state(const tmini_t *lidar)
{
    if (lidar == NULL) {
        return TMINI_STATE_UNKNOWN;
    }
    if (tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED)) {
        if (tmini_command_is_scanning(lidar)) {
            return TMINI_STATE_SCANNING;
        }
        return lidar->recovery.is_lost ? TMINI_STATE_RECOVERING : TMINI_STATE_STARTING;
    }
    if (tmini_command_is_busy(lidar)) {
        return lidar->command.operation == TMINI_EVENT_STOPPED ? TMINI_STATE_STOPPING
                                                               : TMINI_STATE_BUSY;
    }
    return lidar->command.phase == TMINI_PHASE_IDLE ? TMINI_STATE_IDLE : TMINI_STATE_UNKNOWN;
}

/* ------------------------------------------------------------------------------------- events */

/* With an event to return, the next poll must not rest. */
TMINI_NOINLINE static void raise_event(tmini_t *lidar, tmini_event_t event)
{
    lidar->pending |= (uint16_t)BIT(event);
    lidar->idle_ms = 0;
}

/* Removes and returns the first pending event in the order of tmini_event_t, or
 * TMINI_EVENT_NONE. */
static tmini_event_t take_event(tmini_t *lidar)
{
    const unsigned pending = lidar->pending;
    lidar->pending = (uint16_t)(pending & (pending - 1)); /* Without the lowest bit. */
    return tmini_recovery_first(pending);
}

/* A new wish drops the events that ended an earlier one and have not been polled: the program would
 * think that they end this one. */
static void drop_events(tmini_t *lidar, unsigned events)
{
    if (!tmini_command_is_busy(lidar)) {
        events |= BIT(TMINI_EVENT_COMMAND_FAILED);
    }
    lidar->pending = (uint16_t)(lidar->pending & ~events);
}

static void fail(tmini_t *lidar, int status)
{
    lidar->command_error = (int8_t)status;
    raise_event(lidar, TMINI_EVENT_COMMAND_FAILED);
}

/* A wish has ended: raises its event, or reports the error. */
TMINI_NOINLINE static void end_wish(tmini_t *lidar, tmini_event_t event, int result)
{
    tmini_recovery_forget_wish(lidar, event);
    if (result == TMINI_OK) {
        raise_event(lidar, event);
    } else {
        fail(lidar, result);
    }
}

/* Looks at the line. Once bytes have come, the lidar is no longer known to be idle. */
TMINI_NOINLINE static void look(tmini_t *lidar)
{
    if (tmini_line_look(lidar, tmini_command_is_scanning(lidar))) {
        tmini_command_disturb(lidar);
    }
}

/* ------------------------------------------------------------------------------------ scanning */

/* The driver stops a lidar that scans, to set its frequency. */
static void restart(tmini_t *lidar)
{
    raise_event(lidar, TMINI_EVENT_PAUSED);
    tmini_recovery_restart(lidar);
}

/* The lidar is lost. Another unit may come back, so what is known about this one is forgotten. */
static void lose(tmini_t *lidar)
{
    raise_event(lidar, TMINI_EVENT_LOST);
    tmini_command_forget_frequency(lidar);
    tmini_monitor_forget_frequency(&lidar->monitor);
    tmini_ct_init(&lidar->decoder.ct);
    tmini_recovery_begin(lidar);
}

/* The lidar is lost if this is not called again in time. */
static void expect_packet(tmini_t *lidar)
{
    tmini_command_wait(lidar, TMINI_PHASE_SCANNING, TMINI_DATA_TIMEOUT_MS);
}

/* The lidar scans. So the start command is not sent again, and its reply is not awaited (section
 * 2). A frequency that could not be set is reported now, unless the wish has changed meanwhile. */
static void begin_scanning(tmini_t *lidar)
{
    tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    if (lidar->recovery.is_lost) {
        tmini_recovery_end(lidar);
        raise_event(lidar, TMINI_EVENT_RECOVERED);
    } else {
        tmini_recovery_forget(lidar);
        raise_event(lidar, TMINI_EVENT_STARTED);
    }
    if (tmini_recovery_is_unset(lidar)) {
        raise_event(lidar, TMINI_EVENT_COMMAND_FAILED);
        tmini_recovery_note_frequency(lidar, true);
    }
    expect_packet(lidar);
    tmini_decoder_restart(&lidar->decoder);
    tmini_monitor_begin(&lidar->monitor);
}

/* ----------------------------------------------------------------------- how operations end */

/* Each failed attempt to start is reported. During recovery none is, because the loss has been
 * reported. */
static void fail_attempt(tmini_t *lidar, int result)
{
    tmini_recovery_restart_reception(lidar);
    if (!lidar->recovery.is_lost) {
        fail(lidar, result);
        if (lidar->is_recovery_off) {
            tmini_recovery_forget_wish(lidar, TMINI_EVENT_STARTED);
        }
    }
    tmini_recovery_back_off(lidar, result);
}

/* The event is not raised if no frequency is wanted and the program has not asked. */
TMINI_NOINLINE static void end_frequency(tmini_t *lidar, int result)
{
    const bool is_wanted = lidar->command.wanted_chz != 0;
    const bool is_set = result == TMINI_OK;
    tmini_recovery_note_frequency(lidar, is_set || !is_wanted);
    if (tmini_recovery_wishes(lidar, TMINI_EVENT_FREQUENCY) || (is_wanted && is_set)) {
        end_wish(lidar, TMINI_EVENT_FREQUENCY, result);
    } else if (!is_set) {
        lidar->command_error = (int8_t)result;
    }
}

/* A step of the ladder has ended in this phase, and no packet has come yet. A successful start does
 * not come here: it ends with the first packet. A frequency that could not be set is reported when
 * scanning begins; the start follows even then. */
static void climb(tmini_t *lidar, tmini_event_t operation, tmini_phase_t phase, int result)
{
    bool goes_on = result == TMINI_OK;
    if (operation == TMINI_EVENT_FREQUENCY) {
        end_frequency(lidar, result);
        goes_on = phase != TMINI_PHASE_ASKING || result != TMINI_ERROR_TIMEOUT ||
                  tmini_recovery_note_silence(lidar);
    }
    if (goes_on) {
        tmini_recovery_go_on(lidar, operation);
    } else {
        fail_attempt(lidar, result);
    }
}

/* A stop or a question has ended. */
static void end_command(tmini_t *lidar, tmini_event_t operation, int result)
{
    end_wish(lidar, operation, result);
    tmini_recovery_go_on(lidar, TMINI_EVENT_NONE);
}

/* Acts on the result of the current operation, which is no longer under way. */
static void take_result(tmini_t *lidar, int result)
{
    const tmini_event_t operation = (tmini_event_t)lidar->command.operation;
    const tmini_phase_t phase = (tmini_phase_t)lidar->command.phase;
    if (result == TMINI_SCANS) {
        begin_scanning(lidar);
        return;
    }
    tmini_command_end(lidar, result);
    if (phase >= TMINI_PHASE_SCANNING) {
        lose(lidar);
    } else if (tmini_recovery_is_step(lidar, operation)) {
        climb(lidar, operation, phase, result);
    } else {
        end_command(lidar, operation, result);
    }
}

/* The wishes have changed: begins the next operation, and offers its first bytes to the port at
 * once. If the port reports a failure, it is asked again when time has passed; until then a poll
 * has nothing to do. So a loop that polls until TMINI_EVENT_NONE ends, even if it repeats each
 * failed command. */
TMINI_NOINLINE static void begin(tmini_t *lidar)
{
    tmini_recovery_go_on(lidar, TMINI_EVENT_NONE);
    const bool has_failed = tmini_command_poll(lidar) != TMINI_UNDER_WAY;
    lidar->idle_ms = has_failed && lidar->pending == 0 ? 1 : 0;
}

/* A wish of the user has been added: carries it out at once if nothing else is in progress. */
static void act(tmini_t *lidar)
{
    if (!tmini_command_is_busy(lidar)) {
        begin(lidar);
    }
}

/* Stops the lidar, whatever is in progress, unless that is a stop. With listen_only nothing was
 * sent, so nothing is stopped. */
static void begin_stop(tmini_t *lidar)
{
    const bool is_stopping = tmini_recovery_wishes(lidar, TMINI_EVENT_STOPPED);
    tmini_recovery_forget_wishes(lidar);
    tmini_recovery_wish(lidar, TMINI_EVENT_STOPPED);
    if (lidar->is_listen_only) {
        tmini_command_end(lidar, TMINI_ERROR_ABORTED);
        end_wish(lidar, TMINI_EVENT_STOPPED, TMINI_OK);
    } else if (!is_stopping) {
        begin(lidar);
    }
}

/* To start, a question, or a reboot. */
static tmini_status_t take_wish(tmini_t *lidar, tmini_event_t event)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (event == TMINI_EVENT_STARTED) {
        if (is_to_scan(lidar)) {
            return TMINI_OK;
        }
    } else if (lidar->is_listen_only) {
        return TMINI_ERROR_LISTEN_ONLY;
    } else if (tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED)) {
        return TMINI_ERROR_STATE;
    }
    look(lidar);
    drop_events(lidar, BIT(event));
    if (lidar->recovery.is_lost) { /* It only listens, because recovery is off. */
        tmini_command_end(lidar, TMINI_ERROR_ABORTED);
    }
    tmini_recovery_wish(lidar, event);
    act(lidar);
    return TMINI_OK;
}

/* ----------------------------------------------------------------------------- what comes in */

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
    tmini_recovery_note_reply(lidar);
    const int result = tmini_command_reply(lidar, content);
    if (result != TMINI_UNDER_WAY) {
        take_result(lidar, result);
    }
}

/* Of a lost lidar, a point packet is no proof that it scans as it should: it may send no start
 * packets. */
static tmini_sign_t sign_of_packet(tmini_t *lidar)
{
    tmini_packet_t *const packet = &lidar->decoder.packet;
    if (!lidar->recovery.is_lost) {
        return TMINI_SIGN_SCANS;
    }
    tmini_packet_open(packet, tmini_parser_frame(&lidar->decoder.parser));
    if (tmini_packet_is_start(packet)) {
        return TMINI_SIGN_SCANS;
    }
    return tmini_packet_has_range(packet) ? TMINI_SIGN_TURNS : TMINI_SIGN_STANDS;
}

/* True if the lidar scans, as it is wanted to. A lidar that scans although it was stopped is
 * stopped again: the program expects no scans, so the motor would wear out unnoticed. */
static bool note_scanning(tmini_t *lidar)
{
    if (tmini_command_is_scanning(lidar)) {
        return true;
    }
    switch (tmini_command_packet(lidar, sign_of_packet(lidar))) {
    case TMINI_PACKET_FIRST:
        begin_scanning(lidar);
        return true;
    case TMINI_PACKET_UNWANTED:
        raise_event(lidar, TMINI_EVENT_UNWANTED_SCANNING);
        begin_stop(lidar);
        return false;
    default:
        return false;
    }
}

/* A wrong or unknown frequency is set again once. As long as it is not known to be set, this is
 * repeated at growing intervals, unless the lidar never answers. With TMINI_RECOVERY_OFF it is
 * never set again. */
static bool is_worth_a_restart(const tmini_t *lidar)
{
    if (lidar->is_recovery_off) {
        return false;
    }
    return lidar->monitor.off_times == 1 ||
           (tmini_frequency_chz(lidar) == 0 && !tmini_recovery_is_mute(lidar));
}

static void monitor_packet(tmini_t *lidar)
{
    switch (tmini_monitor_packet(&lidar->monitor, &lidar->decoder, lidar->command.wanted_chz,
                                 tmini_frequency_chz(lidar))) {
    case TMINI_TURN_WHOLE:
        tmini_recovery_forget(lidar); /* A lost lidar has recovered now. */
        break;
    case TMINI_TURN_STILL:
        if (!tmini_command_has_frequency(lidar)) {
            restart(lidar);
        }
        break;
    case TMINI_TURN_OFF:
        if (is_worth_a_restart(lidar)) {
            tmini_command_forget_frequency(lidar); /* The reported value is wrong. */
            restart(lidar);
        }
        break;
    case TMINI_TURN_ENDLESS:
        lose(lidar);
        break;
    default:
        break;
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
    if (lidar->scan.complete) {
        lidar->complete_ms = lidar->scan.end_ms != 0 ? lidar->scan.end_ms : 1;
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

/* A program that is behind and gets a scan for each packet in doubt would never catch up. So it
 * gets whole scans or none: a scan of at most two packets that a doubt ends is counted, not
 * delivered, and any incomplete one while the port holds more bytes. */
static void end_scan(tmini_t *lidar, bool is_doubtful)
{
    const tmini_scan_t *const scan = &lidar->decoder.builder.scan;
    const bool is_remnant =
        (is_doubtful && scan->packets <= 2) || (!scan->complete && lidar->line.held > 0);
    if (is_remnant && tmini_line_is_behind(lidar)) {
        lidar->points_withheld += scan->count;
    } else {
        deliver_scan(lidar);
    }
}

static void take_packet(tmini_t *lidar)
{
    const uint32_t came_ms = arrival_ms(lidar);
    if (!note_scanning(lidar)) {
        (void)tmini_line_is_doubtful(lidar, came_ms); /* The end of a doubt must not be missed. */
        return; /* A packet of the tail after a stop, or of a lidar that is not to scan. */
    }
    const bool is_doubtful = tmini_line_is_doubtful(lidar, came_ms);
    expect_packet(lidar);
    if (tmini_decoder_take(&lidar->decoder, is_doubtful, came_ms, lidar->line.late_ms)) {
        end_scan(lidar, is_doubtful);
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

/* Handles frames until there is an event or none is left. Returns false if that takes more work
 * than one poll may do. The frame handled last is counted before the next one is sought; also one
 * of an earlier poll, because a packet that has ended a scan is decoded again. */
static bool receive(tmini_t *lidar)
{
    const tmini_parser_t *const parser = &lidar->decoder.parser;
    size_t effort = FRAME_EFFORT + tmini_parser_frame(parser)->size;
    while (lidar->pending == 0) {
        const tmini_frame_type_t type = tmini_decoder_next(&lidar->decoder, effort);
        if (type == TMINI_FRAME_PACKET) {
            take_packet(lidar);
        } else if (type == TMINI_FRAME_REPLY) {
            take_reply(lidar);
        } else if (type == TMINI_FRAME_NONE && !give_up_candidate(lidar)) {
            return true;
        }
        effort = FRAME_EFFORT + parser->effort + tmini_parser_frame(parser)->size;
        if (effort >= TMINI_PARSER_EFFORT) {
            return false;
        }
    }
    return true;
}

/* Does what is due because time has passed or the line is quiet. True if it ends the current
 * operation. */
static bool advance(tmini_t *lidar)
{
    const int result = tmini_command_poll(lidar);
    if (result == TMINI_UNDER_WAY) {
        return false;
    }
    take_result(lidar, result);
    return true;
}

/* What follows an operation is sent at once. After a failure comes an event or a pause, so this
 * ends. */
static void keep_time(tmini_t *lidar)
{
    while (lidar->pending == 0 && advance(lidar)) {
    }
}

/* A scan of 24 days ago is as good as none: the clock's wrap-around must not make it new again. */
static void limit_age(tmini_t *lidar)
{
    if (lidar->line.now_ms - lidar->complete_ms > AGE_MAX_MS) {
        lidar->complete_ms = 0;
    }
}

/* There is nothing to do until a frame may be complete, or until the next time-out. This time-out
 * is computed once, here, not at each poll. */
static void settle(tmini_t *lidar)
{
    const unsigned frame_ms = lidar->link.timing->frame_timeout_ms;
    const unsigned silent_ms = lidar->line.silent_ms;
    const unsigned give_up_ms = frame_ms > silent_ms ? frame_ms - silent_ms : frame_ms;
    const unsigned command_ms = tmini_command_idle_ms(lidar);
    const unsigned due_ms = give_up_ms < command_ms ? give_up_ms : command_ms;
    const unsigned idle_ms = due_ms < IDLE_MAX_MS ? due_ms : IDLE_MAX_MS;
    limit_age(lidar);
    tmini_line_settle(lidar);
    if (!tmini_command_is_sending(lidar)) {
        lidar->idle_ms = (uint8_t)(idle_ms > 0 ? idle_ms : 1);
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
    const bool is_done = receive(lidar);
    keep_time(lidar);
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

/* The nearest frequency that may be set; 0: this one is out of range. */
TMINI_NOINLINE static uint16_t nearest_step(uint16_t frequency_chz)
{
    if (frequency_chz < TMINI_FREQUENCY_MIN_CHZ || frequency_chz > TMINI_FREQUENCY_MAX_CHZ) {
        return 0;
    }
    return (uint16_t)((frequency_chz + TMINI_FREQUENCY_STEP_CHZ / 2) / TMINI_FREQUENCY_STEP_CHZ *
                      TMINI_FREQUENCY_STEP_CHZ);
}

static bool has_port(const tmini_config_t *config)
{
    const tmini_port_t *const port = config->port;
    return port != NULL && port->now_ms != NULL && (port->write != NULL || config->listen_only);
}

/* Checks members that are of no module below, or exclude each other. */
static bool fits_together(const tmini_config_t *config)
{
    return (config->step != NULL || config->step_data == NULL) &&
           (unsigned)config->recovery <= TMINI_RECOVERY_OFF &&
           (config->timing == NULL || config->timing->quiet_line_ms < QUIET_LINE_LIMIT_MS);
}

/* A lidar to which nothing is sent has the frequency that it has. */
static bool init_frequency(tmini_t *lidar, const tmini_config_t *config)
{
    tmini_command_want(lidar, nearest_step(config->frequency_chz));
    return config->frequency_chz == 0 || (lidar->command.wanted_chz != 0 && !config->listen_only);
}

/* Scans need points; and what needs scans needs them, too. */
static bool init_scans(tmini_builder_t *builder, const tmini_config_t *config)
{
    const bool are_wanted = config->points != NULL || config->max_points != 0 ||
                            config->filter != TMINI_FILTER_NONE || config->spare_points != NULL ||
                            config->step != NULL;
    return !are_wanted || (config->spare_points != config->points &&
                           tmini_builder_init(builder, config->points, config->max_points,
                                              config->filter) == TMINI_OK);
}

/* Ring, parser and builder check their own parts of the configuration. What else a decoder has is 0
 * at first. */
static bool init_modules(tmini_t *lidar, const tmini_config_t *config)
{
    return tmini_ring_init(&lidar->ring, config->rx_buffer, config->rx_size, config->rx_dma) ==
               TMINI_OK &&
           tmini_parser_init(&lidar->decoder.parser, &lidar->ring, config->max_samples) ==
               TMINI_OK &&
           init_scans(&lidar->decoder.builder, config);
}

tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config)
{
    if (lidar == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *lidar = (tmini_t){0}; /* State unknown, no phase, no CT information. */
    if (config == NULL || !has_port(config) || !fits_together(config) ||
        !init_frequency(lidar, config) || !init_modules(lidar, config)) {
        lidar->ring.size = 0; /* It refuses bytes. */
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
    lidar->is_recovery_off = config->recovery == TMINI_RECOVERY_OFF;
    lidar->is_listen_only = config->listen_only;
    return TMINI_OK;
}

/* -------------------------------------------------------------------------- wishes and queries */

tmini_status_t tmini_start(tmini_t *lidar)
{
    return take_wish(lidar, TMINI_EVENT_STARTED);
}

tmini_status_t tmini_stop(tmini_t *lidar)
{
    if (!is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    const unsigned stop = BIT(TMINI_EVENT_STOPPED);
    look(lidar);
    drop_events(lidar, stop | BIT(TMINI_EVENT_STARTED) | BIT(TMINI_EVENT_COMMAND_FAILED) |
                           BIT(TMINI_EVENT_PAUSED) | BIT(TMINI_EVENT_RECOVERED));
    if (tmini_state(lidar) <= TMINI_STATE_STARTING && (lidar->recovery.wishes & ~stop) != 0) {
        fail(lidar, TMINI_ERROR_ABORTED);
    }
    begin_stop(lidar);
    return TMINI_OK;
}

/* While the lidar is to scan, an unchanged wish changes nothing: it must not interrupt a scan or
 * clear the frequency fault. */
tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz)
{
    const uint16_t wanted_chz = nearest_step(frequency_chz);
    if (!is_set_up(lidar) || wanted_chz == 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->is_listen_only) {
        return TMINI_ERROR_LISTEN_ONLY;
    }
    const bool is_new = lidar->command.wanted_chz != wanted_chz;
    if (is_new) {
        tmini_command_want(lidar, wanted_chz);
        if ((lidar->monitor.faults & TMINI_FAULT_FREQUENCY) != 0) {
            raise_event(lidar, TMINI_EVENT_FAULTS_CHANGED);
        }
        tmini_monitor_forget_frequency(&lidar->monitor);
    }
    if (!tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED)) {
        tmini_command_renew_steps(lidar);
        return take_wish(lidar, TMINI_EVENT_FREQUENCY);
    }
    if (is_new) {
        tmini_monitor_await_still(&lidar->monitor);
    }
    return TMINI_OK;
}

tmini_status_t tmini_request_info(tmini_t *lidar)
{
    return take_wish(lidar, TMINI_EVENT_INFO);
}

tmini_status_t tmini_request_health(tmini_t *lidar)
{
    return take_wish(lidar, TMINI_EVENT_HEALTH);
}

tmini_status_t tmini_request_frequency(tmini_t *lidar)
{
    return take_wish(lidar, TMINI_EVENT_FREQUENCY);
}

tmini_status_t tmini_reboot(tmini_t *lidar)
{
    return take_wish(lidar, TMINI_EVENT_REBOOTED);
}

void tmini_withdraw(tmini_t *lidar, tmini_event_t query)
{
    const bool is_current =
        tmini_recovery_wishes(lidar, query) && lidar->command.operation == (uint8_t)query;
    tmini_recovery_forget_wish(lidar, query);
    if (is_current) {
        tmini_command_end(lidar, TMINI_ERROR_ABORTED);
        act(lidar);
    }
}

/* -------------------------------------------------------------------------------------- timing */

static uint32_t since_look_ms(const tmini_t *lidar)
{
    const uint32_t passed_ms =
        lidar->link.port->now_ms(lidar->link.port_context) - lidar->line.now_ms;
    return passed_ms <= AGE_MAX_MS ? passed_ms : 0; /* The clock was set back. */
}

uint32_t tmini_scan_age_ms(const tmini_t *lidar)
{
    if (!is_set_up(lidar) || lidar->complete_ms == 0) {
        return AGE_MAX_MS;
    }
    const uint32_t now_ms = lidar->line.now_ms + since_look_ms(lidar);
    const uint32_t age_ms = now_ms - lidar->complete_ms;
    return age_ms < AGE_MAX_MS ? age_ms : AGE_MAX_MS;
}

/* For how long silence may be left unobserved: it counts as 50 ms at most (tmini_line.c). */
static uint32_t candidate_due_ms(const tmini_t *lidar)
{
    const uint32_t frame_ms = lidar->link.timing->frame_timeout_ms;
    const uint32_t silent_ms = lidar->line.silent_ms;
    const uint32_t left_ms = frame_ms > silent_ms ? frame_ms - silent_ms : 1;
    if (tmini_parser_pending(&lidar->decoder.parser) == 0) {
        return UINT16_MAX;
    }
    return left_ms < TMINI_UNSEEN_SILENCE_MAX_MS ? left_ms : TMINI_UNSEEN_SILENCE_MAX_MS;
}

uint32_t tmini_next_poll_ms(const tmini_t *lidar)
{
    if (!is_set_up(lidar) || lidar->pending != 0) {
        return 0;
    }
    if (tmini_command_is_sending(lidar)) {
        return 1;
    }
    if (lidar->idle_ms == 0) {
        return 0;
    }
    const uint32_t command_ms = tmini_command_due_ms(lidar);
    const uint32_t candidate_ms = candidate_due_ms(lidar);
    const uint32_t due_ms = candidate_ms < command_ms ? candidate_ms : command_ms;
    const uint32_t passed_ms = since_look_ms(lidar);
    return due_ms > passed_ms ? due_ms - passed_ms : 0;
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
    counters->points_withheld = lidar->points_withheld;
    counters->timeouts = lidar->command.timeouts;
    counters->losses = lidar->recovery.losses;
    counters->recoveries = lidar->recovery.recoveries;
    counters->restarts = lidar->recovery.restarts;
    counters->reboots = lidar->recovery.reboots;
}
