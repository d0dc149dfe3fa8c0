/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini: checks a lidar, its wiring and recordings of it from a computer. The command line: the
 * options, the commands, and how the program begins and ends. */

#define _GNU_SOURCE /* getopt_long() */

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "interrupt.h"
#include "mount.h"
#include "options.h"
#include "output.h"
#include "points.h"
#include "words.h"

/* ------------------------------------------------------------------------------------- options */

typedef struct {
    char letter;       /* As in command_t.accepts; all except a few capital letters are short
                        * options. */
    const char *name;  /* Without the two dashes. */
    const char *value; /* Its value's name in the help; NULL: none. */
    const char *help;
    size_t place;      /* The offset of the member in options_t. */
    unsigned min, max; /* The range of a number; both 0: a text. */
    bool (*read)(options_t *options, const char *value); /* Reads the value and prints errors; NULL:
                                                          * none. */
} option_t;

#define PLACE(member) offsetof(options_t, member)

static const option_t table[] = {
    {'p', "port", "PORT", "/dev/ttyUSB0, tcp:HOST:PORT, serial:END; else $TMINI_PORT", PLACE(port),
     0, 0, NULL},
    {'n', "count", "N", "how many scans; 0: until Ctrl-C", PLACE(count), 0, 1000000, NULL},
    {'s', "seconds", "N", "how long", PLACE(seconds), 1, 1000000, NULL},
    {'o', "output", "FILE", "where to draw: FILE.svg, FILE.png or FILE.pdf", PLACE(output), 0, 0,
     NULL},
    {'C', "csv", NULL, "comma-separated values", PLACE(csv), 0, 0, NULL},
    {'J', "json", NULL, "JSON, one object per line", PLACE(json), 0, 0, NULL},
    {'S', "stats", "FILE", "write the counters to FILE, as a JSON object", PLACE(stats), 0, 0,
     NULL},
    {'M', "max-samples", "N", "accept packets of up to N samples (1 to 255; default 80)",
     PLACE(max_samples), 1, 255, NULL},
    {'N', "scan", "N", "the scan with number N, as `decode --csv` counts them", PLACE(scan), 1,
     1000000000, NULL},
    {'A', "all", NULL, "all scans in one picture", PLACE(all), 0, 0, NULL},
    {'T', "timed", NULL, "with time stamps, as for a FILE.tmini", PLACE(timed), 0, 0, NULL},
    {'W', "wait", NULL, "wait for an adapter that is not there, or goes, and go on", PLACE(wait), 0,
     0, NULL},
    {'L', "listen", NULL, "send nothing: something else has started the lidar", PLACE(listen), 0, 0,
     NULL},
    {'F', "front", "DEG", "the lidar's angle that is the robot's front, clockwise", PLACE(mount), 0,
     0, mount_read_front},
    {'U', "upside-down", NULL, "the lidar hangs", PLACE(mount.upside_down), 0, 0, NULL},
    {'O', "offset", "MM", "added to each distance", PLACE(mount), 0, 0, mount_read_offset},
    {'K', "mask", "FROM:TO", "hide these degrees, clockwise from the front; repeatable",
     PLACE(masked), 0, 0, mount_read_mask},
    {'I', "with-serial", NULL, "the serial number too, and a recording", PLACE(with_serial), 0, 0,
     NULL},
    {'E', "ask", NULL, "ask which lidar is there", PLACE(ask), 0, 0, NULL},
    {'X', "force", NULL, "overwrite an existing file", PLACE(force), 0, 0, NULL},
    {'q', "quiet", NULL, "no progress or remarks, only results and errors", PLACE(quiet), 0, 0,
     NULL},
    {'h', "help", NULL, "this text", PLACE(help), 0, 0, NULL},
    {'V', "version", NULL, "the version", PLACE(version), 0, 0, NULL},
};

#define OPTIONS (sizeof table / sizeof table[0])

static bool is_short(const option_t *option)
{
    return islower((unsigned char)option->letter) != 0 || option->letter == 'V';
}

/* The option with that letter, which must exist. */
static const option_t *find(int letter)
{
    size_t i = 0;
    while (table[i].letter != letter) {
        i++;
    }
    return &table[i];
}

static bool read_number(const option_t *option, const char *text, unsigned *number)
{
    char *end = NULL;
    errno = 0;
    const unsigned long value = strtoul(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || value < option->min ||
        value > option->max) {
        (void)message_usage("--%s: \"%s\" is not a number from %u to %u", option->name, text,
                            option->min, option->max);
        return false;
    }
    *number = (unsigned)value;
    return true;
}

static bool apply(options_t *options, const option_t *option, const char *value)
{
    void *const member = (char *)options + option->place;
    if (strchr(options->given, option->letter) == NULL) {
        options->given[strlen(options->given)] = option->letter; /* There is room for all. */
    }
    if (option->read != NULL) {
        return option->read(options, value);
    }
    if (option->value == NULL) {
        *(bool *)member = true;
    } else if (option->max == 0) {
        *(const char **)member = value;
    } else {
        return read_number(option, value, member);
    }
    return true;
}

/* Writes the options for getopt_long(): the short ones and the long ones. A first "-" makes it
 * return all words in their order, and ":" makes it print nothing. */
static void list_options(char *short_ones, struct option *long_ones)
{
    *short_ones++ = '-';
    *short_ones++ = ':';
    for (size_t i = 0; i < OPTIONS; i++) {
        const int has_value = table[i].value != NULL ? required_argument : no_argument;
        long_ones[i] = (struct option){table[i].name, has_value, NULL, table[i].letter};
        if (is_short(&table[i])) {
            short_ones +=
                sprintf(short_ones, "%c%s", table[i].letter, has_value != no_argument ? ":" : "");
        }
    }
}

/* Takes a word that is no option; only the first ones are used. */
static bool take_word(options_t *options, const char *word)
{
    if (options->word_count < OPTIONS_WORDS) {
        options->words[options->word_count++] = word;
    }
    return true;
}

static const char *nearest_option(const char *typed)
{
    const char *names[OPTIONS];
    for (size_t i = 0; i < OPTIONS; i++) {
        names[i] = table[i].name;
    }
    return words_nearest(typed, names, OPTIONS);
}

static const char *advice(const char *nearest, const char *before)
{
    static char text[60];
    (void)snprintf(text, sizeof text, nearest != NULL ? "; did you mean %s%s?" : "", before,
                   nearest);
    return text;
}

/* One dash before the name of a long option: getopt_long() would read it as short ones. */
static bool is_long_with_one_dash(const char *word)
{
    const size_t length = strcspn(word + 1, "=");
    for (size_t i = 0; word[0] == '-' && i < OPTIONS; i++) {
        if (strlen(table[i].name) == length && strncmp(word + 1, table[i].name, length) == 0) {
            return true;
        }
    }
    return false;
}

static bool refuse_unknown(const options_t *options, const char *word)
{
    const char *const command = options->word_count > 0 ? options->words[0] : "COMMAND";
    const bool is_long = word[1] == '-' || is_long_with_one_dash(word);
    char name[24] = {'-', (char)optopt};
    const char *nearest = NULL;
    if (is_long || isprint(optopt) == 0) {
        (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
        nearest = is_long ? nearest_option(name + (word[1] == '-' ? 2 : 1)) : NULL;
    }
    (void)message_usage("there is no option %s%s\nSee tmini %s --help.", name,
                        advice(nearest, "--"), command);
    return false;
}

/* `word` is the one with the option; `optopt` the letter of the option, if it is known. */
static bool refuse(const options_t *options, int answer, const char *word)
{
    const bool is_long = word[1] == '-';
    if (answer == ':') {
        (void)message_usage("--%s needs a value; see tmini %s --help", find(optopt)->name,
                            options->word_count > 0 ? options->words[0] : "COMMAND");
        return false;
    }
    if (is_long && optopt != 0) {
        (void)message_usage("%s: --%s takes no value", word, find(optopt)->name);
        return false;
    }
    return refuse_unknown(options, word);
}

static bool take(options_t *options, int answer, const char *word)
{
    return answer == 1                      ? take_word(options, optarg)
           : is_long_with_one_dash(word)    ? refuse_unknown(options, word)
           : answer == '?' || answer == ':' ? refuse(options, answer, word)
                                            : apply(options, find(answer), optarg);
}

/* Reads all words, in any order. Returns STATUS_OK, or prints the error and returns
 * STATUS_USAGE. */
static int parse(options_t *options, int argc, char **argv)
{
    char short_ones[2 * OPTIONS + 3];
    struct option long_ones[OPTIONS + 1] = {{0}};
    bool is_good = true;
    int answer = 0;
    *options = (options_t){.mount = {.masked = options->masked}};
    list_options(short_ones, long_ones);
    int at = optind; /* Of the next option's word: it may hold several short options. */
    while (is_good && (answer = getopt_long(argc, argv, short_ones, long_ones, NULL)) != -1) {
        is_good = take(options, answer, argv[at]);
        at = optind;
    }
    for (int i = optind; is_good && i < argc; i++) {
        is_good = take_word(options, argv[i]); /* After "--". */
    }
    options->command = options->words[0];
    options->operand = options->words[1];
    return is_good ? STATUS_OK : STATUS_USAGE;
}

static bool is_accepted(const command_t *command, char letter)
{
    return letter == 'h' || letter == 'V' || strchr(command->accepts, letter) != NULL;
}

static int check(const options_t *options, const command_t *command)
{
    const char *const excess = options->words[command->has_operand ? 2 : 1];
    for (const char *letter = options->given; *letter != '\0'; letter++) {
        if (!is_accepted(command, *letter)) {
            return message_usage("%s has no option --%s; see tmini %s --help", command->name,
                                 find(*letter)->name, command->name);
        }
    }
    if (excess != NULL) {
        return message_usage("%s: unexpected \"%s\"; see tmini %s --help", command->name, excess,
                             command->name);
    }
    return options->csv && options->json ? message_usage("either --csv or --json, not both")
                                         : STATUS_OK;
}

static void explain(const command_t *command)
{
    (void)printf("tmini %s %s\n\n%s\n", command->name, command->usage, command->summary);
    (void)printf(command->details != NULL ? "\n%s\n\n" : "\n", command->details);
    if (is_accepted(command, 'C')) {
        (void)printf("%s\n\n", rows_help);
    }
    for (size_t i = 0; i < OPTIONS; i++) {
        const option_t *const option = &table[i];
        if (is_accepted(command, option->letter)) {
            char name[40];
            (void)snprintf(name, sizeof name, "--%s %s", option->name,
                           option->value != NULL ? option->value : "");
            (void)printf("  %c%c%c %-15s %s\n", is_short(option) ? '-' : ' ',
                         is_short(option) ? option->letter : ' ', is_short(option) ? ',' : ' ',
                         name, option->help);
        }
    }
}

/* ------------------------------------------------------------------------------------ commands */

static const command_t *const commands[] = {
    &command_ports,  &command_check, &command_info,   &command_health, &command_frequency,
    &command_reboot, &command_scan,  &command_record, &command_survey, &command_calibrate,
    &command_decode, &command_plot,  &command_view,
};

#define COMMANDS (sizeof commands / sizeof commands[0])

/* If descriptor 0, 1 or 2 were closed, the port would get its number, and output would be sent to
 * the lidar. So descriptors that fail when they are used take these numbers. */
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
    (void)fputs("\n`tmini COMMAND --help` has more. Exit status: 0 success, 1 failure,\n"
                "2 wrong usage.\n",
                file);
    return status;
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

static int run_command(const command_t *command, const options_t *options, bool wants_help)
{
    if (wants_help) {
        explain(command);
        return STATUS_OK;
    }
    message_silence(options->quiet);
    const int status = check(options, command);
    if (status != STATUS_OK) {
        return status;
    }
    return command->run != NULL ? command->run(options) : device_use(options, command->use);
}

static int refuse_command(const char *typed)
{
    const char *names[COMMANDS + 2] = {"help", "version"};
    for (size_t i = 0; i < COMMANDS; i++) {
        names[i + 2] = commands[i]->name;
    }
    return message_usage("there is no command \"%s\"%s\n`tmini help` lists them all.", typed,
                         advice(words_nearest(typed, names, COMMANDS + 2), "tmini "));
}

static bool is_word(const options_t *options, const char *word)
{
    return options->command != NULL && strcmp(options->command, word) == 0;
}

/* `tmini help scan` is `tmini scan --help`, and `tmini version` is `tmini --version`. */
static int run(const options_t *options)
{
    const bool is_help = is_word(options, "help");
    const bool wants_help = is_help || options->help;
    const char *const name = is_help ? options->operand : options->command;
    const command_t *const command = name != NULL ? find_command(name) : NULL;
    if (options->version || is_word(options, "version")) {
        (void)puts("tmini " TMINI_VERSION_TEXT);
        return STATUS_OK;
    }
    if (name == NULL) {
        return wants_help ? print_usage(stdout, STATUS_OK) : print_usage(stderr, STATUS_USAGE);
    }
    if (command == NULL) {
        return refuse_command(name);
    }
    return run_command(command, options, wants_help);
}

/* Output that could not be written, for example to a full disk, must not count as success. */
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
    const int status = parse(&options, argc, argv);
    return close_output(status == STATUS_OK ? run(&options) : status);
}
