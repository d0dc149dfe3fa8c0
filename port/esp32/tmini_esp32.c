/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_esp32.h"

#include "esp_intr_alloc.h"
#include "esp_timer.h"
#include "freertos/task.h"
#include "soc/uart_reg.h"

/* The protocol's section 1. */
#define BAUD_RATE 230400

#define FIFO_SIZE 128

/* The tightest limits in the family, those of the ESP32 itself. */
#define FIFO_THRESHOLD_MAX 126
#define TIMEOUT_SYMBOLS_MAX 100

/* How long the receiving task waits for an event before it looks by itself, and so how long closing
 * may take. An event that found the queue full is made up for then, if not by the next one. */
#define LOOK_MS 20

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

/* ------------------------------------------------------------------------------------ receiving */

/* Reads until nothing is left, whatever size an event has named: then neither a lost event nor one
 * that comes late matters. Reading is also what sets a driver with a full buffer going again.
 *
 * There is no flushing here, after overflows either. What the driver holds was received whole; what
 * overflowed is gone already. Flushing would only add intact packets to the loss: the parser finds
 * its way past the hole by itself. */
static size_t drain(tmini_esp32_t *board)
{
    size_t drained = 0;
    int count = 0;
    do {
        count = uart_read_bytes(board->uart, board->chunk, sizeof board->chunk, 0);
        if (count > 0) {
            tmini_feed(board->lidar, board->chunk, (size_t)count);
            drained += (size_t)count;
        }
    } while (count == (int)sizeof board->chunk);
    add(&board->counters.bytes, (uint32_t)drained);
    return drained;
}

static void count_event(tmini_esp32_counters_t *counters, uart_event_type_t type)
{
    switch (type) {
    case UART_FIFO_OVF:
        add(&counters->fifo_overflows, 1);
        break;
    case UART_BUFFER_FULL:
        add(&counters->buffers_full, 1);
        break;
    case UART_BREAK:
        add(&counters->breaks, 1);
        break;
    case UART_FRAME_ERR:
        add(&counters->frame_errors, 1);
        break;
    case UART_PARITY_ERR:
        add(&counters->parity_errors, 1);
        break;
    default: /* Data, and what this port does not switch on. */
        break;
    }
}

static size_t receive(tmini_esp32_t *board, TickType_t ticks)
{
    uart_event_t event;
    const bool was_full = uxQueueSpacesAvailable(board->events) == 0;
    if (xQueueReceive(board->events, &event, ticks) == pdTRUE) {
        count_event(&board->counters, event.type);
        if (was_full) {
            add(&board->counters.queues_full, 1);
        }
    }
    return drain(board);
}

size_t tmini_esp32_receive(tmini_esp32_t *board, TickType_t ticks)
{
    if (board == NULL || !board->is_open || board->with_task) {
        return 0;
    }
    return receive(board, ticks);
}

/* Touches nothing of the board after its last store: the board may be gone by then. */
static void receive_task(void *argument)
{
    tmini_esp32_t *const board = argument;
    while (!load(&board->stopping)) {
        (void)receive(board, pdMS_TO_TICKS(LOOK_MS));
    }
    store(&board->receiving, false);
    vTaskDelete(NULL);
}

/* --------------------------------------------------------------------------------------- opening */

static bool is_within(int value, int least, int most)
{
    return value >= least && value <= most;
}

static bool is_valid(const tmini_esp32_config_t *config)
{
    const bool task_is_valid =
        !config->with_task || (config->task_stack_bytes > 0 && config->task_priority >= 0 &&
                               config->task_core >= TMINI_ESP32_ANY_CORE);
    return config->uart >= 0 && config->tx_pin >= 0 && config->rx_pin >= 0 &&
           config->buffer_size > FIFO_SIZE && config->queue_length > 0 &&
           is_within(config->fifo_threshold, 1, FIFO_THRESHOLD_MAX) &&
           is_within(config->timeout_symbols, 1, TIMEOUT_SYMBOLS_MAX) && task_is_valid;
}

/* 8N1; no flow control, for which the lidar has no wires. */
static esp_err_t set_up_uart(uart_port_t uart, const tmini_esp32_config_t *config)
{
    const uart_config_t line = {
        .baud_rate = BAUD_RATE,
        .data_bits = UART_DATA_8_BITS,
        .parity = UART_PARITY_DISABLE,
        .stop_bits = UART_STOP_BITS_1,
        .flow_ctrl = UART_HW_FLOWCTRL_DISABLE,
        .source_clk = UART_SCLK_DEFAULT,
    };
    esp_err_t error = uart_param_config(uart, &line);
    if (error == ESP_OK) {
        error = uart_set_pin(uart, config->tx_pin, config->rx_pin, UART_PIN_NO_CHANGE,
                             UART_PIN_NO_CHANGE);
    }
    if (error == ESP_OK) {
        error = uart_set_rx_full_threshold(uart, config->fifo_threshold);
    }
    if (error == ESP_OK) {
        error = uart_set_rx_timeout(uart, (uint8_t)config->timeout_symbols);
    }
    if (error == ESP_OK) {
        /* The one event of this port that the driver does not post unless asked to. */
        error = uart_enable_intr_mask(uart, UART_FRM_ERR_INT_ENA_M);
    }
    return error;
}

static esp_err_t start_task(tmini_esp32_t *board, const tmini_esp32_config_t *config)
{
    if (!config->with_task) {
        return ESP_OK;
    }
    const BaseType_t core =
        config->task_core == TMINI_ESP32_ANY_CORE ? (BaseType_t)tskNO_AFFINITY : config->task_core;
    board->receiving = true;
    const BaseType_t created =
        xTaskCreatePinnedToCore(receive_task, "tmini", (uint32_t)config->task_stack_bytes, board,
                                (UBaseType_t)config->task_priority, NULL, core);
    return created == pdPASS ? ESP_OK : ESP_ERR_NO_MEM;
}

esp_err_t tmini_esp32_open(tmini_esp32_t *board, const tmini_esp32_config_t *config, tmini_t *lidar)
{
    if (board == NULL || config == NULL || lidar == NULL || !is_valid(config)) {
        return ESP_ERR_INVALID_ARG;
    }
    if (board->is_open) {
        return ESP_ERR_INVALID_STATE;
    }
    *board = (tmini_esp32_t){
        .lidar = lidar, .uart = (uart_port_t)config->uart, .with_task = config->with_task};
    /* No transmit buffer: a command's two bytes always fit in the transmit FIFO. */
    esp_err_t error = uart_driver_install(board->uart, config->buffer_size, 0, config->queue_length,
                                          &board->events, INTERRUPT_FLAGS);
    if (error != ESP_OK) {
        return error; /* Not ours to remove: it may be someone else's. */
    }
    error = set_up_uart(board->uart, config);
    if (error == ESP_OK) {
        error = start_task(board, config);
    }
    if (error != ESP_OK) {
        (void)uart_driver_delete(board->uart);
        return error;
    }
    board->is_open = true;
    return ESP_OK;
}

esp_err_t tmini_esp32_close(tmini_esp32_t *board)
{
    if (board == NULL || !board->is_open) {
        return ESP_ERR_INVALID_STATE;
    }
    /* The task must not be in the driver when that goes, nor hold one of its locks: it ends itself,
     * between two events. */
    store(&board->stopping, true);
    while (load(&board->receiving)) {
        vTaskDelay(1);
    }
    board->is_open = false;
    return uart_driver_delete(board->uart);
}

void tmini_esp32_counters(const tmini_esp32_t *board, tmini_esp32_counters_t *counters)
{
    *counters = (tmini_esp32_counters_t){
        .bytes = total(&board->counters.bytes),
        .fifo_overflows = total(&board->counters.fifo_overflows),
        .buffers_full = total(&board->counters.buffers_full),
        .queues_full = total(&board->counters.queues_full),
        .breaks = total(&board->counters.breaks),
        .frame_errors = total(&board->counters.frame_errors),
        .parity_errors = total(&board->counters.parity_errors),
    };
}

/* -------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_esp32_t *const board = context;
    if (!board->is_open) {
        return -1;
    }
    return uart_tx_chars(board->uart, (const char *)bytes, (uint32_t)count);
}

static uint32_t port_now_ms(void *context)
{
    (void)context;
    return (uint32_t)(esp_timer_get_time() / 1000);
}

static void port_wait(void *context)
{
    tmini_esp32_t *const board = context;
    if (board->is_open && !board->with_task) {
        (void)receive(board, 1);
    } else {
        vTaskDelay(1);
    }
}

const tmini_port_t tmini_esp32_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait};
