/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "zephyr_model.h"

#include "irq_lines.h"

#include <stdlib.h>
#include <string.h>

#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#define FIFO_USUAL 16u

const struct device zephyr_model_uart = {.name = "uart"};

zephyr_board_t board;

/* ------------------------------------------------------------------------- the UART's interrupt */

static bool is_up(void)
{
    return zephyr_async_is_up() ||
           ((board.late || (board.receiving && machine.count > 0)) && board.callback != NULL);
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

static void arrive(uint32_t errors, uint8_t byte)
{
    board.errors |= (int)errors;
    if (!machine_put(byte)) {
        board.errors |= UART_ERROR_OVERRUN;
    }
}

void zephyr_model_begin(const sim_observer_t *observer)
{
    const machine_uart_t uart = {
        .fifo_size = FIFO_USUAL, .arrive = arrive, .is_up = is_up, .serve = serve};
    machine_begin(observer, &uart);
    memset(&board, 0, sizeof board);
    board.ready = true;
    zephyr_kernel_begin();
    zephyr_async_begin();
}

int zephyr_board_take_errors(void)
{
    const int errors = board.errors;
    board.errors = 0;
    return errors;
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
        machine.count = 0;
    }
    return board.error_check != 0 ? board.error_check : errors;
}

void uart_poll_out(const struct device *device, unsigned char byte)
{
    (void)device;
    sim_receive(&machine.lidar, &byte, 1, machine.now_us);
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
    return machine.count > 0;
}

int uart_fifo_read(const struct device *device, uint8_t *bytes, int size)
{
    (void)device;
    check_context();
    const size_t taken = machine_read(bytes, (size_t)size);
    board.errors = 0; /* In some drivers, reading clears the errors. */
    if (board.lose_while_reading) {
        board.lose_while_reading = false;
        board.errors = UART_ERROR_OVERRUN;
    }
    return (int)taken;
}
