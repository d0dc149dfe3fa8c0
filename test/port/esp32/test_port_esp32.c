/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the ESP32 port's calls of ESP-IDF and their order, its reaction to each event, and its
 * clean-up after a failure or a stop. Each table is a list of test cases. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "console.h"
#include "idf.h"
#include "tmini_esp32.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

#ifdef CONFIG_IDF_TARGET_ESP32
#define UARTS 3
#define TX "27"
#define RX "26"
#define LOOK "1 " /* 20 ms in ticks of 25 ms: at least one tick, else it would not wait. */
#else
#define UARTS 2
#define TX "19"
#define RX "18"
#define LOOK "2 " /* 20 ms in ticks of 10 ms. */
#endif

#define RING 512u

static uint8_t ring[RING];
static tmini_t lidar;
static tmini_esp32_t port;
static tmini_esp32_wiring_t wiring;

static const char *const *waits; /* The story to play at each wait of the receiving task. */
static void (*on_wait)(void);    /* Called at each wait for an event; may be NULL. */
static void (*on_delay)(void);   /* Called while a task sleeps; may be NULL. */
static TaskFunction_t task;
static void *task_argument;

/* -------------------------------------------------------------------------------------- helpers */

void idf_wait(TickType_t ticks, bool for_event)
{
    void (*const happens)(void) = for_event ? on_wait : on_delay;
    (void)ticks;
    if (happens != NULL) {
        happens();
    }
}

void idf_begin_task(TaskFunction_t function, void *argument)
{
    task = function;
    task_argument = argument;
}

void idf_end_task(void) {}

static void set_up(void)
{
    const tmini_config_t config = {.port = &tmini_esp32_port,
                                   .port_context = &port,
                                   .rx_buffer = ring,
                                   .rx_size = sizeof ring};
    idf_begin(NULL);
    idf.records = true;
    on_wait = on_delay = NULL;
    memset(&port, 0, sizeof port);
    wiring = (tmini_esp32_wiring_t)TMINI_ESP32_WIRING_DEFAULT;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
}

void setUp(void)
{
    set_up();
}

static void assert_calls(const char *expected)
{
    TEST_ASSERT_EQUAL_STRING(expected, idf.calls);
    idf.calls[0] = 0;
}

static esp_err_t start(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&port, &wiring));
    return tmini_esp32_start(&port, &lidar);
}

/* Runs the receiving task while tmini_esp32_stop() waits for its end. */
static void run_task(void)
{
    if (port.stopping && port.receiving) {
        task(task_argument);
    }
}

static void start_well(bool with_task)
{
    on_delay = run_task;
    wiring.with_task = with_task;
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
    idf.calls[0] = 0;
}

static tmini_esp32_counters_t counted(void)
{
    tmini_esp32_counters_t counters;
    tmini_esp32_counters(&port, &counters);
    return counters;
}

/* --------------------------------------------------------------------------- starting, stopping */

#define LOCK "create acquire "
#define INSTALL LOCK "install(1,2048,0,64,0) "
#define LINE INSTALL "line(1,230400) "
#define PINS LINE "reset(" RX ") pins(1," TX "," RX ") "
#define PULL_UP PINS "pull-up(" RX ") " /* Only after the pin has been routed. */
#define THRESHOLD PULL_UP "threshold(1,64) "
#define TIMEOUT THRESHOLD "timeout(1,4) "
#define UART TIMEOUT "interrupts(1,8) " /* Bit 3: framing errors. */
#define TASK UART "task(tmini,3072,12,-1) "
#define UNLOCK "release forget "
#define REMOVE "remove(1) " UNLOCK

static const struct {
    const char *fails;
    esp_err_t failure;
    const char *calls;
    esp_err_t result;
} starts[] = {
    {"nothing", ESP_OK, TASK, ESP_OK},
    /* Every call fails. Without power management, "create" fails like this, and there is no lock to
     * give back. */
    {"", ESP_ERR_NOT_SUPPORTED, "create install(1,2048,0,64,0) ", ESP_ERR_NOT_SUPPORTED},
    {"create", ESP_ERR_NO_MEM, "create ", ESP_ERR_NO_MEM},
    {"acquire", ESP_FAIL, LOCK "forget ", ESP_FAIL},
    {"install", ESP_FAIL, INSTALL UNLOCK, ESP_FAIL}, /* A driver of others is not removed. */
    {"line", ESP_FAIL, LINE REMOVE, ESP_FAIL},
    {"pins", ESP_FAIL, PINS REMOVE, ESP_FAIL},
    {"pull-up", ESP_ERR_INVALID_ARG, TASK, ESP_OK}, /* An ESP32's pins 34 to 39 have none. */
    {"reset", ESP_FAIL, TASK, ESP_OK},
    {"threshold", ESP_ERR_INVALID_ARG, THRESHOLD REMOVE, ESP_ERR_INVALID_ARG},
    {"timeout", ESP_ERR_INVALID_ARG, TIMEOUT REMOVE, ESP_ERR_INVALID_ARG},
    {"interrupts", ESP_FAIL, UART REMOVE, ESP_FAIL},
    {"task", ESP_FAIL, TASK REMOVE, ESP_ERR_NO_MEM},
};

/* What is reported is the first error. */
void test_starting_sets_everything_up_in_order_or_leaves_nothing(void)
{
    for (size_t i = 0; i < COUNT(starts); i++) {
        set_up();
        idf.failing = starts[i].fails;
        idf.failure = starts[i].failure;
        TEST_ASSERT_EQUAL_INT_MESSAGE(starts[i].result, start(), idf.failing);
        assert_calls(starts[i].calls);
        idf.failing = NULL;
        TEST_ASSERT_EQUAL_INT_MESSAGE(starts[i].result == ESP_OK ? ESP_ERR_INVALID_STATE : ESP_OK,
                                      tmini_esp32_start(&port, &lidar), starts[i].fails);
    }
}

void test_the_task_can_be_pinned_to_a_core_or_left_out(void)
{
    wiring.task_core = CORES - 1;
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
    TEST_ASSERT_NOT_NULL(
        strstr(idf.calls, CORES == 2 ? "task(tmini,3072,12,1)" : "task(tmini,3072,12,0)"));
    set_up();
    wiring.with_task = false;
    wiring.task_stack_bytes = 0; /* Not checked if there is no task. */
    TEST_ASSERT_EQUAL_INT(ESP_OK, start());
    assert_calls(UART);
}

void test_stopping_ends_the_task_then_removes_the_driver_and_gives_the_lock_back_once(void)
{
    for (unsigned with_task = 0; with_task < 2; with_task++) {
        set_up();
        start_well(with_task == 1);
        idf.failing = "remove";
        idf.failure = with_task == 1 ? ESP_OK : ESP_FAIL;
        TEST_ASSERT_EQUAL_INT(idf.failure, tmini_esp32_stop(&port));
        assert_calls(with_task == 1 ? "delay(1) end " REMOVE : REMOVE);
        TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(&port));
        idf.failing = "create";
        idf.failure = ESP_ERR_NO_MEM;
        TEST_ASSERT_EQUAL_INT(ESP_ERR_NO_MEM, tmini_esp32_start(&port, &lidar));
        assert_calls("create ");
    }
}

void test_what_was_never_set_up_and_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(&port));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_stop(NULL));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(NULL, &wiring));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(&port, NULL));
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_start(NULL, &lidar));
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_start(&port, NULL));
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(NULL, 7));
    assert_calls("delay(7) ");
}

/* --------------------------------------------------------------------------------------- wiring */

#define NO_LIMIT 99999

/* Each member's lowest and highest valid value, and its name in the log if it is invalid. */
static const struct {
    int *member;
    int least;
    int most;
    const char *name;
} ranges[] = {
    {&wiring.uart, 0, UARTS - 1, "uart"}, /* One of the chips also has a low-power UART. */
    {&wiring.tx_pin, 0, NO_LIMIT, "menuconfig"},
    {&wiring.rx_pin, 0, NO_LIMIT, "menuconfig"},
    {&wiring.buffer_size, 129, NO_LIMIT, "buffer_size"},
    {&wiring.queue_length, 4, NO_LIMIT, "queue_length"},
    {&wiring.fifo_threshold, 1, 126, "fifo_threshold"},
    {&wiring.timeout_symbols, 1, 100, "timeout_symbols"},
    {&wiring.task_stack_bytes, 1, NO_LIMIT, "task_stack_bytes"},
    {&wiring.task_priority, 0, configMAX_PRIORITIES - 1, "task_priority"},
    {&wiring.task_core, TMINI_ESP32_ANY_CORE, CORES - 1, "task_core"},
};

static void assert_taken(int *member, int value)
{
    *member = value;
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_init(&port, &wiring));
    TEST_ASSERT_EQUAL_STRING("", console_text());
}

static void assert_refused(int *member, int value, const char *name)
{
    *member = value;
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_ARG, tmini_esp32_init(&port, &wiring));
    assert_said("E tmini: ");
    assert_said(name);
    TEST_ASSERT_EQUAL_INT(ESP_ERR_INVALID_STATE, tmini_esp32_start(&port, &lidar));
}

void test_values_out_of_range_are_refused_by_name_before_anything_is_touched(void)
{
    for (size_t i = 0; i < COUNT(ranges); i++) {
        set_up();
        assert_taken(ranges[i].member, ranges[i].least);
        assert_taken(ranges[i].member, ranges[i].most);
        assert_refused(ranges[i].member, ranges[i].least - 1, ranges[i].name);
        if (ranges[i].most != NO_LIMIT) {
            assert_refused(ranges[i].member, ranges[i].most + 1, ranges[i].name);
        }
        if (i >= 7) { /* Without a task, its settings are not checked. */
            console_begin();
            wiring.with_task = false;
            assert_taken(ranges[i].member, ranges[i].least - 1);
        }
        assert_calls("");
    }
}

/* ------------------------------------------------------------------------------------ receiving */

static void receive(size_t expected, bool gap)
{
    const size_t before = tmini_ring_unread(&lidar.ring);
    TEST_ASSERT_EQUAL_UINT(expected, tmini_esp32_wait(&port, 7));
    TEST_ASSERT_EQUAL_UINT(0, idf.queue_count);
    TEST_ASSERT_EQUAL_UINT(before + expected, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(gap ? 0 : RING - before - expected, tmini_feed_room(&lidar));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&lidar.ring));
    if (gap) {
        tmini_poll(&lidar);
    }
}

static void hold(size_t count)
{
    idf.buffer_count = count;
    memset(idf.buffer, 0x11, count);
}

static void start_again(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&port));
    tmini_poll(&lidar);
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_start(&port, &lidar));
}

static void act(char what, size_t number, bool gap)
{
    static const char letters[] = "DKBOFPxy"; /* One letter per value of uart_event_type_t. */
    switch (what) {
    case 'H': /* The driver now holds this many bytes. */
        hold(number);
        break;
    case '>': /* The port must receive this many bytes; with !, a gap follows them. */
        receive(number, gap);
        break;
    case 'h': /* The port must have reported this many held bytes. */
        TEST_ASSERT_EQUAL_UINT(number, lidar.held_to - tmini_ring_head(&lidar.ring));
        break;
    case 'p':
        tmini_poll(&lidar);
        break;
    case 'Q':
        idf.queue_size = number;
        break;
    case 'S':
        start_again();
        break;
    case 'R':
        tmini_esp32_port.restart(&port);
        break;
    case 'E': /* The driver fails to read. */
        idf.failing = "read";
        break;
    case 'X': /* tmini_esp32_stop() does this on the other core. */
        port.stopping = true;
        break;
    default: /* An event with its size. */
        idf_post((uart_event_type_t)(strchr(letters, what) - letters), number);
        break;
    }
}

static void play(const char *story)
{
    while (*story != 0) {
        char *end;
        const char what = *story++;
        const size_t number = strtoul(story, &end, 10);
        act(what, number, *end == '!');
        story = end + strspn(end, "! ");
    }
}

static void play_next(void)
{
    TEST_ASSERT_NOT_NULL(*waits);
    play(*waits++);
}

/* A story is a list of actions: act(). The counters are overruns, buffers full, queues full,
 * breaks, framing errors and parity errors. */
static const struct {
    const char *story;
    const char *counters;
} stories[] = {
    {"H1 D1 >1", "0 0 0 0 0 0"},
    {"H300 D64 >300", "0 0 0 0 0 0"}, /* More bytes than the event announced. */
    {"H5 >5", "0 0 0 0 0 0"},         /* The event was lost. */
    {"x y D0 >0", "0 0 0 0 0 0"},
    {"E H5 D5 >0", "0 0 0 0 0 0"},
    /* Errors are counted, but no byte is discarded. */
    {"H10 D10 O >10!", "1 0 0 0 0 0"},
    {"H10 D10 B >10", "0 1 0 0 0 0"},
    {"H10 D10 K >10", "0 0 0 1 0 0"},
    {"H10 D10 F >10", "0 0 0 0 1 0"},
    {"H10 D10 P >10", "0 0 0 0 0 1"},
    /* A gap is after all bytes announced before it, and after those that the driver has stashed. */
    {"H178 D128 O D50 >128! >50", "1 0 0 0 0 0"},
    {"H260 D120 B128 O D12 >248! >12", "1 1 0 0 0 0"},
    {"O >0! >0", "1 0 0 0 0 0"},
    /* Bytes that were read before they were announced are not expected again. */
    {"H100 >100 p H30 D100 O D30 >0! >30", "1 0 0 0 0 0"},
    /* Only data events announce bytes: ESP-IDF may leave a size in other events. */
    {"H50 D20 F20 O20 D30 >20! >30", "1 0 0 0 1 0"},
    /* The ring is full before the gap is reached: the gap is reported later. */
    {"H600 D560 O D40 >512 h48 p >48! >40 h0", "1 0 0 0 0 0"},
    /* Each gap costs a poll: gaps at the same place become one, and so do all after the first. */
    {"H50 D20 O O D30 >20! >30", "2 0 0 0 0 0"},
    {"H100 D20 O D30 O D40 O D10 >20! >80! >0", "3 0 0 0 0 0"},
    /* Bytes that were announced but are not in the driver are forgotten. */
    {"H5 D20 O >5! H30 D10 O D20 >10! >20", "2 0 0 0 0 0"},
    {"H9 D10 >9 p H30 D10 O D20 >10!", "1 0 0 0 0 0"},
    /* A full queue may have lost an overflow: a gap is assumed after all bytes in the driver. */
    {"Q4 H200 D10 D10 D10 D10 >200! >0", "0 0 1 0 0 0"},
    {"Q5 H30 D10 D10 D10 >30", "0 0 0 0 0 0"},
    {"Q4 H200 D10 D10 D10 D10 >200! H50 D20 O D30 Q64 >20! >30", "1 0 1 0 0 0"},
    {"Q4 H200 D20 O D30 D30 >20! >180! >0", "1 0 1 0 0 0"},
    {"Q4 H2316 D10 D10 D10 D10 >512 p >512 p >512 p >512 p >168! >100", "0 0 1 0 0 0"},
    /* Bytes that do not fit in the ring stay in the driver until a poll has made room. */
    {"H600 D >512 h88 D >0 h88 p D >88 h0", "0 0 0 0 0 0"},
    /* After stop and start, gaps that were not yet reported are gone, and counters are 0. */
    {"H600 D600 O >512 S H100 D30 >100 p H100 D70 D40 O >40!", "1 0 0 0 0 0"},
    {"K H600 D560 O D40 O >512 S H100 D30 >100 p H100 D70 D40 O >40!", "1 0 0 0 0 0"},
    /* Gaps not yet reported are also gone after a restart, whatever the driver holds. */
    {"H600 D560 O D40 O >512 H100 R p >0! H100 D70 D40 O >100! >0", "3 0 0 0 0 0"},
};

void test_every_byte_is_handed_on_and_every_gap_is_reported_in_its_place(void)
{
    for (size_t i = 0; i < COUNT(stories); i++) {
        char counters[64];
        set_up();
        start_well(false);
        UNITY_SET_DETAIL(stories[i].story);
        play(stories[i].story);
        const tmini_esp32_counters_t c = counted();
        (void)snprintf(counters, sizeof counters, "%u %u %u %u %u %u", (unsigned)c.overruns,
                       (unsigned)c.buffers_full, (unsigned)c.queues_full, (unsigned)c.breaks,
                       (unsigned)c.framing_errors, (unsigned)c.parity_errors);
        TEST_ASSERT_EQUAL_STRING(stories[i].counters, counters);
        UNITY_CLR_DETAILS();
    }
}

static void tap(void *context, const uint8_t *bytes, size_t count)
{
    char *const heard = context;
    (void)snprintf(heard + strlen(heard), 16, "%u%s ", (unsigned)count, bytes == NULL ? "!" : "");
}

void test_a_tap_gets_every_byte_and_is_told_of_each_gap(void)
{
    char heard[100] = "";
    start_well(false);
    tmini_esp32_tap(&port, tap, heard);
    play("H178 D128 O D50 >128! >50");
    TEST_ASSERT_EQUAL_STRING("128 0! 50 ", heard);
    play("H100 R p >0! H100 D70 D40 O >100! >0");
    TEST_ASSERT_EQUAL_STRING("128 0! 50 0! 100 0! ", heard);
    tmini_esp32_tap(&port, NULL, NULL);
    play("p H20 D20 O >20!");
    TEST_ASSERT_EQUAL_STRING("128 0! 50 0! 100 0! ", heard);
}

void test_a_restart_sets_the_line_up_again_and_switches_reception_on(void)
{
    start_well(false);
    play("H50 R >0!");
    assert_calls("line(1,230400) reset(" RX ") pins(1," TX "," RX ") pull-up(" RX
                 ") threshold(1,64) "
                 "timeout(1,4) interrupts(1,8) flush(1) receive(1) 7 ");
    play(">0");
    assert_calls("7 ");
    TEST_ASSERT_EQUAL_INT(ESP_OK, tmini_esp32_stop(&port));
    play("R"); /* A restart of a stopped port does nothing. */
    start_well(false);
    play(">0");
    assert_calls("7 ");
}

/* What happens in each wait of the receiving task (a story), and how many ticks it waits. */
static const struct {
    const char *events[4];
    const char *calls;
    size_t unread;
} tasks[] = {
    {{"H3 D3", "H3 K", "H3 D3 X"}, LOOK LOOK LOOK "end ", 9},
    {{"H511 D", "", "X"}, LOOK LOOK LOOK "end ", 511}, /* The ring has room for one byte. */
    {{"H512 D", "", "X"}, LOOK "1 1 end ", 512},       /* The ring is full. */
    {{"H600 D", "p", "X"}, LOOK "1 " LOOK "end ", 88},
};

void test_the_task_receives_until_it_is_stopped_and_checks_a_full_ring_each_tick(void)
{
    for (size_t i = 0; i < COUNT(tasks); i++) {
        set_up();
        start_well(true);
        waits = tasks[i].events;
        on_wait = play_next;
        task(task_argument);
        assert_calls(tasks[i].calls);
        TEST_ASSERT_EQUAL_UINT(tasks[i].unread, tmini_ring_unread(&lidar.ring));
        TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&lidar.ring));
    }
}

/* ------------------------------------------------------------------------------------- the port */

void test_commands_go_to_the_transmit_fifo_as_far_as_it_has_room(void)
{
    static const uint8_t stop[] = {0xA5, 0x65};
    TEST_ASSERT_EQUAL_INT(-1, tmini_esp32_port.write(&port, stop, 2)); /* Not started. */
    start_well(false);
    TEST_ASSERT_EQUAL_INT(2, tmini_esp32_port.write(&port, stop, 2));
    assert_calls("send(1,A5,65) ");
    idf.failing = "send";
    idf.failure = 1;
    TEST_ASSERT_EQUAL_INT(1, tmini_esp32_port.write(&port, stop, 2));
}

void test_the_clock_counts_milliseconds_modulo_2_to_32(void)
{
    machine.now_us = 1999;
    TEST_ASSERT_EQUAL_UINT32(1, tmini_esp32_port.now_ms(&port));
    machine.now_us = (INT64_C(4294967296) + 5) * 1000;
    TEST_ASSERT_EQUAL_UINT32(5, tmini_esp32_port.now_ms(&port));
}

void test_waiting_receives_but_with_a_task_or_stopped_it_sleeps(void)
{
    tmini_esp32_port.wait(&port);
    assert_calls("delay(1) ");
    start_well(true);
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(&port, 0));
    TEST_ASSERT_EQUAL_UINT(0, tmini_esp32_wait(&port, 7));
    tmini_esp32_port.wait(&port);
    assert_calls("delay(1) delay(7) delay(1) ");
    set_up();
    start_well(false);
    hold(4);
    tmini_esp32_port.wait(&port);
    assert_calls("1 ");
    TEST_ASSERT_EQUAL_UINT(4, tmini_ring_unread(&lidar.ring));
}
