/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What is true of each module's state between any two calls of its functions, whatever was
 * received. test/qa/proof shows that every function keeps it; fuzzers and soak ask
 * after each call. To be asked in the consumer's context. */

#ifndef INVARIANTS_H
#define INVARIANTS_H

#include <stdbool.h>

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

bool ring_is_sound(const tmini_ring_t *ring);

/* And its ring. */
bool parser_is_sound(const tmini_parser_t *parser);

/* Of the packet that `frame` is. */
bool packet_is_sound(const tmini_packet_t *packet, const tmini_frame_t *frame);

bool ct_is_sound(const tmini_ct_t *ct);

/* Of a builder that has been set up. */
bool builder_is_sound(const tmini_builder_t *builder);

/* And all that it consists of. True as well of a lidar that was not set up. */
bool lidar_is_sound(const tmini_t *lidar);

/* Every byte is in exactly one place, modulo 2^32: what the parser has counted, and what waits.
 * Equal to the bytes stored or refused since init, and with DMA to those published. */
uint32_t parser_account(const tmini_parser_t *parser);

#ifdef __cplusplus
}
#endif

#endif
