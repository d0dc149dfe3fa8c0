/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: bits of the UART's registers. */

#ifndef SOC_UART_REG_H
#define SOC_UART_REG_H

#define UART_FRM_ERR_INT_ENA_M (1u << 3)

#endif
