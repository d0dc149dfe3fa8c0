/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port on the model of USART, DMA and HAL: byte by byte, and with DMA into the
 * lidar's buffer and by blocks. Compiled for several families and years of the HAL: see
 * stm32_model/stm32_model.h. */

#include "tmini_stm32_hal.h"

#include <string.h>

#include "play.h"
#include "random.h"
#include "unity.h"
#include "usart.h"

static tmini_stm32_hal_t port;
static uint8_t blocks[1024] __ALIGNED(32);
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
        model.cached = blocks;
        model.cached_size = block_size;
        return tmini_stm32_hal_start_blocks(&port, &lidar, blocks, block_size);
    }
    model.cached = tmini_rx_buffer(&lidar, &model.cached_size);
    return tmini_stm32_hal_start(&port, &lidar);
}

/* With this value in this place, a start is refused. */
static void assert_refused(uint32_t *member, uint32_t value)
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
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start_blocks(NULL, &lidar, blocks, 256));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_hal_start_blocks(&port, NULL, blocks, 256));
    tmini_stm32_hal_stop(NULL);
    tmini_stm32_hal_stop(&no_port);
}

/* CubeMX proposes 115200 baud. */
void test_another_baud_rate_or_format_is_refused(void)
{
    assert_refused(&huart1.Init.BaudRate, 115200);
    assert_refused(&huart1.Init.Parity, UART_PARITY_EVEN);
    assert_refused(&huart1.Init.WordLength, UART_WORDLENGTH_9B);
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

static const struct {
    uint32_t *member;
    uint32_t value;
} wrong[] = {
#ifdef STM32_MODEL_NO_DMA
    {NULL, 0}, /* Not tried. */
#elif defined(DMA_LINKEDLIST_CIRCULAR)
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
    for (unsigned way = BY_DMA; way < port_way_count; way++) {
        play_begin(way);
        for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
            assert_refused(wrong[i].member, wrong[i].value);
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
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 62));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 255));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 65536));
    play_begin(BY_DMA); /* The lidar's own buffer is announced as DMA's target. */
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 256));
}

/* ----------------------------------------------------------------------------------------- DMA */

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
    for (unsigned way = BY_DMA; way < port_way_count; way++) {
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
    static const uint8_t broken = 0x00;
    for (unsigned at = 0; at < 60 * (port_way_count - 1); at++) {
        play_begin(BY_DMA + at / 60);
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
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(&blocks[4], 128));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, start_blocks(blocks, 80));
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
    TEST_ASSERT_LESS_THAN_INT(0, tmini_stm32_hal_port.write(&no_port, blocks, 2));
}

void test_the_clock_is_the_hals_and_waiting_sleeps_until_the_next_interrupt(void)
{
    machine_pass(12345678);
    TEST_ASSERT_EQUAL_UINT32(12345, tmini_stm32_hal_port.now_ms(&port));
    tmini_stm32_hal_port.wait(&port);
    TEST_ASSERT_EQUAL_UINT32(12346, tmini_stm32_hal_port.now_ms(&port));
}
