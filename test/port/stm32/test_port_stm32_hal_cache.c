/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port with a data cache. test_port_stm32_hal_dma.c shows on this model, too, that
 * bytes from DMA are read from memory. */

#include "hal_rig.h"

#include <string.h>

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_a_buffer_that_is_not_aligned_to_cache_lines_is_refused(void)
{
    hal_rig_open(BY_BLOCKS);
    TEST_ASSERT_EQUAL(
        TMINI_ERROR_ARGUMENT,
        tmini_stm32_hal_start_blocks(&hal_rig.port, &hal_rig.lidar, &hal_rig_block[4], 128));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_hal_start_blocks(
                                                &hal_rig.port, &hal_rig.lidar, hal_rig_block, 80));
}

/* The interrupts do this without a poll. 79 packets are 1027 bytes. */
void test_the_cache_is_invalidated_up_to_the_buffers_end(void)
{
    hal_rig_open(BY_DMA);
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
    line_send_packets(HAL_RIG_RX_SIZE / 13 + 1);
    model_pass(100000);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(model.ram, hal_rig_rx, HAL_RIG_RX_SIZE);
}

/* Otherwise the cache could later write old data over the bytes from DMA. */
void test_the_cache_is_written_to_memory_before_dma_begins(void)
{
    hal_rig_open(BY_DMA);
    memset(hal_rig_rx, 0x5A, sizeof hal_rig_rx);
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
    TEST_ASSERT_EQUAL_HEX8_ARRAY(hal_rig_rx, model.ram, sizeof hal_rig_rx);
}
