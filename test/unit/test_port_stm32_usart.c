/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The STM32 port on the registers, in both layouts: an array stands for the USART. The bits have the
 * same places in SR and in ISR. */

#include "tmini_stm32_usart.h"

#include <string.h>

#include "unity.h"

#ifdef USART_HAS_RDR /* Reference manual RM0444 and others. */
enum { CR1 = 0, BRR = 3, STATUS = 7, CLEAR = 8, RECEIVED = 9, TO_SEND = 10 };
#define CR1_EXPECTED 0x0000002Du   /* UE 0, RE 2, TE 3, RXNEIE 5 */
#define CLEAR_EXPECTED 0x00000008u /* The overrun's bit. */
#else                              /* Reference manual RM0090 and others. */
enum { STATUS = 0, RECEIVED = 1, TO_SEND = 1, BRR = 2, CR1 = 3, CLEAR = 7 };
#define CR1_EXPECTED 0x0000202Cu   /* RE 2, TE 3, RXNEIE 5, UE 13 */
#define CLEAR_EXPECTED 0u          /* There is no such register: reading clears. */
#endif

#define FRAMING_ERROR 0x02u
#define NOISE 0x04u
#define OVERRUN 0x08u
#define RECEIVE_NOT_EMPTY 0x20u
#define TRANSMIT_EMPTY 0x80u

static volatile uint32_t registers[16];
static volatile uint32_t time_ms;
static uint8_t rx[256];
static tmini_t lidar;
static tmini_stm32_usart_t port;

void setUp(void)
{
    for (size_t i = 0; i < sizeof registers / sizeof registers[0]; i++) {
        registers[i] = 0;
    }
    time_ms = 0;
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
    };
    tmini_stm32_usart_begin(&port, &lidar, registers, &time_ms);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
}

void tearDown(void) {}

static void interrupt_with(uint32_t status, uint8_t byte)
{
    registers[STATUS] = status;
    registers[RECEIVED] = byte;
    tmini_stm32_usart_interrupt(&port);
}

static uint32_t bytes_stored(void)
{
    tmini_counters_t counters;
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    return counters.parser.bytes_skipped + counters.parser.bytes_in_packets +
           counters.bytes_pending;
}

void test_the_divider_is_rounded_to_nearest(void)
{
    tmini_stm32_usart_open(&port, 84000000); /* 84 MHz / 230400 = 364.6 */
    TEST_ASSERT_EQUAL_UINT32(365, registers[BRR]);
    tmini_stm32_usart_open(&port, 16000000); /* 69.4 */
    TEST_ASSERT_EQUAL_UINT32(69, registers[BRR]);
}

void test_an_open_usart_sends_receives_and_interrupts(void)
{
    tmini_stm32_usart_open(&port, 84000000);
    TEST_ASSERT_EQUAL_HEX32(CR1_EXPECTED, registers[CR1]);
}

void test_a_received_packet_reaches_the_lidar(void)
{
    /* As a real unit has sent it (section 9.14). */
    static const uint8_t packet[] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                     0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};
    for (size_t i = 0; i < sizeof packet; i++) {
        interrupt_with(RECEIVE_NOT_EMPTY, packet[i]);
    }
    tmini_counters_t counters;
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.parser.packets);
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
