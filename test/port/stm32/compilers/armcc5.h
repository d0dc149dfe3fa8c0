/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the built-in functions of ARMCC 5. */

#ifndef ARMCC5_H
#define ARMCC5_H

#define __CC_ARM 5060960
#define __memory_changed() __asm__ volatile("" ::: "memory")
#define __dmb(kind) ((void)(kind), __sync_synchronize())

#endif
