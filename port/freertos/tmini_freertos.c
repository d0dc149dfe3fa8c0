/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_freertos.h"

#if configSUPPORT_STATIC_ALLOCATION != 1
#error "tmini: set configSUPPORT_STATIC_ALLOCATION to 1 in FreeRTOSConfig.h"
#endif
#if TMINI_FREERTOS_NOTIFICATION >= configTASK_NOTIFICATION_ARRAY_ENTRIES
#error "tmini: raise configTASK_NOTIFICATION_ARRAY_ENTRIES in FreeRTOSConfig.h"
#endif

#define STREAM_SIZE_MIN 128u

/* The receiving task wakes after so many bytes, or so much time: a packet's end must not wait for
 * the next packet. It sleeps on its notification and not on the stream, whose senders alone wake
 * those who do: a stream that is closed would wake nobody. */
#define RECEIVER_WAKE_BYTES 32u
#define PATIENCE_MS 10u

#define CHUNK 64u

/* Never no time at all, whatever the tick's rate. */
static TickType_t ticks_of(uint32_t ms)
{
    const TickType_t ticks = (TickType_t)(ms * configTICK_RATE_HZ / 1000u);
    return ticks > 0 ? ticks : 1;
}

/* ----------------------------------------------------------------- the UART's interrupt context */

/* The polling task has no name before it has slept for the first time, and the receiving one not
 * quite from its first moment. */
static void notify_from_isr(tmini_freertos_t *board, TaskHandle_t task, BaseType_t *woken)
{
    if (task != NULL) {
        board->unannounced = 0;
        vTaskNotifyGiveIndexedFromISR(task, TMINI_FREERTOS_NOTIFICATION, woken);
    }
}

/* A stream that has had to refuse a byte stays closed until the receiving task has emptied it: so
 * the bytes are missing at one place that is known, behind the last one stored. */
static void send_to_stream(tmini_freertos_t *board, const uint8_t *bytes, size_t count,
                           BaseType_t *woken)
{
    size_t sent = 0;
    if (!board->is_closed) {
        sent = xStreamBufferSendFromISR(board->stream, bytes, count, woken);
    }
    if (sent < count) {
        board->counters.bytes_lost += (uint32_t)(count - sent);
        board->is_closed = true;
    }
    if (board->is_closed || board->unannounced >= RECEIVER_WAKE_BYTES) {
        notify_from_isr(board, board->receiver, woken);
    }
}

static void feed(tmini_freertos_t *board, const uint8_t *bytes, size_t count, BaseType_t *woken)
{
    tmini_feed(board->lidar, bytes, count);
    if (board->unannounced >= TMINI_FREERTOS_WAKE_BYTES) {
        notify_from_isr(board, board->poller, woken);
    }
}

void tmini_freertos_receive_from_isr(tmini_freertos_t *board, const uint8_t *bytes, size_t count,
                                     BaseType_t *woken)
{
    if (!board->is_receiving) {
        return;
    }
    board->counters.bytes += (uint32_t)count;
    board->unannounced += (uint32_t)count;
    if (board->stream != NULL) {
        send_to_stream(board, bytes, count, woken);
    } else {
        feed(board, bytes, count, woken);
    }
}

void tmini_freertos_gap_from_isr(tmini_freertos_t *board)
{
    if (!board->is_receiving) {
        return;
    }
    board->counters.overruns++;
    if (board->stream != NULL) {
        board->is_closed = true;
    } else {
        tmini_feed_gap(board->lidar);
    }
}

/* --------------------------------------------------------------------------- the receiving task */

static void announce(const tmini_freertos_t *board)
{
    if (board->poller != NULL) {
        (void)xTaskNotifyGiveIndexed(board->poller, TMINI_FREERTOS_NOTIFICATION);
    }
}

/* While it is closed the interrupt sends nothing: what is empty stays so. The polling task must
 * empty the lidar's ring before that takes more. */
static void open_when_empty(tmini_freertos_t *board)
{
    if (board->is_closed && xStreamBufferIsEmpty(board->stream) == pdTRUE) {
        tmini_feed_gap(board->lidar);
        board->is_closed = false;
        announce(board);
    }
}

static void await_notification(TickType_t ticks)
{
    (void)ulTaskNotifyTakeIndexed(TMINI_FREERTOS_NOTIFICATION, pdTRUE, ticks);
}

/* Takes no more than the lidar has room for: the rest is better kept in the stream than refused. */
static void hand_on(tmini_freertos_t *board)
{
    uint8_t chunk[CHUNK];
    const size_t room = tmini_feed_room(board->lidar);
    if (room == 0) {
        vTaskDelay(1); /* The polling task's turn. */
        return;
    }
    const size_t count = xStreamBufferReceive(board->stream, chunk, room < CHUNK ? room : CHUNK, 0);
    if (count > 0) {
        tmini_feed(board->lidar, chunk, count);
        announce(board);
    }
    open_when_empty(board);
    if (count == 0) {
        await_notification(ticks_of(PATIENCE_MS));
    }
}

static void receive_task(void *argument)
{
    tmini_freertos_t *const board = argument;
    for (;;) {
        if (board->is_receiving) {
            hand_on(board);
        } else {
            await_notification(0); /* Of bytes from before; the next notification is the start's. */
            board->is_parked = true;
            await_notification(portMAX_DELAY);
        }
    }
}

/* ------------------------------------------------------------------------- init, start and stop */

static bool is_good_wiring(const tmini_freertos_wiring_t *wiring)
{
    return wiring->write != NULL &&
           (wiring->stream == NULL ||
            (wiring->stream_size >= STREAM_SIZE_MIN && wiring->priority < configMAX_PRIORITIES));
}

tmini_status_t tmini_freertos_init(tmini_freertos_t *board, const tmini_freertos_wiring_t *wiring)
{
    if (board == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *board = (tmini_freertos_t){0};
    if (wiring == NULL || !is_good_wiring(wiring)) {
        return TMINI_ERROR_ARGUMENT;
    }
    board->wiring = *wiring;
    if (wiring->stream != NULL) {
        board->stream = xStreamBufferCreateStatic(wiring->stream_size, 1, wiring->stream,
                                                  &board->stream_memory);
    }
    return TMINI_OK;
}

/* The task is made at the first start; later ones only wake it. */
static void start_receiver(tmini_freertos_t *board)
{
    if (board->receiver == NULL) {
        board->receiver =
            xTaskCreateStatic(receive_task, "tmini", TMINI_FREERTOS_STACK_WORDS, board,
                              board->wiring.priority, board->stack, &board->task_memory);
    } else {
        (void)xTaskNotifyGiveIndexed(board->receiver, TMINI_FREERTOS_NOTIFICATION);
    }
}

tmini_status_t tmini_freertos_start(tmini_freertos_t *board, tmini_t *lidar)
{
    if (board == NULL || lidar == NULL || board->wiring.write == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (board->is_receiving) {
        return TMINI_ERROR_STATE;
    }
    board->counters = (tmini_freertos_counters_t){0};
    board->lidar = lidar;
    board->unannounced = 0;
    board->is_parked = false;
    board->is_closed = false;
    if (board->stream != NULL) {
        (void)xStreamBufferReset(board->stream); /* What was left behind when it was stopped. */
    }
    board->is_receiving = true;
    if (board->stream != NULL) {
        start_receiver(board);
    }
    return TMINI_OK;
}

void tmini_freertos_stop(tmini_freertos_t *board)
{
    if (board == NULL || !board->is_receiving) {
        return;
    }
    board->is_receiving = false;
    while (board->stream != NULL && !board->is_parked) {
        vTaskDelay(1);
    }
}

void tmini_freertos_wait(tmini_freertos_t *board, TickType_t ticks)
{
    board->poller = xTaskGetCurrentTaskHandle();
    await_notification(ticks > 0 ? ticks : 1);
}

void tmini_freertos_counters(const tmini_freertos_t *board, tmini_freertos_counters_t *counters)
{
    *counters = board->counters;
}

/* ------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_freertos_t *const board = context;
    return board->wiring.write != NULL ? board->wiring.write(board->wiring.uart, bytes, count) : -1;
}

/* Milliseconds that run on modulo 2^32, which ticks of another rate or of 16 bits do not: each call
 * adds what has passed since the last one. */
static uint32_t port_now_ms(void *context)
{
    tmini_freertos_t *const board = context;
    const TickType_t now = xTaskGetTickCount();
    const TickType_t passed = (TickType_t)(now - board->tick);
    const uint32_t seconds = (uint32_t)(passed / configTICK_RATE_HZ);
    const uint32_t rest = (uint32_t)(passed % configTICK_RATE_HZ) * 1000u + board->time_rest;
    board->tick = now;
    board->time_ms += seconds * 1000u + rest / configTICK_RATE_HZ;
    board->time_rest = rest % configTICK_RATE_HZ;
    return board->time_ms;
}

static void port_wait(void *context)
{
    tmini_freertos_wait(context, 1);
}

const tmini_port_t tmini_freertos_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait};
