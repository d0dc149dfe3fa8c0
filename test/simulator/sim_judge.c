/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "sim_judge.h"

/* Without LastCRC, if whole packets are missing, only the angles can show the hole between two
 * packets. Below 4 degrees, a hole cannot be distinguished from jitter. */
#define HIDDEN_Q6 256u

/* ---- What was sent ---- */

void sim_judge_begin(sim_judge_t *judge)
{
    judge->sent = 0;
    judge->next = 0;
    judge->begun_in_partial = false;
    judge->is_guarded = false;
}

const sim_sample_t *sim_judge_sample(const sim_judge_t *judge, uint32_t place)
{
    return &judge->samples[place % SIM_JUDGE_SAMPLES];
}

static sim_sample_t *sample_at(sim_judge_t *judge, uint32_t place)
{
    return &judge->samples[place % SIM_JUDGE_SAMPLES];
}

uint32_t sim_judge_sent(sim_judge_t *judge, const sim_packet_t *packet)
{
    const uint32_t first = judge->sent;
    for (unsigned i = 0; i < packet->bytes[3]; i++) {
        *sample_at(judge, judge->sent++) =
            (sim_sample_t){.point = reference_point(packet->bytes, i),
                           .starts = packet->starts_revolution,
                           .is_of_partial = packet->is_of_partial,
                           .turn = packet->revolution};
    }
    return first;
}

uint32_t sim_judge_in_one(const sim_judge_t *judge, uint32_t place, uint32_t count)
{
    uint32_t in_one = 0;
    for (uint32_t i = 0; i < count; i++) {
        in_one += sim_judge_sample(judge, place + i)->seen == 1 ? 1u : 0u;
    }
    return in_one;
}

static bool is_at(const sim_judge_t *judge, uint32_t place, reference_point_t point)
{
    const reference_point_t sent = sim_judge_sample(judge, place)->point;
    return sent.distance_mm == point.distance_mm && sent.angle_q6 == point.angle_q6 &&
           sent.intensity == point.intensity && sent.flag == point.flag;
}

static uint32_t oldest(const sim_judge_t *judge)
{
    return judge->sent > SIM_JUDGE_SAMPLES ? judge->sent - SIM_JUDGE_SAMPLES : 0;
}

/* The nearest such sample from `next` on; otherwise the nearest before it. */
static bool find(const sim_judge_t *judge, reference_point_t point, uint32_t *place)
{
    const uint32_t from = judge->next > oldest(judge) ? judge->next : oldest(judge);
    for (*place = from; *place < judge->sent; ++*place) {
        if (is_at(judge, *place, point)) {
            return true;
        }
    }
    for (*place = from; *place > oldest(judge);) {
        if (is_at(judge, --*place, point)) {
            return true;
        }
    }
    return false;
}

/* ---- A scan ---- */

static uint32_t turned_q6(uint16_t from, uint16_t to)
{
    return (to + ENCODE_FULL_TURN_Q6 - from) % ENCODE_FULL_TURN_Q6;
}

static void note_hole(sim_reading_t *reading, uint32_t missing, uint32_t wide_q6)
{
    reading->missing += missing;
    reading->widest_q6 = wide_q6 > reading->widest_q6 ? wide_q6 : reading->widest_q6;
}

/* All points of a scan are from one turn, with one exception. If the lidar began with a start
 * packet at any angle (section 9.8), nothing shows where turns begin until the next start packet.
 * Until then a scan is one turn from the first packet's angle on, and may have points of two. */
static unsigned lie_about_place(sim_judge_t *judge, const sim_reading_t *reading, uint32_t place)
{
    const sim_sample_t *const sample = sim_judge_sample(judge, place);
    const uint32_t turn = sim_judge_sample(judge, reading->first)->turn;
    if (sample->starts) {
        judge->begun_in_partial = sample->is_of_partial;
    }
    if (sample->turn != turn && !(judge->begun_in_partial && sample->turn == turn + 1)) {
        return SIM_LIE(SIM_LIE_MIXED);
    }
    return reading->points > 0 && place <= reading->last ? SIM_LIE(SIM_LIE_DISORDERED) : 0;
}

static void follow(sim_judge_t *judge, sim_reading_t *reading, uint32_t place)
{
    const sim_sample_t *const sample = sim_judge_sample(judge, place);
    if (reading->points == 0) {
        reading->first = place;
        note_hole(reading, sample->starts ? 0 : 1, sample->starts ? 0 : UINT32_MAX);
    }
    const unsigned lie = lie_about_place(judge, reading, place);
    const unsigned odd = SIM_LIE(SIM_LIE_MIXED) | SIM_LIE(SIM_LIE_DISORDERED);
    if (lie != 0 && (reading->lies & odd) == 0) {
        reading->before = reading->last;
        reading->odd = place;
    } else if (lie == 0 && reading->points > 0 && place > reading->last + 1) {
        note_hole(reading, place - reading->last - 1,
                  turned_q6(sim_judge_sample(judge, reading->last)->point.angle_q6,
                            sample->point.angle_q6));
    }
    reading->lies |= lie;
    reading->last = place;
    reading->points++;
}

void sim_read_point(sim_judge_t *judge, sim_reading_t *reading, reference_point_t point)
{
    uint32_t place;
    if (!find(judge, point, &place)) {
        reading->lies |= SIM_LIE(SIM_LIE_INVENTED);
        return;
    }
    if (sample_at(judge, place)->seen++ > 0) {
        reading->lies |= SIM_LIE(SIM_LIE_AGAIN);
    }
    follow(judge, reading, place);
    judge->next = place + 1;
}

/* The samples between the last point and the next start packet. */
static void read_rest(const sim_judge_t *judge, sim_reading_t *reading)
{
    const uint16_t angle_q6 = sim_judge_sample(judge, reading->last)->point.angle_q6;
    uint32_t place = reading->last + 1;
    while (place < judge->sent && !sim_judge_sample(judge, place)->starts) {
        place++;
    }
    if (place == judge->sent) {
        note_hole(reading, 1, UINT32_MAX);
    } else if (place > reading->last + 1) {
        note_hole(reading, place - reading->last - 1,
                  turned_q6(angle_q6, sim_judge_sample(judge, place)->point.angle_q6));
    }
}

unsigned sim_read_end(const sim_judge_t *judge, sim_reading_t *reading, bool complete,
                      unsigned gaps, unsigned dropped)
{
    const unsigned odd = SIM_LIE(SIM_LIE_MIXED) | SIM_LIE(SIM_LIE_INVENTED);
    if ((reading->lies & odd) != 0) {
        return reading->lies;
    }
    if (dropped == 0) {
        read_rest(judge, reading);
    }
    const bool lacks = reading->missing > 0;
    reading->is_hidden = lacks && !judge->is_guarded && reading->widest_q6 <= HIDDEN_Q6;
    if (complete && (dropped > 0 || (lacks && !reading->is_hidden))) {
        reading->lies |= SIM_LIE(SIM_LIE_COMPLETE);
    }
    /* From one start packet to the next the angle does not jump: if nothing else comes of a turn,
     * its scan has no gap and is not complete. */
    const bool is_told = gaps > 0 || dropped > 0 || (reading->points == 1 && !complete);
    if (lacks && !is_told && !reading->is_hidden) {
        reading->lies |= SIM_LIE(SIM_LIE_SILENT);
    }
    return reading->lies;
}

const char *sim_lie_name(sim_lie_t lie)
{
    static const char *const names[SIM_LIES] = {
        [SIM_LIE_INVENTED] = "scans with points never sent",
        [SIM_LIE_MIXED] = "scans of two revolutions",
        [SIM_LIE_DISORDERED] = "scans out of order",
        [SIM_LIE_AGAIN] = "scans with points of an earlier one",
        [SIM_LIE_COMPLETE] = "complete, but something is missing",
        [SIM_LIE_SILENT] = "something missing, but not reported"};
    return names[lie];
}

/* ---- Damage that cannot be seen ---- */

typedef struct {
    const sim_judge_t *judge;
    bool knows;
} question_t;

static bool was_sent(const sim_judge_t *judge, const reference_item_t *packet)
{
    uint32_t place;
    unsigned same = 0;
    if (!find(judge, reference_point(packet->bytes, 0), &place)) {
        return false;
    }
    while (same < packet->lsn && is_at(judge, place + same, reference_point(packet->bytes, same))) {
        same++;
    }
    return same == packet->lsn;
}

static void ask(void *context, const reference_item_t *item)
{
    question_t *const question = context;
    question->knows = question->knows && (!item->is_packet || was_sent(question->judge, item));
}

bool sim_judge_knows(const sim_judge_t *judge, const uint8_t *bytes, size_t count)
{
    const reference_options_t options = {.max_samples = 80};
    question_t question = {judge, true};
    (void)reference_decode(bytes, count, &options, ask, &question);
    return question.knows;
}
