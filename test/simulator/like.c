/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "like.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLACE(member) offsetof(options_t, member)

/* Key of a number that, multiplied by `scale`, goes into the member of `size` bytes at `place`. */
typedef struct {
    const char *key;
    size_t place;
    size_t size;
    double scale;
    double max;
} number_t;

#define NUMBER(key, member, scale, max)                                     \
    {                                                                       \
        key, PLACE(member), sizeof(((options_t *)NULL)->member), scale, max \
    }

static const number_t numbers[] = {
    NUMBER("model", device.information.model, 1, 255),
    NUMBER("hardware", device.information.hardware, 1, 255),
    NUMBER("health", health, 1, 63),
    NUMBER("frequency_hz", device.frequency_chz, 100, 20),
    NUMBER("min_frequency_hz", device.min_frequency_chz, 100, 20),
    NUMBER("max_frequency_hz", device.max_frequency_chz, 100, 20),
    NUMBER("reply_ms", device.reply_latency_ms, 1, 10000),
    NUMBER("boot_ms", device.boot_ms, 1, 60000),
    NUMBER("first_packet_ms", device.first_packet_ms, 1, 60000),
    NUMBER("spin_up_ms", device.spin_up_ms, 1, 60000),
    NUMBER("spin_up_percent", device.spin_up_percent, 1, 100),
    NUMBER("motor_percent", device.motor_percent, 1, 200),
    NUMBER("stop_tail_ms", device.stop_tail_ms, 1, 60000),
    NUMBER("first_angle_deg", device.first_angle_q6, 64, 359),
    NUMBER("start_angle_deg", device.start_angle_q6, 64, 359),
    NUMBER("samples_per_packet", device.samples_per_packet, 1, 40),
    NUMBER("flagged_permille", device.flagged_permille, 1, 1000),
};

/* The word sets the switch; any other value clears it. */
static const struct {
    const char *key;
    const char *word;
    size_t place;
} switches[] = {
    {"steps", "refused", PLACE(device.refuses_steps)},
    {"frequency_survives", "yes", PLACE(device.keeps_frequency)},
    {"ct_information", "yes", PLACE(device.ct_information)},
    {"firmware_order", "major-first", PLACE(device.firmware_major_first)},
    {"serial_digits", "ascii", PLACE(device.ascii_serial)},
};

static void store(options_t *options, const number_t *number, double value)
{
    const uint16_t scaled = (uint16_t)(value * number->scale + 0.5);
    const uint8_t byte = (uint8_t)scaled;

    memcpy((char *)options + number->place,
           number->size == 1 ? (const void *)&byte : (const void *)&scaled, number->size);
}

static bool set_number(options_t *options, const char *key, const char *value)
{
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (strcmp(key, numbers[i].key) == 0) {
            char *end;
            const double read = strtod(value, &end);

            if (end == value || *end != '\0' || !(read >= 0.0 && read <= numbers[i].max)) {
                return false;
            }
            store(options, &numbers[i], read);
        }
    }
    return true;
}

static void set_switch(options_t *options, const char *key, const char *value)
{
    for (size_t i = 0; i < sizeof switches / sizeof switches[0]; i++) {
        if (strcmp(key, switches[i].key) == 0) {
            *(bool *)((char *)options + switches[i].place) = strcmp(value, switches[i].word) == 0;
        }
    }
}

static bool set_version(const char *value, uint8_t *major, uint8_t *minor)
{
    unsigned read[2];

    if (sscanf(value, "%u.%u", &read[0], &read[1]) != 2 || read[0] > 255u || read[1] > 255u) {
        return false;
    }
    *major = (uint8_t)read[0];
    *minor = (uint8_t)read[1];
    return true;
}

static bool set_serial(sim_config_t *device, const char *value)
{
    const size_t count = sizeof device->information.serial;

    if (strlen(value) != count || strspn(value, "0123456789") != count) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        device->information.serial[i] = (uint8_t)(value[i] - '0');
    }
    return true;
}

static bool set_beginning(sim_config_t *device, const char *value)
{
    device->beginning = strcmp(value, "start") == 0      ? SIM_BEGINS_WITH_A_START
                        : strcmp(value, "unmarked") == 0 ? SIM_BEGINS_UNMARKED
                                                         : SIM_BEGINS_ANYWHERE;
    return device->beginning != SIM_BEGINS_ANYWHERE || strcmp(value, "anywhere") == 0;
}

static bool set(options_t *options, const char *key, const char *value)
{
    sim_config_t *device = &options->device;

    if (strcmp(value, "unknown") == 0) {
        return true;
    }
    if (strcmp(key, "firmware") == 0) {
        return set_version(value, &device->information.firmware_major,
                           &device->information.firmware_minor);
    }
    if (strcmp(key, "user_version") == 0) {
        return set_version(value, &device->user_major, &device->user_minor);
    }
    if (strcmp(key, "serial") == 0) {
        return set_serial(device, value);
    }
    if (strcmp(key, "first_packets") == 0) {
        return set_beginning(device, value);
    }
    if (strcmp(key, "lone_packets") == 0 && strcmp(value, "no") == 0) {
        device->lone_packet_permille = 0;
    }
    set_switch(options, key, value);
    return set_number(options, key, value);
}

bool like_read(options_t *options, const char *path)
{
    FILE *file = fopen(path, "r");
    char line[200];
    bool is_good = file != NULL;
    bool is_report = false;

    while (is_good && fgets(line, sizeof line, file) != NULL) {
        char key[40];
        char value[120];

        if (line[0] != '#' && sscanf(line, "%39s = %119[^\n]", key, value) == 2) {
            is_good = set(options, key, value);
            is_report = true;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return is_good && is_report;
}
