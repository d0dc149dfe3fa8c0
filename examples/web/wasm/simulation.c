/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar of test/simulator, and the faulty wire to it. */

#include "web.h"

#include "link.h"

/* The average number of bytes, or milliseconds, between two faults of each kind: small enough to be
 * noticed. */
static const uint32_t mean_gaps[SIM_LINK_KINDS] = {
    [SIM_LINK_DROP] = 2000, [SIM_LINK_FLIP] = 2000, [SIM_LINK_INSERT] = 2000,
    [SIM_LINK_BURST] = 500, [SIM_LINK_STALL] = 500, [SIM_LINK_CUT] = 200,
    [SIM_LINK_UNPLUG] = 0,  [SIM_LINK_GARBLE] = 1,
};

static sim_t sim;
static sim_link_t wire;

static uint64_t us(uint32_t now_ms)
{
    return (uint64_t)now_ms * 1000u;
}

EXPORTED void simulation_init(uint32_t seed, uint32_t ct_information, uint32_t frequency_chz)
{
    sim_config_t device = sim_default_config();
    sim_link_config_t faults = sim_link_default_config();
    device.seed = seed;
    device.ct_information = ct_information != 0;
    device.frequency_chz = (uint16_t)frequency_chz;
    faults.seed = seed;
    /* Short, so that garbling ends soon after it is switched off; until then it begins again at
     * once. */
    faults.shortest[SIM_LINK_GARBLE] = 100;
    faults.longest[SIM_LINK_GARBLE] = 100;
    sim_init(&sim, &device);
    sim_link_init(&wire, &sim, &faults);
}

/* Copies to `transfer` the bytes that have arrived until now. */
EXPORTED uint32_t simulation_read(uint32_t now_ms)
{
    return (uint32_t)sim_link_read(&wire, us(now_ms), web_transfer, WEB_TRANSFER_SIZE);
}

/* Sends the first `count` bytes of `transfer` to the lidar. */
EXPORTED void simulation_write(uint32_t count, uint32_t now_ms)
{
    sim_link_write(&wire, web_transfer, count, us(now_ms));
}

EXPORTED void simulation_block(uint32_t blocked)
{
    sim_block_rotor(&sim, blocked != 0);
}

EXPORTED void simulation_cover(uint32_t covered)
{
    sim_cover_window(&sim, covered != 0);
}

EXPORTED void simulation_health(uint32_t bits)
{
    sim_set_health(&sim, (uint8_t)bits);
}

EXPORTED void simulation_power(uint32_t on, uint32_t now_ms)
{
    sim_power(&sim, on != 0, us(now_ms));
}

EXPORTED void simulation_fault(uint32_t kind, uint32_t on, uint32_t now_ms)
{
    if (kind < SIM_LINK_KINDS) {
        sim_link_set_mean_gap(&wire, (sim_link_kind_t)kind, on != 0 ? mean_gaps[kind] : 0,
                              us(now_ms));
    }
}

/* The name of a kind of fault on the wire; null after the last. */
EXPORTED const char *simulation_fault_name(uint32_t kind)
{
    return kind < SIM_LINK_KINDS ? sim_link_kind_name((sim_link_kind_t)kind) : NULL;
}

EXPORTED void simulation_visitor(uint32_t present)
{
    sim_clear_obstacles(&sim);
    if (present != 0) {
        sim_place_obstacle(&sim, 0, 1600, 700);
    }
}
