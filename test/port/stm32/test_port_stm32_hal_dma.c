/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port with DMA on the model, both into the lidar's buffer and by blocks: events,
 * errors, laps. */

#include "hal_rig.h"

#include <string.h>

#include "known_packets.h"
#include "random.h"
#include "unity.h"

/* ------------------------------------------------------------------------------ what is refused */

static const struct {
    uint32_t *member;
    uint32_t value;
} wrong[] = {
#ifdef DMA_LINKEDLIST_CIRCULAR
    {&hdma_usart1_rx.Mode, DMA_NORMAL},
    {&Node_GPDMA1_Channel0.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET],
     DMA_CTR1_DINC | DMA_CTR1_SDW_LOG2},
    {&Node_GPDMA1_Channel0.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET],
     DMA_CTR1_DINC | DMA_CTR1_DDW_LOG2},
    {&Node_GPDMA1_Channel0.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET], DMA_CTR1_DINC | DMA_CTR1_SINC},
    {&Node_GPDMA1_Channel0.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET], 0},
#else
    {&hdma_usart1_rx.Init.Mode, DMA_NORMAL},
    {&hdma_usart1_rx.Init.MemDataAlignment, DMA_MDATAALIGN_WORD},
    {&hdma_usart1_rx.Init.MemInc, 0},
#endif
#ifdef DMA_FIFOMODE_DISABLE
    {&hdma_usart1_rx.Init.FIFOMode, DMA_FIFOMODE_ENABLE},
#endif
};

void test_dma_that_is_not_circular_by_byte_and_without_fifo_is_refused(void)
{
    for (unsigned way = BY_DMA; way <= BY_BLOCKS; way++) {
        play_begin(way);
        for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
            hal_rig_assert_refused(wrong[i].member, wrong[i].value);
        }
#ifdef DMA_LINKEDLIST_CIRCULAR
        List_GPDMA1_Channel0.Head = NULL;
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
        hdma_usart1_rx.LinkedListQueue = NULL;
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
#endif
    }
}

static tmini_status_t start_blocks(uint8_t *block, size_t size)
{
    return tmini_stm32_hal_start_blocks(&port, &lidar, block, size);
}

void test_blocks_of_a_wrong_size_or_beside_a_buffer_for_dma_are_refused(void)
{
    play_begin(BY_BLOCKS);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(NULL, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 62));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 255));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 65536));
    play_begin(BY_DMA); /* The lidar's own buffer is announced as DMA's target. */
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 256));
}

/* ----------------------------------------------------------------------------------- the scenes */

static const row_t scenes[] IN_FLASH = {
    /* ---- Reception that others have stopped is started again by the next poll ---- */
    ROW(a_uart_set_up_anew_is_started_again, /* By HAL_UART_DeInit() and HAL_UART_Init(). */
        "DMA blocks: set-up ~20000 poll restarts:1 P:100 run packets:100 restarts:1"),
    ROW(a_dma_that_is_paused_is_started_again, /* HAL_UART_DMAPause() */
        "DMA blocks: P:30 run pause ~20000 poll restarts:1 P:100 run packets:130 restarts:1"),
    ROW(a_dma_that_is_aborted_is_started_again, /* HAL_DMA_Abort() */
        "DMA blocks: P:30 run abort ~20000 poll restarts:1 P:100 run packets:130 restarts:1"),
    ROW(a_reception_that_has_ended_is_started_again, /* The DMA still runs. */
        "DMA blocks: P:30 run end ~20000 poll restarts:1 P:100 run packets:130 restarts:1"),
#ifdef DMA_LINKEDLIST_CIRCULAR
    ROW(a_dma_that_is_suspended_is_started_again, /* HAL_UART_DMAPause() in a newer HAL. */
        "DMA blocks: P:30 run suspend ~20000 poll restarts:1 P:100 run packets:130 restarts:1"),
#endif
    /* Not in the interrupt: see HAL_UART_ErrorCallback(). */
    ROW(a_dma_that_fails_is_started_again_by_the_poll,
        "DMA blocks: P:30 run TE ~5000 others:1 poll P:100 run packets:130"),
    /* The port checks reception when the library asks for the time. The first poll after a command
     * asks only once: it restarts reception, and a later poll hands over bytes. */
    ROW(bytes_before_a_dma_failure_are_not_delivered_again,
        "DMA blocks: for:10:110:20 P:it run mark info TE ~5000 poll P:100 run more:100 restarts:1"),
    ROW(failed_restarts_are_tried_again_some_milliseconds_later, /* In 30 ms. */
        "DMA blocks: block 300( ~100 poll ) restarts>5 restarts<12 unblock"),
    ROW(a_byte_that_waits_for_dma_is_not_removed, /* Where reading it would clear the overrun. */
        "DMA blocks: deaf break P ~2000 RXNE:1 ORE-stands:1 poll RXNE:1 ORE:1"),
    /* ---- Laps ---- */
    ROW(a_large_block_delivers_every_byte, /* A position needs more than 8 bits. */
        "blocks idle: size:1024 start P:200 run packets:200 laps:0"),
    /* If DMA's interrupt comes inside the idle line's, both callbacks see the DMA event's type. */
    ROW(an_event_that_is_reported_twice_is_no_lap, /* DMA has passed the middle. */
        "DMA: P:60 ~22880 event event laps:0"),
    ROW(an_event_of_the_wrong_type_is_no_lap, /* A pause of 30 to 80 µs after each packet. */
        "DMA: for:602:652:5 dma-priority:4 access:5000 400( P ~it poll ) packets:400 laps:0"),
    /* ---- Others ---- */
    ROW(callbacks_of_another_uart_change_nothing, "DMA blocks: P ~300 other-uart position:0 FEs:0"),
    ROW(after_stop_bytes_received_by_others_with_the_same_dma_are_left_alone,
        "DMA blocks: P:5 run stop receive-else P:10 run packets:5 accounted:65 abort-else"),
    /* The lidar has lost its supply: the next command finds the error flag set. */
    ROW(a_command_while_an_error_flag_is_set_is_no_lock_up,
        "DMA blocks: FE x ~5000 command ~1000 ready:1"),
    /* ---- Stop ---- */
    /* After the HAL has ended the reception, DMA's position is not valid. */
    ROW(an_event_after_the_end_of_reception_hands_nothing_over,
        "DMA blocks: P:5 run end P ~10000 half position:65"),
};

void test_scenes_with_dma(void)
{
    run_rows(scenes, play_row);
}

/* ------------------------------------------------------------------------ events at each moment */

static void idle_event(void)
{
    if (!irq_is_in_handler() && huart1.RxState == HAL_UART_STATE_BUSY_RX) {
#ifdef HAL_UART_RXEVENT_IDLE
        huart1.RxEventType = HAL_UART_RXEVENT_IDLE;
#endif
        tmini_stm32_hal_rx_event(&port, &huart1);
    }
}

/* The event comes once at each access to a register or an index. */
void test_an_event_between_reading_and_using_the_position_does_no_harm(void)
{
    for (unsigned way = BY_DMA; way <= BY_BLOCKS; way++) {
        random_t random;
        play_start(way);
        random_seed(&random, 1);
        play_send(600);
        for (uint32_t place = 0; place < 60; place = irq_next_place(&random, place)) {
            machine_pass(1000);
            irq_happen_after(place, idle_event);
            poll_all();
        }
        play_receive(0);
        TEST_ASSERT_EQUAL_UINT32(600, play_packets());
    }
}

/* A damaged byte arrives at some moment of the HAL's start: at each one in turn. */
void test_an_error_inside_the_hals_start_does_not_end_reception(void)
{
    for (unsigned at = 0; at < 2 * 60; at++) {
        static const uint8_t broken = 0x00;
        play_begin(at < 60 ? BY_DMA : BY_BLOCKS);
        machine_pass(10000);
        machine_send(MODEL_FE, &broken, 1);
        machine.now_ns += MACHINE_BYTE_NS - at % 60 * machine.access_ns;
        TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
        play_receive(100);
        TEST_ASSERT_EQUAL_UINT32(100, play_packets());
        TEST_ASSERT_EQUAL_UINT32(0, rig_counts().restarts);
        TEST_ASSERT_LESS_THAN_UINT32(50, irq.lines[MODEL_USART_IRQ].served);
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
    play_begin(BY_BLOCKS);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(&hal_rig_block[4], 128));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(hal_rig_block, 80));
}

/* Otherwise the cache could later write old data over the bytes from DMA. After 79 packets, 1027
 * bytes, it has been invalidated up to the buffer's end: the interrupts do this without a poll. */
void test_the_cache_is_written_to_memory_before_dma_begins_and_invalidated_while_it_runs(void)
{
    NEED_CACHE;
    play_begin(BY_DMA);
    memset(tmini_rx_buffer(&lidar, &model.cached_size), 0x5A, 1024);
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
    TEST_ASSERT_EQUAL_HEX8_ARRAY(model.cached, model.ram, 1024);
    play_send(79);
    machine_pass(100000);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(model.ram, model.cached, 1024);
}
