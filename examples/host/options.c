/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "message.h"

typedef struct {
    char letter;       /* As in command_t.accepts; lower-case ones are also short options. */
    const char *name;  /* Without the two dashes. */
    const char *value; /* What it takes, for the help; NULL: nothing. */
    const char *help;
    unsigned min, max; /* If the value is a number. */
} option_t;

static const option_t option_table[] = {
    {'p', "port", "PORT", "the lidar's serial port, for example /dev/ttyUSB0", 0, 0},
    {'n', "count", "N", "how many scans; 0: until Ctrl-C", 0, 1000000},
    {'s', "seconds", "N", "how long; without it, until Ctrl-C", 1, 1000000},
    {'o', "output", "FILE", "where to draw: FILE.svg or FILE.png", 0, 0},
    {'C', "csv", NULL, "comma-separated values", 0, 0},
    {'J', "json", NULL, "JSON, one object a line", 0, 0},
    {'S', "stats", "FILE", "write the counters to FILE, as a JSON object", 0, 0},
    {'M', "max-samples", "N", "accept packets of up to N samples (1 to 255; default 80)", 1, 255},
    {'N', "scan", "N", "the scan with number N, as `tmini decode --csv` counts them", 1,
     1000000000},
    {'A', "all", NULL, "all scans in one picture", 0, 0},
    {'q', "quiet", NULL, "no progress or remarks, only results and errors", 0, 0},
    {'h', "help", NULL, "this text", 0, 0},
};

#define OPTIONS (sizeof option_table / sizeof option_table[0])

static bool is_accepted(const command_t *command, const option_t *option)
{
    return option->letter == 'h' || strchr(command->accepts, option->letter) != NULL;
}

/* `word` is "-x" or "--name" or "--name=value". */
static const option_t *find(const command_t *command, const char *word)
{
    const bool is_long = word[1] == '-';
    const size_t length = strcspn(word + 2, "=");
    for (size_t i = 0; i < OPTIONS; i++) {
        const option_t *const option = &option_table[i];
        const bool same =
            is_long ? strlen(option->name) == length && strncmp(option->name, word + 2, length) == 0
                    : option->letter == word[1] && option->letter >= 'a' && word[2] == '\0';
        if (same && is_accepted(command, option)) {
            return option;
        }
    }
    return NULL;
}

static bool read_number(const option_t *option, const char *text, unsigned *number)
{
    char *end = NULL;
    errno = 0;
    const unsigned long value = strtoul(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || value < option->min ||
        value > option->max) {
        return false;
    }
    *number = (unsigned)value;
    return true;
}

static bool set_format(options_t *options, format_t format)
{
    const bool clashes = options->format != FORMAT_TEXT && options->format != format;
    options->format = format;
    return !clashes;
}

/* Returns false if the value is not what the option takes. */
static bool apply(options_t *options, const option_t *option, const char *value)
{
    switch (option->letter) {
    case 'p':
        options->port = value;
        return true;
    case 'o':
        options->output = value;
        return true;
    case 'S':
        options->stats = value;
        return true;
    case 'n':
        return read_number(option, value, &options->count);
    case 's':
        return read_number(option, value, &options->seconds);
    case 'M':
        return read_number(option, value, &options->max_samples);
    case 'N':
        return read_number(option, value, &options->scan);
    case 'C':
        return set_format(options, FORMAT_CSV);
    case 'J':
        return set_format(options, FORMAT_JSON);
    case 'A':
        options->all = true;
        return true;
    case 'q':
        options->quiet = true;
        return true;
    default:
        options->help = true;
        return true;
    }
}

static int take_operand(options_t *options, const command_t *command, const char *word)
{
    if (command->operand == NULL || options->operand != NULL) {
        return message_usage("%s: unexpected \"%s\"; see tmini %s --help", command->name, word,
                             command->name);
    }
    options->operand = word;
    return STATUS_OK;
}

/* Takes the option at words[*index], and its value, which may be the word after it. */
static int take_option(options_t *options, const command_t *command, int count, char *const *words,
                       int *index)
{
    const char *const word = words[*index];
    const option_t *const option = find(command, word);
    if (option == NULL) {
        return message_usage("%s has no option %s; see tmini %s --help", command->name, word,
                             command->name);
    }
    const char *value = word[1] == '-' ? strchr(word, '=') : NULL;
    if (value != NULL) {
        value++;
    } else if (option->value != NULL && *index + 1 < count) {
        (*index)++;
        value = words[*index];
    }
    if ((value == NULL) != (option->value == NULL)) {
        return message_usage("--%s takes %s value; see tmini %s --help", option->name,
                             value == NULL ? "a" : "no", command->name);
    }
    if (!apply(options, option, value)) {
        return value == NULL ? message_usage("either --csv or --json, not both")
                             : message_usage("--%s: \"%s\" is not a number from %u to %u",
                                             option->name, value, option->min, option->max);
    }
    return STATUS_OK;
}

int options_parse(options_t *options, const command_t *command, int count, char *const *words)
{
    *options = (options_t){0};
    bool only_operands = false;
    int status = STATUS_OK;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        const bool looks_like_option = words[i][0] == '-' && words[i][1] != '\0';
        if (!only_operands && strcmp(words[i], "--") == 0) {
            only_operands = true;
        } else if (!only_operands && looks_like_option) {
            status = take_option(options, command, count, words, &i);
        } else {
            status = take_operand(options, command, words[i]);
        }
    }
    return status;
}

void options_help(const command_t *command)
{
    (void)printf("tmini %s %s\n\n%s\n%s\n\n", command->name, command->usage, command->summary,
                 command->details);
    for (size_t i = 0; i < OPTIONS; i++) {
        const option_t *const option = &option_table[i];
        if (is_accepted(command, option)) {
            char name[40];
            (void)snprintf(name, sizeof name, "--%s %s", option->name,
                           option->value != NULL ? option->value : "");
            const bool is_short = option->letter >= 'a';
            (void)printf("  %c%c%c %-20s %s\n", is_short ? '-' : ' ',
                         is_short ? option->letter : ' ', is_short ? ',' : ' ', name, option->help);
        }
    }
}
