/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One command at a time: sends it when the line is quiet, awaits its reply, tries again, and
 * returns the result. The callers decide what the result means. */

#include "tmini_driver.h"

/* More frequency steps than any change needs (6 of 1 Hz and 9 of 0.1 Hz). */
#define STEPS_MAX 20
#define COARSE_STEP_CHZ 100

/* A reply outside these limits is garbage: section 1 gives 6 to 12 Hz. */
#define PLAUSIBLE_CHZ_MIN 100
#define PLAUSIBLE_CHZ_MAX 2000

/* A poll that comes this much too late to see that the lidar is lost gives it another chance. */
#define LATE_POLL_MS 50
#define LAST_CHANCE_MS 100

static const uint8_t codes[] = {
    [TMINI_EVENT_STARTED] = TMINI_COMMAND_START,
    [TMINI_EVENT_STOPPED] = TMINI_COMMAND_STOP,
    [TMINI_EVENT_INFO] = TMINI_COMMAND_GET_INFO,
    [TMINI_EVENT_HEALTH] = TMINI_COMMAND_GET_HEALTH,
    [TMINI_EVENT_FREQUENCY] = TMINI_COMMAND_GET_FREQUENCY,
    [TMINI_EVENT_REBOOTED] = TMINI_COMMAND_REBOOT,
};

/* Begins a phase that lasts at most `timeout_ms`; 0: no limit. */
static void enter(tmini_t *lidar, tmini_phase_t phase, uint16_t timeout_ms)
{
    lidar->command.phase = (uint8_t)phase;
    lidar->command.since_ms = lidar->line.now_ms;
    lidar->command.timeout_ms = timeout_ms;
}

/* ------------------------------------------------------------------------------------- sending */

/* transmit() sends the bytes. If the first byte of an abandoned command has already been sent, it
 * is not sent again: it is the same in all commands. */
static void send(tmini_t *lidar, tmini_command_code_t code)
{
    lidar->command.code = (uint8_t)code;
    lidar->command.unsent = lidar->command.sync_sent ? 1 : 2;
}

/* Hands what is left of the command to the port. Returns false if the port reports a failure. */
static bool transmit(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    const uint8_t bytes[2] = {TMINI_COMMAND_SYNC, command->code};
    const uint8_t unsent = command->unsent;
    const int taken = lidar->link.port->write(lidar->link.port_context, &bytes[2 - unsent], unsent);
    if (taken < 0) {
        return false;
    }
    /* If a port reports more bytes than it was given, it has taken all. */
    command->unsent = (uint8_t)(taken < unsent ? unsent - taken : 0);
    command->sync_sent = command->unsent == 1;
    return true;
}

/* Waits for a quiet line; if it does not become quiet in time, the attempt has failed. */
static void await_quiet(tmini_t *lidar)
{
    enter(lidar, TMINI_PHASE_QUIESCING, TMINI_STOP_TIMEOUT_MS);
}

/* Stops the lidar first, which is always permitted (section 9.10). */
TMINI_NOINLINE static void quiesce(tmini_t *lidar)
{
    (void)tmini_parser_await(&lidar->decoder.parser, NULL);
    send(lidar, TMINI_COMMAND_STOP);
    await_quiet(lidar);
}

/* Sends a command (the line is quiet) and awaits its reply, if it has one. */
static void request(tmini_t *lidar, tmini_command_code_t code)
{
    tmini_reply_header_t reply;
    send(lidar, code);
    if (tmini_reply_header(code, &reply)) {
        (void)tmini_parser_await(&lidar->decoder.parser, &reply);
        enter(lidar, TMINI_PHASE_AWAITING_REPLY, lidar->link.timing->reply_timeout_ms);
    } else {
        tmini_command_forget_frequency(lidar);
        enter(lidar, TMINI_PHASE_WAITING, TMINI_REBOOT_TIME_MS);
    }
}

/* --------------------------------------------------------------------------- how commands end */

/* With recovery the ladder repeats attempts to start, so each of its commands is tried once. */
static uint8_t attempts_max(const tmini_t *lidar)
{
    const bool is_repeated = lidar->state >= TMINI_STATE_STARTING && !lidar->is_recovery_off;
    return is_repeated ? 1 : lidar->link.timing->max_attempts;
}

/* A phase has taken too long: makes another attempt, unless this was the last. */
static int time_out(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    command->timeouts++;
    if (command->attempts < attempts_max(lidar)) {
        command->attempts++;
        quiesce(lidar);
        return TMINI_UNDER_WAY;
    }
    return command->phase == TMINI_PHASE_AWAITING_STEP ? TMINI_ERROR_REPLY : TMINI_ERROR_TIMEOUT;
}

/* ----------------------------------------------------------------------------- frequency change */

static int32_t chz_to_go(const tmini_t *lidar)
{
    return (int32_t)lidar->command.wanted_chz - lidar->command.frequency_chz;
}

bool tmini_command_has_frequency(const tmini_t *lidar)
{
    const int32_t left = chz_to_go(lidar);
    return lidar->command.wanted_chz == 0 ||
           (left >= -TMINI_FREQUENCY_TOLERANCE_CHZ && left <= TMINI_FREQUENCY_TOLERANCE_CHZ);
}

/* Overshoots by less than the finest step, so the frequency never leaves the permitted range. */
static uint8_t next_step(const tmini_t *lidar)
{
    const int32_t left = chz_to_go(lidar);
    if (left < 0) {
        return left > -COARSE_STEP_CHZ ? TMINI_COMMAND_SLOWER_TENTH : TMINI_COMMAND_SLOWER_ONE;
    }
    return left < COARSE_STEP_CHZ ? TMINI_COMMAND_FASTER_TENTH : TMINI_COMMAND_FASTER_ONE;
}

/* A late reply to the previous step looks like the reply to a step that was refused. So another
 * reply is awaited for the rest of the time. */
static int await_another_frequency(tmini_t *lidar)
{
    tmini_parser_await_again(&lidar->decoder.parser);
    lidar->command.phase = TMINI_PHASE_AWAITING_STEP; /* Without a new time limit. */
    return TMINI_UNDER_WAY;
}

static int take_frequency(tmini_t *lidar, uint32_t frequency_chz)
{
    tmini_command_t *const command = &lidar->command;
    const bool is_step = command->code != TMINI_COMMAND_GET_FREQUENCY;
    if (frequency_chz < PLAUSIBLE_CHZ_MIN || frequency_chz > PLAUSIBLE_CHZ_MAX) {
        return TMINI_ERROR_REPLY;
    }
    if (is_step && frequency_chz == command->frequency_chz) {
        return await_another_frequency(lidar);
    }
    command->frequency_chz = (uint16_t)frequency_chz;
    if (!is_step && tmini_command_has_frequency(lidar)) {
        return TMINI_OK;
    }
    await_quiet(lidar);
    return TMINI_UNDER_WAY;
}

/* -------------------------------------------------------------------------------- keeping time */

/* The last condition: an interrupt may have stored bytes since the last look at the line. */
static bool is_quiet(const tmini_t *lidar)
{
    const uint16_t quiet_ms = lidar->link.timing->quiet_line_ms;
    return lidar->line.silent_ms >= quiet_ms &&
           tmini_has_elapsed(lidar, lidar->command.since_ms, quiet_ms) &&
           tmini_ring_head(&lidar->ring) == lidar->line.received;
}

/* The line is quiet: the next command may be sent (section 2). Bytes that came before a command
 * cannot be its reply, so all are skipped, including an incomplete packet. After a stop the
 * operation's own command is next. To change the frequency, the driver asks for it, sends the
 * steps, and asks again. */
static int proceed(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    uint8_t next = codes[command->operation];
    tmini_parser_skip_all(&lidar->decoder.parser);
    if (next == TMINI_COMMAND_STOP) {
        command->attempts = 1; /* A quiet line means idle, after any attempt. */
        return TMINI_OK;
    }
    if (command->code != TMINI_COMMAND_STOP && !tmini_command_has_frequency(lidar)) {
        if (command->steps == STEPS_MAX) {
            return TMINI_ERROR_REPLY;
        }
        command->steps++;
        next = next_step(lidar);
    }
    request(lidar, (tmini_command_code_t)next);
    return TMINI_UNDER_WAY;
}

/* Sends the command's bytes; the phase's time begins when all have been taken. */
static int send_rest(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    if (!transmit(lidar) || (command->unsent > 0 &&
                             tmini_has_elapsed(lidar, command->since_ms, TMINI_WRITE_TIMEOUT_MS))) {
        return TMINI_ERROR_WRITE;
    }
    if (command->unsent == 0) {
        command->since_ms = lidar->line.now_ms;
    }
    return TMINI_UNDER_WAY;
}

/* True if this poll comes late to see that no packet has come: DMA may have overwritten all packets
 * in a pause of the program, or the clock may have jumped. */
static bool is_late_to_lose(const tmini_t *lidar)
{
    return lidar->state == TMINI_STATE_SCANNING &&
           lidar->command.timeout_ms == TMINI_DATA_TIMEOUT_MS &&
           tmini_has_elapsed(lidar, lidar->command.since_ms, TMINI_DATA_TIMEOUT_MS + LATE_POLL_MS);
}

/* The time of the phase is over. With listen_only this means that no packet has come. In
 * TMINI_PHASE_NONE no command ends, but from now on packets mean unwanted scanning. */
static int end_phase(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    if (command->phase == TMINI_PHASE_WAITING) {
        if (is_late_to_lose(lidar)) {
            enter(lidar, TMINI_PHASE_WAITING, LAST_CHANCE_MS);
            return TMINI_UNDER_WAY;
        }
        return lidar->is_listen_only ? TMINI_ERROR_TIMEOUT : TMINI_OK;
    }
    if (command->phase == TMINI_PHASE_NONE) {
        command->phase = TMINI_PHASE_IDLE;
        command->timeout_ms = 0;
        return TMINI_UNDER_WAY;
    }
    return time_out(lidar);
}

int tmini_command_poll(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    if ((int32_t)(lidar->line.now_ms - command->since_ms) < 0) {
        command->since_ms = lidar->line.now_ms; /* The clock was set back. */
    }
    if (command->unsent > 0) {
        return send_rest(lidar);
    }
    if (command->phase == TMINI_PHASE_QUIESCING && is_quiet(lidar)) {
        return proceed(lidar);
    }
    if (command->timeout_ms == 0 ||
        !tmini_has_elapsed(lidar, command->since_ms, command->timeout_ms)) {
        return TMINI_UNDER_WAY;
    }
    return end_phase(lidar);
}

uint16_t tmini_command_idle_ms(const tmini_t *lidar)
{
    const tmini_command_t *const command = &lidar->command;
    if (command->phase == TMINI_PHASE_QUIESCING) {
        return 0;
    }
    return (uint16_t)(command->timeout_ms - (lidar->line.now_ms - command->since_ms));
}

/* ------------------------------------------------------------------------ for the layers above */

void tmini_command_begin(tmini_t *lidar, tmini_event_t operation, bool is_idle)
{
    tmini_command_t *const command = &lidar->command;
    command->operation = (uint8_t)operation;
    command->attempts = 1;
    command->steps = 0;
    quiesce(lidar);
    if (is_idle) {
        (void)proceed(lidar);
    }
}

int tmini_command_reply(tmini_t *lidar, const uint8_t *content)
{
    switch (lidar->command.code) {
    case TMINI_COMMAND_START:
        enter(lidar, TMINI_PHASE_SPINNING_UP, TMINI_SPIN_UP_TIMEOUT_MS);
        return TMINI_UNDER_WAY;
    case TMINI_COMMAND_GET_INFO:
        tmini_reply_info(content, &lidar->info);
        return TMINI_OK;
    case TMINI_COMMAND_GET_HEALTH:
        tmini_reply_health(content, &lidar->health);
        return TMINI_OK;
    default:
        return take_frequency(lidar, tmini_reply_frequency_chz(content));
    }
}

void tmini_command_wait(tmini_t *lidar, uint16_t wait_ms)
{
    lidar->command.operation = 0;
    enter(lidar, TMINI_PHASE_WAITING, wait_ms);
}

bool tmini_command_end(tmini_t *lidar, int result)
{
    tmini_command_t *const command = &lidar->command;
    (void)tmini_parser_await(&lidar->decoder.parser, NULL);
    command->unsent = 0;
    if (result != TMINI_OK) { /* Packets are ignored; after a stop only for this time. */
        const bool was_stopped = command->operation >= TMINI_EVENT_STOPPED;
        enter(lidar, TMINI_PHASE_NONE, was_stopped ? TMINI_BACK_OFF_MS : 0);
        return false;
    }
    const bool has_waited = command->phase == TMINI_PHASE_WAITING;
    enter(lidar, TMINI_PHASE_IDLE, 0);
    return !has_waited && command->attempts == 1;
}
