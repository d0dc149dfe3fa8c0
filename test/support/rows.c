/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rows.h"

#include "unity.h"

static const row_t *current;
static void (*run_row)(const row_t *row);

static void run_current(void)
{
    run_row(current);
}

/* Unity allows this if nothing is asserted afterwards. */
void rows_run(const row_t *rows, size_t count, void (*run)(const row_t *row))
{
    const char *const name = Unity.CurrentTestName;
    const UNITY_LINE_TYPE line = Unity.CurrentTestLineNumber;

    run_row = run;
    for (size_t i = 0; i < count; i++) {
        current = &rows[i];
        UnityDefaultTestRun(run_current, current->name, (int)current->line);
    }
    Unity.CurrentTestName = name;
    Unity.CurrentTestLineNumber = line;
}
