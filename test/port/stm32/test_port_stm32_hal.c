/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port on the model of USART, DMA and HAL. Compiled for several families and years of
 * the HAL: see stm32_model/stm32_model.h. */

#include "hal_rig.h"

#include <string.h>

#include "unity.h"

static tmini_t small; /* A lidar with a buffer of a test's own. */

static void begin_with_buffer(uint8_t *memory)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &port,
        .rx_buffer = memory,
        .rx_size = 256,
    };
    play_begin(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&small, &config));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_hal_start(&port, &small));
}

static int send(const char *command, size_t size)
{
    return tmini_stm32_hal_port.write(&port, (const uint8_t *)command, size);
}

/* --------------------------------------------------------------------------------- byte by byte */

void test_bytes_the_port_waits_for_a_handle_that_others_have_locked(void)
{
    if (STM32_MODEL_YEAR > 2021) {
        TEST_IGNORE_MESSAGE("newer HALs lock nothing");
    }
    play_start(BY_BYTES);
    huart1.Lock = true;
    TEST_ASSERT_EQUAL_INT(0, send("\xA5\x65", 2));
    play_receive(1);
    TEST_ASSERT_EQUAL_UINT32(0, play_packets());
    huart1.Lock = false;
    machine_pass(5000);
    poll_all();
    play_receive(2);
    TEST_ASSERT_EQUAL_UINT32(2, play_packets());
}

/* Fills the receive buffer to its end and empties it, so that the next byte goes to its beginning.
 * That byte comes during the restart, at each access in turn. */
void test_bytes_that_come_during_a_restart_stay_within_the_buffer(void)
{
    static uint8_t memory[256 + 1];
    static const uint8_t noise[256 + 1];
    for (uint32_t accesses = 1; accesses <= 40; accesses++) {
        begin_with_buffer(memory);
        machine_send(0, noise, 256);
        while (!machine_has_sent() || tmini_poll(&small) != TMINI_EVENT_NONE) {
            machine_pass(1000);
        }
        memory[256] = 0xEE;
        machine_send(0, noise, 1);
        machine_pass(MACHINE_BYTE_NS / 1000);
        machine.access_ns = MACHINE_BYTE_NS % 1000 / accesses + 1;
        tmini_stm32_hal_port.restart(&port);
        TEST_ASSERT_EQUAL_HEX8(0xEE, memory[256]);
    }
}

/* Only DMA needs aligned buffers. */
void test_bytes_need_no_aligned_buffer(void)
{
    static uint8_t odd[257];
    begin_with_buffer(&odd[1]);
}

/* ------------------------------------------------------------------------------ what is refused */

void test_what_is_missing_or_not_set_up_is_refused(void)
{
    static tmini_stm32_hal_t no_port;
    static tmini_t no_lidar;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_init(NULL, &huart1));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_init(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(NULL, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&no_port, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&port, &no_lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE,
                      tmini_stm32_hal_start_blocks(NULL, &lidar, hal_rig_block, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE,
                      tmini_stm32_hal_start_blocks(&port, NULL, hal_rig_block, 256));
    tmini_stm32_hal_stop(NULL);
    tmini_stm32_hal_stop(&no_port);
}

/* CubeMX proposes 115200 baud. */
void test_another_baud_rate_or_format_is_refused(void)
{
    hal_rig_assert_refused(&huart1.Init.BaudRate, 115200);
    hal_rig_assert_refused(&huart1.Init.Parity, UART_PARITY_EVEN);
    hal_rig_assert_refused(&huart1.Init.WordLength, UART_WORDLENGTH_9B);
}

/* Without the HAL's DMA module, and without a channel. */
void test_dma_is_refused_if_there_is_none(void)
{
    for (unsigned way = BY_DMA; way <= BY_BLOCKS; way++) {
        play_begin(way);
#ifdef HAL_DMA_MODULE_ENABLED
        huart1.hdmarx = NULL;
#endif
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
    }
}

/* -------------------------------------------------------------------------------------- sending */

void test_a_command_is_sent_by_interrupt_from_a_copy_which_the_next_one_does_not_change(void)
{
    char command[] = "\xA5\x60";
    play_start(BY_BYTES);
    irq.lines[MODEL_USART_IRQ].disabled = true;
    TEST_ASSERT_EQUAL_INT(2, send(command, 2));
    memset(command, 0, sizeof command);
    TEST_ASSERT_EQUAL_INT(0, send("\xA5\x65", 2)); /* The transmitter is busy. */
    irq.lines[MODEL_USART_IRQ].disabled = false;
    machine_pass(1000);
    TEST_ASSERT_EQUAL_UINT32(2, model.sent_count);
    TEST_ASSERT_EQUAL_HEX8(0xA5, model.sent[0]);
    TEST_ASSERT_EQUAL_HEX8(0x60, model.sent[1]);
}

void test_writing_too_much_or_without_a_uart_is_an_error(void)
{
    static tmini_stm32_hal_t no_port;
    play_start(BY_BYTES);
    TEST_ASSERT_LESS_THAN_INT(0, send("\xA5\x65", 3));
    TEST_ASSERT_LESS_THAN_INT(0, tmini_stm32_hal_port.write(&no_port, hal_rig_block, 2));
}

void test_the_clock_is_the_hals_and_waiting_sleeps_until_the_next_interrupt(void)
{
    machine_pass(12345678);
    TEST_ASSERT_EQUAL_UINT32(12345, tmini_stm32_hal_port.now_ms(&port));
    tmini_stm32_hal_port.wait(&port);
    TEST_ASSERT_EQUAL_UINT32(12346, tmini_stm32_hal_port.now_ms(&port));
}
