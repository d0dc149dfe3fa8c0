/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "board.h"

#include "stm32f405.h"

#define CONSOLE_BAUD 115200u
#define CYCLES_PER_MS (BOARD_CLOCK_HZ / 1000u)
#define INTERNAL_OSCILLATOR_HZ 16000000u

/* Some milliseconds at 16 MHz. A crystal takes 2 ms to start, the PLL 0.3 ms. An emulator may have
 * no clock control: then no bit ever changes. */
#define PATIENCE 20000u

volatile uint32_t board_time_ms;

void SysTick_Handler(void);

void SysTick_Handler(void)
{
    board_time_ms = board_time_ms + 1;
}

void board_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t bits)
{
    for (uint32_t i = 0; i < PATIENCE && (*reg & mask) != bits; i++) {
    }
}

/* 168 MHz by the PLL: source / M * 336 / 2, where source / M is 1 MHz. (The bits for 2 are 0.) */
static void start_clock(void)
{
    const uint32_t source_hz = BOARD_CRYSTAL_HZ != 0 ? BOARD_CRYSTAL_HZ : INTERNAL_OSCILLATOR_HZ;
    RCC_APB1ENR |= RCC_APB1ENR_PWR;
    PWR_CR |= PWR_CR_VOS;
    if (BOARD_CRYSTAL_HZ != 0) {
        RCC_CR |= RCC_CR_HSEON;
        board_wait_for(&RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY);
    }
    RCC_PLLCFGR = source_hz / 1000000u | 336u << 6 | 7u << 24 |
                  (BOARD_CRYSTAL_HZ != 0 ? RCC_PLLCFGR_SRC_HSE : 0u);
    RCC_CR |= RCC_CR_PLLON;
    board_wait_for(&RCC_CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY);
    FLASH_ACR = FLASH_ACR_5_WAIT_STATES | FLASH_ACR_PREFETCH_AND_CACHES;
    RCC_CFGR = RCC_CFGR_PPRE1_DIV4 | RCC_CFGR_PPRE2_DIV2 | RCC_CFGR_SW_PLL;
    board_wait_for(&RCC_CFGR, RCC_CFGR_SWS_MASK, RCC_CFGR_SWS_PLL);
}

static void start_pins(void)
{
    RCC_AHB1ENR |= RCC_AHB1ENR_GPIOA | RCC_AHB1ENR_GPIOB;
    board_enable_drive(false);
    GPIOB_MODER = (GPIOB_MODER & ~3u) | 1u; /* PB0: output. */
    /* PA2, PA3, PA9, PA10: alternate function 7, the USARTs; inputs pulled up, so that a line
     * without a lidar is quiet. */
    GPIOA_AFRL = (GPIOA_AFRL & ~0x0000FF00u) | 0x00007700u;
    GPIOA_AFRH = (GPIOA_AFRH & ~0x00000FF0u) | 0x00000770u;
    GPIOA_PUPDR = (GPIOA_PUPDR & ~0x003000C0u) | 0x00100040u;
    GPIOA_MODER = (GPIOA_MODER & ~0x003C00F0u) | 0x002800A0u;
}

static void start_console(void)
{
    RCC_APB1ENR |= RCC_APB1ENR_USART2;
    USART2_BRR = (BOARD_USART2_CLOCK_HZ + CONSOLE_BAUD / 2) / CONSOLE_BAUD;
    USART2_CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE;
}

static void start_time(void)
{
    SYSTICK_LOAD = CYCLES_PER_MS - 1;
    SYSTICK_VAL = 0;
    SYSTICK_CTRL = SYSTICK_CTRL_ON;
}

void board_start(void)
{
    start_clock();
    start_pins();
    start_console();
    start_time();
    RCC_APB2ENR |= RCC_APB2ENR_USART1;
}

void board_enable_lidar_interrupt(void)
{
    NVIC_ISER(USART1_IRQ) = NVIC_BIT(USART1_IRQ);
}

void board_enable_drive(bool enable)
{
    GPIOB_BSRR = enable ? 1u << 0 : 1u << 16;
}

void board_sleep(void)
{
    __asm__ volatile("wfi");
}

uint32_t board_cycle(void)
{
    return SYSTICK_VAL;
}

uint32_t board_cycles_since(uint32_t start)
{
    const uint32_t now = SYSTICK_VAL; /* The counter counts down. */
    return start >= now ? start - now : start + CYCLES_PER_MS - now;
}
