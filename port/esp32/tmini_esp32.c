/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_esp32.h"

#include "driver/gpio.h"
#include "esp_intr_alloc.h"
#include "esp_log.h"
#include "esp_timer.h"
#include "freertos/task.h"
#include "soc/uart_reg.h"

static const char *const TAG = "tmini";

/* The protocol's section 1. */
#define BAUD_RATE 230400

#define FIFO_SIZE 128

/* In a shorter queue a single waiting event would look like a full queue, and so like a loss. */
#define QUEUE_LENGTH_MIN 4

/* The tightest limits in the chip family, those of the ESP32 itself. */
#define FIFO_THRESHOLD_MAX 126
#define TIMEOUT_SYMBOLS_MAX 100

/* How long the receiving task waits for an event before it looks for bytes itself, because their
 * event may have been lost in a full queue. Stopping may take this long, too. At least one tick:
 * otherwise the task would never wait, and no task of lower priority would run. */
#define LOOK_MS 20
#define LOOK_TICKS (pdMS_TO_TICKS(LOOK_MS) > 0 ? pdMS_TO_TICKS(LOOK_MS) : 1)

/* Low-power UARTs, which have the highest numbers on some chips, do not count: their FIFOs have 16
 * bytes and their clocks are slow. */
#ifdef SOC_UART_HP_NUM
#define UARTS SOC_UART_HP_NUM
#else
#define UARTS UART_NUM_MAX
#endif

#ifdef CONFIG_FREERTOS_UNICORE
#define CORES 1
#else
#define CORES 2
#endif

/* Power management changes the clocks of CPU and buses, but not the crystal's. On the two oldest
 * chips a UART cannot use the crystal: there the APB has to keep its full speed. */
#if defined(CONFIG_IDF_TARGET_ESP32) || defined(CONFIG_IDF_TARGET_ESP32S2)
#define UART_CLOCK UART_SCLK_APB
#define PM_LOCK ESP_PM_APB_FREQ_MAX
#else
#define UART_CLOCK UART_SCLK_XTAL
#define PM_LOCK ESP_PM_NO_LIGHT_SLEEP
#endif

/* Must agree with where menuconfig puts the interrupt handler, or ESP-IDF warns. */
#ifdef CONFIG_UART_ISR_IN_IRAM
#define INTERRUPT_FLAGS ESP_INTR_FLAG_IRAM
#else
#define INTERRUPT_FLAGS 0
#endif

/* ------------------------------------------------------------------- shared between two tasks */

/* One access, and a barrier for the chips with two cores: for __atomic_store_n() Clang would call a
 * library on those without atomic instructions (ESP32-C3). */

static void store(bool *flag, bool value)
{
    __atomic_thread_fence(__ATOMIC_RELEASE);
    *(volatile bool *)flag = value;
}

static bool load(const bool *flag)
{
    const bool loaded = *(const volatile bool *)flag;
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    return loaded;
}

/* There is one writer, so the addition need not be atomic; only the store must be. */
static void add(uint32_t *counter, uint32_t amount)
{
    *(volatile uint32_t *)counter = *counter + amount;
}

static uint32_t total(const uint32_t *counter)
{
    return *(const volatile uint32_t *)counter;
}

/* ------------------------------------------------------------------------------------- the line */

/* A pin that was an output before would still drive the line: newer versions of ESP-IDF do not
 * switch the output off. */
static void release(int pin)
{
    (void)gpio_reset_pin((gpio_num_t)pin);
}

/* Without a pull-up the line of an unplugged lidar would float, and noise would become bytes and
 * errors. Older versions of ESP-IDF did this by themselves. For pins without a pull-up (34 to 39 of
 * the ESP32) ESP-IDF logs an error, but they work. */
static void pull_up(int pin)
{
    (void)gpio_pullup_en((gpio_num_t)pin);
}

/* 8N1; no flow control, for which the lidar has no wires. */
static esp_err_t set_up_uart(const tmini_esp32_wiring_t *wiring)
{
    const uart_port_t uart = (uart_port_t)wiring->uart;
    const uart_config_t line = {
        .baud_rate = BAUD_RATE,
        .data_bits = UART_DATA_8_BITS,
        .parity = UART_PARITY_DISABLE,
        .stop_bits = UART_STOP_BITS_1,
        .flow_ctrl = UART_HW_FLOWCTRL_DISABLE,
        .source_clk = UART_CLOCK,
    };
    esp_err_t error = uart_param_config(uart, &line);
    if (error == ESP_OK) {
        release(wiring->rx_pin);
        error = uart_set_pin(uart, wiring->tx_pin, wiring->rx_pin, UART_PIN_NO_CHANGE,
                             UART_PIN_NO_CHANGE);
    }
    if (error == ESP_OK) {
        pull_up(wiring->rx_pin);
        error = uart_set_rx_full_threshold(uart, wiring->fifo_threshold);
    }
    if (error == ESP_OK) {
        error = uart_set_rx_timeout(uart, (uint8_t)wiring->timeout_symbols);
    }
    if (error == ESP_OK) {
        /* The only event used here that the driver does not post by default. */
        error = uart_enable_intr_mask(uart, UART_FRM_ERR_INT_ENA_M);
    }
    return error;
}

/* ------------------------------------------------------------------------------------ receiving */

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* How far a place in the stream is ahead of counters.bytes, in bytes; 0 if it has been passed.
 * A place is a value of counters.bytes. */
static size_t distance_to(const tmini_esp32_t *port, uint32_t place)
{
    const uint32_t distance = place - port->counters.bytes;
    return distance <= INT32_MAX ? distance : 0;
}

/* How many bytes to take from the driver now: no more than the lidar's ring has room for, because
 * the others are safe in the driver's buffer until a poll has made room; and none from after the
 * next gap. */
static size_t wanted_now(const tmini_esp32_t *port)
{
    const size_t wanted = smaller(tmini_feed_room(port->lidar), sizeof port->chunk);
    return port->gap_ahead ? smaller(wanted, distance_to(port, port->gap)) : wanted;
}

static size_t take(tmini_esp32_t *port, size_t wanted)
{
    if (wanted == 0) {
        return 0;
    }
    const int count =
        uart_read_bytes((uart_port_t)port->wiring.uart, port->chunk, (uint32_t)wanted, 0);
    if (count > 0 && port->tap != NULL) {
        port->tap(port->tap_context, port->chunk, (size_t)count);
    }
    return count > 0 ? tmini_feed(port->lidar, port->chunk, (size_t)count) : 0;
}

static void feed_gap(tmini_esp32_t *port)
{
    if (port->tap != NULL) {
        port->tap(port->tap_context, NULL, 0);
    }
    tmini_feed_gap(port->lidar);
}

/* Called when the driver holds no bytes. It stores bytes before it announces them, so all announced
 * bytes have been handed to the lidar, and a gap that was ahead is here. */
static void catch_up(tmini_esp32_t *port)
{
    if (distance_to(port, port->announced) > 0) {
        port->announced = port->counters.bytes;
    }
    port->gap = port->counters.bytes;
}

static void pass_gap(tmini_esp32_t *port)
{
    if (port->gap_ahead && distance_to(port, port->gap) == 0) {
        port->gap_ahead = false;
        feed_gap(port);
    }
}

static size_t left_in_driver(const tmini_esp32_t *port)
{
    size_t left = 0;
    (void)uart_get_buffered_data_len((uart_port_t)port->wiring.uart, &left);
    return port->gap_ahead ? smaller(left, distance_to(port, port->gap)) : left;
}

/* Reads until nothing is left, or up to a gap. It does not use the sizes in events, so lost or late
 * events do no harm. A driver whose buffer was full receives again after this.
 *
 * It never flushes the driver's buffer: even after an overflow the bytes in it are intact. */
static size_t drain(tmini_esp32_t *port)
{
    size_t drained = 0;
    size_t wanted = 0;
    size_t count = 0;
    do {
        wanted = wanted_now(port);
        count = take(port, wanted);
        add(&port->counters.bytes, (uint32_t)count);
        drained += count;
    } while (count > 0 && count == wanted);
    if (count < wanted) {
        catch_up(port);
    }
    tmini_feed_held(port->lidar, count < wanted ? 0 : left_in_driver(port));
    pass_gap(port);
    return drained;
}

/* Notes an overflow. The lost bytes came after all bytes announced so far: on an overflow the
 * driver saves the FIFO's bytes and announces them, if its buffer has room, before it reports the
 * overflow. */
static void note_gap(tmini_esp32_t *port)
{
    if (!port->gap_ahead) {
        port->gap = port->announced;
        port->gap_ahead = true;
    } else if (port->gap != port->announced) {
        port->lost_more = true;
    }
}

/* Joins all further overflows into one second gap, because for each gap a poll must empty the
 * lidar's ring. Overflows whose events were lost are included. This gap lies after all bytes that
 * the driver can hold now. */
static void note_later_gaps(tmini_esp32_t *port)
{
    if (port->lost_more && !port->gap_ahead) {
        port->announced += (uint32_t)(port->wiring.buffer_size + FIFO_SIZE);
        port->lost_more = false;
        note_gap(port);
    }
}

static void count_event(tmini_esp32_counters_t *counters, uart_event_type_t type)
{
    switch (type) {
    case UART_FIFO_OVF:
        add(&counters->overruns, 1);
        break;
    case UART_BUFFER_FULL:
        add(&counters->buffers_full, 1);
        break;
    case UART_BREAK:
        add(&counters->breaks, 1);
        break;
    case UART_FRAME_ERR:
        add(&counters->framing_errors, 1);
        break;
    case UART_PARITY_ERR:
        add(&counters->parity_errors, 1);
        break;
    default: /* Data, and events that this port does not enable. */
        break;
    }
}

/* Bytes that did not fit into the driver's buffer are announced too; they follow when there is
 * room. */
static void take_event(tmini_esp32_t *port, const uart_event_t *event)
{
    count_event(&port->counters, event->type);
    if (event->type == UART_DATA || event->type == UART_BUFFER_FULL) {
        port->announced += (uint32_t)event->size;
    } else if (event->type == UART_FIFO_OVF) {
        note_gap(port);
    }
}

/* One event has just been taken. If there is room for only one, the queue was full before, and any
 * event may have been lost. */
static void look_for_lost_events(tmini_esp32_t *port)
{
    if (uxQueueSpacesAvailable(port->events) <= 1) {
        add(&port->counters.queues_full, 1);
        port->lost_more = true;
    }
}

/* The lidar is lost, perhaps because something has changed the UART, its interrupts or its pins:
 * sets them up again. Bytes that the driver still holds are older than the loss, and are
 * dropped. */
static void set_up_again(tmini_esp32_t *port)
{
    const uart_port_t uart = (uart_port_t)port->wiring.uart;
    (void)set_up_uart(&port->wiring);
    (void)uart_flush_input(uart);
    (void)uart_enable_rx_intr(uart);
    port->announced = port->counters.bytes;
    port->gap_ahead = false;
    port->lost_more = false;
    feed_gap(port);
}

/* Takes all events before any bytes, so that the place of an overflow among the bytes is known. */
static size_t receive(tmini_esp32_t *port, TickType_t ticks)
{
    uart_event_t event;
    TickType_t wait = ticks;
    if (load(&port->restarting)) {
        store(&port->restarting, false);
        set_up_again(port);
    }
    while (xQueueReceive(port->events, &event, wait) == pdTRUE) {
        take_event(port, &event);
        look_for_lost_events(port);
        wait = 0;
    }
    note_later_gaps(port);
    return drain(port);
}

size_t tmini_esp32_wait(tmini_esp32_t *port, TickType_t ticks)
{
    if (port != NULL && port->is_started && !port->wiring.with_task) {
        return receive(port, ticks);
    }
    vTaskDelay(ticks > 0 ? ticks : 1);
    return 0;
}

/* While the lidar's ring is full, the task looks once per tick, because no event reports that a
 * poll has made room.
 *
 * After its last store the task does not touch the port, which may no longer exist. */
static void receive_task(void *argument)
{
    tmini_esp32_t *const port = argument;
    while (!load(&port->stopping)) {
        (void)receive(port, tmini_feed_room(port->lidar) > 0 ? LOOK_TICKS : 1);
    }
    store(&port->receiving, false);
    vTaskDelete(NULL);
}

/* -------------------------------------------------------------------------------- configuration */

static bool is_within(int value, int least, int most)
{
    return value >= least && value <= most;
}

static const char *mistake_in_task(const tmini_esp32_wiring_t *wiring)
{
    if (!wiring->with_task) {
        return NULL;
    }
    if (wiring->task_stack_bytes <= 0) {
        return "task_stack_bytes";
    }
    if (!is_within(wiring->task_priority, 0, configMAX_PRIORITIES - 1)) {
        return "task_priority: from 0 to less than configMAX_PRIORITIES";
    }
    if (!is_within(wiring->task_core, TMINI_ESP32_ANY_CORE, CORES - 1)) {
        return "task_core: FreeRTOS does not run on that core";
    }
    return NULL;
}

/* Names the first mistake in the wiring; NULL: there is none. FreeRTOS or the UART driver would
 * stop the program at some of them without naming the lidar. */
static const char *mistake_in(const tmini_esp32_wiring_t *wiring)
{
    if (!is_within(wiring->uart, 0, UARTS - 1)) {
        return "uart: this chip has no UART of this number, or it is a low-power one";
    }
    if (wiring->tx_pin < 0 || wiring->rx_pin < 0) {
        return "tx_pin, rx_pin: not chosen (menuconfig, T-mini lidar)";
    }
    if (wiring->buffer_size <= FIFO_SIZE) {
        return "buffer_size: more than the FIFO's 128 bytes";
    }
    if (wiring->queue_length < QUEUE_LENGTH_MIN) {
        return "queue_length: 4 or more";
    }
    if (!is_within(wiring->fifo_threshold, 1, FIFO_THRESHOLD_MAX)) {
        return "fifo_threshold: 1 to 126";
    }
    if (!is_within(wiring->timeout_symbols, 1, TIMEOUT_SYMBOLS_MAX)) {
        return "timeout_symbols: 1 to 100";
    }
    return mistake_in_task(wiring);
}

void tmini_esp32_tap(tmini_esp32_t *port, tmini_esp32_tap_t tap, void *context)
{
    port->tap = tap;
    port->tap_context = context;
}

esp_err_t tmini_esp32_init(tmini_esp32_t *port, const tmini_esp32_wiring_t *wiring)
{
    if (port == NULL || wiring == NULL) {
        return ESP_ERR_INVALID_ARG;
    }
    const char *const mistake = mistake_in(wiring);
    *port = (tmini_esp32_t){.wiring = *wiring, .is_ready = mistake == NULL};
    if (mistake != NULL) {
        ESP_LOGE(TAG, "%s", mistake);
        return ESP_ERR_INVALID_ARG;
    }
    return ESP_OK;
}

/* ------------------------------------------------------------------------ starting and stopping */

static esp_err_t start_task(tmini_esp32_t *port)
{
    const tmini_esp32_wiring_t *const wiring = &port->wiring;
    if (!wiring->with_task) {
        return ESP_OK;
    }
    const BaseType_t core =
        wiring->task_core == TMINI_ESP32_ANY_CORE ? (BaseType_t)tskNO_AFFINITY : wiring->task_core;
    port->receiving = true;
    const BaseType_t created =
        xTaskCreatePinnedToCore(receive_task, "tmini", (uint32_t)wiring->task_stack_bytes, port,
                                (UBaseType_t)wiring->task_priority, NULL, core);
    return created == pdPASS ? ESP_OK : ESP_ERR_NO_MEM;
}

/* Called before the UART is set up, because the baud rate's divider is computed from the clock at
 * that time. */
static esp_err_t hold_clock(tmini_esp32_t *port)
{
    esp_pm_lock_handle_t lock = NULL;
    esp_err_t error = esp_pm_lock_create(PM_LOCK, 0, "tmini", &lock);
    if (error == ESP_ERR_NOT_SUPPORTED) {
        return ESP_OK; /* Without power management the clocks never change. */
    }
    if (error != ESP_OK) {
        return error;
    }
    error = esp_pm_lock_acquire(lock);
    if (error != ESP_OK) {
        (void)esp_pm_lock_delete(lock);
        return error;
    }
    port->pm_lock = lock;
    return ESP_OK;
}

static void release_clock(tmini_esp32_t *port)
{
    if (port->pm_lock != NULL) {
        (void)esp_pm_lock_release(port->pm_lock);
        (void)esp_pm_lock_delete(port->pm_lock);
        port->pm_lock = NULL;
    }
}

/* Installs the driver and starts the task. After a failure nothing of this remains. */
static esp_err_t begin_reception(tmini_esp32_t *port)
{
    const tmini_esp32_wiring_t *const wiring = &port->wiring;
    const uart_port_t uart = (uart_port_t)wiring->uart;
    /* No transmit buffer: a command's two bytes always fit in the transmit FIFO. */
    esp_err_t error = uart_driver_install(uart, wiring->buffer_size, 0, wiring->queue_length,
                                          &port->events, INTERRUPT_FLAGS);
    if (error != ESP_OK) {
        return error; /* Not deleted: the driver may belong to another part of the program. */
    }
    error = set_up_uart(wiring);
    if (error == ESP_OK) {
        error = start_task(port);
    }
    if (error != ESP_OK) {
        (void)uart_driver_delete(uart);
    }
    return error;
}

esp_err_t tmini_esp32_start(tmini_esp32_t *port, tmini_t *lidar)
{
    if (port == NULL || lidar == NULL) {
        return ESP_ERR_INVALID_ARG;
    }
    if (!port->is_ready || port->is_started) {
        return ESP_ERR_INVALID_STATE;
    }
    port->lidar = lidar;
    port->stopping = false;
    port->restarting = false;
    port->announced = 0;
    port->gap_ahead = false;
    port->lost_more = false;
    port->counters = (tmini_esp32_counters_t){.bytes = 0};
    esp_err_t error = hold_clock(port);
    if (error == ESP_OK) {
        error = begin_reception(port);
    }
    if (error != ESP_OK) {
        release_clock(port);
        return error;
    }
    port->is_started = true;
    return ESP_OK;
}

esp_err_t tmini_esp32_stop(tmini_esp32_t *port)
{
    if (port == NULL || !port->is_started) {
        return ESP_ERR_INVALID_STATE;
    }
    /* When the driver is removed the task must not be inside it or hold one of its locks, so the
     * task ends itself between two events. */
    store(&port->stopping, true);
    while (load(&port->receiving)) {
        vTaskDelay(1);
    }
    port->is_started = false;
    const esp_err_t error = uart_driver_delete((uart_port_t)port->wiring.uart);
    release_clock(port);
    return error;
}

void tmini_esp32_counters(const tmini_esp32_t *port, tmini_esp32_counters_t *counters)
{
    *counters = (tmini_esp32_counters_t){
        .bytes = total(&port->counters.bytes),
        .overruns = total(&port->counters.overruns),
        .buffers_full = total(&port->counters.buffers_full),
        .queues_full = total(&port->counters.queues_full),
        .breaks = total(&port->counters.breaks),
        .framing_errors = total(&port->counters.framing_errors),
        .parity_errors = total(&port->counters.parity_errors),
    };
}

/* ------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_esp32_t *const port = context;
    if (!port->is_started) {
        return -1;
    }
    return uart_tx_chars((uart_port_t)port->wiring.uart, (const char *)bytes, (uint32_t)count);
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return (uint32_t)(esp_timer_get_time() / 1000);
}

static void port_wait(void *context)
{
    (void)tmini_esp32_wait(context, 1);
}

/* Only the receiving context may feed or report a gap; it notices this flag within 20 ms. */
static void port_restart(void *context)
{
    tmini_esp32_t *const port = context;
    store(&port->restarting, true);
}

const tmini_port_t tmini_esp32_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait, .restart = port_restart};
