/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "web.h"

#define NUMBERS_MAX 64u

typedef struct {
    const char *name;
    uint32_t value;
} number_t;

static struct {
    number_t numbers[NUMBERS_MAX];
    uint32_t count;
} table;

uint8_t web_transfer[WEB_TRANSFER_SIZE];

void numbers_clear(void)
{
    table.count = 0;
}

void numbers_put(const char *name, uint32_t value)
{
    if (table.count < NUMBERS_MAX) {
        table.numbers[table.count++] = (number_t){name, value};
    }
}

uint32_t numbers_count(void)
{
    return table.count;
}

void numbers_put_ct(const tmini_ct_info_t *info)
{
    numbers_put("known", info->known);
    numbers_put("userMajor", info->user_major);
    numbers_put("userMinor", info->user_minor);
    numbers_put("ctFaults", info->faults);
    numbers_put("ctHardware", info->hardware);
    numbers_put("ctFirmwareMajor", info->firmware_major);
    numbers_put("ctFirmwareMinor", info->firmware_minor);
    numbers_put("year", info->year);
    numbers_put("month", info->month);
    numbers_put("day", info->day);
    numbers_put("number", info->number);
}

/* Pairs of a name's address and a value, 32 bits each. */
EXPORTED const void *numbers(void)
{
    return table.numbers;
}

EXPORTED uint8_t *transfer(void)
{
    return web_transfer;
}

EXPORTED uint32_t transfer_size(void)
{
    return WEB_TRANSFER_SIZE;
}
