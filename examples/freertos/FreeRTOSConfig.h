/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The kernel's settings for this demo: static allocation only, no heap, no timers. */

#ifndef FREERTOS_CONFIG_H
#define FREERTOS_CONFIG_H

#define configCPU_CLOCK_HZ 50000000u
#define configTICK_RATE_HZ 1000u
#define configTICK_TYPE_WIDTH_IN_BITS TICK_TYPE_WIDTH_32_BITS
#define configUSE_PREEMPTION 1
#define configUSE_IDLE_HOOK 1
#define configUSE_TICK_HOOK 0
#define configMAX_PRIORITIES 4
#define configMINIMAL_STACK_SIZE 96
#define configUSE_TIMERS 0
#define configUSE_MUTEXES 0
#define configCHECK_FOR_STACK_OVERFLOW 2

#define configSUPPORT_STATIC_ALLOCATION 1
#define configSUPPORT_DYNAMIC_ALLOCATION 0
#define configKERNEL_PROVIDED_STATIC_MEMORY 1

#define configUSE_TASK_NOTIFICATIONS 1
#define configUSE_STREAM_BUFFERS 1

#define INCLUDE_vTaskDelay 1
#define INCLUDE_vTaskSuspend 1
#define INCLUDE_xTaskGetCurrentTaskHandle 1

/* Priorities have three bits, at the top of the byte. The kernel has the lowest priority;
 * interrupts that call it may have at most the middle one. */
#define configPRIO_BITS 3
#define configKERNEL_INTERRUPT_PRIORITY 0xE0
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 0x60

void board_assert(const char *file, int line);
#define configASSERT(condition)               \
    do {                                      \
        if (!(condition)) {                   \
            board_assert(__FILE__, __LINE__); \
        }                                     \
    } while (0)

/* The kernel's handlers get the names in the vector table. */
#define vPortSVCHandler SVC_Handler
#define xPortPendSVHandler PendSV_Handler
#define xPortSysTickHandler SysTick_Handler

#endif
