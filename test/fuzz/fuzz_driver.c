/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fuzz target: the whole driver as a hostile world would use it. The input is a list of actions:
 * bytes received, by interrupt, block or DMA, time passing, polls, commands at any moment, a port
 * that takes none, one or both bytes, or fails. Nothing may crash, hang or lose count, and nothing
 * but whole two-byte commands may leave. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "invariants.h"
#include "tmini/tmini.h"

#define RX_SIZE 512u
#define POINTS 100u

static struct {
    const uint8_t *data;
    size_t left;
    uint32_t now_ms;
    int write_behaviour;
    size_t position; /* Of the DMA in the ring's memory. */
    uint32_t fed;
    bool half_sent;
    tmini_t lidar;
    uint8_t rx[RX_SIZE];
    tmini_point_t points[POINTS];
} world;

static void demand(int condition)
{
    if (!condition) {
        abort();
    }
}

static uint8_t take(void)
{
    if (world.left == 0) {
        return 0;
    }
    world.left--;
    return *world.data++;
}

static bool is_command(uint8_t code)
{
    static const uint8_t codes[] = {0x60, 0x65, 0x90, 0x92, 0x09, 0x0A, 0x0B, 0x0C, 0x0D, 0x40};
    return memchr(codes, code, sizeof codes) != NULL;
}

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    demand(context == &world && count >= 1 && count <= 2);
    int taken = world.write_behaviour;
    if (taken > (int)count) {
        taken = (int)count;
    }
    for (int i = 0; i < taken; i++) {
        demand(world.half_sent ? is_command(bytes[i]) : bytes[i] == 0xA5);
        world.half_sent = !world.half_sent;
    }
    return taken;
}

static uint32_t port_now_ms(void *context)
{
    demand(context == &world);
    return world.now_ms;
}

static void command(uint8_t which)
{
    static tmini_status_t (*const commands[])(tmini_t *) = {
        tmini_start,  tmini_stop, tmini_request_info, tmini_request_health, tmini_request_frequency,
        tmini_reboot,
    };
    const tmini_state_t before = tmini_state(&world.lidar);
    tmini_status_t status;
    if (which % 7 == 6) {
        status = tmini_set_frequency(&world.lidar, (uint16_t)(600 + 10 * (take() % 61)));
    } else {
        status = commands[which % 7](&world.lidar);
    }
    if (before == TMINI_STATE_SCANNING && which % 7 != 1) {
        demand(status == TMINI_ERROR_STATE);
    }
}

static void receive_byte(uint8_t byte, bool dma)
{
    if (dma) {
        world.rx[world.position] = byte;
        world.position = (world.position + 1) % RX_SIZE;
        tmini_feed_dma(&world.lidar, world.position);
    } else {
        tmini_feed_byte(&world.lidar, byte);
    }
    world.fed++;
}

static void receive(uint8_t count, bool dma)
{
    while (count-- > 0) {
        receive_byte(take(), dma);
    }
}

/* What a lidar would say, so that the fuzzer need not find a checksum first. */
static void receive_packet(uint8_t ct, uint8_t samples, bool dma)
{
    uint8_t packet[10 + 3 * 40] = {0xAA, 0x55, ct, (uint8_t)((ct & 1) != 0 ? 1 : 1 + samples % 40)};
    for (size_t i = 4; i < 8; i++) {
        packet[i] = take();
    }
    packet[4] |= 1;
    packet[6] |= 1;
    const size_t size = 10 + 3u * packet[3];
    for (size_t i = 10; i < size; i++) {
        packet[i] = (uint8_t)(i * samples);
    }
    for (size_t i = 0; i < size; i++) {
        const bool is_high = i < 10 ? i % 2 != 0 : (i - 10) % 3 == 2;
        if (i != 8 && i != 9) {
            packet[is_high ? 9 : 8] ^= packet[i];
        }
    }
    for (size_t i = 0; i < size; i++) {
        receive_byte(packet[i], dma);
    }
}

static void poll_events(uint8_t times)
{
    for (unsigned i = 0; i <= times % 8u; i++) {
        const tmini_event_t event = tmini_poll(&world.lidar);
        demand(event <= TMINI_EVENT_MORE && lidar_is_sound(&world.lidar));
        if (event == TMINI_EVENT_SCAN) {
            demand(tmini_scan(&world.lidar)->count <= POINTS);
        }
        if (event == TMINI_EVENT_COMMAND_FAILED) {
            demand(tmini_command_error(&world.lidar) < 0);
        }
    }
}

static void account(void)
{
    tmini_counters_t counters;
    tmini_counters(&world.lidar, &counters);
    demand(counters.parser.bytes_in_packets + counters.parser.bytes_in_replies +
               counters.parser.bytes_skipped + counters.parser.bytes_overrun +
               counters.bytes_pending ==
           world.fed);
}

static void act(bool dma)
{
    const uint8_t action = take();
    switch (action % 8) {
    case 0:
        receive(take(), dma);
        break;
    case 1:
        receive_packet(take(), action, dma);
        break;
    case 2:
        world.now_ms += (uint32_t)take() * (action / 8u);
        break;
    case 3:
        command(take());
        break;
    case 4:
        world.write_behaviour = action / 8 % 4 - 1;
        break;
    default:
        poll_events(action / 8);
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const tmini_port_t port = {.write = port_write, .now_ms = port_now_ms};
    memset(&world, 0, sizeof world);
    world.data = data;
    world.left = size;
    world.write_behaviour = 2;
    const uint8_t setup = take();
    const bool dma = (setup & 1) != 0;
    const bool streaming = (setup & 2) != 0;
    world.now_ms = 0u - (uint32_t)setup * 100u; /* The clock wraps on the way. */
    const tmini_config_t config = {
        .port = &port,
        .port_context = &world,
        .rx_buffer = world.rx,
        .rx_size = RX_SIZE,
        .rx_dma = dma,
        .points = streaming ? NULL : world.points,
        .max_points = streaming ? 0 : POINTS,
        .filter = (uint8_t)(setup & TMINI_FILTER_BOTH),
        .disable_recovery = (setup & 16) != 0,
    };
    demand(tmini_init(&world.lidar, &config) == TMINI_OK);
    while (world.left > 0) {
        act(dma);
        demand(lidar_is_sound(&world.lidar));
        account();
    }
    world.now_ms += 1000;
    for (unsigned i = 0; i < 64; i++) {
        (void)tmini_poll(&world.lidar);
    }
    account();
    return 0;
}
