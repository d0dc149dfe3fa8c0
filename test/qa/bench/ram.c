/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Objects as large as the types that users declare; compiled, and their sizes read. */

#include "tmini/tmini.h"

extern char ram_tmini_t[sizeof(tmini_t)];
extern char ram_tmini_ring_t[sizeof(tmini_ring_t)];
extern char ram_tmini_parser_t[sizeof(tmini_parser_t)];
extern char ram_tmini_packet_t[sizeof(tmini_packet_t)];
extern char ram_tmini_ct_t[sizeof(tmini_ct_t)];
extern char ram_tmini_scan_builder_t[sizeof(tmini_builder_t)];
extern char ram_tmini_point_t[sizeof(tmini_point_t)];

char ram_tmini_t[sizeof(tmini_t)];
char ram_tmini_ring_t[sizeof(tmini_ring_t)];
char ram_tmini_parser_t[sizeof(tmini_parser_t)];
char ram_tmini_packet_t[sizeof(tmini_packet_t)];
char ram_tmini_ct_t[sizeof(tmini_ct_t)];
char ram_tmini_scan_builder_t[sizeof(tmini_builder_t)];
char ram_tmini_point_t[sizeof(tmini_point_t)];
