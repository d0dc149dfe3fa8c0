/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the STM32 ports with the simulated lidar: seconds of scanning in each way to receive. */

#include "every_port.h"
#include "stm32_rig.h"
#include "unity.h"

#define LAP_US 80000u /* Of a scanning lidar, in 1024 bytes. */

static const sim_observer_t *truth;
static rig_way_t way;
static uint32_t bytes_before;
static uint32_t overruns_before;

static void wait(void)
{
    machine_pass(1000);
}

scanning_t port_program = {.wait = wait, .work = machine_pass};

void port_begin(const sim_observer_t *observer)
{
    static sim_observer_t kept;
    kept = *observer;
    truth = &kept;
    port_program.port = rig_port;
    port_program.context = rig_context;
    rig_open(way != 0 ? way : BY_BYTES);
    sim_observe(&machine.lidar, truth);
}

static void use(rig_way_t wanted)
{
    way = wanted;
    port_program.rx_dma = way == BY_DMA;
    bytes_before = overruns_before = 0;
    rig_open(way);
    sim_observe(&machine.lidar, truth);
    init_lidar(1024);
}

static uint32_t bytes_accounted_for(void)
{
    tmini_counters_t c;
    tmini_counters(&lidar, &c);
    return c.bytes_in_packets + c.bytes_skipped + c.bytes_overrun + c.bytes_pending;
}

int port_init(void)
{
    return 0; /* rig_open() has done it. */
}

static uint32_t overruns(void)
{
    const rig_errors_t errors = rig_errors();
    return errors.overruns + errors.laps;
}

/* The first interrupt may count an overrun from before. */
int port_start(void)
{
    const tmini_status_t status = rig_start();
    machine_step(0);
    bytes_before = bytes_accounted_for();
    overruns_before = overruns();
    return status;
}

void port_stop(void)
{
    rig_stop();
}

void port_assert_stopped(void)
{
    TEST_ASSERT_TRUE(rig_is_off());
}

port_counts_t port_counted(void)
{
    const rig_errors_t errors = rig_errors();
    return (port_counts_t){.bytes = bytes_accounted_for() - bytes_before,
                           .overruns = overruns() - overruns_before,
                           .framing_errors = errors.framing_errors,
                           .breaks = errors.noise_errors};
}

static void by_dma(void)
{
    use(BY_DMA);
}

static void by_blocks(void)
{
    use(BY_BLOCKS);
}

static void by_bytes(void)
{
    use(BY_BYTES);
}

static void hold_up(uint32_t us)
{
    model.held_until_ns = machine.now_ns + us * UINT64_C(1000);
    machine_pass(us);
}

/* One lap and a half, in which 20 ms would pass with a smaller buffer. */
static void hold_up_for_a_lap(uint32_t us)
{
    hold_up(us / 20000 * LAP_US * 3 / 2);
}

#define ERRORS .framing_error = MODEL_FE, .line_break = MODEL_NE
#define WAY .always_wired = true, .old = 16, .behind = 64, .break_reception = rig_break_reception

const port_way_t port_ways[] = {
    {.name = "by bytes",
     .choose = by_bytes,
     .without_fifo = true,
     .packets_per_loss = 4,
     .hold_up = hold_up,
     .loss = MODEL_ORE,
     ERRORS,
     WAY},
    {.name = "by DMA",
     .choose = by_dma,
     .holds = 500,
     .packets_per_loss = 16,
     .hold_up = hold_up_for_a_lap,
     WAY},
    {.name = "by blocks", .choose = by_blocks, .packets_per_loss = 6, .hold_up = hold_up, WAY},
};
const unsigned port_way_count = RIG_WAYS == ANY_WAY ? 3 : (RIG_WAYS & BY_DMA) != 0 ? 2 : 1;
