/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Conditions that each module's state meets between any two calls of its functions, whatever was
 * received. test/qa/proof shows that every function preserves them; the fuzzers and the soak test
 * check them after each call. Call these functions in the consumer's context. */

#ifndef INVARIANTS_H
#define INVARIANTS_H

#include <stdbool.h>

#include "tmini/tmini.h"

bool ring_is_sound(const tmini_ring_t *ring);

/* The parser and its ring. */
bool parser_is_sound(const tmini_parser_t *parser);

/* Of the packet that `frame` contains. */
bool packet_is_sound(const tmini_packet_t *packet, const tmini_frame_t *frame);

bool ct_is_sound(const tmini_ct_t *ct);

/* Of a builder that has been set up. */
bool builder_is_sound(const tmini_builder_t *builder);

/* The lidar and all its parts. Also true of a lidar that was not set up. */
bool lidar_is_sound(const tmini_t *lidar);

/* The bytes that the parser has counted and those still waiting, modulo 2^32. If every byte is
 * counted once, equal to the bytes stored or refused since init (with DMA: published). */
uint32_t parser_account(const tmini_parser_t *parser);

#endif
