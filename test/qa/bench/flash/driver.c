/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program with the full driver: every command and every result. */

#include "full_driver.h"

void bench_main(void)
{
    full_driver();
}
