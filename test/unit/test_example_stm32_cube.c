/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The example for CubeMX projects, over a mocked HAL: from DMA's events to the pin that lets the robot
 * move. The example's state outlives a test, as a robot's does; each test is far from the one before
 * in time. */

#include "lidar.h"
#include "usart.h"

#include <string.h>

#include "encoder.h"
#include "mock_stm32_stub_hal.h"
#include "unity.h"

#define DEGREE_Q6 64u
#define PACKET_SAMPLES 40u
#define HEALTH_INDEX 3u
#define PD_CT 0x10 /* The health bit PD, 0x08, above bit 0. */

bool stm32_stub_is_masked;
bool stm32_stub_was_read_unmasked;
GPIO_TypeDef stm32_stub_gpiob;
UART_HandleTypeDef huart1;

static DMA_Stream_TypeDef stream;
static DMA_HandleTypeDef dma;
static uint32_t tick_ms;
static uint8_t *buffer; /* Where DMA writes. */
static size_t size;
static size_t written; /* What DMA has written in all. */
static uint8_t sent[2];
static bool may_move;

static unsigned index_in_turn;
static uint8_t health_ct; /* The CT byte with the health bits (section 7); 0: no CT information. */
static uint8_t crc;
static bool next_is_harmed;

static uint32_t get_tick(int calls)
{
    (void)calls;
    return tick_ms;
}

static HAL_StatusTypeDef receive(UART_HandleTypeDef *uart, hal_memory_t *memory, uint16_t count,
                                 int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(&huart1, uart);
    buffer = memory;
    size = count;
    stream.NDTR = count;
    huart1.RxState = HAL_UART_STATE_BUSY_RX;
    return HAL_OK;
}

static HAL_StatusTypeDef transmit(UART_HandleTypeDef *uart, const uint8_t *bytes, uint16_t count,
                                  int calls)
{
    (void)uart;
    (void)calls;
    TEST_ASSERT_EQUAL_UINT16(2, count);
    memcpy(sent, bytes, 2);
    return HAL_OK;
}

static void write_pin(GPIO_TypeDef *gpio, uint16_t pin, GPIO_PinState state, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(&stm32_stub_gpiob, gpio);
    TEST_ASSERT_EQUAL_HEX16(GPIO_PIN_0, pin);
    may_move = state == GPIO_PIN_SET;
}

void setUp(void)
{
    dma = (DMA_HandleTypeDef){.Instance = &stream, .Init.Mode = DMA_CIRCULAR};
    huart1 = (UART_HandleTypeDef){
        .hdmarx = &dma,
        .gState = HAL_UART_STATE_READY,
        .RxState = HAL_UART_STATE_READY,
    };
    written = 0;
    health_ct = 0;
    next_is_harmed = false;
    tick_ms += 100000;
    HAL_GetTick_Stub(get_tick);
    HAL_UARTEx_ReceiveToIdle_DMA_Stub(receive);
    HAL_UART_Transmit_IT_Stub(transmit);
    HAL_GPIO_WritePin_Stub(write_pin);
}

void tearDown(void) {}

static void work_for(uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        tick_ms++;
        lidar_work();
    }
}

/* From reset to the start command: stop, a quiet line, start. */
static void start_scanning(void)
{
    lidar_start();
    TEST_ASSERT_EQUAL_HEX8(0x65, sent[1]);
    work_for(60);
    TEST_ASSERT_EQUAL_HEX8(0x60, sent[1]);
}

static void arrive(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        buffer[written % size] = bytes[i];
        written++;
    }
    stream.NDTR = (uint32_t)(size - written % size);
    HAL_UARTEx_RxEventCallback(&huart1, (uint16_t)(written % size));
}

/* Behind a start packet's revolution comes LastCRC, if there is CT information. */
static uint8_t next_ct(bool starts)
{
    if (starts && health_ct != 0) {
        arrive(&crc, 1);
    }
    index_in_turn = starts ? 0 : index_in_turn + 1;
    const uint8_t ct = starts ? 1 : index_in_turn == HEALTH_INDEX ? health_ct : 0;
    crc = encode_crc8(starts ? 0 : crc, ct);
    return ct;
}

/* Samples a degree apart, all at 2 m but for those with `near_mm` from 10 degrees before `near` to 10
 * behind it. */
static void arrive_packet(bool starts, unsigned first, unsigned count, unsigned near,
                          uint16_t near_mm)
{
    encode_sample_t samples[PACKET_SAMPLES];
    uint8_t bytes[10 + 3 * PACKET_SAMPLES];
    for (unsigned i = 0; i < count; i++) {
        const unsigned away = (first + i + 360u - near) % 360u;
        const bool is_near = away <= 10u || away >= 350u;
        samples[i] = (encode_sample_t){.distance_mm = is_near ? near_mm : 2000};
    }
    const encode_packet_t packet = {
        .ct = next_ct(starts),
        .lsn = (uint8_t)count,
        .first_q6 = (uint16_t)(first * DEGREE_Q6),
        .last_q6 = (uint16_t)((first + count - 1) * DEGREE_Q6),
        .samples = samples,
    };
    const size_t length = encode_packet(bytes, &packet);
    bytes[length - 1] ^= next_is_harmed ? 0x55 : 0;
    next_is_harmed = false;
    arrive(bytes, length);
    work_for(10);
}

static void arrive_rest(unsigned near, uint16_t near_mm)
{
    for (unsigned first = 1; first < 360; first += PACKET_SAMPLES) {
        const unsigned left = 360 - first;
        arrive_packet(false, first, left < PACKET_SAMPLES ? left : PACKET_SAMPLES, near, near_mm);
    }
}

static void arrive_revolution(unsigned near, uint16_t near_mm)
{
    arrive_packet(true, 0, 1, near, near_mm);
    arrive_rest(near, near_mm);
}

static void scan_with(unsigned near, uint16_t near_mm)
{
    start_scanning();
    arrive_revolution(near, near_mm);
    arrive_packet(true, 0, 1, near, near_mm);
}

void test_the_robot_may_not_move_before_anything_is_seen(void)
{
    start_scanning();
    TEST_ASSERT_FALSE(may_move);
}

void test_the_robot_may_move_when_all_is_far(void)
{
    scan_with(0, 2000);
    TEST_ASSERT_TRUE(may_move);
    TEST_ASSERT_EQUAL_UINT16(2000, lidar_ahead_mm());
}

void test_something_near_in_front_stops_the_robot(void)
{
    scan_with(350, 250);
    TEST_ASSERT_FALSE(may_move);
    TEST_ASSERT_EQUAL_UINT16(250, lidar_ahead_mm());
}

void test_something_near_behind_does_not(void)
{
    scan_with(180, 250);
    TEST_ASSERT_TRUE(may_move);
}

void test_no_range_is_not_near(void)
{
    scan_with(0, 0);
    TEST_ASSERT_TRUE(may_move);
}

void test_a_scan_that_has_lost_what_is_in_front_does_not_let_the_robot_go(void)
{
    scan_with(20, 250);
    TEST_ASSERT_FALSE(may_move);
    next_is_harmed = true; /* 1 to 40 degrees. */
    arrive_rest(20, 250);
    arrive_packet(true, 0, 1, 20, 250);
    TEST_ASSERT_EQUAL_UINT16(2000, lidar_ahead_mm());
    TEST_ASSERT_FALSE(may_move);
}

void test_a_faulty_lidar_stops_the_robot_whatever_it_measures(void)
{
    scan_with(0, 2000);
    TEST_ASSERT_TRUE(may_move);
    health_ct = PD_CT;
    arrive_rest(0, 2000);
    arrive_revolution(0, 2000);
    arrive_revolution(0, 2000);
    arrive_packet(true, 0, 1, 0, 2000);
    TEST_ASSERT_EQUAL_UINT16(2000, lidar_ahead_mm());
    TEST_ASSERT_FALSE(may_move);
}

void test_the_robot_needs_more_room_to_go_on_than_to_stop(void)
{
    scan_with(0, 250);
    arrive_rest(0, 320);
    arrive_packet(true, 0, 1, 0, 320);
    TEST_ASSERT_EQUAL_UINT16(250, lidar_ahead_mm());
    arrive_rest(0, 320);
    arrive_packet(true, 0, 1, 0, 320);
    TEST_ASSERT_EQUAL_UINT16(320, lidar_ahead_mm());
    TEST_ASSERT_FALSE(may_move);
}

void test_a_robot_that_sees_nothing_any_more_stops(void)
{
    scan_with(0, 2000);
    work_for(450);
    TEST_ASSERT_TRUE(may_move);
    work_for(60);
    TEST_ASSERT_FALSE(may_move);
}

void test_reception_goes_on_after_a_line_error(void)
{
    start_scanning();
    huart1.RxState = HAL_UART_STATE_READY;
    huart1.ErrorCode = HAL_UART_ERROR_FE;
    HAL_UART_ErrorCallback(&huart1);
    TEST_ASSERT_EQUAL(HAL_UART_STATE_BUSY_RX, huart1.RxState);
    written = 0;
    arrive_revolution(0, 2000);
    arrive_packet(true, 0, 1, 0, 2000);
    TEST_ASSERT_TRUE(may_move);
}

void test_dma_that_is_not_circular_is_an_error_of_the_project(void)
{
    dma.Init.Mode = DMA_NORMAL;
    Error_Handler_Expect();
    lidar_start();
}

void test_a_lidar_that_does_not_answer_is_asked_again(void)
{
    start_scanning();
    work_for(20000); /* Three attempts, and failed. */
    memset(sent, 0, sizeof sent);
    work_for(3000);
    TEST_ASSERT_EQUAL_HEX8(0xA5, sent[0]);
}
