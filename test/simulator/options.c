/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _GNU_SOURCE /* getopt_long() */

#include "options.h"

#include "like.h"

#include <getopt.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char letter; /* its short form; 0: none */
    const char *name;
    const char *value; /* name of its value in the help; NULL: it takes none */
    const char *help;
    bool (*set)(options_t *options, const char *value); /* false: invalid value */
    size_t place; /* if `set` is NULL: offset of the bool or string that is set */
} option_t;

#define PLACE(member) offsetof(options_t, member)

static bool set_no_ct(options_t *options, const char *value)
{
    (void)value;
    options->device.ct_information = false;
    return true;
}

/* The whole text must be a number in low..high. */
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

/* Major and minor have one digit each, as on the units' labels. */
static bool set_firmware(options_t *options, const char *value)
{
    encode_information_t *const information = &options->device.information;

    if (strlen(value) != 3 || value[1] != '.' || value[0] < '0' || value[0] > '9' ||
        value[2] < '0' || value[2] > '9') {
        return false;
    }
    information->firmware_major = (uint8_t)(value[0] - '0');
    information->firmware_minor = (uint8_t)(value[2] - '0');
    return true;
}

/* The angles are those of two real units (section 9.8). */
static bool set_beginning(options_t *options, const char *value)
{
    sim_config_t *const device = &options->device;

    if (strcmp(value, "unmarked") == 0) {
        device->beginning = SIM_BEGINS_UNMARKED;
        device->first_angle_q6 = 21101; /* 329.7 degrees. */
    } else if (strcmp(value, "start") == 0) {
        device->beginning = SIM_BEGINS_WITH_A_START;
        device->first_angle_q6 = 5485; /* 85.7 degrees. */
    } else {
        device->beginning = SIM_BEGINS_ANYWHERE;
    }
    return device->beginning != SIM_BEGINS_ANYWHERE || strcmp(value, "anywhere") == 0;
}

/* The six bits of section 4, decimal or hexadecimal (0x...). */
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

static bool set_motor(options_t *options, const char *value)
{
    double percent;

    if (!parse_number(value, 1, 150, &percent)) {
        return false;
    }
    options->device.motor_percent = (uint8_t)percent;
    return true;
}

static bool set_spin_up(options_t *options, const char *value)
{
    double seconds;

    if (!parse_number(value, 0, 60, &seconds)) {
        return false;
    }
    options->device.spin_up_ms = (uint16_t)(seconds * 1000.0);
    return true;
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

/* The value is a probability per byte, or events per second; the link needs its inverse. */
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

static bool set_model(options_t *options, const char *value)
{
    double model;

    if (!parse_number(value, 0, 255, &model)) {
        return false;
    }
    options->device.information.model = (uint8_t)model;
    return true;
}

static bool set_samples(options_t *options, const char *value)
{
    options->bridge.sample_size = (uint8_t)(value[0] - '0');
    return strcmp(value, "2") == 0 || strcmp(value, "3") == 0 || strcmp(value, "4") == 0;
}

static bool set_bridge(options_t *options, const char *value)
{
    return bridge_kind_named(value, &options->bridge.kind);
}

static bool set_bursts(options_t *options, const char *value)
{
    double milliseconds;

    if (!parse_number(value, 1, 4000, &milliseconds)) {
        return false;
    }
    options->bridge.bursts_ms = (uint16_t)milliseconds;
    return true;
}

static bool set_blind(options_t *options, const char *value)
{
    double every;

    if (!parse_number(value, 1, 255, &every)) {
        return false;
    }
    options->bridge.blind_every = (uint8_t)every;
    return true;
}

static bool set_boot(options_t *options, const char *value)
{
    double seconds;

    if (!parse_number(value, 0, 60, &seconds)) {
        return false;
    }
    options->boots = true;
    options->device.boot_ms = (uint16_t)(seconds * 1000.0);
    return true;
}

static bool set_turned(options_t *options, const char *value)
{
    double degrees;

    if (!parse_number(value, 0, 359.99, &degrees)) {
        return false;
    }
    options->device.turned_q6 = (uint16_t)(degrees * 64.0 + 0.5);
    return true;
}

static bool set_turning(options_t *options, const char *value)
{
    double degrees;

    if (!parse_number(value, -360, 360, &degrees)) {
        return false;
    }
    options->device.turning_q6_s = (int32_t)(degrees * 64.0);
    return true;
}

static bool set_mast(options_t *options, const char *value)
{
    unsigned from, to, mm;
    char end;

    if (sscanf(value, "%u:%u:%u%c", &from, &to, &mm, &end) != 3 || from > 359 || to < from ||
        to > 359 || mm > 9999) {
        return false;
    }
    options->device.mast_from_q6 = (uint16_t)(from * 64u);
    options->device.mast_wide_q6 = (uint16_t)((to - from) * 64u);
    options->device.mast_mm = (uint16_t)mm;
    return true;
}

static bool set_longer(options_t *options, const char *value)
{
    double mm;

    if (!parse_number(value, -40, 1000, &mm)) {
        return false;
    }
    options->device.range_error_mm = (int16_t)mm;
    return true;
}

static const option_t known[] = {
    {0, "pty", NULL, "serve a pseudo-terminal; its path is the first line printed", NULL,
     PLACE(pty)},
    {0, "tcp", "PORT", "serve 127.0.0.1:PORT (0: any free port, printed in the first line)",
     set_tcp, 0},
    {0, "lines", NULL,
     "time comes by standard input: lines of MICROSECONDS and the bytes\n"
     "                          received then, in hexadecimal; each is answered by the bytes sent",
     NULL, PLACE(lines)},
    {0, "write", "FILE", "record --seconds of scanning in virtual time, as fast as possible", NULL,
     PLACE(write_path)},
    {0, "frequency", "HZ", "set scan frequency at power-up, 5 to 12 (6)", set_frequency, 0},
    {0, "firmware", "X.Y", "version of the firmware (1.2; 1.3 is in the field)", set_firmware, 0},
    {0, "begin", "HOW",
     "first packets after a start: anywhere, unmarked (they pass the start\n"
     "                          packet's place without one), start (the first is one) (anywhere)",
     set_beginning, 0},
    {0, "like", "REPORT", "as the unit that `tmini survey` has written this report of", like_read,
     0},
    {0, "no-ct", NULL, "send neither CT information nor LastCRC", set_no_ct, 0},
    {0, "blocked", NULL, "the rotor does not turn", NULL, PLACE(blocked)},
    {0, "covered", NULL, "the window is covered: no ranges", NULL, PLACE(covered)},
    {0, "health", "BITS",
     "faults reported, 0 to 0x3F: 1 sensor, 2 encoder,\n"
     "                          4 wireless power, 8 PD, 16 LD, 32 data (0)",
     set_health, 0},
    {0, "motor", "PERCENT", "share of the set frequency that the motor reaches, 1 to 150 (100)",
     set_motor, 0},
    {0, "spin-up", "SECONDS", "time from standstill to that speed, 0 to 60 (1)", set_spin_up, 0},
    {0, "boot", "SECONDS", "gets power when the port is opened, and boots for 0 to 60 s", set_boot,
     0},
    {0, "model", "N", "number of the model (151)", set_model, 0},
    {0, "samples", "BYTES", "packets of another unit: samples of 2 or 4 bytes (3)", set_samples, 0},
    {0, "blind", "N", "each turn of N has no range, and no fault", set_blind, 0},
    {0, "bridge", "KIND",
     "a bridge or terminal in between: telnet (doubles FF), crnl (0D\n"
     "                          becomes 0A), xonxoff (takes 11 and 13), seven (bits)",
     set_bridge, 0},
    {0, "bursts", "MS", "a bridge that delivers what came in the meantime every 1 to 4000 ms",
     set_bursts, 0},
    {0, "turned", "DEGREES", "its angle at the room's 0, clockwise: it is mounted turned (0)",
     set_turned, 0},
    {0, "turning", "DEG/S", "the robot under it is turned, clockwise (0)", set_turning, 0},
    {0, "mast", "FROM:TO:MM", "it sees a part of the robot, in whole degrees", set_mast, 0},
    {0, "longer", "MM", "its ranges are too long by this, -40 to 1000 (0)", set_longer, 0},
    {0, "fault", "KIND=RATE",
     "drop, flip, insert: probability per byte;\n"
     "                          burst, stall, cut, unplug, garble: events per second",
     set_fault, 0},
    {0, "seed", "N", "seed of all that is random (1)", set_seed, 0},
    {'s', "seconds", "N", "virtual time, then exit (never)", set_seconds, 0},
    {0, "speed", "X", "virtual seconds per real second, 0.001 to 1000 (1)", set_speed, 0},
    {0, "log", "FILE", "commands, modes, faults and totals; - is standard output", NULL,
     PLACE(log_path)},
    {0, "truth", "FILE", "every sample sent, as CSV; - is standard output", NULL,
     PLACE(truth_path)},
    {'h', "help", NULL, "this text", NULL, PLACE(help)},
    {'V', "version", NULL, "the version", NULL, PLACE(version)},
};

#define KNOWN_OPTIONS (sizeof known / sizeof known[0])

void options_print_version(void)
{
    puts("tmini-sim " TMINI_SIM_VERSION);
}

static void print_option(FILE *file, const option_t *option)
{
    const char letter[4] = {'-', option->letter, ',', '\0'};

    fprintf(file, "%3s --%-9s %-10s%s\n", option->letter == 0 ? "" : letter, option->name,
            option->value == NULL ? "" : option->value, option->help);
}

void options_print_help(void)
{
    puts("usage: tmini-sim --pty | --tcp PORT | --lines | --write FILE --seconds N [options]\n"
         "A simulated YDLIDAR T-mini Plus.\n");
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        print_option(stdout, &known[i]);
    }
}

static bool complain(const char *about, const char *what)
{
    fprintf(stderr, "tmini-sim: %s%s; try tmini-sim --help\n", about, what);
    return false;
}

static bool complain_of(const option_t *option, const char *value)
{
    fprintf(stderr, "tmini-sim: --%s does not take %s:\n", option->name, value);
    print_option(stderr, option);
    return false;
}

static int on_standard_output(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0 ? 1 : 0;
}

static bool is_consistent(const options_t *options)
{
    const int modes = (options->pty ? 1 : 0) + (options->tcp ? 1 : 0) + (options->lines ? 1 : 0) +
                      (options->write_path == NULL ? 0 : 1);

    if (options->help || options->version) {
        return true;
    }
    if (modes != 1) {
        return complain("", "give one of --pty, --tcp PORT, --lines and --write FILE");
    }
    if (options->write_path != NULL && options->seconds <= 0.0) {
        return complain("--write", " needs --seconds N");
    }
    if ((options->lines ? 1 : 0) + on_standard_output(options->write_path) +
            on_standard_output(options->log_path) + on_standard_output(options->truth_path) >
        1) {
        return complain("",
                        "only one of --lines, --write, --log and --truth can have standard output");
    }
    return true;
}

/* Lists the options for getopt_long(). The short ones begin with ":", which suppresses its error
 * messages. A long one returns BEYOND (above all characters) plus its index in the table. */
#define BEYOND 256

static void list_options(char *short_ones, struct option *long_ones)
{
    *short_ones++ = ':';
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        const int has_value = known[i].value != NULL ? required_argument : no_argument;

        long_ones[i].name = known[i].name;
        long_ones[i].has_arg = has_value;
        long_ones[i].val = BEYOND + (int)i;
        if (known[i].letter != 0) {
            *short_ones++ = known[i].letter;
            *short_ones++ = ':';
            short_ones -= has_value == no_argument ? 1 : 0;
        }
    }
    *short_ones = '\0';
}

static const option_t *option_of(int answer)
{
    size_t i = 0;

    while (answer < BEYOND && i < KNOWN_OPTIONS && known[i].letter != answer) {
        i++;
    }
    i = answer < BEYOND ? i : (size_t)(answer - BEYOND);
    return i < KNOWN_OPTIONS ? &known[i] : NULL;
}

static bool set(options_t *options, const option_t *option, const char *value)
{
    char *const place = (char *)options + option->place;

    if (option->set != NULL) {
        return option->set(options, value);
    }
    if (option->value == NULL) {
        *(bool *)place = true;
    } else {
        memcpy(place, &value, sizeof value);
    }
    return true;
}

static bool take(options_t *options, int answer, const char *word)
{
    const option_t *option = answer == '?' || answer == ':' ? NULL : option_of(answer);

    if (option == NULL) {
        return complain(word,
                        answer == ':' ? " needs a value" : " is not an option, or needs no value");
    }
    return set(options, option, optarg) || complain_of(option, optarg);
}

bool options_parse(options_t *options, int argc, char **argv)
{
    char short_ones[2 * KNOWN_OPTIONS + 2];
    struct option long_ones[KNOWN_OPTIONS + 1];
    int at = optind; /* of the word with the next option */
    int answer;

    memset(options, 0, sizeof *options);
    memset(long_ones, 0, sizeof long_ones);
    options->speed = 1.0;
    options->device = sim_default_config();
    options->link = sim_link_default_config();
    list_options(short_ones, long_ones);
    while ((answer = getopt_long(argc, argv, short_ones, long_ones, NULL)) != -1) {
        if (!take(options, answer, argv[at])) {
            return false;
        }
        at = optind;
    }
    return optind == argc ? is_consistent(options) : complain(argv[optind], " is not an option");
}
