/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "console.h"

#include "stm32f405.h"

#define SIZE 2048u /* A power of two. */

static char buffer[SIZE];
static uint32_t head;
static uint32_t tail;

static void put(char character)
{
    if (head - tail < SIZE) {
        buffer[head % SIZE] = character;
        head++;
    }
}

void console_text(const char *text)
{
    while (*text != '\0') {
        put(*text);
        text++;
    }
}

/* Writes at least `digits` digits. */
static void put_number(uint32_t value, unsigned digits, uint32_t base)
{
    char text[10];
    unsigned length = 0;
    while (value > 0 || length < digits) {
        text[length] = "0123456789abcdef"[value % base];
        value /= base;
        length++;
    }
    while (length > 0) {
        length--;
        put(text[length]);
    }
}

static void put_name(const char *name)
{
    put(' ');
    console_text(name);
    put(' ');
}

void console_value(const char *name, uint32_t value)
{
    put_name(name);
    put_number(value, 1, 10);
}

void console_hundredths(const char *name, uint32_t hundredths)
{
    put_name(name);
    put_number(hundredths / 100, 1, 10);
    put('.');
    put_number(hundredths % 100, 2, 10);
}

void console_version(const char *name, uint32_t major, uint32_t minor)
{
    put_name(name);
    put_number(major, 1, 10);
    put('.');
    put_number(minor, 1, 10);
}

void console_hex(const char *name, uint32_t value)
{
    put_name(name);
    put_number(value, 8, 16);
}

void console_line_end(void)
{
    console_text("\r\n");
}

bool console_work(void)
{
    while (tail != head && (USART2_SR & USART_SR_TXE) != 0) {
        USART2_DR = (uint8_t)buffer[tail % SIZE];
        tail++;
    }
    return tail == head;
}

char console_key(void)
{
    return (USART2_SR & USART_SR_RXNE) != 0 ? (char)(USART2_DR & 0x7Fu) : '\0';
}
