/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* When the STM32 port on SR and DR reads DR. Reading it clears the errors and the idle line, but
 * takes a byte away from the DMA if one is there (reference manual RM0090). An array does not show
 * that it is read; a page of memory that nobody may touch does: SR is the last word before it. */

#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */

#include "tmini_stm32_usart.h"

#include "unity.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#define FRAMING_ERROR 0x02u
#define OVERRUN 0x08u
#define IDLE 0x10u
#define RECEIVE_NOT_EMPTY 0x20u
#define RX_SIZE 512u

static size_t page_size;
static uint8_t *page; /* From DR on. */
static volatile uint32_t *registers;
static volatile sig_atomic_t reads;
static const volatile uint32_t time_ms;
static const volatile uint32_t remaining = RX_SIZE;
static uint8_t rx[RX_SIZE];
static tmini_t lidar;
static tmini_stm32_usart_t port;

static void allow(int access)
{
    TEST_ASSERT_EQUAL_INT(0, mprotect(page, page_size, access));
}

/* The instruction that was refused is tried again. */
static void count_read(int number)
{
    (void)number;
    reads++;
    allow(PROT_READ | PROT_WRITE);
}

void setUp(void)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = true,
    };
    page_size = (size_t)sysconf(_SC_PAGESIZE);
    uint8_t *const memory =
        mmap(NULL, 2 * page_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    TEST_ASSERT_TRUE(memory != MAP_FAILED);
    page = memory + page_size;
    registers = (volatile uint32_t *)(void *)(page - sizeof *registers);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(&port, registers, &time_ms));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 0, &remaining));
    (void)signal(SIGSEGV, count_read);
    (void)signal(SIGBUS, count_read);
}

void tearDown(void)
{
    (void)signal(SIGSEGV, SIG_DFL);
    (void)signal(SIGBUS, SIG_DFL);
    TEST_ASSERT_EQUAL_INT(0, munmap(page - page_size, 2 * page_size));
}

static void dr_is_read_so_often_with(int times, uint32_t status)
{
    registers[0] = status;
    reads = 0;
    allow(PROT_NONE);
    tmini_stm32_usart_interrupt(&port);
    allow(PROT_READ | PROT_WRITE);
    TEST_ASSERT_EQUAL_INT(times, reads);
}

void test_an_idle_line_is_cleared_by_reading(void)
{
    dr_is_read_so_often_with(1, IDLE);
}

void test_errors_without_a_byte_are_cleared_by_reading(void)
{
    dr_is_read_so_often_with(1, OVERRUN);
    dr_is_read_so_often_with(1, FRAMING_ERROR);
}

void test_a_byte_that_is_there_is_left_to_the_dma(void)
{
    dr_is_read_so_often_with(0, IDLE | RECEIVE_NOT_EMPTY);
    dr_is_read_so_often_with(0, OVERRUN | RECEIVE_NOT_EMPTY);
}

void test_without_need_nothing_is_read(void)
{
    dr_is_read_so_often_with(0, 0);
}
