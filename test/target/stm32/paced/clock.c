/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A deliberate fault, linked into the firmware by the linker's --wrap: of the bytes that the
 * interrupt receives and counts, one now and then is taken out of the library's ring again, as if
 * it had not reached the library. The target test must find it. */

#include "tmini_stm32_usart.h"

#define INTERVAL 5000u

void __real_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);
void __wrap_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);

void __wrap_tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port)
{
    const uint32_t before = port->counters.bytes;
    __real_tmini_stm32_usart_interrupt(port);
    if (port->counters.bytes != before && port->counters.bytes % INTERVAL == 0) {
        port->lidar->ring.head--;
        port->lidar->ring.stop = port->lidar->ring.head;
    }
}
