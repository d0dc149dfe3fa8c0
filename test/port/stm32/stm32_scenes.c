/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What each STM32 port must do, one situation at a time, in each of its ways to receive
 * (play.h). Interrupts stay pending until a handler clears them, and may come at
 * any access. A byte takes 43.4 µs, and a lap of the buffer 44,445 µs. */

#include "play.h"

/* Those in every_port.c. */
void setUp(void);
void tearDown(void);
void test_scenes_of_both_ports(void);

static const row_t scenes[] IN_FLASH = {
    /* ---- Byte by byte ---- */
    ROW(each_byte_is_an_interrupt_and_reaches_the_lidar,
        "bytes: P:200 run packets:200 served:2600"),
    ROW(line_errors_cost_no_byte, "bytes: FE P NE P run packets:2 ORE:0 restarts:0"),
    ROW(a_late_interrupt_is_an_overrun_that_is_counted_and_survived, /* Until the second packet. */
        "bytes: P:3 hold:694 run P run packets:2 ORE:1"),
    ROW(no_packet_continues_across_an_overrun, /* What is left of two packets looks like one. */
        "bytes: P:2 ~282 hold:607 run ORE:1 packets:0"),
    ROW(an_overrun_without_a_byte_is_a_gap_and_stops_reception_only_until_the_next_poll,
        "bytes: head run ORE-stands +1 ORE:1 served<20 tail run packets:0 P:2 run packets:2"),
    /* ---- DMA ---- */
    ROW(dma_delivers_every_byte_with_few_interrupts,
        "DMA blocks: P:200 run packets:200 accounted:2600 laps:0 served<50"),
    /* Also at the buffer's end, where HALs of different years report different events. */
    ROW(idle_events_at_any_position_lose_and_repeat_nothing,
        "DMA blocks: 300( P +1 ) packets:300 laps:0"),
    /* On a slow controller, interrupts coincide. */
    ROW(priorities_of_the_two_interrupts_may_be_any,
        "DMA blocks: for:4:7:1 priority:it access:2000 P:200 run packets:200 laps:0"),
    ROW(polls_alone_deliver_every_byte_from_dma, "DMA blocks: deaf P:200 run packets:200 laps:0"),
    ROW(a_line_error_costs_only_its_byte,
        "DMA blocks: 10( P:10 FE x P:10 NE x ) run packets:200 skipped:20 restarts:0 FEs>4 FEs<11 "
        "NEs>4"),
    ROW(an_overrun_while_dma_runs_is_counted_and_does_not_stop_it,
        "DMA blocks: P:10 ~2000 ORE-stands run packets:10 ORE:1 restarts:0"),
    /* As on many boards. DMA has already read the byte before. */
    ROW(an_overrun_that_holds_bytes_back_is_cleared_by_the_poll,
        "DMA blocks: ORE-holds P:10 run ORE-stands ~1000 poll P:10 run packets:20 ORE:1"),
#ifndef STM32_MODEL_SR /* The poll comes up to 1 ms (23 bytes) later. */
    ROW(an_error_that_holds_dma_back_is_cleared_by_the_poll,
        "DMA blocks: DDRE FE P P:19 run packets>13 packets<21 mark P:10 run more:10"),
#endif
    /* ---- Laps ---- */
    /* Half and whole buffer are reported at once, and of the bytes that a lap has overwritten, only
     * a few seem to be new. */
    ROW(a_lap_without_any_interrupt_is_counted_once,
        "DMA: for:44445:88890:1500 P:200 +30 held:it run laps:1 accounted:2600 packets>75 "
        "packets<200 overrun>500"),
    /* A lap that the half alone has shown must not hide the next one. */
    ROW(each_of_several_laps_is_counted_once,
        "DMA: for:45445:88890:3000 P:600 +30 held:it poll +3 laps:1 +30 held:it poll +3 laps:2 "
        "+30 held:it poll +3 laps:3 run accounted:7800 laps:3"),
    ROW(a_lap_of_a_block_without_any_interrupt_is_noticed,
        "blocks: for:11111:44445:700 P:200 +30 held:it run laps>0"),
    ROW(interrupts_late_by_less_than_half_a_lap_lose_nothing,
        "DMA: for:100:20222:1500 P:200 +30 held:it run packets:200 laps:0"),
    /* ---- Start and stop ---- */
    /* As after a reset of the controller alone, while the lidar spins. */
    ROW(an_overrun_pending_at_the_start_does_no_harm,
        "all idle: P:100 ~2000 ORE-stands:1 start run packets>93 restarts:0"),
    /* The buffer is full of old packets. When the port stops, no event has come for the last. */
    ROW(after_stop_received_bytes_are_kept_and_after_another_start_none_is_read_again,
        "all: P:100 run P:5 ~3000 stop packets:105 off:1 P:100 run packets:105 start packets:105 "
        "P:5 run packets:110"),
    ROW(a_lidar_that_is_set_up_again_begins_at_the_buffers_start,
        "all: P:33 run stop anew start P:100 run packets:100 accounted:1300"),
    ROW(broken_reception_is_set_up_again_when_the_lidar_is_lost_but_not_when_stopped,
        "all: P:10 run break restart poll P:100 run packets:110 stop restart off:1"),
};

void test_scenes_of_both_ports(void)
{
    run_rows(scenes, play_row);
}
