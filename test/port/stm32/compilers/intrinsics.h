/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for IAR's header of this name, and for the built-in functions of ARMCC 5. */

#ifndef INTRINSICS_H
#define INTRINSICS_H

#define __DMB() __sync_synchronize()
#define __memory_changed() __asm__ volatile("" ::: "memory")
#define __dmb(kind) ((void)(kind), __DMB())

#endif
