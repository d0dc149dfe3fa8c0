/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "proof.h"

bool same_expectations(const tmini_parser_t *before, const tmini_parser_t *after)
{
    return after->frame.ring == before->frame.ring && after->max_samples == before->max_samples &&
           after->awaited.type == before->awaited.type &&
           after->awaited.mode == before->awaited.mode &&
           after->awaited.length == before->awaited.length;
}

static bool is_packet(const tmini_parser_t *parser)
{
    const tmini_frame_t *const frame = &parser->frame;
    const uint8_t samples = frame->header[1];
    return frame->size == TMINI_PACKET_SIZE(samples) && samples >= 1 &&
           samples <= parser->max_samples && (samples == 1 || (frame->header[0] & 1u) == 0) &&
           (frame->header[2] & frame->header[4] & 1u) != 0;
}

bool next_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after,
                         tmini_frame_type_t type)
{
    if (!parser_is_sound(after) || !same_expectations(before, after)) {
        return false;
    }
    switch (type) {
    case TMINI_FRAME_PACKET:
        return after->awaiting == before->awaiting && is_packet(after);
    case TMINI_FRAME_REPLY:
        return before->awaiting && !after->awaiting &&
               after->frame.size == TMINI_REPLY_HEADER_SIZE + after->awaited.length;
    case TMINI_FRAME_NONE:
    case TMINI_FRAME_MORE:
        return after->awaiting == before->awaiting && after->frame.size == 0;
    default:
        return false;
    }
}

bool skip_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after)
{
    return parser_is_sound(after) && same_expectations(before, after) &&
           after->awaiting == before->awaiting && after->frame.size == 0;
}
