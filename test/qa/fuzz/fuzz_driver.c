/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fuzz target: the whole driver. The input is a list of actions: bytes received by interrupt or
 * DMA, time passing, polls, commands at any moment, and a port that takes none, one or both
 * bytes, or fails. The driver must not crash, hang or miscount bytes, and must send only whole
 * two-byte commands. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "encoder.h"
#include "invariants.h"
#include "tmini_driver.h"

#define RX_SIZE 512u
#define POINTS 700u
#define FEW_POINTS 100u

/* Bits of the input's first byte; two more bits are the filter. */
enum { DMA = 1, STREAMING = 2, NO_RECOVERY = 16, MANY_POINTS = 64 };

static struct {
    const uint8_t *data;
    size_t left;
    uint32_t now_ms;
    int write_behaviour;
    size_t position; /* DMA's position in the ring's memory. */
    uint32_t fed;
    bool half_sent;
    bool dma;
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

static void receive_byte(uint8_t byte)
{
    if (world.dma) {
        world.rx[world.position] = byte;
        world.position = (world.position + 1) % RX_SIZE;
        tmini_feed_dma(&world.lidar, world.position);
    } else {
        tmini_feed_byte(&world.lidar, byte);
    }
    world.fed++;
}

static void receive_all(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        receive_byte(bytes[i]);
    }
}

static uint32_t port_now_ms(void *context)
{
    demand(context == &world);
    return world.now_ms;
}

/* ---- Actions ---- */

static void command(uint8_t which)
{
    static tmini_status_t (*const commands[])(tmini_t *) = {
        tmini_start,  tmini_stop, tmini_request_info, tmini_request_health, tmini_request_frequency,
        tmini_reboot,
    };
    const tmini_state_t before = tmini_state(&world.lidar);
    tmini_status_t status;
    if (which % 8 == 7) {
        tmini_withdraw(&world.lidar, (tmini_event_t)(TMINI_EVENT_INFO + take() % 3));
        return;
    }
    if (which % 8 == 6) {
        status = tmini_set_frequency(&world.lidar, (uint16_t)(600 + 10 * (take() % 61)));
    } else {
        status = commands[which % 8](&world.lidar);
    }
    const bool is_query = which % 8 >= 2 && which % 8 <= 5;
    if (before == TMINI_STATE_SCANNING) {
        demand(status == (is_query ? TMINI_ERROR_STATE : TMINI_OK));
    }
}

static void receive(uint8_t count)
{
    while (count-- > 0) {
        receive_byte(take());
    }
}

/* Receives a valid packet: the fuzzer would hardly find a valid checksum by chance. */
static void receive_packet(uint8_t ct, uint8_t samples)
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
    encode_seal(packet);
    receive_all(packet, size);
}

/* Receives a reply with a valid header and any content. */
static void receive_reply(uint8_t shape)
{
    static const uint8_t headers[][7] = {{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81},
                                         {0xA5, 0x5A, 20, 0, 0, 0, 0x04},
                                         {0xA5, 0x5A, 3, 0, 0, 0, 0x06},
                                         {0xA5, 0x5A, 4, 0, 0, 0, 0x04}};
    const uint8_t *const header = headers[shape % 4u];
    receive_all(header, sizeof headers[0]);
    receive(shape % 4u == 0 ? 0 : header[2]);
}

/* Calls what only asks, and checks the answers' ranges. */
static void look_around(void)
{
    tmini_ct_info_t info;
    tmini_ct_info(&world.lidar, &info);
    demand(tmini_faults(&world.lidar) <= (TMINI_FAULT_MASK | TMINI_FAULT_FREQUENCY));
    demand(tmini_info(&world.lidar) != NULL && tmini_health(&world.lidar) != NULL);
    demand(tmini_frequency_chz(&world.lidar) <= 2000);
    demand(tmini_next_poll_ms(&world.lidar) <= UINT16_MAX);
    demand(tmini_scan_age_ms(&world.lidar) <= UINT32_MAX / 2);
}

static void poll_events(uint8_t times)
{
    for (unsigned i = 0; i <= times % 8u; i++) {
        const tmini_event_t event = tmini_poll(&world.lidar);
        demand(event <= TMINI_EVENT_MORE && lidar_is_sound(&world.lidar));
        if (event == TMINI_EVENT_SCAN) {
            demand(tmini_scan(&world.lidar)->count <= world.lidar.decoder.builder.capacity);
        }
        if (event == TMINI_EVENT_COMMAND_FAILED) {
            demand(tmini_command_error(&world.lidar) < 0);
        }
        look_around();
    }
}

static void account(void)
{
    tmini_counters_t counters;
    tmini_counters(&world.lidar, &counters);
    demand(counters.bytes_in_packets + counters.bytes_in_replies + counters.bytes_skipped +
               counters.bytes_overrun + counters.bytes_pending ==
           world.fed);
}

static void act(void)
{
    const uint8_t action = take();
    switch (action % 8) {
    case 0:
        receive(take());
        break;
    case 1:
        receive_packet(take(), action);
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
    case 5:
        receive_reply(action / 8);
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
    world.dma = (setup & DMA) != 0;
    const bool streaming = (setup & STREAMING) != 0;
    world.now_ms = 0u - (uint32_t)setup * 100u; /* So that the clock wraps around. */
    const tmini_config_t config = {
        .port = &port,
        .port_context = &world,
        .rx_buffer = world.rx,
        .rx_size = RX_SIZE,
        .rx_dma = world.dma,
        .points = streaming ? NULL : world.points,
        .max_points = streaming                    ? 0
                      : (setup & MANY_POINTS) != 0 ? POINTS
                                                   : FEW_POINTS,
        .filter = streaming ? 0 : (uint8_t)(setup & TMINI_FILTER_BOTH),
        .recovery = (setup & NO_RECOVERY) != 0 ? TMINI_RECOVERY_OFF : TMINI_RECOVERY_ON,
    };
    demand(tmini_init(&world.lidar, &config) == TMINI_OK);
    while (world.left > 0) {
        act();
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
