/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini view of a recording, at the speed at which it was made. */

#define _POSIX_C_SOURCE 200809L

#include <poll.h>

#include "faults.h"
#include "message.h"
#include "recording.h"
#include "tmini/tmini_turn.h"
#include "tmini_posix.h"
#include "viewer.h"

#define SLICE_MS 10
#define SAMPLES_A_MS 4u /* Section 1. */

typedef struct {
    decoder_t decoder;
    tmini_scan_builder_t builder;
    tmini_point_t points[SCAN_CAPACITY];
    tmini_turn_t turn;
    uint64_t bytes_before; /* The first packet. */
    uint64_t bytes_until;  /* The latest packet: skipped bytes, */
    uint64_t guard_bytes;  /* of which LastCRC is none that was lost. */
    uint32_t begun_ms;
    bool is_at_end;
    char health[FAULTS_TEXT_SIZE];
} player_t;

static uint32_t now_ms(void)
{
    return tmini_posix_port.now_ms(NULL);
}

/* Takes the latest packet. Returns true if it completes a scan. */
static bool take(player_t *player, viewer_t *viewer)
{
    const tmini_packet_t *const packet = &player->decoder.packet;
    const bool is_scan = tmini_scan_close(&player->builder, packet);
    if (is_scan) {
        viewer_keep(viewer, &player->builder.scan);
        viewer->view.scans++;
    }
    player->guard_bytes += tmini_packet_is_start(packet) && packet->gap == 1 ? 1 : 0;
    player->bytes_until = decoder_bytes_skipped(&player->decoder);
    if (player->decoder.totals.packets == 1) {
        player->bytes_before = player->bytes_until;
    }
    (void)tmini_turn_add(&player->turn, packet);
    tmini_scan_add(&player->builder, packet, 0);
    return is_scan;
}

/* Plays what is due by now, up to the next scan. Returns true if there is something to show. */
static bool play(player_t *player, viewer_t *viewer)
{
    const uint64_t due = (uint64_t)(uint32_t)(now_ms() - player->begun_ms) * SAMPLES_A_MS;
    if (player->is_at_end) {
        return false;
    }
    while (player->decoder.totals.points <= due) {
        player->is_at_end = !decoder_next(&player->decoder);
        if (player->is_at_end || take(player, viewer)) {
            return true;
        }
    }
    return false;
}

static void tell(player_t *player, view_t *view)
{
    const decoder_totals_t *const totals = &player->decoder.totals;
    tmini_turn_info_t info;
    tmini_turn_info(&player->turn, &info);
    view->is_faulty = info.faults != 0;
    if ((info.known & TMINI_KNOWN_FAULTS) != 0) {
        view->health = faults_text(info.faults, player->health);
    }
    view->packets = totals->packets;
    view->checksum_errors = totals->checksum_errors;
    view->bytes_lost = player->bytes_until - player->bytes_before - player->guard_bytes;
    view->state = player->is_at_end ? "end of the recording" : "playing";
}

static int watch(const options_t *options, player_t *player)
{
    static viewer_t viewer;
    if (!viewer_open(&viewer, recording_base_name(options->operand))) {
        return STATUS_FAILED;
    }
    player->begun_ms = now_ms();
    (void)take(player, &viewer); /* The first packet. */
    while (!viewer.is_over) {
        const bool is_news = play(player, &viewer);
        tell(player, &viewer.view);
        viewer_attend(&viewer, is_news);
        (void)poll(NULL, 0, SLICE_MS);
    }
    viewer_close(&viewer);
    return viewer.has_memory ? STATUS_OK : STATUS_FAILED;
}

int view_recording(const options_t *options)
{
    static player_t player;
    FILE *const file = recording_open(options->operand);
    if (file == NULL) {
        return STATUS_FAILED;
    }
    decoder_init(&player.decoder, file, (uint8_t)options->max_samples);
    (void)tmini_scan_init(&player.builder, player.points, SCAN_CAPACITY, TMINI_FILTER_NONE);
    tmini_turn_init(&player.turn);
    /* What is no recording is told before the screen is taken over. */
    int status = STATUS_OK;
    if (decoder_next(&player.decoder)) {
        status = watch(options, &player);
    }
    if (status == STATUS_OK && (player.is_at_end || player.decoder.totals.packets == 0)) {
        status = recording_verdict(options->operand, &player.decoder);
    }
    recording_close(file);
    return status;
}
