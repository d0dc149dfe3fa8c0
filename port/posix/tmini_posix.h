/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The port for computers: a lidar on a serial device of Linux or another POSIX system, such as
 * /dev/ttyUSB0. Works on pseudo-terminals, too. Also written for macOS (/dev/cu.usbserial-110), but
 * not tried there.
 *
 *     static tmini_posix_t port;
 *
 *     tmini_posix_init(&port, "/dev/ttyUSB0");
 *     config.port = &tmini_posix_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { … }
 *     if (tmini_posix_start(&port, &lidar) != TMINI_POSIX_OK) { … }
 *     tmini_start(&lidar);
 *     while (tmini_posix_wait(&port, 10) == TMINI_POSIX_OK) {
 *         while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) { … }
 *     }
 *     stop_robot();    // the device has gone
 *     tmini_posix_stop(&port);
 *
 * After tmini_posix_reconnect() the loop survives a cable that is pulled and plugged in again.
 *
 * A computer may deliver bytes late. So use a copy of tmini_timing_default with a frame_timeout_ms
 * of 250, as examples/obstacle_stop does (timing = tmini_timing_default; timing.frame_timeout_ms =
 * 250). If scans then have gaps without a visible reason, set max_pause_ms to 250, too.
 *
 * There is no interrupt here: the one context that polls also receives. The port's `wait`
 * receives as well, so that the functions of tmini_blocking.h work. Any number of lidars, each
 * with a tmini_posix_t of its own. */

#ifndef TMINI_POSIX_H
#define TMINI_POSIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini.h"
#include "tmini_timed.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The state of the device. */
typedef enum {
    TMINI_POSIX_OK = 0,              /**< It is open. */
    TMINI_POSIX_NO_DEVICE = -1,      /**< There is no device of that name, or it has not been
                                      * started. */
    TMINI_POSIX_PERMISSION = -2,     /**< This user has no permission to open it. */
    TMINI_POSIX_BUSY = -3,           /**< Another program uses it. */
    TMINI_POSIX_NOT_A_TERMINAL = -4, /**< It is a file, another kind of device, or this program's
                                        * own terminal. */
    TMINI_POSIX_BAUD_RATE = -5,      /**< It cannot do 230400 baud. */
    TMINI_POSIX_UNPLUGGED = -6,      /**< It was open, and has disappeared. */
    TMINI_POSIX_FAILED = -7,         /**< Another error; errno has it. */
    TMINI_POSIX_ADDRESS = -8,        /**< The address is not tcp:HOST:PORT, or there is no such
                                      * host. */
} tmini_posix_status_t;

/** Errors of the line; each means a lost or wrong byte. */
typedef struct {
    uint32_t overruns;       /**< The adapter or the system was too slow. */
    uint32_t framing_errors; /**< No stop bit: another baud rate, or interference. */
    uint32_t parity_errors;  /**< Cannot happen with 8N1. */
} tmini_posix_counters_t;

/** Called with all bytes that are received, before the lidar gets them; for recordings. */
typedef void (*tmini_posix_tap_t)(void *context, const uint8_t *bytes, size_t count);

/** One serial device. The documented members may be read, the rest is private. */
typedef struct {
    uint64_t received;          /**< Bytes since it was started. */
    uint32_t reconnections;     /**< How often it has been opened again since. */
    tmini_posix_status_t state; /**< TMINI_POSIX_OK while it is open, or else why not. */
    /** @cond private */
    const char *path;
    tmini_t *lidar;
    tmini_posix_tap_t tap;
    void *tap_context;
    tmini_timed_t timed;
    int64_t waited_us;
    uint32_t tried_ms;
    bool reconnects;
    bool is_started;
    int fd;
    /** @endcond */
} tmini_posix_t;

/** The `port` of tmini_config_t; its `port_context` is the tmini_posix_t. */
extern const tmini_port_t tmini_posix_port;

/** Sets the path of the device, or of the socket to a controller that forwards its UART:
 * "tcp:HOST:PORT". It may forward raw bytes, or a timed stream: then times are those of the sender,
 * late bytes cost no scan, nothing can be sent, and the driver has to be `listen_only`. If nothing
 * comes, the driver's clock stands still for up to 0.6 s, as late bytes may follow, and so does
 * tmini_scan_age_ms(). Opens nothing yet. `path` stays the caller's, and must last as long as the
 * port is used. Do not call it between tmini_posix_start() and tmini_posix_stop(). */
void tmini_posix_init(tmini_posix_t *port, const char *path);

/** From now on received bytes also go to `tap`; NULL: to the lidar alone. */
void tmini_posix_tap(tmini_posix_t *port, tmini_posix_tap_t tap, void *context);

/** Opens the device at 230400 baud, 8N1, without flow control, for this program alone, and drops
 * what it received before; or connects the socket, for some seconds at most. From then on received
 * bytes go to `lidar`, set up by tmini_init(); NULL: to the tap alone. May wait as long as the
 * system's open does. A device that was stopped, or could not be opened, may be started again. */
tmini_posix_status_t tmini_posix_start(tmini_posix_t *port, tmini_t *lidar);

/** The same with a descriptor that is open already, such as a socket to a controller that forwards
 * its UART. It becomes the port's own: tmini_posix_stop() closes it. Returns TMINI_POSIX_OK. */
tmini_posix_status_t tmini_posix_start_on(tmini_posix_t *port, int fd, tmini_t *lidar);

/** From now on a device that has disappeared is opened again as soon as it is back. Until then
 * tmini_posix_wait() returns TMINI_POSIX_OK; the driver reports TMINI_EVENT_LOST, and
 * TMINI_EVENT_RECOVERED when the lidar scans again. The same holds for a device that did not exist
 * at tmini_posix_start(), and for a silent lidar. A name in /dev/serial/by-id always means the same
 * adapter; /dev/ttyUSB0 means the first one. While a socket is connected again, tmini_poll() and
 * tmini_posix_wait() may take seconds. Has no effect after tmini_posix_start_on(). */
void tmini_posix_reconnect(tmini_posix_t *port, bool reconnects);

/** Waits up to `timeout_ms` for bytes and feeds all that have come to the lidar, but no more than
 * its ring has room for: call tmini_poll() until it returns TMINI_EVENT_NONE in between. Without
 * room it returns at once; the bytes stay with the system. A signal ends the waiting early. Returns
 * TMINI_POSIX_OK, also when nothing came; TMINI_POSIX_UNPLUGGED or TMINI_POSIX_FAILED, which all
 * later calls return, too. */
tmini_posix_status_t tmini_posix_wait(tmini_posix_t *port, int timeout_ms);

/** Whether a timed stream comes. After tmini_posix_start() this is known, if the first bytes have
 * come within 0.6 s. */
bool tmini_posix_is_timed(const tmini_posix_t *port);

/** The time of the bytes being handed over, in microseconds of the system's monotonic clock:
 * now, or when the sender of a timed stream received them, without the delay. The scans' times are
 * on this clock, in milliseconds. */
int64_t tmini_posix_now_us(const tmini_posix_t *port);

/** Copies the errors that the system has counted since the adapter was plugged in. All 0 where it
 * does not count: sockets, pseudo-terminals, systems other than Linux. */
void tmini_posix_counters(const tmini_posix_t *port, tmini_posix_counters_t *counters);

/** Closes the device, if it is open. Stop the lidar before, or it goes on scanning. */
void tmini_posix_stop(tmini_posix_t *port);

/** The status as a short English phrase, for example "no such device". Never NULL. */
const char *tmini_posix_status_name(tmini_posix_status_t status);

#ifdef __cplusplus
}
#endif

#endif
