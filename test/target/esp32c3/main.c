/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Firmware without an operating system for the ESP32-C3 that the Python package labwired (0.25.0)
 * simulates register by register. It asks for information and health, receives four scans at 12 Hz
 * through UART0 and stops the lidar. run.py reads its results from memory.
 *
 * Registers are as in Espressif's "ESP32-C3 Technical Reference Manual". The simulator differs from
 * the chip in three ways: see (1), (2) and (3) below. */

#include "tmini/tmini_blocking.h"

#include <string.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define UART 0x60000000u
#define UART_FIFO REGISTER(UART + 0x00u)
#define UART_INT_STATUS REGISTER(UART + 0x08u)
#define UART_INT_ENABLE REGISTER(UART + 0x0Cu)
#define UART_INT_CLEAR REGISTER(UART + 0x10u)
#define UART_CLKDIV REGISTER(UART + 0x14u)
#define UART_STATUS REGISTER(UART + 0x1Cu)
#define UART_CONF1 REGISTER(UART + 0x24u)
#define UART_MEM_CONF REGISTER(UART + 0x60u)
#define UART_CLK_CONF REGISTER(UART + 0x78u)
#define RXFIFO_FULL (1u << 0)
#define RXFIFO_OVF (1u << 4)
#define RXFIFO_TOUT (1u << 8)
#define RX_TOUT_EN (1u << 21)
#define FIFO_SIZE 128u

#define TIMER 0x6001F000u
#define TIMER_CONFIG REGISTER(TIMER + 0x00u)
#define TIMER_LOW REGISTER(TIMER + 0x04u)
#define TIMER_HIGH REGISTER(TIMER + 0x08u)
#define TIMER_UPDATE REGISTER(TIMER + 0x0Cu)

/* (1) The chip's timer counts the 40 MHz crystal divided by 40. The simulator's ignores the divider
 * and counts processor cycles, at 20 MHz as on the chip after reset. */
#define TICKS_PER_MS 20000u

/* (2) The chip has an interrupt matrix with lines of its own. In the simulator the UART raises
 * RISC-V's machine external interrupt, (3) which stays pending until it is cleared. */
#define EXTERNAL_INTERRUPT (1u << 11)

#define SCANS 4u
#define PATIENCE_MS 3000u

/* The results; the last one says that there are some. */
tmini_info_t info;
tmini_ct_info_t turn;
uint32_t harm; /* Bytes and packets that were lost or damaged. */
tmini_health_t health;
uint32_t frequency_chz, overflows, incomplete, unexpected;
uint32_t counts[SCANS];
tmini_point_t kept[SCANS][TMINI_SCAN_POINTS_TYPICAL];
volatile uint32_t finished;

static tmini_t lidar;
static uint8_t rx[512];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static unsigned scans;

/* ---- The board ---- */

__attribute__((interrupt, aligned(4))) static void receive(void)
{
    const uint32_t status = UART_INT_STATUS;
    while ((UART_STATUS & 0x3FFu) > 0) {
        tmini_feed_byte(&lidar, (uint8_t)UART_FIFO);
    }
    overflows += (status & RXFIFO_OVF) != 0;
    UART_INT_CLEAR = status;
    __asm__ volatile("csrc mip, %0" ::"r"(EXTERNAL_INTERRUPT));
}

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

static void open_board(void)
{
    TIMER_CONFIG = 1u << 31 | 1u << 30 | 40u << 13 | 1u << 9;
    open_uart();
    __asm__ volatile("csrw mtvec, %0" ::"r"((uintptr_t)receive));
    __asm__ volatile("csrs mie, %0" ::"r"(EXTERNAL_INTERRUPT));
    __asm__ volatile("csrsi mstatus, 8");
}

static uint32_t now_ms(void *context)
{
    (void)context;
    TIMER_UPDATE = 1u << 31;
    return (uint32_t)(((uint64_t)TIMER_HIGH << 32 | TIMER_LOW) / TICKS_PER_MS);
}

static int write_uart(void *context, const uint8_t *bytes, size_t count)
{
    size_t taken = 0;
    (void)context;
    while (taken < count && (UART_STATUS >> 16 & 0x3FFu) < FIFO_SIZE) {
        UART_FIFO = bytes[taken++];
    }
    return (int)taken;
}

static void wait_for_interrupt(void *context)
{
    (void)context;
    __asm__ volatile("wfi");
}

/* ---- The job ---- */

static void keep(const tmini_scan_t *scan)
{
    counts[scans] = scan->count;
    incomplete += !scan->complete;
    memcpy(kept[scans++], scan->points, scan->count * sizeof *scan->points);
}

static void receive_scans(void)
{
    keep(tmini_scan(&lidar)); /* What the start has waited for. */
    while (scans < SCANS && unexpected == 0) {
        const tmini_event_t event = tmini_poll(&lidar);
        if (event == TMINI_EVENT_SCAN) {
            keep(tmini_scan(&lidar));
        } else if (event == TMINI_EVENT_NONE) {
            wait_for_interrupt(NULL);
        } else {
            unexpected = event;
        }
    }
    tmini_ct_info(&lidar, &turn);
}

static bool do_all(const tmini_config_t *config)
{
    if (tmini_init(&lidar, config) != TMINI_OK) {
        return false;
    }
    open_board();
    if (tmini_blocking_read_info(&lidar, &info, PATIENCE_MS) != TMINI_OK ||
        tmini_blocking_read_health(&lidar, &health, PATIENCE_MS) != TMINI_OK ||
        tmini_blocking_start(&lidar, PATIENCE_MS) != TMINI_OK) {
        return false;
    }
    receive_scans();
    frequency_chz = tmini_frequency_chz(&lidar);
    return tmini_blocking_stop(&lidar, PATIENCE_MS) == TMINI_OK;
}

int main(void)
{
    static const tmini_port_t port = {
        .write = write_uart, .now_ms = now_ms, .wait = wait_for_interrupt};
    const tmini_config_t config = {
        .port = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1200,
    };
    const bool is_done = do_all(&config);
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    harm = counters.checksum_errors + counters.bytes_overrun + counters.losses + counters.timeouts;
    finished = is_done ? 1 : 2;
    for (;;) {
    }
}
