/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_reply.h"

/* Most commands have the frequency as their reply: its query, and each of its steps (sections 3 and
 * 4). */
bool tmini_reply_header(tmini_command_code_t command, tmini_reply_header_t *header)
{
    if (command == TMINI_COMMAND_STOP || command == TMINI_COMMAND_REBOOT) {
        return false;
    }
    header->type = 0x04;
    header->mode = TMINI_REPLY_MODE_SINGLE;
    header->length = TMINI_FREQUENCY_SIZE;
    if (command == TMINI_COMMAND_START) {
        header->type = 0x81;
        header->mode = TMINI_REPLY_MODE_CONTINUOUS;
        header->length = 0;
    }
    if (command == TMINI_COMMAND_GET_INFO) {
        header->length = TMINI_INFO_SIZE;
    }
    if (command == TMINI_COMMAND_GET_HEALTH) {
        header->type = 0x06;
        header->length = TMINI_HEALTH_SIZE;
    }
    return true;
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
