/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: statuses, events, states and faults as short English phrases, for logs and displays.
 * The linker leaves out what is not used. Any context; no waiting; the strings are constant. */

#ifndef TMINI_NAMES_H
#define TMINI_NAMES_H

#include <stddef.h>
#include <stdint.h>

#include "tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A buffer of this size holds the text of any combination of faults. */
#define TMINI_FAULTS_TEXT_SIZE 64u

/** A status as text, for example "timeout". "unknown status" for any other value. Never NULL. */
const char *tmini_status_name(tmini_status_t status);

/** An event as text, for example "faults changed"; "unknown event" for any other value. Never
 * NULL. */
const char *tmini_event_name(tmini_event_t event);

/** A state as text, for example "scanning"; "unknown state" for any other value ("unknown" is
 * TMINI_STATE_UNKNOWN). Never NULL. */
const char *tmini_state_name(tmini_state_t state);

/** The name of one fault, for example "encoder"; "unknown fault" for 0 or several faults. Never
 * NULL. */
const char *tmini_fault_name(tmini_fault_t fault);

/** Writes the names of all faults in `faults` (a combination of tmini_fault_t) to `text`, as in
 * "encoder, data"; "none" for 0. `size` is the size of `text` in bytes, including the terminating
 * 0. Text that does not fit is cut off; with size 0 nothing is written. Returns `text`. */
const char *tmini_faults_text(uint8_t faults, char *text, size_t size);

/** The serial number as text: 16 characters and a terminating 0; '?' where there is no digit. */
void tmini_serial_text(const tmini_info_t *info, char text[TMINI_SERIAL_DIGITS + 1]);

#ifdef __cplusplus
}
#endif

#endif
