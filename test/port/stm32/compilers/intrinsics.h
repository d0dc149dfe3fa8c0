/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for IAR's header of this name. */

#ifndef INTRINSICS_H
#define INTRINSICS_H

#define __DMB() __sync_synchronize()

#endif
