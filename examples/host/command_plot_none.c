/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini plot without cairo: compiled instead of command_plot.c and picture.c. */

#include "output.h"
#include "options.h"

static int run(const options_t *options)
{
    (void)options;
    return message_fail(
        "this tmini was built without cairo, so it cannot draw. To have `plot`, install cairo's\n"
        "development package and pkg-config (on Debian: libcairo2-dev pkg-config), and build "
        "again.");
}

const command_t command_plot = {
    .name = "plot",
    .usage = "",
    .summary = "a picture of a scan: not in this build, which is without cairo",
    .accepts = "poNAMFUOKq",
    .has_operand = true,
    .run = run,
};
