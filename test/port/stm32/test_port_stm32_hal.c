/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port on the model of USART, DMA and HAL, one situation at a time. Compiled for
 * several families and years of the HAL: see stm32_model/stm32_model.h. */

#include "hal_rig.h"

#include <string.h>

#include "unity.h"

#define PACKET LINE_PACKET_SIZE

static uint32_t commands_sent;
static uint8_t last_sent[2];

static void note_sent(uint8_t byte, uint64_t now_us)
{
    (void)now_us;
    last_sent[commands_sent++ % 2] = byte;
}

void setUp(void)
{
    commands_sent = 0;
}

void tearDown(void) {}

/* --------------------------------------------------------------------------------- byte by byte */

void test_bytes_reach_the_lidar(void)
{
    hal_rig_open_and_start(BY_BYTES);
    hal_rig_receive(200);
    TEST_ASSERT_EQUAL_UINT32(200, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(200 * PACKET, irq.lines[MODEL_USART_IRQ].served);
}

void test_bytes_line_errors_are_counted_and_cost_no_byte(void)
{
    hal_rig_open_and_start(BY_BYTES);
    line_send_with(MODEL_FE);
    line_send_packets(1);
    line_send_with(MODEL_NE);
    hal_rig_receive(1);
    TEST_ASSERT_EQUAL_UINT32(2, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().noise_errors);
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
}

void test_bytes_a_late_interrupt_is_an_overrun_that_is_counted_and_survived(void)
{
    hal_rig_open_and_start(BY_BYTES);
    line_send_packets(3);
    model.held_until_ns = model.now_ns + 16 * MODEL_BYTE_NS; /* Until the second packet. */
    hal_rig_run();
    hal_rig_receive(1);
    TEST_ASSERT_EQUAL_UINT32(2, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().overruns);
}

/* Bytes 7 to 19 of two packets are lost. The other 13 bytes look like one packet. */
void test_bytes_no_packet_continues_across_an_overrun(void)
{
    hal_rig_open_and_start(BY_BYTES);
    line_send_packets(2);
    model_pass(MODEL_BYTE_NS * 13 / 2000);
    model.held_until_ns = model.now_ns + 14 * MODEL_BYTE_NS;
    hal_rig_run();
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().overruns);
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_packets());
}

/* Only the overrun flag is set: the byte before it has already been read. */
void test_bytes_an_overrun_without_a_byte_stops_reception_only_until_the_next_poll(void)
{
    hal_rig_open_and_start(BY_BYTES);
    hal_rig_receive(1);
    model.flags |= MODEL_ORE;
    model_pass(1000);
    (void)hal_rig_poll();
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().overruns);
    TEST_ASSERT_LESS_THAN_UINT32(20, irq.lines[MODEL_USART_IRQ].served);
    hal_rig_receive(2);
    TEST_ASSERT_EQUAL_UINT32(3, hal_rig_packets());
}

void test_bytes_reception_starts_after_a_controller_reset_while_the_lidar_spins(void)
{
    hal_rig_open(BY_BYTES);
    line_send_packets(8);
    model_pass(2000); /* An overrun is pending. */
    TEST_ASSERT_NOT_EQUAL(0, model.flags & MODEL_ORE);
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
    hal_rig_run();
    TEST_ASSERT_GREATER_THAN_UINT32(2, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
}

void test_bytes_the_port_waits_for_a_handle_that_others_have_locked(void)
{
    if (STM32_MODEL_YEAR > 2021) {
        TEST_IGNORE_MESSAGE("newer HALs lock nothing");
    }
    hal_rig_open_and_start(BY_BYTES);
    hal_rig.uart.Lock = true;
    hal_rig_receive(1);
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_packets());
    hal_rig.uart.Lock = false;
    model_pass(5000);
    (void)hal_rig_poll();
    hal_rig_receive(2);
    TEST_ASSERT_EQUAL_UINT32(2, hal_rig_packets());
}

void test_bytes_do_not_arrive_after_stop_and_arrive_again_after_start(void)
{
    hal_rig_open_and_start(BY_BYTES);
    hal_rig_receive(1);
    tmini_stm32_hal_stop(&hal_rig.port);
    hal_rig_receive(2);
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_packets());
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
    hal_rig_receive(2);
    TEST_ASSERT_EQUAL_UINT32(3, hal_rig_packets());
}

/* Fills the receive buffer to its end and empties it, so that the next byte goes to its beginning.
 * That byte comes during the restart, at each access in turn. */
void test_bytes_that_come_during_a_restart_stay_within_the_buffer(void)
{
    static uint8_t memory[256 + 1];
    static const uint8_t noise[256 + 1];
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &hal_rig.port,
        .rx_buffer = memory,
        .rx_size = 256,
    };
    for (uint32_t accesses = 1; accesses <= 40; accesses++) {
        hal_rig_open(BY_BYTES);
        TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&hal_rig.lidar, &config));
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        line_send(noise, 256);
        hal_rig_run();
        memory[256] = 0xEE;
        line_send(noise, 1);
        model_pass(MODEL_BYTE_NS / 1000);
        model.access_ns = MODEL_BYTE_NS % 1000 / accesses + 1;
        tmini_stm32_hal_port.restart(&hal_rig.port);
        TEST_ASSERT_EQUAL_HEX8(0xEE, memory[256]);
    }
}

/* Only DMA needs aligned buffers. */
void test_bytes_need_no_aligned_buffer(void)
{
    static uint8_t odd[257];
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &hal_rig.port,
        .rx_buffer = &odd[1],
        .rx_size = 256,
    };
    hal_rig_open(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&hal_rig.lidar, &config));
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
}

/* ------------------------------------------------------------------------------ what is refused */

void test_null_pointers_are_refused(void)
{
    hal_rig_open(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_init(NULL, &hal_rig.uart));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_init(&hal_rig.port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(NULL, &hal_rig.lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&hal_rig.port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE,
                      tmini_stm32_hal_start_blocks(NULL, &hal_rig.lidar, hal_rig_block, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE,
                      tmini_stm32_hal_start_blocks(&hal_rig.port, NULL, hal_rig_block, 256));
    tmini_stm32_hal_stop(NULL);
}

void test_a_port_or_a_lidar_that_is_not_set_up_is_refused(void)
{
    static tmini_stm32_hal_t no_port;
    static tmini_t no_lidar;
    hal_rig_open(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&no_port, &hal_rig.lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start(&hal_rig.port, &no_lidar));
    tmini_stm32_hal_stop(&no_port);
}

/* CubeMX proposes 115200 baud. */
void test_another_baud_rate_or_format_is_refused(void)
{
    hal_rig_open(BY_BYTES);
    hal_rig.uart.Init.BaudRate = 115200;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
    hal_rig_open(BY_BYTES);
    hal_rig.uart.Init.Parity = UART_PARITY_EVEN;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
    hal_rig_open(BY_BYTES);
    hal_rig.uart.Init.WordLength = UART_WORDLENGTH_9B;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
}

/* Without the HAL's DMA module, and without a channel. */
void test_dma_is_refused_if_there_is_none(void)
{
    static const hal_rig_way_t ways[] = {BY_DMA, BY_BLOCKS};
    for (unsigned i = 0; i < 2; i++) {
        hal_rig_open(ways[i]);
#ifdef HAL_DMA_MODULE_ENABLED
        hal_rig.uart.hdmarx = NULL;
#endif
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
    }
}

/* -------------------------------------------------------------------------------------- sending */

void test_a_command_is_sent_by_interrupt_from_a_copy(void)
{
    uint8_t command[] = {0xA5, 0x60};
    hal_rig_open_and_start(BY_BYTES);
    model.sent = note_sent;
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_hal_port.write(&hal_rig.port, command, 2));
    memset(command, 0, sizeof command);
    model_pass(1000);
    TEST_ASSERT_EQUAL_UINT32(2, commands_sent);
    TEST_ASSERT_EQUAL_HEX8(0xA5, last_sent[0]);
    TEST_ASSERT_EQUAL_HEX8(0x60, last_sent[1]);
}

void test_a_busy_transmitter_takes_nothing_and_finishes_its_command(void)
{
    static const uint8_t first[] = {0xA5, 0x60};
    static const uint8_t second[] = {0xA5, 0x65};
    hal_rig_open_and_start(BY_BYTES);
    model.sent = note_sent;
    irq.lines[MODEL_USART_IRQ].disabled = true;
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_hal_port.write(&hal_rig.port, first, 2));
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_hal_port.write(&hal_rig.port, second, 2));
    irq.lines[MODEL_USART_IRQ].disabled = false;
    model_pass(1000);
    TEST_ASSERT_EQUAL_UINT32(2, commands_sent);
    TEST_ASSERT_EQUAL_HEX8(0x60, last_sent[1]);
}

void test_writing_too_much_or_without_a_uart_is_an_error(void)
{
    static const uint8_t bytes[3];
    static tmini_stm32_hal_t no_port;
    hal_rig_open_and_start(BY_BYTES);
    TEST_ASSERT_LESS_THAN_INT(0, tmini_stm32_hal_port.write(&hal_rig.port, bytes, 3));
    TEST_ASSERT_LESS_THAN_INT(0, tmini_stm32_hal_port.write(&no_port, bytes, 2));
}

void test_the_clock_is_the_hals(void)
{
    hal_rig_open(BY_BYTES);
    model_pass(12345678);
    TEST_ASSERT_EQUAL_UINT32(12345, tmini_stm32_hal_port.now_ms(&hal_rig.port));
}

void test_waiting_sleeps_until_the_next_interrupt(void)
{
    hal_rig_open(BY_BYTES);
    tmini_stm32_hal_port.wait(&hal_rig.port);
    TEST_ASSERT_EQUAL_UINT32(1, tmini_stm32_hal_port.now_ms(&hal_rig.port));
}
