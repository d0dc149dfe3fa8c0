/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Pico port on a model of the chip with the simulated lidar. */

#include <string.h>

#include "unity.h"

#include "hardware/gpio.h"
#include "every_port.h"
#include "irq_lines.h"
#include "pico_model.h"
#include "tmini_pico.h"

#define UART1_IRQ 21u
#define LAP 1024u
#define BYTE_US 44u      /* A byte on the wire takes 43.4 µs. */
#define TURN 0x08000000u /* Bytes that one DMA channel transfers before the other takes over. */
TMINI_PICO_RING(ring, LAP);
TMINI_PICO_RING(large_ring, 8192);
static tmini_pico_t port;
static tmini_pico_wiring_t wiring;

static uint32_t pause_ms;

/* Waits `pause_ms`, then receives. */
static void wait(void)
{
    machine_pass(pause_ms * 1000u);
    (void)tmini_pico_wait(&port, 0);
}

PORT_UNDER_TEST(pico, &wiring);

void port_begin(const sim_observer_t *observer)
{
    pico_model_begin(observer);
    memset(&port, 0, sizeof port);
    wiring = (tmini_pico_wiring_t){
        .uart = uart1, .tx_pin = 4, .rx_pin = 5, .ring = ring, .ring_size = sizeof ring};
    pause_ms = 1;
}

void port_assert_stopped(void)
{
    TEST_ASSERT_EQUAL_UINT(0, pico_model_claimed_channels());
    TEST_ASSERT_NULL(chip.handlers[UART1_IRQ]);
    TEST_ASSERT_FALSE(chip.uart.receive_irq);
}

static void enlarge(void)
{
    wiring.ring = large_ring;
    wiring.ring_size = sizeof large_ring;
}

static void receive_by_interrupt(void)
{
    wiring.ring = NULL;
    wiring.ring_size = 0;
}

static void block_dma(uint32_t us)
{
    chip.dma_blocked = true;
    machine_pass(us);
    chip.dma_blocked = false;
}

static void switch_interrupts_off(void)
{
    uart_set_irqs_enabled(uart1, false, false);
}

#define ERRORS                                                         \
    .loss = UART_UARTDR_OE_BITS, .framing_error = UART_UARTDR_FE_BITS, \
    .line_break = UART_UARTDR_FE_BITS | UART_UARTDR_BE_BITS

enum { BY_DMA, BY_INTERRUPT };

const port_way_t port_ways[] = {
    {.name = "by DMA",
     .enlarge = enlarge,
     .holds = sizeof large_ring,
     .behind = 64,
     .packets_per_loss = 4,
     .hold_up = block_dma,
     .break_reception = pico_model_break_dma,
     ERRORS},
    {.name = "by interrupt",
     .choose = receive_by_interrupt,
     .behind = 31,
     .packets_per_loss = 4,
     .hold_up = machine_pass_held_up,
     .break_reception = switch_interrupts_off,
     ERRORS},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];

port_counts_t port_counted(void)
{
    tmini_pico_counters_t c;
    tmini_pico_counters(&port, &c);
    return (port_counts_t){c.bytes, c.bytes_lost, c.overruns, c.framing_errors, c.breaks};
}

/* ------------------------------------------------------------------------------------- wiring */

void test_the_uart_is_set_up_for_the_lidar_and_an_unplugged_line_is_idle(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
    TEST_ASSERT_EQUAL_UINT(230400, chip.baud_rate);
    TEST_ASSERT_EQUAL_INT(GPIO_FUNC_UART, chip.functions[4]);
    TEST_ASSERT_EQUAL_INT(GPIO_FUNC_UART, chip.functions[5]);
    TEST_ASSERT_TRUE(chip.pulled_up[5]);
}

static void handle_for_somebody_else(void) {}

static void assert_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(-1, chip.functions[wiring.rx_pin % PICO_PINS]);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_start(&port, &lidar));
    setUp();
}

void test_missing_parts_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_init(NULL, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_init(&port, NULL));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_start(NULL, &lidar));
    wiring.uart = NULL;
    assert_refused();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_start(&port, NULL));
}

/* The UART whose TX a pin can be, by the data sheets: RP2040 section 2.19.2, RP2350 section 9.4. RX
 * is the next pin. */
static const char tx_pins[] =
#if PICO_RP2350
    "0.0.1.1.1.1.0.0.0.0.1.1.1.1.0.0.0.0.1.1.1.1.0.0.";
#else
    "0...1...1...0...0...1...1...0.";
#endif

static bool is_accepted(unsigned uart, uint tx_pin, uint rx_pin)
{
    wiring.uart = pico_uarts[uart];
    wiring.tx_pin = tx_pin;
    wiring.rx_pin = rx_pin;
    return tmini_pico_init(&port, &wiring) == TMINI_OK;
}

void test_only_pins_that_the_uart_has_are_accepted(void)
{
    for (uint pin = 0; pin < 64; pin++) {
        for (unsigned uart = 0; uart < 2; uart++) {
            const bool has_tx = pin < sizeof tx_pins - 1 && tx_pins[pin] == (char)('0' + uart);
            TEST_ASSERT_EQUAL(has_tx, is_accepted(uart, pin, uart * 4 + 1));
            TEST_ASSERT_EQUAL(has_tx, is_accepted(uart, uart * 4, pin + 1));
            TEST_ASSERT_FALSE(is_accepted(uart, uart * 4, pin & ~1u)); /* TX is no RX. */
        }
    }
}

/* On pins with CTS and RTS, RP2350 also has TX and RX. */
void test_a_pin_gets_the_function_that_its_chip_has_there(void)
{
    const bool has_more = tx_pins[6] == '1';
    TEST_ASSERT_EQUAL(has_more, is_accepted(1, 6, 7));
    TEST_ASSERT_EQUAL_INT(has_more ? GPIO_FUNC_UART_AUX : -1, chip.functions[6]);
    TEST_ASSERT_EQUAL_INT(has_more ? GPIO_FUNC_UART_AUX : -1, chip.functions[7]);
}

void test_a_ring_that_the_hardware_cannot_wrap_is_refused(void)
{
    static uint8_t large[65536] __attribute__((aligned(65536)));
    wiring.ring_size = 1000;
    assert_refused();
    wiring.ring_size = 128;
    assert_refused();
    wiring.ring = ring + 256; /* Not aligned to 512 bytes. */
    wiring.ring_size = 512;
    assert_refused();
    wiring.ring = large;
    wiring.ring_size = 65536;
    assert_refused();
    wiring.ring = large;
    wiring.ring_size = 32768;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
    wiring.ring_size = 256;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
}

void test_a_clock_that_does_not_make_the_baud_rate_is_reported(void)
{
    chip.baud_error_permille = 21;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_pico_init(&port, &wiring));
    chip.baud_error_permille = -21;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_pico_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_pico_start(&port, &lidar));
    chip.baud_error_permille = 19;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
}

/* ------------------------------------------------------------------------------ start and stop */

/* Others have one channel more each time. The port needs two of the twelve. */
void test_by_dma_a_start_takes_two_channels_or_nothing(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
    for (unsigned taken = 1; taken <= 12; taken++) {
        pico_model_take_channels(1);
        TEST_ASSERT_EQUAL_INT(taken <= 10 ? TMINI_OK : TMINI_ERROR_STATE, port_start());
        tmini_pico_stop(&port);
        TEST_ASSERT_EQUAL_UINT(taken, pico_model_claimed_channels());
        TEST_ASSERT_TRUE(chip.channels[taken - 1].claimed);
    }
    pico_model_begin(NULL); /* All channels are free. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, port_start());
}

void test_by_interrupt_a_start_takes_the_interrupt_or_leaves_it_to_others(void)
{
    receive_by_interrupt();
    start_port();
    TEST_ASSERT_TRUE(chip.irq_enabled[UART1_IRQ]);
    tmini_pico_stop(&port);
    TEST_ASSERT_FALSE(chip.irq_enabled[UART1_IRQ]);
    chip.handlers[UART1_IRQ] = handle_for_somebody_else;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, port_start());
    tmini_pico_stop(&port); /* This must not remove the handler of others. */
    TEST_ASSERT_TRUE(chip.handlers[UART1_IRQ] != NULL);
    pico_model_begin(NULL);
}

/* ------------------------------------------------------------------------------------- sending */

void test_a_busy_transmitter_takes_what_it_can(void)
{
    static const uint8_t bytes[2] = {0xA5, 0x60};
    TEST_ASSERT_EQUAL_INT(-1, tmini_pico_port.write(&port, bytes, 2));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_pico_init(&port, &wiring));
    chip.uart.places_to_send = 1;
    TEST_ASSERT_EQUAL_INT(1, tmini_pico_port.write(&port, bytes, 2));
    TEST_ASSERT_EQUAL_INT(0, tmini_pico_port.write(&port, bytes + 1, 1));
    chip.uart.places_to_send = 32;
    TEST_ASSERT_EQUAL_INT(2, tmini_pico_port.write(&port, bytes, 2));
}

/* --------------------------------------------------------------- losses that bytes do not show */

/* Two laps of other bytes come between the packet's two parts, and the ring no longer has them. */
void test_no_packet_is_put_together_across_lost_laps(void)
{
    static const uint8_t nothing[2 * LAP] = {0};
    const size_t rest = sizeof manual_packet - PACKET_CUT;
    start_port();
    machine_receive(0, manual_packet, PACKET_CUT);
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    machine_receive(0, nothing, 2 * LAP);
    machine_receive(0, &manual_packet[PACKET_CUT], rest);
    machine_receive(0, nothing, LAP / 2 - rest);
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    TEST_ASSERT_EQUAL_UINT32(2 * LAP, port_counted().lost);
}

/* -------------------------------------------------------------------------------------- by DMA */

/* The port sets the level to half a FIFO; with the lowest level there would be more. */
void test_the_uart_interrupts_at_half_a_fifo_and_with_dma_never(void)
{
    start();
    assert_true_scans(1, 2);
    TEST_ASSERT_EQUAL_UINT(0, irq.lines[0].served);
    begin_way(BY_INTERRUPT);
    start();
    assert_true_scans(1, 2);
    TEST_ASSERT_LESS_THAN_UINT32(machine.line_bytes / 10, irq.lines[0].served);
}

static void read_all(void)
{
    do {
        (void)tmini_pico_wait(&port, 0);
    } while (tmini_poll(&lidar) != TMINI_EVENT_NONE);
}

/* Reads all bytes; then lets this many arrive before the next poll. */
static void stall_bytes(uint32_t bytes)
{
    const uint32_t line_bytes = machine.line_bytes;
    read_all();
    while (machine.line_bytes - line_bytes < bytes) {
        machine_pass(BYTE_US / 2);
    }
}

/* After whole laps, DMA is at the same place as before: only the count shows the loss. A stall that
 * the ring can just hold loses nothing. */
void test_stalls_are_noticed_to_the_byte(void)
{
    static const uint32_t stalls[] = {LAP - 16, LAP,         LAP + 1, 2 * LAP - 1,       2 * LAP,
                                      3 * LAP,  3 * LAP / 2, 8 * LAP, 11 * LAP + LAP / 2};
    for (unsigned i = 0; i < sizeof stalls / sizeof stalls[0]; i++) {
        const uint32_t lost = stalls[i] < LAP ? 0 : stalls[i] - LAP / 2;
        begin_way(BY_DMA);
        start();
        assert_true_scans(1, 2);
        stall_bytes(stalls[i]);
        (void)tmini_pico_wait(&port, 0);
        TEST_ASSERT_EQUAL_UINT32(lost, port_counted().lost);
        TEST_ASSERT_EQUAL(lost > 0, scans_until_complete() > 1);
        TEST_ASSERT_EQUAL_UINT32(machine.line_bytes, port_counted().bytes + port_counted().lost);
        TEST_ASSERT_EQUAL_UINT32(lost, port_counted().lost);
    }
}

/* Delays a poll after each of its readings of DMA's position in turn, with bytes in the ring. */
void test_a_poll_that_is_delayed_at_any_reading_delivers_nothing_wrong(void)
{
    static const uint32_t stalls[] = {LAP / 2, LAP - 300, LAP, LAP + 300, 2 * LAP, 5 * LAP};
    for (unsigned i = 0; i < sizeof stalls / sizeof stalls[0]; i++) {
        for (unsigned reads = 1; reads <= 10; reads++) {
            begin_way(BY_DMA);
            start();
            assert_true_scans(1, 2);
            stall_bytes(300);
            chip.pass_after = reads;
            chip.pass_us = stalls[i] * 76u; /* 76 µs per byte of a scan. */
            (void)scans_until_complete();
        }
    }
}

/* Advances DMA, as in nearly three hours of scanning, to `bytes_left` before one channel takes over
 * from the other; then scans until one is complete. Returns how many bytes are lost by now. */
static uint32_t approach_end_of_turn(uint32_t bytes_left)
{
    read_all();
    pico_model_move_on(TURN - (port_counted().bytes + port_counted().lost) % TURN - bytes_left);
    TEST_ASSERT_TRUE(scans_until_complete() >= 2);
    return port_counted().lost;
}

/* The channels change eight laps (620 ms) later, when scans are complete again. */
void test_one_channel_takes_over_from_the_other_without_losing_a_byte(void)
{
    tmini_counters_t counters;
    start();
    assert_true_scans(1, 1);
    for (unsigned turn = 0; turn < 4; turn++) {
        const uint32_t lost = approach_end_of_turn(8 * LAP);
        TEST_ASSERT_EQUAL_UINT(turn, chip.changes_of_channel);
        for (unsigned i = 0; i < 5; i++) {
            pause_ms = 5;
            poll_until(TMINI_EVENT_SCAN);
            truth_assert_some_revolution(tmini_scan(&lidar));
        }
        TEST_ASSERT_EQUAL_UINT(turn + 1, chip.changes_of_channel);
        TEST_ASSERT_EQUAL_UINT32(lost, port_counted().lost);
    }
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.losses); /* No restart has helped. */
}

/* ------------------------------------------------------------------------------------- waiting */

static void assert_wait(size_t bytes)
{
    const uint64_t begun_us = machine.now_us;
    TEST_ASSERT_EQUAL_UINT(bytes, tmini_pico_wait(&port, 300));
    TEST_ASSERT_EQUAL_UINT64(bytes > 0 ? 0 : 300000, machine.now_us - begun_us);
}

/* Also after another start, when fewer bytes have come than before. */
void test_waiting_ends_with_the_first_bytes_or_at_its_timeout(void)
{
    static const uint8_t bytes[256] = {0};
    while (next_way()) {
        TEST_ASSERT_EQUAL_INT(0, port_init());
        for (unsigned starts = 0; starts < 2; starts++) {
            TEST_ASSERT_EQUAL_INT(0, port_start());
            assert_wait(0);
            machine_receive(0, bytes, sizeof bytes);
            assert_wait(sizeof bytes);
            assert_wait(0);
            port_stop();
            TEST_ASSERT_EQUAL_UINT(0, tmini_pico_wait(&port, 10));
        }
    }
}
