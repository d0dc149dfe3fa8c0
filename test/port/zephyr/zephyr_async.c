/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr's async UART API on the model: it fills a buffer, requests the next one, reports received
 * bytes when a buffer is full or the line pauses, and stops at any error. */

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <zephyr/drivers/uart.h>

#include "irq_lines.h"
#include "zephyr_model.h"

static struct {
    uart_callback_t callback;
    void *user_data;
    bool ending;
    uint64_t end_us; /* Disabling takes until this time: the UART is busy. */
    uint8_t *buffer;
    size_t size;
    size_t reported;
    size_t count;
    uint8_t *next;
    size_t next_size;
    int32_t timeout_us;
} async;

void zephyr_async_begin(void)
{
    memset(&async, 0, sizeof async);
}

static void post(struct uart_event event)
{
    async.callback(&zephyr_model_uart, &event, async.user_data);
}

static void report(void)
{
    const size_t from = async.reported;
    async.reported = async.count;
    if (async.count > from) {
        post((struct uart_event){
            .type = UART_RX_RDY,
            .data.rx = {.buf = async.buffer, .offset = from, .len = async.count - from}});
    }
}

static void release(uint8_t *buffer)
{
    if (buffer != NULL) {
        memset(buffer, 0xFF, async.size); /* The port must no longer read it. */
        post((struct uart_event){.type = UART_RX_BUF_RELEASED, .data.rx_buf.buf = buffer});
    }
}

static void use(uint8_t *buffer, size_t size)
{
    async.buffer = buffer;
    async.size = size;
    async.count = 0;
    async.reported = 0;
    async.next = NULL;
}

static void end(void)
{
    report();
    release(async.buffer);
    release(async.next);
    board.async_is_on = false;
    async.ending = false;
    post((struct uart_event){.type = UART_RX_DISABLED});
}

static void change_buffers(void)
{
    uint8_t *const full = async.buffer;
    uint8_t *const next = async.next;
    report();
    release(full);
    use(next, async.next_size);
    if (next == NULL) {
        end();
    } else {
        post((struct uart_event){.type = UART_RX_BUF_REQUEST});
    }
}

static bool has_paused(void)
{
    return async.count > async.reported &&
           machine.now_us - machine.last_us >= (uint64_t)async.timeout_us;
}

static bool is_over(void)
{
    return async.ending && machine.now_us >= async.end_us;
}

bool zephyr_async_is_up(void)
{
    return board.async_is_on && (is_over() || machine.count > 0 || has_paused());
}

void zephyr_async_serve(void)
{
    const int errors = zephyr_board_take_errors();
    while (board.async_is_on && machine.count > 0) {
        async.buffer[async.count++] = (uint8_t)machine_take();
        if (async.count == async.size) {
            change_buffers();
        }
    }
    if (errors != 0) {
        post((struct uart_event){.type = UART_RX_STOPPED,
                                 .data.rx_stop.reason = (enum uart_rx_stop_reason)errors});
    }
    if (board.async_is_on && (errors != 0 || is_over())) {
        end();
    } else if (has_paused()) {
        report();
    }
}

int uart_callback_set(const struct device *device, uart_callback_t callback, void *user_data)
{
    (void)device;
    async.callback = callback;
    async.user_data = user_data;
    return board.async;
}

int uart_rx_enable(const struct device *device, uint8_t *buffer, size_t size, int32_t timeout_us)
{
    (void)device;
    if (board.async_is_on || board.async_enable != 0) {
        return board.async_is_on ? -EBUSY : board.async_enable;
    }
    use(buffer, size);
    async.timeout_us = timeout_us;
    board.async_is_on = true;
    (void)zephyr_board_take_errors();
    post((struct uart_event){.type = UART_RX_BUF_REQUEST});
    irq_access();
    return 0;
}

int uart_rx_buf_rsp(const struct device *device, uint8_t *buffer, size_t size)
{
    (void)device;
    if (buffer == async.buffer) {
        abort(); /* This buffer is still being filled. */
    }
    if (!board.async_is_on || async.next != NULL) {
        return board.async_is_on ? -EBUSY : -EACCES;
    }
    async.next = buffer;
    async.next_size = size;
    return 0;
}

/* Reception ends later, in the interrupt. */
int uart_rx_disable(const struct device *device)
{
    (void)device;
    if (!board.async_is_on) {
        return -EFAULT;
    }
    async.ending = true;
    async.end_us = machine.now_us + 500u;
    irq_access();
    return 0;
}
