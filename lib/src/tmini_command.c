/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One command at a time: sends it when the line is quiet, awaits its reply, tries again, and
 * returns the result. The callers decide what the result means. What ends a phase, and what
 * follows, stands in four switches: on_quiet(), on_time_out(), tmini_command_reply() and
 * tmini_command_packet(); docs/phases.svg draws them. */

#include "tmini_driver.h"

/* No change between 6 and 12 Hz needs more than 14 steps (5 of 1 Hz and 9 of 0.1 Hz). A step in
 * vain counts for 16. So a lidar that obeys none is given up after four, and any change may have
 * three. A lidar that is to scan gets no more if the wish changes meanwhile: a slider must not hold
 * up its start. */
#define STEPS_MAX 64
#define STEPS_IN_VAIN 15 /* What one counts for beside itself. */
#define COARSE_STEP_CHZ 100

/* A lidar that boots answers nothing, and what is sent to it is lost (section 9.16). So the first
 * question is repeated: for longer than any unit is said to need. Steps and later questions are
 * not, because late replies to them could not be told apart. */
#define ASK_EACH_MS 250
#define ASKS_MAX 30
#define UNCHANGED_MS 2000 /* For another reply to a step, if replies have no limit. */

/* A reply outside these limits is garbage: section 1 gives 6 to 12 Hz. */
#define PLAUSIBLE_CHZ_MIN 100
#define PLAUSIBLE_CHZ_MAX 2000

/* A lidar that seems to be lost gets another chance, unless the line was seen silent for this
 * long. */
#define SILENCE_OF_LOST_MS (TMINI_DATA_TIMEOUT_MS / 2)
#define JITTER_MS 10 /* A task that sleeps until a time-out wakes up this late. */
#define LAST_CHANCE_MS 100
#define CHANCES_MAX 3

/* Begins a phase that lasts at most `timeout_ms`; 0: no limit. */
static void enter(tmini_t *lidar, tmini_phase_t phase, unsigned timeout_ms)
{
    lidar->command.phase = (uint8_t)phase;
    lidar->command.since_ms = lidar->line.now_ms;
    lidar->command.timeout_ms = (uint16_t)timeout_ms;
}

/* ------------------------------------------------------------------------------------- sending */

/* Bits of tmini_command_t.unsent beside TMINI_UNSENT. */
#define SYNC_SENT 1u   /* The first byte of a command has been sent, the second has not. */
#define NOT_OFFERED 4u /* The port has not been asked yet. */

/* send_rest() sends the bytes. If the first byte of an abandoned command has already been sent, it
 * is not sent again: it is the same in all commands. */
static void send(tmini_t *lidar, tmini_command_code_t code)
{
    tmini_command_t *const command = &lidar->command;
    command->code = (uint8_t)code;
    command->unsent |= TMINI_UNSENT | NOT_OFFERED;
}

/* Hands what is left of the command to the port. The time to take it begins when the port is asked
 * first, the time of the phase when all has been taken. */
static int send_rest(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    const uint8_t bytes[2] = {TMINI_COMMAND_SYNC, command->code};
    const unsigned before = command->unsent & SYNC_SENT;
    if ((command->unsent & NOT_OFFERED) != 0) {
        command->since_ms = lidar->line.now_ms;
    }
    const int taken =
        lidar->link.port->write(lidar->link.port_context, &bytes[before], sizeof bytes - before);
    if (taken < 0) {
        return TMINI_ERROR_WRITE;
    }
    const unsigned sent = before + (unsigned)taken;
    if (sent >= sizeof bytes) { /* More than were offered means all. */
        command->unsent = 0;
        command->since_ms = lidar->line.now_ms;
        return TMINI_UNDER_WAY;
    }
    command->unsent = (uint8_t)(TMINI_UNSENT | sent);
    return tmini_has_elapsed(lidar, command->since_ms, TMINI_WRITE_TIMEOUT_MS) ? TMINI_ERROR_WRITE
                                                                               : TMINI_UNDER_WAY;
}

/* Sends a command (the line is quiet, or it is a stop) and awaits its reply, if it has one, in
 * `phase`. */
static int send_and_await(tmini_t *lidar, uint8_t code, tmini_phase_t phase, unsigned timeout_ms)
{
    send(lidar, (tmini_command_code_t)code);
    (void)tmini_parser_await(&lidar->decoder.parser,
                             tmini_reply_header((tmini_command_code_t)code));
    enter(lidar, phase, timeout_ms);
    return TMINI_UNDER_WAY;
}

/* How long the line may take to become quiet. */
static unsigned quiet_timeout_ms(const tmini_t *lidar)
{
    return TMINI_STOP_TIMEOUT_MS + lidar->link.timing->quiet_line_ms;
}

/* Stops the lidar first, which is always permitted (section 9.10). */
static int quiesce(tmini_t *lidar)
{
    return send_and_await(lidar, TMINI_COMMAND_STOP, TMINI_PHASE_QUIESCING,
                          quiet_timeout_ms(lidar));
}

/* Asks for the frequency, unless that has been in vain too often. */
static int ask(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    if (command->asks >= ASKS_MAX) {
        command->timeouts++;
        return TMINI_ERROR_TIMEOUT;
    }
    command->asks++;
    return send_and_await(lidar, TMINI_COMMAND_GET_FREQUENCY, TMINI_PHASE_ASKING, ASK_EACH_MS);
}

/* --------------------------------------------------------------------------- how commands end */

/* No reply came in time, no start packet, or the line did not become quiet: makes another attempt,
 * unless this was the last. Without an answer to a step, or with one that may be a late copy, it is
 * unknown whether the lidar obeyed, refused, or lost its power: asks from the beginning. */
static int try_again(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    command->timeouts++;
    command->is_repeated = true;
    if (command->operation == TMINI_EVENT_FREQUENCY && !tmini_command_awaits_quiet(lidar)) {
        command->steps = (uint8_t)(command->steps + STEPS_IN_VAIN);
        command->asks = 0;
        if (command->steps >= STEPS_MAX && command->phase == TMINI_PHASE_AWAITING) {
            return TMINI_ERROR_TIMEOUT; /* Unlike a refusal this leaves the frequency unknown. */
        }
        return ask(lidar);
    }
    if (command->attempts_left == 0) {
        return TMINI_ERROR_TIMEOUT;
    }
    command->attempts_left--;
    return quiesce(lidar);
}

/* ----------------------------------------------------------------------------- frequency change */

static int32_t chz_to_go(const tmini_t *lidar)
{
    return (int32_t)lidar->command.wanted_chz - lidar->command.frequency_chz;
}

bool tmini_command_has_frequency(const tmini_t *lidar)
{
    const int32_t left = chz_to_go(lidar);
    return (left >= -TMINI_FREQUENCY_TOLERANCE_CHZ && left <= TMINI_FREQUENCY_TOLERANCE_CHZ) ||
           lidar->command.wanted_chz == 0;
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

/* The line is quiet after an answer: sends the next step, or asks whether all were obeyed. */
static int step(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    uint8_t code = TMINI_COMMAND_GET_FREQUENCY;
    if (command->steps >= STEPS_MAX) {
        return TMINI_ERROR_REPLY;
    }
    if (!tmini_command_has_frequency(lidar)) {
        command->steps++;
        code = next_step(lidar);
    }
    return send_and_await(lidar, code, TMINI_PHASE_AWAITING, lidar->link.timing->reply_timeout_ms);
}

/* A late reply to the previous step looks like the reply to a step that was refused. So another
 * reply is awaited for the rest of the time. */
static int await_another_frequency(tmini_t *lidar)
{
    tmini_parser_await_again(&lidar->decoder.parser);
    lidar->command.phase = TMINI_PHASE_UNCHANGED; /* Without a new time limit, if there is one. */
    if (lidar->command.timeout_ms == 0) {
        enter(lidar, TMINI_PHASE_UNCHANGED, UNCHANGED_MS);
    }
    return TMINI_UNDER_WAY;
}

static int take_frequency(tmini_t *lidar, uint32_t frequency_chz)
{
    tmini_command_t *const command = &lidar->command;
    const bool is_step = command->code != TMINI_COMMAND_GET_FREQUENCY;
    if (frequency_chz < PLAUSIBLE_CHZ_MIN || frequency_chz > PLAUSIBLE_CHZ_MAX) {
        tmini_command_forget_frequency(lidar);
        return TMINI_ERROR_REPLY;
    }
    if (is_step && frequency_chz == command->frequency_chz) {
        return await_another_frequency(lidar);
    }
    command->frequency_chz = (uint16_t)frequency_chz;
    if (command->operation == TMINI_EVENT_REBOOTED) {
        return TMINI_OK;
    }
    if (!command->is_repeated) {
        command->asks = 0; /* They were for a lidar that boots. */
    }
    const bool may_be_late = command->phase == TMINI_PHASE_ASKING && command->is_repeated;
    if (!is_step && !may_be_late && tmini_command_has_frequency(lidar)) {
        return TMINI_OK;
    }
    enter(lidar, TMINI_PHASE_SETTLING, quiet_timeout_ms(lidar));
    return TMINI_UNDER_WAY;
}

/* -------------------------------------------------------------------------------- keeping time */

/* The last condition: an interrupt may have stored bytes since the last look at the line. */
static bool is_quiet(const tmini_t *lidar)
{
    const uint16_t quiet_ms = lidar->link.timing->quiet_line_ms;
    return tmini_command_awaits_quiet(lidar) && lidar->line.silent_ms >= quiet_ms &&
           tmini_has_elapsed(lidar, lidar->command.since_ms, quiet_ms) &&
           tmini_ring_head(&lidar->ring) == lidar->line.received;
}

/* The line is quiet: the next command may be sent (section 2). Bytes that came before a command
 * cannot be its reply, so all are skipped, including an incomplete packet. */
static int on_quiet(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    uint8_t code = TMINI_COMMAND_GET_HEALTH; /* Unless the operation is another. */
    const bool has_answered = command->phase == TMINI_PHASE_SETTLING;
    tmini_parser_skip_all(&lidar->decoder.parser);
    switch (command->operation) {
    case TMINI_EVENT_STOPPED:
        command->is_repeated = false; /* A quiet line means idle, after any attempt. */
        return TMINI_OK;
    case TMINI_EVENT_REBOOTED:
        if (command->asks > 0) {
            return ask(lidar); /* It has been sent already. */
        }
        tmini_command_forget_frequency(lidar);
        return send_and_await(lidar, TMINI_COMMAND_REBOOT, TMINI_PHASE_REBOOTING,
                              TMINI_REBOOT_TIME_MS);
    case TMINI_EVENT_FREQUENCY:
        return has_answered ? step(lidar) : ask(lidar);
    case TMINI_EVENT_STARTED:
        code = TMINI_COMMAND_START;
        break;
    case TMINI_EVENT_INFO:
        code = TMINI_COMMAND_GET_INFO;
        break;
    default:
        break;
    }
    return send_and_await(lidar, code, TMINI_PHASE_AWAITING, lidar->link.timing->reply_timeout_ms);
}

/* No packet has come in time. If the program has paused, and not just slept until now, the lidar
 * gets another chance: DMA may have overwritten all packets, or the clock may have jumped. */
static int on_no_packet(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    const uint32_t late_ms = (uint32_t)command->timeout_ms + JITTER_MS;
    if (command->asks == CHANCES_MAX || lidar->line.silent_ms >= SILENCE_OF_LOST_MS ||
        !tmini_has_elapsed(lidar, command->since_ms, late_ms)) {
        return TMINI_ERROR_TIMEOUT;
    }
    command->asks++;
    enter(lidar, TMINI_PHASE_LAST_CHANCE, LAST_CHANCE_MS);
    return TMINI_UNDER_WAY;
}

/* The time of the phase is over. */
static int on_time_out(tmini_t *lidar)
{
    switch (lidar->command.phase) {
    case TMINI_PHASE_ASKING:
    case TMINI_PHASE_REBOOTING:
        return ask(lidar);
    case TMINI_PHASE_STANDING: /* A blocked rotor is a fault; no attempt to start it helps. */
        return TMINI_SCANS;
    case TMINI_PHASE_PAUSING:
        return TMINI_OK;
    case TMINI_PHASE_SCANNING:
    case TMINI_PHASE_LAST_CHANCE:
        return on_no_packet(lidar);
    case TMINI_PHASE_LISTENING:
        return TMINI_ERROR_TIMEOUT;
    default:
        return try_again(lidar);
    }
}

static bool is_over(const tmini_t *lidar)
{
    const tmini_command_t *const command = &lidar->command;
    return command->timeout_ms != 0 &&
           tmini_has_elapsed(lidar, command->since_ms, command->timeout_ms);
}

int tmini_command_poll(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    int result = TMINI_UNDER_WAY;
    if ((int32_t)(lidar->line.now_ms - command->since_ms) < 0) {
        command->since_ms = lidar->line.now_ms; /* The clock was set back. */
    }
    if (!tmini_command_is_sending(lidar)) {
        if (is_quiet(lidar)) {
            result = on_quiet(lidar);
        } else if (is_over(lidar)) {
            result = on_time_out(lidar);
        }
    }
    return result == TMINI_UNDER_WAY && tmini_command_is_sending(lidar) ? send_rest(lidar) : result;
}

/* How much of `whole_ms` is left. */
static uint32_t rest_ms(uint32_t whole_ms, uint32_t passed_ms)
{
    return whole_ms > passed_ms ? whole_ms - passed_ms : 0;
}

/* A quiet line is watched closely enough to see its silence. */
uint16_t tmini_command_due_ms(const tmini_t *lidar)
{
    const uint32_t quiet_ms = lidar->link.timing->quiet_line_ms;
    const uint32_t silent_ms = rest_ms(quiet_ms, lidar->line.silent_ms);
    const uint32_t since_ms = rest_ms(quiet_ms, lidar->line.now_ms - lidar->command.since_ms);
    uint32_t due_ms = silent_ms > since_ms ? silent_ms : since_ms;
    if (!tmini_command_awaits_quiet(lidar)) {
        return tmini_command_idle_ms(lidar);
    }
    due_ms = due_ms < TMINI_UNSEEN_SILENCE_MAX_MS ? due_ms : TMINI_UNSEEN_SILENCE_MAX_MS;
    return (uint16_t)(due_ms < tmini_command_left_ms(lidar) ? due_ms
                                                            : tmini_command_left_ms(lidar));
}

/* ------------------------------------------------------------------------ for the layers above */

void tmini_command_begin(tmini_t *lidar, tmini_event_t operation, uint8_t attempts)
{
    tmini_command_t *const command = &lidar->command;
    command->operation = (uint8_t)operation;
    command->attempts_left = (uint8_t)(attempts > 0 ? attempts - 1 : 0);
    command->is_repeated = false;
    command->steps = 0;
    command->asks = 0;
    if (command->phase == TMINI_PHASE_IDLE && operation != TMINI_EVENT_STOPPED) {
        (void)on_quiet(lidar);
    } else {
        (void)quiesce(lidar);
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

/* A packet while a lidar that should be idle is asked: it scans, so it has not received its stop,
 * or a layer below has held the packet back. It is stopped (again): while it scans, nothing else
 * may be sent (section 2). */
static tmini_packet_meaning_t on_packet_while_idle(tmini_t *lidar)
{
    tmini_command_t *const command = &lidar->command;
    if (command->asks < ASKS_MAX) { /* A lidar that receives no stop goes on scanning. */
        command->asks++;
        command->is_repeated = true;
        (void)quiesce(lidar);
    }
    return TMINI_PACKET_IGNORED;
}

/* A lost lidar that sends ranges gets time for a start packet. */
static tmini_packet_meaning_t on_first_packet(tmini_t *lidar, tmini_sign_t sign)
{
    const uint8_t phase = lidar->command.phase;
    if (sign == TMINI_SIGN_SCANS) {
        return TMINI_PACKET_FIRST;
    }
    (void)tmini_parser_await(&lidar->decoder.parser, NULL); /* The reply was lost. */
    if (sign == TMINI_SIGN_TURNS && phase != TMINI_PHASE_TURNING) {
        enter(lidar, TMINI_PHASE_TURNING, TMINI_SPIN_UP_TIMEOUT_MS);
    } else if (phase < TMINI_PHASE_TURNING) {
        enter(lidar, TMINI_PHASE_STANDING, TMINI_SPIN_UP_TIMEOUT_MS);
    }
    return TMINI_PACKET_IGNORED;
}

tmini_packet_meaning_t tmini_command_packet(tmini_t *lidar, tmini_sign_t sign)
{
    switch (lidar->command.phase) {
    case TMINI_PHASE_WATCHING:
    case TMINI_PHASE_IDLE: /* At once, it may be of the tail, or held by a layer below. */
        return tmini_has_elapsed(lidar, lidar->command.since_ms, TMINI_BACK_OFF_MS)
                   ? TMINI_PACKET_UNWANTED
                   : TMINI_PACKET_IGNORED;
    case TMINI_PHASE_ASKING:
    case TMINI_PHASE_UNCHANGED:
    case TMINI_PHASE_AWAITING:
    case TMINI_PHASE_SPINNING_UP:
    case TMINI_PHASE_TURNING:
    case TMINI_PHASE_STANDING:
        return lidar->command.operation == TMINI_EVENT_STARTED ? on_first_packet(lidar, sign)
                                                               : on_packet_while_idle(lidar);
    case TMINI_PHASE_PAUSING:
    case TMINI_PHASE_LISTENING:
        return sign == TMINI_SIGN_SCANS ? TMINI_PACKET_FIRST : TMINI_PACKET_IGNORED;
    default: /* Nothing is known, it has been stopped just now, or it reboots. */
        return TMINI_PACKET_IGNORED;
    }
}

void tmini_command_wait(tmini_t *lidar, tmini_phase_t phase, uint16_t wait_ms)
{
    lidar->command.operation = TMINI_EVENT_NONE;
    lidar->command.asks = 0;
    enter(lidar, phase, wait_ms);
}

void tmini_command_end(tmini_t *lidar, int result)
{
    tmini_command_t *const command = &lidar->command;
    (void)tmini_parser_await(&lidar->decoder.parser, NULL);
    command->unsent &= SYNC_SENT;
    if (command->operation == TMINI_EVENT_FREQUENCY && result != TMINI_OK &&
        result != TMINI_ERROR_REPLY) { /* That is an answer: it has refused a step. */
        tmini_command_forget_frequency(lidar);
    }
    tmini_phase_t phase = TMINI_PHASE_WATCHING;
    if (command->operation < TMINI_EVENT_STOPPED) { /* The lidar may be scanning. */
        phase = TMINI_PHASE_NONE;
    } else if (result == TMINI_OK && !command->is_repeated &&
               tmini_ring_head(&lidar->ring) == tmini_position(lidar)) {
        phase = TMINI_PHASE_IDLE;
    }
    enter(lidar, phase, 0);
}
