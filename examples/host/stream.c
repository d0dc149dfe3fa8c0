/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stream.h"

#include <string.h>

/* A full packet (section 9.6), by which damaged bytes are counted as packets. */
#define PACKET_SIZE 130u

/* After this long without a packet any number of turns may be missing, whatever the angles say: no
 * computer holds that many bytes back. (Live, the driver knows better, and says so by the packet's
 * gap.) */
#define PAUSE_MS 1000u

/* After a pause the driver may doubt a whole batch of packets: the first one begins a scan of its
 * own, the others only make theirs incomplete. Some bytes, but not the one of LastCRC. */
#define MORE_DOUBT 2u

void stream_init(stream_t *stream, const tmini_mount_t *mount)
{
    *stream = (stream_t){.faults = TMINI_FAULTS_UNKNOWN, .mount = mount};
    tmini_ct_init(&stream->ct);
    (void)tmini_builder_init(&stream->builder, stream->building, STREAM_POINTS_MAX,
                             TMINI_FILTER_NONE);
}

static void keep(stream_t *stream)
{
    stream->scan = stream->builder.scan;
    memcpy(stream->kept, stream->scan.points, stream->scan.count * sizeof *stream->kept);
    stream->scan.points = stream->kept;
    tmini_mount_step(stream->mount, &stream->scan);
    stream->number = stream->open_number;
    stream->is_open = false;
    stream->has_scan = true;
    stream->scans++;
    stream->complete += stream->scan.complete ? 1 : 0;
}

/* One byte before a start packet is LastCRC. A pause is no damage, nor is what precedes the first
 * packet: the reply to the start command. */
static void count_gap(stream_t *stream, const tmini_packet_t *packet)
{
    if (tmini_packet_is_start(packet) && packet->gap == 1) {
        stream->guard_bytes++;
    } else if (packet->gap > 0 && packet->gap != TMINI_GAP_UNKNOWN && stream->packets > 0) {
        const unsigned packets = (packet->gap + PACKET_SIZE / 2) / PACKET_SIZE;
        stream->stray_bytes += packet->gap;
        stream->damaged += packets > 0 ? packets : 1;
    }
}

static void count(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    const uint32_t pause_ms = now_ms - stream->packet_ms;
    count_gap(stream, packet);
    stream->longest_ms =
        stream->packets > 0 && pause_ms > stream->longest_ms ? pause_ms : stream->longest_ms;
    stream->packet_ms = now_ms;
    stream->packets++;
    stream->points += packet->count;
    if (tmini_packet_is_start(packet)) {
        stream->start_packets++;
        stream->frequency_chz = packet->ct / 2u * 10u; /* Section 7. */
    }
    stream->points_before += stream->start_packets == 0 ? packet->count : 0;
}

bool stream_take(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    tmini_packet_t taken = *packet;
    if (stream->packets > 0 && now_ms - stream->packet_ms > PAUSE_MS) {
        taken.gap = TMINI_GAP_UNKNOWN;
    }
    if (taken.gap == TMINI_GAP_UNKNOWN && stream->is_in_doubt) {
        taken.gap = MORE_DOUBT;
    }
    stream->is_in_doubt = packet->gap == TMINI_GAP_UNKNOWN;
    stream->has_scan = false;
    const tmini_ct_verdict_t verdict = tmini_ct_add(&stream->ct, &taken);
    stream->confirmed += verdict == TMINI_CT_CONFIRMED ? 1 : 0;
    stream->faults = tmini_ct_faults(&stream->ct);
    count(stream, packet, now_ms);
    if (verdict == TMINI_CT_REFUTED) {
        tmini_builder_refute(&stream->builder);
    }
    if (tmini_builder_add(&stream->builder, &taken, now_ms)) {
        if (stream->builder.scan.packets > 1 || taken.gap != TMINI_GAP_UNKNOWN) {
            keep(stream); /* A start packet and then a pause is no scan. */
        }
        (void)tmini_builder_add(&stream->builder, &taken, now_ms);
    }
    stream->is_open = stream->builder.open;
    stream->open_number = stream->start_packets;
    return stream->has_scan;
}

bool stream_end(stream_t *stream)
{
    stream->has_scan = false;
    if (stream->is_open) {
        keep(stream);
    }
    return stream->has_scan;
}

void stream_break(stream_t *stream)
{
    tmini_builder_discard(&stream->builder);
    tmini_ct_discard(&stream->ct);
    stream->is_open = false;
}

unsigned stream_damaged_permille(const stream_t *stream)
{
    const count_t all = stream->packets + stream->damaged;
    return all == 0 ? 0 : (unsigned)((stream->damaged * 1000 + all / 2) / all);
}

bool stream_tells_nothing(const stream_t *stream)
{
    return stream->confirmed == 0 && stream->complete > 0 && stream->guard_bytes == 0;
}
