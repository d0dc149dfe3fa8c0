/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What is in a recording, in a few lines that a person reads. */

#ifndef SUMMARY_H
#define SUMMARY_H

#include <stdint.h>

#include "decoder.h"
#include "scan_list.h"
#include "tmini/tmini_turn.h"

typedef struct {
    scan_list_t *scans;
    tmini_turn_t turn;
    uint64_t guard_bytes;  /* LastCRC (section 7): one byte before a start packet. */
    uint64_t bytes_before; /* The first packet: the reply to the start command. */
    uint64_t
        bytes_until; /* The last packet so far: skipped bytes; after it the recording was cut. */
} summary_t;

/* Returns false if memory is short. Released by summary_free(). */
bool summary_init(summary_t *summary);
void summary_free(summary_t *summary);

/* Takes the decoder's latest packet. Returns false if memory is short. */
bool summary_add(summary_t *summary, const decoder_t *decoder);

/* The recording has ended: prints. Returns false if memory is short. */
bool summary_print(summary_t *summary, const decoder_t *decoder);

#endif
