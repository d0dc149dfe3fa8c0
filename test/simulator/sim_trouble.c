/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Names of troubles, for tests; apart, because the viewer has no C library. */

#include "simulator.h"

#include <stdlib.h>
#include <string.h>

static const char *const names[] = {"sound", "lost",   "late",    "doubled",   "cut",
                                    "deaf",  "silent", "reboots", "no-starts", "no-scans"};

const char *sim_trouble_name(sim_trouble_t trouble)
{
    return names[trouble];
}

sim_trouble_t sim_trouble_named(const char *text, uint32_t *for_ms)
{
    const size_t length = strcspn(text, "0123456789");
    unsigned trouble = SIM_NO_SCANS;
    *for_ms = (uint32_t)strtoul(text + length, NULL, 10);
    while (trouble > SIM_SOUND &&
           (strlen(names[trouble]) != length || strncmp(text, names[trouble], length) != 0)) {
        trouble--;
    }
    return (sim_trouble_t)trouble;
}
