/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What each STM32 port must do, one situation at a time, in each of its ways to receive. Interrupts
 * stay pending until a handler clears them, and may come at any access. */

#include "stm32_scenes.h"

#include <string.h>

#include "known_packets.h"
#include "unity.h"

#define LAP_US 44445u

tmini_t lidar;
uint8_t rig_rx[RIG_RX_SIZE] __attribute__((aligned(32)));

static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
rig_way_t rig_way;

void set_up_lidar(rig_way_t wanted)
{
    const tmini_config_t config = {
        .port = rig_port,
        .port_context = rig_context,
        .rx_buffer = rig_rx,
        .rx_size = sizeof rig_rx,
        .rx_dma = wanted == BY_DMA,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
    };
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
}

void open_port(rig_way_t wanted)
{
    memset(rig_rx, 0, sizeof rig_rx);
    rig_open(wanted);
    machine_power(false); /* The test sends. */
    set_up_lidar(wanted);
}

void start_port(rig_way_t wanted)
{
    open_port(wanted);
    machine_pass(10000);
    TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
}

bool next_way(unsigned ways)
{
    static const char *const names[] = {"by DMA", "by blocks", "", "by bytes"};
    do {
        rig_way = rig_way == 0 ? BY_DMA : (rig_way_t)(rig_way << 1);
    } while (rig_way <= BY_BYTES && (rig_way & ways & RIG_WAYS) == 0);
    if (rig_way > BY_BYTES) {
        rig_way = 0;
        return false;
    }
    UNITY_SET_DETAIL(names[rig_way - 1]);
    start_port(rig_way);
    return true;
}

void send_packet_with(uint32_t errors)
{
    machine_send(errors, start_packet, PACKET_SIZE);
}

void send_packets(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        send_packet_with(0);
    }
}

void send_broken_byte(uint32_t errors)
{
    static const uint8_t broken = 0x00;
    machine_send(errors, &broken, 1);
}

tmini_counters_t poll_all(void)
{
    tmini_counters_t counters;
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
    return counters;
}

uint32_t packets(void)
{
    return poll_all().packets;
}

void pass_ms(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        machine_pass(1000);
        (void)poll_all();
    }
}

void run(void)
{
    while (!machine_has_sent()) {
        pass_ms(1);
    }
    pass_ms(1);
}

void receive(unsigned count)
{
    send_packets(count);
    run();
}

uint32_t bytes_accounted_for(void)
{
    const tmini_counters_t counters = poll_all();
    return counters.bytes_in_packets + counters.bytes_skipped + counters.bytes_overrun +
           counters.bytes_pending;
}

static void hold_up(uint32_t us)
{
    model.held_until_ns = machine.now_ns + us * UINT64_C(1000);
}

/* --------------------------------------------------------------------------------- byte by byte */

void test_each_byte_is_an_interrupt_and_reaches_the_lidar(void)
{
    while (next_way(BY_BYTES)) {
        receive(200);
        TEST_ASSERT_EQUAL_UINT32(200, packets());
        TEST_ASSERT_EQUAL_UINT32(200 * PACKET_SIZE, irq.lines[MODEL_USART_IRQ].served);
    }
}

void test_line_errors_are_counted_and_cost_no_byte(void)
{
    while (next_way(BY_BYTES)) {
        send_packet_with(MODEL_FE);
        send_packet_with(MODEL_NE);
        run();
        TEST_ASSERT_EQUAL_UINT32(2, packets());
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().framing_errors);
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().noise_errors);
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().overruns);
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().restarts);
    }
}

/* Until the second packet. */
void test_a_late_interrupt_is_an_overrun_that_is_counted_and_survived(void)
{
    while (next_way(BY_BYTES)) {
        send_packets(3);
        hold_up(16 * MACHINE_BYTE_NS / 1000);
        run();
        receive(1);
        TEST_ASSERT_EQUAL_UINT32(2, packets());
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
    }
}

/* Bytes 7 to 19 of two packets are lost. The other 13 bytes look like one packet. */
void test_no_packet_continues_across_an_overrun(void)
{
    while (next_way(BY_BYTES)) {
        send_packets(2);
        machine_pass(MACHINE_BYTE_NS * 13 / 2000);
        hold_up(14 * MACHINE_BYTE_NS / 1000);
        run();
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
        TEST_ASSERT_EQUAL_UINT32(0, packets());
    }
}

/* Only the overrun flag is set: the byte before it has already been read. The next one may belong
 * to another packet. */
void test_an_overrun_without_a_byte_is_a_gap_and_stops_reception_only_until_the_next_poll(void)
{
    while (next_way(BY_BYTES)) {
        machine_send(0, start_packet, 6);
        run();
        model.flags |= MODEL_ORE;
        pass_ms(1);
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
        TEST_ASSERT_LESS_THAN_UINT32(20, irq.lines[MODEL_USART_IRQ].served);
        machine_send(0, &start_packet[6], 7);
        run();
        TEST_ASSERT_EQUAL_UINT32(0, packets());
        receive(2);
        TEST_ASSERT_EQUAL_UINT32(2, packets());
    }
}

/* ------------------------------------------------------------------------------------------ DMA */

void test_dma_delivers_every_byte_with_few_interrupts(void)
{
    while (next_way(IN_CIRCLE)) {
        receive(200);
        TEST_ASSERT_EQUAL_UINT32(200, packets());
        TEST_ASSERT_EQUAL_UINT32(200 * PACKET_SIZE, bytes_accounted_for());
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
        TEST_ASSERT_LESS_THAN_UINT32(50, irq.lines[MODEL_USART_IRQ].served);
    }
}

/* Also at the buffer's end, where HALs of different years report different events and sizes. */
void test_idle_events_at_any_position_lose_and_repeat_nothing(void)
{
    while (next_way(IN_CIRCLE)) {
        for (unsigned i = 0; i < 300; i++) {
            send_packets(1);
            pass_ms(1);
        }
        TEST_ASSERT_EQUAL_UINT32(300, packets());
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
    }
}

void test_priorities_of_the_two_interrupts_may_be_any(void)
{
    for (unsigned usart = 4; usart <= 6; usart++) {
        while (next_way(IN_CIRCLE)) {
            irq.lines[MODEL_USART_IRQ].priority = usart;
            machine.access_ns = 2000; /* On a slow controller, interrupts coincide. */
            receive(200);
            TEST_ASSERT_EQUAL_UINT32(200, packets());
            TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
        }
    }
}

void test_polls_alone_deliver_every_byte_from_dma(void)
{
    while (next_way(IN_CIRCLE)) {
        irq.lines[MODEL_USART_IRQ].disabled = true;
        irq.lines[MODEL_DMA_IRQ].disabled = true;
        receive(200);
        TEST_ASSERT_EQUAL_UINT32(200, packets());
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
    }
}

void test_a_line_error_costs_only_its_byte(void)
{
    while (next_way(IN_CIRCLE)) {
        for (unsigned i = 0; i < 20; i++) {
            send_packets(10);
            send_broken_byte(i % 2 == 0 ? MODEL_FE : MODEL_NE);
        }
        run();
        TEST_ASSERT_EQUAL_UINT32(200, packets());
        TEST_ASSERT_EQUAL_UINT32(20, poll_all().bytes_skipped);
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().restarts);
        TEST_ASSERT_GREATER_THAN_UINT32(4, rig_errors().framing_errors);
        TEST_ASSERT_GREATER_THAN_UINT32(4, rig_errors().noise_errors);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(10, rig_errors().framing_errors);
    }
}

void test_an_overrun_while_dma_runs_is_counted_and_does_not_stop_it(void)
{
    while (next_way(IN_CIRCLE)) {
        send_packets(10);
        machine_pass(2000);
        model.flags |= MODEL_ORE;
        run();
        TEST_ASSERT_EQUAL_UINT32(10, packets());
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().restarts);
    }
}

/* On many boards the overrun flag holds the next byte back. DMA has already read the byte
 * before. */
void test_an_overrun_that_holds_bytes_back_is_cleared_by_the_poll(void)
{
    while (next_way(IN_CIRCLE)) {
        model.ore_holds_rxne = true;
        receive(10);
        model.flags |= MODEL_ORE;
        machine_pass(1000);
        (void)poll_all();
        receive(10);
        TEST_ASSERT_EQUAL_UINT32(20, packets());
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().overruns);
    }
}

/* With DDRE, any error holds DMA requests back until it is cleared. The poll comes up to 1 ms (23
 * bytes) later. */
void test_an_error_that_holds_dma_back_is_cleared_by_the_poll(void)
{
#ifdef STM32_MODEL_SR
    TEST_IGNORE_MESSAGE("not with SR and DR");
#endif
    while (next_way(IN_CIRCLE)) {
        model_usart.CR3 |= MODEL_CR3_DDRE;
        send_packet_with(MODEL_FE);
        receive(19);
        TEST_ASSERT_UINT32_WITHIN(3, 17, packets());
        const uint32_t before = packets();
        receive(10);
        TEST_ASSERT_EQUAL_UINT32(before + 10, packets());
    }
}

/* ----------------------------------------------------------------------------------------- laps */

/* Sends 200 packets, holds interrupts back for `us`, and returns the packets received. */
static uint32_t packets_with_interrupts_held(rig_way_t by, uint32_t us)
{
    start_port(by);
    send_packets(200);
    pass_ms(30);
    hold_up(us);
    machine_pass(us + 10);
    run();
    return packets();
}

static bool has(rig_way_t by)
{
    return (RIG_WAYS & by) != 0;
}

/* Interrupts are held back for one lap to two laps. Then half and whole buffer are reported at
 * once. Of the bytes that a lap has overwritten, only a few seem to be new. */
void test_a_lap_without_any_interrupt_is_counted_once(void)
{
    for (uint32_t us = LAP_US; has(BY_DMA) && us < 2 * LAP_US; us += 1500) {
        const uint32_t received = packets_with_interrupts_held(BY_DMA, us);
        TEST_ASSERT_EQUAL_UINT32(1, rig_errors().laps);
        TEST_ASSERT_EQUAL_UINT32(200 * PACKET_SIZE, bytes_accounted_for());
        TEST_ASSERT_LESS_THAN_UINT32(200, received);
        TEST_ASSERT_GREATER_THAN_UINT32(75, received);
        TEST_ASSERT_GREATER_THAN_UINT32(500, poll_all().bytes_overrun);
    }
}

/* A lap that the half alone has shown must not hide the next one. */
void test_each_of_several_laps_is_counted_once(void)
{
    for (uint32_t us = LAP_US + 1000; has(BY_DMA) && us < 2 * LAP_US; us += 3000) {
        start_port(BY_DMA);
        send_packets(600);
        for (unsigned laps = 1; laps <= 3; laps++) {
            pass_ms(30);
            hold_up(us);
            machine_pass(us + 10);
            (void)poll_all();
            pass_ms(3);
            TEST_ASSERT_EQUAL_UINT32(laps, rig_errors().laps);
        }
        run();
        TEST_ASSERT_EQUAL_UINT32(600 * PACKET_SIZE, bytes_accounted_for());
        TEST_ASSERT_EQUAL_UINT32(3, rig_errors().laps);
    }
}

void test_a_lap_of_a_block_without_any_interrupt_is_noticed(void)
{
    for (uint32_t us = LAP_US / 4; has(BY_BLOCKS) && us < LAP_US; us += 700) {
        (void)packets_with_interrupts_held(BY_BLOCKS, us);
        TEST_ASSERT_GREATER_THAN_UINT32(0, rig_errors().laps);
    }
}

void test_interrupts_late_by_less_than_half_a_lap_lose_nothing(void)
{
    for (uint32_t us = 100; has(BY_DMA) && us < LAP_US / 2 - 2000; us += 1500) {
        TEST_ASSERT_EQUAL_UINT32(200, packets_with_interrupts_held(BY_DMA, us));
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().laps);
    }
}

/* ------------------------------------------------------------------------------- start and stop */

/* As after a reset of the controller alone, while the lidar spins. */
void test_an_overrun_pending_at_the_start_does_no_harm(void)
{
    while (next_way(ANY_WAY)) {
        open_port(rig_way);
        send_packets(100);
        machine_pass(2000);
        TEST_ASSERT_NOT_EQUAL(0, model.flags & MODEL_ORE);
        TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
        run();
        TEST_ASSERT_GREATER_THAN_UINT32(93, packets());
        TEST_ASSERT_EQUAL_UINT32(0, rig_errors().restarts);
    }
}

/* The buffer is full of old packets. When the port stops, no event has come for the last ones. */
void test_after_stop_received_bytes_are_kept_and_after_another_start_none_is_read_again(void)
{
    while (next_way(ANY_WAY)) {
        receive(100);
        send_packets(5);
        machine_pass(3000);
        rig_stop();
        TEST_ASSERT_EQUAL_UINT32(105, packets());
        TEST_ASSERT_TRUE(rig_is_off());
        receive(100);
        TEST_ASSERT_EQUAL_UINT32(105, packets());
        TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
        TEST_ASSERT_EQUAL_UINT32(105, packets());
        receive(5);
        TEST_ASSERT_EQUAL_UINT32(110, packets());
    }
}

void test_a_lidar_that_is_set_up_again_begins_at_the_buffers_start(void)
{
    while (next_way(ANY_WAY)) {
        receive(33);
        rig_stop();
        set_up_lidar(rig_way);
        TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
        receive(100);
        TEST_ASSERT_EQUAL_UINT32(100, packets());
        TEST_ASSERT_EQUAL_UINT32(100 * PACKET_SIZE, bytes_accounted_for());
    }
}

void test_broken_reception_is_set_up_again_when_the_lidar_is_lost_but_not_when_stopped(void)
{
    while (next_way(ANY_WAY)) {
        receive(10);
        rig_break_reception();
        rig_port->restart(rig_context);
        (void)poll_all();
        receive(100);
        TEST_ASSERT_EQUAL_UINT32(110, packets());
        rig_stop();
        rig_port->restart(rig_context);
        TEST_ASSERT_TRUE(rig_is_off());
    }
}
