/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_reply.h"

/* How the replies begin (sections 3 and 4). */
enum { FREQUENCY_REPLY, PACKETS_REPLY, INFO_REPLY, HEALTH_REPLY };
static const tmini_reply_header_t headers[] = {
    [FREQUENCY_REPLY] = {.type = 0x04,
                         .mode = TMINI_REPLY_MODE_SINGLE,
                         .length = TMINI_FREQUENCY_SIZE},
    [PACKETS_REPLY] = {.type = 0x81, .mode = TMINI_REPLY_MODE_CONTINUOUS, .length = 0},
    [INFO_REPLY] = {.type = 0x04, .mode = TMINI_REPLY_MODE_SINGLE, .length = TMINI_INFO_SIZE},
    [HEALTH_REPLY] = {.type = 0x06, .mode = TMINI_REPLY_MODE_SINGLE, .length = TMINI_HEALTH_SIZE},
};

/* Most commands have the frequency as their reply: its query, and each of its steps. */
const tmini_reply_header_t *tmini_reply_header(tmini_command_code_t command)
{
    size_t reply = FREQUENCY_REPLY;
    if (command == TMINI_COMMAND_STOP || command == TMINI_COMMAND_REBOOT) {
        return NULL;
    }
    if (command == TMINI_COMMAND_START) {
        reply = PACKETS_REPLY;
    }
    if (command == TMINI_COMMAND_GET_INFO) {
        reply = INFO_REPLY;
    }
    if (command == TMINI_COMMAND_GET_HEALTH) {
        reply = HEALTH_REPLY;
    }
    return &headers[reply];
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
