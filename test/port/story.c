/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "story.h"

#include "console.h"

static story_board_t board;
static unsigned chapter;

static void it_scans_and_an_obstacle_comes(void)
{
    assert_said("model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    assert_last_said(", go; bytes ");
    assert_last_said("lost: 0 checksums, 0 bytes, 0 gaps\n");
    board.assert_stops(false);
    sim_place_obstacle(board.lidar, 0, 640, 250);
}

static void it_stops_and_the_obstacle_goes(void)
{
    assert_last_said(", STOP;");
    board.assert_stops(true);
    sim_clear_obstacles(board.lidar);
}

static void it_goes_and_power_fails(void)
{
    board.assert_stops(false);
    sim_power(board.lidar, false, board.now_us());
}

static void it_is_blind_and_power_returns(void)
{
    assert_said("lost; trying to get it back\n");
    board.assert_stops(true);
    sim_power(board.lidar, true, board.now_us());
}

static void it_has_come_back(void)
{
    assert_said("back again\n");
    board.assert_stops(false);
}

static const struct {
    uint64_t time_us;
    void (*happens)(void);
} chapters[] = {
    {4000000, it_scans_and_an_obstacle_comes},
    {5500000, it_stops_and_the_obstacle_goes},
    {6500000, it_goes_and_power_fails},
    {8500000, it_is_blind_and_power_returns},
    {30000000, it_has_come_back},
};

#define CHAPTERS (sizeof chapters / sizeof chapters[0])

void story_begin(const story_board_t *the_board)
{
    board = *the_board;
    chapter = 0;
}

bool story_goes_on(void)
{
    if (chapter < CHAPTERS && board.now_us() >= chapters[chapter].time_us) {
        chapters[chapter].happens();
        chapter++;
    }
    return chapter < CHAPTERS;
}
