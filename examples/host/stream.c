/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stream.h"

#include <string.h>

/* The size of a full packet (section 9.6), to convert damaged bytes to packets. */
#define PACKET_SIZE 130u

/* After this long without a packet any number of turns may be missing, whatever the angles are,
 * because no computer delays bytes for so long. (With a live lidar the driver decides this, and
 * reports it by the packet's gap.) */
#define PAUSE_MS 1000u

/* After a pause the driver may doubt several packets in a row. The first one begins a new scan; the
 * others get this gap, which only makes their scan incomplete. 1 would be LastCRC. */
#define MORE_DOUBT 2u

void stream_init(stream_t *stream, const tmini_mount_t *mount)
{
    memset(stream, 0, sizeof *stream);
    stream->mount = mount;
    stream->spare = stream->points_of[1];
    (void)tmini_builder_init(&stream->decoder.builder, stream->points_of[0], STREAM_POINTS_MAX,
                             TMINI_FILTER_NONE);
}

/* The next scan is built in the spare buffer. A scan may have begun slightly before the time 0. */
static void keep_scan(stream_t *stream)
{
    tmini_builder_t *const builder = &stream->decoder.builder;
    stream->scan = builder->scan;
    if (stream->scan.start_ms > stream->scan.end_ms) {
        stream->scan.start_ms = 0;
    }
    tmini_builder_use(builder, stream->spare);
    stream->spare = stream->scan.points;
    tmini_mount_step(stream->mount, &stream->scan);
    stream->number = stream->start_packets;
    stream->has_scan = true;
    stream->scans++;
    stream->complete += stream->scan.complete ? 1 : 0;
}

/* One byte before a start packet is LastCRC. A pause is no damage, and neither are the bytes before
 * the first packet: they are the reply to the start command. */
static void count_gap(stream_t *stream, const tmini_packet_t *packet)
{
    if (tmini_packet_is_start(packet) && packet->gap == 1) {
        stream->last_crc_bytes++;
    } else if (packet->gap > 0 && packet->gap != TMINI_GAP_UNKNOWN && stream->packets > 0 &&
               !stream->is_broken) {
        const unsigned packets = (packet->gap + PACKET_SIZE / 2) / PACKET_SIZE;
        stream->stray_bytes += packet->gap;
        stream->damaged += packets > 0 ? packets : 1;
    }
}

static void count(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    count_gap(stream, packet);
    stream->is_broken = false;
    stream->packet_ms = now_ms;
    stream->packets++;
    stream->points += packet->count;
    if (tmini_packet_is_start(packet)) {
        stream->start_packets++;
        stream->frequency_chz = packet->ct / 2u * 10u; /* Section 7. */
    }
    stream->points_before += stream->start_packets == 0 ? packet->count : 0;
}

/* The packet, with the gap that the scan builder needs. */
static tmini_packet_t judge_gap(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    const bool is_in_doubt = packet->gap != packet->frame->gap;
    tmini_packet_t judged = *packet;
    if (is_in_doubt && stream->is_in_doubt) {
        judged.gap = MORE_DOUBT;
    }
    if (stream->packets > 0 && now_ms - stream->packet_ms > PAUSE_MS) {
        judged.gap = TMINI_GAP_UNKNOWN;
    }
    stream->is_in_doubt = is_in_doubt;
    return judged;
}

/* When the packet was sent, about: its samples took 250 us each (section 1), and a millisecond more
 * lets the time catch up. */
static uint32_t sent_ms(const stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    const uint32_t due_ms = stream->sent_ms + packet->count / 4u + 1u;
    const uint32_t late_ms = now_ms - due_ms; /* Large if it comes early: unsigned. */
    const bool is_late = stream->is_late && stream->packets > 0 && late_ms <= PAUSE_MS;
    return is_late ? due_ms : now_ms;
}

bool stream_take(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms)
{
    tmini_builder_t *const builder = &stream->decoder.builder;
    const tmini_packet_t judged = judge_gap(stream, packet, now_ms);
    const uint32_t came_ms = sent_ms(stream, packet, now_ms);
    stream->sent_ms = came_ms;
    stream->has_scan = false;
    if (tmini_decoder_take_packet(&stream->decoder, &judged, came_ms)) {
        if (builder->scan.packets > 1 || judged.gap != TMINI_GAP_UNKNOWN) {
            keep_scan(stream); /* A start packet and then a pause is no scan. */
        }
        (void)tmini_builder_add(builder, &judged, came_ms);
    }
    stream->confirmed += stream->decoder.verdict == TMINI_CT_CONFIRMED ? 1 : 0;
    count(stream, packet, now_ms);
    return stream->has_scan;
}

bool stream_end(stream_t *stream)
{
    stream->has_scan = false;
    if (stream->decoder.builder.open) {
        stream->decoder.builder.open = false;
        keep_scan(stream);
    }
    return stream->has_scan;
}

void stream_break(stream_t *stream)
{
    tmini_decoder_restart(&stream->decoder);
    stream->is_broken = true;
}

unsigned stream_faults(const stream_t *stream)
{
    return tmini_ct_faults(&stream->decoder.ct);
}

unsigned stream_damaged_permille(const stream_t *stream)
{
    const count_t all = stream->packets + stream->damaged;
    return all == 0 ? 0 : (unsigned)((stream->damaged * 1000 + all / 2) / all);
}

bool stream_reports_nothing(const stream_t *stream)
{
    return stream->confirmed == 0 && stream->complete > 0 && stream->last_crc_bytes == 0;
}
