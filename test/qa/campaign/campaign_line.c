/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_line.h"

#include "encoder.h"

#include <string.h>

#define FULL_CIRCLE_Q6 23040u
#define FULL_CIRCLE_Q22 ((uint64_t)FULL_CIRCLE_Q6 << 16) /* Fine phases: 2^-16 of 1/64 degree. */
#define SAMPLES_PER_SECOND 4000u                         /* Section 1. */
#define SAMPLE_US 250u
#define FULL_PACKET 40u /* Section 9.6. */
#define LONE_ONE_IN 300u
#define JITTER_Q6 3u
#define LONE_STEP_BACK_Q6 7u /* Section 9.6: 0.266 - 0.156 degrees. */
#define FIRST_SAMPLE_US 15000u
#define SPIN_UP_CHZ 240u
#define SPIN_UP_US 1000000u

/* ---- Marks: 11 bits of the sample's index, 13 of its revolution, scrambled to look random ---- */

#define MARK_BITS 24u
#define MARK_MASK ((1u << MARK_BITS) - 1u)
#define SAMPLE_BITS 11u

/* Odd numbers and their inverses modulo 2^24. */
#define FACTOR_A 0x9E3779u
#define FACTOR_B 0x85EBCBu

static uint32_t inverse(uint32_t odd)
{
    uint32_t x = odd;

    for (unsigned round = 0; round < 4; round++) {
        x = x * (2u - odd * x);
    }
    return x & MARK_MASK;
}

static uint32_t scramble(uint32_t mark, uint32_t key)
{
    uint32_t x = ((mark ^ key) * FACTOR_A) & MARK_MASK;

    x ^= x >> 13;
    return (x * FACTOR_B) & MARK_MASK;
}

static uint32_t unscramble(uint32_t value, uint32_t key)
{
    uint32_t x = (value * inverse(FACTOR_B)) & MARK_MASK;

    x ^= x >> 13;
    return ((x * inverse(FACTOR_A)) & MARK_MASK) ^ key;
}

static encode_sample_t marked_sample(const line_t *line, uint32_t revolution, uint32_t sample)
{
    const uint32_t value = scramble(revolution << SAMPLE_BITS | sample, line->key);

    return (encode_sample_t){.distance_mm = (uint16_t)(value & 0x3FFFu),
                             .intensity = (uint8_t)(value >> 16),
                             .flag = (uint8_t)(value >> 14 & 3u)};
}

bool line_identify(const line_t *line, uint16_t distance_mm, uint8_t intensity, uint8_t flag,
                   line_mark_t *mark)
{
    const uint32_t value = (uint32_t)intensity << 16 | (uint32_t)flag << 14 | distance_mm;
    const uint32_t plain = unscramble(value, line->key);

    mark->revolution = plain >> SAMPLE_BITS;
    mark->sample = plain & ((1u << SAMPLE_BITS) - 1u);
    return mark->revolution < line->config.revolutions &&
           mark->sample < line->counts[mark->revolution];
}

/* ---- The rotor ---- */

typedef struct {
    random_t *random;
    uint64_t
        phase; /* The next sample's angle, counted from a turn before the first start packet. */
    uint64_t step;
    uint64_t time_us; /* Time at which the next sample begins. */
    uint64_t free_us; /* Time at which the line is free. */
    uint32_t revolution;
    uint32_t index; /* The next packet's index in its revolution. */
    bool at_start;
    uint8_t crc;
    encode_turn_t turn;
} rotor_t;

static uint64_t step_at(uint32_t frequency_chz, int32_t per_100000)
{
    const uint64_t step = FULL_CIRCLE_Q22 * frequency_chz / (UINT64_C(100) * SAMPLES_PER_SECOND);

    return (uint64_t)((int64_t)step + (int64_t)step / 10000 * per_100000 / 10);
}

/* Chooses the revolution's speed, with a deviation of up to 0.5 %; lower while spinning up. */
static void choose_speed(const line_t *line, rotor_t *rotor)
{
    uint32_t frequency_chz = line->config.frequency_chz;
    const int32_t wobble = (int32_t)random_between(rotor->random, 0, 1000) - 500;

    if (line->config.spins_up && rotor->time_us < SPIN_UP_US) {
        frequency_chz = SPIN_UP_CHZ + (uint32_t)((uint64_t)(frequency_chz - SPIN_UP_CHZ) *
                                                 rotor->time_us / SPIN_UP_US);
    }
    rotor->step = step_at(frequency_chz, wobble);
}

static uint32_t draw_samples(const rotor_t *rotor)
{
    const uint64_t left = FULL_CIRCLE_Q22 - rotor->phase % FULL_CIRCLE_Q22;
    const uint64_t samples = (left + rotor->step - 1) / rotor->step;

    if (rotor->at_start || random_below(rotor->random, LONE_ONE_IN) == 0) {
        return 1;
    }
    return (uint32_t)(samples < FULL_PACKET ? samples : FULL_PACKET);
}

/* ---- Packets ---- */

static uint32_t with_jitter(const line_t *line, rotor_t *rotor, uint64_t phase)
{
    const uint32_t plain = (uint32_t)((phase >> 16) % FULL_CIRCLE_Q6);
    const uint32_t jitter = random_between(rotor->random, 0, 2 * JITTER_Q6);

    return plain + line->config.start_angle_q6 + FULL_CIRCLE_Q6 - JITTER_Q6 + jitter;
}

/* Sets the first and the last angle, which may exceed the full circle. The LSA of a lone sample is
 * a little less than its FSA (section 9.6). */
static void set_angles(const line_t *line, rotor_t *rotor, uint32_t count, uint32_t angles[2])
{
    angles[0] = with_jitter(line, rotor, rotor->phase);
    angles[1] =
        with_jitter(line, rotor, rotor->phase) + (uint32_t)(((count - 1) * rotor->step) >> 16);
    if (count == 1) {
        angles[1] = rotor->at_start ? angles[0] : angles[0] - LONE_STEP_BACK_Q6;
    } else if (angles[1] < angles[0]) {
        angles[1] = angles[0];
    }
}

/* Section 5: angles are evenly spaced from the first to the last; rounded to 1/64 degree. */
static void note_angles(line_t *line, uint32_t revolution, uint32_t count, const uint32_t angles[2])
{
    uint16_t *const noted = &line->angles_q6[revolution][line->counts[revolution]];
    const uint32_t steps = count > 1 ? count - 1 : 1;
    const uint32_t turned = count > 1 ? angles[1] - angles[0] : 0;

    for (uint32_t i = 0; i < count; i++) {
        noted[i] =
            (uint16_t)((angles[0] + (2 * turned * i + steps) / (2 * steps)) % FULL_CIRCLE_Q6);
    }
    line->counts[revolution] = (uint16_t)(line->counts[revolution] + count);
}

static void send(line_t *line, rotor_t *rotor, const uint8_t *bytes, uint32_t size)
{
    const uint64_t begins_us = rotor->time_us > rotor->free_us ? rotor->time_us : rotor->free_us;

    for (uint32_t i = 0; i < size; i++) {
        line->bytes[line->size] = bytes[i];
        line->owner[line->size] = (uint16_t)line->packet_count;
        line->is_guard[line->size] = size == 1;
        line->at_us[line->size++] = (uint32_t)(begins_us + (i + 1) * 1000000u / 23040u);
    }
    rotor->free_us = begins_us + size * 1000000u / 23040u;
}

static uint32_t encode(line_t *line, rotor_t *rotor, uint32_t count, uint8_t *out)
{
    encode_sample_t samples[FULL_PACKET];
    uint32_t angles[2];
    encode_packet_t packet = {.lsn = (uint8_t)count, .samples = samples};

    if (rotor->at_start || (line->config.ct_information && rotor->revolution > 0)) {
        packet.ct = encode_ct(&rotor->turn, rotor->index);
    }
    rotor->crc = encode_crc8(rotor->crc, packet.ct);
    for (uint32_t i = 0; i < count; i++) {
        samples[i] = marked_sample(line, rotor->revolution, line->counts[rotor->revolution] + i);
    }
    set_angles(line, rotor, count, angles);
    note_angles(line, rotor->revolution, count, angles);
    packet.first_q6 = (uint16_t)(angles[0] % FULL_CIRCLE_Q6);
    packet.last_q6 = (uint16_t)(angles[1] % FULL_CIRCLE_Q6);
    return (uint32_t)encode_packet(out, &packet);
}

/* Section 9.8: a start packet reports the frequency of the previous revolution. */
static void begin_revolution(line_t *line, rotor_t *rotor)
{
    const uint32_t samples = line->counts[rotor->revolution];

    if (rotor->revolution > 0 && line->config.ct_information) {
        send(line, rotor, &rotor->crc, 1);
    }
    rotor->turn.frequency_dhz =
        (uint16_t)(rotor->revolution > 0 ? (10 * SAMPLES_PER_SECOND + samples / 2) / samples
                                         : line->config.frequency_chz / 10);
    rotor->revolution++;
    rotor->index = 0;
    rotor->crc = 0;
    choose_speed(line, rotor);
}

static void turn_on(rotor_t *rotor, uint32_t count)
{
    const uint64_t before = rotor->phase / FULL_CIRCLE_Q22;

    rotor->phase += count * rotor->step;
    rotor->at_start = rotor->phase / FULL_CIRCLE_Q22 != before;
    rotor->index++;
}

static void make_packet(line_t *line, rotor_t *rotor)
{
    uint8_t bytes[ENCODE_PACKET_MAX];
    line_packet_t *const packet = &line->packets[line->packet_count];
    const uint32_t count = draw_samples(rotor);

    rotor->time_us += (uint64_t)count * SAMPLE_US;
    if (rotor->at_start) {
        begin_revolution(line, rotor);
    }
    *packet = (line_packet_t){.from = line->size,
                              .turned_q6 = rotor->phase >> 16,
                              .ends_q6 = (rotor->phase + (count - 1) * rotor->step) >> 16,
                              .first = line->counts[rotor->revolution],
                              .samples = (uint16_t)count,
                              .revolution = (uint16_t)rotor->revolution,
                              .is_start = rotor->at_start};
    send(line, rotor, bytes, encode(line, rotor, count, bytes));
    packet->to = line->size;
    packet->sent_us = line->at_us[line->size - 1];
    line->packet_count++;
    turn_on(rotor, count);
}

void line_make(line_t *line, const line_config_t *config, random_t *random)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    rotor_t rotor = {.random = random,
                     .turn = {.user_major = 1,
                              .hardware = 1,
                              .firmware_major = 1,
                              .firmware_minor = 2,
                              .year = 2026,
                              .month = 3,
                              .day = 17,
                              .serial = 12345,
                              .production = (uint8_t)random_below(random, 128)}};

    memset(line->counts, 0, sizeof line->counts);
    memset(line->touched, 0, sizeof line->touched);
    line->config = *config;
    line->key = random_below(random, 1u << MARK_BITS);
    line->size = 0;
    line->packet_count = 0;
    rotor.phase = ((uint64_t)random_u32(random) << 16) % FULL_CIRCLE_Q22;
    choose_speed(line, &rotor);
    rotor.time_us = 3000;
    send(line, &rotor, reply, (uint32_t)encode_scan_reply(reply));
    rotor.time_us = FIRST_SAMPLE_US;
    while (!rotor.at_start || rotor.revolution + 1 < config->revolutions) {
        make_packet(line, &rotor);
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

/* Copies up to `most` bytes that arrive, beginning at `from`; returns their number. */
static uint32_t gather(const line_t *line, uint32_t from, uint8_t *bytes, uint32_t most)
{
    uint32_t count = 0;

    for (uint32_t i = from; i < line->size && count < most; i++) {
        if (!line->lost[i]) {
            bytes[count++] = line->bytes[i];
        }
    }
    return count;
}

static bool is_valid_packet(const uint8_t *bytes, uint32_t count, uint32_t *size)
{
    if (count < ENCODE_PACKET_HEADER || bytes[0] != 0xAA || bytes[1] != 0x55 || bytes[3] == 0 ||
        bytes[3] > LINE_MAX_SAMPLES) {
        return false;
    }
    *size = ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * bytes[3];
    return *size <= count && encode_checksum(bytes) == (bytes[8] | bytes[9] << 8);
}

/* True if the bytes on both sides of the hole at `cut` look like a packet. */
static bool forges_a_packet(const line_t *line, uint32_t cut)
{
    uint8_t bytes[ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * LINE_MAX_SAMPLES];
    uint32_t seen = 0;

    if (!line->lost[cut] || cut == 0 || line->lost[cut - 1]) {
        return false;
    }
    for (uint32_t i = cut; i-- > 0 && seen < sizeof bytes;) {
        uint32_t size = 0;

        if (line->lost[i]) {
            continue;
        }
        seen++;
        if (line->bytes[i] == 0xAA &&
            is_valid_packet(bytes, gather(line, i, bytes, sizeof bytes), &size) && size > seen) {
            return true;
        }
    }
    return false;
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

/* Makes a hole a byte wider if the bytes on both sides look like a packet. */
static void forge_nothing(line_t *line)
{
    for (uint32_t i = 1; i < line->size; i++) {
        while (forges_a_packet(line, i)) {
            lose(line, i - 1, i);
            i = i > 300 ? i - 300 : 1; /* This may affect the holes before it: check them again. */
        }
    }
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
