/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Who else uses a serial port: the kernel's console, and programs whose command line names the port
 * or that hold it open. Of other users' programs the descriptors are visible only to root. For
 * tests, the environment variable TMINI_ROOT names the folder that
 * contains dev/, proc/ and sys/. */

#ifndef USERS_H
#define USERS_H

#include <stddef.h>

#define USERS_TEXT_SIZE 200

/* "agetty (process 812) uses ttyAMA0" and so on in `text`; "" if there is nobody, or it cannot be
 * seen. Returns `text`. */
const char *users_find(const char *path, char text[USERS_TEXT_SIZE]);

/* TMINI_ROOT, or "". */
const char *users_root(void);

#endif
