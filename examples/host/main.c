/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini: checks a lidar, its wiring and recordings of it from a computer. */

#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "interrupt.h"
#include "message.h"
#include "tmini/tmini.h"

static const command_t *const commands[] = {
    &command_info,   &command_health, &command_frequency, &command_reboot, &command_scan,
    &command_record, &command_decode, &command_plot,      &command_view,
};

#define COMMANDS (sizeof commands / sizeof commands[0])

static void print_usage(FILE *file)
{
    (void)fputs("tmini: checks a YDLIDAR T-mini Plus, its wiring and recordings of it.\n\n", file);
    for (size_t i = 0; i < COMMANDS; i++) {
        (void)fprintf(file, "  tmini %-10s %s\n", commands[i]->name, commands[i]->summary);
    }
    (void)fputs("\ntmini COMMAND --help tells more. Exit status: 0 success, 1 failure, 2 wrong "
                "usage.\n",
                file);
}

static const command_t *find_command(const char *name)
{
    for (size_t i = 0; i < COMMANDS; i++) {
        if (strcmp(commands[i]->name, name) == 0) {
            return commands[i];
        }
    }
    return NULL;
}

/* Output that could not be written, for example to a full disk, must not pass for success. */
static int close_output(int status)
{
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        return message_fail("cannot write to standard output");
    }
    return status;
}

static int run(const command_t *command, int count, char *const *words)
{
    options_t options;
    const int status = options_parse(&options, command, count, words);
    if (status != STATUS_OK) {
        return status;
    }
    if (options.help) {
        options_help(command);
        return STATUS_OK;
    }
    message_silence(options.quiet);
    return command->run(&options);
}

int main(int argc, char **argv)
{
    const char *const name = argc > 1 ? argv[1] : "";
    interrupt_ignore_closed_pipes();
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_usage(stdout);
        return close_output(STATUS_OK);
    }
    if (strcmp(name, "--version") == 0) {
        (void)printf("tmini %d.%d.%d\n", TMINI_VERSION_MAJOR, TMINI_VERSION_MINOR,
                     TMINI_VERSION_PATCH);
        return close_output(STATUS_OK);
    }
    const command_t *const command = find_command(name);
    if (command == NULL) {
        print_usage(stderr);
        return argc > 1 ? message_usage("there is no command \"%s\"", name) : STATUS_USAGE;
    }
    return close_output(run(command, argc - 2, argv + 2));
}
