/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ATmega2560: output through UART 0, end by sleeping without interrupts (the simulator then
 * stops). */

#include "avr_board.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdbool.h>
#include <stdint.h>

/* Just after the static data (there is no heap): the first place that a stack too deep reaches. */
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
        avr_board_put(*text++);
    }
}

void avr_board_start(void)
{
    uint8_t *const guard = &__heap_start;
    for (uint8_t i = 0; i < GUARD_SIZE; i++) {
        guard[i] = GUARD_BYTE;
    }
    UBRR0 = 0; /* As fast as it goes: nothing is at the other end of the wire. */
    UCSR0B = _BV(TXEN0);
}

void avr_board_put(char character)
{
    loop_until_bit_is_set(UCSR0A, UDRE0);
    UDR0 = (uint8_t)character;
}

void avr_board_stop(void)
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
