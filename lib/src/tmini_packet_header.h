/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Where the fields of a scan packet's header lie after the start sign (section 5). */

#ifndef TMINI_PACKET_HEADER_H
#define TMINI_PACKET_HEADER_H

enum { CT = 0, LSN = 1, FSA = 2, LSA = 4 };

#endif
