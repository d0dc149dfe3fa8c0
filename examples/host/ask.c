/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "ask.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "points.h"
#include "tmini/parts/tmini_reply.h"
#include "tmini/tmini_names.h"

#define ALL_MS 3000u
#define LISTEN_MS 300u /* A lidar that streams sends a packet every 10 ms. */
#define AGAIN_MS 800u  /* A question is lost while the lidar boots. */
#define SLICE_MS 10

static uint32_t now_ms(void)
{
    return tmini_posix_port.now_ms(NULL);
}

static void await_info(asked_t *asked)
{
    (void)tmini_parser_await(&asked->decoder.parser, tmini_reply_header(TMINI_COMMAND_GET_INFO));
}

static void take_bytes(void *context, const uint8_t *bytes, size_t count)
{
    asked_t *const asked = context;
    (void)tmini_ring_write(&asked->ring, bytes, count);
}

static void open_port(asked_t *asked)
{
    if (users_find(asked->path, asked->users)[0] != '\0') {
        asked->state = ASK_HELD;
        return;
    }
    (void)tmini_ring_init(&asked->ring, asked->memory, sizeof asked->memory, false);
    (void)tmini_decoder_init(&asked->decoder, &asked->ring, 0);
    tmini_posix_init(&asked->port, asked->path);
    tmini_posix_tap(&asked->port, take_bytes, asked);
    asked->why_closed = tmini_posix_start(&asked->port, NULL);
    asked->state = asked->why_closed == TMINI_POSIX_OK     ? ASK_WAITING
                   : asked->why_closed == TMINI_POSIX_BUSY ? ASK_HELD
                                                           : ASK_CLOSED;
}

static void take_answer(asked_t *asked)
{
    uint8_t content[TMINI_INFO_SIZE];
    tmini_info_t info;
    (void)tmini_frame_content(tmini_parser_frame(&asked->decoder.parser), content, sizeof content);
    tmini_reply_info(content, &info);
    asked->model = info.model;
    tmini_serial_text(&info, asked->serial);
    asked->state = ASK_ANSWERED;
}

/* The stream has the serial number in the CT information of a whole turn (section 7). */
static void take_packet(asked_t *asked)
{
    tmini_ct_info_t info;
    const unsigned needed = TMINI_KNOWN_DAY | TMINI_KNOWN_SERIAL;
    (void)tmini_decoder_take(&asked->decoder, false, now_ms(), 0);
    tmini_ct_read(&asked->decoder.ct, &info);
    asked->state = ASK_STREAMS;
    if ((info.known & needed) == needed) {
        (void)snprintf(asked->serial, sizeof asked->serial, "%04u%02u%02u%08u",
                       (unsigned)info.year % 10000, (unsigned)info.month % 100,
                       (unsigned)info.day % 100, (unsigned)info.number % 100000000);
    }
}

static void receive(asked_t *asked)
{
    tmini_frame_type_t frame = TMINI_FRAME_NONE;
    (void)tmini_posix_wait(&asked->port, 0);
    while ((frame = tmini_decoder_next(&asked->decoder, 0)) != TMINI_FRAME_NONE) {
        if (frame == TMINI_FRAME_REPLY) {
            take_answer(asked);
        } else if (frame == TMINI_FRAME_PACKET) {
            take_packet(asked);
        }
    }
}

/* Only a port from which nothing comes is asked. */
static void question(asked_t *asked, uint32_t passed_ms)
{
    static const uint8_t command[2] = {TMINI_COMMAND_SYNC, TMINI_COMMAND_GET_INFO};
    if (asked->state == ASK_WAITING && passed_ms >= LISTEN_MS + asked->questions * AGAIN_MS &&
        (asked->questions > 0 || asked->port.received == 0)) {
        asked->questions++;
        await_info(asked);
        (void)tmini_posix_port.write(&asked->port, command, sizeof command);
    }
}

static bool is_open(const asked_t *asked)
{
    return asked->state == ASK_WAITING || (asked->state == ASK_STREAMS && asked->serial[0] == '\0');
}

void ask(asked_t *asked, size_t count)
{
    const uint32_t begun_ms = now_ms();
    bool is_any = true;
    for (size_t i = 0; i < count; i++) {
        if (asked[i].state == ASK_WAITING) {
            open_port(&asked[i]);
        }
    }
    while (is_any && now_ms() - begun_ms < ALL_MS) {
        is_any = false;
        for (size_t i = 0; i < count; i++) {
            if (is_open(&asked[i])) {
                receive(&asked[i]);
                question(&asked[i], now_ms() - begun_ms);
                is_any = is_any || is_open(&asked[i]);
            }
        }
        (void)poll(NULL, 0, is_any ? SLICE_MS : 0);
    }
    for (size_t i = 0; i < count; i++) {
        if (asked[i].path != NULL && asked[i].ring.size > 0) {
            tmini_posix_stop(&asked[i].port);
        }
    }
}

const char *ask_text(const asked_t *asked, char text[ASK_TEXT_SIZE])
{
    switch (asked->state) {
    case ASK_ANSWERED:
        (void)snprintf(text, ASK_TEXT_SIZE, "model %d (%s), serial %s", asked->model,
                       model_text(asked->model), asked->serial);
        break;
    case ASK_STREAMS:
        (void)snprintf(text, ASK_TEXT_SIZE, "a lidar that scans, not asked; serial %s",
                       asked->serial[0] != '\0' ? asked->serial : "unknown");
        break;
    case ASK_HELD:
        (void)snprintf(text, ASK_TEXT_SIZE, "not asked: %s",
                       asked->users[0] != '\0' ? asked->users : "another program uses it");
        break;
    case ASK_CLOSED:
        (void)snprintf(text, ASK_TEXT_SIZE, "not asked: %s",
                       tmini_posix_status_name(asked->why_closed));
        break;
    case ASK_LEFT_OUT:
        (void)snprintf(text, ASK_TEXT_SIZE, "not asked");
        break;
    case ASK_WAITING:
        (void)snprintf(text, ASK_TEXT_SIZE,
                       asked->questions > 0 ? "asked, no answer"
                                            : "not asked: bytes come that no T-mini Plus sends");
        break;
    }
    return text;
}
