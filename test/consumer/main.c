/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Uses the library. The library's strict warnings would refuse this code: they must not apply. */

#include <stdio.h>

#include "tmini/tmini_names.h"

int sloppy(long wide, int unused)
{
    int narrow = wide;
    {
        int narrow = 3;
        (void)narrow;
    }
    return narrow;
}

int main()
{
    puts(tmini_status_name(TMINI_OK));
    return sloppy(0, 1);
}
