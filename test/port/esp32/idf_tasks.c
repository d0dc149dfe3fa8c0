/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tasks, as on two cores: whenever one of them accesses what tasks share, another that is ready may
 * go on instead. */

#include "idf.h"
#include "irq_lines.h"
#include "tasks.h"

#define TICK_US (1000000u / CONFIG_FREERTOS_HZ)

static void switch_cores(void)
{
    if (!irq_is_in_handler()) {
        tasks_alternate();
    }
}

void idf_begin_tasks(void)
{
    tasks_begin(0);
    machine.uart.switch_tasks = switch_cores;
}

static bool is_posted(const task_t *task)
{
    (void)task;
    return idf.queue_count > 0;
}

void idf_wait(TickType_t ticks, bool for_event)
{
    tasks_wait(machine.now_us + (uint64_t)ticks * TICK_US, for_event ? is_posted : NULL);
}

void idf_begin_task(TaskFunction_t function, void *argument)
{
    (void)tasks_new(0, function, argument);
}

void idf_end_task(void)
{
    tasks_end();
}
