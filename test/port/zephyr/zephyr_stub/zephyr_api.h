/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the port and its sample use of Zephyr, with Zephyr's names, on the model of a board
 * (../zephyr_model.h). Written for the tests from Zephyr's public API documentation. */

#ifndef ZEPHYR_API_H
#define ZEPHYR_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CONFIG_TMINI_WAKE_BYTES 64

/* -------------------------------------------------------------------------------- devices, UART */

struct device {
    const char *name;
};
extern const struct device zephyr_model_uart;

/* A devicetree with the lidar on the only UART. */
#define DT_NODELABEL(label) DT_NODE_##label
#define DT_BUS(node) BUS_OF(node)
#define BUS_OF(node) BUS_OF_##node
#define BUS_OF_DT_NODE_lidar zephyr_model_uart
#define DEVICE_DT_GET(node) (&node)

bool device_is_ready(const struct device *device);

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

/* Zephyr has told since 3.3 whether the callback was taken. */
#ifdef ZEPHYR_BEFORE_3_3
#define UART_CALLBACK_RESULT void
#else
#define UART_CALLBACK_RESULT int
#endif

#define UART_ERROR_OVERRUN 1
#define UART_ERROR_PARITY 2
#define UART_ERROR_FRAMING 4
#define UART_BREAK 8

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
int uart_irq_update(const struct device *device);
int uart_irq_rx_ready(const struct device *device);
int uart_fifo_read(const struct device *device, uint8_t *bytes, int size);

/* --------------------------------------------------------------------------------------- kernel */

typedef struct {
    int64_t ms;
} k_timeout_t;
#define K_MSEC(time_ms) ((k_timeout_t){.ms = (time_ms)})

struct k_sem {
    unsigned count;
    unsigned limit;
};
int k_sem_init(struct k_sem *sem, unsigned initial, unsigned limit);
int k_sem_take(struct k_sem *sem, k_timeout_t timeout);
void k_sem_give(struct k_sem *sem);

struct k_spinlock {
    bool held;
};
typedef struct {
    int key;
} k_spinlock_key_t;
k_spinlock_key_t k_spin_lock(struct k_spinlock *lock);
void k_spin_unlock(struct k_spinlock *lock, k_spinlock_key_t key);

uint32_t k_uptime_get_32(void);

int printk(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
