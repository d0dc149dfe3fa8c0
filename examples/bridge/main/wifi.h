/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The Wi-Fi of menuconfig, as a station: connects, and again whenever it is lost. Does not wait. */

#ifndef WIFI_H
#define WIFI_H

void wifi_begin(void);

#endif
