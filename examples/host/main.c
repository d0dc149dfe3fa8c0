/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini: checks a lidar, its wiring and recordings of it from a computer. */

#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "options.h"
#include "interrupt.h"
#include "message.h"
#include "tmini/tmini.h"

static const command_t *const commands[] = {
    &command_ports,     &command_check,  &command_info, &command_health,
    &command_frequency, &command_reboot, &command_scan, &command_record,
    &command_decode,    &command_plot,   &command_view,
};

#define COMMANDS (sizeof commands / sizeof commands[0])

/* If 0, 1 or 2 came closed, the port would get that number, and results be sent to the lidar. What
 * takes the place fails when it is used. */
static void hold_standard_descriptors(void)
{
    static const int useless[3] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int fd = 0; fd < 3; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", useless[fd]);
        }
    }
}

static int print_usage(FILE *file, int status)
{
    (void)fputs("tmini: checks a YDLIDAR T-mini Plus, its wiring and recordings of it.\n\n", file);
    for (size_t i = 0; i < COMMANDS; i++) {
        (void)fprintf(file, "  tmini %-10s %s\n", commands[i]->name, commands[i]->summary);
    }
    (void)fputs("\ntmini COMMAND --help tells more. Exit status: 0 success, 1 failure, 2 wrong "
                "usage.\n",
                file);
    return status;
}

static int print_version(void)
{
    (void)printf("tmini %d.%d.%d\n", TMINI_VERSION_MAJOR, TMINI_VERSION_MINOR, TMINI_VERSION_PATCH);
    return STATUS_OK;
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

static int run(options_t *options)
{
    if (options->command != NULL && strcmp(options->command, "help") == 0) {
        options->help = true;
        options->command = options->operand;
    }
    if (options->version) {
        return print_version();
    }
    if (options->command == NULL) {
        return options->help ? print_usage(stdout, STATUS_OK) : print_usage(stderr, STATUS_USAGE);
    }
    const command_t *const command = find_command(options->command);
    if (command == NULL) {
        (void)print_usage(stderr, STATUS_USAGE);
        return message_usage("there is no command \"%s\"", options->command);
    }
    if (options->help) {
        options_help(command);
        return STATUS_OK;
    }
    message_silence(options->quiet);
    const int status = options_check(options, command);
    return status == STATUS_OK ? command->run(options) : status;
}

/* Output that could not be written, for example to a full disk, must not pass for success. */
static int close_output(int status)
{
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        return message_fail("cannot write to standard output");
    }
    return status;
}

int main(int argc, char **argv)
{
    options_t options;
    hold_standard_descriptors();
    interrupt_watch_pipes();
    const int status = options_parse(&options, argc, argv);
    return close_output(status == STATUS_OK ? run(&options) : status);
}
