/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Registers as in Espressif's "ESP32-C3 Technical Reference Manual".
 *
 * Compile with -DEMULATED for the simulator that the test uses. It differs from the chip in three
 * ways: see (1), (2) and (3) below. */

#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define UART 0x60000000u
#define UART_FIFO REGISTER(UART + 0x00u)
#define UART_INT_STATUS REGISTER(UART + 0x08u)
#define UART_INT_ENABLE REGISTER(UART + 0x0Cu)
#define UART_INT_CLEAR REGISTER(UART + 0x10u)
#define UART_CLKDIV REGISTER(UART + 0x14u)
#define UART_STATUS REGISTER(UART + 0x1Cu)
#define UART_CONF0 REGISTER(UART + 0x20u)
#define UART_CONF1 REGISTER(UART + 0x24u)
#define UART_MEM_CONF REGISTER(UART + 0x60u)
#define UART_CLK_CONF REGISTER(UART + 0x78u)
#define RXFIFO_FULL (1u << 0)
#define RXFIFO_OVF (1u << 4)
#define RXFIFO_TOUT (1u << 8)
#define RXFIFO_RST (1u << 17)
#define RX_TOUT_EN (1u << 21)
#define FIFO_SIZE 128u

#define MATRIX 0x600C2000u
#define MATRIX_UART_MAP REGISTER(MATRIX + 0x54u)
#define MATRIX_ENABLE REGISTER(MATRIX + 0x104u)
#define MATRIX_TYPE REGISTER(MATRIX + 0x108u)
#define MATRIX_PRIORITY(line) REGISTER(MATRIX + 0x114u + 4u * (line))
#define MATRIX_THRESHOLD REGISTER(MATRIX + 0x194u)
#define UART_LINE 1u

#define TIMER 0x6001F000u
#define TIMER_CONFIG REGISTER(TIMER + 0x00u)
#define TIMER_LOW REGISTER(TIMER + 0x04u)
#define TIMER_HIGH REGISTER(TIMER + 0x08u)
#define TIMER_UPDATE REGISTER(TIMER + 0x0Cu)
#define TIMER_BUSY (1u << 31)

/* The chip's timer counts the 40 MHz crystal divided by 40. (1) The simulator's timer ignores the
 * divider and counts processor cycles, at 20 MHz as on the chip after reset. */
#ifdef EMULATED
#define TICKS_PER_MS 20000u
#else
#define TICKS_PER_MS 1000u
#endif

#define STACK_PAINT 0xA5A5A5A5u

extern uint32_t data_begin[], data_end[], data_image[], bss_begin[], bss_end[];
extern uint32_t stack_paint_end[], stack_top[];

int main(void);
void board_begin(void);
void board_interrupt(void);

static tmini_t *receiver;
static volatile board_statistics_t statistics;

/* ------------------------------------------------------------------------- start and interrupts */

__attribute__((naked, section(".start"))) void board_start(void)
{
    __asm__ volatile("la sp, stack_top\n"
                     "j board_begin\n");
}

void board_begin(void)
{
    const uint32_t *from = data_image;
    for (uint32_t *to = data_begin; to < data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = bss_begin; to < bss_end; to++) {
        *to = 0;
    }
    for (uint32_t *to = bss_end; to < stack_paint_end; to++) {
        *to = STACK_PAINT;
    }
    main();
    for (;;) {
        board_sleep();
    }
}

uint32_t board_stack_used(void)
{
    const uint32_t *deepest = bss_end;
    while (deepest < stack_top && *deepest == STACK_PAINT) {
        deepest++;
    }
    return (uint32_t)((const uint8_t *)stack_top - (const uint8_t *)deepest);
}

/* The core needs a table of 32 jumps, one per interrupt line. */
__attribute__((naked, aligned(256), section(".vectors"))) static void vectors(void)
{
    __asm__ volatile(".option push\n"
                     ".option norvc\n"
                     ".rept 32\n"
                     "j board_interrupt\n"
                     ".endr\n"
                     ".option pop\n");
}

__attribute__((interrupt, aligned(4))) void board_interrupt(void)
{
    const uint32_t status = UART_INT_STATUS;
    uint32_t count = 0;
    for (; (UART_STATUS & 0x3FFu) > 0; count++) {
        tmini_feed_byte(receiver, (uint8_t)UART_FIFO);
    }
    if ((status & RXFIFO_OVF) != 0) {
        UART_CONF0 |= RXFIFO_RST;
        UART_CONF0 &= ~RXFIFO_RST;
        statistics.overflows++;
    }
    UART_INT_CLEAR = status;
    statistics.interrupts++;
    if (count > statistics.most_bytes) {
        statistics.most_bytes = count;
    }
#ifdef EMULATED
    /* (2) In the simulator, the interrupt stays pending until it is cleared here. */
    __asm__ volatile("csrc mip, %0" ::"r"(1u << 11));
#endif
}

/* Level-triggered line 1, priority 1, above the threshold 0. */
static void open_interrupt(void)
{
    __asm__ volatile("csrw mtvec, %0" ::"r"((uintptr_t)vectors | 1u));
    MATRIX_UART_MAP = UART_LINE;
    MATRIX_TYPE &= ~(1u << UART_LINE);
    MATRIX_PRIORITY(UART_LINE) = 1;
    MATRIX_THRESHOLD = 0;
    MATRIX_ENABLE |= 1u << UART_LINE;
#ifdef EMULATED
    /* (3) The simulator ignores the interrupt matrix: the UART raises RISC-V's machine external
     * interrupt. */
    __asm__ volatile("csrs mie, %0" ::"r"(1u << 11));
#endif
    __asm__ volatile("csrsi mstatus, 8");
}

void board_sleep(void)
{
    __asm__ volatile("wfi");
}

/* ---------------------------------------------------------------------------------- UART, clock */

/* 230400 8N1: the 40 MHz crystal divided by 173 10/16, 0.008 % slow. The UART interrupts after 64
 * bytes, or 40 bit times after the last byte. */
static void open_uart(void)
{
    UART_CLK_CONF = (UART_CLK_CONF & ~(0xFFFFFu)) | 3u << 20 | 1u << 22;
    UART_CLKDIV = 10u << 20 | 173u;
    UART_CONF1 = (UART_CONF1 & ~0x1FFu) | 64u | RX_TOUT_EN;
    UART_MEM_CONF = (UART_MEM_CONF & ~(0x3FFu << 16)) | 40u << 16;
    UART_INT_CLEAR = RXFIFO_FULL | RXFIFO_OVF | RXFIFO_TOUT;
    UART_INT_ENABLE = RXFIFO_FULL | RXFIFO_OVF | RXFIFO_TOUT;
}

/* The timer is enabled, counts up, divides by 40 and is clocked by the crystal. */
static void open_clock(void)
{
    TIMER_CONFIG = 1u << 31 | 1u << 30 | 40u << 13 | 1u << 9;
}

static uint32_t board_now_ms(void *context)
{
    (void)context;
    TIMER_UPDATE = TIMER_BUSY;
#ifndef EMULATED
    while ((TIMER_UPDATE & TIMER_BUSY) != 0) {
    }
#endif
    const uint64_t ticks = (uint64_t)TIMER_HIGH << 32 | TIMER_LOW;
    return (uint32_t)(ticks / TICKS_PER_MS);
}

static int board_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    size_t taken = 0;
    while (taken < count && (UART_STATUS >> 16 & 0x3FFu) < FIFO_SIZE) {
        UART_FIFO = bytes[taken++];
    }
    return (int)taken;
}

const tmini_port_t board_port = {.write = board_write, .now_ms = board_now_ms};

void board_open(tmini_t *lidar)
{
    receiver = lidar;
    open_clock();
    open_uart();
    open_interrupt();
}

board_statistics_t board_statistics(void)
{
    return statistics;
}
