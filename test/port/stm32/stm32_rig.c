/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "stm32_rig.h"

#include "unity.h"

#define LAP_US 80000u /* Of a scanning lidar, in 1024 bytes. */

rig_way_t rig_way;

static uint32_t bytes_before;
static uint32_t overruns_before;

/* -------------------------------------------------------------------------- as every_port wants */

static void use(rig_way_t way)
{
    rig_way = way;
    port_program.rx_dma = way == BY_DMA;
    init_lidar(1024);
}

static void by_dma(void)
{
    use(BY_DMA);
}

static void by_blocks(void)
{
    use(BY_BLOCKS);
}

void port_begin(const sim_observer_t *observer)
{
    rig_way = BY_BYTES;
    port_program.rx_dma = false;
    bytes_before = overruns_before = 0;
    rig_open();
    machine_new_lidar(observer);
}

int port_init(void)
{
    return 0; /* rig_open() has done it. */
}

static uint32_t bytes_accounted_for(void)
{
    tmini_counters_t c;
    tmini_counters(&lidar, &c);
    return c.bytes_in_packets + c.bytes_skipped + c.bytes_overrun + c.bytes_pending;
}

static uint32_t overruns_and_laps(void)
{
    const rig_counts_t errors = rig_counts();
    return errors.overruns + errors.laps;
}

/* The first interrupt may count an overrun from before. */
int port_start(void)
{
    const tmini_status_t status = rig_start();
    machine_step(0);
    bytes_before = bytes_accounted_for();
    overruns_before = overruns_and_laps();
    return status;
}

void port_assert_stopped(void)
{
    TEST_ASSERT_TRUE(rig_is_off());
}

port_counts_t port_counted(void)
{
    const rig_counts_t errors = rig_counts();
    return (port_counts_t){.bytes = bytes_accounted_for() - bytes_before,
                           .overruns = overruns_and_laps() - overruns_before,
                           .framing_errors = errors.framing_errors,
                           .breaks = errors.noise_errors};
}

static void hold(uint32_t us)
{
    model.held_until_ns = machine.now_ns + us * UINT64_C(1000);
}

static void hold_up(uint32_t us)
{
    hold(us);
    machine_pass(us);
}

/* One lap and a half, in which 20 ms would pass with a smaller buffer. */
static void hold_up_for_a_lap(uint32_t us)
{
    hold_up(us / 20000 * LAP_US * 3 / 2);
}

#define WAY .always_wired = true, .old = 16, .behind = 64, .break_reception = rig_break_reception

const port_way_t port_ways[] = {
    {.name = "by bytes",
     .without_fifo = true,
     .packets_per_loss = 4,
     .hold_up = hold_up,
     .loss = MODEL_ORE,
     .framing_error = MODEL_FE,
     .line_break = MODEL_NE,
     WAY},
    {.name = "by DMA",
     .choose = by_dma,
     .holds = 500,
     .packets_per_loss = 16,
     .hold_up = hold_up_for_a_lap,
     WAY},
    {.name = "by blocks", .choose = by_blocks, .packets_per_loss = 6, .hold_up = hold_up, WAY},
};

/* ------------------------------------------------------------------------------ words of scenes */

ACT(damage_framing, play_damage(MODEL_FE))
ACT(damage_by_noise, play_damage(MODEL_NE))
ACT(set_overrun, model.flags |= MODEL_ORE)
ACT(let_overruns_hold_bytes_back, model.ore_holds_rxne = true)
ACT(let_errors_hold_dma_back, model_usart.CR3 |= MODEL_CR3_DDRE)

static void hold_and_pass(uint32_t us)
{
    hold_up(us);
    machine_pass(10);
}

static void disable_interrupts(void)
{
    irq.lines[MODEL_USART_IRQ].disabled = true;
    irq.lines[MODEL_DMA_IRQ].disabled = true;
}

ACT_ON(set_priority, irq.lines[MODEL_USART_IRQ].priority = number)
ACT_ON(set_access, machine.access_ns = number)
NUMBER(overrun_stands, (model.flags & MODEL_ORE) != 0)
NUMBER(is_off, rig_is_off())
NUMBER(overruns, rig_counts().overruns)
NUMBER(framing_errors, rig_counts().framing_errors)
NUMBER(noise_errors, rig_counts().noise_errors)
NUMBER(laps, rig_counts().laps)
NUMBER(restarts, rig_counts().restarts)
NUMBER(other_errors, rig_counts().other_errors)

const play_word_t rig_words[] = {
    {.name = "FE", .act = damage_framing},
    {.name = "NE", .act = damage_by_noise},
    {.name = "ORE-stands", .act = set_overrun, .count = overrun_stands},
    {.name = "ORE-holds", .act = let_overruns_hold_bytes_back},
    {.name = "DDRE", .act = let_errors_hold_dma_back},
    {.name = "hold", .act_on = hold},
    {.name = "held", .act_on = hold_and_pass},
    {.name = "deaf", .act = disable_interrupts},
    {.name = "priority", .act_on = set_priority},
    {.name = "access", .act_on = set_access},
    {.name = "off", .count = is_off},
    {.name = "ORE", .count = overruns},
    {.name = "FEs", .count = framing_errors},
    {.name = "NEs", .count = noise_errors},
    {.name = "laps", .count = laps},
    {.name = "restarts", .count = restarts},
    {.name = "others", .count = other_errors},
    {.name = NULL},
};
