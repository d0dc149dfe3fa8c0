/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fuzz target: a program, the driver and a turning lidar (bed.h). The input is a list of actions:
 * time passes, with polls or without; bytes of some packets are lost; the line or the lidar has a
 * fault; packets come in the middle of a poll; commands at any moment. Nothing may be wrong that
 * watch.h lists, above all no scan may lie. */

#include "bed.h"
#include "interrupting_atomic.h"
#include "tmini_driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PACKET_US 10000u
#define INPUT_MAX 300u /* Longer ones would only take longer. */

static const uint8_t *data;
static size_t left;

static bed_t bed;
static watch_t watch;

/* Of this many packets the bytes from `from` on and before `to` are lost. */
static struct {
    unsigned packets;
    uint8_t from, to;
} hole;

static unsigned surprises; /* A packet comes at each of this many accesses of a poll. */
static bool has_stalled;   /* The line has held bytes back. */
static bool has_lost_all;  /* It has lost whole packets. */

static uint8_t take(void)
{
    if (left == 0) {
        return 0;
    }
    left--;
    return *data++;
}

static bool lose(void *context, const sim_run_t *run, size_t i)
{
    const size_t place = run->offset + i;
    (void)context;
    hole.packets -= run->packet != NULL && place == 0 && hole.packets > 0 ? 1u : 0u;
    return run->packet != NULL && hole.packets > 0 && place >= hole.from && place < hole.to;
}

void interrupt(void)
{
    static bool is_interrupted;
    if (bed.is_polling && !is_interrupted && surprises > 0) {
        surprises--;
        is_interrupted = true;
        bed_pass_us(&bed, PACKET_US);
        is_interrupted = false;
    }
}

static void command(void)
{
    static tmini_status_t (*const commands[])(tmini_t *) = {
        tmini_start,  tmini_stop, tmini_request_info, tmini_request_health, tmini_request_frequency,
        tmini_reboot,
    };
    const unsigned which = take() % 8u;
    if (which == 7) {
        tmini_withdraw(&bed.lidar, (tmini_event_t)(TMINI_EVENT_INFO + take() % 3));
    } else if (which == 6) {
        (void)tmini_set_frequency(&bed.lidar, (uint16_t)(600 + 10 * (take() % 61)));
    } else {
        (void)commands[which](&bed.lidar);
    }
}

/* The program does not poll. The time to recover counts from the next poll. */
static void pause_ms(bed_t *same, uint32_t ms)
{
    bed_pause_ms(same, ms);
    watch.trouble_us = watch.trouble_us > same->now_us ? watch.trouble_us : same->now_us;
}

/* The next `packets` are lost, with polls meanwhile or not. */
static void be_silent(unsigned packets, bool polled)
{
    has_lost_all = true;
    hole.packets = 1 + packets;
    hole.from = 0;
    hole.to = UINT8_MAX;
    (polled ? bed_run_ms : pause_ms)(&bed, packets * PACKET_US / 1000u);
}

static void act(void)
{
    const uint8_t action = take();
    const unsigned detail = action / 8u;
    switch (action % 8) {
    case 0:
        bed_run_ms(&bed, 1 + 10 * detail);
        break;
    case 1:
        pause_ms(&bed, 10 * detail);
        break;
    case 2:
        be_silent(take() % 64u, detail % 2 == 1);
        break;
    case 3:
        hole.packets = 2 + detail;
        hole.from = take();
        hole.to = take();
        has_lost_all |= hole.from == 0;
        break;
    case 4:
        command();
        break;
    case 5:
        has_stalled |= detail % SIM_LINK_KINDS == SIM_LINK_STALL;
        sim_link_force(&watch.link, (sim_link_kind_t)(detail % SIM_LINK_KINDS), take(), bed.now_us);
        break;
    case 6:
        surprises = 1 + detail % 4;
        break;
    default: /* What follows a lidar without start packets, or without scans: explore.c. */
        sim_befall(&bed.sim, (sim_trouble_t)(SIM_POWER_CUT + detail % 4), take() * 10u, bed.now_us);
        break;
    }
}

/* Bytes that come late hide how long the lidar was silent: if more than a turn is lost meanwhile,
 * the angles tell only that something is, and the scan is not complete. */
static void see_scan(bed_t *same, sim_reading_t *reading)
{
    if (has_stalled && !tmini_scan(&same->lidar)->complete) {
        reading->lies &= ~SIM_LIE(SIM_LIE_MIXED);
    }
}

static void begin(uint8_t setup)
{
    sim_config_t lidar = bed_quiet_lidar();
    lidar.marked = true;
    lidar.ct_information = (setup & 1) != 0;
    lidar.spin_up_percent = 100;
    memset(&watch, 0, sizeof watch);
    watch.line = sim_link_default_config();
    watch.may_lose = true;
    watch.loses = lose;
    watch.on_scan = see_scan;
    bed_prepare(&bed);
    bed.watch = &watch;
    bed.poll_ms = 5 + setup / 16u;
    bed.config.rx_dma = (setup & 2) != 0;
    bed.config.rx_size = (setup & 4) != 0 ? 512 : 4096;
    bed.config.recovery = (setup & 8) != 0 ? TMINI_RECOVERY_OFF : TMINI_RECOVERY_ON;
    hole.packets = 0;
    bed.writes_short = setup % 32 >= 24;
    surprises = 0;
    has_stalled = false;
    has_lost_all = false;
    if (!bed_init(&bed, &lidar)) {
        abort();
    }
}

/* A lidar that has not heard the stop, and of which nothing comes, looks idle to everybody. */
static bool is_excused(void)
{
    return watch.wrong == watch_name(WRONG_COMMAND) && (has_stalled || has_lost_all);
}

int LLVMFuzzerTestOneInput(const uint8_t *input, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *input, size_t size)
{
    data = input;
    left = size < INPUT_MAX ? size : INPUT_MAX;
    begin(take());
    (void)bed_start(&bed);
    bed_run_ms(&bed, 500);
    while (left > 0 && watch.wrong == NULL) {
        act();
    }
    if (watch.wrong != NULL && !is_excused()) {
        (void)fprintf(stderr, "%s\n", watch.wrong);
        abort();
    }
    return 0;
}
