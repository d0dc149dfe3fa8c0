/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The viewer for browsers, over ESP-IDF's HTTP server: the page at /live, the lidar's stream at
 * /stream, as a WebSocket. The server has a task of its own; only that task waits for the network.
 * Listeners send nothing: who does is left. */

#ifndef WEB_H
#define WEB_H

#include "bridge.h"
#include "esp_err.h"

esp_err_t web_begin(void);

/* Passes on what waits for the browsers. Call it often, from the task of the bridge. */
void web_serve(bridge_t *bridge, uint64_t now_us);

#endif
