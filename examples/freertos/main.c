/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop under FreeRTOS: one task polls the lidar, asks for its information, scans, and
 * writes a line per second to the console: whether a robot may move. Everything is allocated
 * statically. */

#include "FreeRTOS.h"
#include "task.h"

#include "board.h"
#include "lidar_log.h"
#include "obstacle.h"
#include "tmini_freertos.h"

#define LIDAR_TASK_PRIORITY 1
#define RECEIVING_TASK_PRIORITY 2
#define LIDAR_TASK_STACK_WORDS 384

/* The longest sleep: the console's line must not be late. */
#define LOOK_MS 100u

#if LIDAR_BY_STREAM
static uint8_t stream[1024];
#define STREAM stream
#define STREAM_SIZE sizeof stream
static uint8_t rx[512];
#else
#define STREAM NULL
#define STREAM_SIZE 0
static uint8_t rx[1024];
#endif

static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_freertos_t port;
static obstacle_t obstacle;
static lidar_log_t console = {.lidar = &lidar, .print = board_print};

static StaticTask_t lidar_task_memory;
static StackType_t lidar_task_stack[LIDAR_TASK_STACK_WORDS];

void UART1_Handler(void)
{
    uint8_t bytes[16];
    int overrun = 0;
    BaseType_t woken = pdFALSE;
    const size_t count = board_lidar_read(bytes, sizeof bytes, &overrun);
    if (overrun) {
        tmini_freertos_gap_from_isr(&port);
    }
    tmini_freertos_receive_from_isr(&port, bytes, count, &woken);
    portYIELD_FROM_ISR(woken);
}

static uint32_t now_ms(void)
{
    return tmini_freertos_port.now_ms(&port);
}

/* Without a scanning lidar, or with a faulty one, the way ahead is unknown. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, now_ms());
}

static void report_each_second(void)
{
    tmini_freertos_counters_t uart;
    if (lidar_log_is_due(&console, now_ms())) {
        tmini_freertos_counters(&port, &uart);
        lidar_log_status(&console, obstacle.sectors[0].nearest_mm, must_stop(), uart.bytes,
                         uart.bytes_lost + uart.overruns);
    }
}

static void sleep_until_due(void)
{
    const uint32_t due_ms = tmini_next_poll_ms(&lidar);
    tmini_freertos_sleep(&port, due_ms < LOOK_MS ? due_ms : LOOK_MS);
}

static bool start_lidar(void)
{
    const tmini_freertos_wiring_t wiring = {
        .write = board_lidar_write,
        .stream = STREAM,
        .stream_size = STREAM_SIZE,
        .priority = RECEIVING_TASK_PRIORITY,
    };
    const tmini_config_t config = {
        .port = &tmini_freertos_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    if (tmini_freertos_init(&port, &wiring) != TMINI_OK ||
        tmini_init(&lidar, &config) != TMINI_OK ||
        tmini_freertos_start(&port, &lidar) != TMINI_OK) {
        return false;
    }
    board_enable_lidar_interrupt();
    (void)tmini_request_info(&lidar);
    return tmini_start(&lidar) == TMINI_OK; /* Begins after the answer, and holds until
                                             * tmini_stop(). */
}

static void run_lidar(void *argument)
{
    (void)argument;
    if (!start_lidar()) {
        board_print("the configuration is wrong\n");
        vTaskSuspend(NULL);
    }
    for (;;) {
        const tmini_event_t event = tmini_poll(&lidar);
        lidar_log_event(&console, event);
        if (event == TMINI_EVENT_SCAN) {
            obstacle_see(&obstacle, tmini_scan(&lidar));
        } else if (event == TMINI_EVENT_NONE) {
            report_each_second();
            sleep_until_due();
        }
    }
}

/* The kernel calls this while no task has work. */
void vApplicationIdleHook(void)
{
    board_sleep();
}

void vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    board_print("stack overflow: ");
    board_print(name);
    board_print("\n");
    configASSERT(false);
}

int main(void)
{
    board_start();
    (void)xTaskCreateStatic(run_lidar, "lidar", LIDAR_TASK_STACK_WORDS, NULL, LIDAR_TASK_PRIORITY,
                            lidar_task_stack, &lidar_task_memory);
    vTaskStartScheduler();
    return 0;
}
