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

/* While bytes come, a task wakes after this time at the latest, so that a packet's end need not
 * wait for the next packet. */
#define PATIENCE_MS 10u

/* The receiving task wakes after this many bytes. It waits for its notification, not for the
 * stream: only a sender wakes a task that waits for a stream, and nothing is sent to a closed
 * one. */
#define RECEIVER_WAKE_BYTES 32u

#define CHUNK 64u

/* Rounded down, but at least one tick, at any tick rate; at most half of what a tick of 16 bits
 * holds, because the clock must be read before the tick wraps around. */
static TickType_t ticks_of(uint32_t ms)
{
    const uint32_t ticks = ms * configTICK_RATE_HZ / 1000u;
    const TickType_t most = portMAX_DELAY / 2;
    if (ticks > most) {
        return most;
    }
    return ticks > 0 ? (TickType_t)ticks : 1;
}

/* Between writing what the other side reads and reading what it writes. The two are volatile, which
 * is enough on one core. */
static void write_before_reading(void)
{
    tmini_fence();
#if defined(configNUMBER_OF_CORES) && configNUMBER_OF_CORES > 1
    __atomic_thread_fence(__ATOMIC_SEQ_CST);
#endif
}

/* ----------------------------------------------------------------- the UART's interrupt context */

/* The task may be unknown: the polling task until it sleeps for the first time, the receiving task
 * until it has been created. */
static void notify_from_isr(tmini_freertos_t *port, TaskHandle_t task, BaseType_t *woken)
{
    if (task != NULL) {
        port->unannounced = 0;
        port->wakes_at_once = false;
        vTaskNotifyGiveIndexedFromISR(task, TMINI_FREERTOS_NOTIFICATION, woken);
    }
}

/* A task that sleeps long wants the first byte, another one `wake_bytes` (see doze()). */
static bool is_worth_waking(tmini_freertos_t *port, uint32_t wake_bytes)
{
    port->has_received = true;
    write_before_reading();
    return port->wakes_at_once || port->unannounced >= wake_bytes;
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
    if (is_worth_waking(port, RECEIVER_WAKE_BYTES) || port->is_closed) {
        notify_from_isr(port, port->receiver, woken);
    }
}

static void feed(tmini_freertos_t *port, const uint8_t *bytes, size_t count, BaseType_t *woken)
{
    tmini_feed(port->lidar, bytes, count);
    if (is_worth_waking(port, TMINI_FREERTOS_WAKE_BYTES)) {
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

/* ------------------------------------------------------------------------------------- sleeping */

static void await_notification(TickType_t ticks)
{
    (void)ulTaskNotifyTakeIndexed(TMINI_FREERTOS_NOTIFICATION, pdTRUE, ticks);
}

/* For the task that the interrupt notifies, after it has taken all bytes. If none has come since
 * the last call, it sleeps for `ticks`, and the next byte ends that. Else bytes are flowing: it
 * waits for several, but not long.
 * No byte is slept over. The interrupt stores it, sets `has_received`, then reads `wakes_at_once`;
 * here the order is the opposite. So for a byte that this call does not see as received, the
 * interrupt sees the flag and notifies, and a notification that comes before the wait ends it. A
 * byte whose `has_received` is cleared here waits for the short time at most. */
static void doze(tmini_freertos_t *port, TickType_t ticks)
{
    const TickType_t patience = ticks_of(PATIENCE_MS);
    port->wakes_at_once = true;
    write_before_reading();
    if (port->has_received) {
        port->has_received = false;
        port->wakes_at_once = false;
        ticks = ticks < patience ? ticks : patience;
    }
    await_notification(ticks);
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
        doze(port, portMAX_DELAY);
    }
}

static void receive_task(void *argument)
{
    tmini_freertos_t *const port = argument;
    for (;;) {
        if (port->is_receiving) {
            hand_on(port);
        } else {
            port->is_parked = true;
            while (!port->is_receiving) {
                await_notification(portMAX_DELAY);
            }
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

static void wake_receiver(const tmini_freertos_t *port)
{
    (void)xTaskNotifyGiveIndexed(port->receiver, TMINI_FREERTOS_NOTIFICATION);
}

/* The task is created at the first start; later starts only wake it. */
static void start_receiver(tmini_freertos_t *port)
{
    if (port->receiver == NULL) {
        port->receiver = xTaskCreateStatic(receive_task, "tmini", TMINI_FREERTOS_STACK_WORDS, port,
                                           port->wiring.priority, port->stack, &port->task_memory);
    } else {
        wake_receiver(port);
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
    port->has_received = false;
    port->wakes_at_once = false;
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
    if (port->stream != NULL) {
        wake_receiver(port);
        while (!port->is_parked) {
            vTaskDelay(1);
        }
    }
}

void tmini_freertos_wait(tmini_freertos_t *port, TickType_t ticks)
{
    port->poller = xTaskGetCurrentTaskHandle();
    await_notification(ticks > 0 ? ticks : 1);
}

/* The first call returns at once, because bytes that came before it have notified no task. The
 * receiving task notifies for each byte that it hands on. */
void tmini_freertos_sleep(tmini_freertos_t *port, uint32_t due_ms)
{
    TaskHandle_t self = xTaskGetCurrentTaskHandle();
    if (due_ms == 0 || port->poller != self) {
        port->poller = self;
    } else if (port->stream != NULL) {
        await_notification(ticks_of(due_ms));
    } else {
        doze(port, ticks_of(due_ms));
    }
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
