/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar as a device of Zephyr, one for each enabled node "ydlidar,t-mini-plus" of the
 * devicetree. It has its own buffers and a thread that polls; your program gets events:
 *
 *     static const struct device *const lidar = DEVICE_DT_GET(DT_NODELABEL(lidar));
 *
 *     static void on_event(const struct device *device, tmini_event_t event, void *user_data)
 *     {
 *         if (event == TMINI_EVENT_SCAN) {
 *             use(tmini_scan(tmini_zephyr_device_lidar(device)));
 *         }
 *     }
 *
 *     int main(void)
 *     {
 *         if (!device_is_ready(lidar)) { halt(); }
 *         tmini_zephyr_device_callback_set(lidar, on_event, NULL);
 *         tmini_zephyr_device_start(lidar);       holds until tmini_zephyr_device_stop()
 *         …
 *
 * The callback runs in the device's thread. There every function of tmini.h may be called with
 * tmini_zephyr_device_lidar(); in other threads only between tmini_zephyr_device_lock() and
 * _unlock(). A scan stays valid until the next one. So a message queue may pass pointers to scans
 * to another thread, which must use each within a revolution. */

#ifndef TMINI_ZEPHYR_DEVICE_H
#define TMINI_ZEPHYR_DEVICE_H

#include "tmini_zephyr.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Called in the device's thread with each event except TMINI_EVENT_NONE. */
typedef void (*tmini_zephyr_callback_t)(const struct device *device, tmini_event_t event,
                                        void *user_data);

/** From now on events go to `callback`; NULL: nowhere. Any thread. */
void tmini_zephyr_device_callback_set(const struct device *device, tmini_zephyr_callback_t callback,
                                      void *user_data);

/** tmini_start() and tmini_stop(), from any thread. They return 0, or -EIO if the library
 * refuses. */
int tmini_zephyr_device_start(const struct device *device);
int tmini_zephyr_device_stop(const struct device *device); /**< Ends scanning. */

/** The lidar, for the functions of tmini.h: in the callback, or between lock and unlock. */
tmini_t *tmini_zephyr_device_lidar(const struct device *device);

/** Makes the device's thread wait until tmini_zephyr_device_unlock(), so that this thread may use
 * the lidar, for a short time. Returns the lidar. Any thread; waits for the device's thread. */
tmini_t *tmini_zephyr_device_lock(const struct device *device);

/** Lets the device's thread continue, and wakes it, so that what was asked for begins at once. */
void tmini_zephyr_device_unlock(const struct device *device);

/** Copies the port's counters; any thread. */
void tmini_zephyr_device_counters(const struct device *device, tmini_zephyr_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
