/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: the UART driver. */

#ifndef DRIVER_UART_H
#define DRIVER_UART_H

#include <stddef.h>
#include <stdint.h>

#include "esp_err.h"
#include "freertos/FreeRTOS.h"
#include "freertos/queue.h"

#define UART_PIN_NO_CHANGE (-1)

/* The low-power UART has the number after those of the other UARTs. */
#ifdef MODEL_ESP32
#define SOC_UART_HP_NUM (3)
typedef enum { UART_NUM_0, UART_NUM_1, UART_NUM_2, UART_NUM_MAX } uart_port_t;
typedef enum { UART_SCLK_APB = 1, UART_SCLK_DEFAULT = 1 } uart_sclk_t;
#else
#define SOC_UART_HP_NUM (2)
typedef enum { UART_NUM_0, UART_NUM_1, LP_UART_NUM_0, UART_NUM_MAX } uart_port_t;
typedef enum { UART_SCLK_PLL_F80M = 1, UART_SCLK_XTAL, UART_SCLK_DEFAULT = 1 } uart_sclk_t;
#endif

typedef enum { UART_DATA_8_BITS = 3 } uart_word_length_t;
typedef enum { UART_PARITY_DISABLE = 0 } uart_parity_t;
typedef enum { UART_STOP_BITS_1 = 1 } uart_stop_bits_t;
typedef enum { UART_HW_FLOWCTRL_DISABLE = 0 } uart_hw_flowcontrol_t;

typedef struct {
    int baud_rate;
    uart_word_length_t data_bits;
    uart_parity_t parity;
    uart_stop_bits_t stop_bits;
    uart_hw_flowcontrol_t flow_ctrl;
    uart_sclk_t source_clk;
} uart_config_t;

typedef enum {
    UART_DATA,
    UART_BREAK,
    UART_BUFFER_FULL,
    UART_FIFO_OVF,
    UART_FRAME_ERR,
    UART_PARITY_ERR,
    UART_DATA_BREAK,
    UART_PATTERN_DET
} uart_event_type_t;

typedef struct {
    uart_event_type_t type;
    size_t size;
} uart_event_t;

esp_err_t uart_driver_install(uart_port_t uart, int rx_buffer_size, int tx_buffer_size,
                              int queue_size, QueueHandle_t *queue, int intr_alloc_flags);
esp_err_t uart_driver_delete(uart_port_t uart);
esp_err_t uart_param_config(uart_port_t uart, const uart_config_t *config);
esp_err_t uart_set_pin(uart_port_t uart, int tx, int rx, int rts, int cts);
esp_err_t uart_set_rx_full_threshold(uart_port_t uart, int threshold);
esp_err_t uart_set_rx_timeout(uart_port_t uart, const uint8_t symbols);
esp_err_t uart_enable_intr_mask(uart_port_t uart, uint32_t mask);
esp_err_t uart_enable_rx_intr(uart_port_t uart);
esp_err_t uart_get_buffered_data_len(uart_port_t uart, size_t *size);
esp_err_t uart_flush_input(uart_port_t uart);
int uart_read_bytes(uart_port_t uart, void *buffer, uint32_t length, TickType_t ticks);
int uart_tx_chars(uart_port_t uart, const char *buffer, uint32_t length);

#endif
