/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: the interrupt-driven and the async UART APIs. */

#ifndef ZEPHYR_DRIVERS_UART_H
#define ZEPHYR_DRIVERS_UART_H

#include <stddef.h>
#include <stdint.h>
#include <zephyr/device.h>

enum uart_config_parity { UART_CFG_PARITY_NONE, UART_CFG_PARITY_ODD };
enum uart_config_stop_bits { UART_CFG_STOP_BITS_0_5, UART_CFG_STOP_BITS_1 };
enum uart_config_data_bits { UART_CFG_DATA_BITS_5, UART_CFG_DATA_BITS_8 = 3 };
enum uart_config_flow_control { UART_CFG_FLOW_CTRL_NONE, UART_CFG_FLOW_CTRL_RTS_CTS };

struct uart_config {
    uint32_t baudrate;
    uint8_t parity;
    uint8_t stop_bits;
    uint8_t data_bits;
    uint8_t flow_ctrl;
};

/* Setting the callback returns a result since Zephyr 3.3; uart_irq_update() returns nothing since
 * May 2026 (pull request 105231). */
#ifdef ZEPHYR_BEFORE_3_3
#define UART_CALLBACK_RESULT void
#define UART_UPDATE_RESULT int
#else
#define UART_CALLBACK_RESULT int
#define UART_UPDATE_RESULT void
#endif

enum uart_rx_stop_reason {
    UART_ERROR_OVERRUN = 1,
    UART_ERROR_PARITY = 2,
    UART_ERROR_FRAMING = 4,
    UART_BREAK = 8,
    UART_ERROR_NOISE = 32
};

typedef void (*uart_irq_callback_user_data_t)(const struct device *device, void *user_data);

int uart_configure(const struct device *device, const struct uart_config *config);
int uart_err_check(const struct device *device);
void uart_poll_out(const struct device *device, unsigned char byte);
UART_CALLBACK_RESULT uart_irq_callback_user_data_set(const struct device *device,
                                                     uart_irq_callback_user_data_t callback,
                                                     void *user_data);
void uart_irq_rx_enable(const struct device *device);
void uart_irq_rx_disable(const struct device *device);
void uart_irq_tx_disable(const struct device *device);
UART_UPDATE_RESULT uart_irq_update(const struct device *device);
int uart_irq_rx_ready(const struct device *device);
int uart_fifo_read(const struct device *device, uint8_t *bytes, int size);

enum uart_event_type {
    UART_TX_DONE,
    UART_TX_ABORTED,
    UART_RX_RDY,
    UART_RX_BUF_REQUEST,
    UART_RX_BUF_RELEASED,
    UART_RX_DISABLED,
    UART_RX_STOPPED
};
struct uart_event_rx {
    uint8_t *buf;
    size_t offset;
    size_t len;
};
struct uart_event_rx_buf {
    uint8_t *buf;
};
struct uart_event_rx_stop {
    enum uart_rx_stop_reason reason;
    struct uart_event_rx data;
};
struct uart_event {
    enum uart_event_type type;
    union {
        struct uart_event_rx rx;
        struct uart_event_rx_buf rx_buf;
        struct uart_event_rx_stop rx_stop;
    } data;
};
typedef void (*uart_callback_t)(const struct device *device, struct uart_event *event,
                                void *user_data);

int uart_callback_set(const struct device *device, uart_callback_t callback, void *user_data);
int uart_rx_enable(const struct device *device, uint8_t *buffer, size_t size, int32_t timeout_us);
int uart_rx_buf_rsp(const struct device *device, uint8_t *buffer, size_t size);
int uart_rx_disable(const struct device *device);

#endif
