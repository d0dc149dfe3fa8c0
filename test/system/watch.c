/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "watch.h"

#include "bed.h"
#include "invariants.h"
#include "judge_scan.h"

#include <string.h>

const char *watch_name(unsigned wrong)
{
    static const char *const names[WRONG_KINDS] = {[WRONG_LOST_PACKET] = "packets lost",
                                                   [WRONG_BYTES] = "bytes not accounted for",
                                                   [WRONG_COMMAND] = "forbidden commands",
                                                   [WRONG_FALSE_FAULT] = "false faults",
                                                   [WRONG_MISSED_FAULT] = "missed faults",
                                                   [WRONG_ANSWER] = "wrong answers",
                                                   [WRONG_SLOW_RECOVERY] = "slow recoveries",
                                                   [WRONG_STATE] = "impossible states",
                                                   [WRONG_REMAINDER] =
                                                       "bytes still pending at the end",
                                                   [WRONG_COST] = "whole turns not complete"};
    return wrong < SIM_LIES ? sim_lie_name((sim_lie_t)wrong) : names[wrong];
}

void watch_complain(bed_t *bed, unsigned wrong)
{
    watch_t *const watch = bed->watch;
    watch->counts.wrongs[wrong]++;
    watch->wrong = watch->wrong != NULL ? watch->wrong : watch_name(wrong);
    bed_tell(bed, "WRONG: %s", watch_name(wrong));
}

/* ---- What was sent and has arrived ---- */

static watch_packet_t *packet_at(watch_t *watch, uint32_t place)
{
    return &watch->packets[(watch->first + place) % WATCH_PACKETS];
}

static void pop(watch_t *watch)
{
    watch->first++;
    watch->count--;
}

/* A start packet also ends the turn before it. */
static void touch(watch_t *watch, uint32_t turn, bool is_start)
{
    watch->turns[turn % WATCH_TURNS].is_touched = true;
    watch->turns[(turn - 1u) % WATCH_TURNS].is_touched |= is_start;
}

static void note_turn(watch_t *watch, const sim_packet_t *packet, bool is_touched)
{
    watch_turn_t *const turn = &watch->turns[packet->revolution % WATCH_TURNS];
    if (packet->starts_revolution) {
        *turn = (watch_turn_t){0};
    }
    turn->samples += packet->bytes[3];
    if (is_touched) {
        touch(watch, packet->revolution, packet->starts_revolution);
    }
}

void watch_lose(bed_t *bed, uint64_t from, uint64_t to)
{
    watch_t *const watch = bed->watch;
    watch->lost_to = to > watch->lost_to ? to : watch->lost_to;
    for (uint32_t i = 0; i < watch->count; i++) {
        watch_packet_t *const packet = packet_at(watch, i);
        if (packet->offset < to && packet->offset + packet->length > from) {
            packet->is_lost = true;
            touch(watch, packet->turn, packet->starts_revolution);
        }
    }
}

/* Its first bytes may have been lost by the receiver before its last ones come. */
static void note_packet(void *context, const sim_link_packet_t *packet)
{
    watch_t *const watch = context;
    const uint32_t place = sim_judge_sent(&watch->judge, &packet->sent);
    const bool is_lost = packet->intact && watch->lost_to > packet->offset;
    note_turn(watch, &packet->sent, !packet->intact || is_lost);
    if (!packet->intact) {
        return;
    }
    if (watch->count == WATCH_PACKETS) {
        pop(watch); /* The library does not scan. */
    }
    *packet_at(watch, watch->count++) =
        (watch_packet_t){.offset = packet->offset,
                         .length = packet->sent.length,
                         .starts_revolution = packet->sent.starts_revolution,
                         .is_lost = is_lost,
                         .turn = packet->sent.revolution,
                         .at_us = watch->link.sim->now_us,
                         .place = place,
                         .samples = packet->sent.bytes[3]};
}

void watch_begin(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const sim_link_observer_t observer = {
        .context = watch, .on_packet = note_packet, .loses = watch->loses};
    sim_judge_begin(&watch->judge);
    sim_link_init(&watch->link, &bed->sim, &watch->line);
    sim_link_observe(&watch->link, &observer);
}

void watch_restart(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    watch->begun_at = watch->arrived;
    watch->known_at_poll = 0;
    watch->silent_since_us = bed->now_us;
    watch->faults = 0;
    watch->in_trouble = false;
}

void watch_arrive(bed_t *bed, const uint8_t *bytes, size_t count)
{
    watch_t *const watch = bed->watch;
    for (size_t i = 0; i < count; i++) {
        watch->history[watch->arrived++ % WATCH_HISTORY] = bytes[i];
    }
}

/* The place on the line up to which the library has parsed, as packets, replies or skipped
 * bytes. */
static uint64_t parsed(const bed_t *bed)
{
    tmini_counters_t counters;
    tmini_counters(&bed->lidar, &counters);
    return bed->watch->begun_at + counters.bytes_in_packets + counters.bytes_in_replies +
           counters.bytes_skipped;
}

/* ---- Scans and packets ---- */

/* The latest bytes that have arrived, in a row; returns how many. */
static size_t latest_bytes(const watch_t *watch, uint8_t *bytes)
{
    const size_t count =
        watch->arrived < WATCH_HISTORY ? (size_t)watch->arrived : (size_t)WATCH_HISTORY;
    for (size_t i = 0; i < count; i++) {
        bytes[i] = watch->history[(watch->arrived - count + i) % WATCH_HISTORY];
    }
    return count;
}

/* Damage that leaves a checksum right cannot be seen. To look for it takes long: not for the tenth
 * lie of a kind. */
static void complain_unless_by_chance(bed_t *bed, sim_lie_t lie)
{
    static uint8_t bytes[WATCH_HISTORY];
    const size_t count = latest_bytes(bed->watch, bytes);
    if (bed->watch->counts.wrongs[lie] >= 10 || sim_judge_knows(&bed->watch->judge, bytes, count)) {
        watch_complain(bed, lie);
    } else {
        bed->watch->counts.by_chance++;
    }
}

typedef struct {
    size_t offset;
    bool is_found;
} search_t;

static void look_for_packet(void *context, const reference_item_t *item)
{
    search_t *const search = context;
    search->is_found |= item->is_packet && item->offset == search->offset;
}

/* It may have begun inside another packet that was valid by chance: then nobody finds it. */
static bool can_be_found(const bed_t *bed, const watch_packet_t *packet)
{
    static const reference_options_t options = {.max_samples = 80};
    static uint8_t bytes[WATCH_HISTORY];
    const size_t count = latest_bytes(bed->watch, bytes);
    search_t search = {(size_t)(packet->offset - (bed->watch->arrived - count)), false};
    (void)reference_decode(bytes, count, &options, look_for_packet, &search);
    return search.is_found;
}

static void complain_if_found(bed_t *bed, const watch_packet_t *packet)
{
    if (can_be_found(bed, packet)) {
        watch_complain(bed, WRONG_LOST_PACKET);
    } else {
        bed->watch->counts.by_chance++;
    }
}

static bool is_delivered(const watch_t *watch, const watch_packet_t *packet)
{
    return sim_judge_in_one(&watch->judge, packet->place, packet->samples) == packet->samples;
}

/* Whether the packet must have been delivered. Before the first start packet no packet is in a
 * scan. */
static bool is_due(bed_t *bed, const watch_packet_t *packet)
{
    watch_t *const watch = bed->watch;
    watch->has_begun |= packet->starts_revolution || bed->config.max_points == 0;
    watch->counts.split += packet->is_split ? 1u : 0u;
    return watch->has_begun && !packet->is_split && !packet->is_lost && !watch->may_lose;
}

/* Packets that end at `end` or before must have been delivered, or, if `is_judged` is false, need
 * not. */
static void settle(bed_t *bed, uint64_t end, bool is_judged)
{
    watch_t *const watch = bed->watch;
    while (!watch->is_trial && watch->count > 0 &&
           packet_at(watch, 0)->offset + packet_at(watch, 0)->length <= end) {
        const watch_packet_t *const packet = packet_at(watch, 0);
        pop(watch);
        if (is_judged && is_delivered(watch, packet)) {
            watch->has_begun = true;
            watch->counts.packets++;
        } else if (is_judged && is_due(bed, packet)) {
            complain_if_found(bed, packet);
        }
    }
}

/* The library did not receive. */
static void forget(bed_t *bed, uint64_t end)
{
    settle(bed, end, false);
    bed->watch->has_begun = false;
}

static void judge_lies(bed_t *bed, const sim_reading_t *reading)
{
    bed->watch->counts.points += reading->points;
    for (unsigned lie = 0; lie < SIM_LIES; lie++) {
        if ((reading->lies & SIM_LIE(lie)) != 0) {
            complain_unless_by_chance(bed, (sim_lie_t)lie);
        }
    }
}

static void check_packet(bed_t *bed)
{
    const tmini_packet_t *const packet = tmini_packet(&bed->lidar);
    sim_reading_t reading = {0};
    tmini_point_t point;
    for (unsigned i = 0; i < packet->count && tmini_packet_point(packet, i, &point); i++) {
        judge_point(&bed->watch->judge, &reading, &point);
    }
    judge_lies(bed, &reading);
}

static void check_scan(bed_t *bed)
{
    const tmini_scan_t *const scan = tmini_scan(&bed->lidar);
    const unsigned closing = TMINI_PACKET_SIZE(tmini_packet(&bed->lidar)->count);
    sim_reading_t reading = judge_scan(&bed->watch->judge, scan);
    if (bed->watch->on_scan != NULL) {
        bed->watch->on_scan(bed, &reading);
    }
    judge_lies(bed, &reading);
    settle(bed, parsed(bed) - closing, scan->dropped == 0);
    bed->watch->has_begun = true;
}

/* ---- Faults and recoveries ---- */

static void check_faults(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const uint8_t faults = tmini_faults(&bed->lidar);
    const uint64_t since_us = bed->now_us - WATCH_FAULT_MS * 1000u;
    for (unsigned bit = 0; bit < 8; bit++) {
        const bool now = (faults >> bit & 1u) != 0;
        const bool before = (watch->faults >> bit & 1u) != 0;
        const uint64_t seen_us = now ? watch->fault_on_us[bit] : watch->fault_off_us[bit];
        if (now != before && bed->now_us > WATCH_FAULT_MS * 1000u && seen_us < since_us) {
            watch_complain(bed, WRONG_FALSE_FAULT);
        }
    }
    watch->faults = faults;
}

static void check_recovery(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const uint64_t taken_us = bed->now_us - watch->trouble_us;
    if (!watch->in_trouble) {
        return;
    }
    watch->in_trouble = false;
    watch->counts.recoveries++;
    if (bed->now_us > watch->trouble_us && taken_us / 1000u > watch->counts.worst_recovery_ms) {
        watch->counts.worst_recovery_ms = (uint32_t)(taken_us / 1000u);
    }
}

static void note_faults(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    uint8_t faults = sim_health(&bed->sim);
    /* The library may then report a data fault (section 8), even if the lidar's health does not. */
    if (bed->sim.window_covered || bed->sim.rotor_blocked) {
        faults |= SIM_HEALTH_DATA;
    }
    watch->fault_on_us[6] = bed->now_us; /* TMINI_FAULT_FREQUENCY: not judged here. */
    for (unsigned bit = 0; bit < 8; bit++) {
        if ((faults >> bit & 1u) != 0) {
            watch->fault_on_us[bit] = bed->now_us;
        }
        if ((sim_health(&bed->sim) >> bit & 1u) == 0) {
            watch->fault_off_us[bit] = bed->now_us;
        }
    }
}

/* Trouble after a power failure also includes the time in which the lidar boots. */
static void note_trouble(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const uint64_t sound_us = sim_sound_us(&bed->sim);
    const bool is_faulty = sim_link_is_faulty(&watch->link) || sound_us == SIM_NEVER;
    if (sim_mode(&bed->sim) == SIM_OFF) {
        watch->trouble_us = bed->now_us + bed->sim.config.boot_ms * 1000u;
    } else if (is_faulty && watch->trouble_us < bed->now_us) {
        watch->trouble_us = bed->now_us;
    } else if (!is_faulty && watch->trouble_us < sound_us) {
        watch->trouble_us = sound_us;
    }
    if (tmini_state(&bed->lidar) != TMINI_STATE_RECOVERING) {
        watch->in_trouble = false; /* The program has stopped it. */
    }
    if (watch->in_trouble && bed->config.recovery == TMINI_RECOVERY_ON &&
        !bed->config.listen_only && bed->now_us > watch->trouble_us &&
        bed->now_us - watch->trouble_us > WATCH_RECOVERY_MS * 1000u) {
        watch->in_trouble = false;
        watch_complain(bed, WRONG_SLOW_RECOVERY);
    }
}

void watch_step(bed_t *bed)
{
    note_faults(bed);
    note_trouble(bed);
}

bool watch_is_undisturbed_since(const bed_t *bed, uint64_t since_us)
{
    const watch_t *const watch = bed->watch;
    return !sim_link_is_faulty(&watch->link) && watch->trouble_us < since_us &&
           watch->link.last_fault_us < since_us;
}

/* ---- A round of polls ---- */

/* After so long a silence the library gives up a packet that has not come whole. */
static void note_silence(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const uint64_t silence_us = (bed->timing.frame_timeout_ms - 1u) * 1000u;
    const uint64_t end = watch->begun_at + bed->known;
    if (bed->known != watch->known_at_poll) {
        watch->known_at_poll = bed->known;
        watch->silent_since_us = bed->now_us;
    } else if (bed->now_us - watch->silent_since_us >= silence_us) {
        for (uint32_t i = 0; i < watch->count; i++) {
            watch_packet_t *const packet = packet_at(watch, i);
            packet->is_split |= packet->offset < end && packet->offset + packet->length > end;
        }
    }
}

static void check_state(bed_t *bed)
{
    if (!lidar_is_sound(&bed->lidar)) {
        watch_complain(bed, WRONG_STATE);
    }
}

void watch_before_polls(bed_t *bed)
{
    note_silence(bed);
    check_state(bed); /* Commands and fed bytes may have changed it. */
    bed->watch->was_scanning = tmini_state(&bed->lidar) == TMINI_STATE_SCANNING;
}

void watch_event(bed_t *bed, tmini_event_t event)
{
    check_state(bed);
    switch (event) {
    case TMINI_EVENT_LOST:
        bed->watch->in_trouble = true;
        break;
    case TMINI_EVENT_RECOVERED:
        check_recovery(bed);
        forget(bed, parsed(bed) - 1);
        break;
    case TMINI_EVENT_STARTED:
        forget(bed, parsed(bed) - 1);
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        check_faults(bed);
        break;
    case TMINI_EVENT_PACKET:
        check_packet(bed);
        break;
    case TMINI_EVENT_SCAN:
        check_scan(bed);
        break;
    default:
        break;
    }
}

static void check_bytes(bed_t *bed)
{
    tmini_counters_t counters;
    tmini_counters(&bed->lidar, &counters);
    if (bed->known != bed->known_at_poll) {
        return; /* Some came during the latest poll. */
    }
    if (parsed(bed) - bed->watch->begun_at + counters.bytes_overrun + counters.bytes_pending !=
            bed->known ||
        (counters.bytes_overrun > 0 && !bed->watch->may_lose)) {
        watch_complain(bed, WRONG_BYTES);
    }
}

/* A missed packet is wrong if the library was scanning. */
void watch_after_polls(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const bool is_scanning = tmini_state(&bed->lidar) == TMINI_STATE_SCANNING;
    check_bytes(bed);
    if (!is_scanning) {
        forget(bed, parsed(bed));
    } else if (bed->config.max_points == 0 && watch->was_scanning) {
        settle(bed, parsed(bed), true);
    }
    if (bed->sim.counts.commands_while_scanning > watch->counts.wrongs[WRONG_COMMAND]) {
        watch_complain(bed, WRONG_COMMAND);
    }
}

/* ---- The end of a trial ---- */

/* Each point of a packet without losses after the first such start packet must be in exactly one
 * scan, unless the library counts it as withheld. The current, unfinished scan counts as one. */
watch_end_t watch_end(bed_t *bed)
{
    watch_t *const watch = bed->watch;
    const tmini_builder_t *const builder = &bed->lidar.decoder.builder;
    watch_end_t end = {0};
    tmini_counters_t counters;
    bool has_begun = false;
    tmini_counters(&bed->lidar, &counters);
    if (counters.bytes_pending > 0) {
        watch_complain(bed, WRONG_REMAINDER);
    }
    if (builder->open) {
        sim_reading_t reading = judge_points(&watch->judge, &builder->scan);
        reading.lies &= SIM_LIE(SIM_LIE_AGAIN);
        judge_lies(bed, &reading);
    }
    for (uint32_t i = 0; i < watch->count; i++) {
        const watch_packet_t *const packet = packet_at(watch, i);
        has_begun |= packet->starts_revolution && !packet->is_lost;
        if (has_begun && !packet->is_lost) {
            const uint32_t in_one = sim_judge_in_one(&watch->judge, packet->place, packet->samples);
            if (in_one < packet->samples && counters.points_withheld == 0 &&
                !can_be_found(bed, packet)) {
                watch->counts.by_chance++;
                continue;
            }
            end.intact += packet->samples;
            end.in_one += in_one;
            if (in_one < packet->samples) {
                bed_tell(bed, "not in one scan: packet of turn %u, come at %u ms", packet->turn,
                         (unsigned)(packet->at_us / 1000u));
            }
        }
    }
    return end;
}
