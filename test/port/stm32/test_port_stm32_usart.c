/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the STM32 port without HAL, with both register layouts, on the model: what the port over
 * the HAL has not (stm32_scenes.c). */

#include "tmini_stm32_usart.h"

#include "known_packets.h"
#include "random.h"
#include "play.h"
#include "unity.h"

static tmini_stm32_usart_t port;
static tmini_stm32_usart_wiring_t wiring;

/* ------------------------------------------------------------------ the port as play.c wants */

static void wait(void)
{
    machine_pass(1000);
}

scanning_t port_program = {.port = &tmini_stm32_usart_port, .context = &port, .wait = wait};
const unsigned port_way_count = 2;

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

void rig_open(void)
{
    model_reset();
    irq.lines[MODEL_USART_IRQ].handler = usart_handler;
    irq.lines[MODEL_DMA_IRQ].handler = dma_handler;
    wiring = (tmini_stm32_usart_wiring_t){.usart = &model_usart,
                                          .clock_hz = 84000000,
                                          .time_ms = &model.tick_ms,
                                          .remaining = &model.dma.channel.CBR1};
    (void)tmini_stm32_usart_init(&port, &wiring);
}

tmini_status_t rig_start(void)
{
    size_t size = 0;
    uint8_t *const memory = tmini_rx_buffer(&lidar, &size);
    if (memory != NULL) {
        model.dma = (model_dma_t){.enabled = true,
                                  .circular = true,
                                  .memory = memory,
                                  .size = (uint16_t)size,
                                  .channel = {(uint32_t)size},
                                  .interrupts = MODEL_DMA_HT | MODEL_DMA_TC};
    }
    return tmini_stm32_usart_start(&port, &lidar);
}

void port_stop(void)
{
    tmini_stm32_usart_stop(&port);
}

rig_counts_t rig_counts(void)
{
    tmini_stm32_usart_counters_t c;
    tmini_stm32_usart_counters(&port, &c);
    return (rig_counts_t){.bytes = c.bytes,
                          .overruns = c.overruns,
                          .framing_errors = c.framing_errors,
                          .noise_errors = c.noise_errors,
                          .laps = c.laps};
}

bool rig_is_off(void)
{
    const uint32_t on = model_usart.CR1 & (MODEL_CR1_RXNEIE | MODEL_CR1_IDLEIE);
    return on == 0 && (model_usart.CR3 & MODEL_CR3_DMAR) == 0;
}

void rig_break_reception(void)
{
    model_usart = (USART_TypeDef){0};
}

/* ------------------------------------------------------------------------------ words of scenes */

ACT_ON(set_channel, model.dma.enabled = number)

/* LL has left the FIFO threshold's interrupt on, which the port does not need. */
static void enable_fifo(void)
{
    model_usart.CR1 |= MODEL_CR1_FIFOEN;
    model_usart.CR3 |= MODEL_CR3_RXFTIE | MODEL_CR3_RXFTCFG_HALF;
}

NUMBER(idle_interrupts, (model_usart.CR1 & MODEL_CR1_IDLEIE) != 0)
NUMBER(bytes, rig_counts().bytes)

const play_word_t port_words[] = {
    {.name = "interrupt", .act = usart_handler}, {.name = "channel", .act_on = set_channel},
    {.name = "FIFO", .act = enable_fifo},        {.name = "IDLEIE", .count = idle_interrupts},
    {.name = "counted", .count = bytes},         {.name = NULL},
};

/* ----------------------------------------------------------------------------------- life cycle */

static tmini_status_t init_with_clock(uint32_t clock_hz)
{
    wiring.clock_hz = clock_hz;
    return tmini_stm32_usart_init(&port, &wiring);
}

/* Several families start with a 4 MHz oscillator, which gives 235294 baud: 2.1 % too fast. */
void test_the_divider_is_rounded_to_nearest_and_a_clock_without_one_is_refused(void)
{
    static const struct {
        uint32_t clock_hz;
        uint32_t divider; /* 0: refused. */
    } clocks[] = {{84000000, 365}, {16000000, 69}, {8000000, 35}, {3686400, 16}, {170000000, 738},
                  {1000000, 0},    {2097000, 0},   {3000000, 0},  {3600000, 0},  {4000000, 0}};
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        const bool fits = clocks[i].divider > 0;
        play_begin(BY_BYTES);
        TEST_ASSERT_EQUAL(fits ? TMINI_OK : TMINI_ERROR_ARGUMENT,
                          init_with_clock(clocks[i].clock_hz));
        if (fits) {
            TEST_ASSERT_EQUAL(TMINI_OK, rig_start());
            TEST_ASSERT_EQUAL_UINT32(clocks[i].divider, model_usart.BRR);
        }
    }
}

/* When it has stopped, it can still send; pending interrupts change nothing. */
void test_a_started_usart_sends_receives_and_interrupts(void)
{
    for (unsigned way = BY_BYTES; way <= BY_DMA; way++) {
        const bool by_dma = way == BY_DMA; /* RE 2, TE 3, IDLEIE 4, RXNEIE 5 */
        play_start(way);
        TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | (by_dma ? 0x1C : 0x2C), model_usart.CR1);
        TEST_ASSERT_EQUAL_HEX32(by_dma ? MODEL_CR3_DMAR : 0, model_usart.CR3);
        play_receive(3);
        port_stop();
        model.dma.channel.CBR1 = 500;
        tmini_stm32_usart_dma_interrupt(&port, true, true);
        tmini_stm32_usart_interrupt(&port);
        TEST_ASSERT_EQUAL_UINT32(3 * sizeof start_packet, play_accounted());
        TEST_ASSERT_EQUAL_HEX32(0, model_usart.CR3);
        TEST_ASSERT_EQUAL_HEX32(MODEL_CR1_UE | 0x0C, model_usart.CR1);
    }
}

/* LL_USART_Init() has set them, or an LPUART needs another divider. */
void test_without_a_clock_baud_rate_and_format_are_not_changed(void)
{
    play_begin(BY_BYTES);
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
    play_begin(BY_BYTES);
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(NULL, &wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(NULL, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&no_port, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_STATE, tmini_stm32_usart_start(&port, &no_lidar));
    wiring.time_ms = NULL;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, &wiring));
    wiring = (tmini_stm32_usart_wiring_t){.time_ms = &model.tick_ms};
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_init(&port, &wiring));
}

void test_a_dma_channel_that_is_not_at_the_buffers_start_is_refused(void)
{
    play_begin(BY_DMA);
    model.dma.channel.CBR1 = 1023;
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(&port, &lidar));
    wiring.remaining = NULL;
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_stm32_usart_init(&port, &wiring));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_stm32_usart_start(&port, &lidar));
}

/* ------------------------------------------------------------------------------------------ DMA */

static const row_t scenes[] IN_FLASH = {
    ROW(half_a_buffer_and_an_idle_line_are_handed_over_without_a_poll, /* First 516 bytes arrive. */
        "DMA: P:40 ~22400 position:512 ~1000 position:520"),
    ROW(bytes_are_counted, "bytes: P:30 run counted:390"),
    /* On a USART with SR, reading DR clears errors and the idle flag (reference manual RM0090), but
     * also removes a byte that waits for DMA. */
    ROW(a_byte_that_waits_for_dma_is_not_removed,
        "DMA: deaf channel:0 P ~2000 RXNE:1 ORE-stands:1 interrupt interrupt RXNE:1 "
        "ORE:1"),
    /* On a USART with SR, the idle flag cannot be cleared while a byte waits, as it does when the
     * channel has stopped: its interrupt has to be switched off, or it comes endlessly. */
    ROW(a_dma_channel_that_has_stopped_is_no_lock_up,
        "DMA: P:10 run channel:0 P:10 run packets:10 channel:1 +2 IDLEIE:1 mark P:10 run more:10 "
        "IDLEIE:1 channel:0 P:10 run stop start P:10 run packets:30"),
#ifndef STM32_MODEL_SR
    ROW(an_enabled_fifo_keeps_eight_bytes_for_a_late_interrupt,
        "bytes: FIFO 20( P ~100 hold:340 ~2000 ) packets:20 ORE:0"),
#endif
};

void test_scenes_on_the_registers(void)
{
    run_rows(scenes, play_row);
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
    play_start(BY_DMA);
    for (uint32_t place = 0; place < 80; place = irq_next_place(&random, place)) {
        play_send(1);
        machine_pass(500);
        irq_happen_after(place, line_falls_idle);
        poll_all();
    }
    play_receive(0);
    TEST_ASSERT_EQUAL_UINT32(0, model.flags & MODEL_IDLE);
}

/* -------------------------------------------------------------------------------------- sending */

void test_an_empty_transmitter_takes_a_command_and_a_full_one_takes_nothing(void)
{
    static const uint8_t command[] = {0xA5, 0x60};
    play_start(BY_BYTES);
    TEST_ASSERT_EQUAL_INT(2, tmini_stm32_usart_port.write(&port, command, 2));
    TEST_ASSERT_EQUAL_HEX8(0x60, model.sent[1]);
    model.flags &= ~MODEL_TXE;
    TEST_ASSERT_EQUAL_INT(0, tmini_stm32_usart_port.write(&port, command, 2));
}

void test_the_clock_is_the_given_counter(void)
{
    static const uint32_t time_ms = 0xFFFFFFFFu;
    play_begin(BY_BYTES);
    wiring.time_ms = &time_ms;
    TEST_ASSERT_EQUAL(TMINI_OK, init_with_clock(0));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, tmini_stm32_usart_port.now_ms(&port));
}
