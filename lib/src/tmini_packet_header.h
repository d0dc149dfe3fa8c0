/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Where the fields of a scan packet's header lie (section 5). */

#ifndef TMINI_PACKET_HEADER_H
#define TMINI_PACKET_HEADER_H

enum { CT = 2, LSN = 3, FSA = 4, LSA = 6 };

#endif
