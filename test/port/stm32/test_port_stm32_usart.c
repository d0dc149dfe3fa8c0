/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the STM32 port without HAL, with both register layouts, on the model. Interrupts stay
 * pending until a handler clears them, and may come at any access. */

#include "tmini_stm32_usart.h"

#include <string.h>

#include "line.h"
#include "stm32_model.h"
#include "unity.h"

#define RX_SIZE 1024u
#define LINE_PACKETS 300u

#define PACKET LINE_PACKET_SIZE

static volatile uint32_t time_ms;
static uint8_t rx[RX_SIZE];
static tmini_t lidar;
static tmini_stm32_usart_t port;
static tmini_stm32_usart_wiring_t wiring;

/* ---------------------------------------------------------------------------------- the project */

static void usart_handler(void)
{
    tmini_stm32_usart_interrupt(&port);
}

static void dma_handler(void)
{
    const uint32_t flags = model.dma.flags;
    model_step();
    model.dma.flags &= ~flags;
    tmini_stm32_usart_dma_interrupt(&port, (flags & MODEL_DMA_HT) != 0,
                                    (flags & MODEL_DMA_TC) != 0);
}

static void set_up_channel(void)
{
    model.dma = (model_dma_t){
        .enabled = true,
        .circular = true,
        .memory = rx,
        .size = RX_SIZE,
        .channel = {RX_SIZE},
        .interrupts = MODEL_DMA_HT | MODEL_DMA_TC,
    };
}

static tmini_status_t open_with_clock(bool rx_dma, uint32_t clock_hz)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = rx_dma,
    };
    wiring = (tmini_stm32_usart_wiring_t){
        .usart = &model_usart, .clock_hz = clock_hz, .time_ms = &time_ms};
    wiring.remaining = &model.dma.channel.CBR1;
    model_reset();
    line_open();
    memset(rx, 0, sizeof rx);
    set_up_channel();
    irq.lines[MODEL_USART_IRQ].handler = usart_handler;
    irq.lines[MODEL_DMA_IRQ].handler = dma_handler;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    return tmini_stm32_usart_init(&port, &wiring);
}

static void start_with_clock(bool rx_dma, uint32_t clock_hz)
{
    TEST_ASSERT_EQUAL(TMINI_OK, open_with_clock(rx_dma, clock_hz));
    model_usart.CR1 = 0;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar));
}

static void start(bool rx_dma)
{
    start_with_clock(rx_dma, 84000000);
}

void setUp(void) {}

void tearDown(void) {}

static tmini_stm32_usart_counters_t errors(void)
{
    tmini_stm32_usart_counters_t counters;
    tmini_stm32_usart_counters(&port, &counters);
    return counters;
}

static tmini_counters_t poll(void)
{
    return line_poll(&lidar);
}

static uint32_t run(void)
{
    return line_run(&lidar, 200).packets;
}

/* Sends `count` packets; returns how many arrive. */
static uint32_t run_packets(unsigned count)
{
    const uint32_t before = poll().packets;
    line_send_packets(count);
    return run() - before;
}

/* ----------------------------------------------------------------------------------- life cycle */

void test_the_divider_is_rounded_to_nearest(void)
{
    static const struct {
        uint32_t clock_hz;
        uint32_t divider;
    } clocks[] = {{84000000, 365}, {16000000, 69}, {8000000, 35}, {3686400, 16}, {170000000, 738}};
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        start_with_clock(false, clocks[i].clock_hz);
        TEST_ASSERT_EQUAL_UINT32(clocks[i].divider, model_usart.BRR);
    }
}

/* Several families start with a 4 MHz oscillator, which gives 235294 baud: 2.1 % too fast. */
void test_a_clock_that_does_not_make_the_baud_rate_is_refused(void)
{
    static const uint32_t clocks_hz[] = {1000000, 2097000, 3000000, 3600000, 4000000};
    for (size_t i = 0; i < sizeof clocks_hz / sizeof clocks_hz[0]; i++) {
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, open_with_clock(false, clocks_hz[i]));
    }
}

void test_a_started_usart_sends_receives_and_interrupts(void)
{
    start(false);
    TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | 0x2C, model_usart.CR1); /* RE 2, TE 3, RXNEIE 5 */
    TEST_ASSERT_EQUAL_HEX32(0, model_usart.CR3);
    start(true);
    TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | 0x1C, model_usart.CR1); /* RE 2, TE 3, IDLEIE 4 */
    TEST_ASSERT_EQUAL_HEX32(MODEL_CR3_DMAR, model_usart.CR3);
}

/* LL_USART_Init() has set them, or an LPUART needs another divider. */
void test_without_a_clock_baud_rate_and_format_are_not_changed(void)
{
    TEST_ASSERT_EQUAL(TMINI_OK, open_with_clock(false, 0));
    model_usart.CR1 = 0x10000000u;
    model_usart.CR3 = 0x00001001u; /* OVRDIS (no overruns) and EIE (error interrupt). */
    model_usart.BRR = 0x12345u;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar));
    TEST_ASSERT_EQUAL_HEX32(0x12345u, model_usart.BRR);
    TEST_ASSERT_EQUAL_HEX32(0x10000000u | MODEL_CR1_UE | 0x2C, model_usart.CR1);
    TEST_ASSERT_EQUAL_HEX32(0x00001000u, model_usart.CR3);
}

void test_missing_arguments_are_refused(void)
{
    static tmini_stm32_usart_t no_port;
    static tmini_t no_lidar;
    TEST_ASSERT_EQUAL(TMINI_OK, open_with_clock(false, 84000000));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(NULL, &wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(NULL, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&no_port, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, &no_lidar));
    wiring.time_ms = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, &wiring));
    wiring = (tmini_stm32_usart_wiring_t){.time_ms = &time_ms};
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, &wiring));
}

void test_a_dma_channel_that_is_not_at_the_buffers_start_is_refused(void)
{
    TEST_ASSERT_EQUAL(TMINI_OK, open_with_clock(true, 84000000));
    model.dma.channel.CBR1 = RX_SIZE - 1;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(&port, &lidar));
    wiring.remaining = NULL;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(&port, &wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(&port, &lidar));
}

void test_after_stop_no_byte_arrives_and_received_bytes_are_kept(void)
{
    for (int rx_dma = 0; rx_dma < 2; rx_dma++) {
        start(rx_dma != 0);
        line_send_packets(3);
        model_pass(3 * PACKET * 50);
        tmini_stm32_usart_stop(&port);
        line_send_packets(3);
        TEST_ASSERT_EQUAL_UINT32(3, run());
        tmini_stm32_usart_dma_interrupt(&port, true, true); /* A pending interrupt. */
        tmini_stm32_usart_interrupt(&port);
        TEST_ASSERT_EQUAL_UINT32(3, poll().packets);
        TEST_ASSERT_EQUAL_HEX32(0, model_usart.CR3);
        TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | 0x0C, model_usart.CR1); /* TX stays on. */
    }
}

void test_after_another_start_dma_begins_at_the_buffers_start(void)
{
    start(true);
    TEST_ASSERT_EQUAL_UINT32(100, run_packets(100)); /* The buffer is now full of old packets. */
    tmini_stm32_usart_stop(&port);
    set_up_channel();
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT32(100, poll().packets); /* None of these is read again. */
    TEST_ASSERT_EQUAL_UINT32(5, run_packets(5));
}

void test_the_usart_is_set_up_again_when_the_lidar_is_lost(void)
{
    for (int rx_dma = 0; rx_dma < 2; rx_dma++) {
        start(rx_dma != 0);
        model_usart = (USART_TypeDef){0};
        TEST_ASSERT_EQUAL_UINT32(0, run_packets(5));
        tmini_stm32_usart_port.restart(&port);
        TEST_ASSERT_EQUAL_UINT32(5, run_packets(5));
        tmini_stm32_usart_stop(&port);
        model_usart = (USART_TypeDef){0};
        tmini_stm32_usart_port.restart(&port);
        TEST_ASSERT_EQUAL_HEX32(0, model_usart.CR1);
    }
}

/* --------------------------------------------------------------------------------- byte by byte */

void test_bytes_at_any_access_of_a_poll_reach_the_lidar(void)
{
    start(false);
    TEST_ASSERT_EQUAL_UINT32(LINE_PACKETS, run_packets(LINE_PACKETS));
    TEST_ASSERT_EQUAL_UINT32(LINE_PACKETS * PACKET, errors().bytes);
}

void test_a_byte_with_a_line_error_is_counted_and_stored(void)
{
    start(false);
    line_send_with(MODEL_FE);
    line_send_packets(1);
    line_send_with(MODEL_NE);
    TEST_ASSERT_EQUAL_UINT32(2, run_packets(1));
    TEST_ASSERT_EQUAL_UINT32(1, errors().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, errors().noise_errors);
    TEST_ASSERT_EQUAL_UINT32(0, errors().overruns);
}

/* The overrun flag is set in mid-packet: the second half may be another packet's. */
void test_no_packet_continues_across_an_overrun(void)
{
    start(false);
    line_send(line_packet, 6);
    (void)run();
    model.flags |= MODEL_ORE;
    model_pass(1000);
    line_send(&line_packet[6], PACKET - 6);
    TEST_ASSERT_EQUAL_UINT32(0, run());
    TEST_ASSERT_EQUAL_UINT32(1, errors().overruns);
    TEST_ASSERT_EQUAL_UINT32(5, run_packets(5));
}

void test_late_interrupts_are_an_overrun_that_is_counted_and_survived(void)
{
    start(false);
    model.held_until_ns = 400000;
    (void)run_packets(3);
    TEST_ASSERT_EQUAL_UINT32(1, errors().overruns);
    TEST_ASSERT_EQUAL_UINT32(5, run_packets(5));
}

/* ------------------------------------------------------------------------------------------ DMA */

void test_dma_delivers_every_byte(void)
{
    start(true);
    TEST_ASSERT_EQUAL_UINT32(LINE_PACKETS, run_packets(LINE_PACKETS));
    TEST_ASSERT_EQUAL_UINT32(0, errors().laps);
}

void test_half_a_buffer_and_an_idle_line_are_handed_over_without_a_poll(void)
{
    start(true);
    line_send_packets(40);
    model_pass(22400); /* 516 bytes arrive. */
    TEST_ASSERT_EQUAL_UINT32(RX_SIZE / 2, tmini_ring_head(&lidar.ring));
    model_pass(1000);
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
    start(true);
    for (uint32_t place = 0; place < 80; place = irq_next_place(&random, place)) {
        line_send_packets(1);
        model_pass(500);
        irq_happen_after(place, line_falls_idle);
        (void)poll();
    }
    (void)run();
    TEST_ASSERT_EQUAL_UINT32(0, model.flags & MODEL_IDLE);
}

void test_a_lap_without_any_interrupt_is_noticed(void)
{
    start(true);
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
    model.held_until_ns = model.now_ns + 60000000u;
    line_send_packets(90); /* 1170 bytes: DMA passes its old position again. */
    model_pass(60000);
    TEST_ASSERT_UINT32_WITHIN(1, 10 + 11, run()); /* Only the bytes after the lap are left. */
    TEST_ASSERT_EQUAL_UINT32(1, errors().laps);
    model.held_until_ns = model.now_ns + 60000000u;
    line_send_packets(102); /* A lap and 302 bytes, past the middle: only the end shows the lap. */
    model_pass(60000);
    (void)run();
    TEST_ASSERT_EQUAL_UINT32(2, errors().laps);
}

/* On a USART with SR, reading DR clears errors and the idle flag (reference manual RM0090), but
 * also removes a byte that waits for DMA. */
void test_a_byte_that_waits_for_dma_is_not_removed(void)
{
    start(true);
    irq.lines[MODEL_USART_IRQ].handler = NULL;
    model.dma.enabled = false;
    line_send_packets(1);
    model_pass(2000);
    TEST_ASSERT_EQUAL_HEX32(MODEL_RXNE | MODEL_ORE, model.flags & (MODEL_RXNE | MODEL_ORE));
    tmini_stm32_usart_interrupt(&port);
    tmini_stm32_usart_interrupt(&port);
    TEST_ASSERT_EQUAL_HEX32(MODEL_RXNE, model.flags & MODEL_RXNE);
    TEST_ASSERT_EQUAL_UINT32(1, errors().overruns);
}

/* On a USART with SR, the idle flag cannot be cleared while a byte waits. */
void test_a_dma_channel_that_has_stopped_is_no_lock_up(void)
{
    start(true);
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
    model.dma.enabled = false;
    TEST_ASSERT_EQUAL_UINT32(0, run_packets(10));
    tmini_stm32_usart_stop(&port);
    set_up_channel();
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
    line_send_packets(1);
    model_pass(1000);
    TEST_ASSERT_NOT_EQUAL(0, model_usart.CR1 & MODEL_CR1_IDLEIE);
}

/* The DMA has already taken the byte: only the poll checks the flag. */
void test_an_overrun_that_holds_bytes_back_is_cleared_by_the_next_poll(void)
{
    start(true);
    model.ore_holds_rxne = true;
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
    model.flags |= MODEL_ORE;
    model_pass(1000);
    (void)poll();
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
    TEST_ASSERT_EQUAL_UINT32(1, errors().overruns);
}

/* -------------------------------------------------------------------- functions of newer USARTs */

static void start_with_settings(bool rx_dma)
{
#ifdef STM32_MODEL_SR
    TEST_IGNORE_MESSAGE("not with SR and DR");
#endif
    start_with_clock(rx_dma, 0);
}

/* With DDRE, an error holds DMA requests back until it is cleared. */
void test_an_error_that_holds_dma_back_costs_only_bytes_until_the_next_poll(void)
{
    start_with_settings(true);
    model_usart.CR3 |= MODEL_CR3_DDRE;
    line_send_with(MODEL_FE);
    TEST_ASSERT_UINT32_WITHIN(1, 9, run_packets(10)); /* Polled every 200 us (4 bytes). */
    TEST_ASSERT_EQUAL_UINT32(1, errors().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
}

void test_an_enabled_fifo_keeps_eight_bytes_for_a_late_interrupt(void)
{
    start_with_settings(false);
    model_usart.CR1 |= MODEL_CR1_FIFOEN;
    for (unsigned i = 0; i < 20; i++) {
        line_send_packets(1);
        model_pass(100);
        model.held_until_ns = model.now_ns + 340000u;
        model_pass(2000);
    }
    TEST_ASSERT_EQUAL_UINT32(20, run());
    TEST_ASSERT_EQUAL_UINT32(0, errors().overruns);
}

/* LL has left the FIFO threshold's interrupt on, which the port does not need. */
void test_the_fifos_threshold_is_no_lock_up(void)
{
    start_with_settings(false);
    model_usart.CR1 |= MODEL_CR1_FIFOEN;
    model_usart.CR3 |= MODEL_CR3_RXFTIE | MODEL_CR3_RXFTCFG_HALF;
    model.held_until_ns = 300000;
    TEST_ASSERT_EQUAL_UINT32(10, run_packets(10));
}

/* -------------------------------------------------------------------------------------- sending */

static uint8_t sent;

static void note_sent(uint8_t byte, uint64_t now_us)
{
    (void)now_us;
    sent = byte;
}

void test_an_empty_transmitter_takes_a_command_and_a_full_one_takes_nothing(void)
{
    static const uint8_t command[] = {0xA5, 0x60};
    start(false);
    model.sent = note_sent;
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_usart_port.write(&port, command, 2));
    TEST_ASSERT_EQUAL_HEX8(0x60, sent);
    model.flags &= ~MODEL_TXE;
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_usart_port.write(&port, command, 2));
}

void test_the_clock_is_the_given_counter(void)
{
    start(false);
    time_ms = 0xFFFFFFFFu;
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, tmini_stm32_usart_port.now_ms(&port));
}
