/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The STM32 port over a mocked HAL: how bytes come in by each way of receiving, what happens after
 * errors, and how commands leave. */

#include "tmini_stm32_hal.h"

#include <string.h>

#include "mock_stm32_stub_hal.h"
#include "unity.h"

#define RX_SIZE 512u
#define BLOCK_SIZE 64u

/* A start packet as a real unit has sent it (section 9.14). */
static const uint8_t packet[] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                 0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};
#define PACKET_SIZE sizeof packet

bool stm32_stub_is_masked;
bool stm32_stub_was_read_unmasked;

static DMA_Stream_TypeDef stream;
static DMA_HandleTypeDef dma;
static UART_HandleTypeDef uart;
static UART_HandleTypeDef other_uart;

static uint8_t rx[RX_SIZE];
static uint8_t block[BLOCK_SIZE];
static tmini_t lidar;
static tmini_stm32_hal_t port;

static uint32_t tick_ms;

static uint32_t get_tick(int calls)
{
    (void)calls;
    return tick_ms;
}

static void set_up_lidar(bool rx_dma)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = rx_dma,
    };
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
}

void setUp(void)
{
    memset(rx, 0, sizeof rx);
    memset(block, 0, sizeof block);
    port = (tmini_stm32_hal_t){0};
    stream.NDTR = RX_SIZE;
    dma = (DMA_HandleTypeDef){.Instance = &stream, .Init.Mode = DMA_CIRCULAR};
    uart = (UART_HandleTypeDef){
        .hdmarx = &dma,
        .gState = HAL_UART_STATE_READY,
        .RxState = HAL_UART_STATE_READY,
    };
    other_uart = uart;
    stm32_stub_is_masked = false;
    stm32_stub_was_read_unmasked = false;
    tick_ms = 1000;
    HAL_GetTick_Stub(get_tick);
}

void tearDown(void) {}

/* The HAL's side: reception has begun, or has been broken off. */
static void hal_receives(void)
{
    uart.RxState = HAL_UART_STATE_BUSY_RX;
}

static void hal_breaks_off(uint32_t error_code)
{
    uart.RxState = HAL_UART_STATE_READY;
    uart.ErrorCode = error_code;
}

static void begin_dma(void)
{
    set_up_lidar(true);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_hal_receive_dma(&port, &lidar, &uart, rx, sizeof rx));
    hal_receives();
}

static void begin_blocks_by_interrupt(void)
{
    set_up_lidar(false);
    uart.hdmarx = NULL;
    HAL_UARTEx_ReceiveToIdle_IT_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    TEST_ASSERT_EQUAL(TMINI_OK,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, block, sizeof block));
    hal_receives();
}

static void begin_blocks_by_dma(uint32_t dma_mode)
{
    set_up_lidar(false);
    dma.Init.Mode = dma_mode;
    stream.NDTR = BLOCK_SIZE;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    TEST_ASSERT_EQUAL(TMINI_OK,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, block, sizeof block));
    hal_receives();
}

static void begin_bytes(void)
{
    set_up_lidar(false);
    HAL_UART_Receive_IT_ExpectAndReturn(&uart, &port.byte, 1, HAL_OK);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_hal_receive_bytes(&port, &lidar, &uart));
    hal_receives();
}

/* The hardware's side: DMA stands at `position` of the receive buffer. */
static void dma_stands_at(size_t position)
{
    stream.NDTR = (uint32_t)(RX_SIZE - position);
}

static void event_at(size_t position)
{
    dma_stands_at(position);
    tmini_stm32_hal_rx_event(&port, &uart, (uint16_t)position);
}

/* Writes a packet as DMA would, across the buffer's end if need be. */
static void put_packet(size_t at)
{
    for (size_t i = 0; i < PACKET_SIZE; i++) {
        rx[(at + i) % RX_SIZE] = packet[i];
    }
}

static tmini_counters_t poll(void)
{
    tmini_counters_t counters;
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
    return counters;
}

static uint32_t bytes_in(const tmini_counters_t *counters)
{
    return counters->parser.bytes_in_packets + counters->parser.bytes_in_replies +
           counters->parser.bytes_skipped + counters->parser.bytes_overrun +
           counters->bytes_pending;
}

/* ------------------------------------------------------------------------------- circular DMA */

void test_dma_receives_into_the_librarys_own_buffer(void)
{
    begin_dma();
}

static tmini_status_t begin_dma_with(tmini_t *of_lidar, UART_HandleTypeDef *by_uart,
                                     uint8_t *buffer, size_t size)
{
    return tmini_stm32_hal_receive_dma(&port, of_lidar, by_uart, buffer, size);
}

void test_dma_is_refused_with_anything_missing(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_dma(NULL, &lidar, &uart, rx, RX_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(NULL, &uart, rx, RX_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, NULL, rx, RX_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, NULL, RX_SIZE));
    uart.hdmarx = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, rx, RX_SIZE));
}

void test_dma_is_refused_with_a_size_that_is_no_power_of_two_or_too_large_to_count(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, rx, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, rx, 500));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, rx, 65536));
}

void test_dma_that_is_not_circular_is_refused(void)
{
    dma.Init.Mode = DMA_NORMAL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, begin_dma_with(&lidar, &uart, rx, RX_SIZE));
}

void test_a_hal_that_will_not_start_is_told_and_asked_again_later(void)
{
    set_up_lidar(true);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_BUSY);
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, begin_dma_with(&lidar, &uart, rx, RX_SIZE));

    tick_ms = 1003;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    (void)tmini_poll(&lidar);
}

void test_an_idle_event_hands_over_what_dma_has_written(void)
{
    begin_dma();
    put_packet(0);
    event_at(PACKET_SIZE);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

void test_half_and_full_events_hand_over_everything_once(void)
{
    begin_dma();
    put_packet(100);
    put_packet(300);
    event_at(256);
    tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(256, bytes_in(&counters));

    dma_stands_at(0); /* It has begun anew when the event comes. */
    tmini_stm32_hal_rx_event(&port, &uart, RX_SIZE);
    counters = poll();
    TEST_ASSERT_EQUAL_UINT32(2, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(512, bytes_in(&counters));
}

void test_a_packet_across_the_buffers_end_is_found(void)
{
    begin_dma();
    event_at(256);
    (void)poll();
    event_at(500);
    (void)poll();
    put_packet(505);
    event_at(20);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(532, bytes_in(&counters));
}

void test_a_half_event_overtaken_by_an_idle_event_brings_nothing_twice(void)
{
    begin_dma();
    dma_stands_at(260);
    tmini_stm32_hal_rx_event(&port, &uart, 260); /* Idle. */
    tmini_stm32_hal_rx_event(&port, &uart, 256); /* Half: late. */
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(260, bytes_in(&counters));
}

void test_an_idle_event_together_with_the_full_event_brings_nothing_twice(void)
{
    begin_dma();
    event_at(256);
    (void)poll();
    dma_stands_at(0);
    tmini_stm32_hal_rx_event(&port, &uart, RX_SIZE); /* Full. */
    tmini_stm32_hal_rx_event(&port, &uart, RX_SIZE); /* Idle. */
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(512, bytes_in(&counters));
}

void test_a_dma_counter_caught_at_0_is_the_buffers_end(void)
{
    begin_dma();
    event_at(256);
    (void)poll();
    event_at(512);
    event_at(8);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(520, bytes_in(&counters));
}

void test_no_other_event_can_come_between_reading_and_using_dmas_position(void)
{
    begin_dma();
    event_at(10);
    TEST_ASSERT_FALSE(stm32_stub_was_read_unmasked);
    TEST_ASSERT_FALSE(stm32_stub_is_masked);
}

void test_interrupts_held_back_by_the_caller_stay_held_back(void)
{
    begin_dma();
    stm32_stub_is_masked = true;
    event_at(10);
    TEST_ASSERT_TRUE(stm32_stub_is_masked);
}

void test_another_uarts_callbacks_change_nothing(void)
{
    begin_dma();
    dma_stands_at(10);
    other_uart.ErrorCode = HAL_UART_ERROR_ORE;
    tmini_stm32_hal_rx_event(&port, &other_uart, 10);
    tmini_stm32_hal_rx_complete(&port, &other_uart);
    tmini_stm32_hal_error(&port, &other_uart);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(0, bytes_in(&counters));
    TEST_ASSERT_EQUAL_UINT32(0, port.counters.overruns);
}

void test_callbacks_before_reception_was_begun_change_nothing(void)
{
    port.uart = &uart;
    tmini_stm32_hal_rx_event(&port, &uart, 10);
    tmini_stm32_hal_rx_complete(&port, &uart);
    tmini_stm32_hal_error(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(0, port.counters.restarts);
}

/* ------------------------------------------------------------------------------------- errors */

void test_each_kind_of_error_is_counted_and_reception_goes_on_from_the_start(void)
{
    begin_dma();
    static const uint32_t codes[] = {
        HAL_UART_ERROR_ORE,
        HAL_UART_ERROR_FE | HAL_UART_ERROR_NE,
        HAL_UART_ERROR_NE,
        HAL_UART_ERROR_DMA,
    };
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        hal_breaks_off(codes[i]);
        HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
        tmini_stm32_hal_error(&port, &uart);
        hal_receives();
    }
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.overruns);
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(2, port.counters.noise_errors);
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.other_errors);
    TEST_ASSERT_EQUAL_UINT32(4, port.counters.restarts);
}

static void dma_error_at(size_t position)
{
    dma_stands_at(position);
    hal_breaks_off(HAL_UART_ERROR_FE);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    tmini_stm32_hal_error(&port, &uart);
    hal_receives();
    dma_stands_at(0);
}

void test_what_came_before_an_error_is_kept(void)
{
    begin_dma();
    put_packet(300);
    event_at(256);
    (void)poll();
    dma_error_at(300 + PACKET_SIZE);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

void test_a_packet_of_the_round_before_does_not_come_again_after_an_error(void)
{
    begin_dma();
    put_packet(300);
    event_at(256);
    (void)poll();
    event_at(511);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
    event_at(200);
    (void)poll();
    dma_error_at(260);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

void test_packets_after_an_error_come_from_the_buffers_start(void)
{
    begin_dma();
    event_at(200);
    (void)poll();
    dma_error_at(400);
    (void)poll();
    put_packet(0);
    event_at(PACKET_SIZE);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(512 + PACKET_SIZE, bytes_in(&counters));
}

void test_packets_that_come_soon_after_an_error_are_found(void)
{
    begin_dma();
    event_at(100);
    (void)poll();
    dma_error_at(100);
    (void)poll();
    put_packet(0);
    event_at(130); /* Farther than where the error was, before any half event. */
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(512 + 130, bytes_in(&counters));
}

void test_an_error_before_the_first_byte_passes_nothing(void)
{
    begin_dma();
    dma_error_at(0);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(0, bytes_in(&counters));
}

void test_a_dma_controller_that_was_reset_by_the_error_is_not_believed(void)
{
    begin_dma();
    event_at(100);
    (void)poll();
    put_packet(400); /* Old bytes. */
    dma_error_at(512);
    TEST_ASSERT_EQUAL_UINT32(0, poll().parser.packets);
}

void test_an_error_after_which_the_hal_goes_on_is_only_counted(void)
{
    begin_bytes();
    uart.ErrorCode = HAL_UART_ERROR_NE;
    tmini_stm32_hal_error(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.noise_errors);
    TEST_ASSERT_EQUAL_UINT32(0, port.counters.restarts);
}

void test_a_restart_that_fails_is_tried_again_by_polling(void)
{
    begin_dma();
    hal_breaks_off(HAL_UART_ERROR_ORE);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_ERROR);
    tmini_stm32_hal_error(&port, &uart);

    tick_ms = 1003;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_ERROR);
    (void)tmini_poll(&lidar);

    tick_ms = 1006;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    (void)tmini_poll(&lidar);
    TEST_ASSERT_EQUAL_UINT32(3, port.counters.restarts);
}

/* The HAL marks a reception as ended some time before it calls back. */
void test_a_reception_that_has_just_ended_is_left_to_the_callback(void)
{
    begin_dma();
    tick_ms = 5000;
    (void)tmini_poll(&lidar);
    hal_breaks_off(HAL_UART_ERROR_ORE);
    tick_ms = 5002;
    (void)tmini_poll(&lidar);
    TEST_ASSERT_EQUAL_UINT32(0, port.counters.restarts);
}

void test_a_reception_that_ended_without_any_callback_is_started_again(void)
{
    begin_dma();
    tick_ms = 5000;
    (void)tmini_poll(&lidar);
    uart.RxState = HAL_UART_STATE_READY;
    tick_ms = 5003;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, rx, RX_SIZE, HAL_OK);
    (void)tmini_poll(&lidar);
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.restarts);
}

/* ------------------------------------------------------------------------------------- blocks */

void test_blocks_are_refused_with_anything_missing(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(NULL, &lidar, &uart, block, BLOCK_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(&port, NULL, &uart, block, BLOCK_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, NULL, block, BLOCK_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, NULL, BLOCK_SIZE));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, block, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_hal_receive_blocks(&port, &lidar, &uart, block, 65536));
}

void test_a_block_by_interrupt_is_copied_and_the_next_one_asked_for(void)
{
    begin_blocks_by_interrupt();
    memcpy(block, packet, PACKET_SIZE);
    uart.RxState = HAL_UART_STATE_READY;
    HAL_UARTEx_ReceiveToIdle_IT_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    tmini_stm32_hal_rx_event(&port, &uart, PACKET_SIZE);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
    TEST_ASSERT_EQUAL_UINT32(0, port.counters.restarts);
}

void test_each_block_begins_at_its_first_byte(void)
{
    begin_blocks_by_interrupt();
    memcpy(block, packet, PACKET_SIZE);
    for (uint32_t blocks = 1; blocks <= 2; blocks++) {
        uart.RxState = HAL_UART_STATE_READY;
        HAL_UARTEx_ReceiveToIdle_IT_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
        tmini_stm32_hal_rx_event(&port, &uart, PACKET_SIZE);
        hal_receives();
        TEST_ASSERT_EQUAL_UINT32(blocks, poll().parser.packets);
    }
}

void test_a_block_by_plain_dma_is_copied_once_and_the_next_one_asked_for(void)
{
    begin_blocks_by_dma(DMA_NORMAL);
    memcpy(&block[25], packet, PACKET_SIZE);
    tmini_stm32_hal_rx_event(&port, &uart, 32); /* Half full; goes on. */
    uart.RxState = HAL_UART_STATE_READY;
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    tmini_stm32_hal_rx_event(&port, &uart, 25 + PACKET_SIZE); /* Idle: ended. */
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(25 + PACKET_SIZE, bytes_in(&counters));
}

void test_blocks_by_circular_dma_go_round_without_being_asked_for(void)
{
    begin_blocks_by_dma(DMA_CIRCULAR);
    tmini_stm32_hal_rx_event(&port, &uart, 32);
    tmini_stm32_hal_rx_event(&port, &uart, 64);
    memcpy(block, packet, PACKET_SIZE);
    tmini_stm32_hal_rx_event(&port, &uart, PACKET_SIZE);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(64 + PACKET_SIZE, bytes_in(&counters));
}

void test_an_overtaken_event_of_a_block_brings_nothing_twice(void)
{
    begin_blocks_by_dma(DMA_CIRCULAR);
    tmini_stm32_hal_rx_event(&port, &uart, 40);
    tmini_stm32_hal_rx_event(&port, &uart, 32);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(40, bytes_in(&counters));
}

void test_an_event_beyond_the_blocks_end_brings_nothing(void)
{
    begin_blocks_by_dma(DMA_CIRCULAR);
    tmini_stm32_hal_rx_event(&port, &uart, BLOCK_SIZE + 1);
    const tmini_counters_t counters = poll();
    TEST_ASSERT_EQUAL_UINT32(0, bytes_in(&counters));
}

void test_what_a_block_by_interrupt_held_before_an_error_is_kept(void)
{
    begin_blocks_by_interrupt();
    memcpy(block, packet, PACKET_SIZE);
    uart.RxXferCount = (uint16_t)(BLOCK_SIZE - PACKET_SIZE);
    hal_breaks_off(HAL_UART_ERROR_ORE);
    HAL_UARTEx_ReceiveToIdle_IT_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    tmini_stm32_hal_error(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

void test_what_a_block_by_dma_held_before_an_error_is_kept(void)
{
    begin_blocks_by_dma(DMA_NORMAL);
    memcpy(block, packet, PACKET_SIZE);
    stream.NDTR = (uint32_t)(BLOCK_SIZE - PACKET_SIZE);
    hal_breaks_off(HAL_UART_ERROR_FE);
    HAL_UARTEx_ReceiveToIdle_DMA_ExpectAndReturn(&uart, block, BLOCK_SIZE, HAL_OK);
    tmini_stm32_hal_error(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

/* -------------------------------------------------------------------------------------- bytes */

void test_bytes_are_refused_with_anything_missing(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_receive_bytes(NULL, &lidar, &uart));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_receive_bytes(&port, NULL, &uart));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_receive_bytes(&port, &lidar, NULL));
}

void test_each_byte_is_stored_and_the_next_one_asked_for(void)
{
    begin_bytes();
    for (size_t i = 0; i < PACKET_SIZE; i++) {
        port.byte = packet[i];
        HAL_UART_Receive_IT_ExpectAndReturn(&uart, &port.byte, 1, HAL_OK);
        tmini_stm32_hal_rx_complete(&port, &uart);
    }
    TEST_ASSERT_EQUAL_UINT32(1, poll().parser.packets);
}

/* Older HALs lock the handle while a transmission is begun. */
void test_a_byte_that_cannot_be_asked_for_is_asked_for_again_by_polling(void)
{
    begin_bytes();
    uart.RxState = HAL_UART_STATE_READY;
    HAL_UART_Receive_IT_ExpectAndReturn(&uart, &port.byte, 1, HAL_BUSY);
    tmini_stm32_hal_rx_complete(&port, &uart);

    tick_ms = 1003;
    HAL_UART_Receive_IT_ExpectAndReturn(&uart, &port.byte, 1, HAL_OK);
    (void)tmini_poll(&lidar);
}

void test_an_overrun_starts_the_reception_of_bytes_again(void)
{
    begin_bytes();
    hal_breaks_off(HAL_UART_ERROR_ORE);
    HAL_UART_Receive_IT_ExpectAndReturn(&uart, &port.byte, 1, HAL_OK);
    tmini_stm32_hal_error(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(1, port.counters.overruns);
}

/* ------------------------------------------------------------------------------------- sending */

static const uint8_t command[] = {0xA5, 0x60};

static void expect_transmission(HAL_StatusTypeDef status)
{
    HAL_UART_Transmit_IT_ExpectWithArrayAndReturn(&uart, 1, command, 2, 2, status);
}

void test_a_command_is_sent_by_interrupt_from_a_copy(void)
{
    begin_dma();
    expect_transmission(HAL_OK);
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_hal_port.write(&port, command, 2));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(command, port.sending, 2);
}

void test_a_busy_transmitter_takes_nothing_and_keeps_what_it_sends(void)
{
    begin_dma();
    expect_transmission(HAL_OK);
    (void)tmini_stm32_hal_port.write(&port, command, 2);
    uart.gState = HAL_UART_STATE_BUSY_TX;
    static const uint8_t next[] = {0xA5, 0x65};
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_hal_port.write(&port, next, 2));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(command, port.sending, 2);
}

void test_a_locked_hal_takes_nothing(void)
{
    begin_dma();
    expect_transmission(HAL_BUSY);
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_hal_port.write(&port, command, 2));
}

void test_a_hal_error_is_a_write_error(void)
{
    begin_dma();
    expect_transmission(HAL_ERROR);
    TEST_ASSERT_EQUAL_INT(-1, tmini_stm32_hal_port.write(&port, command, 2));
}

void test_more_than_a_command_is_refused(void)
{
    static const uint8_t three[] = {1, 2, 3};
    begin_dma();
    TEST_ASSERT_EQUAL_INT(-1, tmini_stm32_hal_port.write(&port, three, 3));
}

void test_sending_before_reception_was_begun_is_a_write_error(void)
{
    set_up_lidar(true);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&lidar));
    TEST_ASSERT_EQUAL(TMINI_EVENT_FAILED, tmini_poll(&lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_WRITE, tmini_failure(&lidar));
}

/* ----------------------------------------------------------------------------- clock and waiting */

void test_the_clock_is_the_hals(void)
{
    tick_ms = 0xFFFFFFFF;
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFF, tmini_stm32_hal_port.now_ms(&port));
}

void test_waiting_sleeps_until_the_next_interrupt(void)
{
    __WFI_Expect();
    tmini_stm32_hal_port.wait(&port);
}
