/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The STM32 port on the registers, in both layouts: an array stands for the USART, a number for
 * what the DMA channel still has to do. The bits have the same places in SR and in ISR. */

#include "tmini_stm32_usart.h"

#include <string.h>

#include "unity.h"

#ifdef USART_HAS_RDR /* Reference manual RM0444 and others. */
enum { CR1 = 0, CR3 = 2, BRR = 3, STATUS = 7, CLEAR = 8, RECEIVED = 9, TO_SEND = 10 };
#define CR1_BYTES 0x0000002Du      /* UE 0, RE 2, TE 3, RXNEIE 5 */
#define CR1_DMA 0x0000001Du        /* UE 0, RE 2, TE 3, IDLEIE 4 */
#define CLEAR_EXPECTED 0x00000008u /* The overrun's bit. */
#define IDLE_CLEARED 0x10u
#else                         /* Reference manual RM0090 and others. */
enum { STATUS = 0, RECEIVED = 1, TO_SEND = 1, BRR = 2, CR1 = 3, CR3 = 5, CLEAR = 7 };
#define CR1_BYTES 0x0000202Cu /* RE 2, TE 3, RXNEIE 5, UE 13 */
#define CR1_DMA 0x0000201Cu   /* RE 2, TE 3, IDLEIE 4, UE 13 */
#define CLEAR_EXPECTED 0u     /* There is no such register: reading clears. */
#define IDLE_CLEARED 0u
#endif

#define CR3_DMAR 0x40u
#define FRAMING_ERROR 0x02u
#define NOISE 0x04u
#define OVERRUN 0x08u
#define IDLE 0x10u
#define RECEIVE_NOT_EMPTY 0x20u
#define TRANSMIT_EMPTY 0x80u
#define RX_SIZE 512u

/* As a real unit has sent it (section 9.14). */
static const uint8_t packet[] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                 0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};
#define PACKET sizeof packet

static volatile uint32_t registers[16];
static volatile uint32_t time_ms;
static volatile uint32_t remaining;
static uint32_t written; /* By DMA, in all. */
static uint8_t rx[RX_SIZE];
static tmini_t lidar;
static tmini_stm32_usart_t port;

static void set_up(bool rx_dma)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = rx_dma,
    };
    for (size_t i = 0; i < sizeof registers / sizeof registers[0]; i++) {
        registers[i] = 0;
    }
    memset(rx, 0, sizeof rx);
    time_ms = 0;
    remaining = RX_SIZE;
    written = 0;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(&port, registers, &time_ms));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
}

static void start_dma(void)
{
    set_up(true);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
}

void setUp(void)
{
    set_up(false);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar, 84000000));
}

void tearDown(void) {}

static void interrupt_with(uint32_t status, uint8_t byte)
{
    registers[STATUS] = status;
    registers[RECEIVED] = byte;
    tmini_stm32_usart_interrupt(&port);
}

static tmini_counters_t counters_after_polling(void)
{
    tmini_counters_t counters;
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
    return counters;
}

static uint32_t packets(void)
{
    return counters_after_polling().packets;
}

static uint32_t bytes_stored(void)
{
    const tmini_counters_t counters = counters_after_polling();
    return counters.bytes_skipped + counters.bytes_in_packets + counters.bytes_pending;
}

/* ----------------------------------------------------------------------------------- life cycle */

void test_the_divider_is_rounded_to_nearest(void)
{
    static const struct {
        uint32_t clock_hz;
        uint32_t divider;
    } clocks[] = {{84000000, 365}, {16000000, 69}, {8000000, 35}, {3686400, 16}, {170000000, 738}};
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar, clocks[i].clock_hz));
        TEST_ASSERT_EQUAL_UINT32(clocks[i].divider, registers[BRR]);
    }
}

/* 4 MHz, an oscillator that several families start with, makes 235294 baud, 2.1 % too much. */
void test_a_clock_that_does_not_make_the_baud_rate_is_refused(void)
{
    static const uint32_t clocks_hz[] = {1000000, 2097000, 3000000, 3600000, 4000000};
    for (size_t i = 0; i < sizeof clocks_hz / sizeof clocks_hz[0]; i++) {
        TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                          tmini_stm32_usart_start(&port, &lidar, clocks_hz[i]));
    }
}

void test_a_started_usart_sends_receives_and_interrupts(void)
{
    TEST_ASSERT_EQUAL_HEX32(CR1_BYTES, registers[CR1]);
    TEST_ASSERT_EQUAL_HEX32(0, registers[CR3]);
}

/* LL_USART_Init() has been there, or it is an LPUART, whose divider is another. */
void test_without_a_clock_baud_rate_and_format_stay_as_they_are(void)
{
    registers[CR1] = 0x10000000u;
    registers[CR3] = 0x00001001u; /* Overruns off; errors' interrupt on. */
    registers[BRR] = 0x12345u;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar, 0));
    TEST_ASSERT_EQUAL_HEX32(0x12345u, registers[BRR]);
    TEST_ASSERT_EQUAL_HEX32(0x10000000u | CR1_BYTES, registers[CR1]);
    TEST_ASSERT_EQUAL_HEX32(0x00001000u, registers[CR3]);
}

void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(NULL, registers, &time_ms));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, NULL, &time_ms));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, registers, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(NULL, &lidar, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, NULL, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start_dma(NULL, &lidar, 0, &remaining));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start_dma(&port, NULL, 0, &remaining));
}

void test_a_port_or_a_lidar_that_is_not_set_up_is_refused(void)
{
    static tmini_stm32_usart_t no_port;
    static tmini_t no_lidar;
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&no_port, &lidar, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, &no_lidar, 0));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE,
                      tmini_stm32_usart_start_dma(&port, &no_lidar, 0, &remaining));
}

void test_a_buffer_for_the_other_way_is_refused(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
    set_up(true);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(&port, &lidar, 84000000));
}

void test_after_stop_nothing_interrupts_and_sending_goes_on(void)
{
    tmini_stm32_usart_stop(&port);
    TEST_ASSERT_EQUAL_HEX32(CR1_BYTES & ~0x20u, registers[CR1]);
}

/* --------------------------------------------------------------------------------- byte by byte */

void test_a_received_packet_reaches_the_lidar(void)
{
    for (size_t i = 0; i < PACKET; i++) {
        interrupt_with(RECEIVE_NOT_EMPTY, packet[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(1, packets());
    TEST_ASSERT_EQUAL_UINT32(13, port.bytes);
}

void test_an_interrupt_for_another_reason_stores_nothing(void)
{
    interrupt_with(TRANSMIT_EMPTY, 0x11);
    TEST_ASSERT_EQUAL_UINT32(0, bytes_stored());
    TEST_ASSERT_EQUAL_UINT32(0, port.bytes);
}

void test_a_byte_with_a_line_error_is_counted_and_stored(void)
{
    interrupt_with(RECEIVE_NOT_EMPTY | FRAMING_ERROR, 0x11);
    interrupt_with(RECEIVE_NOT_EMPTY | NOISE, 0x11);
    TEST_ASSERT_EQUAL_UINT32(2, bytes_stored());
    TEST_ASSERT_EQUAL_UINT32(1, port.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, port.noise_errors);
    TEST_ASSERT_EQUAL_UINT32(0, port.overruns);
}

void test_the_byte_that_an_overrun_left_is_stored(void)
{
    interrupt_with(RECEIVE_NOT_EMPTY | OVERRUN, 0x11);
    TEST_ASSERT_EQUAL_UINT32(1, bytes_stored());
    TEST_ASSERT_EQUAL_UINT32(1, port.overruns);
}

void test_an_overrun_without_a_byte_stores_nothing(void)
{
    interrupt_with(OVERRUN, 0x11);
    TEST_ASSERT_EQUAL_UINT32(0, bytes_stored());
    TEST_ASSERT_EQUAL_UINT32(1, port.overruns);
}

void test_errors_are_cleared_the_usarts_own_way_and_nothing_else_is(void)
{
    interrupt_with(RECEIVE_NOT_EMPTY | OVERRUN | TRANSMIT_EMPTY, 0x11);
    TEST_ASSERT_EQUAL_HEX32(CLEAR_EXPECTED, registers[CLEAR]);
}

/* ------------------------------------------------------------------------------------------ DMA */

/* Bytes go to memory without anybody being told. */
static void dma_writes(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        rx[written % RX_SIZE] = bytes[i];
        written++;
    }
    remaining = 0xFFFF0000u | (RX_SIZE - written % RX_SIZE); /* Upper half: whatever it may hold. */
}

static void dma_writes_packets(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        dma_writes(packet, PACKET);
    }
}

static void poll_and_write_packets(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        dma_writes_packets(1);
        tmini_stm32_usart_interrupt(&port);
        (void)packets();
    }
}

void test_with_dma_the_usart_requests_it_and_interrupts_when_the_line_is_idle(void)
{
    start_dma();
    TEST_ASSERT_EQUAL_HEX32(CR1_DMA, registers[CR1]);
    TEST_ASSERT_EQUAL_HEX32(CR3_DMAR, registers[CR3]);
}

void test_a_dma_channel_that_is_not_at_the_buffers_start_is_refused(void)
{
    set_up(true);
    remaining = RX_SIZE - 1;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_usart_start_dma(&port, &lidar, 84000000, NULL));
    remaining = RX_SIZE;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT,
                      tmini_stm32_usart_start_dma(&port, &lidar, 4000000, &remaining));
}

void test_an_idle_line_hands_over_what_dma_has_written(void)
{
    start_dma();
    dma_writes_packets(3);
    TEST_ASSERT_EQUAL_UINT32(0, tmini_ring_head(&lidar.ring));
    interrupt_with(IDLE, 0);
    TEST_ASSERT_EQUAL_UINT32(3 * PACKET, tmini_ring_head(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT32(3, packets());
}

void test_an_idle_line_that_has_interrupted_is_cleared(void)
{
    start_dma();
    interrupt_with(IDLE, 0);
    TEST_ASSERT_EQUAL_HEX32(IDLE_CLEARED, registers[CLEAR]);
}

void test_half_and_whole_buffer_hand_over_what_dma_has_written(void)
{
    start_dma();
    poll_and_write_packets(15);
    dma_writes_packets(5); /* 260 bytes of 512. */
    tmini_stm32_usart_dma_interrupt(&port, true, false);
    TEST_ASSERT_EQUAL_UINT32(20, packets());
    poll_and_write_packets(15);
    dma_writes_packets(5);
    tmini_stm32_usart_dma_interrupt(&port, false, true);
    TEST_ASSERT_EQUAL_UINT32(40, packets());
    TEST_ASSERT_EQUAL_UINT32(0, port.laps);
}

void test_a_poll_hands_over_what_dma_has_written(void)
{
    start_dma();
    for (unsigned i = 0; i < 100; i++) {
        dma_writes_packets(2);
        (void)packets(); /* Its polls end before they have seen what came with the clock. */
    }
    TEST_ASSERT_EQUAL_UINT32(200, packets());
    TEST_ASSERT_EQUAL_UINT32(0, port.laps);
}

void test_a_lap_that_no_interrupt_has_seen_is_noticed(void)
{
    start_dma();
    dma_writes_packets(10);
    (void)packets();
    dma_writes_packets(45); /* 585 bytes: past the middle, the end and the place where it was. */
    tmini_stm32_usart_dma_interrupt(&port, true, true);
    TEST_ASSERT_EQUAL_UINT32(1, port.laps);
    TEST_ASSERT_UINT32_WITHIN(1, 10 + 5, packets()); /* Of 585 bytes those beyond the lap. */
}

void test_with_dma_line_errors_are_counted_once_and_bytes_stay(void)
{
    start_dma();
    dma_writes_packets(1);
    registers[STATUS] = FRAMING_ERROR | RECEIVE_NOT_EMPTY;
    tmini_stm32_usart_interrupt(&port);
    tmini_stm32_usart_interrupt(&port); /* The DMA has not taken the byte yet. */
    registers[STATUS] = 0;
    tmini_stm32_usart_interrupt(&port);
    registers[STATUS] = OVERRUN;
    tmini_stm32_usart_interrupt(&port);
    TEST_ASSERT_EQUAL_UINT32(1, port.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, port.overruns);
    TEST_ASSERT_EQUAL_UINT32(1, packets());
}

void test_after_stop_dma_is_asked_for_nothing_and_what_had_come_is_there(void)
{
    start_dma();
    dma_writes_packets(3);
    tmini_stm32_usart_stop(&port);
    TEST_ASSERT_EQUAL_HEX32(0, registers[CR3]);
    TEST_ASSERT_EQUAL_HEX32(CR1_DMA & ~0x10u, registers[CR1]);
    dma_writes_packets(3);
    tmini_stm32_usart_dma_interrupt(&port, true, true);
    TEST_ASSERT_EQUAL_UINT32(3, packets());
}

void test_started_again_dma_begins_at_the_buffers_start(void)
{
    start_dma();
    poll_and_write_packets(60); /* More than a lap: there are packets in all of the buffer. */
    tmini_stm32_usart_stop(&port);
    TEST_ASSERT_EQUAL_UINT32(60, packets());
    remaining = RX_SIZE;
    written = 0;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
    TEST_ASSERT_EQUAL_UINT32(60, packets()); /* Nothing that had come before comes again. */
    dma_writes_packets(5);
    tmini_stm32_usart_interrupt(&port);
    TEST_ASSERT_EQUAL_UINT32(65, packets());
}

void test_started_again_an_error_that_still_shows_is_counted_anew(void)
{
    start_dma();
    interrupt_with(FRAMING_ERROR | RECEIVE_NOT_EMPTY, 0);
    TEST_ASSERT_EQUAL_UINT32(1, port.framing_errors);
    tmini_stm32_usart_stop(&port);
    remaining = RX_SIZE;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
    interrupt_with(FRAMING_ERROR | RECEIVE_NOT_EMPTY, 0);
    TEST_ASSERT_EQUAL_UINT32(2, port.framing_errors);
}

/* The buffer is full to its end: nothing but a gap shows that reception was interrupted. */
void test_started_again_at_the_buffers_start_there_is_a_gap(void)
{
    start_dma();
    poll_and_write_packets(39); /* 507 bytes. */
    dma_writes((const uint8_t[5]){0xAA, 0x55, 0x75, 0x01, 0x3F}, 5);
    tmini_stm32_usart_interrupt(&port);
    (void)packets();
    tmini_stm32_usart_stop(&port);
    TEST_ASSERT_EQUAL_UINT32(512, tmini_ring_head(&lidar.ring));
    remaining = RX_SIZE;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &remaining));
    TEST_ASSERT_EQUAL_UINT32(1024, tmini_ring_head(&lidar.ring)); /* A lap that nobody saw. */
}

/* -------------------------------------------------------------------------------------- sending */

void test_an_empty_transmitter_takes_a_command(void)
{
    static const uint8_t command[] = {0xA5, 0x60};
    registers[STATUS] = TRANSMIT_EMPTY;
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_usart_port.write(&port, command, 2));
    TEST_ASSERT_EQUAL_HEX32(0x60, registers[TO_SEND]);
}

void test_a_full_transmitter_takes_nothing_and_is_not_waited_for(void)
{
    static const uint8_t command[] = {0xA5, 0x60};
    registers[STATUS] = 0;
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_usart_port.write(&port, command, 2));
    TEST_ASSERT_EQUAL_HEX32(0, registers[TO_SEND]);
}

void test_the_clock_is_the_count_it_was_given(void)
{
    time_ms = 0xFFFFFFFFu;
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, tmini_stm32_usart_port.now_ms(&port));
}
