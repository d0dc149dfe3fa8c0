/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "freertos_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "FreeRTOS.h"
#include "board.h"
#include "console.h"
#include "interrupting_atomic.h"
#include "irq_lines.h"
#include "stream_buffer.h"

#define FIFO_SIZE 16u
#define TIMEOUT_US 139u /* 32 bits at 230400 baud. */
#define NEVER UINT64_MAX
#define STACK_WORDS_MIN 128u

freertos_world_t world;

void freertos_model_assert(const char *condition)
{
    fprintf(stderr, "assertion: %s\n", condition);
    abort();
}

static void demand(bool condition, const char *what)
{
    if (!condition) {
        freertos_model_assert(what);
    }
}

/* ----------------------------------------------------------------------------- time, interrupts */

/* The UART interrupts when its FIFO is half full, or after 32 bit times without a byte. */
static bool line_is_up(void)
{
    return world.interrupt_enabled && machine_must_read(FIFO_SIZE / 2, TIMEOUT_US);
}

static void arrive(uint32_t overrun, uint8_t byte)
{
    world.overrun = !machine_put(byte) || world.overrun || overrun != 0;
}

/* --------------------------------------------------------------------------------------- tasks */

/* At each access to the library's indices, another task may run. */
static void switch_tasks(void)
{
    if (!irq_is_in_handler()) {
        tasks_yield();
    }
}

static uint64_t after(TickType_t ticks)
{
    if (ticks == portMAX_DELAY) {
        return NEVER;
    }
    return machine.now_us + (uint64_t)ticks * 1000000u / configTICK_RATE_HZ;
}

static void wait_until(uint64_t until_us, bool (*is_awaited)(const task_t *))
{
    demand(!irq_is_in_handler(), "no waiting in an interrupt");
    tasks_wait(until_us, is_awaited);
}

void freertos_model_begin(const sim_observer_t *observer, unsigned priority)
{
    const machine_uart_t uart = {.fifo_size = FIFO_SIZE,
                                 .arrive = arrive,
                                 .is_up = line_is_up,
                                 .serve = UART1_Handler,
                                 .switch_tasks = switch_tasks};
    memset(&world, 0, sizeof world);
    machine_begin(observer, &uart);
    tasks_begin(priority);
}

TaskHandle_t xTaskCreateStatic(TaskFunction_t function, const char *name, uint32_t stack_words,
                               void *argument, UBaseType_t priority, StackType_t *stack,
                               StaticTask_t *memory)
{
    demand(name != NULL && stack != NULL && memory != NULL, "a task needs memory");
    demand(stack_words >= STACK_WORDS_MIN && priority < configMAX_PRIORITIES, "a task's size");
    task_t *const task = tasks_new((unsigned)priority, function, argument);
    memset(stack, 0xA5, stack_words * sizeof *stack);
    memory->kept = task;
    tasks_yield();
    return task;
}

TaskHandle_t xTaskGetCurrentTaskHandle(void)
{
    interrupt();
    return tasks_current;
}

TickType_t xTaskGetTickCount(void)
{
    return (TickType_t)((machine.now_us + world.skipped_us) * configTICK_RATE_HZ / 1000000u);
}

void vTaskDelay(TickType_t ticks)
{
    wait_until(after(ticks), NULL);
}

void vTaskSuspend(TaskHandle_t task)
{
    demand(task == NULL, "only itself");
    tasks_wait(NEVER, NULL);
}

/* The tasks exist already: they run whenever the test's task lets them. */
void vTaskStartScheduler(void) {}

BaseType_t xTaskNotifyGiveIndexed(TaskHandle_t task, UBaseType_t index)
{
    demand(index < configTASK_NOTIFICATION_ARRAY_ENTRIES, "an index");
    demand(!irq_is_in_handler(), "not from an interrupt");
    task->notices++;
    tasks_yield();
    return pdPASS;
}

void vTaskNotifyGiveIndexedFromISR(TaskHandle_t task, UBaseType_t index, BaseType_t *woken)
{
    demand(index < configTASK_NOTIFICATION_ARRAY_ENTRIES, "an index");
    demand(irq_is_in_handler(), "from an interrupt only");
    task->notices++;
    if (task->priority > tasks_current->priority) {
        *woken = pdTRUE;
    }
}

static bool has_notice(const task_t *task)
{
    return task->notices > 0;
}

uint32_t ulTaskNotifyTakeIndexed(UBaseType_t index, BaseType_t clear, TickType_t ticks)
{
    task_t *const self = tasks_current;
    demand(index < configTASK_NOTIFICATION_ARRAY_ENTRIES, "an index");
    interrupt();
    if (self->notices == 0 && ticks > 0) {
        wait_until(after(ticks), has_notice);
    }
    const uint32_t notices = self->notices;
    self->notices = clear == pdTRUE || notices == 0 ? 0 : notices - 1;
    world.wakes += tasks_is_test() && notices > 0;
    return notices;
}

/* ------------------------------------------------------------------------------- stream buffers */

StreamBufferHandle_t xStreamBufferCreateStatic(size_t size, size_t trigger, uint8_t *storage,
                                               StaticStreamBuffer_t *memory)
{
    demand(storage != NULL && trigger < size, "a stream's size");
    *memory = (StaticStreamBuffer_t){.memory = storage, .size = size};
    return memory;
}

/* As in the kernel, one place stays free. The port's tasks wait for notifications, not for a
 * stream. */
size_t xStreamBufferSendFromISR(StreamBufferHandle_t stream, const void *bytes, size_t count,
                                BaseType_t *woken)
{
    const size_t room = stream->size - 1 - stream->count;
    const size_t sent = count < room ? count : room;
    (void)woken;
    demand(irq_is_in_handler(), "from an interrupt only");
    memcpy(&stream->memory[stream->count], bytes, sent);
    stream->count += sent;
    return sent;
}

size_t xStreamBufferReceive(StreamBufferHandle_t stream, void *bytes, size_t size, TickType_t ticks)
{
    const size_t taken = stream->count < size ? stream->count : size;
    demand(ticks == 0, "a stream that wakes nobody");
    memcpy(bytes, stream->memory, taken);
    stream->count -= taken;
    memmove(stream->memory, &stream->memory[taken], stream->count);
    if (!tasks_is_test()) {
        interrupt();
    }
    return taken;
}

BaseType_t xStreamBufferIsEmpty(StreamBufferHandle_t stream)
{
    return stream->count == 0 ? pdTRUE : pdFALSE;
}

size_t xStreamBufferBytesAvailable(StreamBufferHandle_t stream)
{
    return stream->count;
}

BaseType_t xStreamBufferReset(StreamBufferHandle_t stream)
{
    stream->count = 0;
    return pdPASS;
}

/* -------------------------------------------------------------------------- the example's board */

void board_start(void) {}

void board_sleep(void) {}

int board_lidar_write(void *uart, const uint8_t *bytes, size_t count)
{
    (void)uart;
    sim_receive(&machine.lidar, bytes, count, machine.now_us);
    return (int)count;
}

void board_enable_lidar_interrupt(void)
{
    world.interrupt_enabled = true;
}

size_t board_lidar_read(uint8_t *bytes, size_t max, int *overrun)
{
    demand(irq_is_in_handler(), "in the interrupt only");
    *overrun = world.overrun;
    world.overrun = false;
    return machine_read(bytes, max);
}

void board_print(const char *text)
{
    console_write(machine.now_us, text);
}
