/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What Kconfig makes. Zephyr's build includes it before everything else; here the other headers
 * do. */

#ifndef AUTOCONF_H
#define AUTOCONF_H

#define CONFIG_TMINI 1
#define CONFIG_TMINI_UART 1
#define CONFIG_TMINI_WAKE_BYTES 64

#endif
