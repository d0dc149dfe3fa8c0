/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For the page: the library's constants by name, and the library's texts. */

#include "web.h"

#include "tape.h"
#include "tmini/tmini.h"
#include "tmini/tmini_names.h"

EXPORTED uint32_t constants(void)
{
    numbers_clear();
    numbers_put("OK", TMINI_OK);
    numbers_put("EVENT_NONE", TMINI_EVENT_NONE);
    numbers_put("EVENT_STARTED", TMINI_EVENT_STARTED);
    numbers_put("EVENT_STOPPED", TMINI_EVENT_STOPPED);
    numbers_put("EVENT_INFO", TMINI_EVENT_INFO);
    numbers_put("EVENT_HEALTH", TMINI_EVENT_HEALTH);
    numbers_put("EVENT_FREQUENCY", TMINI_EVENT_FREQUENCY);
    numbers_put("EVENT_REBOOTED", TMINI_EVENT_REBOOTED);
    numbers_put("EVENT_COMMAND_FAILED", TMINI_EVENT_COMMAND_FAILED);
    numbers_put("EVENT_STREAMING", TMINI_EVENT_UNWANTED_SCANNING);
    numbers_put("EVENT_LOST", TMINI_EVENT_LOST);
    numbers_put("EVENT_RECOVERED", TMINI_EVENT_RECOVERED);
    numbers_put("EVENT_FAULTS_CHANGED", TMINI_EVENT_FAULTS_CHANGED);
    numbers_put("EVENT_SCAN", TMINI_EVENT_SCAN);
    numbers_put("EVENT_MORE", TMINI_EVENT_MORE);
    numbers_put("STATE_IDLE", TMINI_STATE_IDLE);
    numbers_put("STATE_STARTING", TMINI_STATE_STARTING);
    numbers_put("STATE_SCANNING", TMINI_STATE_SCANNING);
    numbers_put("STATE_RECOVERING", TMINI_STATE_RECOVERING);
    numbers_put("FLAG_SPECULAR", TMINI_FLAG_SPECULAR);
    numbers_put("FLAG_AMBIENT", TMINI_FLAG_AMBIENT);
    numbers_put("FAULT_ENCODER", TMINI_FAULT_ENCODER);
    numbers_put("FAULT_MASK", TMINI_FAULT_MASK);
    numbers_put("FAULTS_UNKNOWN", TMINI_FAULTS_UNKNOWN);
    numbers_put("KNOWN_USER_VERSION", TMINI_KNOWN_USER_VERSION);
    numbers_put("KNOWN_FAULTS", TMINI_KNOWN_FAULTS);
    numbers_put("KNOWN_HARDWARE", TMINI_KNOWN_HARDWARE);
    numbers_put("KNOWN_FIRMWARE", TMINI_KNOWN_FIRMWARE);
    numbers_put("KNOWN_SERIAL", TMINI_KNOWN_SERIAL);
    numbers_put("FULL_CIRCLE_Q6", TMINI_FULL_CIRCLE_Q6);
    numbers_put("FREQUENCY_MIN_CHZ", TMINI_FREQUENCY_MIN_CHZ);
    numbers_put("FREQUENCY_MAX_CHZ", TMINI_FREQUENCY_MAX_CHZ);
    numbers_put("FREQUENCY_STEP_CHZ", TMINI_FREQUENCY_STEP_CHZ);
    numbers_put("MODEL_T_MINI_PRO", TMINI_MODEL_T_MINI_PRO);
    numbers_put("MODEL_T_MINI_PLUS", TMINI_MODEL_T_MINI_PLUS);
    numbers_put("ERROR_ABORTED", (uint32_t)TMINI_ERROR_ABORTED);
    numbers_put("TAPE_NEEDS_BYTES", TAPE_NEEDS_BYTES);
    numbers_put("TAPE_SCAN", TAPE_SCAN);
    numbers_put("TAPE_END", TAPE_END);
    numbers_put("NETWORK_GAP", NETWORK_GAP);
    numbers_put("CHUNK_MAGIC_SIZE", CHUNK_MAGIC_SIZE);
    numbers_put("CHUNK_HEAD_SIZE", CHUNK_HEAD_SIZE);
    numbers_put("CHUNK_MAX", CHUNK_MAX);
    numbers_put("CHUNK_VERSION", CHUNK_VERSION);
    return numbers_count();
}

EXPORTED const char *status_name(int status)
{
    return tmini_status_name((tmini_status_t)status);
}

EXPORTED const char *event_name(uint32_t event)
{
    return tmini_event_name((tmini_event_t)event);
}

EXPORTED const char *state_name(uint32_t state)
{
    return tmini_state_name((tmini_state_t)state);
}

EXPORTED const char *fault_name(uint32_t fault)
{
    return tmini_fault_name((tmini_fault_t)fault);
}

/* The text is in `transfer`. */
EXPORTED void faults_text(uint32_t faults)
{
    (void)tmini_faults_text((uint8_t)faults, (char *)web_transfer, WEB_TRANSFER_SIZE);
}
