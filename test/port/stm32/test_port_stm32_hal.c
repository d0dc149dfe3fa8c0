/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port on the model of USART, DMA and HAL. Compiled for several families and years of
 * the HAL: see stm32_model/stm32_model.h. */

#include "hal_rig.h"

#include <string.h>

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

/* ------------------------------------------------------------------ the port as play.c wants */

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

static int send(const char *command, size_t size)
{
    return tmini_stm32_hal_port.write(&port, (const uint8_t *)command, size);
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

static void call_for_other_uart(void)
{
    UART_HandleTypeDef other = {.RxState = HAL_UART_STATE_READY, .ErrorCode = HAL_UART_ERROR_FE};
    tmini_stm32_hal_rx_event(&port, &other);
    tmini_stm32_hal_rx_half_complete(&port, &other);
    tmini_stm32_hal_rx_complete(&port, &other);
    tmini_stm32_hal_error(&port, &other);
}

static void receive_elsewhere(void)
{
    static uint8_t others[64];
    TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_Receive_DMA(&huart1, others, sizeof others));
}

ACT(abort_elsewhere, TEST_ASSERT_EQUAL(HAL_OK, HAL_UART_AbortReceive(&huart1)))
ACT(command, TEST_ASSERT_EQUAL_INT(2, send("\xA5\x60", 2)))
NUMBER(is_ready, huart1.gState == HAL_UART_STATE_READY)

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
    {.name = "other-uart", .act = call_for_other_uart},
    {.name = "receive-else", .act = receive_elsewhere},
    {.name = "abort-else", .act = abort_elsewhere},
    {.name = "command", .act = command},
    {.name = "ready", .count = is_ready},
#endif
    {.name = NULL},
};

/* --------------------------------------------------------------------------------- byte by byte */

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
 * That byte comes during the restart, at each access in turn. Only DMA needs an aligned buffer. */
void test_bytes_that_come_during_a_restart_stay_within_a_buffer_at_any_address(void)
{
    static uint8_t aligned[1 + 256 + 1] __ALIGNED(32);
    uint8_t *const memory = &aligned[1];
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
