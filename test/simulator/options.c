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
    const char *name;
    const char *value; /* name of its value in the help; NULL: it takes none */
    const char *help;
    bool (*set)(options_t *options, const char *value); /* false: invalid value */
    size_t place;    /* without `set`: of the bool or string that is set, */
    number_t number; /* or the number */
    char letter;     /* its short form; 0: none */
} option_t;

#define PLACE(member) offsetof(options_t, member)
static bool set_frequency(options_t *options, const char *value)
{
    const number_t frequency =
        NUMBER(device.frequency_chz, 100, options->device.min_frequency_chz / 100.0,
               options->device.max_frequency_chz / 100.0);
    return like_read_number(options, &frequency, value);
}

static bool set_firmware(options_t *options, const char *value)
{
    return like_set(options, "firmware", value);
}

/* The angles are those of two real units (section 9.8): 329.7 and 85.7 degrees. */
static bool set_begin(options_t *options, const char *value)
{
    static const uint16_t first_q6[] = {
        [SIM_BEGINS_UNMARKED] = 21101, [SIM_BEGINS_WITH_A_START] = 5485};
    sim_config_t *const device = &options->device;
    const bool is_known = like_set(options, "first_packets", value);
    if (device->beginning != SIM_BEGINS_ANYWHERE) {
        device->first_angle_q6 = first_q6[device->beginning];
    }
    return is_known;
}

static bool set_seed(options_t *options, const char *value)
{
    char *end;
    options->device.seed = strtoull(value, &end, 0);
    options->link.seed = options->device.seed;
    return end != value && *end == '\0' && *value != '-';
}

/* The value is a probability per byte, or events per second; the link needs its inverse. */
static bool set_fault(options_t *options, const char *value)
{
    char name[16];
    int length = 0;
    double rate;
    const bool is_named = sscanf(value, "%15[a-z]=%n", name, &length) == 1 && length > 0;
    const sim_link_kind_t kind = is_named ? sim_link_kind_named(name) : SIM_LINK_KINDS;
    if (kind == SIM_LINK_KINDS || !like_parse(value + length, 1e-9, 100, &rate)) {
        return false;
    }
    const double gap = (sim_link_counts_bytes(kind) ? 1.0 : 1000.0) / rate;
    if (gap < 1.0 || gap > 4e9) {
        return false;
    }
    options->link.mean_gap[kind] = (uint32_t)gap;
    return true;
}

static bool set_bridge(options_t *options, const char *value)
{
    static const char *const names[] = {"clean", "telnet", "crnl", "xonxoff", "seven"};
    unsigned kind;
    const bool is_known = like_find(value, names, 5, &kind);
    options->bridge.kind = (bridge_kind_t)kind;
    return is_known;
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

static const option_t known[] = {
    {"pty", NULL, "serve a pseudo-terminal; its path is the first line printed",
     .place = PLACE(pty)},
    {"tcp", "PORT", "serve 127.0.0.1:PORT (0: any free port, printed in the first line)",
     .number = NUMBER(tcp_port, 1, 0, 65535)},
    {"lines", NULL,
     "time comes by standard input: lines of MICROSECONDS and the bytes\n"
     "                          received then, in hexadecimal; each is answered by the bytes sent",
     .place = PLACE(lines)},
    {"write", "FILE", "record --seconds of scanning in virtual time, as fast as possible",
     .place = PLACE(write_path)},
    {"frequency", "HZ", "set scan frequency at power-up, 5 to 12 (6)", .set = set_frequency},
    {"firmware", "X.Y", "version of the firmware (1.2; 1.3 is in the field)", .set = set_firmware},
    {"begin", "HOW",
     "first packets after a start: anywhere, unmarked (they pass the start\n"
     "                          packet's place without one), start (the first is one) (anywhere)",
     .set = set_begin},
    {"like", "REPORT", "as the unit that `tmini survey` has written this report of",
     .set = like_read},
    {"no-ct", NULL, "send neither CT information nor LastCRC",
     .place = PLACE(device.ct_information)},
    {"blocked", NULL, "the rotor does not turn", .place = PLACE(blocked)},
    {"covered", NULL, "the window is covered: no ranges", .place = PLACE(covered)},
    {"health", "BITS",
     "faults reported, 0 to 0x3F: 1 sensor, 2 encoder,\n"
     "                          4 wireless power, 8 PD, 16 LD, 32 data (0)",
     .number = NUMBER(health, 1, 0, 63)},
    {"motor", "PERCENT", "share of the set frequency that the motor reaches, 1 to 150 (100)",
     .number = NUMBER(device.motor_percent, 1, 1, 150)},
    {"spin-up", "SECONDS", "time from standstill to that speed, 0 to 60 (1)",
     .number = NUMBER(device.spin_up_ms, 1000, 0, 60)},
    {"boot", "SECONDS", "gets power when the port is opened, and boots for 0 to 60 s",
     .number = NUMBER(boot_ms, 1000, 0, 60)},
    {"model", "N", "number of the model (151)",
     .number = NUMBER(device.information.model, 1, 0, 255)},
    {"samples", "BYTES", "packets of another unit: samples of 2 or 4 bytes (3)",
     .number = NUMBER(device.sample_size, 1, 2, 4)},
    {"blind", "N", "each turn of N has no range, and no fault",
     .number = NUMBER(device.blind_every, 1, 1, 255)},
    {"bridge", "KIND",
     "a bridge or terminal in between: telnet (doubles FF), crnl (0D\n"
     "                          becomes 0A), xonxoff (takes 11 and 13), seven (bits)",
     .set = set_bridge},
    {"bursts", "MS", "a bridge that delivers what came in the meantime every 1 to 4000 ms",
     .number = NUMBER(bridge.bursts_ms, 1, 1, 4000)},
    {"turned", "DEGREES", "its angle at the room's 0, clockwise: it is mounted turned (0)",
     .number = NUMBER(device.turned_q6, 64, 0, 359.99)},
    {"turning", "DEG/S", "the robot under it is turned, clockwise (0)",
     .number = NUMBER(device.turning_q6_s, 64, -360, 360)},
    {"mast", "A:B:MM", "it sees a part of the robot from A to B (whole degrees)", .set = set_mast},
    {"longer", "MM", "its ranges are too long by this, -40 to 1000 (0)",
     .number = NUMBER(device.range_error_mm, 1, -40, 1000)},
    {"fault", "KIND=RATE",
     "drop, flip, insert: probability per byte;\n"
     "                          burst, stall, cut, unplug, garble: events per second",
     .set = set_fault},
    {"seed", "N", "seed of all that is random (1)", .set = set_seed},
    {"seconds", "N", "virtual time, then exit (never)", .number = NUMBER(seconds, 1, 0.001, 1e9),
     .letter = 's'},
    {"speed", "X", "virtual seconds per real second, 0.001 to 1000 (1)",
     .number = NUMBER(speed, 1, 0.001, 1000)},
    {"log", "FILE", "commands, modes, faults and totals; - is standard output",
     .place = PLACE(log_path)},
    {"truth", "FILE", "every sample sent, as CSV; - is standard output",
     .place = PLACE(truth_path)},
    {"help", NULL, "this text", .place = PLACE(help), .letter = 'h'},
    {"version", NULL, "the version", .place = PLACE(version), .letter = 'V'},
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
    puts("\nThe room: walls 2.3 m ahead, 2.8 m on the right (90 degrees), 1.7 m behind and 2.2 m\n"
         "on the left. On the right a window (no range), ahead a doorway to a corridor. A pillar\n"
         "ahead, a box ahead left, a table's leg behind left, a box behind right: its corner is\n"
         "nearest, 1.0 m at 143 degrees. More in test/simulator/README.md.");
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
    const int modes = (options->pty ? 1 : 0) + (options->tcp_port >= 0 ? 1 : 0) +
                      (options->lines ? 1 : 0) + (options->write_path == NULL ? 0 : 1);
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

/* What getopt_long() returns for an option: its letter, or BEYOND (above all characters) plus its
 * index in the table. */
#define BEYOND 256

static int answer_of(size_t i)
{
    return known[i].letter != 0 ? known[i].letter : BEYOND + (int)i;
}

static bool set(options_t *options, const option_t *option, const char *value)
{
    char *const place = (char *)options + option->place;
    if (option->set != NULL) {
        return option->set(options, value);
    }
    if (option->number.size > 0) {
        return like_read_number(options, &option->number, value);
    }
    if (option->value == NULL) {
        *(bool *)place = strncmp(option->name, "no-", 3) != 0;
    } else {
        memcpy(place, &value, sizeof value);
    }
    return true;
}

static bool take(options_t *options, int answer, const char *word)
{
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        if (answer_of(i) == answer) {
            return set(options, &known[i], optarg) || complain_of(&known[i], optarg);
        }
    }
    return complain(word,
                    answer == ':' ? " needs a value" : " is not an option, or needs no value");
}

bool options_parse(options_t *options, int argc, char **argv)
{
    struct option long_ones[KNOWN_OPTIONS + 1] = {{0}};
    int at = optind; /* of the word with the next option */
    int answer;
    memset(options, 0, sizeof *options);
    options->tcp_port = -1;
    options->boot_ms = -1;
    options->speed = 1.0;
    options->device = sim_default_config();
    options->link = sim_link_default_config();
    for (size_t i = 0; i < KNOWN_OPTIONS; i++) {
        long_ones[i].name = known[i].name;
        long_ones[i].has_arg = known[i].value != NULL ? required_argument : no_argument;
        long_ones[i].val = answer_of(i);
    }
    /* ":" suppresses its messages. */
    while ((answer = getopt_long(argc, argv, ":hVs:", long_ones, NULL)) != -1) {
        if (!take(options, answer, argv[at])) {
            return false;
        }
        at = optind;
    }
    options->device.boot_ms =
        options->boot_ms < 0 ? options->device.boot_ms : (uint16_t)options->boot_ms;
    return optind == argc ? is_consistent(options) : complain(argv[optind], " is not an option");
}
