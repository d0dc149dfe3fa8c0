/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port with DMA on the model, both into the lidar's buffer and by blocks: events,
 * errors, laps. Compiled for several families and years of the HAL. */

#include "hal_rig.h"

#include <string.h>

#include "stm32_scenes.h"
#include "unity.h"

/* ------------------------------------------------------------------------------ what is refused */

static void set_dma_mode(uint32_t mode)
{
#ifdef DMA_LINKEDLIST_CIRCULAR
    hal_rig.dma.Mode = mode;
#else
    hal_rig.dma.Init.Mode = mode;
#endif
}

#ifdef DMA_LINKEDLIST_CIRCULAR
static void check_node_refused(rig_way_t way, uint32_t how)
{
    open_port(way);
    hal_rig.node.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET] = how;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
}
#endif

static void check_refused(rig_way_t way)
{
    open_port(way);
    set_dma_mode(DMA_NORMAL);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
#ifdef DMA_FIFOMODE_DISABLE
    open_port(way);
    hal_rig.dma.Init.FIFOMode = DMA_FIFOMODE_ENABLE;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
#endif
#ifdef DMA_LINKEDLIST_CIRCULAR
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_SDW_LOG2);
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_DDW_LOG2);
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_SINC);
    check_node_refused(way, 0);
    open_port(way);
    hal_rig.list.Head = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
    hal_rig.dma.LinkedListQueue = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
#else
    open_port(way);
    hal_rig.dma.Init.MemDataAlignment = DMA_MDATAALIGN_WORD;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
    open_port(way);
    hal_rig.dma.Init.MemInc = 0;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
#endif
}

void test_dma_that_is_not_circular_by_byte_and_without_fifo_is_refused(void)
{
    while (next_way(IN_CIRCLE)) {
        check_refused(rig_way);
    }
}

static tmini_status_t start_blocks(uint8_t *block, size_t size)
{
    return tmini_stm32_hal_start_blocks(&hal_rig.port, &lidar, block, size);
}

void test_blocks_of_a_wrong_size_are_refused(void)
{
    open_port(BY_BLOCKS);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(NULL, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 62));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 255));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 65536));
}

void test_blocks_are_refused_for_a_buffer_announced_as_dmas_target(void)
{
    open_port(BY_DMA);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 256));
}

/* ------------------------------------------------------------------------------------------ DMA */

void test_callbacks_of_another_uart_change_nothing(void)
{
    while (next_way(IN_CIRCLE)) {
        UART_HandleTypeDef other = {.RxState = HAL_UART_STATE_READY,
                                    .ErrorCode = HAL_UART_ERROR_FE};
        send_packets(1);
        machine_pass(300);
        tmini_stm32_hal_rx_event(&hal_rig.port, &other);
        tmini_stm32_hal_rx_half_complete(&hal_rig.port, &other);
        tmini_stm32_hal_rx_complete(&hal_rig.port, &other);
        tmini_stm32_hal_error(&hal_rig.port, &other);
        TEST_ASSERT_EQUAL_UINT32(0, tmini_ring_head(&lidar.ring));
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().framing_errors);
    }
}

static void idle_event(void)
{
    if (!irq_is_in_handler() && hal_rig.uart.RxState == HAL_UART_STATE_BUSY_RX) {
#ifdef HAL_UART_RXEVENT_IDLE
        hal_rig.uart.RxEventType = HAL_UART_RXEVENT_IDLE;
#endif
        tmini_stm32_hal_rx_event(&hal_rig.port, &hal_rig.uart);
    }
}

/* The event comes once at each access to a register or an index. */
void test_an_event_between_reading_and_using_the_position_does_no_harm(void)
{
    while (next_way(IN_CIRCLE)) {
        random_t random;
        random_seed(&random, 1);
        send_packets(600);
        for (uint32_t place = 0; place < 60; place = irq_next_place(&random, place)) {
            machine_pass(1000);
            irq_happen_after(place, idle_event);
            (void)poll_all();
        }
        run();
        TEST_ASSERT_EQUAL_UINT32(600, packets());
    }
}

/* --------------------------------------------------------------------------- errors of the line */

/* A damaged byte arrives at some moment of the HAL's start: at each one in turn. */
void test_an_error_inside_the_hals_start_does_not_end_reception(void)
{
    while (next_way(IN_CIRCLE)) {
        for (unsigned at = 0; at < 60; at++) {
            open_port(rig_way);
            machine_pass(10000);
            send_broken_byte(MODEL_FE);
            machine.now_ns += MACHINE_BYTE_NS - at * machine.access_ns;
            TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
            receive(100);
            TEST_ASSERT_EQUAL_UINT32(100, packets());
            TEST_ASSERT_EQUAL_UINT32(0, rig_errors().restarts);
            TEST_ASSERT_LESS_THAN_UINT32(50, irq.lines[MODEL_USART_IRQ].served);
        }
    }
}

/* The lidar has lost its supply: the next command finds the error flag set. */
void test_a_command_while_an_error_flag_is_set_is_no_lock_up(void)
{
    while (next_way(IN_CIRCLE)) {
        static const uint8_t command[] = {0xA5, 0x60};
        send_broken_byte(MODEL_FE);
        machine_pass(5000);
        TEST_ASSERT_EQUAL_INT(2, tmini_stm32_hal_port.write(&hal_rig.port, command, 2));
        machine_pass(1000);
        TEST_ASSERT_EQUAL(HAL_UART_STATE_READY, hal_rig.uart.gState);
    }
}

/* ------------------------------------------------------------------- reception that has stopped */

static void set_up_anew(void)
{
    model_usart.CR1 = MODEL_CR1_UE | MODEL_CR1_RE | MODEL_CR1_TE;
    model_usart.CR3 = 0;
    hal_rig.uart.RxState = HAL_UART_STATE_READY;
}

static void pause_dma(void)
{
    model_usart.CR3 = 0;
}

static void abort_dma(void)
{
    TEST_ASSERT_EQUAL(HAL_OK, HAL_DMA_Abort(&hal_rig.dma));
}

static void end_reception(void) /* The DMA still runs. */
{
    hal_rig.uart.RxState = HAL_UART_STATE_READY;
}

#ifdef DMA_LINKEDLIST_CIRCULAR
static void suspend_dma(void) /* HAL_UART_DMAPause() in a newer HAL. */
{
    model.dma.enabled = false;
    hal_rig.dma.State = HAL_DMA_STATE_SUSPEND;
}
#endif

static void (*const stops[])(void) = {
    set_up_anew, pause_dma, abort_dma, end_reception,
#ifdef DMA_LINKEDLIST_CIRCULAR
    suspend_dma,
#endif
};

/* As by HAL_UART_DeInit() and HAL_UART_Init(), HAL_UART_DMAPause() or HAL_DMA_Abort(). */
void test_a_reception_that_others_have_stopped_is_started_again_by_the_next_poll(void)
{
    while (next_way(IN_CIRCLE)) {
        for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
            start_port(rig_way);
            receive(i > 0 ? 30 : 0);
            stops[i]();
            machine_pass(20000);
            (void)poll_all();
            TEST_ASSERT_EQUAL_UINT32(1, rig_errors().restarts);
            receive(100);
            TEST_ASSERT_EQUAL_UINT32(i > 0 ? 130 : 100, packets());
            TEST_ASSERT_EQUAL_UINT32(1, rig_errors().restarts);
        }
    }
}

void test_a_dma_that_fails_is_started_again_by_the_poll_and_not_in_the_interrupt(void)
{
    while (next_way(IN_CIRCLE)) {
        receive(30);
        model.dma.flags |= MODEL_DMA_TE;
        machine_pass(5000);
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().other_errors);
        TEST_ASSERT_FALSE(hal_rig.started_in_error);
        (void)poll_all();
        receive(100);
        TEST_ASSERT_EQUAL_UINT32(130, packets());
    }
}

/* The port checks reception when the library asks for the time. The first poll after a command asks
 * only once: it restarts reception, and a later poll hands over bytes. */
static void check_dma_error_after(unsigned count)
{
    start_port(rig_way);
    receive(count);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&lidar));
    model.dma.flags |= MODEL_DMA_TE;
    machine_pass(5000);
    (void)poll_all();
    receive(100);
    TEST_ASSERT_EQUAL_UINT32(count + 100, packets());
    TEST_ASSERT_EQUAL_UINT32(1, rig_errors().restarts);
}

void test_bytes_before_a_dma_failure_are_not_delivered_again(void)
{
    while (next_way(IN_CIRCLE)) {
        for (unsigned count = 10; count < 110; count += 20) {
            check_dma_error_after(count);
        }
    }
}

void test_failed_restarts_are_tried_again_some_milliseconds_later(void)
{
    while (next_way(IN_CIRCLE)) {
        hal_rig.dma.State = HAL_DMA_STATE_ABORT; /* The channel stays blocked. */
        hal_rig.uart.RxState = HAL_UART_STATE_READY;
        model_usart.CR3 = 0;
        for (unsigned i = 0; i < 300; i++) {
            machine_pass(100);
            (void)poll_all();
        }
        TEST_ASSERT_LESS_THAN_UINT32(12, rig_errors().restarts); /* In 30 ms. */
        TEST_ASSERT_GREATER_THAN_UINT32(5, rig_errors().restarts);
    }
}

/* ----------------------------------------------------------------------------------------- laps */

/* If DMA's interrupt comes inside the idle line's, both callbacks see the DMA event's type. */
void test_an_event_that_is_reported_twice_is_no_lap(void)
{
    start_port(BY_DMA);
    send_packets(60);
    machine_pass(520 * 44); /* DMA has passed the middle. */
    tmini_stm32_hal_rx_event(&hal_rig.port, &hal_rig.uart);
    tmini_stm32_hal_rx_event(&hal_rig.port, &hal_rig.uart);
    TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
}

/* DMA's interrupt comes inside the idle line's, between storing the event's type and the
 * callback. */
void test_an_event_of_the_wrong_type_is_no_lap(void)
{
    start_port(BY_DMA);
    irq.lines[MODEL_DMA_IRQ].priority = 4;
    machine.access_ns = 5000;
    for (unsigned i = 0; i < 2000; i++) {
        send_packets(1);
        machine_pass(PACKET_SIZE * 44 + 30 + i % 50);
        (void)poll_all();
    }
    TEST_ASSERT_EQUAL_UINT32(2000, packets());
    TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
}

/* ----------------------------------------------------------------------------------------- stop */

void test_after_stop_bytes_received_by_others_with_the_same_dma_are_left_alone(void)
{
    while (next_way(IN_CIRCLE)) {
        static uint8_t others[64];
        receive(5);
        tmini_stm32_hal_stop(&hal_rig.port);
        TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_Receive_DMA(&hal_rig.uart, others, sizeof others));
        receive(10);
        TEST_ASSERT_EQUAL_UINT32(5, packets());
        TEST_ASSERT_EQUAL_UINT32(5 * PACKET_SIZE, bytes_accounted_for());
        TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_AbortReceive(&hal_rig.uart));
    }
}

/* After the HAL has ended the reception, DMA's position is not valid. */
void test_an_event_after_the_end_of_reception_hands_nothing_over(void)
{
    while (next_way(IN_CIRCLE)) {
        receive(5);
        const size_t head = tmini_ring_head(&lidar.ring);
        hal_rig.uart.RxState = HAL_UART_STATE_READY;
        send_packets(1);
        machine_pass(10000);
        tmini_stm32_hal_rx_half_complete(&hal_rig.port, &hal_rig.uart);
        TEST_ASSERT_EQUAL_UINT32(head, tmini_ring_head(&lidar.ring));
    }
}

/* ----------------------------------------------------------------------------------- data cache */

#ifdef STM32_MODEL_DCACHE
#define NEED_CACHE
#else
#define NEED_CACHE TEST_IGNORE_MESSAGE("no data cache")
#endif

void test_a_buffer_that_is_not_aligned_to_cache_lines_is_refused(void)
{
    NEED_CACHE;
    open_port(BY_BLOCKS);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(&hal_rig_block[4], 128));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 80));
}

/* The interrupts do this without a poll. 79 packets are 1027 bytes. */
void test_the_cache_is_invalidated_up_to_the_buffers_end(void)
{
    NEED_CACHE;
    start_port(BY_DMA);
    send_packets(RIG_RX_SIZE / 13 + 1);
    machine_pass(100000);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(model.ram, rig_rx, RIG_RX_SIZE);
}

/* Otherwise the cache could later write old data over the bytes from DMA. */
void test_the_cache_is_written_to_memory_before_dma_begins(void)
{
    NEED_CACHE;
    open_port(BY_DMA);
    memset(rig_rx, 0x5A, sizeof rig_rx);
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
    TEST_ASSERT_EQUAL_HEX8_ARRAY(rig_rx, model.ram, sizeof rig_rx);
}
