/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the node of examples/micro_ros in virtual time, with the simulated lidar and a virtual
 * agent. The conversion of a scan has a test of its own: test/port/ros2/test_laser.c. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine.h"
#include "scan_node.h"
#include "virtual_agent.h"

#include "unity.h"

#define EPOCH_NS INT64_C(1790000000000000000) /* ROS's clock when our clock is 0. */
#define NS_PER_US 1000

static uint64_t turn_began_us; /* The end of the last start packet. */
static uint8_t rx[2048];
static tmini_point_t points[800];
static tmini_t lidar;
static scan_node_t node;
static char frame[] = "laser";

/* ---- The linker redirects calls of malloc() to this counter ---- */

static unsigned allocations;
void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

void *__wrap_malloc(size_t size)
{
    allocations++;
    return __real_malloc(size);
}

/* ---- Lidar and clock ---- */

static void note_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    if (packet->bytes[2] & 1) { /* A start packet. */
        turn_began_us = machine.now_us;
    }
}

static uint32_t now_ms(void *context)
{
    (void)context;
    return (uint32_t)(machine.now_us / 1000);
}

static int send_to_lidar(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    sim_receive(&machine.lidar, bytes, count, machine.now_us);
    return (int)count;
}

/* The interrupt. */
static void arrive(uint32_t flags, uint8_t byte)
{
    (void)flags;
    (void)tmini_feed(&lidar, &byte, 1);
}

static void wait(int ms)
{
    machine_pass((uint32_t)ms * 1000);
    virtual_agent.epoch_ns = EPOCH_NS + (int64_t)machine.now_us * NS_PER_US;
}

static void run_for(unsigned ms)
{
    const uint64_t end_us = machine.now_us + ms * UINT64_C(1000);
    while (machine.now_us < end_us) {
        wait(1);
        scan_node_step(&node);
    }
}

void setUp(void)
{
    static const tmini_port_t port = {.write = send_to_lidar, .now_ms = now_ms};
    static const sim_observer_t observer = {.on_packet = note_packet};
    static const machine_uart_t uart = {.arrive = arrive};
    const tmini_config_t config = {
        .port = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = 800,
    };
    machine_begin(NULL, &uart); /* It shows the room, not marks. */
    sim_observe(&machine.lidar, &observer);
    virtual_agent_reset(wait);
    virtual_agent.present = true;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
    memset(&node, 0xEE, sizeof node);
    scan_node_init(&node, &lidar, &config, frame);
}

/* 6 Hz, minus the motor's spin-up. Connecting may allocate, publishing must not. */
void test_each_scan_is_published_and_allocates_nothing(void)
{
    run_for(3000);
    allocations = 0;
    run_for(7000);
    TEST_ASSERT_EQUAL_UINT(0, allocations);
    TEST_ASSERT_GREATER_THAN_UINT(50, virtual_agent.published);
    TEST_ASSERT_EQUAL_UINT32(virtual_agent.published, node.counters.published);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.unpublished);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.connections);
}

void test_every_field_of_a_message_is_filled_in_and_the_ranges_show_the_room(void)
{
    const sensor_msgs__msg__LaserScan *const message = &virtual_agent.message;
    sim_place_obstacle(&machine.lidar, 90 * 64, 20 * 64, 700); /* To the right. */
    run_for(5000);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0.7f, message->ranges.data[270]);
    TEST_ASSERT_FALSE(fabsf(message->ranges.data[90] - 0.7f) < 0.1f);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 6.26573201f, message->angle_max - message->angle_min);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.01745329f, message->angle_increment);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 0.1667f, message->scan_time);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -message->scan_time / 360, message->time_increment);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, message->range_min);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 12.0f, message->range_max);
    TEST_ASSERT_EQUAL_PTR(frame, message->header.frame_id.data);
    TEST_ASSERT_EQUAL_UINT(5, message->header.frame_id.size);
    TEST_ASSERT_EQUAL_UINT(6, message->header.frame_id.capacity);
    TEST_ASSERT_EQUAL_PTR(node.memory.ranges, message->ranges.data);
    TEST_ASSERT_EQUAL_UINT(360, message->ranges.size);
    TEST_ASSERT_EQUAL_UINT(360, message->ranges.capacity);
    TEST_ASSERT_EQUAL_PTR(node.memory.intensities, message->intensities.data);
    TEST_ASSERT_EQUAL_UINT(360, message->intensities.size);
    TEST_ASSERT_EQUAL_UINT(360, message->intensities.capacity);
}

/* The last quarter of a turn of 100 ms, which began at 1000; the packet after it came late. */
void test_the_stamp_of_a_part_is_when_its_turn_ended(void)
{
    const tmini_scan_t part = {
        .points = points, .count = 1, .frequency_chz = 1000, .start_ms = 1075, .end_ms = 1200};
    points[0] = (tmini_point_t){270 * 64, 1000, 0, 0};
    TEST_ASSERT_TRUE(
        laser_scan_fill(&node.message, &node.memory, &part, INT64_C(1790000000123456789)));
    TEST_ASSERT_EQUAL_INT32(1790000000, node.message.header.stamp.sec);
    TEST_ASSERT_UINT32_WITHIN(500000, 23456789, node.message.header.stamp.nanosec);
    TEST_ASSERT_FALSE(laser_scan_fill(&node.message, &node.memory, NULL, 0));
    TEST_ASSERT_EQUAL_INT32(1790000000, node.message.header.stamp.sec);
}

/* How much later the last stamp is than the scan's end, which is the next start packet. */
static int64_t stamp_is_late_ns(void)
{
    const int64_t stamp_ns = virtual_agent.message.header.stamp.sec * INT64_C(1000000000) +
                             (int64_t)virtual_agent.message.header.stamp.nanosec;
    return stamp_ns - (EPOCH_NS + (int64_t)turn_began_us * NS_PER_US);
}

void test_a_messages_stamp_is_the_scans_end_in_the_agents_clock(void)
{
    run_for(5000);
    const unsigned published = virtual_agent.published;
    while (virtual_agent.published == published) {
        run_for(1);
    }
    TEST_ASSERT_EQUAL_UINT(1, virtual_agent.synchronisations);
    TEST_ASSERT_TRUE(stamp_is_late_ns() >= 0 && stamp_is_late_ns() <= 1000000);
}

/* Without the agent's clock, and without its answer to a message. */
void test_scans_that_cannot_be_published_are_counted_until_they_can(void)
{
    static const char *const functions[] = {"sync", "publish"};
    for (unsigned i = 0; i < 2; i++) {
        const uint32_t unpublished = node.counters.unpublished;
        virtual_agent.failing = functions[i];
        virtual_agent.published = 0;
        run_for(3000);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, virtual_agent.published, functions[i]);
        TEST_ASSERT_GREATER_THAN_UINT32(unpublished + 10, node.counters.unpublished);
        virtual_agent.failing = NULL;
        run_for(3000);
        TEST_ASSERT_NOT_EQUAL_UINT(0, virtual_agent.published);
    }
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.connections);
}

void test_the_clock_is_synchronised_again_each_minute(void)
{
    run_for(185000);
    TEST_ASSERT_EQUAL_UINT(4, virtual_agent.synchronisations);
}

/* The driver estimates a scan's age from the bytes after it, at 23 per millisecond. The lidar sends
 * only 13, so the stamp is somewhat late. */
void test_a_scan_that_is_polled_late_keeps_its_time(void)
{
    int64_t latest_ns = 0;
    run_for(5000);
    for (int i = 0; i < 100; i++) {
        const unsigned published = virtual_agent.published;
        wait(40);
        scan_node_step(&node);
        if (virtual_agent.published != published && stamp_is_late_ns() > latest_ns) {
            latest_ns = stamp_is_late_ns();
        }
    }
    TEST_ASSERT_TRUE(latest_ns > 0 && latest_ns <= 25 * NS_PER_US * INT64_C(1000));
}

void test_an_agent_that_comes_later_or_comes_back_is_found_without_losing_a_byte(void)
{
    tmini_counters_t counters;
    for (unsigned times = 1; times <= 2; times++) {
        const uint32_t unpublished = node.counters.unpublished;
        virtual_agent.present = false;
        run_for(5000);
        TEST_ASSERT_FALSE(virtual_agent.publisher_open);
        TEST_ASSERT_FALSE(virtual_agent.node_open);
        TEST_ASSERT_FALSE(virtual_agent.support_open);
        TEST_ASSERT_GREATER_THAN_UINT32(unpublished + 20, node.counters.unpublished);
        virtual_agent.present = true;
        virtual_agent.published = 0;
        run_for(1300);
        TEST_ASSERT_GREATER_THAN_UINT(0, virtual_agent.published);
        TEST_ASSERT_EQUAL_UINT32(times, node.counters.connections);
        TEST_ASSERT_EQUAL_UINT(times, virtual_agent.synchronisations);
    }
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.unclosed);
    TEST_ASSERT_EQUAL_INT(SCAN_NODE_WAIT_MS, virtual_agent.longest_wait_ms);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
}

void test_after_a_failure_all_is_closed_and_opened_again(void)
{
    static const char *const functions[] = {"publisher", "node", "support"};
    for (unsigned i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        virtual_agent.failing = functions[i];
        run_for(1500);
        TEST_ASSERT_FALSE_MESSAGE(virtual_agent.node_open, functions[i]);
        TEST_ASSERT_FALSE_MESSAGE(virtual_agent.support_open, functions[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.connections);
    virtual_agent.failing = NULL;
    run_for(1500);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.connections);
}

void test_failures_to_close_are_counted(void)
{
    run_for(1500);
    virtual_agent.present = false;
    virtual_agent.failing = "close";
    run_for(1500);
    TEST_ASSERT_EQUAL_UINT32(3, node.counters.unclosed);
}
