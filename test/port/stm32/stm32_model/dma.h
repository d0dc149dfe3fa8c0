/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the dma.h that CubeMX generates. */

#ifndef DMA_H
#define DMA_H

void MX_DMA_Init(void);

#endif
