/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the CubeMX example on the model: from bytes on the line to the pin that lets the robot
 * move. Its state is not reset: each test begins long after the one before. */

#include "lidar.h"
#include "usart.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "console.h"
#include "encoder.h"
#include "line.h"
#include "unity.h"

#define DEGREE_Q6 64u
#define PACKET_SAMPLES 40u
#define HEALTH_INDEX 3u
#define PD_CT 0x10 /* The health bit PD, 0x08, shifted by one. */

GPIO_TypeDef stm32_model_gpiob;
UART_HandleTypeDef huart1;

static DMA_HandleTypeDef dma;
static uint8_t sent[2]; /* The last two bytes sent. */
static bool may_move;
static uint32_t led_changes;
static uint32_t errors_handled;
static uint64_t day_us;
static uint32_t calls_every_ms = 1;

static unsigned index_in_turn;
static uint8_t health_ct; /* The CT byte with the health bits (section 7); 0: no CT information. */
static uint8_t crc;
static bool next_is_harmed;

int console_printf(const char *format, ...);

int console_printf(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = console_print(model.now_ns / 1000u, format, arguments);
    va_end(arguments);
    return length;
}

static void usart_interrupt(void)
{
    HAL_UART_IRQHandler(&huart1);
}

static void dma_interrupt(void)
{
    HAL_DMA_IRQHandler(&dma);
}

static void note_sent(uint8_t byte, uint64_t now_us)
{
    (void)now_us;
    sent[0] = sent[1];
    sent[1] = byte;
}

void HAL_UART_RxHalfCpltCallback(UART_HandleTypeDef *huart)
{
    (void)huart;
}

void HAL_UART_RxCpltCallback(UART_HandleTypeDef *huart)
{
    (void)huart;
}

void HAL_GPIO_WritePin(GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin, GPIO_PinState PinState)
{
    TEST_ASSERT_EQUAL_PTR(&stm32_model_gpiob, GPIOx);
    TEST_ASSERT_EQUAL_HEX16(GPIO_PIN_0, GPIO_Pin);
    may_move = PinState == GPIO_PIN_SET;
}

void HAL_GPIO_TogglePin(GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin)
{
    TEST_ASSERT_EQUAL_PTR(&stm32_model_gpiob, GPIOx);
    TEST_ASSERT_EQUAL_HEX16(GPIO_PIN_1, GPIO_Pin);
    led_changes++;
}

void Error_Handler(void)
{
    errors_handled++;
}

void __WFI(void) {}

void setUp(void)
{
    model_reset();
    day_us += 1000000000u;
    model.tick_ns = day_us * 1000u;
    model.now_ns = day_us * 1000u;
    irq.lines[MODEL_USART_IRQ].handler = usart_interrupt;
    irq.lines[MODEL_DMA_IRQ].handler = dma_interrupt;
    model.sent = note_sent;
    line_open();
    console_begin();
    dma = (DMA_HandleTypeDef){.Init = {.Mode = DMA_CIRCULAR, .MemInc = DMA_MINC_ENABLE}};
    huart1 = (UART_HandleTypeDef){
        .Instance = &model_usart,
        .Init = {.BaudRate = 230400},
        .hdmarx = &dma,
        .gState = HAL_UART_STATE_READY,
        .RxState = HAL_UART_STATE_READY,
    };
    health_ct = 0;
    next_is_harmed = false;
    led_changes = 0;
    errors_handled = 0;
}

void tearDown(void) {}

static uint32_t ms_past;

static void work_for(uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        model_pass(1000);
        if (++ms_past % calls_every_ms == 0) {
            lidar_work();
        }
    }
}

/* Runs from reset to the start command: a stop command, a quiet line, a question that is answered
 * (6.00 Hz), a start command. */
static void start_scanning(void)
{
    lidar_start(&huart1);
    work_for(2);
    TEST_ASSERT_EQUAL_HEX8(0x65, sent[1]);
    static const uint8_t answer[] = {0xA5, 0x5A, 4, 0, 0, 0, 4, 0x58, 2, 0, 0};
    work_for(60);
    TEST_ASSERT_EQUAL_HEX8(0x0D, sent[1]);
    line_send(answer, sizeof answer);
    work_for(5);
    TEST_ASSERT_EQUAL_HEX8(0x60, sent[1]);
    static const uint8_t reply[] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
    line_send(reply, sizeof reply);
    work_for(2);
}

/* With CT information, a byte LastCRC ends each revolution. */
static uint8_t next_ct(bool starts)
{
    if (starts && health_ct != 0) {
        line_send(&crc, 1);
    }
    index_in_turn = starts ? 0 : index_in_turn + 1;
    const uint8_t ct = starts ? 1 : index_in_turn == HEALTH_INDEX ? health_ct : 0;
    crc = encode_crc8(starts ? 0 : crc, ct);
    return ct;
}

/* Samples are one degree apart. Those within 10 degrees of `near` are at `near_mm`, all others at
 * 2 m. */
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
    line_send(bytes, length);
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
    for (unsigned turn = 0; turn < 3; turn++) {
        arrive_revolution(near, near_mm);
    }
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

void test_printing_leaves_time_for_the_lidar(void)
{
    start_scanning();
    for (unsigned turn = 0; turn < 50; turn++) {
        arrive_revolution(0, 2000);
    }
    assert_console_leaves_time(1024);
}

void test_something_near_in_front_stops_the_robot(void)
{
    scan_with(350, 250);
    TEST_ASSERT_FALSE(may_move);
    TEST_ASSERT_EQUAL_UINT16(250, lidar_ahead_mm());
}

void test_something_near_at_the_back_does_not(void)
{
    scan_with(180, 250);
    TEST_ASSERT_TRUE(may_move);
}

void test_no_range_is_not_near(void)
{
    scan_with(0, 0);
    TEST_ASSERT_TRUE(may_move);
}

void test_a_scan_that_lacks_the_front_does_not_let_the_robot_go(void)
{
    scan_with(20, 250);
    TEST_ASSERT_FALSE(may_move);
    next_is_harmed = true; /* The packet with 1 to 40 degrees is lost. */
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
    arrive_revolution(0, 320);
    arrive_revolution(0, 320);
    arrive_packet(true, 0, 1, 0, 320);
    TEST_ASSERT_EQUAL_UINT16(320, lidar_ahead_mm());
    TEST_ASSERT_FALSE(may_move);
}

void test_a_robot_without_scans_stops(void)
{
    scan_with(0, 2000);
    work_for(250);
    TEST_ASSERT_TRUE(may_move);
    work_for(60);
    TEST_ASSERT_FALSE(may_move);
}

void test_reception_continues_after_line_errors_and_after_a_stop(void)
{
    static const uint8_t broken = 0;
    start_scanning();
    line_send_with(MODEL_FE);
    line_send(&broken, 1);
    work_for(5);
    huart1.RxState = HAL_UART_STATE_READY;
    work_for(5);
    for (unsigned turn = 0; turn < 3; turn++) {
        arrive_revolution(0, 2000);
    }
    arrive_packet(true, 0, 1, 0, 2000);
    TEST_ASSERT_TRUE(may_move);
}

/* At each call, at least 3 packets wait. */
void test_a_main_loop_of_30_ms_loses_nothing(void)
{
    start_scanning();
    arrive_revolution(0, 2000);
    calls_every_ms = 30;
    for (unsigned turn = 0; turn < 20; turn++) {
        arrive_revolution(0, 2000);
    }
    calls_every_ms = 1;
    arrive_packet(true, 0, 1, 0, 2000);
    TEST_ASSERT_EQUAL_UINT32(21, led_changes);
}

void test_the_led_changes_with_every_complete_scan(void)
{
    scan_with(0, 2000);
    TEST_ASSERT_EQUAL_UINT32(3, led_changes);
    arrive_rest(0, 2000);
    arrive_packet(true, 0, 1, 0, 2000);
    TEST_ASSERT_EQUAL_UINT32(4, led_changes);
}

void test_a_uart_not_set_up_as_in_the_readme_calls_the_error_handler(void)
{
    dma.Init.Mode = DMA_NORMAL;
    lidar_start(&huart1);
    TEST_ASSERT_EQUAL_UINT32(1, errors_handled);
    dma.Init.Mode = DMA_CIRCULAR;
    huart1.Init.BaudRate = 115200;
    lidar_start(&huart1);
    TEST_ASSERT_EQUAL_UINT32(2, errors_handled);
}

void test_a_lidar_that_does_not_answer_is_asked_again(void)
{
    start_scanning();
    work_for(20000); /* Three attempts have failed. */
    memset(sent, 0, sizeof sent);
    work_for(3000);
    TEST_ASSERT_EQUAL_HEX8(0xA5, sent[0]);
}
