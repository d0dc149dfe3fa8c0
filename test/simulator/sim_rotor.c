/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "sim_rotor.h"

#define FULL_TURN_Q16 (UINT32_C(23040) << 16)
#define SAMPLE_US 250u  /* section 1: 4000 samples per second */
#define FULL_PACKET 40u /* section 9.6, or fewer by configuration */
#define SPEED_PER_CHZ 1000u
#define LONE_STEP_BACK_Q6 7u /* FSA - LSA in section 9.6: 0.266 - 0.156 degrees */

static uint32_t set_speed(const sim_t *sim)
{
    return (uint32_t)sim->frequency_chz * SPEED_PER_CHZ / 100u * sim->config.motor_percent;
}

static bool frozen(const sim_t *sim)
{
    return sim->rotor_blocked && !sim->config.blocked_sends_starts;
}

/* The angle per sample, at 4000 Hz: speed * FULL_TURN_Q16 / (4000 * 10^5), as a reduced
 * fraction. */
static uint32_t step_of(uint32_t speed)
{
    return (uint32_t)((uint64_t)speed * 294912u / 78125u);
}

static uint32_t approach(uint32_t from, uint32_t to, uint32_t most)
{
    if (from < to) {
        return to - from > most ? from + most : to;
    }
    return from - to > most ? from - most : to;
}

/* The speed approaches the set frequency no faster than during spin-up. */
static void turn_rotor(sim_t *sim, uint32_t samples)
{
    sim_rotor_t *rotor = &sim->rotor;
    const uint32_t target = (uint32_t)((int32_t)set_speed(sim) + rotor->wobble);
    const uint32_t spin_up_samples = (uint32_t)sim->config.spin_up_ms * 4u;
    const uint32_t most =
        spin_up_samples == 0u ? target : set_speed(sim) / spin_up_samples * samples + 1u;
    rotor->speed = approach(rotor->speed, target, most);
    rotor->step = frozen(sim) ? 0u : step_of(rotor->speed);
}

/* This revolution's deviation in speed, in either direction. */
static int32_t draw_wobble(sim_t *sim)
{
    const uint32_t most = set_speed(sim) / 1000u * sim->config.wobble_permille;
    return (int32_t)random_between(&sim->random, 0, 2u * most) - (int32_t)most;
}

static uint32_t samples_to_full_turn(const sim_t *sim)
{
    const sim_rotor_t *rotor = &sim->rotor;
    if (rotor->step == 0u || rotor->unmarked) {
        return sim->config.samples_per_packet;
    }
    return (FULL_TURN_Q16 - rotor->phase + rotor->step - 1u) / rotor->step;
}

static bool happens(sim_t *sim, uint16_t permille)
{
    return permille != 0u && random_below(&sim->random, 1000) < permille;
}

/* Section 9.6: full packets, a short last one, and sometimes one with a single sample. */
static uint32_t draw_packet_samples(sim_t *sim)
{
    const uint32_t left = samples_to_full_turn(sim);
    if (sim->rotor.at_start || happens(sim, sim->config.lone_packet_permille)) {
        return 1;
    }
    return left < sim->config.samples_per_packet ? left : sim->config.samples_per_packet;
}

static void plan_packet(sim_t *sim, uint64_t from_us)
{
    sim->rotor.planned = (uint8_t)draw_packet_samples(sim);
    sim->rotor.due_us = from_us + (uint32_t)sim->rotor.planned * SAMPLE_US;
}

static uint32_t decimal(const uint8_t *digits, unsigned count)
{
    uint32_t value = 0;
    for (unsigned i = 0; i < count; i++) {
        value = value * 10u + digits[i];
    }
    return value;
}

/* Normally the serial number begins with a date (section 7), but not on all units (section 9.5). */
static void prepare_turn_information(sim_t *sim)
{
    const encode_information_t *information = &sim->config.information;
    encode_turn_t *turn = &sim->rotor.turn;
    turn->user_major = sim->config.user_major;
    turn->user_minor = sim->config.user_minor;
    turn->hardware = information->hardware;
    turn->firmware_major = information->firmware_major;
    turn->firmware_minor = information->firmware_minor;
    turn->year = (uint16_t)decimal(information->serial, 4);
    turn->month = (uint8_t)decimal(information->serial + 4, 2);
    turn->day = (uint8_t)decimal(information->serial + 6, 2);
    turn->serial = decimal(information->serial + 8, 8);
}

/* The rotor's angle at the start is random unless configured, so the first revolution is
 * partial. */
static uint32_t first_phase(sim_t *sim)
{
    const uint32_t chance = random_below(&sim->random, FULL_TURN_Q16);
    const uint32_t angle_q6 = sim->config.first_angle_q6;
    if (angle_q6 == 0u) {
        return chance;
    }
    return ((angle_q6 + ENCODE_FULL_TURN_Q6 - sim->config.start_angle_q6) % ENCODE_FULL_TURN_Q6)
           << 16;
}

void sim_rotor_start(sim_t *sim, uint64_t at_us)
{
    sim_rotor_t *rotor = &sim->rotor;
    prepare_turn_information(sim);
    rotor->phase = first_phase(sim);
    rotor->speed = set_speed(sim) / 100u * sim->config.spin_up_percent;
    rotor->wobble = draw_wobble(sim);
    rotor->at_start = sim->config.beginning == SIM_BEGINS_WITH_A_START;
    rotor->unmarked = sim->config.beginning == SIM_BEGINS_UNMARKED;
    rotor->in_turn = false;
    rotor->noted = 0;
    rotor->is_partial = false;
    rotor->index = 0;
    rotor->samples = 0;
    rotor->valid = 0;
    rotor->data_fault = false;
    turn_rotor(sim, 0);
    plan_packet(sim, at_us);
}

void sim_rotor_release(sim_t *sim)
{
    sim->rotor.speed = set_speed(sim) / 100u * sim->config.spin_up_percent;
}

void sim_rotor_stop(sim_t *sim)
{
    sim->rotor.due_us = SIM_NEVER;
}

bool sim_rotor_measures(const sim_t *sim)
{
    const sim_rotor_t *rotor = &sim->rotor;
    return rotor->due_us != SIM_NEVER &&
           sim->now_us + (uint32_t)rotor->planned * SAMPLE_US >= rotor->due_us;
}

/* The signal falls with the distance. */
static uint8_t intensity_at(uint16_t distance_mm)
{
    return (uint8_t)(10u + UINT32_C(360000) / (distance_mm + 1500u));
}

static uint16_t add_noise(uint16_t distance_mm, uint32_t dice, uint32_t noise_mm)
{
    const uint32_t added = (dice & 0xFFFFu) * (2u * noise_mm + 1u) >> 16;
    if (distance_mm <= noise_mm) {
        return distance_mm;
    }
    return (uint16_t)(distance_mm + added - noise_mm);
}

/* The angle of the room that the lidar sees at one of its own: the room turns the other way when
 * the robot is turned. */
static uint32_t room_angle(const sim_t *sim, uint32_t angle_q6)
{
    const sim_config_t *const config = &sim->config;
    const int64_t full = ENCODE_FULL_TURN_Q6;
    int64_t turned = (int64_t)angle_q6 - config->turned_q6;
    if (config->turning_q6_s != 0) {
        turned += (int64_t)sim->now_us * config->turning_q6_s / 1000000 % full;
    }
    return (uint32_t)(turned < 0 ? turned + full : turned < full ? turned : turned - full);
}

static bool is_mast(const sim_config_t *config, uint32_t angle_q6)
{
    return config->mast_mm != 0 && angle_q6 >= config->mast_from_q6 &&
           angle_q6 <= (uint32_t)config->mast_from_q6 + config->mast_wide_q6;
}

static bool is_dark(const sim_t *sim)
{
    return sim->rotor_blocked || sim->window_covered;
}

static uint16_t ideal_distance(const sim_t *sim, uint32_t angle_q16)
{
    const uint32_t angle_q6 = angle_q16 >> 16;
    uint16_t seen_mm;
    if (is_dark(sim)) {
        return 0;
    }
    seen_mm = is_mast(&sim->config, angle_q6)
                  ? sim->config.mast_mm
                  : sim->scene.distance_mm[room_angle(sim, angle_q6) / SIM_SCENE_STEP_Q6];
    return (uint16_t)(seen_mm == 0 ? 0 : seen_mm + sim->config.range_error_mm);
}

/* One random number per sample: 16 bits each decide the noise, whether the range is missing, and
 * the flag. */
static encode_sample_t measure_noisy(sim_t *sim, uint32_t angle_q16)
{
    const uint64_t dice = random_u64(&sim->random);
    const uint32_t missing = ((uint32_t)(dice >> 16) & 0xFFFFu) * 1000u >> 16;
    const uint32_t flagged = ((uint32_t)(dice >> 32) & 0xFFFFu) * 1000u >> 16;
    const uint16_t ideal = ideal_distance(sim, angle_q16);
    encode_sample_t sample = {0, 0, 0};
    if (is_dark(sim)) {
        return sample;
    }
    if (ideal != 0u && missing >= sim->config.invalid_permille) {
        sample.distance_mm = add_noise(ideal, (uint32_t)dice, sim->config.noise_mm);
        sample.intensity = intensity_at(ideal);
    }
    if (flagged < sim->config.flagged_permille) {
        sample.flag = (uint8_t)(2u + (dice >> 63));
    }
    return sample;
}

/* Most of the time of long runs would go into random numbers. */
static encode_sample_t measure_quiet(sim_t *sim, uint32_t angle_q16)
{
    const uint16_t ideal = ideal_distance(sim, angle_q16);
    const encode_sample_t sample = {ideal, intensity_at(ideal), 0};
    return ideal != 0u ? sample : (encode_sample_t){0, 0, 0};
}

static bool is_noisy(const sim_config_t *config)
{
    return config->noise_mm != 0u || config->invalid_permille != 0u ||
           config->flagged_permille != 0u;
}

static encode_sample_t measure(sim_t *sim, uint32_t angle_q16)
{
    return is_noisy(&sim->config) ? measure_noisy(sim, angle_q16) : measure_quiet(sim, angle_q16);
}

static uint32_t turned_by(uint32_t angle_q16, uint32_t more_q16)
{
    const uint32_t room = FULL_TURN_Q16 - angle_q16;
    return more_q16 < room ? angle_q16 + more_q16 : more_q16 - room;
}

static bool is_blind(const sim_t *sim)
{
    const uint8_t every = sim->config.blind_every;
    return every != 0u && sim->revolution % every == 0u;
}

static void measure_all(sim_t *sim, encode_sample_t *samples)
{
    uint32_t angle = turned_by(sim->rotor.phase, (uint32_t)sim->config.start_angle_q6 << 16);
    for (uint32_t i = 0; i < sim->rotor.planned; i++) {
        samples[i] = sim->config.marked && !is_dark(sim)
                         ? sim_mark(sim, sim->revolution, sim->rotor.samples + i)
                         : measure(sim, angle);
        sim->rotor.valid += samples[i].distance_mm != 0u ? 1u : 0u;
        samples[i].distance_mm = is_blind(sim) ? 0u : samples[i].distance_mm;
        angle = turned_by(angle, sim->rotor.step);
    }
}

/* Returns 0..2 * jitter. set_angles() subtracts one jitter, so angles vary in both directions. */
static uint32_t draw_jitter(sim_t *sim)
{
    const uint32_t most = frozen(sim) ? 0u : sim->config.angle_jitter_q6;
    return random_between(&sim->random, 0, 2u * most);
}

/* Both angles have jitter, but LSA must not be less than FSA: that would mean almost a full
 * turn. */
static void set_angles(sim_t *sim, encode_packet_t *packet)
{
    const sim_rotor_t *rotor = &sim->rotor;
    const uint32_t zero = ENCODE_FULL_TURN_Q6 + sim->config.start_angle_q6 -
                          (frozen(sim) ? 0u : sim->config.angle_jitter_q6);
    const uint32_t swept = rotor->step * (rotor->planned - 1u);
    const uint32_t first = zero + (rotor->phase >> 16) + draw_jitter(sim);
    uint32_t last = zero + ((rotor->phase + swept) >> 16) + draw_jitter(sim);
    if (rotor->planned == 1u) {
        last = rotor->at_start ? first : first - LONE_STEP_BACK_Q6;
    } else if (last < first) {
        last = first;
    }
    packet->first_q6 = (uint16_t)(first % ENCODE_FULL_TURN_Q6);
    packet->last_q6 = (uint16_t)(last % ENCODE_FULL_TURN_Q6);
}

/* The previous revolution's frequency (section 9.8); if there was none, the present speed. */
static uint16_t measured_frequency_dhz(const sim_rotor_t *rotor)
{
    uint32_t dhz = rotor->speed / (10u * SPEED_PER_CHZ);
    if (rotor->in_turn && rotor->samples > 0u) {
        dhz = (40000u + rotor->samples / 2u) / rotor->samples;
    }
    return (uint16_t)(dhz < 127u ? dhz : 127u);
}

/* Section 8: a whole revolution without a range is a data fault. When the rotor is blocked, the
 * laser is dark and the device reports the encoder fault instead. */
static void begin_revolution(sim_t *sim)
{
    sim_rotor_t *rotor = &sim->rotor;
    rotor->turn.frequency_dhz = measured_frequency_dhz(rotor);
    rotor->turn.production = (uint8_t)random_below(&sim->random, 128);
    rotor->data_fault = rotor->in_turn && rotor->valid == 0u && !sim->rotor_blocked;
    rotor->wobble = draw_wobble(sim);
    rotor->is_partial = !rotor->in_turn && sim->config.beginning == SIM_BEGINS_WITH_A_START;
    rotor->in_turn = true;
    rotor->index = 0;
    rotor->crc = 0;
    rotor->samples = 0;
    rotor->valid = 0;
    sim->revolution++;
}

/* Point packets before the first start packet have no index and no CT information. */
static uint8_t next_ct(sim_t *sim)
{
    sim_rotor_t *rotor = &sim->rotor;
    if (!rotor->at_start && (!sim->config.ct_information || !rotor->in_turn)) {
        return 0;
    }
    rotor->turn.health = sim_health(sim);
    return encode_ct(&rotor->turn, rotor->index);
}

/* LastCRC follows a complete revolution, so the first start packet has none before it. */
static uint8_t add_last_crc(const sim_t *sim, sim_frame_t *frame)
{
    if (!sim->rotor.at_start || !sim->rotor.in_turn || !sim->config.ct_information) {
        return 0;
    }
    frame->bytes[0] = sim->rotor.crc;
    return 1;
}

static size_t encode(const sim_t *sim, sim_frame_t *frame, const encode_packet_t *packet)
{
    uint8_t *const out = frame->bytes + frame->packet_at;
    return sim->config.sample_size == 3u
               ? encode_packet(out, packet)
               : encode_other_packet(out, packet, sim->config.sample_size);
}

static void fill_frame(sim_t *sim, sim_frame_t *frame)
{
    sim_rotor_t *rotor = &sim->rotor;
    encode_sample_t samples[FULL_PACKET];
    encode_packet_t packet = {0, 0, 0, 0, NULL};
    frame->packet_at = add_last_crc(sim, frame);
    if (rotor->at_start) {
        begin_revolution(sim);
    }
    packet.ct = next_ct(sim);
    packet.lsn = rotor->planned;
    packet.samples = samples;
    set_angles(sim, &packet);
    measure_all(sim, samples);
    frame->length = (uint16_t)(frame->packet_at + encode(sim, frame, &packet));
    frame->is_packet = true;
    frame->packet.number = sim->packet_number++;
    frame->packet.revolution = sim->revolution;
    frame->packet.starts_revolution = rotor->at_start;
    frame->packet.is_of_partial = rotor->is_partial;
    rotor->crc = encode_crc8(rotor->crc, packet.ct);
}

static void turn_past_packet(sim_t *sim)
{
    sim_rotor_t *rotor = &sim->rotor;
    const uint32_t swept = rotor->step * rotor->planned;
    const uint32_t to_start = FULL_TURN_Q16 - rotor->phase;
    const bool passes = swept >= to_start;
    rotor->at_start = passes && !rotor->unmarked;
    rotor->unmarked = rotor->unmarked && !passes;
    rotor->phase = passes ? swept - to_start : rotor->phase + swept;
    rotor->index++;
    rotor->samples += rotor->planned;
    turn_rotor(sim, rotor->planned);
    plan_packet(sim, sim->now_us);
}

static void send_packet(sim_t *sim, bool is_sent, bool is_doubled)
{
    sim_frame_t *frame = sim_line_open(&sim->line);
    sim_frame_t *again;
    if (frame == NULL) {
        return;
    }
    fill_frame(sim, frame);
    if (!is_sent) {
        return;
    }
    sim_line_send(&sim->line, sim->now_us);
    if (is_doubled && (again = sim_line_open(&sim->line)) != NULL) {
        *again = *frame;
        sim_line_send(&sim->line, sim->now_us);
    }
}

/* Returns SIM_SOUND for packets that are no events. */
static sim_trouble_t spoil(sim_t *sim, uint32_t *for_ms)
{
    sim_rotor_t *rotor = &sim->rotor;
    if (rotor->noted >= SIM_STARTS_NOTED || (rotor->noted > 0u && !rotor->at_start)) {
        return SIM_SOUND;
    }
    return sim_event(sim, rotor->noted++ == 0u ? SIM_EVENT_BEGINNING : SIM_EVENT_START, for_ms);
}

void sim_rotor_packet(sim_t *sim)
{
    sim_rotor_t *rotor = &sim->rotor;
    const bool is_beginning = rotor->noted == 0u;
    uint32_t for_ms = 0;
    const sim_trouble_t trouble = spoil(sim, &for_ms);
    const bool is_hidden = sim_is_silent(sim) || (sim->no_starts && rotor->at_start);
    if (rotor->due_us == SIM_NEVER) {
        return; /* The trouble was a loss of power. */
    }
    if (trouble == SIM_LOST && is_beginning) {
        sim_go_idle(sim);
        return;
    }
    if (trouble == SIM_LATE) {
        rotor->due_us += (uint64_t)for_ms * 1000u;
        return;
    }
    send_packet(sim, !is_hidden && trouble != SIM_LOST, trouble == SIM_DOUBLED);
    turn_past_packet(sim);
}
