/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Why a lidar gives no scans, or damaged ones: a table of causes, each with what it is recognised
 * by and with its words. Used by every command, live and on recordings. */

#ifndef CAUSES_H
#define CAUSES_H

#include "traits.h"

/* What has been observed. */
typedef struct {
    const char *path;
    bool is_file;           /* A recording. */
    bool is_socket;         /* tcp:HOST:PORT */
    bool listens;           /* Nothing was sent. */
    bool has_replied;       /* The lidar has answered a command. */
    uint64_t received;      /* Bytes. */
    uint64_t packets;       /* Valid ones. */
    unsigned per_second;    /* Bytes per second, while they came; 0: unknown. */
    bool is_damaged;        /* Bytes were lost or changed. */
    const char *users;      /* Who else uses the port, in words; "": unknown. */
    const traits_t *traits; /* Of the latest bytes. */
} facts_t;

typedef struct {
    const char *name;     /* The question that it answers, in one word. */
    const char *headline; /* For the verdict; NULL: the name is enough. */
    bool (*is)(const facts_t *facts);
    const char *text;   /* What was observed; {rate}, {users} and {excerpt} stand for facts. */
    const char *advice; /* What to do. */
    bool is_sign;       /* The bytes show it; others are what remains. */
} cause_t;

#define CAUSE_TEXT_SIZE 600

/* The first cause that fits; NULL: none. */
const cause_t *cause_find(const facts_t *facts);

/* Its words, in `text`. */
const char *cause_text(const cause_t *cause, const facts_t *facts, char text[CAUSE_TEXT_SIZE]);

#endif
