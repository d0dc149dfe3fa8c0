/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the STM32 port without HAL, with both register layouts, on the model: what the port over
 * the HAL has not (stm32_scenes.c). */

#include "usart_rig.h"

#include "random.h"
#include "stm32_scenes.h"
#include "unity.h"

static tmini_stm32_usart_t *const port = &usart_rig.port;
static tmini_stm32_usart_wiring_t *const wiring = &usart_rig.wiring;

static tmini_status_t init_with_clock(uint32_t clock_hz)
{
    wiring->clock_hz = clock_hz;
    return tmini_stm32_usart_init(port, wiring);
}

/* ----------------------------------------------------------------------------------- life cycle */

void test_the_divider_is_rounded_to_nearest(void)
{
    static const struct {
        uint32_t clock_hz;
        uint32_t divider;
    } clocks[] = {{84000000, 365}, {16000000, 69}, {8000000, 35}, {3686400, 16}, {170000000, 738}};
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        open_port(BY_BYTES);
        TEST_ASSERT_EQUAL(TMINI_OK, init_with_clock(clocks[i].clock_hz));
        TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
        TEST_ASSERT_EQUAL_UINT32(clocks[i].divider, model_usart.BRR);
    }
}

/* Several families start with a 4 MHz oscillator, which gives 235294 baud: 2.1 % too fast. */
void test_a_clock_that_does_not_make_the_baud_rate_is_refused(void)
{
    static const uint32_t clocks_hz[] = {1000000, 2097000, 3000000, 3600000, 4000000};
    open_port(BY_BYTES);
    for (size_t i = 0; i < sizeof clocks_hz / sizeof clocks_hz[0]; i++) {
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, init_with_clock(clocks_hz[i]));
    }
}

/* When it has stopped, it can still send; pending interrupts change nothing. */
void test_a_started_usart_sends_receives_and_interrupts(void)
{
    while (next_way(ANY_WAY)) {
        const bool by_dma = rig_way == BY_DMA; /* RE 2, TE 3, IDLEIE 4, RXNEIE 5 */
        TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | (by_dma ? 0x1C : 0x2C), model_usart.CR1);
        TEST_ASSERT_EQUAL_HEX32(by_dma ? MODEL_CR3_DMAR : 0, model_usart.CR3);
        receive(3);
        rig_stop();
        model.dma.channel.CBR1 = 500;
        tmini_stm32_usart_dma_interrupt(port, true, true);
        tmini_stm32_usart_interrupt(port);
        TEST_ASSERT_EQUAL_UINT32(3 * PACKET_SIZE, bytes_accounted_for());
        TEST_ASSERT_EQUAL_HEX32(0, model_usart.CR3);
        TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | 0x0C, model_usart.CR1);
    }
}

/* LL_USART_Init() has set them, or an LPUART needs another divider. */
void test_without_a_clock_baud_rate_and_format_are_not_changed(void)
{
    open_port(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_OK, init_with_clock(0));
    model_usart.CR1 = 0x10000000u;
    model_usart.CR3 = 0x00001001u; /* OVRDIS (no overruns) and EIE (error interrupt). */
    model_usart.BRR = 0x12345u;
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
    TEST_ASSERT_EQUAL_HEX32(0x12345u, model_usart.BRR);
    TEST_ASSERT_EQUAL_HEX32(0x10000000u | MODEL_CR1_UE | 0x2C, model_usart.CR1);
    TEST_ASSERT_EQUAL_HEX32(0x00001000u, model_usart.CR3);
}

void test_missing_arguments_are_refused(void)
{
    static tmini_stm32_usart_t no_port;
    static tmini_t no_lidar;
    open_port(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(NULL, wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(NULL, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&no_port, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(port, &no_lidar));
    wiring->time_ms = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(port, wiring));
    *wiring = (tmini_stm32_usart_wiring_t){.time_ms = &model.tick_ms};
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(port, wiring));
}

void test_a_dma_channel_that_is_not_at_the_buffers_start_is_refused(void)
{
    open_port(BY_DMA);
    model.dma.channel.CBR1 = RIG_RX_SIZE - 1;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(port, &lidar));
    wiring->remaining = NULL;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(port, wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(port, &lidar));
}

void test_bytes_are_counted(void)
{
    tmini_stm32_usart_counters_t counters;
    start_port(BY_BYTES);
    receive(30);
    tmini_stm32_usart_counters(port, &counters);
    TEST_ASSERT_EQUAL_UINT32(30 * PACKET_SIZE, counters.bytes);
}

/* ------------------------------------------------------------------------------------------ DMA */

void test_half_a_buffer_and_an_idle_line_are_handed_over_without_a_poll(void)
{
    start_port(BY_DMA);
    send_packets(40);
    machine_pass(22400); /* 516 bytes arrive. */
    TEST_ASSERT_EQUAL_UINT32(RIG_RX_SIZE / 2, tmini_ring_head(&lidar.ring));
    machine_pass(1000);
    TEST_ASSERT_EQUAL_UINT32(520, tmini_ring_head(&lidar.ring));
}

/* The flag must be cleared, even while the poll hands bytes over. */
static void line_falls_idle(void)
{
    model.flags |= MODEL_IDLE;
}

void test_an_idle_line_at_any_access_of_a_poll_is_no_lock_up(void)
{
    random_t random;
    random_seed(&random, 1);
    start_port(BY_DMA);
    for (uint32_t place = 0; place < 80; place = irq_next_place(&random, place)) {
        send_packets(1);
        machine_pass(500);
        irq_happen_after(place, line_falls_idle);
        (void)poll_all();
    }
    run();
    TEST_ASSERT_EQUAL_UINT32(0, model.flags & MODEL_IDLE);
}

/* On a USART with SR, reading DR clears errors and the idle flag (reference manual RM0090), but
 * also removes a byte that waits for DMA. */
void test_a_byte_that_waits_for_dma_is_not_removed(void)
{
    start_port(BY_DMA);
    irq.lines[MODEL_USART_IRQ].handler = NULL;
    model.dma.enabled = false;
    send_packets(1);
    machine_pass(2000);
    TEST_ASSERT_EQUAL_HEX32(MODEL_RXNE | MODEL_ORE, model.flags & (MODEL_RXNE | MODEL_ORE));
    tmini_stm32_usart_interrupt(port);
    tmini_stm32_usart_interrupt(port);
    TEST_ASSERT_EQUAL_HEX32(MODEL_RXNE, model.flags & MODEL_RXNE);
    TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
}

/* On a USART with SR, the idle flag cannot be cleared while a byte waits. */
void test_a_dma_channel_that_has_stopped_is_no_lock_up(void)
{
    start_port(BY_DMA);
    receive(10);
    model.dma.enabled = false;
    receive(10);
    TEST_ASSERT_EQUAL_UINT32(10, packets());
    rig_stop();
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
    receive(10);
    TEST_ASSERT_EQUAL_UINT32(20, packets());
    send_packets(1);
    machine_pass(1000);
    TEST_ASSERT_NOT_EQUAL(0, model_usart.CR1 & MODEL_CR1_IDLEIE);
}

/* -------------------------------------------------------------------- functions of newer USARTs */

/* LL has left the FIFO threshold's interrupt on, which the port does not need. */
static void start_with_fifo(void)
{
#ifdef STM32_MODEL_SR
    TEST_IGNORE_MESSAGE("not with SR and DR");
#endif
    open_port(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_OK, init_with_clock(0));
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
    model_usart.CR1 |= MODEL_CR1_FIFOEN;
    model_usart.CR3 |= MODEL_CR3_RXFTIE | MODEL_CR3_RXFTCFG_HALF;
}

void test_an_enabled_fifo_keeps_eight_bytes_for_a_late_interrupt(void)
{
    start_with_fifo();
    for (unsigned i = 0; i < 20; i++) {
        send_packets(1);
        machine_pass(100);
        model.held_until_ns = machine.now_ns + 340000u;
        machine_pass(2000);
    }
    TEST_ASSERT_EQUAL_UINT32(20, packets());
    TEST_ASSERT_EQUAL_UINT32(0, rig_errors().overruns);
}

/* -------------------------------------------------------------------------------------- sending */

void test_an_empty_transmitter_takes_a_command_and_a_full_one_takes_nothing(void)
{
    static const uint8_t command[] = {0xA5, 0x60};
    start_port(BY_BYTES);
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_usart_port.write(port, command, 2));
    TEST_ASSERT_EQUAL_HEX8(0x60, model.sent[1]);
    model.flags &= ~MODEL_TXE;
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_usart_port.write(port, command, 2));
}

void test_the_clock_is_the_given_counter(void)
{
    static const uint32_t time_ms = 0xFFFFFFFFu;
    open_port(BY_BYTES);
    wiring->time_ms = &time_ms;
    TEST_ASSERT_EQUAL(TMINI_OK, init_with_clock(0));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, tmini_stm32_usart_port.now_ms(port));
}
