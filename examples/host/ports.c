/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini ports: the USB serial adapters of this computer. For tests, the environment variable
 * TMINI_ROOT names the folder that contains dev/ and sys/. */

#define _XOPEN_SOURCE 700

#include "options.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

#define PORTS_MAX 32
#define PATH_SIZE 600

typedef struct {
    char name[PATH_SIZE];   /* The most stable name. */
    char device[PATH_SIZE]; /* The device that it links to. */
    char maker[20];         /* "vendor:product", or ":" if not known. */
    const char *chip;       /* NULL: not a chip that lidars come with. */
} adapter_t;

static adapter_t adapters[PORTS_MAX + 1];

/* The chips of lidars' USB adapters, the same as in 60-tmini.rules. */
static const struct {
    const char *maker, *chip;
} chips[] = {
    {"10c4:ea60", "CP210x"}, {"1a86:7523", "CH340"},  {"1a86:55d4", "CH9102"},
    {"067b:2303", "PL2303"}, {"0403:6001", "FT232R"}, {"0403:6015", "FT230X"},
    {"0483:5740", "STM32"},
};

/* The most stable names come first. */
static const char *const places[] = {
    "/dev/tmini*",  "/dev/serial/by-id/*", "/dev/serial/by-path/*", "/dev/ttyUSB*",
    "/dev/ttyACM*", "/dev/cu.usb*",        "/dev/cu.SLAB*",         "/dev/cu.wchusbserial*",
};

static const char *root(void)
{
    const char *const folder = getenv("TMINI_ROOT");
    return folder != NULL ? folder : "";
}

/* Reads the first word of a file in the USB device's folder, one or two above the tty's; "" if
 * there is none. */
static void read_word(const adapter_t *adapter, const char *name, char word[8])
{
    static const char *const above[] = {"..", "../.."};
    word[0] = '\0';
    for (size_t i = 0; i < 2 && word[0] == '\0'; i++) {
        char path[PATH_SIZE];
        (void)snprintf(path, sizeof path, "%s/sys/class/tty/%.60s/device/%s/%s", root(),
                       strrchr(adapter->device, '/') + 1, above[i], name);
        FILE *const file = fopen(path, "r");
        if (file != NULL) {
            (void)!fscanf(file, "%7s", word);
            (void)fclose(file);
        }
    }
}

static void find_maker(adapter_t *adapter)
{
    char vendor[8];
    char product[8];
    read_word(adapter, "idVendor", vendor);
    read_word(adapter, "idProduct", product);
    (void)snprintf(adapter->maker, sizeof adapter->maker, "%s:%s", vendor, product);
    for (size_t i = 0; i < sizeof chips / sizeof chips[0]; i++) {
        adapter->chip = strcmp(adapter->maker, chips[i].maker) == 0 ? chips[i].chip : adapter->chip;
    }
}

/* Adds the adapter of that name, unless it has been found under another one. */
static size_t add(size_t count, const char *name)
{
    adapter_t *const adapter = &adapters[count];
    char *const device = realpath(name, NULL);
    if (device == NULL || count == PORTS_MAX) {
        free(device);
        return count;
    }
    *adapter = (adapter_t){.chip = NULL};
    (void)snprintf(adapter->name, sizeof adapter->name, "%s", name);
    (void)snprintf(adapter->device, sizeof adapter->device, "%s", device);
    free(device);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(adapters[i].device, adapter->device) == 0) {
            return count;
        }
    }
    find_maker(adapter);
    return count + 1;
}

static size_t find_adapters(void)
{
    size_t count = 0;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        char pattern[PATH_SIZE];
        glob_t found = {0};
        (void)snprintf(pattern, sizeof pattern, "%s%s", root(), places[i]);
        if (glob(pattern, 0, NULL, &found) == 0) {
            for (size_t j = 0; j < found.gl_pathc; j++) {
                count = add(count, found.gl_pathv[j]);
            }
            globfree(&found);
        }
    }
    return count;
}

static void print(FILE *file, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const bool is_known = adapters[i].maker[1] != '\0'; /* Otherwise it is ":". */
        (void)fprintf(file, "%s  (%s, %s)  %s\n", adapters[i].name, adapters[i].device,
                      is_known ? adapters[i].maker : "maker unknown",
                      adapters[i].chip != NULL ? adapters[i].chip : "");
    }
}

/* The only adapter with a chip that lidars come with; otherwise the only adapter; NULL: there is
 * neither. */
static const adapter_t *only_one(size_t count)
{
    const adapter_t *likely = NULL;
    size_t likely_count = 0;
    for (size_t i = 0; i < count; i++) {
        likely = adapters[i].chip != NULL ? &adapters[i] : likely;
        likely_count += adapters[i].chip != NULL ? 1 : 0;
    }
    return likely_count == 1 ? likely : count == 1 ? adapters : NULL;
}

const char *ports_choose(const options_t *options)
{
    const char *const usual = getenv("TMINI_PORT");
    if (options->port != NULL) {
        return options->port;
    }
    if (usual != NULL && usual[0] != '\0') {
        return usual;
    }
    const size_t count = find_adapters();
    const adapter_t *const adapter = only_one(count);
    if (adapter != NULL) {
        message_note("using %s", adapter->name);
        return adapter->name;
    }
    (void)message_usage(count == 0
                            ? "on which port is the lidar? No USB serial adapter is plugged in. "
                              "For example: -p /dev/ttyUSB0"
                            : "on which port is the lidar? Say, for example, -p %s; there are:",
                        adapters[0].name);
    print(stderr, count);
    return NULL;
}

const char *ports_stable_name(const char *path)
{
    char *const device = realpath(path, NULL);
    const size_t count = find_adapters();
    const char *name = path;
    for (size_t i = 0; i < count; i++) {
        if (device != NULL && strcmp(adapters[i].device, device) == 0) {
            name = adapters[i].name;
        }
    }
    free(device);
    return name;
}

static int run(const options_t *options)
{
    const size_t count = find_adapters();
    (void)options;
    print(stdout, count);
    return count > 0 ? STATUS_OK
                     : message_fail("no USB serial adapter is plugged in, or its driver is missing "
                                    "(on Linux, see `dmesg`)");
}

const command_t command_ports = {
    .name = "ports",
    .usage = "",
    .summary = "the serial adapters of this computer",
    .details = "A line for each: its most stable name, the device that this leads to, the USB\n"
               "numbers of its maker, and its chip if it is one of those that lidars come with.\n"
               "A command without -p takes the port of the environment's TMINI_PORT, or else\n"
               "the only such adapter.",
    .accepts = "q",
    .run = run,
};
