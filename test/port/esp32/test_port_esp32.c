/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ESP32 port over a mocked ESP-IDF: what it asks of the UART driver and in which order, what it
 * makes of each event, and what it leaves behind when something fails or ends. */

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "encoder.h"
#include "esp_log.h"
#include "tmini_esp32.h"

#include "mock_esp_pm.h"
#include "mock_esp_timer.h"
#include "mock_gpio.h"
#include "mock_queue.h"
#include "mock_task.h"
#include "mock_uart.h"

/* The same tests for two chips that differ in what a port must know of: sdkconfig.h. */
#ifdef CONFIG_IDF_TARGET_ESP32
#define UARTS 3
#define CORES 2
#define STEADY_CLOCK UART_SCLK_APB
#define STEADY_LOCK ESP_PM_APB_FREQ_MAX
#define LOOK_TICKS 1u /* 20 ms of ticks of 25 ms: the least that is a wait at all. */
#else
#define UARTS 2
#define CORES 1
#define STEADY_CLOCK UART_SCLK_XTAL
#define STEADY_LOCK ESP_PM_NO_LIGHT_SLEEP
#define LOOK_TICKS 2u /* 20 ms of ticks of 10 ms. */
#endif

/* Any address will do: nobody looks behind it. */
static int queue_memory;
static int lock_memory;
#define QUEUE ((QueueHandle_t)&queue_memory)
#define LOCK ((esp_pm_lock_handle_t)&lock_memory)

static char logged[128];

static int64_t now_us;
static uint8_t ring[512];
static tmini_t lidar;
static tmini_esp32_t board;
static tmini_esp32_config_t config;

static const uint8_t *waiting; /* What the UART driver holds. */
static size_t waiting_count;

static TaskFunction_t task;
static void *task_argument;

/* --------------------------------------------------------------------------- stand-ins, helpers */

void esp_log_line(char level, const char *tag, const char *format, ...)
{
    char text[96];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)snprintf(logged, sizeof logged, "%c %s: %s", level, tag, text);
}

static int64_t tell_time(int calls)
{
    (void)calls;
    return now_us;
}

/* Gives out what the driver holds, as ESP-IDF does when told not to wait. */
static int read_waiting(uart_port_t uart, void *buffer, uint32_t length, TickType_t ticks,
                        int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    TEST_ASSERT_EQUAL_UINT32(0, ticks);
    TEST_ASSERT_NOT_EQUAL_UINT32(0, length);
    const size_t count = waiting_count < length ? waiting_count : length;
    if (count == 0) {
        return 0; /* Nothing may be held, at no address. */
    }
    memcpy(buffer, waiting, count);
    waiting += count;
    waiting_count -= count;
    return (int)count;
}

static uart_event_t events[8];
static size_t event_count;
static size_t queue_length;
static TickType_t next_wait;

static void post(uart_event_type_t type, size_t size)
{
    TEST_ASSERT_TRUE(event_count < sizeof events / sizeof events[0]);
    events[event_count++] = (uart_event_t){.type = type, .size = size};
}

/* Waits, if at all, for the first event only. */
static BaseType_t give_event(QueueHandle_t handle, void *buffer, TickType_t ticks, int calls)
{
    static const uart_event_t untouched;
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(QUEUE, handle);
    TEST_ASSERT_EQUAL_UINT32(next_wait, ticks);
    next_wait = 0;
    if (event_count == 0) {
        memcpy(buffer, &untouched, sizeof untouched);
        return pdFALSE;
    }
    memcpy(buffer, &events[0], sizeof events[0]);
    event_count--;
    memmove(&events[0], &events[1], event_count * sizeof events[0]);
    return pdTRUE;
}

static UBaseType_t tell_spaces(const QueueHandle_t handle, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(QUEUE, handle);
    return (UBaseType_t)(queue_length - event_count);
}

static BaseType_t keep_task(TaskFunction_t function, const char *name, uint32_t stack_depth,
                            void *argument, UBaseType_t priority, TaskHandle_t *handle,
                            BaseType_t core, int calls)
{
    (void)name;
    (void)stack_depth;
    (void)priority;
    (void)handle;
    (void)core;
    (void)calls;
    task = function;
    task_argument = argument;
    return pdPASS;
}

/* While one task sleeps, the other one runs. */
static void run_task_meanwhile(TickType_t ticks, int calls)
{
    (void)ticks;
    (void)calls;
    task(task_argument);
}

static void hold(const uint8_t *bytes, size_t count)
{
    waiting = bytes;
    waiting_count = count;
}

static const uart_config_t line_8n1_at_230400 = {
    .baud_rate = 230400,
    .data_bits = UART_DATA_8_BITS,
    .parity = UART_PARITY_DISABLE,
    .stop_bits = UART_STOP_BITS_1,
    .flow_ctrl = UART_HW_FLOWCTRL_DISABLE,
    .source_clk = STEADY_CLOCK,
};

static void expect_lock(void)
{
    static esp_pm_lock_handle_t lock = LOCK;
    esp_pm_lock_create_ExpectAndReturn(STEADY_LOCK, 0, "tmini", NULL, ESP_OK);
    esp_pm_lock_create_IgnoreArg_lock();
    esp_pm_lock_create_ReturnThruPtr_lock(&lock);
    esp_pm_lock_acquire_ExpectAndReturn(LOCK, ESP_OK);
}

static void expect_unlock(void)
{
    esp_pm_lock_release_ExpectAndReturn(LOCK, ESP_OK);
    esp_pm_lock_delete_ExpectAndReturn(LOCK, ESP_OK);
}

/* The lock is there before the baud rate's divider is worked out. */
static void expect_install(esp_err_t result)
{
    static QueueHandle_t queue = QUEUE;
    expect_lock();
    uart_driver_install_ExpectAndReturn(UART_NUM_1, 2048, 0, 64, NULL, 0, result);
    uart_driver_install_IgnoreArg_queue();
    uart_driver_install_ReturnThruPtr_queue(&queue);
}

static void expect_param_config(esp_err_t result)
{
    uart_param_config_ExpectAndReturn(UART_NUM_1, &line_8n1_at_230400, result);
}

static void expect_set_pin(esp_err_t result)
{
    gpio_reset_pin_ExpectAndReturn(CONFIG_TMINI_ESP32_RX_PIN, ESP_OK); /* An output before? */
    uart_set_pin_ExpectAndReturn(UART_NUM_1, CONFIG_TMINI_ESP32_TX_PIN, CONFIG_TMINI_ESP32_RX_PIN,
                                 UART_PIN_NO_CHANGE, UART_PIN_NO_CHANGE, result);
    if (result == ESP_OK) {
        gpio_pullup_en_ExpectAndReturn(CONFIG_TMINI_ESP32_RX_PIN, ESP_OK);
    }
}

static void expect_threshold(esp_err_t result)
{
    uart_set_rx_full_threshold_ExpectAndReturn(UART_NUM_1, 64, result);
}

static void expect_timeout(esp_err_t result)
{
    uart_set_rx_timeout_ExpectAndReturn(UART_NUM_1, 4, result);
}

/* Bit 3 of the UART's interrupt registers. */
static void expect_frame_error_interrupt(esp_err_t result)
{
    uart_enable_intr_mask_ExpectAndReturn(UART_NUM_1, 8, result);
}

static void expect_uart_set_up(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_OK);
    expect_frame_error_interrupt(ESP_OK);
}

static void expect_task(BaseType_t core, BaseType_t result)
{
    xTaskCreatePinnedToCore_ExpectAndReturn(NULL, "tmini", 3072, &board, 12, NULL, core, result);
    xTaskCreatePinnedToCore_IgnoreArg_function();
}

static void expect_delete(esp_err_t result)
{
    uart_driver_delete_ExpectAndReturn(UART_NUM_1, result);
    expect_unlock();
}

/* With the configuration as it is by now. */
static esp_err_t start(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&board, &config));
    return tmini_esp32_start(&board, &lidar);
}

static void start_without_task(void)
{
    config.with_task = false;
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

/* The receiving task itself runs only when a test calls it. */
static void start_with_task(void)
{
    expect_uart_set_up();
    xTaskCreatePinnedToCore_Stub(keep_task);
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

/* Takes all events that have been posted. */
static size_t receive(void)
{
    xQueueReceive_Stub(give_event);
    next_wait = 7;
    const size_t received = tmini_esp32_wait(&board, 7);
    TEST_ASSERT_EQUAL_UINT32(0, next_wait);
    TEST_ASSERT_EQUAL_UINT(0, event_count);
    return received;
}

static size_t receive_event(uart_event_type_t type, size_t size)
{
    post(type, size);
    return receive();
}

/* A gap closes the lidar's ring until the poll has emptied it. */
static void assert_gap_behind(size_t count, size_t received)
{
    TEST_ASSERT_EQUAL_UINT(count, received);
    TEST_ASSERT_EQUAL_UINT(count, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar));
    tmini_poll(&lidar);
}

static void assert_no_gap_behind(size_t count, size_t received)
{
    TEST_ASSERT_EQUAL_UINT(count, received);
    TEST_ASSERT_EQUAL_UINT(sizeof ring - count, tmini_feed_room(&lidar));
}

static tmini_esp32_counters_t counters_after(uart_event_type_t type)
{
    tmini_esp32_counters_t counters;
    start_without_task();
    receive_event(type, 0);
    tmini_esp32_counters(&board, &counters);
    return counters;
}

static uint32_t sum_of_troubles(const tmini_esp32_counters_t *counters)
{
    return counters->fifo_overflows + counters->buffers_full + counters->queues_full +
           counters->breaks + counters->frame_errors + counters->parity_errors;
}

void setUp(void)
{
    const tmini_config_t lidar_config = {
        .port = &tmini_esp32_port,
        .port_context = &board,
        .rx_buffer = ring,
        .rx_size = sizeof ring,
    };
    logged[0] = 0;
    event_count = 0;
    queue_length = 64;
    now_us = 0;
    esp_timer_get_time_Stub(tell_time);
    uart_read_bytes_Stub(read_waiting);
    uxQueueSpacesAvailable_Stub(tell_spaces);
    hold(NULL, 0);
    memset(&board, 0, sizeof board);
    config = (tmini_esp32_config_t)TMINI_ESP32_CONFIG_DEFAULT;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &lidar_config));
}

void tearDown(void) {}

/* ------------------------------------------------------------------------------------- starting */

void test_starting_sets_up_the_uart_and_then_starts_a_task_on_any_core(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

void test_the_task_can_be_pinned_to_a_core(void)
{
    config.task_core = CORES - 1;
    expect_uart_set_up();
    expect_task(CORES - 1, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

void test_without_a_task_none_is_created(void)
{
    config.with_task = false;
    config.task_stack_bytes = 0; /* Does not matter then. */
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

void test_the_receive_pin_is_pulled_up_once_it_is_routed(void)
{
    expect_uart_set_up(); /* In this order: routing a pin may switch its pull-up off. */
    expect_task(tskNO_AFFINITY, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

void test_a_receive_pin_without_a_pull_up_is_taken_all_the_same(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    gpio_reset_pin_ExpectAndReturn(34, ESP_OK);
    uart_set_pin_ExpectAndReturn(UART_NUM_1, CONFIG_TMINI_ESP32_TX_PIN, 34, UART_PIN_NO_CHANGE,
                                 UART_PIN_NO_CHANGE, ESP_OK);
    gpio_pullup_en_ExpectAndReturn(34, ESP_ERR_INVALID_ARG);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_OK);
    expect_frame_error_interrupt(ESP_OK);
    config.rx_pin = 34;
    config.with_task = false;
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
}

void test_the_clock_is_held_from_start_to_stop(void)
{
    start_without_task(); /* Takes the lock, first of all. */
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
}

void test_without_power_management_no_lock_is_needed(void)
{
    static QueueHandle_t queue = QUEUE;
    esp_pm_lock_create_ExpectAndReturn(STEADY_LOCK, 0, "tmini", NULL, ESP_ERR_NOT_SUPPORTED);
    esp_pm_lock_create_IgnoreArg_lock();
    uart_driver_install_ExpectAndReturn(UART_NUM_1, 2048, 0, 64, NULL, 0, ESP_OK);
    uart_driver_install_IgnoreArg_queue();
    uart_driver_install_ReturnThruPtr_queue(&queue);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_OK);
    expect_frame_error_interrupt(ESP_OK);
    config.with_task = false;
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
    uart_driver_delete_ExpectAndReturn(UART_NUM_1, ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
}

void test_without_memory_for_the_lock_nothing_is_begun(void)
{
    esp_pm_lock_create_ExpectAndReturn(STEADY_LOCK, 0, "tmini", NULL, ESP_ERR_NO_MEM);
    esp_pm_lock_create_IgnoreArg_lock();
    TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, start());
}

void test_a_lock_that_cannot_be_taken_is_given_back(void)
{
    static esp_pm_lock_handle_t lock = LOCK;
    esp_pm_lock_create_ExpectAndReturn(STEADY_LOCK, 0, "tmini", NULL, ESP_OK);
    esp_pm_lock_create_IgnoreArg_lock();
    esp_pm_lock_create_ReturnThruPtr_lock(&lock);
    esp_pm_lock_acquire_ExpectAndReturn(LOCK, ESP_FAIL);
    esp_pm_lock_delete_ExpectAndReturn(LOCK, ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, start());
}

void test_a_uart_that_is_taken_is_left_alone(void)
{
    expect_install(ESP_FAIL);
    expect_unlock();
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, start());
}

void test_a_refused_line_setting_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_FAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, start());
}

void test_a_refused_pin_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_FAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, start());
}

void test_a_refused_threshold_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, start());
}

void test_a_refused_timeout_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, start());
}

void test_a_refused_interrupt_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_OK);
    expect_frame_error_interrupt(ESP_FAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, start());
}

void test_without_memory_for_the_task_the_driver_is_removed(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdFAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, start());
}

void test_the_first_error_is_reported_when_removing_the_driver_fails_too(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_FAIL);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, start());
}

void test_after_a_failure_it_can_be_started_again(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdFAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, start());

    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_start(&board, &lidar));
}

void test_starting_twice_is_refused(void)
{
    start_without_task();
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_start(&board, &lidar));
}

void test_starting_what_was_never_set_up_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_start(&board, &lidar));
}

void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(NULL, &config));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(&board, NULL));
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&board, &config));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_start(NULL, &lidar));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_start(&board, NULL));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(NULL));
    vTaskDelay_Expect(7);
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(NULL, 7));
}

/* -------------------------------------------------------------------------------- configuration */

/* In the log, by its name; and there is no starting over it. */
static void assert_refused(const char *by_name)
{
    logged[0] = 0;
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(&board, &config));
    if (strstr(logged, "E tmini: ") == NULL || strstr(logged, by_name) == NULL) {
        TEST_FAIL_MESSAGE(logged);
    }
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_start(&board, &lidar));
    config = (tmini_esp32_config_t)TMINI_ESP32_CONFIG_DEFAULT;
}

static void assert_accepted(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&board, &config));
    TEST_ASSERT_EQUAL_STRING("", logged);
}

void test_values_out_of_range_are_refused_before_anything_is_touched(void)
{
    config.buffer_size = 128;
    assert_refused("buffer_size");
    config.queue_length = 3;
    assert_refused("queue_length");
    config.fifo_threshold = 0;
    assert_refused("fifo_threshold");
    config.fifo_threshold = 127;
    assert_refused("fifo_threshold");
    config.timeout_symbols = 0;
    assert_refused("timeout_symbols");
    config.timeout_symbols = 101;
    assert_refused("timeout_symbols");
    config.task_stack_bytes = 0;
    assert_refused("task_stack_bytes");
}

void test_the_ends_of_each_range_are_accepted(void)
{
    config.uart = UARTS - 1;
    config.tx_pin = 0;
    config.buffer_size = 129;
    config.queue_length = 4;
    config.fifo_threshold = 1;
    config.timeout_symbols = 1;
    config.task_stack_bytes = 1;
    config.task_priority = 0;
    config.task_core = CORES - 1;
    assert_accepted();
    config.uart = 0;
    config.rx_pin = 0;
    config.fifo_threshold = 126;
    config.timeout_symbols = 100;
    config.task_priority = configMAX_PRIORITIES - 1;
    config.task_core = TMINI_ESP32_ANY_CORE;
    assert_accepted();
}

void test_a_uart_that_the_chip_does_not_have_is_refused(void)
{
    config.uart = -1;
    assert_refused("uart");
    config.uart = UARTS; /* On one of the chips, the low-power one. */
    assert_refused("uart");
}

void test_pins_that_nobody_has_chosen_are_refused_with_a_hint(void)
{
    config.tx_pin = -1;
    assert_refused("menuconfig");
    config.rx_pin = -1;
    assert_refused("menuconfig");
}

void test_a_priority_that_freertos_does_not_have_is_refused(void)
{
    config.task_priority = -1;
    assert_refused("task_priority");
    config.task_priority = 25;
    assert_refused("task_priority");
}

void test_a_core_that_freertos_does_not_run_on_is_refused(void)
{
    config.task_core = -2;
    assert_refused("task_core");
    config.task_core = CORES;
    assert_refused("task_core");
}

void test_without_a_task_what_it_would_be_like_does_not_matter(void)
{
    config.with_task = false;
    config.task_priority = 99;
    config.task_core = 7;
    config.task_stack_bytes = 0;
    assert_accepted();
}

/* ------------------------------------------------------------------------------------ receiving */

void test_a_data_event_hands_its_bytes_to_the_lidar(void)
{
    static const uint8_t bytes[] = {0x11, 0x22, 0x33};
    start_without_task();
    hold(bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT(3, receive_event(UART_DATA, 3));
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_HEX8(0x11, tmini_ring_peek(&lidar.ring, 0));
    TEST_ASSERT_EQUAL_HEX8(0x22, tmini_ring_peek(&lidar.ring, 1));
    TEST_ASSERT_EQUAL_HEX8(0x33, tmini_ring_peek(&lidar.ring, 2));
}

void test_a_single_byte_is_handed_on(void)
{
    static const uint8_t byte = 0x11;
    start_without_task();
    hold(&byte, 1);
    assert_no_gap_behind(1, receive_event(UART_DATA, 1));
}

void test_more_bytes_than_the_event_named_are_read_too(void)
{
    static const uint8_t bytes[300];
    start_without_task();
    hold(bytes, sizeof bytes);
    assert_no_gap_behind(300, receive_event(UART_DATA, 64));
    TEST_ASSERT_EQUAL_UINT(0, waiting_count);
}

void test_bytes_whose_event_was_lost_are_read_when_the_wait_is_over(void)
{
    static const uint8_t bytes[5];
    start_without_task();
    hold(bytes, sizeof bytes);
    assert_no_gap_behind(5, receive());
}

void test_received_bytes_are_counted(void)
{
    static const uint8_t bytes[130];
    tmini_esp32_counters_t counters;
    start_without_task();
    hold(bytes, 130);
    receive_event(UART_DATA, 130);
    hold(bytes, 20);
    receive_event(UART_DATA, 20);
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(150, counters.bytes);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
}

void test_all_events_that_wait_are_counted_at_once(void)
{
    tmini_esp32_counters_t counters;
    start_without_task();
    post(UART_BREAK, 0);
    post(UART_FRAME_ERR, 0);
    post(UART_FRAME_ERR, 0);
    receive();
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.breaks);
    TEST_ASSERT_EQUAL_UINT32(2, counters.frame_errors);
}

void test_a_fifo_overflow_is_counted(void)
{
    const tmini_esp32_counters_t counters = counters_after(UART_FIFO_OVF);
    TEST_ASSERT_EQUAL_UINT32(1, counters.fifo_overflows);
    TEST_ASSERT_EQUAL_UINT32(1, sum_of_troubles(&counters));
}

void test_a_full_buffer_is_counted(void)
{
    const tmini_esp32_counters_t counters = counters_after(UART_BUFFER_FULL);
    TEST_ASSERT_EQUAL_UINT32(1, counters.buffers_full);
    TEST_ASSERT_EQUAL_UINT32(1, sum_of_troubles(&counters));
}

void test_a_break_is_counted(void)
{
    const tmini_esp32_counters_t counters = counters_after(UART_BREAK);
    TEST_ASSERT_EQUAL_UINT32(1, counters.breaks);
    TEST_ASSERT_EQUAL_UINT32(1, sum_of_troubles(&counters));
}

void test_a_frame_error_is_counted(void)
{
    const tmini_esp32_counters_t counters = counters_after(UART_FRAME_ERR);
    TEST_ASSERT_EQUAL_UINT32(1, counters.frame_errors);
    TEST_ASSERT_EQUAL_UINT32(1, sum_of_troubles(&counters));
}

void test_a_parity_error_is_counted(void)
{
    const tmini_esp32_counters_t counters = counters_after(UART_PARITY_ERR);
    TEST_ASSERT_EQUAL_UINT32(1, counters.parity_errors);
    TEST_ASSERT_EQUAL_UINT32(1, sum_of_troubles(&counters));
}

void test_other_events_are_no_trouble(void)
{
    static const uart_event_type_t types[] = {UART_DATA_BREAK, UART_PATTERN_DET, UART_EVENT_MAX};
    tmini_esp32_counters_t counters;
    start_without_task();
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        receive_event(types[i], 0);
    }
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
}

void test_trouble_does_not_throw_away_what_the_driver_holds(void)
{
    static const uart_event_type_t troubles[] = {UART_FIFO_OVF, UART_BUFFER_FULL, UART_BREAK,
                                                 UART_FRAME_ERR, UART_PARITY_ERR};
    static const uint8_t bytes[10];
    start_without_task();
    for (size_t i = 0; i < sizeof troubles / sizeof troubles[0]; i++) {
        hold(bytes, sizeof bytes);
        post(UART_DATA, sizeof bytes);
        TEST_ASSERT_EQUAL_UINT(10, receive_event(troubles[i], 0));
        tmini_poll(&lidar);
    }
}

/* A packet of two samples; its number is the first one's distance. */
static size_t make_packet(uint8_t *out, uint16_t number)
{
    const encode_sample_t samples[2] = {{.distance_mm = number}, {.distance_mm = 9}};
    const encode_packet_t packet = {.lsn = 2, .first_q6 = 640, .last_q6 = 704, .samples = samples};
    return encode_packet(out, &packet);
}

void test_after_an_overflow_the_packets_beside_the_hole_are_all_there(void)
{
    uint8_t stream[4 * ENCODE_PACKET_MAX];
    tmini_counters_t counters;
    size_t size = 0;
    for (uint16_t number = 1; number <= 4; number++) {
        size += make_packet(&stream[size], number);
    }
    /* 16 bytes a packet. Bytes 20 to 39 are lost: most of the second packet, half of the third. */
    TEST_ASSERT_EQUAL_UINT(64, size);
    start_without_task();
    hold(stream, 20);
    post(UART_DATA, 20);
    receive_event(UART_FIFO_OVF, 0);
    tmini_poll(&lidar);
    hold(&stream[40], 24);
    receive_event(UART_DATA, 24);

    now_us = 1000 * 1000; /* Long silence: nothing more will come. */
    tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(2, counters.packets);
    TEST_ASSERT_EQUAL_UINT32(32, counters.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT32(12, counters.bytes_skipped);
}

void test_an_overflow_is_a_gap_between_what_was_announced_before_it_and_after_it(void)
{
    static const uint8_t bytes[178];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 128);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 50);
    assert_gap_behind(128, receive());
    assert_no_gap_behind(50, receive());
}

void test_what_the_driver_has_put_aside_is_before_the_gap(void)
{
    static const uint8_t bytes[260];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 120);
    post(UART_BUFFER_FULL, 128);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 12);
    assert_gap_behind(248, receive());
    assert_no_gap_behind(12, receive());
}

void test_an_overflow_of_an_empty_driver_is_a_gap_at_once(void)
{
    start_without_task();
    assert_gap_behind(0, receive_event(UART_FIFO_OVF, 0));
    assert_no_gap_behind(0, receive());
}

/* As it happens when the driver has stored bytes, and posts their event after they were read. */
void test_bytes_that_were_read_before_they_were_announced_are_not_expected_again(void)
{
    static const uint8_t bytes[130];
    start_without_task();
    hold(bytes, 100);
    TEST_ASSERT_EQUAL_UINT(100, receive());
    tmini_poll(&lidar);
    hold(bytes, 30);
    post(UART_DATA, 100);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 30);
    assert_gap_behind(0, receive());
    assert_no_gap_behind(30, receive());
}

/* The size of any other event is none: ESP-IDF may leave there what an earlier one had. */
void test_only_events_of_bytes_announce_bytes(void)
{
    static const uint8_t bytes[50];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 20);
    post(UART_FRAME_ERR, 20);
    post(UART_FIFO_OVF, 20);
    post(UART_DATA, 30);
    assert_gap_behind(20, receive());
    assert_no_gap_behind(30, receive());
}

void test_a_gap_that_the_ring_has_no_room_to_reach_is_not_forgotten(void)
{
    static const uint8_t bytes[600];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 560);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 40);
    TEST_ASSERT_EQUAL_UINT(512, receive());
    tmini_poll(&lidar);
    assert_gap_behind(48, receive());
    assert_no_gap_behind(40, receive());
}

void test_two_overflows_at_one_place_are_one_gap(void)
{
    static const uint8_t bytes[50];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 20);
    post(UART_FIFO_OVF, 0);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 30);
    assert_gap_behind(20, receive());
    assert_no_gap_behind(30, receive());
}

void test_overflows_behind_the_first_one_are_one_gap_behind_everything(void)
{
    static const uint8_t bytes[100];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 20);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 30);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 40);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 10);
    assert_gap_behind(20, receive());
    assert_gap_behind(80, receive());
    assert_no_gap_behind(0, receive());
}

/* What was announced is then all there was, and the next overflow is where it is. */
void test_a_driver_that_holds_less_than_it_announced_does_not_keep_the_gap(void)
{
    static const uint8_t bytes[30];
    start_without_task();
    hold(bytes, 5);
    post(UART_DATA, 20);
    assert_gap_behind(5, receive_event(UART_FIFO_OVF, 0));
    hold(bytes, sizeof bytes);
    post(UART_DATA, 10);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 20);
    assert_gap_behind(10, receive());
    assert_no_gap_behind(20, receive());
}

void test_one_byte_too_many_that_was_announced_is_forgotten(void)
{
    static const uint8_t bytes[30];
    start_without_task();
    hold(bytes, 9);
    TEST_ASSERT_EQUAL_UINT(9, receive_event(UART_DATA, 10));
    tmini_poll(&lidar);
    hold(bytes, sizeof bytes);
    post(UART_DATA, 10);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 20);
    assert_gap_behind(10, receive());
}

/* Four events in a queue of four: a fifth may have been lost, and may have been an overflow's. */
static void lose_events(void)
{
    start_without_task();
    queue_length = 4;
    post(UART_DATA, 10);
    post(UART_DATA, 10);
    post(UART_DATA, 10);
    post(UART_DATA, 10);
}

void test_a_full_queue_is_counted_and_is_a_gap_behind_everything(void)
{
    static const uint8_t bytes[200];
    tmini_esp32_counters_t counters;
    lose_events();
    hold(bytes, sizeof bytes);
    assert_gap_behind(200, receive());
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.queues_full);
    assert_no_gap_behind(0, receive());
}

void test_a_queue_with_room_left_is_neither(void)
{
    static const uint8_t bytes[30];
    tmini_esp32_counters_t counters;
    start_without_task();
    queue_length = 5;
    hold(bytes, sizeof bytes);
    post(UART_DATA, 10);
    post(UART_DATA, 10);
    post(UART_DATA, 10);
    assert_no_gap_behind(30, receive());
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.queues_full);
}

void test_after_a_full_queue_the_next_overflow_is_where_it_is(void)
{
    static const uint8_t bytes[200];
    lose_events();
    hold(bytes, sizeof bytes);
    assert_gap_behind(200, receive());
    hold(bytes, 50);
    post(UART_DATA, 20);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 30);
    queue_length = 64;
    assert_gap_behind(20, receive());
    assert_no_gap_behind(30, receive());
}

void test_an_overflow_in_a_full_queue_is_told_of_where_it_was_and_the_unknown_one_behind_all(void)
{
    static const uint8_t bytes[200];
    start_without_task();
    queue_length = 4;
    hold(bytes, sizeof bytes);
    post(UART_DATA, 20);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 30);
    post(UART_DATA, 30);
    assert_gap_behind(20, receive());
    assert_gap_behind(180, receive());
    assert_no_gap_behind(0, receive());
}

/* A buffer of 2048 bytes and a FIFO: the gap is not behind bytes that no one has seen yet. */
void test_a_gap_at_an_unknown_place_is_within_what_the_driver_can_hold(void)
{
    static const uint8_t bytes[2048 + 128 + 40 + 100];
    size_t total = 0;
    lose_events();
    hold(bytes, sizeof bytes);
    for (size_t received = receive(); received == sizeof ring; received = receive()) {
        total += received;
        tmini_poll(&lidar);
    }
    TEST_ASSERT_EQUAL_UINT(4 * 512, total);
    assert_gap_behind(2048 + 128 + 40 - 4 * 512, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(100, waiting_count);
}

void test_what_the_ring_has_no_room_for_stays_in_the_driver(void)
{
    static const uint8_t bytes[600];
    start_without_task();
    hold(bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT(512, receive_event(UART_DATA, 0));
    TEST_ASSERT_EQUAL_UINT(512, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(88, waiting_count);
}

void test_with_a_full_ring_the_driver_is_not_read_until_the_poll_has_made_room(void)
{
    static const uint8_t bytes[600];
    start_without_task();
    hold(bytes, sizeof bytes);
    (void)receive_event(UART_DATA, 0);
    TEST_ASSERT_EQUAL_UINT(0, receive_event(UART_DATA, 0));
    TEST_ASSERT_EQUAL_UINT(88, waiting_count);
    tmini_poll(&lidar); /* None of it is a packet. */
    TEST_ASSERT_EQUAL_UINT(88, receive_event(UART_DATA, 0));
    TEST_ASSERT_EQUAL_UINT(0, waiting_count);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&lidar.ring));
}

void test_a_driver_that_fails_to_read_ends_the_call(void)
{
    start_without_task();
    uart_read_bytes_Stub(NULL);
    uart_read_bytes_ExpectAndReturn(UART_NUM_1, NULL, 128, 0, -1);
    uart_read_bytes_IgnoreArg_buffer();
    TEST_ASSERT_EQUAL_UINT(0, receive());
}

void test_with_a_task_waiting_is_sleeping_for_a_tick_or_more(void)
{
    start_with_task();
    vTaskDelay_Expect(1);
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(&board, 0));
    vTaskDelay_Expect(7);
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(&board, 7));
}

/* ---------------------------------------------------------------------------- task and stopping */

static uart_event_type_t script[4];
static size_t script_length;
static size_t script_next;

static void begin_script(size_t length)
{
    script_length = length;
    script_next = 0;
}

/* The scripted events, one a wait, each with three bytes; with the last one, stopping begins. */
static BaseType_t play_script(QueueHandle_t handle, void *buffer, TickType_t ticks, int calls)
{
    static const uint8_t bytes[3];
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(QUEUE, handle);
    if (ticks == 0) {
        return pdFALSE; /* No other event waits. */
    }
    TEST_ASSERT_EQUAL_UINT32(LOOK_TICKS, ticks);
    TEST_ASSERT_TRUE(script_next < script_length);
    *(uart_event_t *)buffer = (uart_event_t){.type = script[script_next++], .size = 3};
    hold(bytes, sizeof bytes);
    if (script_next == script_length) {
        board.stopping = true; /* As tmini_esp32_stop() does on the other core. */
    }
    return pdTRUE;
}

void test_the_task_receives_until_stopping_begins_and_then_ends_itself(void)
{
    tmini_esp32_counters_t counters;
    start_with_task();
    script[0] = UART_DATA;
    script[1] = UART_BREAK;
    script[2] = UART_DATA;
    begin_script(3);
    xQueueReceive_Stub(play_script);
    vTaskDelete_Expect(NULL);
    task(task_argument);
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(9, counters.bytes);
    TEST_ASSERT_EQUAL_UINT32(1, counters.breaks);
    TEST_ASSERT_EQUAL_UINT(9, tmini_ring_unread(&lidar.ring));
}

static TickType_t waits[3];
static size_t waits_count;

static size_t held_at_first;

/* The first event fills the ring, the second finds it full; with the third, stopping begins. */
static BaseType_t fill_the_ring(QueueHandle_t handle, void *buffer, TickType_t ticks, int calls)
{
    static const uint8_t bytes[600];
    (void)handle;
    (void)calls;
    if (ticks == 0) {
        return pdFALSE;
    }
    TEST_ASSERT_TRUE(waits_count < 3);
    waits[waits_count++] = ticks;
    *(uart_event_t *)buffer = (uart_event_t){.type = UART_DATA};
    if (waits_count == 1) {
        hold(bytes, held_at_first);
    } else if (waits_count == 2) {
        tmini_poll(&lidar); /* On the other core. */
    } else {
        board.stopping = true;
    }
    return pdTRUE;
}

static void run_task_with(size_t held)
{
    start_with_task();
    held_at_first = held;
    waits_count = 0;
    xQueueReceive_Stub(fill_the_ring);
    vTaskDelete_Expect(NULL);
    task(task_argument);
}

void test_with_room_for_one_byte_the_task_waits_for_it(void)
{
    run_task_with(511);
    TEST_ASSERT_EQUAL_UINT32(LOOK_TICKS, waits[1]);
}

void test_with_a_full_ring_the_task_looks_each_tick(void)
{
    run_task_with(600);
    TEST_ASSERT_EQUAL_UINT32(LOOK_TICKS, waits[0]);
    TEST_ASSERT_EQUAL_UINT32(1, waits[1]);
    TEST_ASSERT_EQUAL_UINT32(LOOK_TICKS, waits[2]);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&lidar.ring));
}

void test_stopping_waits_for_the_task_to_end_before_it_removes_the_driver(void)
{
    start_with_task();
    vTaskDelay_AddCallback(run_task_meanwhile);
    vTaskDelay_Expect(1);
    vTaskDelete_Expect(NULL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
}

void test_stopping_without_a_task_removes_the_driver_at_once(void)
{
    start_without_task();
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
}

void test_a_driver_that_cannot_be_removed_is_reported(void)
{
    start_without_task();
    expect_delete(ESP_FAIL);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_stop(&board));
}

void test_stopping_what_is_not_started_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(&board));
}

void test_stopping_twice_is_refused(void)
{
    start_without_task();
    expect_delete(ESP_OK);
    tmini_esp32_stop(&board);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(&board));
}

void test_started_again_it_counts_anew(void)
{
    tmini_esp32_counters_t counters;
    start_without_task();
    receive_event(UART_BREAK, 0);
    expect_delete(ESP_OK);
    tmini_esp32_stop(&board);
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_start(&board, &lidar));
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
}

static void assert_begins_again_without_a_gap(void)
{
    static const uint8_t bytes[100];
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
    tmini_poll(&lidar);
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_start(&board, &lidar));
    hold(bytes, 100);
    post(UART_DATA, 30);
    assert_no_gap_behind(100, receive());
    tmini_poll(&lidar);
    hold(bytes, 100);
    post(UART_DATA, 70);
    post(UART_DATA, 40);
    post(UART_FIFO_OVF, 0);
    assert_gap_behind(40, receive());
}

void test_stopped_with_a_gap_ahead_it_begins_again_without_one(void)
{
    static const uint8_t bytes[600];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 600);
    TEST_ASSERT_EQUAL_UINT(512, receive_event(UART_FIFO_OVF, 0));
    assert_begins_again_without_a_gap();
}

void test_stopped_with_another_gap_behind_that_it_begins_again_without_either(void)
{
    static const uint8_t bytes[600];
    start_without_task();
    hold(bytes, sizeof bytes);
    post(UART_DATA, 560);
    post(UART_FIFO_OVF, 0);
    post(UART_DATA, 40);
    TEST_ASSERT_EQUAL_UINT(512, receive_event(UART_FIFO_OVF, 0));
    assert_begins_again_without_a_gap();
}

void test_started_again_the_task_receives_again(void)
{
    start_with_task();
    vTaskDelay_AddCallback(run_task_meanwhile);
    vTaskDelay_Expect(1);
    vTaskDelete_Expect(NULL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));

    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_start(&board, &lidar));
    script[0] = UART_DATA;
    begin_script(1);
    xQueueReceive_Stub(play_script);
    vTaskDelete_Expect(NULL);
    task(task_argument);
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_unread(&lidar.ring));
}

void test_a_lock_is_given_back_once(void)
{
    start_without_task();
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&board));
    esp_pm_lock_create_ExpectAndReturn(STEADY_LOCK, 0, "tmini", NULL, ESP_ERR_NO_MEM);
    esp_pm_lock_create_IgnoreArg_lock();
    TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, tmini_esp32_start(&board, &lidar));
}

/* ------------------------------------------------------------------------------------- the port */

static uint8_t sent[2];
static int sent_room;

/* CMock would take the buffer for a string. */
static int take_sent(uart_port_t uart, const char *buffer, uint32_t length, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    TEST_ASSERT_EQUAL_UINT32(2, length);
    memcpy(sent, buffer, (size_t)sent_room);
    return sent_room;
}

static int send_stop_with_room_for(int room)
{
    static const uint8_t stop[] = {0xA5, 0x65};
    memset(sent, 0, sizeof sent);
    sent_room = room;
    start_without_task();
    uart_tx_chars_Stub(take_sent);
    return tmini_esp32_port.write(&board, stop, sizeof stop);
}

void test_commands_go_to_the_transmit_fifo_without_waiting(void)
{
    TEST_ASSERT_EQUAL_INT(2, send_stop_with_room_for(2));
    TEST_ASSERT_EQUAL_HEX8(0xA5, sent[0]);
    TEST_ASSERT_EQUAL_HEX8(0x65, sent[1]);
}

void test_what_the_fifo_did_not_take_is_reported(void)
{
    TEST_ASSERT_EQUAL_INT(1, send_stop_with_room_for(1));
}

void test_writing_when_stopped_fails(void)
{
    static const uint8_t stop[] = {0xA5, 0x65};
    TEST_ASSERT_EQUAL_INT(-1, tmini_esp32_port.write(&board, stop, 2));
}

void test_the_clock_counts_milliseconds_modulo_2_to_32(void)
{
    now_us = 1999;
    TEST_ASSERT_EQUAL_UINT32(1, tmini_esp32_port.now_ms(&board));
    now_us = (INT64_C(4294967296) + 5) * 1000;
    TEST_ASSERT_EQUAL_UINT32(5, tmini_esp32_port.now_ms(&board));
}

void test_waiting_lets_other_tasks_run_for_a_tick(void)
{
    start_with_task();
    vTaskDelay_Expect(1);
    tmini_esp32_port.wait(&board);
}

void test_waiting_without_a_task_receives_meanwhile(void)
{
    static const uint8_t bytes[4];
    start_without_task();
    hold(bytes, sizeof bytes);
    xQueueReceive_Stub(give_event);
    next_wait = 1;
    tmini_esp32_port.wait(&board);
    TEST_ASSERT_EQUAL_UINT32(0, next_wait);
    TEST_ASSERT_EQUAL_UINT(4, tmini_ring_unread(&lidar.ring));
}

void test_waiting_when_stopped_still_passes_time(void)
{
    vTaskDelay_Expect(1);
    tmini_esp32_port.wait(&board);
}
