/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The vector table, and the start-up code: initialises data, fills the stack with a pattern, and
 * calls main(). What is left of the pattern shows how much stack was ever used. */

#include "board.h"
#include "stm32f405.h"

#define PAINT 0xC5C5C5C5u

/* Defined by the linker script. */
extern uint32_t stack_bottom[];
extern uint32_t paint_end[];
extern uint32_t stack_top[];
extern uint32_t data_load[];
extern uint32_t data_start[];
extern uint32_t data_end[];
extern uint32_t bss_start[];
extern uint32_t bss_end[];

int main(void);
void reset_handler(void);
void SysTick_Handler(void);
void USART1_IRQHandler(void);
void DMA2_Stream2_IRQHandler(void) __attribute__((weak)); /* Exists only with DMA. */

static void paint_stack(void)
{
    for (volatile uint32_t *word = stack_bottom; word < paint_end; word++) {
        *word = PAINT;
    }
}

uint32_t board_stack_used(void)
{
    const uint32_t *word = stack_bottom;
    while (word < stack_top && *word == PAINT) {
        word++;
    }
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
}

void reset_handler(void)
{
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
    paint_stack();
    (void)main();
}

/* After a fault, or an interrupt without a handler, the robot must not move. */
static void stop_handler(void)
{
    board_enable_drive(false);
    for (;;) {
    }
}

typedef void (*handler_t)(void);

/* Indices in the vector table, after the initial stack pointer. */
enum { RESET, NMI, HARD_FAULT, MEMORY_FAULT, BUS_FAULT, USAGE_FAULT, SYSTICK = 14, EXCEPTIONS };

#define IRQS 82u

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
            [MEMORY_FAULT] = stop_handler,
            [BUS_FAULT] = stop_handler,
            [USAGE_FAULT] = stop_handler,
            [SYSTICK] = SysTick_Handler,
        },
    .irqs = {[USART1_IRQ] = USART1_IRQHandler, [DMA2_STREAM2_IRQ] = DMA2_Stream2_IRQHandler},
};
