/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: the console. */

#ifndef ZEPHYR_SYS_PRINTK_H
#define ZEPHYR_SYS_PRINTK_H

int printk(const char *format, ...) __attribute__((format(__printf__, 1, 2)));

#endif
