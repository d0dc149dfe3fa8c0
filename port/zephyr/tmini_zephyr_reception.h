/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Private to the Zephyr port: the interface between the port and its two ways of receiving
 * (interrupt-driven, async). */

#ifndef TMINI_ZEPHYR_RECEPTION_H
#define TMINI_ZEPHYR_RECEPTION_H

#include "tmini_zephyr.h"

/* Takes the UART's callback and begins reception. Returns 0 or the UART driver's error. */
int tmini_zephyr_begin_reception(tmini_zephyr_t *port);

/* Ends reception. Once this has returned, no callback feeds the lidar. */
void tmini_zephyr_end_reception(tmini_zephyr_t *port);

/* Starts reception again if the driver has ended it after an error. Called often, in the polling
 * thread. */
void tmini_zephyr_keep_receiving(tmini_zephyr_t *port);

/* Called from the callback: hands bytes to the lidar. */
void tmini_zephyr_take(tmini_zephyr_t *port, const uint8_t *bytes, size_t count);

/* Called from the callback: counts errors, given by their flags; true if bytes were lost. */
bool tmini_zephyr_count_errors(tmini_zephyr_t *port, int errors);

#endif
