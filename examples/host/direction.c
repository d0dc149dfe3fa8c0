/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "direction.h"

#include "tmini/tmini_packet.h"

#define EIGHTH_Q6 (TMINI_TURN_Q6 / 8)

const char *direction_name(uint16_t angle_q6)
{
    static const char *const names[8] = {
        "ahead",  "ahead to the right", "right", "behind to the right",
        "behind", "behind to the left", "left",  "ahead to the left",
    };
    return names[(angle_q6 + EIGHTH_Q6 / 2) / EIGHTH_Q6 % 8];
}
