/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The STM32 port as it is compiled for a processor with data cache (Cortex-M7) and for a DMA controller
 * with linked lists: the cache is told before bytes are handed over. */

#include "tmini_stm32_hal.h"

#include <string.h>

#include "mock_stm32_stub_hal.h"
#include "unity.h"

#define RX_SIZE 512u
#define BLOCK_SIZE 64u

bool stm32_stub_is_masked;
bool stm32_stub_was_read_unmasked;

static DMA_Stream_TypeDef stream;
static DMA_HandleTypeDef dma;
static UART_HandleTypeDef uart;

/* C99 cannot ask for an alignment: rx is the first multiple of 32 in here. */
static uint8_t memory[RX_SIZE + 64];
static uint8_t *rx;
static tmini_t lidar;
static tmini_stm32_hal_t port;

static void set_up_lidar(bool rx_dma)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = RX_SIZE,
        .rx_dma = rx_dma,
    };
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
}

static uint32_t get_tick(int calls)
{
    (void)calls;
    return 1000;
}

void setUp(void)
{
    rx = &memory[32 - (uintptr_t)memory % 32];
    memset(memory, 0, sizeof memory);
    port = (tmini_stm32_hal_t){0};
    stream.NDTR = RX_SIZE;
    dma = (DMA_HandleTypeDef){.Instance = &stream, .Mode = DMA_LINKEDLIST_CIRCULAR};
    uart = (UART_HandleTypeDef){.hdmarx = &dma, .RxState = HAL_UART_STATE_READY};
    stm32_stub_is_masked = false;
    HAL_GetTick_Stub(get_tick);
}

void tearDown(void) {}

static void begin_dma(void)
{
    set_up_lidar(true);
    SCB_CleanInvalidateDCache_by_Addr_Expect(rx, RX_SIZE);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_hal_receive_dma(&port, &lidar, &uart, rx, RX_SIZE));
    uart.RxState = HAL_UART_STATE_BUSY_RX;
}

static void event_at(size_t position)
{
    stream.NDTR = (uint32_t)(RX_SIZE - position);
    tmini_stm32_hal_rx_event(&port, &uart, (uint16_t)position);
}

static void expect_invalidated(size_t from, size_t to)
{
    SCB_InvalidateDCache_by_Addr_Expect(&rx[from], (int32_t)(to - from));
}

void test_a_buffer_that_shares_a_cache_line_is_refused(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_dma(&port, &lidar, &uart, rx + 4, RX_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_dma(&port, &lidar, &uart, rx, 16));
}

void test_what_was_written_to_the_buffer_before_leaves_the_cache_first(void)
{
    begin_dma();
}

void test_a_linked_list_that_is_not_circular_is_refused(void)
{
    dma.Mode = DMA_NORMAL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_dma(&port, &lidar, &uart, rx, RX_SIZE));
}

void test_new_bytes_are_read_anew_from_their_cache_line_on(void)
{
    begin_dma();
    expect_invalidated(0, 50);
    event_at(50);
    expect_invalidated(32, 70); /* 50 lies in the line of 32 … 63. */
    event_at(70);
}

void test_new_bytes_across_the_buffers_end_are_read_anew_in_two_parts(void)
{
    begin_dma();
    expect_invalidated(0, 500);
    event_at(500);
    expect_invalidated(480, 512);
    expect_invalidated(0, 20);
    event_at(20);
}

void test_an_event_at_the_buffers_end_reads_no_second_part(void)
{
    begin_dma();
    expect_invalidated(0, 256);
    event_at(256);
    expect_invalidated(256, 512);
    event_at(0); /* DMA has begun anew. */
}

/* Or the zeros would reach the memory later, over what DMA has written there by then. */
void test_what_is_overwritten_after_an_error_is_written_through(void)
{
    begin_dma();
    stream.NDTR = RX_SIZE - 96;
    uart.RxState = HAL_UART_STATE_READY;
    uart.ErrorCode = HAL_UART_ERROR_FE;
    expect_invalidated(0, 96);
    SCB_CleanInvalidateDCache_by_Addr_Expect(rx, RX_SIZE);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    tmini_stm32_hal_error(&port, &uart);
}

static void begin_blocks(void)
{
    set_up_lidar(false);
    SCB_CleanInvalidateDCache_by_Addr_Expect(rx, BLOCK_SIZE);
    if (uart.hdmarx != NULL) {
        HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, BLOCK_SIZE, HAL_OK);
    } else {
        HAL_UARTEx_ReceiveToIdle_IT_ExpectAndReturn(&uart, rx, BLOCK_SIZE, HAL_OK);
    }
    TEST_ASSERT_EQUAL(TMINI_OK,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, rx, BLOCK_SIZE));
    uart.RxState = HAL_UART_STATE_BUSY_RX;
}

void test_a_block_by_dma_is_read_anew(void)
{
    begin_blocks();
    expect_invalidated(0, 13);
    tmini_stm32_hal_rx_event(&port, &uart, 13);
}

void test_a_block_by_interrupt_is_in_the_cache_already(void)
{
    uart.hdmarx = NULL;
    begin_blocks();
    tmini_stm32_hal_rx_event(&port, &uart, 13);
}
