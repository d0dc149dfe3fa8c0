/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A TMINI_ATOMIC_HEADER for memory_model.c, which decides what each access sees. */

#ifndef MODELLED_ATOMIC_H
#define MODELLED_ATOMIC_H

#include <stddef.h>

size_t tmini_load(const size_t *value);
void tmini_store(size_t *value, size_t stored);
void tmini_fence(void);

#endif
