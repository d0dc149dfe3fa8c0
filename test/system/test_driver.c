/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library drives the simulated lidar, in virtual time. world.h lists what is always checked;
 * the tests check the results. */

#include "rows.h"
#include "world.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static world_t world;
static world_config_t config;

void setUp(void)
{
    config = world_default_config();
}

static void check_world(const world_t *checked)
{
    for (unsigned i = 0; i < VIOLATION_KINDS; i++) {
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, checked->counts.violations[i],
                                         world_violation_name((violation_t)i));
    }
}

void tearDown(void)
{
    check_world(&world);
}

static void begin(void)
{
    world_init(&world, &config);
}

/* Waits until the command that has begun ends with this event. */
static void ends_with(tmini_event_t event, uint32_t limit_ms)
{
    const unsigned events =
        world_run_until(&world, BIT(event) | BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);

    TEST_ASSERT_TRUE_MESSAGE((events & BIT(event)) != 0, "the command has not ended as it should");
}

static void fails_with(tmini_status_t status, uint32_t limit_ms)
{
    const unsigned events = world_run_until(&world, BIT(TMINI_EVENT_COMMAND_FAILED), limit_ms);

    TEST_ASSERT_TRUE((events & BIT(TMINI_EVENT_COMMAND_FAILED)) != 0);
    TEST_ASSERT_EQUAL_INT(status, tmini_command_error(&world.lidar));
}

/* Starts and waits for full speed. */
static void scan(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&world.lidar));
    ends_with(TMINI_EVENT_STARTED, 3000);
    (void)world_run_ms(&world, 3000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(&world.lidar));
}

static void begin_scanning(void)
{
    begin();
    scan();
}

static uint32_t count(tmini_event_t event)
{
    return world.counts.events[event];
}

/* ---- Starting ---- */

void test_a_cold_start_brings_the_first_scan_within_two_seconds_and_then_six_a_second(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&world.lidar));
    ends_with(TMINI_EVENT_SCAN, 2000);
    (void)world_run_ms(&world, 2000);
    const uint32_t before = count(TMINI_EVENT_SCAN);
    (void)world_run_ms(&world, 10000);
    TEST_ASSERT_UINT32_WITHIN(1, 60, count(TMINI_EVENT_SCAN) - before);
    TEST_ASSERT_TRUE(world.scan.complete);
    TEST_ASSERT_UINT16_WITHIN(10, 600, world.scan.frequency_chz);
}

void test_a_cold_start_of_a_unit_without_ct_information_is_the_same(void)
{
    config.sim.ct_information = false;
    begin_scanning();
    TEST_ASSERT_TRUE(count(TMINI_EVENT_SCAN) > 12);
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_FAULTS_CHANGED));
}

void test_no_packet_of_the_spin_up_is_lost_and_no_loss_is_reported(void)
{
    config.sim.spin_up_ms = 5000;
    config.sim.spin_up_percent = 5;
    config.streaming = true;
    begin_scanning();
    (void)world_run_ms(&world, 5000);
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_LOST));
    TEST_ASSERT_EQUAL_UINT32(world.link.counts.packets, count(TMINI_EVENT_PACKET));
}

/* As on two real units: the first packets pass the start packet's usual angle without one, or begin
 * with a start packet at any angle. */
void test_first_packets_as_real_units_send_them_make_true_scans(void)
{
    static const uint16_t stands_at_q6[] = {0, 21101, 5485};

    for (unsigned i = 0; i < 6; i++) {
        config.sim.beginning = (sim_beginning_t)(i % 3);
        config.sim.first_angle_q6 = stands_at_q6[i % 3];
        config.sim.ct_information = i < 3;
        config.sim.information.firmware_minor = 3;
        begin_scanning();
        TEST_ASSERT_TRUE(count(TMINI_EVENT_SCAN) > 12);
        TEST_ASSERT_TRUE(world.scan.complete);
        check_world(&world);
    }
}

void test_a_restarted_program_finds_the_lidar_streaming_and_starts_it_again(void)
{
    begin_scanning();
    world_restart_library(&world);
    scan();
}

void test_a_restarted_program_that_never_commands_gets_nothing_from_a_streaming_lidar(void)
{
    begin_scanning();
    world_restart_library(&world);
    TEST_ASSERT_EQUAL_HEX(0, world_run_ms(&world, 5000));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_UNKNOWN, tmini_state(&world.lidar));
}

/* ---- Each command, on a lidar that is still streaming ---- */

static void streams_on_while_the_program_restarts(void)
{
    begin_scanning();
    world_restart_library(&world);
}

void test_each_question_reaches_a_lidar_that_is_still_streaming(void)
{
    static const uint8_t serial[16] = {2, 0, 2, 6, 0, 3, 1, 7, 0, 0, 0, 1, 2, 3, 4, 5};

    streams_on_while_the_program_restarts();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&world.lidar));
    ends_with(TMINI_EVENT_INFO, 1000);
    TEST_ASSERT_EQUAL_UINT8(151, tmini_info(&world.lidar)->model);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(serial, tmini_info(&world.lidar)->serial, 16);
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&world.sim));
    streams_on_while_the_program_restarts();
    sim_set_health(&world.sim, SIM_HEALTH_LD);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_health(&world.lidar));
    ends_with(TMINI_EVENT_HEALTH, 1000);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_LD, tmini_health(&world.lidar)->faults);
}

void test_each_setting_reaches_a_lidar_that_is_still_streaming(void)
{
    streams_on_while_the_program_restarts();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_set_frequency(&world.lidar, 940));
    ends_with(TMINI_EVENT_FREQUENCY, 3000);
    TEST_ASSERT_EQUAL_UINT16(940, sim_frequency_chz(&world.sim));
    scan();
    TEST_ASSERT_UINT16_WITHIN(20, 940, world.scan.frequency_chz);
    world_restart_library(&world);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_reboot(&world.lidar));
    ends_with(TMINI_EVENT_REBOOTED, 6000);
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&world.sim));
    scan();
}

/* The program polls every 60 ms. */
static unsigned run_at_leisure(uint32_t ms)
{
    unsigned events = 0;

    for (; ms > 0; ms -= 60) {
        world.busy_until_us = world.now_us + 60000u;
        events |= world_run_ms(&world, 60);
    }
    return events & ~BIT(TMINI_EVENT_MORE);
}

/* The program does not poll for 800 ms, so that the ring is full. When bytes are refused, the line
 * must not count as quiet. */
static void streams_on_while_the_program_is_busy(void)
{
    config.rx_size = 4096;
    config.overruns_expected = true;
    config.sim.stop_tail_ms = 300;
    streams_on_while_the_program_restarts();
    world.busy_until_us = world.now_us + 800000u;
    (void)world_run_ms(&world, 799);
}

void test_a_lidar_whose_bytes_have_filled_the_ring_is_stopped_before_it_is_started(void)
{
    streams_on_while_the_program_is_busy();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&world.lidar));
    TEST_ASSERT_EQUAL_HEX(0, run_at_leisure(300));
    TEST_ASSERT_TRUE((run_at_leisure(3000) & BIT(TMINI_EVENT_STARTED)) != 0);
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_LOST));
}

void test_a_lidar_whose_bytes_have_filled_the_ring_is_reported_stopped_only_when_it_is(void)
{
    streams_on_while_the_program_is_busy();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
    TEST_ASSERT_EQUAL_HEX(0, run_at_leisure(300));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_STOPPED), run_at_leisure(600));
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&world.sim));
}

/* ---- Commands in adverse conditions ---- */

void test_every_frequency_can_be_set_from_where_the_last_one_left_it(void)
{
    begin();
    for (unsigned i = 0; i < 61; i++) {
        const uint16_t target_chz = (uint16_t)(600 + 10 * (i * 37 % 61));

        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_set_frequency(&world.lidar, target_chz));
        ends_with(TMINI_EVENT_FREQUENCY, 3000);
        TEST_ASSERT_EQUAL_UINT16(target_chz, sim_frequency_chz(&world.sim));
    }
}

void test_a_late_reply_to_any_frequency_step_does_no_harm(void)
{
    static const uint32_t delays_ms[] = {40, 100, 1900, 2050, 2500};

    for (unsigned i = 0; i < sizeof delays_ms / sizeof delays_ms[0]; i++) {
        for (unsigned late = 0; late < 6; late++) {
            begin();
            TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_set_frequency(&world.lidar, 820));
            while (world.sim.counts.replies < late) {
                (void)world_step(&world);
            }
            sim_delay_next_reply(&world.sim, delays_ms[i]);
            ends_with(TMINI_EVENT_FREQUENCY, 8000);
            TEST_ASSERT_EQUAL_UINT16(820, sim_frequency_chz(&world.sim));
            check_world(&world);
        }
    }
}

void test_a_late_reply_to_one_query_is_not_taken_as_the_reply_to_another(void)
{
    begin();
    sim_delay_next_reply(&world.sim, 2500);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&world.lidar));
    (void)world_run_ms(&world, 2000);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
    fails_with(TMINI_ERROR_ABORTED, 1);
    ends_with(TMINI_EVENT_STOPPED, 1000);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&world.lidar));
    (void)world_run_until(&world, BIT(TMINI_EVENT_INFO), 3000);
    TEST_ASSERT_EQUAL_UINT8(151, tmini_info(&world.lidar)->model);
}

/* Another program has just sent A5 98, which real units answer. */
void test_a_late_reply_to_a_command_of_another_program_disturbs_no_answer(void)
{
    static const uint8_t command[2] = {0xA5, SIM_COMMAND_UNDOCUMENTED_98};

    for (uint32_t late_ms = 0; late_ms < 200; late_ms += 9) {
        begin();
        sim_delay_next_reply(&world.sim, 50 + late_ms);
        sim_receive(&world.sim, command, 2, world.now_us);
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&world.lidar));
        ends_with(TMINI_EVENT_FREQUENCY, 5000);
        TEST_ASSERT_EQUAL_UINT16(600, tmini_frequency_chz(&world.lidar));
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&world.lidar));
        ends_with(TMINI_EVENT_INFO, 5000);
        TEST_ASSERT_EQUAL_UINT8(151, tmini_info(&world.lidar)->model);
        sim_delay_next_reply(&world.sim, late_ms);
        sim_receive(&world.sim, command, 2, world.now_us);
        scan();
        check_world(&world);
    }
}

/* ---- Faults of the line, at several rates ---- */

/* A minute of such faults, then none: scans must resume, and no violation may have happened. */
static void survives(sim_link_kind_t kind, uint32_t mean_gap)
{
    begin_scanning();
    sim_link_set_mean_gap(&world.link, kind, mean_gap, world.now_us);
    (void)world_run_ms(&world, 60000);
    TEST_ASSERT_TRUE(world.link.counts.faults[kind] > 0);
    sim_link_calm(&world.link, world.now_us);
    (void)world_run_ms(&world, WORLD_RECOVERY_MS + 5000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_FAULTS_CHANGED));
}

/* The steps are a kind of fault and mean gaps. */
static void survives_in_every_mode(const row_t *row)
{
    static const char *const kinds[] = {
        [SIM_LINK_DROP] = "drop",     [SIM_LINK_FLIP] = "flip",     [SIM_LINK_INSERT] = "insert",
        [SIM_LINK_BURST] = "burst",   [SIM_LINK_STALL] = "stall",   [SIM_LINK_CUT] = "cut",
        [SIM_LINK_UNPLUG] = "unplug", [SIM_LINK_GARBLE] = "garble",
    };
    const char *rest = strchr(row->steps, ' ');
    unsigned kind = 0;

    while (strncmp(kinds[kind], row->steps, strlen(kinds[kind])) != 0) {
        kind++;
    }
    while (*rest != '\0') {
        const uint32_t mean_gap = (uint32_t)strtoul(rest, (char **)&rest, 10);

        for (unsigned mode = 0; mode < 4; mode++) {
            config.seed = mode;
            config.streaming = (mode & 1u) != 0;
            config.dma = (mode & 2u) != 0;
            config.rx_size = config.dma ? 8192 : 2048;
            config.sim.ct_information = !config.sim.ct_information;
            config.busy_one_in = 100;
            config.busy_ms = 60;
            survives((sim_link_kind_t)kind, mean_gap);
            check_world(&world);
        }
    }
}

static const row_t lines[] IN_FLASH = {
    ROW(lost_bytes_cost_no_other_packet, "drop 200 2000 50000"),
    ROW(flipped_bits_cost_no_other_packet, "flip 200 2000 50000"),
    ROW(extra_bytes_cost_no_other_packet, "insert 200 2000 50000"),
    ROW(bursts_cost_no_other_packet, "burst 20 200 5000"),
    ROW(stalls_cost_at_most_the_packet_that_they_cut, "stall 200 1000 10000"),
    ROW(packets_cut_short_cost_no_other_packet, "cut 20 200 5000"),
    ROW(loss_of_power_is_recovered_from, "unplug 5000 15000"),
    ROW(wrong_baud_rates_for_a_while_are_recovered_from, "garble 2000 10000"),
};

void test_faults_of_the_line(void)
{
    run_rows(lines, survives_in_every_mode);
}

/* ---- Recovery ---- */

void test_a_lidar_that_shuts_itself_off_is_lost_and_recovered_when_it_is_well_again(void)
{
    config.sim.fatal_health = SIM_HEALTH_SENSOR;
    begin_scanning();
    sim_set_health(&world.sim, SIM_HEALTH_SENSOR);
    world_run_until(&world, BIT(TMINI_EVENT_LOST), 2000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_RECOVERING, tmini_state(&world.lidar));
    sim_set_health(&world.sim, 0);
    ends_with(TMINI_EVENT_RECOVERED, WORLD_RECOVERY_MS);
}

/* ---- Faults of the lidar ---- */

static void reports(uint8_t expected)
{
    const uint32_t losses = count(TMINI_EVENT_LOST);
    const uint32_t commands = world.sim.counts.commands;

    (void)world_run_ms(&world, 60000);
    TEST_ASSERT_EQUAL_HEX8(expected, tmini_faults(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_FAULTS_CHANGED));
    sim_block_rotor(&world.sim, false);
    sim_cover_window(&world.sim, false);
    sim_set_health(&world.sim, 0);
    (void)world_run_ms(&world, WORLD_FAULT_MS);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(2, count(TMINI_EVENT_FAULTS_CHANGED));
    /* It was reported, not "repaired". */
    TEST_ASSERT_EQUAL_UINT32(losses, count(TMINI_EVENT_LOST));
    TEST_ASSERT_EQUAL_UINT32(commands, world.sim.counts.commands);
}

static void begin_with(bool ct_information, bool blocked_sends_starts)
{
    config.sim.ct_information = ct_information;
    config.sim.blocked_sends_starts = blocked_sends_starts;
    begin_scanning();
}

/* The steps: what the unit sends, what befalls it, and the fault. */
static void is_reported_and_not_repaired(const row_t *row)
{
    begin_with(strstr(row->steps, "ct") != NULL, strstr(row->steps, "starts") != NULL);
    sim_block_rotor(&world.sim, strstr(row->steps, "blocked") != NULL);
    sim_cover_window(&world.sim, strstr(row->steps, "covered") != NULL);
    reports(strstr(row->steps, "data") != NULL ? TMINI_FAULT_DATA : TMINI_FAULT_ENCODER);
}

static const row_t faults[] IN_FLASH = {
    ROW(a_blocked_rotor_is_reported, "ct starts blocked: encoder"),
    ROW(a_blocked_rotor_without_start_packets_is_reported, "ct blocked: encoder"),
    ROW(a_blocked_rotor_of_a_unit_without_ct_information_is_reported, "blocked: encoder"),
    ROW(a_blocked_rotor_with_start_packets_but_no_ct_information_shows_as_no_data,
        "starts blocked: data"),
    ROW(a_covered_window_is_reported, "ct starts covered: data"),
    ROW(a_covered_window_of_a_unit_without_ct_information_is_reported, "starts covered: data"),
};

void test_faults_are_reported_and_not_repaired(void)
{
    run_rows(faults, is_reported_and_not_repaired);
}

void test_every_health_bit_is_reported(void)
{
    for (unsigned bit = 0; bit < 6; bit++) {
        begin_with(true, true);
        sim_set_health(&world.sim, (uint8_t)(1u << bit));
        reports((uint8_t)(1u << bit));
    }
}

/* ---- Reception ---- */

void test_a_small_dma_ring_is_enough_for_a_prompt_main_loop(void)
{
    config.dma = true;
    config.rx_size = 1024;
    config.busy_one_in = 10;
    config.busy_ms = 8;
    begin_scanning();
    (void)world_run_ms(&world, 60000);
}

void test_a_ring_of_1024_bytes_is_enough_for_a_main_loop_that_is_busy_for_60_ms(void)
{
    config.rx_size = 1024;
    config.busy_one_in = 10;
    config.busy_ms = 60;
    begin_scanning();
    (void)world_run_ms(&world, 60000);
}

void test_a_main_loop_that_is_busy_for_too_long_costs_packets_but_accounts_for_them(void)
{
    tmini_counters_t counters;

    for (unsigned dma = 0; dma < 2; dma++) {
        config.dma = dma == 1;
        config.rx_size = 1024;
        config.busy_one_in = 10;
        config.busy_ms = 400;
        config.overruns_expected = true;
        begin_scanning();
        (void)world_run_ms(&world, 60000);
        tmini_counters(&world.lidar, &counters);
        TEST_ASSERT_TRUE(counters.bytes_overrun > 0);
        TEST_ASSERT_TRUE(count(TMINI_EVENT_SCAN) > 0);
        TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_LOST));
        check_world(&world);
    }
}

/* After the pause a small ring may hold no whole packet. */
void test_a_program_that_pauses_for_seconds_does_not_lose_a_lidar_that_streams(void)
{
    config.dma = true;
    config.rx_size = 512;
    config.busy_one_in = 1000;
    config.busy_ms = 3000;
    config.overruns_expected = true;
    begin_scanning();
    (void)world_run_ms(&world, 600000);
    TEST_ASSERT_TRUE(count(TMINI_EVENT_SCAN) > 0);
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_LOST));
    check_world(&world);
}
