/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop under FreeRTOS: one task polls the lidar, asks it who it is, scans, and writes a
 * line a second to the console that says whether a robot may move. Everything is allocated
 * statically. */

#include "FreeRTOS.h"
#include "task.h"

#include "board.h"
#include "obstacle.h"
#include "tmini/tmini_names.h"
#include "tmini_freertos.h"

#define REPORT_MS 1000u
#define LIDAR_TASK_PRIORITY 1
#define RECEIVING_TASK_PRIORITY 2
#define LIDAR_TASK_STACK_WORDS 384

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
static tmini_freertos_t board;
static obstacle_t obstacle;
static uint32_t gaps;

static StaticTask_t lidar_task_memory;
static StackType_t lidar_task_stack[LIDAR_TASK_STACK_WORDS];

void UART1_Handler(void)
{
    uint8_t bytes[16];
    int overrun = 0;
    BaseType_t woken = pdFALSE;
    const size_t count = board_lidar_read(bytes, sizeof bytes, &overrun);
    if (overrun) {
        tmini_freertos_gap_from_isr(&board);
    }
    tmini_freertos_receive_from_isr(&board, bytes, count, &woken);
    portYIELD_FROM_ISR(woken);
}

static uint32_t now_ms(void)
{
    return xTaskGetTickCount() * (1000u / configTICK_RATE_HZ);
}

/* Without a scanning lidar, or with a faulty one, nothing can be known of what is in front. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, now_ms());
}

static void tell(const char *before, uint32_t number, const char *behind)
{
    board_print(before);
    board_print_number(number);
    board_print(behind);
}

static void tell_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    tell("model ", info->model, "");
    tell(", firmware ", info->firmware_major, "");
    tell(".", info->firmware_minor, "");
    tell(", hardware ", info->hardware, ", serial ");
    board_print(serial);
    board_print("\n");
}

static void tell_faults(uint8_t faults)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    board_print("faults: ");
    board_print(tmini_faults_text(faults, text, sizeof text));
    board_print("\n");
}

static void see(const tmini_scan_t *scan)
{
    obstacle_see(&obstacle, scan, now_ms());
    gaps += scan->gaps;
}

/* Information, then scanning; from the beginning when something fails. */
static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_INFO:
        tell_info(tmini_info(&lidar));
        (void)tmini_start(&lidar);
        break;
    case TMINI_EVENT_SCAN:
        see(tmini_scan(&lidar));
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        tell_faults(tmini_faults(&lidar));
        break;
    case TMINI_EVENT_LOST:
        board_print("lost; trying to get it back\n");
        break;
    case TMINI_EVENT_RECOVERED:
        board_print("back again\n");
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        board_print("no answer: ");
        board_print(tmini_status_name(tmini_command_error(&lidar)));
        board_print(". Wiring, 5 V?\n");
        (void)tmini_request_info(&lidar);
        break;
    default:
        break;
    }
}

static void report_each_second(void)
{
    static uint32_t reported_ms;
    tmini_counters_t counters;
    tmini_freertos_counters_t uart;
    if (now_ms() - reported_ms < REPORT_MS) {
        return;
    }
    reported_ms += REPORT_MS;
    tmini_counters(&lidar, &counters);
    tmini_freertos_counters(&board, &uart);
    tell("", counters.scans, " scans");
    tell(", nearest in front ", obstacle.sectors[0].nearest_mm,
         must_stop() ? " mm, STOP" : " mm, go");
    tell("; bytes ", uart.bytes, "");
    tell(", lost: ", counters.checksum_errors, " checksums");
    tell(", ", counters.bytes_overrun + uart.bytes_lost + uart.overruns, " bytes");
    tell(", ", gaps, " gaps\n");
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
        .port_context = &board,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    if (tmini_freertos_init(&board, &wiring) != TMINI_OK ||
        tmini_init(&lidar, &config) != TMINI_OK ||
        tmini_freertos_start(&board, &lidar) != TMINI_OK) {
        return false;
    }
    board_enable_lidar_interrupt();
    return tmini_request_info(&lidar) == TMINI_OK;
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
        handle(event);
        if (event == TMINI_EVENT_NONE) {
            report_each_second();
            tmini_freertos_wait(&board, pdMS_TO_TICKS(10));
        }
    }
}

/* The kernel's, while no task has anything to do. */
void vApplicationIdleHook(void)
{
    board_sleep();
}

/* The kernel's, when a task has used more stack than it has. */
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
