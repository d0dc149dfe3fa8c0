/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "hal_rig.h"

#include "unity.h"

tmini_stm32_hal_t port;
uint8_t hal_rig_block[1024] __ALIGNED(32);

static uint32_t block_size;

static void wait(void)
{
    machine_pass(1000);
}

scanning_t port_program = {.port = &tmini_stm32_hal_port, .context = &port, .wait = wait};
#ifdef STM32_MODEL_NO_DMA
const unsigned port_way_count = 1;
#else
const unsigned port_way_count = 3;
#endif

/* ---------------------------------------------------------------------- callbacks of a project */

void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size)
{
    (void)Size;
    tmini_stm32_hal_rx_event(&port, huart);
}

void HAL_UART_RxHalfCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_half_complete(&port, huart);
}

void HAL_UART_RxCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_complete(&port, huart);
}

void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart)
{
    const bool was_ready = huart->RxState == HAL_UART_STATE_READY;
    tmini_stm32_hal_error(&port, huart);
    TEST_ASSERT_EQUAL(was_ready, huart->RxState == HAL_UART_STATE_READY); /* It starts nothing. */
}

void __WFI(void)
{
    machine_pass(1000);
}

/* --------------------------------------------------------------------------------------- set-up */

void rig_open(void)
{
    block_size = 256;
    model_reset();
    MX_USART1_UART_Init();
    (void)tmini_stm32_hal_init(&port, &huart1);
}

tmini_status_t rig_start(void)
{
    if (rig_way == BY_BLOCKS) {
        model.cached = hal_rig_block;
        model.cached_size = block_size;
        return tmini_stm32_hal_start_blocks(&port, &lidar, hal_rig_block, block_size);
    }
    model.cached = tmini_rx_buffer(&lidar, &model.cached_size);
    return tmini_stm32_hal_start(&port, &lidar);
}

void hal_rig_assert_refused(uint32_t *member, uint32_t value)
{
    const uint32_t good = *member;
    *member = value;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, rig_start());
    *member = good;
}

void port_stop(void)
{
    tmini_stm32_hal_stop(&port);
}

rig_counts_t rig_counts(void)
{
    tmini_stm32_hal_counters_t c;
    tmini_stm32_hal_counters(&port, &c);
    return (rig_counts_t){0,      c.overruns, c.framing_errors, c.noise_errors,
                          c.laps, c.restarts, c.other_errors};
}

bool rig_is_off(void)
{
    const uint32_t on = model_usart.CR1 & (MODEL_CR1_RXNEIE | MODEL_CR1_IDLEIE);
    return on == 0 && (model_usart.CR3 & MODEL_CR3_DMAR) == 0 && !model.dma.enabled;
}

void rig_break_reception(void)
{
    model.dma.enabled = false;
    if (rig_way == BY_BYTES) {
        model_usart.CR1 &= ~MODEL_CR1_RXNEIE;
        model_usart.CR3 &= ~MODEL_CR3_EIE;
    }
}

/* ------------------------------------------------------------------------------ words of scenes */

#ifdef HAL_DMA_MODULE_ENABLED

ACT_ON(set_block_size, block_size = number)
ACT(ask_for_info, TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&lidar)))
ACT(end_reception, huart1.RxState = HAL_UART_STATE_READY)
ACT(pause_dma, model_usart.CR3 = 0)

static void set_up_again(void)
{
    model_usart.CR1 = MODEL_CR1_UE | MODEL_CR1_RE | MODEL_CR1_TE;
    pause_dma();
    end_reception();
}

ACT(abort_dma, TEST_ASSERT_EQUAL(HAL_OK, HAL_DMA_Abort(&hdma_usart1_rx)))

static void suspend_dma(void)
{
    model.dma.enabled = false;
    hdma_usart1_rx.State = HAL_DMA_STATE_SUSPEND;
}

ACT(fail_dma, model.dma.flags |= MODEL_DMA_TE)

static void block_dma(void)
{
    hdma_usart1_rx.State = HAL_DMA_STATE_ABORT;
    pause_dma();
    end_reception();
}

ACT(unblock_dma, hdma_usart1_rx.State = HAL_DMA_STATE_BUSY)
ACT(report_event, tmini_stm32_hal_rx_event(&port, &huart1))
ACT(report_half, tmini_stm32_hal_rx_half_complete(&port, &huart1))

#endif

const play_word_t port_words[] = {
#ifdef HAL_DMA_MODULE_ENABLED
    {.name = "size", .act_on = set_block_size},
    {.name = "info", .act = ask_for_info},
    {.name = "end", .act = end_reception},
    {.name = "pause", .act = pause_dma},
    {.name = "set-up", .act = set_up_again},
    {.name = "abort", .act = abort_dma},
    {.name = "suspend", .act = suspend_dma},
    {.name = "TE", .act = fail_dma},
    {.name = "block", .act = block_dma},
    {.name = "unblock", .act = unblock_dma},
    {.name = "event", .act = report_event},
    {.name = "half", .act = report_half},
#endif
    {.name = NULL},
};
