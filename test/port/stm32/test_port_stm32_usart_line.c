/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The STM32 port on the registers, on the model: its interrupt lines stay up until a handler clears
 * them, and may come at any access. */

#include "line.h"
#include "stm32_model.h"
#include "tmini_stm32_usart.h"

#include "unity.h"

#define RX_SIZE 1024u

/* As a real unit has sent it (section 9.14). */
static const uint8_t packet[] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                 0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};
#define PACKET sizeof packet

static volatile uint32_t time_ms;
static uint8_t rx[RX_SIZE];
static tmini_t lidar;
static tmini_stm32_usart_t port;

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

static void set_up(bool rx_dma)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = rx_dma,
    };
    model_reset();
    line_open();
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(&port, &model_usart, &time_ms));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    irq.lines[MODEL_USART_IRQ].handler = usart_handler;
    irq.lines[MODEL_DMA_IRQ].handler = dma_handler;
}

static void start_dma(void)
{
    set_up(true);
    model.dma = (model_dma_t){
        .enabled = true,
        .circular = true,
        .memory = rx,
        .size = RX_SIZE,
        .channel = {RX_SIZE},
        .interrupts = MODEL_DMA_HT | MODEL_DMA_TC,
    };
    TEST_ASSERT_EQUAL(
        TMINI_OK, tmini_stm32_usart_start_dma(&port, &lidar, 84000000, &model.dma.channel.CBR1));
}

void setUp(void) {}

void tearDown(void) {}

static uint32_t packets(void)
{
    tmini_counters_t counters;
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
    return counters.packets;
}

static void send_packets(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        line_send(packet, PACKET);
    }
}

static void run(void)
{
    while (!line_is_empty()) {
        model_pass(200);
        (void)packets();
    }
    model_pass(1000);
}

void test_bytes_at_any_access_of_a_poll_reach_the_lidar(void)
{
    set_up(false);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_start(&port, &lidar, 84000000));
    send_packets(300);
    run();
    TEST_ASSERT_EQUAL_UINT32(300, packets());
    TEST_ASSERT_EQUAL_UINT32(300 * PACKET, port.bytes);
}

void test_dma_brings_every_byte(void)
{
    start_dma();
    send_packets(300);
    run();
    TEST_ASSERT_EQUAL_UINT32(300, packets());
    TEST_ASSERT_EQUAL_UINT32(0, port.laps);
}

/* The poll is handing over then, or not: the flag must be cleared in any case. */
static void line_falls_idle(void)
{
    model.flags |= MODEL_IDLE;
}

void test_an_idle_line_at_any_access_of_a_poll_is_no_lock_up(void)
{
    random_t random;
    random_seed(&random, 1);
    start_dma();
    for (uint32_t place = 0; place < 80; place = irq_next_place(&random, place)) {
        send_packets(1);
        model_pass(500);
        irq_happen_after(place, line_falls_idle);
        (void)packets();
    }
    run();
    TEST_ASSERT_EQUAL_UINT32(0, model.flags & MODEL_IDLE);
}

/* The DMA has taken the byte: nothing but the poll will look at the flag. */
void test_an_overrun_that_holds_the_bytes_back_is_cleared_by_the_poll(void)
{
    start_dma();
    model.ore_holds_rxne = true;
    send_packets(10);
    run();
    model.flags |= MODEL_ORE;
    model_pass(1000);
    (void)packets();
    send_packets(10);
    run();
    TEST_ASSERT_EQUAL_UINT32(20, packets());
    TEST_ASSERT_EQUAL_UINT32(1, port.overruns);
}
