/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Names of troubles, for tests; apart, because the viewer has no C library. */

#include "simulator.h"

#include <stdlib.h>
#include <string.h>

const char *sim_trouble_name(sim_trouble_t trouble)
{
    static const char *const names[] = {"sound", "lost",   "late",    "doubled",   "cut",
                                        "deaf",  "silent", "reboots", "no-starts", "no-scans"};
    return names[trouble];
}

static bool is_named(const char *text, size_t length, sim_trouble_t trouble)
{
    const char *const name = sim_trouble_name(trouble);
    return strlen(name) == length && strncmp(text, name, length) == 0;
}

sim_trouble_t sim_trouble_named(const char *text, uint32_t *for_ms)
{
    const size_t length = strcspn(text, "0123456789");
    unsigned trouble = SIM_NO_SCANS;
    *for_ms = (uint32_t)strtoul(text + length, NULL, 10);
    while (trouble > SIM_SOUND && !is_named(text, length, (sim_trouble_t)trouble)) {
        trouble--;
    }
    return (sim_trouble_t)trouble;
}
