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

/* With fewer, one event that waits would pass for a full queue, and so for a loss. */
#define QUEUE_LENGTH_MIN 4

/* The tightest limits in the family, those of the ESP32 itself. */
#define FIFO_THRESHOLD_MAX 126
#define TIMEOUT_SYMBOLS_MAX 100

/* How long the receiving task waits for an event before it looks by itself, and so how long
 * stopping may take. Bytes whose event found the queue full are fetched then, if not by the next
 * one. Not 0 where ticks are longer, or the task would never wait, and nothing of lower priority
 * ever run. */
#define LOOK_MS 20
#define LOOK_TICKS (pdMS_TO_TICKS(LOOK_MS) > 0 ? pdMS_TO_TICKS(LOOK_MS) : 1)

/* The low-power UARTs of some chips have numbers too, after the others: FIFOs of 16 bytes, slow
 * clocks. */
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

/* The crystal's frequency is the same whatever the power management does to the CPU's and the
 * buses'. The two oldest chips cannot give it to a UART: there the APB has to keep its full
 * speed. */
#if defined(CONFIG_IDF_TARGET_ESP32) || defined(CONFIG_IDF_TARGET_ESP32S2)
#define UART_CLOCK UART_SCLK_APB
#define PM_LOCK ESP_PM_APB_FREQ_MAX
#else
#define UART_CLOCK UART_SCLK_XTAL
#define PM_LOCK ESP_PM_NO_LIGHT_SLEEP
#endif

/* The interrupt handler is where menuconfig has put it; saying otherwise earns a warning. */
#ifdef CONFIG_UART_ISR_IN_IRAM
#define INTERRUPT_FLAGS ESP_INTR_FLAG_IRAM
#else
#define INTERRUPT_FLAGS 0
#endif

/* ------------------------------------------------------------------- shared between two tasks */

static void store(bool *flag, bool value)
{
    __atomic_store_n(flag, value, __ATOMIC_RELEASE);
}

static bool load(const bool *flag)
{
    return __atomic_load_n(flag, __ATOMIC_ACQUIRE);
}

/* One writer, so this need not be one indivisible step; only reading must not see half of it. */
static void add(uint32_t *counter, uint32_t amount)
{
    __atomic_store_n(counter, *counter + amount, __ATOMIC_RELAXED);
}

static uint32_t total(const uint32_t *counter)
{
    return __atomic_load_n(counter, __ATOMIC_RELAXED);
}

/* ------------------------------------------------------------------------------------- the line */

/* A pin that was an output before would go on driving the line: newer versions of ESP-IDF route a
 * receive pin without switching its output off. */
static void release(int pin)
{
    (void)gpio_reset_pin((gpio_num_t)pin);
}

/* An unplugged lidar must not leave the line floating: noise would be bytes, and frame errors
 * interrupts. Older versions of ESP-IDF did this by themselves. Pins without a pull-up (34 to 39 of
 * the ESP32) say so in the log, and work. */
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
        /* The one event of this port that the driver does not post unless asked to. */
        error = uart_enable_intr_mask(uart, UART_FRM_ERR_INT_ENA_M);
    }
    return error;
}

/* ------------------------------------------------------------------------------------ receiving */

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* A place in the stream of bytes is counted as counters.bytes counts what has been handed on. How
 * far ahead of that it is; 0 when it has been passed. */
static size_t distance_to(const tmini_esp32_t *port, uint32_t place)
{
    const uint32_t distance = place - port->counters.bytes;
    return distance <= INT32_MAX ? distance : 0;
}

/* Takes no more than the lidar's ring has room for: what the ring would have to refuse is safe in
 * the driver's buffer, until the poll has made room. And nothing from after a gap yet. */
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
    return count > 0 ? tmini_feed(port->lidar, port->chunk, (size_t)count) : 0;
}

/* The driver stores bytes before it announces them: once it holds none, all that were announced
 * have been handed on, and no gap is ahead any more but here. */
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
        tmini_feed_gap(port->lidar);
    }
}

/* What waits there for room, before a gap if there is one ahead. */
static size_t left_in_driver(const tmini_esp32_t *port)
{
    size_t left = 0;
    (void)uart_get_buffered_data_len((uart_port_t)port->wiring.uart, &left);
    return port->gap_ahead ? smaller(left, distance_to(port, port->gap)) : left;
}

/* Reads until nothing is left, or up to a gap, whatever size an event has named: then neither a
 * lost event nor one that comes late matters. Reading is also what sets a driver with a full buffer
 * going again.
 *
 * There is no flushing here, after overflows either. What the driver holds was received whole; what
 * overflowed is gone already. Flushing would only add intact packets to the loss: the parser finds
 * its way past the gap by itself. */
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

/* What overflowed came after all that had been announced by then: on an overflow, the driver saves
 * the FIFO's bytes and announces them, if its buffer has room, and then reports the overflow. */
static void note_gap(tmini_esp32_t *port)
{
    if (!port->gap_ahead) {
        port->gap = port->announced;
        port->gap_ahead = true;
    } else if (port->gap != port->announced) {
        port->lost_more = true;
    }
}

/* Each gap costs the lidar's ring a poll. So however many there are after the first one, or of
 * however many the events were lost, there is one more: after all that the driver can hold, or
 * turns out to hold. */
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
    default: /* Data, and what this port does not switch on. */
        break;
    }
}

/* Bytes that did not fit into the driver's buffer are announced, too: they follow when there is
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

/* Nobody else takes events: so a queue that was full has stayed so until now, when there is room
 * for the one that has been taken, if no more. Any event may have been lost. */
static void look_for_lost_events(tmini_esp32_t *port)
{
    if (uxQueueSpacesAvailable(port->events) <= 1) {
        add(&port->counters.queues_full, 1);
        port->lost_more = true;
    }
}

/* The lidar is lost: perhaps because something else has changed the UART, its interrupts or its
 * pins. What the driver still holds is older than the loss. */
static void begin_anew(tmini_esp32_t *port)
{
    const uart_port_t uart = (uart_port_t)port->wiring.uart;
    (void)set_up_uart(&port->wiring);
    (void)uart_flush_input(uart);
    (void)uart_enable_rx_intr(uart);
    port->announced = port->counters.bytes;
    port->gap_ahead = false;
    port->lost_more = false;
    tmini_feed_gap(port->lidar);
}

/* All events before any bytes: an overflow is among bytes that came before it and after it. */
static size_t receive(tmini_esp32_t *port, TickType_t ticks)
{
    uart_event_t event;
    TickType_t wait = ticks;
    if (load(&port->restarting)) {
        store(&port->restarting, false);
        begin_anew(port);
    }
    while (xQueueReceive(port->events, &event, wait) == pdTRUE) {
        take_event(port, &event);
        look_for_lost_events(port);
        wait = 0;
    }
    note_later_gaps(port);
    return drain(port);
}

/* With a task, or with nothing to receive, it is time alone that ends the wait. */
size_t tmini_esp32_wait(tmini_esp32_t *port, TickType_t ticks)
{
    if (port != NULL && port->is_started && !port->wiring.with_task) {
        return receive(port, ticks);
    }
    vTaskDelay(ticks > 0 ? ticks : 1);
    return 0;
}

/* With a full ring it is the poll that makes it go on, and no event reports that: look each tick.
 *
 * Touches nothing of the port after its last store: the port may be gone by then. */
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

/* FreeRTOS and the UART driver stop the program at some of these mistakes, and say nothing about
 * the lidar: so each is found here, and named. NULL when there is none. */
static const char *mistake_in(const tmini_esp32_wiring_t *wiring)
{
    if (!is_within(wiring->uart, 0, UARTS - 1)) {
        return "uart: this chip has no such one, or it is a low-power one";
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

/* Before the UART is set up: the baud rate's divider is worked out from the clock as it is then. */
static esp_err_t hold_clock(tmini_esp32_t *port)
{
    esp_pm_lock_handle_t lock = NULL;
    esp_err_t error = esp_pm_lock_create(PM_LOCK, 0, "tmini", &lock);
    if (error == ESP_ERR_NOT_SUPPORTED) {
        return ESP_OK; /* Without power management nothing changes a clock. */
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

/* The driver, and the task over it; on failure nothing is left of either. */
static esp_err_t begin_reception(tmini_esp32_t *port)
{
    const tmini_esp32_wiring_t *const wiring = &port->wiring;
    const uart_port_t uart = (uart_port_t)wiring->uart;
    /* No transmit buffer: a command's two bytes always fit in the transmit FIFO. */
    esp_err_t error = uart_driver_install(uart, wiring->buffer_size, 0, wiring->queue_length,
                                          &port->events, INTERRUPT_FLAGS);
    if (error != ESP_OK) {
        return error; /* Not ours to remove: it may be someone else's. */
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
    /* The task must not be in the driver when that goes, nor hold one of its locks: it ends itself,
     * between two events. */
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

/* Feeding, and so a gap, is the receiving context's: it looks within 20 ms. */
static void port_restart(void *context)
{
    tmini_esp32_t *const port = context;
    store(&port->restarting, true);
}

const tmini_port_t tmini_esp32_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait, .restart = port_restart};
