/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The serial ports of this computer. For tests, the environment variable TMINI_ROOT names the
 * folder that contains dev/, proc/ and sys/. */

#ifndef PORTS_H
#define PORTS_H

#include <stdbool.h>
#include <stddef.h>

#define PORTS_MAX 32
#define PORTS_PATH_SIZE 600

typedef struct {
    char name[PORTS_PATH_SIZE];   /* The most stable name. */
    char device[PORTS_PATH_SIZE]; /* /dev/ttyUSB0 */
    char real[PORTS_PATH_SIZE];   /* The same without links. */
    bool is_board;                /* The board's own UART, no USB adapter. */
    char maker[20];               /* "vendor:product", or ":" if not known. */
    char serial[60];              /* The adapter's own, which need not be unique; "": none. */
    const char *chip;             /* NULL: not a chip that lidars come with. */
} adapter_t;

/* Finds them, USB adapters first. */
size_t ports_find(adapter_t ports[PORTS_MAX]);

#endif
