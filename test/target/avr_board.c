/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ATmega2560: prints through UART 0. Sleeping with interrupts disabled ends the simulation. */

#include "unity_config.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdbool.h>
#include <stdint.h>

/* The first address after the static data. A stack that grows too deep reaches this place first:
 * there is no heap. */
extern uint8_t __heap_start;

#define GUARD_SIZE 16u
#define GUARD_BYTE 0xA5u

static bool guard_is_intact(void)
{
    const uint8_t *const guard = &__heap_start;
    for (uint8_t i = 0; i < GUARD_SIZE; i++) {
        if (guard[i] != GUARD_BYTE) {
            return false;
        }
    }
    return true;
}

static void put_text(const char *text)
{
    while (*text != '\0') {
        board_put(*text++);
    }
}

/* Prepares the UART, and fills some bytes after the static data with a guard pattern. */
void board_start(void)
{
    uint8_t *const guard = &__heap_start;
    for (uint8_t i = 0; i < GUARD_SIZE; i++) {
        guard[i] = GUARD_BYTE;
    }
    UBRR0 = 0; /* The highest baud rate: only the simulator receives. */
    UCSR0B = _BV(TXEN0);
}

/* The simulator prints what UART 0 sends. */
void board_put(char character)
{
    loop_until_bit_is_set(UCSR0A, UDRE0);
    UDR0 = (uint8_t)character;
}

/* Reports a stack that has overwritten the guard pattern, and ends the simulation. */
void board_stop(void)
{
    if (!guard_is_intact()) {
        put_text("STACK OVERFLOW\n");
    }
    loop_until_bit_is_set(UCSR0A, UDRE0);
    cli();
    sleep_enable();
    for (;;) {
        sleep_cpu();
    }
}
