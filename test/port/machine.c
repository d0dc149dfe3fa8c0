/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "machine.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console.h"
#include "irq_lines.h"

#define STEP_US 40u
#define LINE_BYTES 8192u
#define SILENCE_US 10000u /* Longer than anything that follows from the last byte. */
#define IDLE_MAX_US 1000000u

machine_t machine;

/* What a test sends. */
static struct {
    uint8_t bytes[LINE_BYTES];
    uint16_t flags[LINE_BYTES];
    size_t first;
    size_t count;
    uint64_t begun_ns; /* When the first byte of all began. */
    uint64_t asked_us; /* By then the lidar had no more bytes. */
} line;

static void fail(unsigned number)
{
    fprintf(stderr, "the handler of line %u leaves its flag set: a lock-up\n", number);
    abort();
}

void machine_new_lidar(const sim_observer_t *observer)
{
    sim_config_t config = sim_default_config();
    config.marked =
        observer != NULL; /* So that each point shows which sample it is (scanning.h). */
    sim_init(&machine.lidar, &config);
    if (observer != NULL) {
        sim_observe(&machine.lidar, observer);
    }
}

void machine_begin(const sim_observer_t *observer, const machine_uart_t *uart)
{
    console_begin();
    memset(&machine, 0, sizeof machine);
    memset(&line, 0, sizeof line);
    machine.uart = *uart;
    machine_new_lidar(observer);
    irq_reset(fail);
    irq.lines[0] = (irq_line_t){.is_up = uart->is_up, .handler = uart->serve};
}

static void arrive(uint32_t flags, uint8_t byte)
{
    machine.line_bytes++;
    machine.last_us = machine.now_us;
    machine.uart.arrive(flags, byte);
    if (machine.uart.move != NULL) {
        machine.uart.move();
    }
}

static uint64_t end_of_byte_ns(size_t index)
{
    return line.begun_ns + (index + 1) * (uint64_t)MACHINE_BYTE_NS;
}

void machine_send(uint32_t flags, const uint8_t *bytes, size_t count)
{
    if (machine_has_sent()) {
        const uint64_t free_ns = line.count > 0 ? end_of_byte_ns(line.count - 1) : 0;
        line.begun_ns = machine.now_ns > free_ns ? machine.now_ns : free_ns;
        line.first = line.count = 0;
    }
    for (size_t i = 0; i < count && line.count < LINE_BYTES; i++) {
        line.flags[line.count] = (uint16_t)(i == 0 ? flags : 0);
        line.bytes[line.count++] = bytes[i];
    }
}

bool machine_has_sent(void)
{
    return line.first == line.count;
}

static bool lidar_sends(uint8_t *byte)
{
    if (line.asked_us != machine.now_us &&
        sim_transmit(&machine.lidar, machine.now_us, byte, 1) == 1) {
        return true;
    }
    line.asked_us = machine.now_us;
    return false;
}

/* The next byte that has arrived by now. */
static bool next_byte(uint32_t *flags, uint8_t *byte)
{
    *flags = 0;
    if (machine_has_sent() || end_of_byte_ns(line.first) > machine.now_ns) {
        return lidar_sends(byte);
    }
    *flags = line.flags[line.first];
    *byte = line.bytes[line.first++];
    return true;
}

static void advance(uint64_t ns, void (*after_byte)(void))
{
    uint32_t flags;
    uint8_t byte;
    machine.now_ns += ns;
    machine.now_us = machine.now_ns / 1000u;
    while (next_byte(&flags, &byte)) {
        arrive(flags, byte);
        after_byte();
    }
    if (machine.uart.move != NULL) {
        machine.uart.move();
    }
}

static void do_nothing(void) {}

void machine_step(uint32_t us)
{
    advance(us * UINT64_C(1000), irq_serve);
    irq_serve();
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

void machine_idle(uint64_t until_us)
{
    uint64_t end_us = machine.now_us + STEP_US;
    if (machine_has_sent() && machine.now_us - machine.last_us > SILENCE_US) {
        const uint64_t next_us = earlier(until_us, sim_next_us(&machine.lidar));
        end_us = next_us < end_us ? end_us : earlier(next_us, machine.now_us + IDLE_MAX_US);
    }
    machine_step((uint32_t)(end_us - machine.now_us));
}

void machine_access(void)
{
    if (machine.access_ns > 0) {
        advance(machine.access_ns, do_nothing);
    }
    irq_access();
}

static void switch_tasks(void)
{
    if (machine.uart.switch_tasks != NULL && !irq.masked) {
        machine.uart.switch_tasks();
    }
}

void machine_pass(uint32_t us)
{
    for (const uint64_t end_us = machine.now_us + us; machine.now_us < end_us;) {
        const uint64_t left_us = end_us - machine.now_us;
        machine_step(left_us < STEP_US ? (uint32_t)left_us : STEP_US);
        switch_tasks();
    }
}

void machine_pass_held_up(uint32_t us)
{
    irq.masked = true;
    machine_pass(us);
    irq.masked = false;
    irq_serve();
}

void machine_receive(uint32_t flags, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        arrive(flags, bytes[i]);
        if (machine.count == machine.uart.fifo_size || i + 1 == count) {
            irq_serve();
        }
    }
}

bool machine_put(uint32_t entry)
{
    if (machine.count >= machine.uart.fifo_size) {
        return false;
    }
    machine.fifo[machine.count++] = (uint16_t)entry;
    return true;
}

bool machine_must_read(size_t level, uint32_t timeout_us)
{
    return machine.count >= level ||
           (machine.count > 0 && machine.now_us - machine.last_us >= timeout_us);
}

uint16_t machine_take(void)
{
    const uint16_t entry = machine.fifo[0];
    machine.count--;
    memmove(machine.fifo, &machine.fifo[1], machine.count * sizeof machine.fifo[0]);
    return entry;
}

size_t machine_read(uint8_t *bytes, size_t max)
{
    size_t taken = 0;
    while (taken < max && machine.count > 0) {
        bytes[taken++] = (uint8_t)machine_take();
    }
    return taken;
}

void machine_sleep_us(uint64_t us)
{
    machine_pass((uint32_t)us);
    if (machine.on_sleep != NULL) {
        machine.on_sleep();
    }
}

void machine_power(bool on)
{
    sim_power(&machine.lidar, on, machine.now_us);
}

/* Interrupts also come at accesses to the library's indices. */
void interrupt(void)
{
    machine_access();
    switch_tasks();
}

int machine_printf(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = console_print(machine.now_us, format, arguments);
    va_end(arguments);
    return length;
}
