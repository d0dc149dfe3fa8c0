/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name;
    const char *value; /* what the value is called in the help; NULL: it takes none */
    const char *help;
    bool (*set)(options_t *options, const char *value); /* false: not a good value */
} option_t;

static bool set_help(options_t *options, const char *value)
{
    (void)value;
    options->help = true;
    return true;
}

static bool set_pty(options_t *options, const char *value)
{
    (void)value;
    options->pty = true;
    return true;
}

static bool set_no_ct(options_t *options, const char *value)
{
    (void)value;
    options->device.ct_information = false;
    return true;
}

static bool set_blocked(options_t *options, const char *value)
{
    (void)value;
    options->blocked = true;
    return true;
}

static bool set_covered(options_t *options, const char *value)
{
    (void)value;
    options->covered = true;
    return true;
}

/* The whole text, a number in low..high. */
static bool parse_number(const char *text, double low, double high, double *number)
{
    char *end;

    *number = strtod(text, &end);
    return end != text && *end == '\0' && *number >= low && *number <= high;
}

static bool set_tcp(options_t *options, const char *value)
{
    double port;

    options->tcp = true;
    if (!parse_number(value, 0, 65535, &port) || port > (double)(uint16_t)port) {
        return false;
    }
    options->tcp_port = (uint16_t)port;
    return true;
}

static bool set_write(options_t *options, const char *value)
{
    options->write_path = value;
    return true;
}

static bool set_log(options_t *options, const char *value)
{
    options->log_path = value;
    return true;
}

static bool set_truth(options_t *options, const char *value)
{
    options->truth_path = value;
    return true;
}

static bool set_frequency(options_t *options, const char *value)
{
    const double low = options->device.min_frequency_chz / 100.0;
    const double high = options->device.max_frequency_chz / 100.0;
    double hertz;

    if (!parse_number(value, low, high, &hertz)) {
        return false;
    }
    options->device.frequency_chz = (uint16_t)(hertz * 100.0 + 0.5);
    return true;
}

/* The six bits of section 4, also as 0x... */
static bool set_health(options_t *options, const char *value)
{
    char *end;
    const unsigned long bits = strtoul(value, &end, 0);

    options->health = (uint8_t)(bits & 0x3Fu);
    return end != value && *end == '\0' && *value != '-' && bits <= 0x3Fu;
}

static bool set_seconds(options_t *options, const char *value)
{
    return parse_number(value, 0.001, 1e9, &options->seconds);
}

static bool set_speed(options_t *options, const char *value)
{
    return parse_number(value, 0.001, 1000, &options->speed);
}

static bool set_seed(options_t *options, const char *value)
{
    char *end;

    options->device.seed = strtoull(value, &end, 0);
    options->link.seed = options->device.seed;
    return end != value && *end == '\0' && *value != '-';
}

static sim_link_kind_t kind_before(const char *value, const char *equals)
{
    char name[16] = "";

    if ((size_t)(equals - value) < sizeof name) {
        memcpy(name, value, (size_t)(equals - value));
    }
    return sim_link_kind_named(name);
}

/* A probability a byte, or events a second; either way the link wants the mean gap. */
static bool set_fault(options_t *options, const char *value)
{
    const char *equals = strchr(value, '=');
    const sim_link_kind_t kind = equals == NULL ? SIM_LINK_KINDS : kind_before(value, equals);
    double rate;
    double gap;

    if (kind == SIM_LINK_KINDS || !parse_number(equals + 1, 1e-9, 100, &rate)) {
        return false;
    }
    gap = (sim_link_counts_bytes(kind) ? 1.0 : 1000.0) / rate;
    if (gap < 1.0 || gap > 4e9) {
        return false;
    }
    options->link.mean_gap[kind] = (uint32_t)gap;
    return true;
}

static const option_t known[] = {
    {"--pty", NULL, "serve a pseudo-terminal; its path is the first line printed", set_pty},
    {"--tcp", "PORT", "serve 127.0.0.1:PORT (0: any free port; the first line says)", set_tcp},
    {"--write", "FILE", "record --seconds of scanning in virtual time, as fast as can be",
     set_write},
    {"--frequency", "HZ", "set scan frequency at power-up, 5 to 12 (6)", set_frequency},
    {"--no-ct", NULL, "send neither CT information nor LastCRC", set_no_ct},
    {"--blocked", NULL, "the rotor does not turn", set_blocked},
    {"--covered", NULL, "the window is covered: no ranges", set_covered},
    {"--health", "BITS",
     "faults reported, 0 to 0x3F: 1 sensor, 2 encoder,\n"
     "                        4 wireless power, 8 PD, 16 LD, 32 data (0)",
     set_health},
    {"--fault", "KIND=RATE",
     "drop, flip, insert: probability a byte;\n"
     "                        burst, stall, cut, unplug, garble: events a second",
     set_fault},
    {"--seed", "N", "of all that is random (1)", set_seed},
    {"--seconds", "N", "of virtual time, then exit (never)", set_seconds},
    {"--speed", "X", "virtual seconds a real second (1)", set_speed},
    {"--log", "FILE", "commands, modes, faults and totals; - is standard output", set_log},
    {"--truth", "FILE", "every sample sent, as CSV; - is standard output", set_truth},
    {"--help", NULL, "this", set_help},
};

#define KNOWN_OPTIONS (sizeof known / sizeof known[0])

void options_print_help(void)
{
    puts("usage: tmini-sim --pty | --tcp PORT | --write FILE --seconds N [options]\n"
         "A simulated YDLIDAR T-mini Plus.\n");
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        const char *value = known[i].value == NULL ? "" : known[i].value;

        printf("  %-11s %-10s%s\n", known[i].name, value, known[i].help);
    }
}

static const option_t *find(const char *name)
{
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        if (strcmp(known[i].name, name) == 0) {
            return &known[i];
        }
    }
    return NULL;
}

static bool complain(const char *about, const char *what)
{
    fprintf(stderr, "tmini-sim: %s%s; try tmini-sim --help\n", about, what);
    return false;
}

static int on_standard_output(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0 ? 1 : 0;
}

static bool is_consistent(const options_t *options)
{
    const int modes =
        (options->pty ? 1 : 0) + (options->tcp ? 1 : 0) + (options->write_path == NULL ? 0 : 1);

    if (options->help) {
        return true;
    }
    if (modes != 1) {
        return complain("", "give one of --pty, --tcp PORT and --write FILE");
    }
    if (options->write_path != NULL && options->seconds <= 0.0) {
        return complain("--write", " needs --seconds N");
    }
    if (on_standard_output(options->write_path) + on_standard_output(options->log_path) +
            on_standard_output(options->truth_path) >
        1) {
        return complain("", "only one of --write, --log and --truth can be -");
    }
    return true;
}

bool options_parse(options_t *options, int argc, char **argv)
{
    memset(options, 0, sizeof *options);
    options->speed = 1.0;
    options->device = sim_default_config();
    options->link = sim_link_default_config();
    for (int i = 1; i < argc; i++) {
        const option_t *option = find(argv[i]);

        if (option == NULL) {
            return complain(argv[i], " is not an option");
        }
        if (option->value != NULL && i + 1 == argc) {
            return complain(option->name, " needs a value");
        }
        i += option->value != NULL ? 1 : 0;
        if (!option->set(options, argv[i])) {
            return complain(option->name, " has a value out of range or form");
        }
    }
    return is_consistent(options);
}
