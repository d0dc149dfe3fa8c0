/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Commands: how each is begun, carried out phase by phase, and ended. The state diagram is in
 * docs/design.md. */

#include "tmini_driver.h"

/* More frequency steps than any change needs (6 of 1 Hz and 9 of 0.1 Hz). */
#define STEPS_MAX 20
#define COARSE_STEP_CHZ 100
#define FINE_STEP_CHZ 10

/* The events with which commands end. */
#define END_EVENTS                                                                         \
    (1u << TMINI_EVENT_STARTED | 1u << TMINI_EVENT_STOPPED | 1u << TMINI_EVENT_INFO |      \
     1u << TMINI_EVENT_HEALTH | 1u << TMINI_EVENT_FREQUENCY | 1u << TMINI_EVENT_REBOOTED | \
     1u << TMINI_EVENT_FAILED)

/* ------------------------------------------------------------------------------------- sending */

/* Hands what is left of the command to the port. Returns false if the port reports a failure. */
static bool transmit(tmini_t *lidar)
{
    const uint8_t bytes[2] = {TMINI_COMMAND_SIGN, lidar->sent};
    const int taken =
        lidar->port->write(lidar->port_context, &bytes[2 - lidar->unsent], lidar->unsent);
    if (taken < 0) {
        return false;
    }
    lidar->unsent = (uint8_t)(taken < lidar->unsent ? lidar->unsent - taken : 0);
    lidar->sign_sent = lidar->unsent == 1;
    return true;
}

/* The bytes leave with the next tmini_driver_keep_time(). If the first byte of a command that is
 * given up has left already, it serves for this one: it is the same in all. */
static void send(tmini_t *lidar, tmini_command_t command)
{
    lidar->sent = (uint8_t)command;
    lidar->unsent = lidar->sign_sent ? 1 : 2;
    lidar->step_refused = false;
}

/* Sends a command when the line is quiet, and awaits what it is answered with, if anything. */
static void ask(tmini_t *lidar, tmini_command_t command)
{
    tmini_reply_shape_t shape;
    const bool answered = tmini_reply_shape(command, &shape);
    tmini_parser_await(&lidar->parser, answered ? &shape : NULL);
    send(lidar, command);
    if (answered) {
        driver_enter(lidar, PHASE_ASKING, lidar->timing->reply_ms);
    } else {
        driver_enter(lidar, PHASE_BOOTING, lidar->timing->reboot_ms);
    }
}

/* --------------------------------------------------------------------------- how commands end */

static void rest(tmini_t *lidar, enum phase phase)
{
    tmini_parser_await(&lidar->parser, NULL);
    lidar->goal = GOAL_NONE;
    lidar->recovering = false;
    lidar->unsent = 0;
    lidar->heard = false;
    driver_enter(lidar, phase, 0);
}

static void end(tmini_t *lidar, enum phase phase, tmini_event_t event)
{
    rest(lidar, phase);
    driver_raise(lidar, event);
}

void tmini_driver_cancel(tmini_t *lidar)
{
    rest(lidar, PHASE_UNKNOWN);
}

/* After a retry, the reply to an earlier attempt may still come: the line is not surely quiet. */
static void succeed(tmini_t *lidar, tmini_event_t event)
{
    end(lidar, lidar->attempts == 0 ? PHASE_IDLE : PHASE_UNKNOWN, event);
}

static void fail(tmini_t *lidar, tmini_status_t status)
{
    lidar->failure = (int8_t)status;
    end(lidar, PHASE_UNKNOWN, TMINI_EVENT_FAILED);
}

/* An attempt has failed: another one, unless it was the last. */
static void attempt_failed(tmini_t *lidar, tmini_status_t status)
{
    if (status == TMINI_ERROR_TIMEOUT) {
        lidar->timeouts++;
    }
    if (lidar->recovering) {
        tmini_driver_back_off(lidar);
        return;
    }
    lidar->attempts++;
    if (status == TMINI_ERROR_TIMEOUT && lidar->attempts < lidar->timing->attempts) {
        tmini_driver_hush(lidar);
        return;
    }
    fail(lidar, lidar->step_refused ? TMINI_ERROR_REPLY : status);
}

/* ----------------------------------------------------------------------------- frequency change */

static bool is_reached(const tmini_t *lidar)
{
    const int32_t left = (int32_t)lidar->target_chz - lidar->frequency_chz;
    return left >= -FINE_STEP_CHZ / 2 && left <= FINE_STEP_CHZ / 2;
}

/* Never beyond the target, so never out of the permitted range. */
static tmini_command_t next_step(const tmini_t *lidar)
{
    const int32_t left = (int32_t)lidar->target_chz - lidar->frequency_chz;
    if (left >= COARSE_STEP_CHZ) {
        return TMINI_COMMAND_FASTER_ONE;
    }
    if (left <= -COARSE_STEP_CHZ) {
        return TMINI_COMMAND_SLOWER_ONE;
    }
    return left > 0 ? TMINI_COMMAND_FASTER_TENTH : TMINI_COMMAND_SLOWER_TENTH;
}

/* A step's reply tells the new frequency. When that has come to the target, it is read back. */
static void continue_frequency_change(tmini_t *lidar)
{
    if (is_reached(lidar)) {
        ask(lidar, TMINI_COMMAND_GET_FREQUENCY);
    } else if (lidar->steps < STEPS_MAX) {
        lidar->steps++;
        ask(lidar, next_step(lidar));
    } else {
        fail(lidar, TMINI_ERROR_REPLY);
    }
}

static void frequency_reply(tmini_t *lidar, uint32_t frequency_chz)
{
    const bool is_step = lidar->sent != TMINI_COMMAND_GET_FREQUENCY;
    if (frequency_chz > UINT16_MAX) {
        fail(lidar, TMINI_ERROR_REPLY);
        return;
    }
    if (is_step && frequency_chz == lidar->frequency_chz) {
        /* A late reply of the step before, which looks the same; or the lidar refuses to step.
         * Wait on: time tells. */
        lidar->parser.awaiting = true;
        lidar->step_refused = true;
        return;
    }
    lidar->step_refused = false;
    lidar->frequency_chz = (uint16_t)frequency_chz;
    if (lidar->goal == GOAL_FREQUENCY || (!is_step && is_reached(lidar))) {
        succeed(lidar, TMINI_EVENT_FREQUENCY);
    } else {
        driver_enter(lidar, PHASE_SETTLING, lidar->timing->stop_ms);
    }
}

/* ------------------------------------------------------------------------------- carrying out */

void tmini_driver_hush(tmini_t *lidar)
{
    tmini_parser_await(&lidar->parser, NULL);
    send(lidar, TMINI_COMMAND_STOP);
    driver_enter(lidar, PHASE_HUSHING, lidar->timing->stop_ms);
}

/* What each goal's first command is, once the line is quiet. */
static const uint8_t first_command[] = {
    [GOAL_START] = TMINI_COMMAND_START,
    [GOAL_INFO] = TMINI_COMMAND_GET_INFO,
    [GOAL_HEALTH] = TMINI_COMMAND_GET_HEALTH,
    [GOAL_FREQUENCY] = TMINI_COMMAND_GET_FREQUENCY,
    [GOAL_SET_FREQUENCY] = TMINI_COMMAND_GET_FREQUENCY,
    [GOAL_REBOOT] = TMINI_COMMAND_REBOOT,
};

/* The line is quiet: the command that was asked for may be sent (section 2). */
static void issue(tmini_t *lidar)
{
    if (lidar->goal == GOAL_STOP) {
        end(lidar, PHASE_IDLE, TMINI_EVENT_STOPPED);
        return;
    }
    if (lidar->recovering && lidar->goal == GOAL_START) {
        lidar->restarts++;
    } else if (lidar->recovering) {
        lidar->reboots++;
    }
    ask(lidar, (tmini_command_t)first_command[lidar->goal]);
}

void tmini_driver_reply(tmini_t *lidar)
{
    uint8_t content[TMINI_INFO_SIZE];
    /* Bytes that came behind this reply, and only those, are heard in the idle state. */
    lidar->received = lidar->ring.tail + lidar->parser.frame;
    tmini_parser_reply_content(&lidar->parser, content, lidar->parser.awaited.length);
    switch (lidar->sent) {
    case TMINI_COMMAND_START:
        driver_enter(lidar, PHASE_SPINNING_UP, lidar->timing->spin_up_ms);
        break;
    case TMINI_COMMAND_GET_INFO:
        tmini_reply_info(content, &lidar->latest.info);
        succeed(lidar, TMINI_EVENT_INFO);
        break;
    case TMINI_COMMAND_GET_HEALTH:
        tmini_reply_health(content, &lidar->latest.health);
        succeed(lidar, TMINI_EVENT_HEALTH);
        break;
    default:
        frequency_reply(lidar, tmini_reply_frequency_chz(content));
        break;
    }
}

static bool is_quiet(const tmini_t *lidar)
{
    const uint32_t quiet_ms = lidar->timing->quiet_ms;
    return driver_elapsed(lidar, lidar->phase_ms, quiet_ms) &&
           driver_elapsed(lidar, lidar->received_ms, quiet_ms) && driver_is_up_to_date(lidar);
}

static void rebooted(tmini_t *lidar)
{
    if (lidar->recovering) {
        lidar->goal = GOAL_START;
        tmini_driver_hush(lidar);
    } else {
        end(lidar, PHASE_UNKNOWN, TMINI_EVENT_REBOOTED);
    }
}

/* Returns true when the command's bytes have left; a phase's time runs from then on. */
static bool has_left(tmini_t *lidar)
{
    if (lidar->unsent == 0) {
        return true;
    }
    if (!transmit(lidar) ||
        (lidar->unsent > 0 && driver_elapsed(lidar, lidar->phase_ms, lidar->timing->write_ms))) {
        attempt_failed(lidar, TMINI_ERROR_WRITE);
    } else if (lidar->unsent == 0) {
        lidar->phase_ms = lidar->now_ms;
    }
    return false;
}

/* The phase has lasted as long as it may. */
static void expire(tmini_t *lidar)
{
    switch (lidar->phase) {
    case PHASE_SCANNING:
        tmini_driver_lose(lidar);
        break;
    case PHASE_BACKING_OFF:
        tmini_driver_climb(lidar);
        break;
    case PHASE_BOOTING:
        rebooted(lidar);
        break;
    default:
        attempt_failed(lidar, TMINI_ERROR_TIMEOUT);
        break;
    }
}

void tmini_driver_keep_time(tmini_t *lidar)
{
    if (!has_left(lidar)) {
        return;
    }
    const bool hushing = lidar->phase == PHASE_HUSHING;
    if ((hushing || lidar->phase == PHASE_SETTLING) && is_quiet(lidar)) {
        if (hushing) {
            issue(lidar);
        } else {
            continue_frequency_change(lidar);
        }
    } else if (lidar->limit_ms > 0 && driver_elapsed(lidar, lidar->phase_ms, lidar->limit_ms)) {
        expire(lidar);
    } else if (lidar->phase == PHASE_SCANNING) {
        tmini_driver_watch_rotor(lidar);
    }
}

/* ---------------------------------------------------------------------------- public functions */

/* Begins a command. The bytes leave at once, as far as the port takes them. */
static void begin(tmini_t *lidar, enum goal goal)
{
    const bool is_quiet_line = driver_is_idle(lidar) && goal != GOAL_STOP;
    lidar->goal = (uint8_t)goal;
    lidar->attempts = 0;
    lidar->rung = 0;
    lidar->steps = 0;
    lidar->recovering = false;
    /* The end of an earlier command is not the end of this one. */
    lidar->pending = (uint16_t)(lidar->pending & ~END_EVENTS);
    if (is_quiet_line) {
        issue(lidar);
    } else {
        tmini_driver_hush(lidar);
    }
    (void)has_left(lidar);
}

/* Whether a command other than stop may be begun now. */
static tmini_status_t permission(const tmini_t *lidar)
{
    if (!driver_is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->recovering || lidar->phase == PHASE_SCANNING) {
        return TMINI_ERROR_STATE;
    }
    return lidar->goal == GOAL_NONE ? TMINI_OK : TMINI_ERROR_BUSY;
}

static tmini_status_t request(tmini_t *lidar, enum goal goal)
{
    const tmini_status_t status = permission(lidar);
    if (status == TMINI_OK) {
        tmini_driver_look(lidar);
        begin(lidar, goal);
    }
    return status;
}

tmini_status_t tmini_start(tmini_t *lidar)
{
    return request(lidar, GOAL_START);
}

tmini_status_t tmini_stop(tmini_t *lidar)
{
    if (!driver_is_set_up(lidar)) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (lidar->goal == GOAL_STOP) {
        return TMINI_OK; /* It is being stopped already. */
    }
    const bool aborts =
        lidar->goal != GOAL_NONE && !lidar->recovering && lidar->phase != PHASE_SCANNING;
    tmini_driver_look(lidar);
    begin(lidar, GOAL_STOP);
    if (aborts && lidar->goal == GOAL_STOP) {
        lidar->failure = TMINI_ERROR_ABORTED;
        driver_raise(lidar, TMINI_EVENT_FAILED);
    }
    return TMINI_OK;
}

tmini_status_t tmini_request_info(tmini_t *lidar)
{
    return request(lidar, GOAL_INFO);
}

tmini_status_t tmini_request_health(tmini_t *lidar)
{
    return request(lidar, GOAL_HEALTH);
}

tmini_status_t tmini_request_frequency(tmini_t *lidar)
{
    return request(lidar, GOAL_FREQUENCY);
}

tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz)
{
    if (frequency_chz < TMINI_FREQUENCY_MIN_CHZ || frequency_chz > TMINI_FREQUENCY_MAX_CHZ ||
        frequency_chz % TMINI_FREQUENCY_STEP_CHZ != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    const tmini_status_t status = request(lidar, GOAL_SET_FREQUENCY);
    if (status == TMINI_OK) {
        lidar->target_chz = frequency_chz;
    }
    return status;
}

tmini_status_t tmini_reboot(tmini_t *lidar)
{
    return request(lidar, GOAL_REBOOT);
}
