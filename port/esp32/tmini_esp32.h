/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar on a UART of an ESP32 (any chip of the family, ESP-IDF 5.0 and newer).
 *
 * Uses ESP-IDF's UART driver. The driver's interrupt moves bytes from the UART's 128-byte FIFO to a
 * ring buffer and posts events to a queue. A receiving task, or the caller's own loop, hands the
 * bytes on to the lidar. Everything else happens in tmini_poll(), as on every platform.
 *
 *     static tmini_t lidar;
 *     static tmini_esp32_t port;
 *
 *     const tmini_esp32_wiring_t wiring = TMINI_ESP32_WIRING_DEFAULT;
 *     ESP_ERROR_CHECK(tmini_esp32_init(&port, &wiring));
 *     config.port = &tmini_esp32_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { abort(); }
 *     ESP_ERROR_CHECK(tmini_esp32_start(&port, &lidar));   bytes come from here on
 *     tmini_start(&lidar);                                  the lidar scans
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: use(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_NONE: tmini_esp32_wait(&port, pdMS_TO_TICKS(10)); break;
 *         default: break;
 *         }
 *     }
 *
 * By default (`with_task` true) a receiving task feeds and another task polls, on the same core or
 * another. With `with_task` false one task does both: tmini_esp32_wait() then also receives. */

#ifndef TMINI_ESP32_H
#define TMINI_ESP32_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "driver/uart.h"
#include "esp_err.h"
#include "esp_pm.h"
#include "freertos/FreeRTOS.h"
#include "freertos/queue.h"
#include "sdkconfig.h"

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The task may run on any core. */
#define TMINI_ESP32_ANY_CORE (-1)

/** How the lidar is connected, and how its bytes are received. */
typedef struct {
    int uart;             /**< 1 for UART1, and so on; not a low-power one. UART0 is the console. */
    int tx_pin;           /**< The GPIO wired to the lidar's RX. */
    int rx_pin;           /**< The GPIO wired to the lidar's TX. Its pull-up is switched on. */
    int buffer_size;      /**< Size of the UART driver's ring buffer, in bytes: more than the FIFO's
                           * 128. */
    int queue_length;     /**< Length of the UART driver's event queue: 4 or more. */
    int fifo_threshold;   /**< Bytes in the FIFO that raise the interrupt: 1 to 126. */
    int timeout_symbols;  /**< Silence after the last byte that also raises the interrupt, in byte
                           * times: 1 to 100. */
    bool with_task;       /**< Start a receiving task; if false, tmini_esp32_wait() receives. */
    int task_stack_bytes; /**< Stack of that task. This and the next two members are used only if
                           * with_task is true. */
    int task_priority;    /**< Its priority: above the polling task, below FreeRTOS's
                           * configMAX_PRIORITIES. */
    int task_core;        /**< A core that FreeRTOS runs on (0, 1), or TMINI_ESP32_ANY_CORE. */
} tmini_esp32_wiring_t;

/** Wiring and sizes as chosen in menuconfig, "T-mini lidar". Kconfig explains each value. */
#define TMINI_ESP32_WIRING_DEFAULT                                                          \
    {                                                                                       \
        .uart = CONFIG_TMINI_ESP32_UART, .tx_pin = CONFIG_TMINI_ESP32_TX_PIN,               \
        .rx_pin = CONFIG_TMINI_ESP32_RX_PIN, .buffer_size = CONFIG_TMINI_ESP32_BUFFER_SIZE, \
        .queue_length = CONFIG_TMINI_ESP32_QUEUE_LENGTH,                                    \
        .fifo_threshold = CONFIG_TMINI_ESP32_FIFO_THRESHOLD,                                \
        .timeout_symbols = CONFIG_TMINI_ESP32_TIMEOUT_SYMBOLS, .with_task = true,           \
        .task_stack_bytes = CONFIG_TMINI_ESP32_TASK_STACK,                                  \
        .task_priority = CONFIG_TMINI_ESP32_TASK_PRIORITY,                                  \
        .task_core = CONFIG_TMINI_ESP32_TASK_CORE,                                          \
    }

/** Counters of received bytes and errors on their way to the lidar, modulo 2^32. tmini_counters()
 * counts what the lidar does with them. */
typedef struct {
    uint32_t bytes; /**< Handed to the lidar. */
    /** Overflows of the FIFO: the interrupt came too late, and the bytes after the FIFO's 128 were
     * lost. If the driver's buffer was full, those 128 were lost too. */
    uint32_t overruns;
    uint32_t buffers_full; /**< How often the driver's buffer was full, because the task or the
                            * polls came too late. Nothing is lost yet. */
    uint32_t queues_full;  /**< How often events were lost. One may have been an overflow, so a gap
                            * is assumed. */
    uint32_t breaks;       /**< The line was low for longer than a byte: unplugged? */
    uint32_t framing_errors; /**< A stop bit was missing: wrong baud rate, noise? */
    uint32_t parity_errors;  /**< Cannot happen without a parity bit; counted if the chip reports
                              * it. */
} tmini_esp32_counters_t;

/** Called with all bytes that are received, before the lidar gets them; with no bytes where some
 * were lost. For recordings and bridges. Context: whichever receives. */
typedef void (*tmini_esp32_tap_t)(void *context, const uint8_t *bytes, size_t count);

/** One UART with a lidar. Treat the members as private. */
typedef struct {
    /** @cond private */
    tmini_esp32_wiring_t wiring;
    tmini_t *lidar;
    tmini_esp32_tap_t tap;
    void *tap_context;
    QueueHandle_t events;
    esp_pm_lock_handle_t pm_lock; /* NULL: power management is not compiled in. */
    bool is_ready;                /* tmini_esp32_init() has found nothing wrong. */
    bool is_started;
    uint32_t announced;              /* The value that counters.bytes will have after all bytes
                                      * announced by events. */
    uint32_t gap;                    /* The place of a gap: the value that counters.bytes will have
                                      * there. */
    bool gap_ahead;                  /* That gap has not yet been reported to the lidar. */
    bool lost_more;                  /* More bytes were lost, after that gap or at an unknown
                                      * place. */
    bool stopping;                   /* Written by tmini_esp32_stop(), read by the task. */
    bool receiving;                  /* Written by the task: cleared when it ends. */
    bool restarting;                 /* Set by the poll, cleared by the receiving context. */
    tmini_esp32_counters_t counters; /* Written by the receiving context alone. */
    uint8_t chunk[128];
    /** @endcond */
} tmini_esp32_t;

/** The lidar's port. Its context is the tmini_esp32_t. */
extern const tmini_port_t tmini_esp32_port;

/** Checks and copies the wiring; touches no hardware. Not while `port` is started. Returns
 * ESP_OK, or ESP_ERR_INVALID_ARG for a null pointer or a value outside its documented range, with a
 * line in the log that names it. */
esp_err_t tmini_esp32_init(tmini_esp32_t *port, const tmini_esp32_wiring_t *wiring);

/** From now on received bytes also go to `tap`; NULL: to the lidar alone. After tmini_esp32_init(),
 * before tmini_esp32_start(). */
void tmini_esp32_tap(tmini_esp32_t *port, tmini_esp32_tap_t tap, void *context);

/** Installs the UART driver, sets it up for the lidar and starts the receiving task. The UART's
 * interrupt is served by the core that makes this call. `lidar`, set up by tmini_init(), and `port`
 * stay the caller's and must last until tmini_esp32_stop(). The counters begin at 0.
 *
 * If power management is compiled in (CONFIG_PM_ENABLE), the port holds a lock until
 * tmini_esp32_stop(). The lock prevents light sleep, in which a UART receives nothing. On the ESP32
 * and ESP32-S2, whose UARTs take their clock from the APB, it also prevents a slower APB.
 *
 * Context: a task. Waits only for memory. Returns ESP_OK, or an error, after which nothing remains
 * installed:
 *   ESP_ERR_INVALID_ARG    null pointer
 *   ESP_ERR_INVALID_STATE  started already, or tmini_esp32_init() has not succeeded
 *   ESP_ERR_NO_MEM         no memory for the task or the lock
 *   others from the UART driver; ESP_FAIL if the UART is in use */
esp_err_t tmini_esp32_start(tmini_esp32_t *port, tmini_t *lidar);

/** Ends the receiving task and removes the UART driver; allowed while bytes come in. Stop the lidar
 * first, or it keeps scanning. `port` may be started again.
 *
 * Context: the task that polls. Waits for the receiving task to end: 20 ms and two ticks at most.
 * Returns ESP_OK, ESP_ERR_INVALID_STATE if not started, or the UART driver's error. */
esp_err_t tmini_esp32_stop(tmini_esp32_t *port);

/** For a polling task that has nothing left to do. With a receiving task, or when stopped: sleeps
 * for `ticks`, at least one, and returns 0. Without a receiving task: waits up to `ticks` for
 * bytes, hands to the lidar what fits into its ring (the rest waits in the UART driver's buffer
 * for the next call), and returns how many.
 *
 * Context: the task that polls. */
size_t tmini_esp32_wait(tmini_esp32_t *port, TickType_t ticks);

/** Copies the counters; any task. */
void tmini_esp32_counters(const tmini_esp32_t *port, tmini_esp32_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
