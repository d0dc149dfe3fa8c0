/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for Kconfig's header, which Zephyr's build includes first; here the other headers
 * include it. */

#ifndef AUTOCONF_H
#define AUTOCONF_H

#define CONFIG_TMINI 1
#define CONFIG_TMINI_UART 1
#define CONFIG_TMINI_WAKE_BYTES 64
#ifdef ZEPHYR_ASYNC
#define CONFIG_TMINI_UART_ASYNC 1
#define CONFIG_TMINI_UART_BUFFER 64
#else
#define CONFIG_TMINI_UART_INTERRUPT 1
#endif
#define CONFIG_TMINI_DEVICE 1
#define CONFIG_TMINI_POINTS 800
#define CONFIG_TMINI_RX_BUFFER 1024
#define CONFIG_TMINI_THREAD_STACK 1536
#define CONFIG_TMINI_THREAD_PRIORITY 5
#define CONFIG_TMINI_INIT_PRIORITY 90

#endif
