/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_reply.h"

/* How the replies begin (sections 3 and 4). */
typedef struct {
    uint8_t command;
    tmini_reply_header_t header;
} reply_t;

static const reply_t replies[] = {
    {TMINI_COMMAND_GET_FREQUENCY,
     {.type = 0x04, .mode = TMINI_REPLY_MODE_SINGLE, .length = TMINI_FREQUENCY_SIZE}},
    {TMINI_COMMAND_START, {.type = 0x81, .mode = TMINI_REPLY_MODE_CONTINUOUS, .length = 0}},
    {TMINI_COMMAND_GET_INFO,
     {.type = 0x04, .mode = TMINI_REPLY_MODE_SINGLE, .length = TMINI_INFO_SIZE}},
    {TMINI_COMMAND_GET_HEALTH,
     {.type = 0x06, .mode = TMINI_REPLY_MODE_SINGLE, .length = TMINI_HEALTH_SIZE}},
};

const tmini_reply_header_t *tmini_reply_header(tmini_command_code_t command)
{
    const reply_t *const end = &replies[sizeof replies / sizeof replies[0]];
    if (command < TMINI_COMMAND_GET_FREQUENCY) { /* A step: it has the same reply. */
        command = TMINI_COMMAND_GET_FREQUENCY;
    }
    for (const reply_t *reply = replies; reply != end; reply++) {
        if (reply->command == command) {
            return &reply->header;
        }
    }
    return NULL;
}

typedef char information_is_sent_as_it_is_kept[sizeof(tmini_info_t) == TMINI_INFO_SIZE ? 1 : -1];

void tmini_reply_info(const uint8_t content[TMINI_INFO_SIZE], tmini_info_t *info)
{
    TMINI_COPY(info, content, TMINI_INFO_SIZE);
}

void tmini_reply_health(const uint8_t content[TMINI_HEALTH_SIZE], tmini_health_t *health)
{
    health->faults = content[0] & TMINI_FAULT_MASK;
    health->error_code = (uint16_t)(content[1] | (unsigned)content[2] << 8);
}
