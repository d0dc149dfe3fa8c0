/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign.h"

#include "encoder.h"
#include "reference_decoder.h"

#include <string.h>

#define TURN_Q6 ENCODE_FULL_TURN_Q6
#define HALF_A_PACKET_Q6 700u /* Of 40 samples. */
#define SILENCE_US 10000u

holes_t holes;

/* Most begin between two packets; one in four just after another hole. */
static void plan(void)
{
    const bool is_near = below(4) == 0;
    holes.packets = is_near ? 0 : 1 + below(2 * holes.every);
    holes.bytes = is_near ? below(500) : 0;
}

void holes_begin(uint32_t count, uint32_t turns, uint32_t turn_us)
{
    const uint32_t packets = turns * (turn_us / 10000u + 2u); /* 10 ms and a packet of 40. */
    memset(&holes, 0, sizeof holes);
    holes.turn_us = turn_us;
    holes.turns = turns;
    holes.left = count;
    holes.every = count > 0 ? packets / count / 2 + 1 : 1;
    holes.turned_q6 = TURN_Q6;
    plan();
    holes.packets += 1;
}

/* How far the rotor has turned in all, at this angle; jitter may take it back. */
static uint64_t turn_to(uint16_t angle_q6)
{
    const uint32_t turned = (angle_q6 + TURN_Q6 - holes.last_q6) % TURN_Q6;
    holes.last_q6 = angle_q6;
    holes.turned_q6 += turned;
    holes.turned_q6 -= turned < TURN_Q6 / 2 ? 0 : TURN_Q6;
    return holes.turned_q6;
}

/* As long as the line lets it be: each kind of end that is not set is never reached. */
static void open(uint64_t now_us)
{
    const uint64_t turns = 1 + below(5);
    const uint32_t kind = below(6);
    holes.is_open = true;
    holes.dribbles = below(3) == 0;
    holes.of_start = false;
    holes.to_q6 = UINT64_MAX;
    holes.to_us = UINT64_MAX;
    holes.size = UINT32_MAX;
    if (kind < 2) {
        holes.to_q6 = holes.turned_q6 + turns * TURN_Q6 - HALF_A_PACKET_Q6;
    } else if (kind == 2) {
        holes.to_us = now_us + turns * holes.turn_us + below(16000) - 8000;
    } else if (kind == 3) {
        holes.of_start = true;
        holes.is_short = below(2) == 0;
    } else if (below(5) == 0) {
        holes.size = 1 + below(300);
    } else {
        holes.to_us = now_us + (uint64_t)holes.turn_us * below(5000) / 1000u;
    }
}

static void close(void)
{
    holes.is_open = false;
    holes.left--;
    plan();
}

/* The first byte of a packet, or of the LastCRC before it. Half of the holes that do not begin
 * close to another begin inside a packet. */
static void begin_packet(const sim_run_t *run)
{
    const uint8_t *const bytes = run->packet->bytes;
    const uint64_t first_q6 = turn_to(reference_point(bytes, 0).angle_q6);
    if (holes.is_open && first_q6 >= holes.to_q6) {
        close();
    } else if (!holes.is_open && holes.packets > 0 && --holes.packets == 0) {
        holes.bytes = below(2) == 0 ? 0 : below(run->packet->length);
    }
    holes.drops = 1 + below(30);
    holes.drops = holes.drops < run->packet->length ? holes.drops : 0;
}

static bool is_in_hole(const sim_run_t *run, size_t place, uint64_t now_us)
{
    if (!holes.is_open && holes.left > 0 && holes.packets == 0 && holes.bytes-- == 0) {
        open(now_us);
    }
    if (holes.is_open && (now_us >= holes.to_us || holes.size == 0)) {
        close();
    }
    if (!holes.is_open) {
        return false;
    }
    holes.size--;
    if (holes.of_start) {
        const bool is_it = run->packet->starts_revolution && place >= run->packet_at;
        const bool is_last = holes.is_short || place + 1u == run->frame_length;
        if (is_it && is_last) {
            close();
        }
        return is_it;
    }
    return !(holes.dribbles && place >= run->packet_at && place - run->packet_at < holes.drops);
}

static void note_silence(uint64_t now_us)
{
    if (now_us - holes.heard_us > SILENCE_US) {
        holes.silences[holes.silence_count++ % HOLES_SILENCES] =
            (silence_t){holes.heard_us, now_us};
    }
    holes.heard_us = now_us;
}

bool holes_take(void *context, const sim_run_t *run, size_t i)
{
    const size_t place = run->offset + i;
    const uint64_t now_us = sim_byte_us(run->start_us, place);
    (void)context;
    if (run->packet == NULL) {
        return false; /* A reply. */
    }
    if (place == 0) {
        begin_packet(run);
    }
    holes.is_over |= run->packet->revolution >= holes.turns;
    const bool is_lost = is_in_hole(run, place, now_us) || holes.is_over;
    if (place + 1u == run->frame_length) {
        const uint8_t *const bytes = run->packet->bytes;
        (void)turn_to(reference_point(bytes, bytes[3] - 1u).angle_q6);
    }
    if (!is_lost) {
        note_silence(now_us);
    }
    return is_lost;
}

uint64_t holes_longest_us(uint64_t from_us, uint64_t to_us)
{
    uint64_t longest_us = 0;
    for (uint32_t i = 0; i < holes.silence_count && i < HOLES_SILENCES; i++) {
        const silence_t silence = holes.silences[i];
        const uint64_t us = silence.to_us - silence.from_us;
        if (silence.to_us > from_us && silence.to_us <= to_us && us > longest_us) {
            longest_us = us;
        }
    }
    return longest_us;
}
