/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _GNU_SOURCE /* getopt_long() */

#include "options.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "message.h"
#include "points.h"

typedef enum { IS_FLAG, IS_TEXT, IS_NUMBER, IS_CSV, IS_JSON } kind_t;

typedef struct {
    char letter;       /* As in command_t.accepts; all but a few capital ones are short options. */
    const char *name;  /* Without the two dashes. */
    const char *value; /* What it takes, for the help; NULL: nothing. */
    const char *help;
    kind_t kind;
    size_t place; /* Of the member in options_t. */
    unsigned min, max;
} option_t;

#define PLACE(member) offsetof(options_t, member)

static const option_t table[] = {
    {'p', "port", "PORT", "the lidar: /dev/ttyUSB0, tcp:HOST:PORT; else $TMINI_PORT", IS_TEXT,
     PLACE(port), 0, 0},
    {'n', "count", "N", "how many scans; 0: until Ctrl-C", IS_NUMBER, PLACE(count), 0, 1000000},
    {'s', "seconds", "N", "how long", IS_NUMBER, PLACE(seconds), 1, 1000000},
    {'o', "output", "FILE", "where to draw: FILE.svg, FILE.png or FILE.pdf", IS_TEXT, PLACE(output),
     0, 0},
    {'C', "csv", NULL, "comma-separated values", IS_CSV, 0, 0, 0},
    {'J', "json", NULL, "JSON, one object a line", IS_JSON, 0, 0, 0},
    {'S', "stats", "FILE", "write the counters to FILE, as a JSON object", IS_TEXT, PLACE(stats), 0,
     0},
    {'M', "max-samples", "N", "accept packets of up to N samples (1 to 255; default 80)", IS_NUMBER,
     PLACE(max_samples), 1, 255},
    {'N', "scan", "N", "the scan with number N, as `decode --csv` counts them", IS_NUMBER,
     PLACE(scan), 1, 1000000000},
    {'A', "all", NULL, "all scans in one picture", IS_FLAG, PLACE(all), 0, 0},
    {'T', "timed", NULL, "with time stamps, as for a FILE.tmini", IS_FLAG, PLACE(timed), 0, 0},
    {'q', "quiet", NULL, "no progress or remarks, only results and errors", IS_FLAG, PLACE(quiet),
     0, 0},
    {'h', "help", NULL, "this text", IS_FLAG, PLACE(help), 0, 0},
    {'V', "version", NULL, "the version", IS_FLAG, PLACE(version), 0, 0},
};

#define OPTIONS (sizeof table / sizeof table[0])

static bool is_short(const option_t *option)
{
    return islower((unsigned char)option->letter) != 0 || option->letter == 'V';
}

static const option_t *find(int letter)
{
    size_t i = 0;
    while (i < OPTIONS && table[i].letter != letter) {
        i++;
    }
    return i < OPTIONS ? &table[i] : NULL;
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

static bool set_format(options_t *options, format_t format)
{
    if (options->format != FORMAT_TEXT && options->format != format) {
        (void)message_usage("either --csv or --json, not both");
        return false;
    }
    options->format = format;
    return true;
}

static bool take_operand(options_t *options, const char *word)
{
    if (options->word_count < OPTIONS_WORDS) {
        options->words[options->word_count++] = word;
    }
    return true;
}

/* Returns false, and says why, if the value is not what the option takes. */
static bool apply(options_t *options, const option_t *option, const char *value)
{
    void *const member = (char *)options + option->place;
    if (strchr(options->given, option->letter) == NULL) {
        options->given[strlen(options->given)] = option->letter; /* There is room for all. */
    }
    switch (option->kind) {
    case IS_TEXT:
        *(const char **)member = value;
        return true;
    case IS_NUMBER:
        return read_number(option, value, member);
    case IS_CSV:
        return set_format(options, FORMAT_CSV);
    case IS_JSON:
        return set_format(options, FORMAT_JSON);
    default:
        *(bool *)member = true;
        return true;
    }
}

/* For getopt_long(): the short options, after "-:", which asks for all words in their order and for
 * silence about errors; and the long ones. */
static void list_options(char *short_ones, struct option *long_ones)
{
    short_ones += sprintf(short_ones, "-:");
    for (size_t i = 0; i < OPTIONS; i++) {
        const int has_value = table[i].value != NULL ? required_argument : no_argument;
        long_ones[i] = (struct option){table[i].name, has_value, NULL, table[i].letter};
        if (is_short(&table[i])) {
            short_ones +=
                sprintf(short_ones, "%c%s", table[i].letter, has_value != no_argument ? ":" : "");
        }
    }
}

/* What getopt_long() could not take. */
static bool complain(int answer, const char *word)
{
    const option_t *const known = find(optopt);
    const size_t length = strcspn(word, "=");
    if (answer == ':' && known != NULL) {
        (void)message_usage("--%s takes a value: --%s %s", known->name, known->name, known->value);
    } else if (known != NULL && word[1] == '-') {
        (void)message_usage("--%s takes no value", known->name);
    } else if (word[1] == '-') {
        (void)message_usage("there is no option %.*s, or more than one; see tmini --help",
                            (int)length, word);
    } else {
        (void)message_usage("there is no option -%c; see tmini --help", optopt);
    }
    return false;
}

int options_parse(options_t *options, int argc, char **argv)
{
    char short_ones[3 * OPTIONS + 3];
    struct option long_ones[OPTIONS + 1] = {{0}};
    bool is_good = true;
    int answer = 0;
    *options = (options_t){0};
    list_options(short_ones, long_ones);
    while (is_good && (answer = getopt_long(argc, argv, short_ones, long_ones, NULL)) != -1) {
        if (answer == '?' || answer == ':') {
            is_good = complain(answer, argv[optind - 1]);
        } else {
            is_good =
                answer == 1 ? take_operand(options, optarg) : apply(options, find(answer), optarg);
        }
    }
    for (int i = optind; is_good && i < argc; i++) {
        is_good = take_operand(options, argv[i]); /* After "--". */
    }
    options->command = options->words[0];
    options->operand = options->words[1];
    return is_good ? STATUS_OK : STATUS_USAGE;
}

static bool is_accepted(const command_t *command, char letter)
{
    return letter == 'h' || letter == 'V' || strchr(command->accepts, letter) != NULL;
}

int options_check(const options_t *options, const command_t *command)
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
    return STATUS_OK;
}

void options_help(const command_t *command)
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
            (void)printf("  %c%c%c %-20s %s\n", is_short(option) ? '-' : ' ',
                         is_short(option) ? option->letter : ' ', is_short(option) ? ',' : ' ',
                         name, option->help);
        }
    }
}
