/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_names.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* The index is the negated status. */
static const char *const status_names[] = {
    [-TMINI_OK] = "ok",
    [-TMINI_ERROR_ARGUMENT] = "invalid argument",
    [-TMINI_ERROR_STATE] = "not while scanning",
    [-TMINI_ERROR_TIMEOUT] = "timeout",
    [-TMINI_ERROR_WRITE] = "write failed",
    [-TMINI_ERROR_REPLY] = "unexpected reply",
    [-TMINI_ERROR_ABORTED] = "aborted",
    [-TMINI_ERROR_LISTEN_ONLY] = "listen only: nothing is sent",
};

static const char *const event_names[] = {
    [TMINI_EVENT_NONE] = "none",
    [TMINI_EVENT_STARTED] = "started",
    [TMINI_EVENT_STOPPED] = "stopped",
    [TMINI_EVENT_INFO] = "information",
    [TMINI_EVENT_HEALTH] = "health",
    [TMINI_EVENT_FREQUENCY] = "frequency",
    [TMINI_EVENT_REBOOTED] = "rebooted",
    [TMINI_EVENT_COMMAND_FAILED] = "command failed",
    [TMINI_EVENT_UNWANTED_SCANNING] = "unwanted scanning",
    [TMINI_EVENT_PAUSED] = "paused",
    [TMINI_EVENT_LOST] = "lost",
    [TMINI_EVENT_RECOVERED] = "recovered",
    [TMINI_EVENT_FAULTS_CHANGED] = "faults changed",
    [TMINI_EVENT_PACKET] = "packet",
    [TMINI_EVENT_SCAN] = "scan",
    [TMINI_EVENT_MORE] = "more to do",
};

static const char *const state_names[] = {
    [TMINI_STATE_UNKNOWN] = "unknown",
    [TMINI_STATE_IDLE] = "idle",
    [TMINI_STATE_BUSY] = "busy",
    [TMINI_STATE_STOPPING] = "stopping",
    [TMINI_STATE_STARTING] = "starting",
    [TMINI_STATE_SCANNING] = "scanning",
    [TMINI_STATE_RECOVERING] = "recovering",
};

/* The index is the number of the fault's bit. */
static const char *const fault_names[] = {
    "sensor", "encoder", "wireless power", "PD", "LD", "data", "frequency",
};

static const char *name_of(const char *const *names, size_t count, size_t index,
                           const char *otherwise)
{
    return index < count ? names[index] : otherwise;
}

const char *tmini_status_name(tmini_status_t status)
{
    /* A positive status becomes a very large index. */
    return name_of(status_names, COUNT(status_names), (size_t)0 - (size_t)status, "unknown status");
}

const char *tmini_event_name(tmini_event_t event)
{
    return name_of(event_names, COUNT(event_names), (size_t)event, "unknown event");
}

const char *tmini_state_name(tmini_state_t state)
{
    return name_of(state_names, COUNT(state_names), (size_t)state, "unknown state");
}

const char *tmini_fault_name(tmini_fault_t fault)
{
    for (size_t bit = 0; bit < COUNT(fault_names); bit++) {
        if ((unsigned)fault == 1u << bit) {
            return fault_names[bit];
        }
    }
    return "unknown fault";
}

/* Appends `word` at `length` as far as it fits, with room for the terminating 0; returns the
 * length. */
static size_t append_word(char *text, size_t size, size_t length, const char *word)
{
    while (*word != '\0' && length + 1 < size) {
        text[length++] = *word++;
    }
    return length;
}

const char *tmini_faults_text(uint8_t faults, char *text, size_t size)
{
    if (size == 0) {
        return text;
    }
    size_t length = 0;
    for (size_t bit = 0; bit < COUNT(fault_names); bit++) {
        if (((unsigned)faults >> bit & 1u) != 0) {
            length = append_word(text, size, length, length > 0 ? ", " : "");
            length = append_word(text, size, length, fault_names[bit]);
        }
    }
    text[length] = '\0';
    if (length == 0) {
        text[append_word(text, size, 0, "none")] = '\0';
    }
    return text;
}

void tmini_serial_text(const tmini_info_t *info, char text[TMINI_SERIAL_DIGITS + 1])
{
    for (unsigned i = 0; i < TMINI_SERIAL_DIGITS; i++) {
        text[i] = info->serial[i] <= 9 ? (char)('0' + info->serial[i]) : '?';
    }
    text[TMINI_SERIAL_DIGITS] = '\0';
}
