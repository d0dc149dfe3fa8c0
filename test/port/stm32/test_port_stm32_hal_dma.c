/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port with DMA on the model, both into the lidar's buffer and by blocks: events,
 * errors, laps. Compiled for several families and years of the HAL. */

#include "hal_rig.h"

#include <string.h>

#include "unity.h"

#define PACKET LINE_PACKET_SIZE
#define LAP_US 44445u

void setUp(void) {}

void tearDown(void) {}

static uint32_t bytes_accounted_for(void)
{
    const tmini_counters_t counters = hal_rig_poll();
    return counters.bytes_in_packets + counters.bytes_skipped + counters.bytes_overrun +
           counters.bytes_pending;
}

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
static void check_node_refused(hal_rig_way_t way, uint32_t how)
{
    hal_rig_open(way);
    hal_rig.node.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET] = how;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
}
#endif

static void check_refused(hal_rig_way_t way)
{
    hal_rig_open(way);
    set_dma_mode(DMA_NORMAL);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
#ifdef DMA_FIFOMODE_DISABLE
    hal_rig_open(way);
    hal_rig.dma.Init.FIFOMode = DMA_FIFOMODE_ENABLE;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
#endif
#ifdef DMA_LINKEDLIST_CIRCULAR
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_SDW_LOG2);
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_DDW_LOG2);
    check_node_refused(way, DMA_CTR1_DINC | DMA_CTR1_SINC);
    check_node_refused(way, 0);
    hal_rig_open(way);
    hal_rig.list.Head = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
    hal_rig.dma.LinkedListQueue = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
#else
    hal_rig_open(way);
    hal_rig.dma.Init.MemDataAlignment = DMA_MDATAALIGN_WORD;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
    hal_rig_open(way);
    hal_rig.dma.Init.MemInc = 0;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, hal_rig_start());
#endif
}

void test_dma_that_is_not_circular_by_byte_and_without_fifo_is_refused(void)
{
    check_refused(BY_DMA);
    check_refused(BY_BLOCKS);
}

static tmini_status_t start_blocks(uint8_t *block, size_t size)
{
    return tmini_stm32_hal_start_blocks(&hal_rig.port, &hal_rig.lidar, block, size);
}

void test_blocks_of_a_wrong_size_are_refused(void)
{
    hal_rig_open(BY_BLOCKS);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(NULL, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 62));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 255));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 65536));
}

void test_blocks_are_refused_for_a_buffer_announced_as_dmas_target(void)
{
    hal_rig_open(BY_DMA);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 256));
}

/* ------------------------------------------------------------------------------------------ DMA */

void test_dma_delivers_every_byte(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(200);
        TEST_ASSERT_EQUAL_UINT32(200, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(200 * PACKET, bytes_accounted_for());
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
        TEST_ASSERT_LESS_THAN_UINT32(50, irq.lines[MODEL_USART_IRQ].served);
    }
}

void test_callbacks_of_another_uart_change_nothing(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        UART_HandleTypeDef other = {.RxState = HAL_UART_STATE_READY,
                                    .ErrorCode = HAL_UART_ERROR_FE};
        hal_rig_open_and_start(way);
        line_send_packets(1);
        model_pass(300);
        tmini_stm32_hal_rx_event(&hal_rig.port, &other);
        tmini_stm32_hal_rx_half_complete(&hal_rig.port, &other);
        tmini_stm32_hal_rx_complete(&hal_rig.port, &other);
        tmini_stm32_hal_error(&hal_rig.port, &other);
        TEST_ASSERT_EQUAL_UINT32(0, tmini_ring_head(&hal_rig.lidar.ring));
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().framing_errors);
    }
}

/* Also at the buffer's end, where HALs of different years report different events and sizes. */
void test_idle_events_at_any_position_lose_and_repeat_nothing(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        for (unsigned i = 0; i < 300; i++) {
            line_send_packets(1);
            model_pass(1000);
            (void)hal_rig_poll();
        }
        TEST_ASSERT_EQUAL_UINT32(300, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
    }
}

void test_priorities_of_the_two_interrupts_may_be_any(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        for (unsigned usart = 4; usart <= 6; usart++) {
            hal_rig_open_and_start(way);
            irq.lines[MODEL_USART_IRQ].priority = usart;
            model.access_ns = 2000; /* On a slow controller, interrupts coincide. */
            hal_rig_receive(200);
            TEST_ASSERT_EQUAL_UINT32(200, hal_rig_packets());
            TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
        }
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
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        random_t random;
        hal_rig_open_and_start(way);
        random_seed(&random, 1);
        line_send_packets(600);
        for (uint32_t place = 0; place < 60; place = irq_next_place(&random, place)) {
            model_pass(1000);
            irq_happen_after(place, idle_event);
            (void)hal_rig_poll();
        }
        hal_rig_run();
        TEST_ASSERT_EQUAL_UINT32(600, hal_rig_packets());
    }
}

void test_polls_alone_deliver_every_byte_from_dma(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        irq.lines[MODEL_USART_IRQ].disabled = true;
        irq.lines[MODEL_DMA_IRQ].disabled = true;
        hal_rig_receive(200);
        TEST_ASSERT_EQUAL_UINT32(200, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
    }
}

/* --------------------------------------------------------------------------- errors of the line */

void test_an_overrun_pending_at_the_start_does_no_harm(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open(way);
        line_send_packets(100);
        model_pass(2000);
        TEST_ASSERT_NOT_EQUAL(0, model.flags & MODEL_ORE);
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        hal_rig_run();
        TEST_ASSERT_GREATER_THAN_UINT32(94, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
    }
}

/* A damaged byte arrives at some moment of the HAL's start: at each one in turn. */
void test_an_error_inside_the_hals_start_does_not_end_reception(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        static const uint8_t broken = 0x00;
        for (unsigned at = 0; at < 60; at++) {
            hal_rig_open(way);
            model_pass(10000);
            line_send_with(MODEL_FE);
            line_send(&broken, 1);
            model.now_ns += MODEL_BYTE_NS - at * model.access_ns;
            TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
            hal_rig_receive(100);
            TEST_ASSERT_EQUAL_UINT32(100, hal_rig_packets());
            TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
            TEST_ASSERT_LESS_THAN_UINT32(50, irq.lines[MODEL_USART_IRQ].served);
        }
    }
}

void test_a_line_error_costs_only_its_byte(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        for (unsigned i = 0; i < 20; i++) {
            static const uint8_t broken = 0x00;
            line_send_packets(10);
            line_send_with(i % 2 == 0 ? MODEL_FE : MODEL_NE);
            line_send(&broken, 1);
        }
        hal_rig_run();
        TEST_ASSERT_EQUAL_UINT32(200, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(20, hal_rig_poll().bytes_skipped);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
        TEST_ASSERT_GREATER_THAN_UINT32(4, hal_rig_errors().framing_errors);
        TEST_ASSERT_GREATER_THAN_UINT32(4, hal_rig_errors().noise_errors);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(10, hal_rig_errors().framing_errors);
    }
}

void test_an_overrun_while_dma_runs_is_counted_and_does_not_stop_it(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        line_send_packets(10);
        model_pass(2000);
        model.flags |= MODEL_ORE;
        hal_rig_run();
        TEST_ASSERT_EQUAL_UINT32(10, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().overruns);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
    }
}

/* On many boards the overrun flag holds the next byte back. DMA has already read the byte
 * before. */
void test_an_overrun_that_holds_bytes_back_is_cleared_by_the_poll(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        model.ore_holds_rxne = true;
        hal_rig_receive(10);
        model.flags |= MODEL_ORE;
        model_pass(1000);
        (void)hal_rig_poll();
        hal_rig_receive(10);
        TEST_ASSERT_EQUAL_UINT32(20, hal_rig_packets());
    }
}

/* With DDRE, any error holds DMA requests back until it is cleared. */
void test_an_error_that_holds_dma_back_is_cleared_by_the_poll(void)
{
#ifdef STM32_MODEL_SR
    TEST_IGNORE_MESSAGE("not with SR and DR");
#endif
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        model_usart.CR3 |= MODEL_CR3_DDRE;
        line_send_with(MODEL_FE);
        hal_rig_receive(20);
        /* The poll comes up to 1 ms (23 bytes) later. */
        TEST_ASSERT_UINT32_WITHIN(3, 17, hal_rig_packets());
        const uint32_t before = hal_rig_packets();
        hal_rig_receive(10);
        TEST_ASSERT_EQUAL_UINT32(before + 10, hal_rig_packets());
    }
}

/* The lidar has lost its supply: the next command finds the error flag set. */
void test_a_command_while_an_error_flag_is_set_is_no_lock_up(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        static const uint8_t broken = 0x00;
        static const uint8_t command[] = {0xA5, 0x60};
        hal_rig_open_and_start(way);
        line_send_with(MODEL_FE);
        line_send(&broken, 1);
        model_pass(5000);
        TEST_ASSERT_EQUAL_INT(2, tmini_stm32_hal_port.write(&hal_rig.port, command, 2));
        model_pass(1000);
        TEST_ASSERT_EQUAL(HAL_UART_STATE_READY, hal_rig.uart.gState);
    }
}

/* ------------------------------------------------------------------- reception that has stopped */

static void check_comes_back(void)
{
    model_pass(20000);
    (void)hal_rig_poll();
    hal_rig_receive(100);
    TEST_ASSERT_EQUAL_UINT32(100, hal_rig_packets());
}

/* As by HAL_UART_DeInit() and HAL_UART_Init(), HAL_UART_DMAPause() or HAL_DMA_Abort(). */
void test_a_reception_that_others_have_stopped_is_started_again(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        model_usart.CR1 = MODEL_CR1_UE | MODEL_CR1_RE | MODEL_CR1_TE;
        model_usart.CR3 = 0;
        hal_rig.uart.RxState = HAL_UART_STATE_READY;
        check_comes_back();
        hal_rig_open_and_start(way);
        model_usart.CR3 = 0;
        check_comes_back();
        hal_rig_open_and_start(way);
        TEST_ASSERT_EQUAL(HAL_OK, HAL_DMA_Abort(&hal_rig.dma));
        check_comes_back();
#ifdef DMA_LINKEDLIST_CIRCULAR
        hal_rig_open_and_start(way); /* HAL_UART_DMAPause() in a newer HAL. */
        model.dma.enabled = false;
        hal_rig.dma.State = HAL_DMA_STATE_SUSPEND;
        check_comes_back();
#endif
    }
}

void test_reception_is_started_again_when_the_lidar_is_lost(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(10);
        model.dma.enabled = false; /* No flag shows this. */
        tmini_stm32_hal_port.restart(&hal_rig.port);
        (void)hal_rig_poll();
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(110, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().restarts);
    }
}

void test_a_reception_that_has_stopped_is_started_again_by_the_next_poll(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(30);
        hal_rig.uart.RxState = HAL_UART_STATE_READY; /* The DMA still runs. */
        model_pass(20000);
        (void)hal_rig_poll();
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().restarts);
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(130, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().restarts);
    }
}

void test_a_dma_that_fails_is_started_again_by_the_poll_and_not_in_the_interrupt(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(30);
        model.dma.flags |= MODEL_DMA_TE;
        model_pass(5000);
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().other_errors);
        TEST_ASSERT_FALSE(hal_rig.started_in_error);
        (void)hal_rig_poll();
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(130, hal_rig_packets());
    }
}

/* The port checks reception when the library asks for the time. The first poll after a command asks
 * only once: it restarts reception, and a later poll hands over bytes. */
static void check_dma_error_after(hal_rig_way_t way, unsigned packets)
{
    hal_rig_open_and_start(way);
    hal_rig_receive(packets);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&hal_rig.lidar));
    model.dma.flags |= MODEL_DMA_TE;
    model_pass(5000);
    (void)hal_rig_poll();
    hal_rig_receive(100);
    TEST_ASSERT_EQUAL_UINT32(packets + 100, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().restarts);
}

void test_bytes_before_a_dma_failure_are_not_delivered_again(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        for (unsigned packets = 10; packets < 110; packets += 20) {
            check_dma_error_after(way, packets);
        }
    }
}

/* After the restart, old packets still fill the buffer: they must not be read again. */
void test_packets_before_a_restart_are_not_delivered_again(void)
{
    hal_rig_open_and_start(BY_DMA);
    line_send_packets(78); /* 1014 bytes: the buffer is full of packets. */
    hal_rig_run();
    hal_rig_receive(10);
    TEST_ASSERT_EQUAL_UINT32(88, hal_rig_packets());
    hal_rig.uart.RxState = HAL_UART_STATE_READY;
    model_pass(20000);
    TEST_ASSERT_EQUAL_UINT32(88, hal_rig_packets());
    hal_rig_receive(100);
    TEST_ASSERT_EQUAL_UINT32(188, hal_rig_packets());
}

void test_failed_restarts_are_tried_again_some_milliseconds_later(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig.dma.State = HAL_DMA_STATE_ABORT; /* The channel stays blocked. */
        hal_rig.uart.RxState = HAL_UART_STATE_READY;
        model_usart.CR3 = 0;
        for (unsigned i = 0; i < 300; i++) {
            model_pass(100);
            (void)hal_rig_poll();
        }
        TEST_ASSERT_LESS_THAN_UINT32(12, hal_rig_errors().restarts); /* In 30 ms. */
        TEST_ASSERT_GREATER_THAN_UINT32(5, hal_rig_errors().restarts);
    }
}

/* ----------------------------------------------------------------------------------------- laps */

static void pass(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        model_pass(1000);
        (void)hal_rig_poll();
    }
}

/* Sends 200 packets, holds interrupts back for `us`, and returns the packets received. */
static uint32_t packets_with_interrupts_held(hal_rig_way_t way, uint32_t us)
{
    hal_rig_open_and_start(way);
    line_send_packets(200);
    pass(30);
    model.held_until_ns = model.now_ns + us * 1000u;
    model_pass(us + 10);
    hal_rig_run();
    return hal_rig_packets();
}

/* Interrupts are held back for one lap to two laps. Then half and whole buffer are reported at
 * once. */
void test_a_lap_without_any_interrupt_is_counted_once(void)
{
    for (uint32_t us = LAP_US; us < 2 * LAP_US; us += 1500) {
        const uint32_t packets = packets_with_interrupts_held(BY_DMA, us);
        TEST_ASSERT_EQUAL_UINT32(1, hal_rig_errors().laps);
        TEST_ASSERT_EQUAL_UINT32(200 * PACKET, bytes_accounted_for());
        TEST_ASSERT_LESS_THAN_UINT32(200, packets);
        TEST_ASSERT_GREATER_THAN_UINT32(75, packets);
    }
}

/* A lap that the half alone has shown must not hide the next one. */
void test_each_of_several_laps_is_counted_once(void)
{
    for (uint32_t us = LAP_US + 1000; us < LAP_US * 3 / 2; us += 3000) {
        hal_rig_open_and_start(BY_DMA);
        line_send_packets(600);
        for (unsigned laps = 1; laps <= 3; laps++) {
            pass(30);
            model.held_until_ns = model.now_ns + us * 1000u;
            model_pass(us + 10);
            (void)hal_rig_poll();
            pass(3);
            TEST_ASSERT_EQUAL_UINT32(laps, hal_rig_errors().laps);
        }
        hal_rig_run();
        TEST_ASSERT_EQUAL_UINT32(600 * PACKET, bytes_accounted_for());
        TEST_ASSERT_EQUAL_UINT32(3, hal_rig_errors().laps);
    }
}

/* Just over a lap has passed: only a few bytes seem to be new. */
void test_bytes_that_a_lap_has_overwritten_count_as_lost(void)
{
    (void)packets_with_interrupts_held(BY_DMA, LAP_US + 1000);
    TEST_ASSERT_GREATER_THAN_UINT32(500, hal_rig_poll().bytes_overrun);
}

/* If DMA's interrupt comes inside the idle line's, both callbacks see the DMA event's type. */
void test_an_event_that_is_reported_twice_is_no_lap(void)
{
    hal_rig_open_and_start(BY_DMA);
    line_send_packets(60);
    model_pass(520 * 44); /* DMA has passed the middle. */
    tmini_stm32_hal_rx_event(&hal_rig.port, &hal_rig.uart);
    tmini_stm32_hal_rx_event(&hal_rig.port, &hal_rig.uart);
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
}

void test_a_lap_of_a_block_without_any_interrupt_is_noticed(void)
{
    for (uint32_t us = LAP_US / 4; us < LAP_US; us += 700) {
        (void)packets_with_interrupts_held(BY_BLOCKS, us);
        TEST_ASSERT_GREATER_THAN_UINT32(0, hal_rig_errors().laps);
    }
}

void test_interrupts_late_by_less_than_half_a_lap_lose_nothing(void)
{
    for (uint32_t us = 100; us < LAP_US / 2 - 2000; us += 1500) {
        TEST_ASSERT_EQUAL_UINT32(200, packets_with_interrupts_held(BY_DMA, us));
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
    }
}

/* DMA's interrupt comes inside the idle line's, between storing the event's type and the
 * callback. */
void test_an_event_of_the_wrong_type_is_no_lap(void)
{
    hal_rig_open_and_start(BY_DMA);
    irq.lines[MODEL_DMA_IRQ].priority = 4;
    model.access_ns = 5000;
    for (unsigned i = 0; i < 2000; i++) {
        line_send_packets(1);
        model_pass(LINE_PACKET_SIZE * 44 + 30 + i % 50);
        (void)hal_rig_poll();
    }
    TEST_ASSERT_EQUAL_UINT32(2000, hal_rig_packets());
    TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
}

/* ----------------------------------------------------------------------------------------- stop */

void test_after_stop_dma_is_off_and_received_bytes_are_kept(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        line_send_packets(5);
        model_pass(3000); /* No event has come yet. */
        tmini_stm32_hal_stop(&hal_rig.port);
        TEST_ASSERT_EQUAL_UINT32(5, hal_rig_packets());
        TEST_ASSERT_FALSE(model.dma.enabled);
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(5, hal_rig_packets());
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(105, hal_rig_packets());
    }
}

void test_after_stop_bytes_received_by_others_with_the_same_dma_are_left_alone(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        static uint8_t others[64];
        hal_rig_open_and_start(way);
        hal_rig_receive(5);
        tmini_stm32_hal_stop(&hal_rig.port);
        TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_Receive_DMA(&hal_rig.uart, others, sizeof others));
        hal_rig_receive(10);
        TEST_ASSERT_EQUAL_UINT32(5, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(5 * PACKET, bytes_accounted_for());
        TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_AbortReceive(&hal_rig.uart));
    }
}

/* After the HAL has ended the reception, DMA's position is not valid. */
void test_an_event_after_the_end_of_reception_hands_nothing_over(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(5);
        const size_t head = tmini_ring_head(&hal_rig.lidar.ring);
        hal_rig.uart.RxState = HAL_UART_STATE_READY;
        line_send_packets(1);
        model_pass(10000);
        tmini_stm32_hal_rx_half_complete(&hal_rig.port, &hal_rig.uart);
        TEST_ASSERT_EQUAL_UINT32(head, tmini_ring_head(&hal_rig.lidar.ring));
    }
}

void test_a_lidar_that_is_set_up_again_begins_at_the_buffers_start(void)
{
    for (hal_rig_way_t way = BY_DMA; way <= BY_BLOCKS; way++) {
        hal_rig_open_and_start(way);
        hal_rig_receive(33);
        tmini_stm32_hal_stop(&hal_rig.port);
        const tmini_config_t config = {
            .port = &tmini_stm32_hal_port,
            .port_context = &hal_rig.port,
            .rx_buffer = hal_rig_rx,
            .rx_size = sizeof hal_rig_rx,
            .rx_dma = way == BY_DMA,
        };
        TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&hal_rig.lidar, &config));
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        hal_rig_receive(100);
        TEST_ASSERT_EQUAL_UINT32(100, hal_rig_packets());
        TEST_ASSERT_EQUAL_UINT32(100 * PACKET, bytes_accounted_for());
    }
}
