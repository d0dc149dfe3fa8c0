/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "faults.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char *const names[6] = {
    "sensor",           "encoder (is the rotor blocked?)", "wireless power", "laser feedback (PD)",
    "laser drive (LD)", "data (is the window covered?)",
};

const char *faults_text(uint8_t faults, char text[FAULTS_TEXT_SIZE])
{
    (void)snprintf(text, FAULTS_TEXT_SIZE, "%s", faults == 0 ? "healthy" : "faulty: ");
    bool is_first = true;
    for (unsigned bit = 0; bit < 6; bit++) {
        if (((unsigned)faults >> bit & 1u) != 0) {
            const size_t length = strlen(text);
            (void)snprintf(text + length, FAULTS_TEXT_SIZE - length, "%s%s", is_first ? "" : ", ",
                           names[bit]);
            is_first = false;
        }
    }
    return text;
}
