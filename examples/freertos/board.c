/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Registers of the LM3S6965's data sheet: system control, GPIO, UART (a PL011), and the core's
 * NVIC. */

#include "board.h"

#include "FreeRTOSConfig.h"

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))

#define RIS REGISTER(0x400FE050u)
#define RIS_PLL_LOCKED (1u << 6)
#define RCC REGISTER(0x400FE060u)
#define RCC_BYPASS (1u << 11)
#define RCC_USE_DIVIDER (1u << 22)
#define RCC_OFF \
    ((0xFu << 23) | (1u << 13) | (0xFu << 6) | (3u << 4)) /* Divider, PLL off, crystal. */
#define RCC_DIVIDE_BY_4 (3u << 23)
#define RCC_8_MHZ (0xEu << 6)
#define RCGC1 REGISTER(0x400FE104u)
#define RCGC2 REGISTER(0x400FE108u)

#define GPIOA 0x40004000u
#define GPIOD 0x40007000u
#define GPIO_AFSEL(port) REGISTER((port) + 0x420u)
#define GPIO_PUR(port) REGISTER((port) + 0x510u)
#define GPIO_DEN(port) REGISTER((port) + 0x51Cu)

#define UART0 0x4000C000u
#define UART1 0x4000D000u
#define UART_DR(uart) REGISTER(uart)
#define UART_DR_OVERRUN (1u << 11)
#define UART_FR(uart) REGISTER((uart) + 0x18u)
#define UART_FR_NOTHING_RECEIVED (1u << 4)
#define UART_FR_TRANSMITTER_FULL (1u << 5)
#define UART_IBRD(uart) REGISTER((uart) + 0x24u)
#define UART_FBRD(uart) REGISTER((uart) + 0x28u)
#define UART_LCRH(uart) REGISTER((uart) + 0x2Cu)
#define UART_LCRH_8N1_FIFO 0x70u
#define UART_CTL(uart) REGISTER((uart) + 0x30u)
#define UART_CTL_ON 0x301u
#define UART_IFLS(uart) REGISTER((uart) + 0x34u)
#define UART_IFLS_HALF 0x12u
#define UART_IM(uart) REGISTER((uart) + 0x38u)
#define UART_IM_RECEIVE ((1u << 4) | (1u << 6)) /* When the FIFO is half full, and after a pause. */

#define UART1_IRQ 6u
#define NVIC_ENABLE REGISTER(0xE000E100u)
#define NVIC_PRIORITY(irq) (*(volatile uint8_t *)(uintptr_t)(0xE000E400u + (irq)))
#define LIDAR_PRIORITY 0xA0u /* Less urgent than configMAX_SYSCALL_INTERRUPT_PRIORITY. */

/* 50 MHz from the PLL's 200, with the board's crystal of 8 MHz. */
static void start_clock(void)
{
    RCC = (RCC | RCC_BYPASS) & ~RCC_USE_DIVIDER;
    RCC = (RCC & ~RCC_OFF) | RCC_8_MHZ;
    RCC = RCC | RCC_DIVIDE_BY_4 | RCC_USE_DIVIDER;
    for (unsigned tries = 0; tries < 100000 && (RIS & RIS_PLL_LOCKED) == 0; tries++) {
    }
    RCC &= ~RCC_BYPASS;
}

static void start_pins(uint32_t port, uint32_t pins)
{
    GPIO_AFSEL(port) |= pins;
    GPIO_PUR(port) |= pins; /* Without a lidar the line is idle. */
    GPIO_DEN(port) |= pins;
}

static void start_uart(uint32_t uart, uint32_t baud_rate)
{
    const uint32_t divisor = (configCPU_CLOCK_HZ * 4 + baud_rate / 2) / baud_rate; /* In 64ths. */
    UART_CTL(uart) = 0;
    UART_IBRD(uart) = divisor / 64;
    UART_FBRD(uart) = divisor % 64;
    UART_LCRH(uart) = UART_LCRH_8N1_FIFO;
    UART_IFLS(uart) = UART_IFLS_HALF;
    UART_CTL(uart) = UART_CTL_ON;
}

void board_start(void)
{
    start_clock();
    RCGC1 |= 3u;                    /* UART0, UART1. */
    RCGC2 |= (1u << 0) | (1u << 3); /* GPIO A, D. */
    (void)RCGC2;                    /* The units need some cycles to start. */
    start_pins(GPIOA, 3u);          /* A0, A1: UART0. */
    start_pins(GPIOD, 3u << 2);     /* D2, D3: UART1. */
    start_uart(UART0, 115200);
    start_uart(UART1, 230400);
}

int board_lidar_write(void *uart, const uint8_t *bytes, size_t count)
{
    size_t taken = 0;
    (void)uart;
    while (taken < count && (UART_FR(UART1) & UART_FR_TRANSMITTER_FULL) == 0) {
        UART_DR(UART1) = bytes[taken++];
    }
    return (int)taken;
}

void board_enable_lidar_interrupt(void)
{
    UART_IM(UART1) = UART_IM_RECEIVE;
    NVIC_PRIORITY(UART1_IRQ) = LIDAR_PRIORITY;
    NVIC_ENABLE = 1u << UART1_IRQ;
}

size_t board_lidar_read(uint8_t *bytes, size_t max, int *overrun)
{
    size_t count = 0;
    *overrun = 0;
    while (count < max && (UART_FR(UART1) & UART_FR_NOTHING_RECEIVED) == 0) {
        const uint32_t entry = UART_DR(UART1);
        *overrun |= (entry & UART_DR_OVERRUN) != 0;
        bytes[count++] = (uint8_t)entry;
    }
    return count;
}

void board_sleep(void)
{
    __asm__ volatile("wfi");
}

static void put(char character)
{
    while ((UART_FR(UART0) & UART_FR_TRANSMITTER_FULL) != 0) {
    }
    UART_DR(UART0) = (uint8_t)character;
}

void board_print(const char *text)
{
    for (; *text != '\0'; text++) {
        put(*text);
    }
}

static void print_number(uint32_t number)
{
    char text[11];
    char *digit = &text[sizeof text - 1];
    *digit = '\0';
    do {
        *--digit = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    board_print(digit);
}

void board_assert(const char *file, int line)
{
    board_print("assertion in ");
    board_print(file);
    board_print(", line ");
    print_number((uint32_t)line);
    board_print("\n");
    for (;;) {
    }
}
