/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on an STM32F405, without an operating system and without vendor code: asks for the
 * lidar's information and health, scans at 10 Hz, and lets the robot move while nothing is near in
 * front. Each second it reports on the console what it sees. */

#include "board.h"
#include "console.h"
#include "obstacle.h"
#include "reception.h"
#include "report.h"
#include "stm32f405.h"
#include "tmini/tmini.h"
#include "tmini_stm32_usart.h"

#define FREQUENCY_CHZ 1000u
#define STATUS_MS 1000u

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_stm32_usart_t port;
static obstacle_t obstacle;
static report_status_t status;
static volatile uint32_t worst_cycles;
static bool is_asking = true;
static bool says_digests;

void USART1_IRQHandler(void);

void USART1_IRQHandler(void)
{
    const uint32_t start = board_cycle();
    tmini_stm32_usart_interrupt(&port);
    const uint32_t cycles = board_cycles_since(start);
    if (cycles > worst_cycles) {
        worst_cycles = cycles;
    }
}

static void see(const tmini_scan_t *scan)
{
    obstacle_see(&obstacle, scan);
    status.points += scan->count;
    if (says_digests) {
        report_digest(scan);
    }
}

/* After the queries, answered or not, starts scanning; this holds until a stop. */
static void end_questions(void)
{
    if (is_asking) {
        is_asking = false;
        (void)tmini_start(&lidar);
    }
}

static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_INFO:
        report_info(tmini_info(&lidar));
        (void)tmini_request_health(&lidar);
        break;
    case TMINI_EVENT_HEALTH:
        report_health(tmini_health(&lidar));
        end_questions();
        break;
    case TMINI_EVENT_FREQUENCY:
        report_frequency(tmini_frequency_chz(&lidar));
        break;
    case TMINI_EVENT_STARTED:
        report_word("started");
        break;
    case TMINI_EVENT_SCAN:
        see(tmini_scan(&lidar));
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        report_faults(tmini_faults(&lidar));
        break;
    case TMINI_EVENT_LOST:
        report_word("lost");
        break;
    case TMINI_EVENT_RECOVERED:
        report_word("recovered");
        break;
    case TMINI_EVENT_STOPPED:
        report_word("stopped");
        report_counters(&lidar, &port);
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        report_failure(tmini_command_error(&lidar));
        end_questions();
        break;
    default:
        break;
    }
}

static void obey(char key)
{
    switch (key) {
    case 's':
        is_asking = false;
        obstacle_blind(&obstacle);
        (void)tmini_stop(&lidar);
        break;
    case 'g':
        is_asking = false;
        (void)tmini_start(&lidar);
        break;
    case 'c':
        report_counters(&lidar, &port);
        break;
    case 'd':
        says_digests = !says_digests;
        break;
    default:
        break;
    }
}

static void drive(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    status.may_move = obstacle_may_move(&obstacle, board_time_ms);
    board_enable_drive(status.may_move);
}

static void say_status(void)
{
    static uint32_t said_ms;
    if (board_time_ms - said_ms < STATUS_MS) {
        return;
    }
    said_ms += STATUS_MS;
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    status.worst_cycles = worst_cycles;
    worst_cycles = 0;
    report_status(&counters, &obstacle, &status);
}

static void start_lidar(void)
{
    const tmini_config_t config = {
        .port = &tmini_stm32_usart_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .rx_dma = reception_wiring.remaining != NULL,
        .points = points,
        .max_points = sizeof points / sizeof points[0],
        .frequency_chz = FREQUENCY_CHZ,
    };
    if (tmini_stm32_usart_init(&port, &reception_wiring) != TMINI_OK ||
        tmini_init(&lidar, &config) != TMINI_OK ||
        reception_start(&port, &lidar, rx, sizeof rx) != TMINI_OK) {
        report_word("wrong configuration");
        return;
    }
    board_enable_lidar_interrupt();
    (void)tmini_request_info(&lidar);
}

int main(void)
{
    board_start();
    report_start();
    start_lidar();
    for (;;) {
        const tmini_event_t event = tmini_poll(&lidar);
        handle(event);
        obey(console_key());
        drive();
        say_status();
        if (console_work() && event == TMINI_EVENT_NONE) {
            board_sleep();
        }
    }
}
