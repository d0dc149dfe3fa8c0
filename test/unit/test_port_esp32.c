/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ESP32 port over a mocked ESP-IDF: what it asks of the UART driver and in which order, what it
 * makes of each event, and what it leaves behind when something fails or ends. */

#include <string.h>

#include "unity.h"

#include "encoder.h"
#include "tmini_esp32.h"

#include "mock_esp_timer.h"
#include "mock_queue.h"
#include "mock_task.h"
#include "mock_uart.h"

/* Any address will do: nobody looks behind it. */
static int queue_memory;
#define QUEUE ((QueueHandle_t)&queue_memory)

static int64_t now_us;
static uint8_t ring[512];
static tmini_t lidar;
static tmini_esp32_t board;
static tmini_esp32_config_t config;

static const uint8_t *waiting; /* What the UART driver holds. */
static size_t waiting_count;

static TaskFunction_t task;
static void *task_argument;

/* ----------------------------------------------------------------------------- stand-ins, helpers */

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
    const size_t count = waiting_count < length ? waiting_count : length;
    if (count == 0) {
        return 0; /* Nothing may be held, at no address. */
    }
    memcpy(buffer, waiting, count);
    waiting += count;
    waiting_count -= count;
    return (int)count;
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
    .source_clk = UART_SCLK_DEFAULT,
};

static void expect_install(esp_err_t result)
{
    static QueueHandle_t queue = QUEUE;
    uart_driver_install_ExpectAndReturn(UART_NUM_1, 2048, 0, 32, NULL, 0, result);
    uart_driver_install_IgnoreArg_queue();
    uart_driver_install_ReturnThruPtr_queue(&queue);
}

static void expect_param_config(esp_err_t result)
{
    uart_param_config_ExpectAndReturn(UART_NUM_1, &line_8n1_at_230400, result);
}

static void expect_set_pin(esp_err_t result)
{
    uart_set_pin_ExpectAndReturn(UART_NUM_1, 5, 4, UART_PIN_NO_CHANGE, UART_PIN_NO_CHANGE, result);
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
}

static void open_without_task(void)
{
    config.with_task = false;
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

/* The receiving task itself runs only when a test calls it. */
static void open_with_task(void)
{
    expect_uart_set_up();
    xTaskCreatePinnedToCore_Stub(keep_task);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

static void expect_event_in_queue(uart_event_type_t type, size_t size, UBaseType_t spaces)
{
    static uart_event_t event;
    event = (uart_event_t){.type = type, .size = size};
    uxQueueSpacesAvailable_ExpectAndReturn(QUEUE, spaces);
    xQueueReceive_ExpectAndReturn(QUEUE, NULL, 7, pdTRUE);
    xQueueReceive_IgnoreArg_buffer();
    xQueueReceive_ReturnMemThruPtr_buffer(&event, sizeof event);
}

static void expect_no_event(UBaseType_t spaces)
{
    uxQueueSpacesAvailable_ExpectAndReturn(QUEUE, spaces);
    xQueueReceive_ExpectAndReturn(QUEUE, NULL, 7, pdFALSE);
    xQueueReceive_IgnoreArg_buffer();
}

static size_t receive_event(uart_event_type_t type)
{
    expect_event_in_queue(type, 0, 31);
    return tmini_esp32_receive(&board, 7);
}

static tmini_esp32_counters_t counters_after(uart_event_type_t type)
{
    tmini_esp32_counters_t counters;
    open_without_task();
    receive_event(type);
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
    now_us = 0;
    esp_timer_get_time_Stub(tell_time);
    uart_read_bytes_Stub(read_waiting);
    hold(NULL, 0);
    memset(&board, 0, sizeof board);
    config = (tmini_esp32_config_t)TMINI_ESP32_CONFIG_DEFAULT;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &lidar_config));
}

void tearDown(void) {}

/* ------------------------------------------------------------------------------------------ opening */

void test_opening_sets_up_the_uart_and_then_starts_a_task_on_any_core(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

void test_the_task_can_be_pinned_to_a_core(void)
{
    config.task_core = 1;
    expect_uart_set_up();
    expect_task(1, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

void test_without_a_task_none_is_created(void)
{
    config.with_task = false;
    config.task_stack_bytes = 0; /* Does not matter then. */
    expect_uart_set_up();
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

void test_a_uart_that_is_taken_is_left_alone(void)
{
    expect_install(ESP_FAIL);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_open(&board, &config, &lidar));
}

void test_a_refused_line_setting_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_FAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_open(&board, &config, &lidar));
}

void test_a_refused_pin_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_FAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_open(&board, &config, &lidar));
}

void test_a_refused_threshold_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, &config, &lidar));
}

void test_a_refused_timeout_removes_the_driver(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_OK);
    expect_set_pin(ESP_OK);
    expect_threshold(ESP_OK);
    expect_timeout(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, &config, &lidar));
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
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_open(&board, &config, &lidar));
}

void test_without_memory_for_the_task_the_driver_is_removed(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdFAIL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, tmini_esp32_open(&board, &config, &lidar));
}

void test_the_first_error_is_reported_when_removing_the_driver_fails_too(void)
{
    expect_install(ESP_OK);
    expect_param_config(ESP_ERR_INVALID_ARG);
    expect_delete(ESP_FAIL);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, &config, &lidar));
}

void test_after_a_failure_opening_can_be_tried_again(void)
{
    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdFAIL);
    expect_delete(ESP_OK);
    tmini_esp32_open(&board, &config, &lidar);

    expect_uart_set_up();
    expect_task(tskNO_AFFINITY, pdPASS);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_open(&board, &config, &lidar));
}

void test_opening_twice_is_refused(void)
{
    open_without_task();
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_open(&board, &config, &lidar));
}

void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(NULL, &config, &lidar));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, NULL, &lidar));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, &config, NULL));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_close(NULL));
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_receive(NULL, 7));
}

static void assert_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_open(&board, &config, &lidar));
    config = (tmini_esp32_config_t)TMINI_ESP32_CONFIG_DEFAULT;
}

void test_values_out_of_range_are_refused_before_anything_is_touched(void)
{
    config.uart = -1;
    assert_refused();
    config.tx_pin = -1;
    assert_refused();
    config.rx_pin = -1;
    assert_refused();
    config.buffer_size = 128;
    assert_refused();
    config.queue_length = 0;
    assert_refused();
    config.fifo_threshold = 0;
    assert_refused();
    config.fifo_threshold = 127;
    assert_refused();
    config.timeout_symbols = 0;
    assert_refused();
    config.timeout_symbols = 101;
    assert_refused();
    config.task_stack_bytes = 0;
    assert_refused();
    config.task_priority = -1;
    assert_refused();
    config.task_core = -2;
    assert_refused();
}

/* ---------------------------------------------------------------------------------------- receiving */

void test_a_data_event_hands_its_bytes_to_the_lidar(void)
{
    static const uint8_t bytes[] = {0x11, 0x22, 0x33};
    open_without_task();
    hold(bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT(3, receive_event(UART_DATA));
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_HEX8(0x11, tmini_ring_peek(&lidar.ring, 0));
    TEST_ASSERT_EQUAL_HEX8(0x22, tmini_ring_peek(&lidar.ring, 1));
    TEST_ASSERT_EQUAL_HEX8(0x33, tmini_ring_peek(&lidar.ring, 2));
}

void test_more_bytes_than_the_event_named_are_read_too(void)
{
    static const uint8_t bytes[300];
    open_without_task();
    hold(bytes, sizeof bytes);
    expect_event_in_queue(UART_DATA, 64, 31);
    TEST_ASSERT_EQUAL_UINT(300, tmini_esp32_receive(&board, 7));
    TEST_ASSERT_EQUAL_UINT(0, waiting_count);
}

void test_bytes_whose_event_was_lost_are_read_when_the_wait_is_over(void)
{
    static const uint8_t bytes[5];
    open_without_task();
    hold(bytes, sizeof bytes);
    expect_no_event(32);
    TEST_ASSERT_EQUAL_UINT(5, tmini_esp32_receive(&board, 7));
}

void test_received_bytes_are_counted(void)
{
    static const uint8_t bytes[130];
    tmini_esp32_counters_t counters;
    open_without_task();
    hold(bytes, 130);
    receive_event(UART_DATA);
    hold(bytes, 20);
    receive_event(UART_DATA);
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(150, counters.bytes);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
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
    open_without_task();
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        receive_event(types[i]);
    }
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
}

void test_a_full_queue_is_counted_and_costs_no_bytes(void)
{
    static const uint8_t bytes[200];
    tmini_esp32_counters_t counters;
    open_without_task();
    hold(bytes, sizeof bytes);
    expect_event_in_queue(UART_DATA, 64, 0);
    TEST_ASSERT_EQUAL_UINT(200, tmini_esp32_receive(&board, 7));
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.queues_full);
}

void test_trouble_does_not_throw_away_what_the_driver_holds(void)
{
    static const uart_event_type_t troubles[] = {UART_FIFO_OVF, UART_BUFFER_FULL, UART_BREAK,
                                                 UART_FRAME_ERR, UART_PARITY_ERR};
    static const uint8_t bytes[10];
    open_without_task();
    for (size_t i = 0; i < sizeof troubles / sizeof troubles[0]; i++) {
        hold(bytes, sizeof bytes);
        TEST_ASSERT_EQUAL_UINT(10, receive_event(troubles[i]));
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
    open_without_task();
    hold(stream, 20);
    receive_event(UART_FIFO_OVF);
    hold(&stream[40], 24);
    receive_event(UART_DATA);

    now_us = 1000 * 1000; /* Long silence: nothing more will come. */
    tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(2, counters.parser.packets);
    TEST_ASSERT_EQUAL_UINT32(32, counters.parser.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT32(12, counters.parser.bytes_skipped);
}

void test_when_the_lidar_is_not_polled_its_ring_refuses_and_counts(void)
{
    static const uint8_t bytes[600];
    open_without_task();
    hold(bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT(600, receive_event(UART_DATA));
    TEST_ASSERT_EQUAL_UINT(512, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(88, tmini_ring_refused(&lidar.ring));
}

void test_a_driver_that_fails_to_read_ends_the_call(void)
{
    open_without_task();
    uart_read_bytes_Stub(NULL);
    uxQueueSpacesAvailable_ExpectAndReturn(QUEUE, 31);
    xQueueReceive_ExpectAndReturn(QUEUE, NULL, 7, pdFALSE);
    xQueueReceive_IgnoreArg_buffer();
    uart_read_bytes_ExpectAndReturn(UART_NUM_1, NULL, 128, 0, -1);
    uart_read_bytes_IgnoreArg_buffer();
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_receive(&board, 7));
}

void test_with_a_task_the_caller_receives_nothing_itself(void)
{
    open_with_task();
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_receive(&board, 7));
}

/* -------------------------------------------------------------------------------- task and closing */

static uart_event_type_t script[4];
static size_t script_length;

/* The scripted events, one a call, each with three bytes; with the last one, closing begins. */
static BaseType_t play_script(QueueHandle_t queue, void *buffer, TickType_t ticks, int calls)
{
    static const uint8_t bytes[3];
    TEST_ASSERT_EQUAL_PTR(QUEUE, queue);
    TEST_ASSERT_EQUAL_UINT32(2, ticks); /* 20 ms */
    TEST_ASSERT_TRUE((size_t)calls < script_length);
    *(uart_event_t *)buffer = (uart_event_t){.type = script[calls]};
    hold(bytes, sizeof bytes);
    if ((size_t)calls + 1 == script_length) {
        board.stopping = true; /* As tmini_esp32_close() does on the other core. */
    }
    return pdTRUE;
}

static UBaseType_t tell_spaces(const QueueHandle_t queue, int calls)
{
    (void)queue;
    (void)calls;
    return 31;
}

void test_the_task_receives_until_closing_begins_and_then_ends_itself(void)
{
    tmini_esp32_counters_t counters;
    open_with_task();
    script[0] = UART_DATA;
    script[1] = UART_FIFO_OVF;
    script[2] = UART_DATA;
    script_length = 3;
    uxQueueSpacesAvailable_Stub(tell_spaces);
    xQueueReceive_Stub(play_script);
    vTaskDelete_Expect(NULL);
    task(task_argument);
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(9, counters.bytes);
    TEST_ASSERT_EQUAL_UINT32(1, counters.fifo_overflows);
    TEST_ASSERT_EQUAL_UINT(9, tmini_ring_unread(&lidar.ring));
}

void test_closing_waits_for_the_task_to_end_before_it_removes_the_driver(void)
{
    open_with_task();
    vTaskDelay_AddCallback(run_task_meanwhile);
    vTaskDelay_Expect(1);
    vTaskDelete_Expect(NULL);
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_close(&board));
}

void test_closing_without_a_task_removes_the_driver_at_once(void)
{
    open_without_task();
    expect_delete(ESP_OK);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_close(&board));
}

void test_a_driver_that_cannot_be_removed_is_reported(void)
{
    open_without_task();
    expect_delete(ESP_FAIL);
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, tmini_esp32_close(&board));
}

void test_closing_what_is_not_open_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_close(&board));
}

void test_closing_twice_is_refused(void)
{
    open_without_task();
    expect_delete(ESP_OK);
    tmini_esp32_close(&board);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_close(&board));
}

void test_opened_again_it_counts_anew(void)
{
    tmini_esp32_counters_t counters;
    open_without_task();
    receive_event(UART_BREAK);
    expect_delete(ESP_OK);
    tmini_esp32_close(&board);
    open_without_task();
    tmini_esp32_counters(&board, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, sum_of_troubles(&counters));
}

/* ------------------------------------------------------------------------------------------ the port */

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
    open_without_task();
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

void test_writing_when_closed_fails(void)
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
    open_with_task();
    vTaskDelay_Expect(1);
    tmini_esp32_port.wait(&board);
}

void test_waiting_without_a_task_receives_meanwhile(void)
{
    static const uint8_t bytes[4];
    open_without_task();
    hold(bytes, sizeof bytes);
    uxQueueSpacesAvailable_ExpectAndReturn(QUEUE, 32);
    xQueueReceive_ExpectAndReturn(QUEUE, NULL, 1, pdFALSE);
    xQueueReceive_IgnoreArg_buffer();
    tmini_esp32_port.wait(&board);
    TEST_ASSERT_EQUAL_UINT(4, tmini_ring_unread(&lidar.ring));
}

void test_waiting_when_closed_still_passes_time(void)
{
    vTaskDelay_Expect(1);
    tmini_esp32_port.wait(&board);
}
