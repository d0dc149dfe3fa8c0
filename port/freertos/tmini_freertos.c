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

/* The receiving task wakes after this many bytes or this time, so that a packet's end need not wait
 * for the next packet. It waits for its notification, not for the stream: only a sender wakes a
 * task that waits for a stream, and nothing is sent to a closed one. */
#define RECEIVER_WAKE_BYTES 32u
#define PATIENCE_MS 10u

#define CHUNK 64u

/* At least one tick, at any tick rate. */
static TickType_t ticks_of(uint32_t ms)
{
    const TickType_t ticks = (TickType_t)(ms * configTICK_RATE_HZ / 1000u);
    return ticks > 0 ? ticks : 1;
}

/* ----------------------------------------------------------------- the UART's interrupt context */

/* The task may be unknown: the polling task until it sleeps for the first time, the receiving task
 * until it has been created. */
static void notify_from_isr(tmini_freertos_t *port, TaskHandle_t task, BaseType_t *woken)
{
    if (task != NULL) {
        port->unannounced = 0;
        vTaskNotifyGiveIndexedFromISR(task, TMINI_FREERTOS_NOTIFICATION, woken);
    }
}

/* A stream that has refused a byte stays closed until the receiving task has emptied it. So the
 * missing bytes are at one known place: after the last one stored. */
static void send_to_stream(tmini_freertos_t *port, const uint8_t *bytes, size_t count,
                           BaseType_t *woken)
{
    size_t sent = 0;
    if (!port->is_closed) {
        sent = xStreamBufferSendFromISR(port->stream, bytes, count, woken);
    }
    if (sent < count) {
        port->counters.bytes_lost += (uint32_t)(count - sent);
        port->is_closed = true;
    }
    if (port->is_closed || port->unannounced >= RECEIVER_WAKE_BYTES) {
        notify_from_isr(port, port->receiver, woken);
    }
}

static void feed(tmini_freertos_t *port, const uint8_t *bytes, size_t count, BaseType_t *woken)
{
    tmini_feed(port->lidar, bytes, count);
    if (port->unannounced >= TMINI_FREERTOS_WAKE_BYTES) {
        notify_from_isr(port, port->poller, woken);
    }
}

void tmini_freertos_receive_from_isr(tmini_freertos_t *port, const uint8_t *bytes, size_t count,
                                     BaseType_t *woken)
{
    if (!port->is_receiving) {
        return;
    }
    port->counters.bytes += (uint32_t)count;
    port->unannounced += (uint32_t)count;
    if (port->stream != NULL) {
        send_to_stream(port, bytes, count, woken);
    } else {
        feed(port, bytes, count, woken);
    }
}

void tmini_freertos_gap_from_isr(tmini_freertos_t *port)
{
    if (!port->is_receiving) {
        return;
    }
    port->counters.overruns++;
    if (port->stream != NULL) {
        port->is_closed = true;
    } else {
        tmini_feed_gap(port->lidar);
    }
}

/* --------------------------------------------------------------------------- the receiving task */

static void announce(const tmini_freertos_t *port)
{
    if (port->poller != NULL) {
        (void)xTaskNotifyGiveIndexed(port->poller, TMINI_FREERTOS_NOTIFICATION);
    }
}

/* While the stream is closed the interrupt stores nothing, so an empty stream stays empty. The
 * polling task must empty the lidar's ring before the ring takes more. */
static void open_when_empty(tmini_freertos_t *port)
{
    if (port->is_closed && xStreamBufferIsEmpty(port->stream) == pdTRUE) {
        tmini_feed_gap(port->lidar);
        port->is_closed = false;
        announce(port);
    }
}

static void await_notification(TickType_t ticks)
{
    (void)ulTaskNotifyTakeIndexed(TMINI_FREERTOS_NOTIFICATION, pdTRUE, ticks);
}

static void report_held(const tmini_freertos_t *port)
{
    tmini_feed_held(port->lidar, xStreamBufferBytesAvailable(port->stream));
}

/* Takes no more than the lidar has room for; the rest waits in the stream. */
static void hand_on(tmini_freertos_t *port)
{
    uint8_t chunk[CHUNK];
    const size_t room = tmini_feed_room(port->lidar);
    if (room == 0) {
        report_held(port);
        vTaskDelay(1); /* Lets the polling task run. */
        return;
    }
    const size_t count = xStreamBufferReceive(port->stream, chunk, room < CHUNK ? room : CHUNK, 0);
    if (count > 0) {
        tmini_feed(port->lidar, chunk, count);
        report_held(port);
        announce(port);
    }
    open_when_empty(port);
    if (count == 0) {
        await_notification(ticks_of(PATIENCE_MS));
    }
}

static void receive_task(void *argument)
{
    tmini_freertos_t *const port = argument;
    for (;;) {
        if (port->is_receiving) {
            hand_on(port);
        } else {
            await_notification(0); /* Drops a notification for earlier bytes: the next one means a
                                    * start. */
            port->is_parked = true;
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

tmini_status_t tmini_freertos_init(tmini_freertos_t *port, const tmini_freertos_wiring_t *wiring)
{
    if (port == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *port = (tmini_freertos_t){0};
    if (wiring == NULL || !is_good_wiring(wiring)) {
        return TMINI_ERROR_ARGUMENT;
    }
    port->wiring = *wiring;
    if (wiring->stream != NULL) {
        port->stream =
            xStreamBufferCreateStatic(wiring->stream_size, 1, wiring->stream, &port->stream_memory);
    }
    return TMINI_OK;
}

/* The task is created at the first start; later starts only wake it. */
static void start_receiver(tmini_freertos_t *port)
{
    if (port->receiver == NULL) {
        port->receiver = xTaskCreateStatic(receive_task, "tmini", TMINI_FREERTOS_STACK_WORDS, port,
                                           port->wiring.priority, port->stack, &port->task_memory);
    } else {
        (void)xTaskNotifyGiveIndexed(port->receiver, TMINI_FREERTOS_NOTIFICATION);
    }
}

tmini_status_t tmini_freertos_start(tmini_freertos_t *port, tmini_t *lidar)
{
    if (port == NULL || lidar == NULL || port->wiring.write == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    if (port->is_receiving) {
        return TMINI_ERROR_STATE;
    }
    port->counters = (tmini_freertos_counters_t){0};
    port->lidar = lidar;
    port->unannounced = 0;
    port->is_parked = false;
    port->is_closed = false;
    if (port->stream != NULL) {
        (void)xStreamBufferReset(port->stream); /* Bytes left from before the stop. */
    }
    port->is_receiving = true;
    if (port->stream != NULL) {
        start_receiver(port);
    }
    return TMINI_OK;
}

void tmini_freertos_stop(tmini_freertos_t *port)
{
    if (port == NULL || !port->is_receiving) {
        return;
    }
    port->is_receiving = false;
    while (port->stream != NULL && !port->is_parked) {
        vTaskDelay(1);
    }
}

void tmini_freertos_wait(tmini_freertos_t *port, TickType_t ticks)
{
    port->poller = xTaskGetCurrentTaskHandle();
    await_notification(ticks > 0 ? ticks : 1);
}

void tmini_freertos_counters(const tmini_freertos_t *port, tmini_freertos_counters_t *counters)
{
    *counters = port->counters;
}

/* ------------------------------------------------------------------------------------- the port */

static int port_write(void *context, const uint8_t *bytes, size_t count)
{
    const tmini_freertos_t *const port = context;
    return port->wiring.write != NULL ? port->wiring.write(port->wiring.uart, bytes, count) : -1;
}

/* Milliseconds modulo 2^32. Ticks of another rate, or of 16 bits, do not wrap at 2^32 ms, so each
 * call adds the time since the last one. */
static uint32_t port_now_ms(void *context)
{
    tmini_freertos_t *const port = context;
    const TickType_t now = xTaskGetTickCount();
    const TickType_t passed = (TickType_t)(now - port->tick);
    const uint32_t seconds = (uint32_t)(passed / configTICK_RATE_HZ);
    const uint32_t rest = (uint32_t)(passed % configTICK_RATE_HZ) * 1000u + port->time_rest;
    port->tick = now;
    port->time_ms += seconds * 1000u + rest / configTICK_RATE_HZ;
    port->time_rest = rest % configTICK_RATE_HZ;
    return port->time_ms;
}

static void port_wait(void *context)
{
    tmini_freertos_wait(context, 1);
}

static void port_restart(void *context)
{
    const tmini_freertos_t *const port = context;
    if (port->is_receiving && port->wiring.restart != NULL) {
        port->wiring.restart(port->wiring.uart);
    }
}

const tmini_port_t tmini_freertos_port = {
    .write = port_write, .now_ms = port_now_ms, .wait = port_wait, .restart = port_restart};
