/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A port's functions as plain prototypes, for CMock to mock; see tmini/tmini_port.h. */

#ifndef PORT_FUNCTIONS_H
#define PORT_FUNCTIONS_H

#include <stddef.h>
#include <stdint.h>

int port_write(void *context, const uint8_t *bytes, size_t count);
uint32_t port_now_ms(void *context);
void port_wait(void *context);

#endif
