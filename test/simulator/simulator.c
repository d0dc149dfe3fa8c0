/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Modes, commands, replies and time. sim_rotor.c turns and measures, sim_line.c times the bytes. */

#include "simulator.h"

#include "sim_rotor.h"

#include <string.h>

sim_config_t sim_default_config(void)
{
    return (sim_config_t){
        .seed = 1,
        .ct_information = true,
        .frequency_chz = 600,
        .min_frequency_chz = 500,
        .max_frequency_chz = 1200,
        .reply_latency_ms = 3,
        .stop_tail_ms = 60,
        .first_packet_ms = 200,
        .spin_up_ms = 1000,
        .spin_up_percent = 40,
        .boot_ms = 2500,
        .motor_percent = 100,
        .wobble_permille = 5,
        .angle_jitter_q6 = 3,
        .noise_mm = 8,
        .invalid_permille = 3,
        .flagged_permille = 5,
        .lone_packet_permille = 2,
        .samples_per_packet = 40,
        .sample_size = 3,
        .blocked_sends_starts = true,
        .information = {.model = 151,
                        .firmware_major = 1,
                        .firmware_minor = 2,
                        .hardware = 1,
                        .serial = {2, 0, 2, 6, 0, 3, 1, 7, 0, 0, 0, 1, 2, 3, 4, 5}},
        .user_major = 1,
    };
}

static uint64_t ms(uint32_t milliseconds)
{
    return (uint64_t)milliseconds * 1000u;
}

static void set_mode(sim_t *sim, sim_mode_t mode, uint64_t due_us)
{
    const sim_mode_t before = sim->mode;
    sim->mode = mode;
    sim->mode_due_us = due_us;
    if (mode != before && sim->observer.on_mode != NULL) {
        sim->observer.on_mode(sim->observer.context, before, mode, sim->now_us);
    }
}

void sim_init(sim_t *sim, const sim_config_t *config)
{
    memset(sim, 0, sizeof *sim);
    sim->config = *config;
    sim->mode = SIM_IDLE;
    sim->mode_due_us = SIM_NEVER;
    sim->power_us = SIM_NEVER;
    sim->frequency_chz = config->frequency_chz;
    random_seed(&sim->random, config->seed);
    sim_rotor_stop(sim);
    sim_scene_build(&sim->scene);
}

void sim_observe(sim_t *sim, const sim_observer_t *observer)
{
    sim->observer = *observer;
}

/* ---- Trouble ---- */

static void reset(sim_t *sim, sim_mode_t mode, uint64_t due_us);
static void reboot(sim_t *sim);

static void sound_from(sim_t *sim, uint64_t at_us)
{
    sim->sound_us = at_us > sim->sound_us ? at_us : sim->sound_us;
}

static void befall(sim_t *sim, sim_trouble_t trouble, uint32_t for_ms)
{
    const uint64_t end_us = sim->now_us + ms(for_ms);
    switch (trouble) {
    case SIM_POWER_CUT:
        reset(sim, SIM_OFF, SIM_NEVER);
        sim->power_us = end_us;
        sound_from(sim, end_us + ms(sim->config.boot_ms));
        return;
    case SIM_DEAF:
        sim->deaf_until_us = end_us;
        break;
    case SIM_SILENT:
        sim->silent_until_us = end_us;
        break;
    case SIM_REBOOTS:
        reboot(sim);
        sound_from(sim, sim->now_us + ms(sim->config.boot_ms));
        return;
    case SIM_NO_STARTS:
        sim->no_starts = true;
        break;
    case SIM_NO_SCANS:
        sim->no_scans = true;
        break;
    default:
        break;
    }
    sound_from(sim, end_us);
}

sim_trouble_t sim_event(sim_t *sim, sim_event_t event, uint32_t *for_ms)
{
    sim_trouble_t trouble = SIM_SOUND;
    *for_ms = 0;
    if (sim->observer.on_event != NULL) {
        trouble = sim->observer.on_event(sim->observer.context, event, sim->now_us, for_ms);
    }
    if (trouble != SIM_SOUND) {
        befall(sim, trouble, *for_ms);
    }
    return trouble;
}

bool sim_is_silent(const sim_t *sim)
{
    return sim->now_us < sim->silent_until_us;
}

/* ---- Replies ---- */

/* When the reply to a command that arrives now is due: never before an earlier reply. */
static uint64_t reply_due_us(sim_t *sim)
{
    uint64_t due = sim->now_us + ms(sim->config.reply_latency_ms) + ms(sim->extra_latency_ms);
    if (sim->reply_count > 0u) {
        const uint32_t last = (sim->first_reply + sim->reply_count - 1u) % SIM_REPLIES;
        due = sim->replies[last].due_us > due ? sim->replies[last].due_us : due;
    }
    sim->extra_latency_ms = 0;
    return due;
}

/* Returns when the reply is due, even if it is lost. */
static uint64_t answer(sim_t *sim, const uint8_t *bytes, size_t length)
{
    const uint64_t due = reply_due_us(sim);
    sim_reply_t *reply = &sim->replies[(sim->first_reply + sim->reply_count) % SIM_REPLIES];
    if (sim->lose_reply || sim->config.never_answers || sim->reply_count == SIM_REPLIES) {
        sim->lose_reply = false;
        sim->counts.lost_replies++;
        return due;
    }
    reply->due_us = due;
    reply->is_late = false;
    reply->length = (uint8_t)length;
    memcpy(reply->bytes, bytes, length);
    sim->reply_count++;
    return due;
}

static uint64_t next_reply_us(const sim_t *sim)
{
    return sim->reply_count == 0u ? SIM_NEVER : sim->replies[sim->first_reply].due_us;
}

/* While scanning, the reply comes between two packets, as on the real device (section 2). */
static void put_reply(sim_t *sim, const sim_reply_t *reply)
{
    sim_frame_t *frame = sim_is_silent(sim) ? NULL : sim_line_open(&sim->line);
    if (frame != NULL) {
        frame->length = reply->length;
        memcpy(frame->bytes, reply->bytes, reply->length);
        sim_line_send(&sim->line, sim->now_us);
    }
}

/* Later replies keep their order: they wait for a late one. */
static void delay_replies(sim_t *sim, uint64_t due_us)
{
    for (uint32_t i = 0; i < sim->reply_count; i++) {
        sim_reply_t *reply = &sim->replies[(sim->first_reply + i) % SIM_REPLIES];
        reply->due_us = reply->due_us > due_us ? reply->due_us : due_us;
    }
}

static void send_reply(sim_t *sim)
{
    sim_reply_t *reply = &sim->replies[sim->first_reply];
    uint32_t late_ms = 0;
    const sim_trouble_t trouble =
        reply->is_late ? SIM_SOUND : sim_event(sim, SIM_EVENT_REPLY, &late_ms);
    if (sim->reply_count == 0u) {
        return; /* The trouble was a loss of power. */
    }
    if (trouble == SIM_LATE) {
        reply->is_late = true;
        delay_replies(sim, sim->now_us + ms(late_ms));
        return;
    }
    sim->first_reply = (sim->first_reply + 1u) % SIM_REPLIES;
    sim->reply_count--;
    for (unsigned times = trouble == SIM_LOST      ? 0
                          : trouble == SIM_DOUBLED ? 2
                                                   : 1;
         times > 0; times--) {
        put_reply(sim, reply);
    }
}

/* ---- Commands ---- */

static bool is_fatal(const sim_t *sim)
{
    return (sim_health(sim) & sim->config.fatal_health) != 0u;
}

/* Also valid while scanning, and in the tail after a stop, where the stream then goes on. */
static void start(sim_t *sim)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    const uint64_t due = answer(sim, reply, encode_scan_reply(reply));
    if (is_fatal(sim)) {
        set_mode(sim, SIM_FAULT, SIM_NEVER);
        return;
    }
    if (sim->no_scans) {
        return;
    }
    if (sim->mode != SIM_SCANNING && sim->mode != SIM_STOPPING) {
        sim_rotor_start(sim, due + ms(sim->config.first_packet_ms));
    }
    set_mode(sim, SIM_SCANNING, SIM_NEVER);
}

void sim_go_idle(sim_t *sim)
{
    sim_rotor_stop(sim);
    set_mode(sim, SIM_IDLE, SIM_NEVER);
}

static void stop(sim_t *sim)
{
    if (sim->mode == SIM_SCANNING && sim_rotor_measures(sim)) {
        set_mode(sim, SIM_STOPPING, sim->now_us + ms(sim->config.stop_tail_ms));
    } else if (sim->mode == SIM_SCANNING || sim->mode == SIM_FAULT) {
        sim_go_idle(sim);
    }
}

static void answer_information(sim_t *sim)
{
    encode_information_t information = sim->config.information;
    uint8_t reply[ENCODE_REPLY_MAX];
    if (sim->config.firmware_major_first) {
        information.firmware_major = sim->config.information.firmware_minor;
        information.firmware_minor = sim->config.information.firmware_major;
    }
    for (size_t i = 0; i < sizeof information.serial && sim->config.ascii_serial; i++) {
        information.serial[i] = (uint8_t)(information.serial[i] + '0');
    }
    answer(sim, reply, encode_information_reply(reply, &information));
}

/* The values of the error code are undisclosed (section 4): it repeats the status. */
static void answer_health(sim_t *sim)
{
    const uint8_t status = sim_health(sim);
    uint8_t reply[ENCODE_REPLY_MAX];
    answer(sim, reply, encode_health_reply(reply, status, status));
}

/* Undocumented: type 0x10, four zero bytes of unknown meaning. */
static void answer_undocumented_98(sim_t *sim)
{
    static const uint8_t content[4] = {0, 0, 0, 0};
    uint8_t reply[ENCODE_REPLY_MAX];
    answer(sim, reply, encode_reply(reply, ENCODE_MODE_SINGLE, 0x10, content, sizeof content));
}

static void step_frequency(sim_t *sim, int step_chz)
{
    const int frequency = (int)sim->frequency_chz + step_chz;
    uint8_t reply[ENCODE_REPLY_MAX];
    if (!sim->config.refuses_steps && frequency >= (int)sim->config.min_frequency_chz &&
        frequency <= (int)sim->config.max_frequency_chz) {
        sim->frequency_chz = (uint16_t)frequency;
    }
    answer(sim, reply, encode_frequency_reply(reply, sim->frequency_chz));
}

static void reset(sim_t *sim, sim_mode_t mode, uint64_t due_us)
{
    sim_line_cut(&sim->line, sim->now_us);
    sim_rotor_stop(sim);
    sim->rotor.data_fault = false;
    sim->reply_count = 0;
    sim->half_command = false;
    sim->late.count = 0;
    if (sim->no_starts || sim->no_scans) {
        sound_from(sim, sim->now_us + ms(sim->config.boot_ms));
    }
    sim->no_starts = false;
    sim->no_scans = false;
    sim->power_us = SIM_NEVER;
    if (!sim->config.keeps_frequency) {
        sim->frequency_chz = sim->config.frequency_chz;
    }
    set_mode(sim, mode, due_us);
}

static void reboot(sim_t *sim)
{
    reset(sim, SIM_BOOTING, sim->now_us + ms(sim->config.boot_ms));
}

static bool obey(sim_t *sim, uint8_t code)
{
    static const struct {
        uint8_t code;
        int step_chz;
        void (*obey)(sim_t *sim); /* NULL: a step of the frequency. */
    } commands[] = {
        {SIM_COMMAND_FREQUENCY_UP_TENTH, 10, NULL},
        {SIM_COMMAND_FREQUENCY_DOWN_TENTH, -10, NULL},
        {SIM_COMMAND_FREQUENCY_UP, 100, NULL},
        {SIM_COMMAND_FREQUENCY_DOWN, -100, NULL},
        {SIM_COMMAND_GET_FREQUENCY, 0, NULL},
        {SIM_COMMAND_REBOOT, 0, reboot},
        {SIM_COMMAND_START, 0, start},
        {SIM_COMMAND_STOP, 0, stop},
        {SIM_COMMAND_INFORMATION, 0, answer_information},
        {SIM_COMMAND_HEALTH, 0, answer_health},
        {SIM_COMMAND_UNDOCUMENTED_98, 0, answer_undocumented_98},
    };
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (commands[i].code == code && commands[i].obey != NULL) {
            commands[i].obey(sim);
            return true;
        }
        if (commands[i].code == code) {
            step_frequency(sim, commands[i].step_chz);
            return true;
        }
    }
    return false;
}

/* The manual's rule (section 2): while scanning, only stop is allowed. That a silent lidar scans
 * nobody can know. */
static void count_command(sim_t *sim, uint8_t code, sim_mode_t mode)
{
    sim->counts.commands++;
    if (code != SIM_COMMAND_STOP) {
        const bool is_seen = mode == SIM_SCANNING && !sim_is_silent(sim);
        sim->counts.commands_while_scanning += is_seen ? 1u : 0u;
        sim->counts.commands_in_tail += mode == SIM_STOPPING ? 1u : 0u;
    }
}

static void execute(sim_t *sim, uint8_t code)
{
    const sim_mode_t mode = sim->mode;
    if (sim->observer.on_command != NULL) {
        sim->observer.on_command(sim->observer.context, code, sim->now_us);
    }
    if (obey(sim, code)) {
        count_command(sim, code, mode);
    } else {
        sim->counts.unknown_commands++;
    }
}

static void delay(sim_late_t *late, uint8_t code, uint64_t due_us)
{
    if (late->count < SIM_LATE_COMMANDS) {
        late->codes[late->count] = code;
        late->due_us[late->count] = due_us;
        late->count++;
    }
}

static void execute_late(sim_t *sim)
{
    sim_late_t *late = &sim->late;
    const uint8_t code = late->codes[0];
    late->count--;
    memmove(late->codes, late->codes + 1, late->count * sizeof late->codes[0]);
    memmove(late->due_us, late->due_us + 1, late->count * sizeof late->due_us[0]);
    execute(sim, code);
}

/* A command that arrives after a late one waits for it. */
static void receive_command(sim_t *sim, uint8_t code)
{
    const uint32_t before = sim->late.count;
    uint64_t due_us = before > 0u ? sim->late.due_us[before - 1u] : sim->now_us;
    uint32_t late_ms;
    const sim_trouble_t trouble = sim_event(sim, SIM_EVENT_COMMAND, &late_ms);
    const bool is_heard = trouble == SIM_SOUND || trouble == SIM_LATE || trouble == SIM_DOUBLED ||
                          trouble == SIM_SILENT || trouble == SIM_NO_STARTS;
    if (trouble == SIM_LATE) {
        due_us += ms(late_ms);
        sound_from(sim, due_us);
    }
    for (unsigned times = !is_heard ? 0 : trouble == SIM_DOUBLED ? 2 : 1; times > 0; times--) {
        if (due_us > sim->now_us) {
            delay(&sim->late, code, due_us);
        } else {
            execute(sim, code);
        }
    }
}

static bool listens(const sim_t *sim)
{
    return sim->now_us >= sim->deaf_until_us && sim->mode != SIM_OFF && sim->mode != SIM_BOOTING;
}

static void receive_byte(sim_t *sim, uint8_t byte)
{
    if (!listens(sim)) {
        return;
    }
    if (byte == 0xA5) {
        sim->half_command = true;
    } else if (sim->half_command) {
        sim->half_command = false;
        receive_command(sim, byte);
    }
}

/* ---- Time ---- */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t next_event_us(const sim_t *sim)
{
    const uint64_t late_us = sim->late.count > 0u ? sim->late.due_us[0] : SIM_NEVER;
    const uint64_t outer_us = earlier(sim->power_us, late_us);
    return earlier(outer_us,
                   earlier(sim->mode_due_us, earlier(next_reply_us(sim), sim->rotor.due_us)));
}

static void boot(sim_t *sim)
{
    sim->power_us = SIM_NEVER;
    set_mode(sim, SIM_BOOTING, sim->now_us + ms(sim->config.boot_ms));
}

/* Processes the next event, unless it is after `until_us`. */
static bool step(sim_t *sim, uint64_t until_us)
{
    const uint64_t event_us = next_event_us(sim);
    if (event_us > until_us) {
        return false;
    }
    sim->now_us = event_us;
    if (event_us == sim->power_us) {
        boot(sim);
    } else if (sim->late.count > 0u && event_us == sim->late.due_us[0]) {
        execute_late(sim);
    } else if (event_us == sim->mode_due_us) {
        sim_go_idle(sim);
    } else if (event_us == next_reply_us(sim)) {
        send_reply(sim);
    } else {
        sim_rotor_packet(sim);
    }
    return true;
}

static void advance(sim_t *sim, uint64_t now_us)
{
    while (step(sim, now_us)) {
    }
    sim->now_us = now_us > sim->now_us ? now_us : sim->now_us;
}

void sim_receive(sim_t *sim, const uint8_t *bytes, size_t count, uint64_t now_us)
{
    advance(sim, now_us);
    for (size_t i = 0; i < count; i++) {
        receive_byte(sim, bytes[i]);
    }
}

static void note_sent(sim_t *sim, const sim_run_t *run)
{
    const sim_packet_t *const packet = run->packet;
    if (!run->completes) {
        return;
    }
    if (packet == NULL) {
        sim->counts.replies++;
        return;
    }
    sim->counts.packets++;
    sim->counts.start_packets += packet->starts_revolution ? 1u : 0u;
    sim->counts.samples += packet->bytes[3];
    if (sim->observer.on_packet != NULL) {
        sim->observer.on_packet(sim->observer.context, packet);
    }
}

/* Makes one frame at a time, when the line is free for it, so any jump of time is handled. */
static bool take_run(sim_t *sim, uint64_t now_us, size_t max, sim_run_t *run)
{
    while (sim_line_front(&sim->line) == NULL && step(sim, now_us)) {
    }
    if (!sim_line_take(&sim->line, now_us, max, run)) {
        advance(sim, now_us);
        return false;
    }
    note_sent(sim, run);
    return true;
}

bool sim_next_run(sim_t *sim, uint64_t now_us, sim_run_t *run)
{
    return take_run(sim, now_us, SIM_FRAME_MAX, run);
}

size_t sim_transmit(sim_t *sim, uint64_t now_us, uint8_t *out, size_t max)
{
    size_t count = 0;
    sim_run_t run;
    while (count < max && take_run(sim, now_us, max - count, &run)) {
        memcpy(out + count, run.bytes, run.length);
        count += run.length;
    }
    return count;
}

uint64_t sim_next_us(sim_t *sim)
{
    const sim_frame_t *frame = sim_line_front(&sim->line);
    const uint64_t event_us = next_event_us(sim);
    if (frame == NULL) {
        return event_us;
    }
    return earlier(event_us, sim_byte_us(frame->start_us, frame->taken));
}

void sim_power(sim_t *sim, bool on, uint64_t now_us)
{
    advance(sim, now_us);
    if (!on) {
        reset(sim, SIM_OFF, SIM_NEVER);
    } else if (sim->mode == SIM_OFF) {
        boot(sim);
    }
}

/* ---- What happens to the device ---- */

void sim_befall(sim_t *sim, sim_trouble_t trouble, uint32_t for_ms, uint64_t now_us)
{
    advance(sim, now_us);
    if (trouble == SIM_LOST) {
        sim->lose_reply = true;
    } else if (trouble == SIM_LATE) {
        sim->extra_latency_ms = for_ms;
    } else {
        befall(sim, trouble, for_ms);
    }
}

uint64_t sim_sound_us(const sim_t *sim)
{
    return sim->no_starts || sim->no_scans ? SIM_NEVER : sim->sound_us;
}

bool sim_expects_event(const sim_t *sim)
{
    return sim->reply_count > 0u ||
           (sim->rotor.due_us != SIM_NEVER && sim->rotor.noted < SIM_STARTS_NOTED);
}

/* Section 2: the device itself switches its ranging unit off. */
static void shut_off_if_fatal(sim_t *sim)
{
    if (is_fatal(sim) && (sim->mode == SIM_SCANNING || sim->mode == SIM_STOPPING)) {
        sim_rotor_stop(sim);
        set_mode(sim, SIM_FAULT, SIM_NEVER);
    }
}

void sim_set_health(sim_t *sim, uint8_t bits)
{
    sim->health = bits;
    shut_off_if_fatal(sim);
}

void sim_block_rotor(sim_t *sim, bool blocked)
{
    sim->rotor_blocked = blocked;
    if (!blocked) {
        sim_rotor_release(sim);
    }
    shut_off_if_fatal(sim);
}

void sim_cover_window(sim_t *sim, bool covered)
{
    sim->window_covered = covered;
}

void sim_place_obstacle(sim_t *sim, uint16_t angle_q6, uint16_t width_q6, uint16_t distance_mm)
{
    sim_scene_place(&sim->scene, angle_q6, width_q6, distance_mm);
}

void sim_clear_obstacles(sim_t *sim)
{
    sim_scene_build(&sim->scene);
}

/* ---- Queries ---- */

sim_mode_t sim_mode(const sim_t *sim)
{
    return sim->mode;
}

const char *sim_mode_name(sim_mode_t mode)
{
    static const char *const names[] = {"off", "booting", "idle", "scanning", "stopping", "fault"};
    return names[mode];
}

uint16_t sim_frequency_chz(const sim_t *sim)
{
    return sim->frequency_chz;
}

uint8_t sim_health(const sim_t *sim)
{
    return (uint8_t)(sim->health | (sim->rotor_blocked ? SIM_HEALTH_ENCODER : 0) |
                     (sim->rotor.data_fault ? SIM_HEALTH_DATA : 0));
}
