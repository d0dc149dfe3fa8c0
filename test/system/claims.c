/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "claims.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static char complaint[200];

bool is_right(void)
{
    return complaint[0] == '\0';
}

void expect(bool is_true, const char *format, ...)
{
    va_list arguments;

    if (is_true || !is_right()) {
        return;
    }
    va_start(arguments, format);
    (void)vsnprintf(complaint, sizeof complaint, format, arguments);
    va_end(arguments);
}

static bool is_among(const char *name, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(names[i], name) == 0) {
            return true;
        }
    }
    return false;
}

static bool check(const claim_t *claim)
{
    complaint[0] = '\0';
    claim->run(claim->argument);
    printf("%s %s%s%s\n", is_right() ? "PASS" : "FAIL", claim->name, is_right() ? "" : ": ",
           complaint);
    return is_right();
}

int claims_main(int argc, char **argv, const claim_t *claims, size_t count)
{
    const bool is_list = argc > 1 && strcmp(argv[1], "--list") == 0;
    const char *const *const chosen = (const char *const *)argv + 1;
    unsigned wrong = 0;
    unsigned checked = 0;

    for (size_t i = 0; i < count; i++) {
        if (is_list) {
            printf("%s\n", claims[i].name);
        } else if (argc == 1 || is_among(claims[i].name, chosen, (size_t)argc - 1)) {
            checked++;
            wrong += check(&claims[i]) ? 0 : 1;
        }
    }
    if (!is_list && checked == 0) {
        printf("no such row: see --list\n");
        return 2;
    }
    return wrong == 0 ? 0 : 1;
}
