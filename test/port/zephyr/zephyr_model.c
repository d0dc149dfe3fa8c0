/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "zephyr_model.h"

#include "console.h"
#include "irq_lines.h"
#include "zephyr_board.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#define STEP_US 20u
#define FIFO_MAX 64u
#define FIFO_USUAL 16u

const struct device zephyr_model_uart = {.name = "uart"};

static struct {
    sim_t lidar;
    uint64_t now_us;
    uint8_t fifo[FIFO_MAX];
    unsigned fifo_size;
    unsigned count;
    int errors;
    int damage;
    bool lose_while_reading;
    bool clearing_reads_data;
    int error_check;
    int configure;
    int interrupts;
    bool ready;
    bool receiving;
    bool late; /* An interrupt that was already pending when it was switched off. */
    bool lidar_ready;
    uint64_t last_us;
    uint32_t baud_rate;
    uint32_t line_bytes;
    uart_irq_callback_user_data_t callback;
    void *user_data;
} board;

/* ------------------------------------------------------------------------- the UART's interrupt */

static bool is_up(void)
{
    return zephyr_async_is_up() ||
           ((board.late || (board.receiving && board.count > 0)) && board.callback != NULL);
}

static void serve(void)
{
    if (zephyr_async_is_up()) {
        zephyr_async_serve();
    } else {
        board.late = false;
        board.callback(&zephyr_model_uart, board.user_data);
    }
}

static void fail(unsigned line)
{
    (void)line;
    abort(); /* The handler left its flag set: a lock-up. */
}

/* Interrupts also come at accesses to the library's indices. */
void interrupt(void)
{
    irq_access();
}

/* ------------------------------------------------------------------------------------ the board */

void zephyr_model_begin(const sim_observer_t *observer)
{
    console_begin();
    memset(&board, 0, sizeof board);
    const sim_config_t config = sim_default_config();
    sim_init(&board.lidar, &config);
    sim_observe(&board.lidar, observer);
    board.fifo_size = FIFO_USUAL;
    board.ready = true;
    irq_reset(fail);
    irq.lines[0] = (irq_line_t){.is_up = is_up, .handler = serve};
    zephyr_kernel_begin();
    zephyr_async_begin();
}

void zephyr_model_set_fifo(unsigned size)
{
    board.fifo_size = size;
}

void zephyr_model_set_error_check(int result)
{
    board.error_check = result;
}

void zephyr_model_set_configure(int result)
{
    board.configure = result;
}

void zephyr_model_set_interrupts(int result)
{
    board.interrupts = result;
}

void zephyr_model_set_ready(bool ready)
{
    board.ready = ready;
}

void zephyr_model_set_lidar_ready(bool ready)
{
    board.lidar_ready = ready;
}

sim_t *zephyr_model_lidar(void)
{
    return &board.lidar;
}

uint64_t zephyr_model_now_us(void)
{
    return board.now_us;
}

uint32_t zephyr_model_line_bytes(void)
{
    return board.line_bytes;
}

uint32_t zephyr_model_baud_rate(void)
{
    return board.baud_rate;
}

bool zephyr_model_is_receiving(void)
{
    return board.receiving || zephyr_async_is_enabled();
}

void zephyr_model_damage(int errors)
{
    board.damage = errors;
}

void zephyr_model_set_clearing_reads_data(void)
{
    board.clearing_reads_data = true;
}

void zephyr_model_lose_while_reading(void)
{
    board.lose_while_reading = true;
}

/* ----------------------------------------------------------------------------- time, interrupts */

static void receive_byte(uint8_t byte)
{
    board.line_bytes++;
    board.last_us = board.now_us;
    board.errors |= board.damage;
    board.damage = 0;
    if (board.count < board.fifo_size) {
        board.fifo[board.count++] = byte;
    } else {
        board.errors |= UART_ERROR_OVERRUN;
    }
}

bool zephyr_board_has_byte(void)
{
    return board.count > 0;
}

static void take(uint8_t *bytes, unsigned count)
{
    memcpy(bytes, board.fifo, count);
    board.count -= count;
    memmove(board.fifo, &board.fifo[count], board.count);
}

uint8_t zephyr_board_take_byte(void)
{
    uint8_t byte;
    take(&byte, 1);
    return byte;
}

uint64_t zephyr_board_last_byte_us(void)
{
    return board.last_us;
}

int zephyr_board_take_errors(void)
{
    const int errors = board.errors;
    board.errors = 0;
    return errors;
}

void zephyr_model_receive(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        receive_byte(bytes[i]);
        if (board.count == board.fifo_size || i + 1 == count) {
            irq_serve();
        }
    }
}

void zephyr_model_leave_receiving(void)
{
    board.receiving = true;
}

void zephyr_model_interrupt_late(void)
{
    board.late = true;
    irq_serve();
}

void zephyr_model_pass(uint32_t us)
{
    const uint64_t end_us = board.now_us + us;
    while (board.now_us < end_us) {
        uint8_t byte;
        board.now_us += STEP_US;
        while (sim_transmit(&board.lidar, board.now_us, &byte, 1) == 1) {
            receive_byte(byte);
            irq_serve();
        }
        irq_serve();
    }
}

void zephyr_model_pass_held_up(uint32_t us)
{
    irq.masked = true;
    zephyr_model_pass(us);
    irq.masked = false;
    irq_serve();
}

/* ----------------------------------------------------------------------------------------- UART */

bool device_is_ready(const struct device *device)
{
    return device == &zephyr_model_uart ? board.ready : board.lidar_ready;
}

int uart_configure(const struct device *device, const struct uart_config *config)
{
    (void)device;
    if (board.configure == 0 && config->parity == UART_CFG_PARITY_NONE &&
        config->stop_bits == UART_CFG_STOP_BITS_1 && config->data_bits == UART_CFG_DATA_BITS_8 &&
        config->flow_ctrl == UART_CFG_FLOW_CTRL_NONE) {
        board.baud_rate = config->baudrate;
    }
    return board.configure;
}

int uart_err_check(const struct device *device)
{
    (void)device;
    irq_access();
    const int errors = zephyr_board_take_errors();
    if (errors != 0 && board.clearing_reads_data) {
        board.count = 0;
    }
    return board.error_check != 0 ? board.error_check : errors;
}

void uart_poll_out(const struct device *device, unsigned char byte)
{
    (void)device;
    sim_receive(&board.lidar, &byte, 1, board.now_us);
}

UART_CALLBACK_RESULT uart_irq_callback_user_data_set(const struct device *device,
                                                     uart_irq_callback_user_data_t callback,
                                                     void *user_data)
{
    (void)device;
    if (board.receiving) {
        abort(); /* An interrupt could come in between. */
    }
    if (board.interrupts == 0) {
        board.callback = callback;
        board.user_data = user_data;
    }
#ifndef ZEPHYR_BEFORE_3_3
    return board.interrupts;
#endif
}

void uart_irq_rx_enable(const struct device *device)
{
    (void)device;
    board.receiving = true;
    irq_access();
}

void uart_irq_rx_disable(const struct device *device)
{
    (void)device;
    board.receiving = false;
}

void uart_irq_tx_disable(const struct device *device)
{
    (void)device;
}

UART_UPDATE_RESULT uart_irq_update(const struct device *device)
{
    (void)device;
#ifdef ZEPHYR_BEFORE_3_3
    return 1;
#endif
}

static void check_context(void)
{
    irq_access();
    if (!irq_is_in_handler()) {
        abort(); /* Zephyr allows these calls only in the callback. */
    }
}

int uart_irq_rx_ready(const struct device *device)
{
    (void)device;
    check_context();
    return board.count > 0;
}

int uart_fifo_read(const struct device *device, uint8_t *bytes, int size)
{
    (void)device;
    check_context();
    const unsigned taken = board.count < (unsigned)size ? board.count : (unsigned)size;
    take(bytes, taken);
    board.errors = 0; /* In some drivers, reading clears the errors. */
    if (board.lose_while_reading) {
        board.lose_while_reading = false;
        board.errors = UART_ERROR_OVERRUN;
    }
    return (int)taken;
}

/* -------------------------------------------------------------------------------------- console */

int printk(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = console_print(board.now_us, format, arguments);
    va_end(arguments);
    return length;
}
