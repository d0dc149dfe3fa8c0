/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Start-up of unit tests on an emulated Cortex-M: vector table, main(), end by semihosting. Nothing
 * is copied or cleared: the emulator loads initialised data into RAM, and the rest is zero. */

#include "unity_config.h"

#include <stdint.h>

/* Operations, and reasons for an exit, of ARM's semihosting specification. */
#define SYS_WRITEC 0x03
#define SYS_EXIT 0x18
#define APPLICATION_EXIT 0x20026u
#define RUN_TIME_ERROR 0x20023u

extern uint32_t stack_top; /* Defined in the linker script. */

int main(void);

static void ask(uint32_t operation, uint32_t argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register uint32_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void board_put(char character)
{
    ask(SYS_WRITEC, (uint32_t)&character);
}

/* Ends the emulator with status 0 or 1. */
static void end(int status)
{
    ask(SYS_EXIT, status == 0 ? APPLICATION_EXIT : RUN_TIME_ERROR);
    for (;;) {
    }
}

void cortex_m_reset(void);

void cortex_m_reset(void)
{
    end(main());
}

/* Any exception, for example an unaligned access, a wild pointer or a stack overflow. */
static void fault(void)
{
    static const char text[] = "PROCESSOR FAULT\n";
    for (const char *character = text; *character != '\0'; character++) {
        board_put(*character);
    }
    end(1);
}

/* Initial stack pointer, reset, and the processor's other exceptions. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_top, cortex_m_reset, fault, fault, fault, fault, fault, fault,
    fault,      fault,          fault, fault, fault, fault, fault, fault,
};
