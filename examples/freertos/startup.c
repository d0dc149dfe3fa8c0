/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The vector table, and the start-up code: initialises data and calls main(). */

#include <stdint.h>

#include "board.h"

/* Defined by the linker script. */
extern uint32_t stack_top[];
extern uint32_t data_load[];
extern uint32_t data_start[];
extern uint32_t data_end[];
extern uint32_t bss_start[];
extern uint32_t bss_end[];

int main(void);
void reset_handler(void);

/* The kernel's handlers; FreeRTOSConfig.h gives them these names. */
void SVC_Handler(void);
void PendSV_Handler(void);
void SysTick_Handler(void);

void reset_handler(void)
{
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
    (void)main();
}

static void stop_handler(void)
{
    for (;;) {
    }
}

typedef void (*handler_t)(void);

/* Indices in the vector table, after the initial stack pointer. */
enum { RESET, NMI, HARD_FAULT, SVC = 10, PENDSV = 13, SYSTICK = 14, EXCEPTIONS };
enum { UART1_IRQ = 6, IRQS = 44 };

__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    handler_t exceptions[EXCEPTIONS];
    handler_t irqs[IRQS];
} vectors = {
    .stack = stack_top,
    .exceptions =
        {
            [RESET] = reset_handler,
            [NMI] = stop_handler,
            [HARD_FAULT] = stop_handler,
            [SVC] = SVC_Handler,
            [PENDSV] = PendSV_Handler,
            [SYSTICK] = SysTick_Handler,
        },
    .irqs = {[UART1_IRQ] = UART1_Handler},
};
