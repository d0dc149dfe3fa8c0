/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "like.h"

#include "members.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLACE(member) offsetof(options_t, member)

static const struct {
    const char *key;
    number_t number;
} numbers[] = {
    {"model", NUMBER(device.information.model, 1, 0, 255)},
    {"hardware", NUMBER(device.information.hardware, 1, 0, 255)},
    {"health", NUMBER(health, 1, 0, 63)},
    {"frequency_hz", NUMBER(device.frequency_chz, 100, 0, 20)},
    {"min_frequency_hz", NUMBER(device.min_frequency_chz, 100, 0, 20)},
    {"max_frequency_hz", NUMBER(device.max_frequency_chz, 100, 0, 20)},
    {"reply_ms", NUMBER(device.reply_latency_ms, 1, 0, 10000)},
    {"boot_ms", NUMBER(device.boot_ms, 1, 0, 60000)},
    {"first_packet_ms", NUMBER(device.first_packet_ms, 1, 0, 60000)},
    {"spin_up_ms", NUMBER(device.spin_up_ms, 1, 0, 60000)},
    {"spin_up_percent", NUMBER(device.spin_up_percent, 1, 0, 100)},
    {"motor_percent", NUMBER(device.motor_percent, 1, 0, 200)},
    {"stop_tail_ms", NUMBER(device.stop_tail_ms, 1, 0, 60000)},
    {"first_angle_deg", NUMBER(device.first_angle_q6, 64, 0, 359)},
    {"start_angle_deg", NUMBER(device.start_angle_q6, 64, 0, 359)},
    {"samples_per_packet", NUMBER(device.samples_per_packet, 1, 0, 40)},
    {"flagged_permille", NUMBER(device.flagged_permille, 1, 0, 1000)},
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

bool like_parse(const char *text, double low, double high, double *number)
{
    char *end;
    *number = strtod(text, &end);
    return end != text && *end == '\0' && *number >= low && *number <= high;
}

bool like_read_number(options_t *options, const number_t *number, const char *text)
{
    char *const place = (char *)options + number->place;
    double value;
    if (!like_parse(text, number->low, number->high, &value)) {
        return false;
    }
    const double scaled = value * number->scale;
    if (number->size == sizeof scaled) {
        memcpy(place, &scaled, sizeof scaled);
    } else {
        member_store(place, number->size, (uint64_t)(int64_t)(scaled + (scaled < 0 ? -0.5 : 0.5)));
    }
    return true;
}

bool like_find(const char *name, const char *const *names, unsigned count, unsigned *found)
{
    *found = 0;
    while (*found < count && strcmp(name, names[*found]) != 0) {
        ++*found;
    }
    return *found < count;
}

static bool set_beginning(options_t *options, const char *value)
{
    static const char *const names[] = {[SIM_BEGINS_ANYWHERE] = "anywhere",
                                        [SIM_BEGINS_UNMARKED] = "unmarked",
                                        [SIM_BEGINS_WITH_A_START] = "start"};
    unsigned beginning;
    const bool is_known = like_find(value, names, 3, &beginning);
    options->device.beginning = (sim_beginning_t)(beginning % 3);
    return is_known;
}

static bool set_number(options_t *options, const char *key, const char *value)
{
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (strcmp(key, numbers[i].key) == 0) {
            return like_read_number(options, &numbers[i].number, value);
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

bool like_set(options_t *options, const char *key, const char *value)
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
        return set_beginning(options, value);
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
        if (sscanf(line, "%39s = %119[^\n]", key, value) == 2) {
            is_good = like_set(options, key, value);
            is_report = true;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return is_good && is_report;
}
