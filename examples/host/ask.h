/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Asks several ports at once which lidar is there, with care: ports that a program holds are left
 * alone; each is listened to first; a lidar that streams is not asked; nothing but the question for
 * the information is sent. */

#ifndef ASK_H
#define ASK_H

#include "tmini/parts/tmini_decoder.h"
#include "tmini/tmini.h"
#include "tmini_posix.h"
#include "users.h"

typedef enum {
    ASK_WAITING,  /* To be asked; afterwards: it has not answered. */
    ASK_LEFT_OUT, /* Not to be asked. */
    ASK_HELD,     /* A program holds it. */
    ASK_CLOSED,   /* It cannot be opened. */
    ASK_STREAMS,  /* A lidar streams there; its serial number may be known from that. */
    ASK_ANSWERED,
} ask_state_t;

typedef struct {
    const char *path;
    ask_state_t state;
    uint8_t model;
    char serial[TMINI_SERIAL_DIGITS + 1]; /* "": unknown. */
    char users[USERS_TEXT_SIZE];
    tmini_posix_status_t why_closed;
    tmini_posix_t port;
    unsigned questions;
    tmini_ring_t ring;
    tmini_decoder_t decoder;
    uint8_t memory[2048];
} asked_t;

#define ASK_TEXT_SIZE 300

/* Asks the ports that are ASK_WAITING, for 3 s at most. */
void ask(asked_t *asked, size_t count);

/* What came of it, in words. */
const char *ask_text(const asked_t *asked, char text[ASK_TEXT_SIZE]);

#endif
