/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_steps.h"

void tmini_steps_step(const void *steps, tmini_scan_t *scan)
{
    const tmini_steps_t *const all = steps;
    for (size_t i = 0; all != NULL && i < all->count; i++) {
        if (all->list[i].step != NULL) {
            all->list[i].step(all->list[i].data, scan);
        }
    }
}
