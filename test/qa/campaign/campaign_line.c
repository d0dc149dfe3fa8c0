/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_line.h"

#include <string.h>

#define FULL_CIRCLE_Q6 23040u
#define SPIN_UP_CHZ 240u
#define FAR_US UINT64_C(60000000)

/* ---- What the simulated lidar sends ---- */

static sim_config_t lidar_config(const line_config_t *config, uint64_t seed)
{
    sim_config_t lidar = sim_default_config();
    lidar.seed = seed;
    lidar.marked = true;
    lidar.ct_information = config->ct_information;
    lidar.frequency_chz = (uint16_t)config->frequency_chz;
    lidar.start_angle_q6 = (uint16_t)config->start_angle_q6;
    lidar.lone_packet_permille = 3;
    lidar.first_packet_ms = 12;
    lidar.spin_up_percent =
        (uint8_t)(config->spins_up ? 100u * SPIN_UP_CHZ / config->frequency_chz : 100u);
    return lidar;
}

/* How far the rotor has turned in all, at this angle; jitter may take it back. */
static uint64_t turn_to(line_t *line, uint16_t angle_q6)
{
    const uint32_t turned = (angle_q6 + FULL_CIRCLE_Q6 - line->last_q6) % FULL_CIRCLE_Q6;
    line->last_q6 = angle_q6;
    line->turned_q6 += turned;
    line->turned_q6 -= turned < FULL_CIRCLE_Q6 / 2 ? 0 : FULL_CIRCLE_Q6;
    return line->turned_q6;
}

static void note_bytes(line_t *line, const sim_run_t *run)
{
    for (uint32_t i = 0; i < run->length; i++) {
        line->bytes[line->size] = run->bytes[i];
        line->owner[line->size] = (uint16_t)line->packet_count;
        line->is_guard[line->size] = i < run->packet_at;
        line->at_us[line->size++] = (uint32_t)sim_byte_us(run->start_us, i);
    }
}

static void note_packet(line_t *line, const sim_run_t *run)
{
    line_packet_t *const packet = &line->packets[line->packet_count];
    const uint8_t *const bytes = run->packet->bytes;
    *packet = (line_packet_t){.from = line->size + (uint32_t)run->packet_at,
                              .to = line->size + (uint32_t)run->length,
                              .first = sim_judge_sent(&line->judge, run->packet),
                              .samples = bytes[3],
                              .revolution = (uint16_t)run->packet->revolution,
                              .is_start = run->packet->starts_revolution};
    packet->turned_q6 = turn_to(line, reference_point(bytes, 0).angle_q6);
    packet->ends_q6 = turn_to(line, reference_point(bytes, packet->samples - 1u).angle_q6);
    line->counts[packet->revolution] += packet->samples;
    note_bytes(line, run);
    packet->sent_us = line->at_us[line->size - 1];
    line->packet_count++;
}

void line_make(line_t *line, const line_config_t *config, random_t *random)
{
    static const uint8_t start[] = {0xA5, SIM_COMMAND_START};
    const sim_config_t lidar = lidar_config(config, random_u64(random));
    sim_run_t run;
    memset(line->counts, 0, sizeof line->counts);
    memset(line->touched, 0, sizeof line->touched);
    line->config = *config;
    line->size = 0;
    line->packet_count = 0;
    line->turned_q6 = FULL_CIRCLE_Q6;
    line->last_q6 = 0;
    sim_judge_begin(&line->judge);
    line->judge.is_guarded = config->ct_information;
    sim_init(&line->lidar, &lidar);
    sim_receive(&line->lidar, start, sizeof start, 0);
    /* As far in the future as needed: the whole next frame. */
    while (sim_next_run(&line->lidar, FAR_US, &run) &&
           (run.packet == NULL || run.packet->revolution < config->revolutions)) {
        if (run.packet == NULL) {
            note_bytes(line, &run);
        } else {
            note_packet(line, &run);
        }
    }
    memset(line->lost, 0, line->size);
}

/* ---- Bytes that do not arrive ---- */

/* A start packet also ends the revolution before it. */
static void touch(line_t *line, uint32_t byte)
{
    const line_packet_t *const packet = &line->packets[line->owner[byte]];
    line->touched[packet->revolution] = true;
    if (packet->is_start && packet->revolution > 0) {
        line->touched[packet->revolution - 1] = true;
    }
}

void line_lose(line_t *line, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        touch(line, i);
        line->packets[line->owner[i]].missing += line->is_guard[i] ? 0 : 1;
    }
}

static uint32_t byte_at_time(const line_t *line, uint32_t from, uint64_t us)
{
    while (from < line->size && line->at_us[from] < us) {
        from++;
    }
    return from;
}

/* The packet that begins nearest to the angle `turned_q6`. */
static uint32_t packet_nearest(const line_t *line, uint64_t turned_q6)
{
    uint32_t nearest = 0;
    while (nearest + 1 < line->packet_count &&
           line->packets[nearest + 1].turned_q6 <= turned_q6 + FULL_CIRCLE_Q6 / 128) {
        nearest++;
    }
    return nearest;
}

/* A hole between two packets, of nearly a whole number of turns. */
static void cut_whole_turns(line_t *line, random_t *random, uint32_t cut[2])
{
    const uint32_t first = random_between(random, 1, line->packet_count - 2);
    const uint64_t turns = random_between(random, 1, 5);
    cut[0] = line->packets[first].to;
    cut[1] =
        line->packets[packet_nearest(line, line->packets[first].ends_q6 + turns * FULL_CIRCLE_Q6)]
            .from;
}

/* As above, but measured by time, with a few milliseconds more or less. */
static void cut_turns_of_time(line_t *line, random_t *random, uint32_t cut[2])
{
    const line_packet_t *const last =
        &line->packets[random_between(random, 1, line->packet_count - 2)];
    const uint32_t turns_us =
        random_between(random, 1, 5) * 100000000u / line->config.frequency_chz;
    cut[0] = last->to;
    cut[1] =
        byte_at_time(line, cut[0], last->sent_us + turns_us + random_below(random, 16000) - 8000);
}

static void cut_start_packet(line_t *line, random_t *random, uint32_t cut[2])
{
    uint32_t packet = random_below(random, line->packet_count);
    while (packet > 0 && !line->packets[packet].is_start) {
        packet--;
    }
    cut[0] = line->packets[packet].from;
    cut[1] = random_below(random, 2) == 0 ? line->packets[packet].to : cut[0] + 1;
}

/* A hole that begins at any byte, of up to five turns, or sometimes only of some bytes. */
static void cut_anywhere(line_t *line, random_t *random, uint32_t cut[2])
{
    const uint64_t turn_us = 100000000u / line->config.frequency_chz;
    const uint32_t head = line->packets[0].to;
    cut[0] = random_between(random, head, line->size - 1);
    if (random_below(random, 5) == 0) {
        cut[1] = cut[0] + random_between(random, 1, 300);
    } else {
        cut[1] = byte_at_time(
            line, cut[0], line->at_us[cut[0]] + turn_us * random_between(random, 0, 5000) / 1000);
    }
}

static void remove_lost(line_t *line)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < line->size; i++) {
        if (!line->lost[i]) {
            line->bytes[left] = line->bytes[i];
            line->owner[left] = line->owner[i];
            line->is_guard[left] = line->is_guard[i];
            line->at_us[left++] = line->at_us[i];
        } else {
            line_lose(line, i, i + 1);
        }
    }
    line->size = left;
}

static void lose(line_t *line, uint32_t from, uint32_t to)
{
    memset(&line->lost[from], 1, to - from);
}

/* Lets some bytes of each packet in the hole arrive, so that there is no silence. */
static void let_dribble(line_t *line, random_t *random, uint32_t from, uint32_t to)
{
    const uint32_t most = random_between(random, 1, 30);
    for (uint32_t i = 0; i < line->packet_count; i++) {
        const line_packet_t *const packet = &line->packets[i];
        const uint32_t end = packet->from + random_between(random, 1, most);
        if (packet->from >= from && packet->to <= to && end < packet->to) {
            memset(&line->lost[packet->from], 0, end - packet->from);
        }
    }
}

/* What arrives, and where on the line each byte of it was sent. */
static struct {
    uint8_t bytes[LINE_BYTES];
    uint32_t sent_at[LINE_BYTES];
    bool is_forged; /* Bytes from both sides of a hole look like a packet. */
} arrived;

/* Makes the hole in the item a byte wider. */
static void lose_forged(void *context, const reference_item_t *item)
{
    const uint32_t *const sent_at = &arrived.sent_at[item->offset];
    uint32_t at = 1;
    while (at < item->length && sent_at[at] == sent_at[at - 1] + 1) {
        at++;
    }
    if (at < item->length) {
        lose(context, sent_at[at - 1], sent_at[at - 1] + 1);
        arrived.is_forged = true;
    }
}

static void forge_nothing(line_t *line)
{
    static const reference_options_t options = {.max_samples = LINE_MAX_SAMPLES};
    do {
        uint32_t count = 0;
        for (uint32_t i = 0; i < line->size; i++) {
            arrived.bytes[count] = line->bytes[i];
            arrived.sent_at[count] = i;
            count += line->lost[i] ? 0 : 1;
        }
        arrived.is_forged = false;
        (void)reference_decode(arrived.bytes, count, &options, lose_forged, line);
    } while (arrived.is_forged);
}

static void draw_cut(line_t *line, random_t *random, uint32_t cut[2])
{
    static void (*const cuts[])(line_t * line, random_t * random, uint32_t cut[2]) = {
        cut_whole_turns,  cut_whole_turns, cut_turns_of_time,
        cut_start_packet, cut_anywhere,    cut_anywhere};

    cuts[random_below(random, sizeof cuts / sizeof cuts[0])](line, random, cut);
}

/* Moves the cut to within a few packets of the previous cut, which ended at `before`. */
static void move_near(const line_t *line, random_t *random, uint32_t before, uint32_t cut[2])
{
    const uint32_t away = before + random_between(random, 0, 500);
    cut[1] = cut[1] - cut[0] + away;
    cut[0] = away < line->size ? away : line->size;
}

static void make_cut(line_t *line, random_t *random, uint32_t cut[2])
{
    cut[1] = cut[1] < line->size ? cut[1] : line->size;
    lose(line, cut[0], cut[1] > cut[0] ? cut[1] : cut[0]);
    if (random_below(random, 3) == 0) {
        let_dribble(line, random, cut[0], cut[1]);
    }
}

void line_interrupt(line_t *line, random_t *random)
{
    const uint32_t count = random_between(random, 1, LINE_CUTS);
    uint32_t before = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cut[2];
        draw_cut(line, random, cut);
        if (i > 0 && random_below(random, 4) == 0) {
            move_near(line, random, before, cut);
        }
        make_cut(line, random, cut);
        before = cut[1];
    }
    forge_nothing(line);
    remove_lost(line);
}
