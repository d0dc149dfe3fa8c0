/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the CubeMX example on the model: from the simulated lidar to the pin that lets the robot
 * move. Its state is not reset: each test begins long after the one before. */

#include "lidar.h"
#include "usart.h"

#include "console.h"
#include "machine.h"
#include "unity.h"

GPIO_TypeDef stm32_model_gpiob;

static bool may_move;
static uint32_t led_changes;
static uint32_t errors_handled;
static uint64_t day_ns;
static uint32_t ms_past;
static uint32_t calls_every_ms = 1;

/* With this HAL, only for a reception without the idle line. */
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
    model.tick_ns = day_ns += UINT64_C(1000000000000);
    MX_USART1_UART_Init();
    errors_handled = 0;
}

static void work_for(uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        machine_pass(1000);
        if (++ms_past % calls_every_ms == 0) {
            lidar_work();
        }
    }
}

/* Only when all has been seen and is far may the robot move, and only with a healthy lidar; without
 * scans it stops within 300 ms of the last whole one. */
void test_the_robot_moves_only_while_it_may(void)
{
    lidar_start(&huart1);
    work_for(200);
    TEST_ASSERT_FALSE(may_move);
    work_for(3000);
    TEST_ASSERT_TRUE(may_move);
    TEST_ASSERT_GREATER_THAN_UINT16(1000, lidar_ahead_mm());
    sim_place_obstacle(&machine.lidar, 350 * 64, 640, 250);
    work_for(1000);
    TEST_ASSERT_FALSE(may_move);
    TEST_ASSERT_UINT16_WITHIN(10, 250, lidar_ahead_mm());
    sim_clear_obstacles(&machine.lidar);
    sim_set_health(&machine.lidar, SIM_HEALTH_PD);
    work_for(1500);
    TEST_ASSERT_GREATER_THAN_UINT16(1000, lidar_ahead_mm());
    TEST_ASSERT_FALSE(may_move);
    sim_set_health(&machine.lidar, 0);
    work_for(1500);
    machine_power(false);
    work_for(90);
    TEST_ASSERT_TRUE(may_move);
    work_for(220);
    TEST_ASSERT_FALSE(may_move);
}

/* At each call, at least 3 packets wait. The LED changes with every complete scan, six per
 * second. */
void test_a_main_loop_of_30_ms_loses_nothing_and_printing_leaves_time_for_the_lidar(void)
{
    lidar_start(&huart1);
    work_for(3000);
    led_changes = 0;
    calls_every_ms = 30;
    work_for(5000);
    calls_every_ms = 1;
    TEST_ASSERT_UINT32_WITHIN(1, 30, led_changes);
    assert_console_leaves_time(1024);
    assert_last_said("lidar scanning, faults none, scans ");
}

void test_a_uart_not_set_up_as_in_the_readme_calls_the_error_handler(void)
{
    hdma_usart1_rx.Init.Mode = DMA_NORMAL;
    lidar_start(&huart1);
    TEST_ASSERT_EQUAL_UINT32(1, errors_handled);
    hdma_usart1_rx.Init.Mode = DMA_CIRCULAR;
    huart1.Init.BaudRate = 115200;
    lidar_start(&huart1);
    TEST_ASSERT_EQUAL_UINT32(2, errors_handled);
}
