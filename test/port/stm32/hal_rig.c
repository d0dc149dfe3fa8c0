/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "hal_rig.h"

#include <string.h>

#include "unity.h"

hal_rig_t hal_rig;
uint8_t hal_rig_rx[HAL_RIG_RX_SIZE] __ALIGNED(32);
uint8_t hal_rig_block[HAL_RIG_BLOCK_SIZE] __ALIGNED(32);

static hal_rig_way_t way;

/* ---------------------------------------------------------- handlers and callbacks of a project */

static void usart_interrupt(void)
{
    HAL_UART_IRQHandler(&hal_rig.uart);
}

void HAL_UARTEx_RxEventCallback(UART_HandleTypeDef *huart, uint16_t Size)
{
    (void)Size;
    tmini_stm32_hal_rx_event(&hal_rig.port, huart);
}

void HAL_UART_RxHalfCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_half_complete(&hal_rig.port, huart);
}

void HAL_UART_RxCpltCallback(UART_HandleTypeDef *huart)
{
    tmini_stm32_hal_rx_complete(&hal_rig.port, huart);
}

void HAL_UART_ErrorCallback(UART_HandleTypeDef *huart)
{
    const bool was_ready = huart->RxState == HAL_UART_STATE_READY;
    hal_rig.errors_seen++;
    tmini_stm32_hal_error(&hal_rig.port, huart);
    hal_rig.started_in_error =
        hal_rig.started_in_error || (was_ready && huart->RxState != HAL_UART_STATE_READY);
}

void __WFI(void)
{
    model_pass(1000);
}

/* --------------------------------------------------------------------------------------- set-up */

static void open_uart(void)
{
    hal_rig.uart = (UART_HandleTypeDef){
        .Instance = &model_usart,
        .Init = {.BaudRate = 230400, .WordLength = UART_WORDLENGTH_8B, .Parity = UART_PARITY_NONE},
        .gState = HAL_UART_STATE_READY,
        .RxState = HAL_UART_STATE_READY,
    };
}

#ifdef HAL_DMA_MODULE_ENABLED

static void dma_interrupt(void)
{
    HAL_DMA_IRQHandler(&hal_rig.dma);
}

static void open_dma(void)
{
    hal_rig.dma = (DMA_HandleTypeDef){
        .Instance = &model.dma.channel, .Init.Mode = DMA_CIRCULAR, .Init.MemInc = DMA_MINC_ENABLE};
#ifdef DMA_LINKEDLIST_CIRCULAR
    hal_rig.dma.Mode = DMA_LINKEDLIST_CIRCULAR;
    hal_rig.node.LinkRegisters[NODE_CTR1_DEFAULT_OFFSET] = DMA_CTR1_DINC;
    hal_rig.list.Head = &hal_rig.node;
    hal_rig.dma.LinkedListQueue = &hal_rig.list;
#endif
    hal_rig.uart.hdmarx = &hal_rig.dma;
    irq.lines[MODEL_DMA_IRQ].handler = dma_interrupt;
    model.cached = way == BY_BLOCKS ? hal_rig_block : hal_rig_rx;
    model.cached_size = way == BY_BLOCKS ? sizeof hal_rig_block : sizeof hal_rig_rx;
}

#else

static void open_dma(void) {}

#endif

static void open_lidar(void)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_hal_port,
        .port_context = &hal_rig.port,
        .rx_buffer = hal_rig_rx,
        .rx_size = sizeof hal_rig_rx,
        .rx_dma = way == BY_DMA,
        .points = hal_rig.points,
        .max_points = sizeof hal_rig.points / sizeof hal_rig.points[0],
    };
    (void)tmini_stm32_hal_init(&hal_rig.port, &hal_rig.uart);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&hal_rig.lidar, &config));
}

void hal_rig_open(hal_rig_way_t wanted)
{
    way = wanted;
    memset(&hal_rig, 0, sizeof hal_rig);
    memset(hal_rig_rx, 0, sizeof hal_rig_rx);
    model_reset();
    line_open();
    irq.lines[MODEL_USART_IRQ].handler = usart_interrupt;
    open_uart();
    open_dma();
    open_lidar();
}

tmini_status_t hal_rig_start(void)
{
    return way == BY_BLOCKS ? tmini_stm32_hal_start_blocks(&hal_rig.port, &hal_rig.lidar,
                                                           hal_rig_block, sizeof hal_rig_block)
                            : tmini_stm32_hal_start(&hal_rig.port, &hal_rig.lidar);
}

void hal_rig_open_and_start(hal_rig_way_t wanted)
{
    hal_rig_open(wanted);
    model_pass(10000);
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
}

tmini_stm32_hal_counters_t hal_rig_errors(void)
{
    tmini_stm32_hal_counters_t counters;
    tmini_stm32_hal_counters(&hal_rig.port, &counters);
    return counters;
}

/* -------------------------------------------------------------------------------------- running */

uint32_t hal_rig_packets(void)
{
    return hal_rig_poll().packets;
}

void hal_rig_receive(unsigned packets)
{
    line_send_packets(packets);
    hal_rig_run();
}
