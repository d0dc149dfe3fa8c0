/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini ports: the serial ports of this computer; and the choice of one. */

#define _XOPEN_SOURCE 700

#include "ports.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ask.h"
#include "options.h"
#include "output.h"
#include "users.h"

#define PATH_SIZE PORTS_PATH_SIZE

static adapter_t adapters[PORTS_MAX];

/* The chips of lidars' USB adapters, the same as in 60-tmini.rules. */
static const struct {
    const char *maker, *chip;
} chips[] = {
    {"10c4:ea60", "CP210x"}, {"1a86:7523", "CH340"},  {"1a86:55d4", "CH9102"},
    {"067b:2303", "PL2303"}, {"0403:6001", "FT232R"}, {"0403:6015", "FT230X"},
    {"0483:5740", "STM32"},
};

static const struct {
    const char *pattern;
    bool is_board;
} places[] = {
    {"/dev/ttyUSB*", false},          {"/dev/ttyACM*", false},
    {"/dev/cu.usb*", false},          {"/dev/cu.SLAB*", false},
    {"/dev/cu.wchusbserial*", false}, {"/dev/ttyAMA*", true},
    {"/dev/ttyTHS*", true},           {"/dev/ttyS*", true},
};

/* Reads the first word of a file about the port in /sys; "" if there is none. */
static void read_word(const adapter_t *adapter, const char *name, char *word, size_t size)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s/sys/class/tty/%.60s/%s", users_root(),
                   strrchr(adapter->device, '/') + 1, name);
    FILE *const file = fopen(path, "r");
    word[0] = '\0';
    if (file != NULL) {
        if (fgets(word, (int)size, file) == NULL) {
            word[0] = '\0';
        }
        word[strcspn(word, " \n")] = '\0';
        (void)fclose(file);
    }
}

/* The USB device's folder is one or two above the tty's. */
static void read_usb_word(const adapter_t *adapter, const char *name, char *word, size_t size)
{
    char path[40];
    (void)snprintf(path, sizeof path, "device/../%s", name);
    read_word(adapter, path, word, size);
    if (word[0] == '\0') {
        (void)snprintf(path, sizeof path, "device/../../%s", name);
        read_word(adapter, path, word, size);
    }
}

static void find_maker(adapter_t *adapter)
{
    char vendor[8];
    char product[8];
    read_usb_word(adapter, "idVendor", vendor, sizeof vendor);
    read_usb_word(adapter, "idProduct", product, sizeof product);
    read_usb_word(adapter, "serial", adapter->serial, sizeof adapter->serial);
    (void)snprintf(adapter->maker, sizeof adapter->maker, "%s:%s", vendor, product);
    for (size_t i = 0; i < sizeof chips / sizeof chips[0]; i++) {
        adapter->chip = strcmp(adapter->maker, chips[i].maker) == 0 ? chips[i].chip : adapter->chip;
    }
}

/* /dev/ttyS0 to ttyS31 exist also where there is no such UART: its type is 0 then. */
static bool is_missing(const adapter_t *adapter)
{
    char type[8];
    read_word(adapter, "type", type, sizeof type);
    return adapter->is_board && strcmp(type, "0") == 0;
}

static size_t add(size_t count, const char *device, bool is_board)
{
    adapter_t *const adapter = &adapters[count];
    char *const real = realpath(device, NULL);
    if (real == NULL || count == PORTS_MAX) {
        free(real);
        return count;
    }
    *adapter = (adapter_t){.is_board = is_board};
    (void)snprintf(adapter->device, sizeof adapter->device, "%s", device);
    (void)snprintf(adapter->name, sizeof adapter->name, "%s", device);
    (void)snprintf(adapter->real, sizeof adapter->real, "%s", real);
    free(real);
    if (is_missing(adapter)) {
        return count;
    }
    if (!is_board) {
        find_maker(adapter);
    }
    return count + 1;
}

static size_t add_all(size_t count, const char *pattern, bool is_board)
{
    char path[PATH_SIZE];
    glob_t found = {0};
    (void)snprintf(path, sizeof path, "%s%s", users_root(), pattern);
    if (glob(path, 0, NULL, &found) == 0) {
        for (size_t i = 0; i < found.gl_pathc; i++) {
            count = add(count, found.gl_pathv[i], is_board);
        }
        globfree(&found);
    }
    return count;
}

/* Of several equal adapters only one has the link in by-id. */
static bool is_unique(const adapter_t *adapter, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (&adapters[i] != adapter && strcmp(adapters[i].maker, adapter->maker) == 0 &&
            strcmp(adapters[i].serial, adapter->serial) == 0) {
            return false;
        }
    }
    return true;
}

/* Takes the link in that folder as the adapter's name, if there is one. */
static bool take_link(adapter_t *adapter, const char *folder)
{
    char path[PATH_SIZE];
    glob_t found = {0};
    bool is_taken = false;
    (void)snprintf(path, sizeof path, "%s/dev/serial/%s/*", users_root(), folder);
    if (glob(path, 0, NULL, &found) == 0) {
        for (size_t i = 0; i < found.gl_pathc && !is_taken; i++) {
            char *const real = realpath(found.gl_pathv[i], NULL);
            is_taken = real != NULL && strcmp(real, adapter->real) == 0;
            if (is_taken) {
                (void)snprintf(adapter->name, sizeof adapter->name, "%s", found.gl_pathv[i]);
            }
            free(real);
        }
        globfree(&found);
    }
    return is_taken;
}

static size_t find_adapters(void)
{
    size_t count = 0;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        count = add_all(count, places[i].pattern, places[i].is_board);
    }
    for (size_t i = 0; i < count; i++) {
        adapter_t *const adapter = &adapters[i];
        if (!adapter->is_board && (!is_unique(adapter, count) || !take_link(adapter, "by-id"))) {
            (void)take_link(adapter, "by-path");
        }
    }
    return count;
}

size_t ports_find(adapter_t ports[PORTS_MAX])
{
    const size_t count = find_adapters();
    memcpy(ports, adapters, sizeof adapters);
    return count;
}

static void print_port(FILE *file, const adapter_t *adapter)
{
    const bool is_known = adapter->maker[1] != '\0'; /* Otherwise it is ":". */
    (void)fprintf(file, "%s  (%s, %s)%s%s", adapter->name, adapter->device,
                  adapter->is_board ? "on the board"
                  : is_known        ? adapter->maker
                                    : "maker unknown",
                  adapter->chip != NULL ? "  " : "", adapter->chip != NULL ? adapter->chip : "");
}

static void print(FILE *file, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        print_port(file, &adapters[i]);
        (void)fputc('\n', file);
    }
}

/* The only USB adapter with a chip that lidars come with; otherwise the only USB adapter; NULL:
 * there is neither. */
static const adapter_t *only_one(size_t count)
{
    const adapter_t *likely = NULL;
    size_t likely_count = 0;
    size_t usb_count = 0;
    for (size_t i = 0; i < count; i++) {
        likely = adapters[i].chip != NULL ? &adapters[i] : likely;
        likely_count += adapters[i].chip != NULL ? 1 : 0;
        usb_count += adapters[i].is_board ? 0 : 1;
    }
    return likely_count == 1 ? likely : usb_count == 1 ? adapters : NULL;
}

/* The adapters that may be asked without being named: those with a chip that lidars come with. Of
 * the others, only `named`. */
static size_t ask_all(size_t count, const char *named, asked_t asked[PORTS_MAX])
{
    char *const real = named != NULL ? realpath(named, NULL) : NULL;
    for (size_t i = 0; i < count; i++) {
        const bool is_named = real != NULL && strcmp(adapters[i].real, real) == 0;
        asked[i] = (asked_t){.path = adapters[i].name};
        asked[i].state =
            is_named || (named == NULL && adapters[i].chip != NULL) ? ASK_WAITING : ASK_LEFT_OUT;
    }
    free(real);
    ask(asked, count);
    return count;
}

static void print_asked(FILE *file, const asked_t *asked, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char text[ASK_TEXT_SIZE];
        print_port(file, &adapters[i]);
        (void)fprintf(file, ": %s\n", ask_text(&asked[i], text));
    }
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(end);
    return length > 0 && strlen(text) >= length && strcmp(text + strlen(text) - length, end) == 0;
}

#define SERIAL_PREFIX "serial:"

/* The port with the lidar whose serial number ends so. */
static const char *choose_by_serial(const char *end)
{
    static asked_t asked[PORTS_MAX];
    const size_t count = ask_all(find_adapters(), NULL, asked);
    size_t found = 0;
    size_t at = 0;
    for (size_t i = 0; i < count; i++) {
        if (ends_with(asked[i].serial, end)) {
            at = i;
            found++;
        }
    }
    if (found == 1) {
        message_note("using %s: serial %s", adapters[at].name, asked[at].serial);
        return adapters[at].name;
    }
    (void)message_usage(found == 0 ? "no lidar with a serial number that ends in %s:"
                                   : "several lidars have serial numbers that end in %s:",
                        end);
    print_asked(stderr, asked, count);
    return NULL;
}

const char *ports_choose(const options_t *options)
{
    const char *const usual = getenv("TMINI_PORT");
    const char *const wanted = options->port != NULL               ? options->port
                               : usual != NULL && usual[0] != '\0' ? usual
                                                                   : NULL;
    if (wanted != NULL) {
        return strncmp(wanted, SERIAL_PREFIX, sizeof SERIAL_PREFIX - 1) == 0
                   ? choose_by_serial(wanted + sizeof SERIAL_PREFIX - 1)
                   : wanted;
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
    struct stat status;
    char *const real = realpath(path, NULL);
    const char *name = path;
    if (real != NULL && lstat(path, &status) == 0 && !S_ISLNK(status.st_mode)) {
        const size_t count = find_adapters();
        for (size_t i = 0; i < count; i++) {
            name = strcmp(adapters[i].real, real) == 0 ? adapters[i].name : name;
        }
    }
    free(real);
    return name;
}

static int run(const options_t *options)
{
    static asked_t asked[PORTS_MAX];
    const size_t count = find_adapters();
    if (count == 0) {
        return message_fail("no USB serial adapter is plugged in, or its driver is missing "
                            "(on Linux, see `dmesg`)");
    }
    if (options->ask) {
        (void)ask_all(count, options->port, asked);
        print_asked(stdout, asked, count);
    } else {
        print(stdout, count);
    }
    return STATUS_OK;
}

const command_t command_ports = {
    .name = "ports",
    .usage = "[--ask [-p PORT]]",
    .summary = "the serial ports of this computer",
    .details = "A line for each: its most stable name, the device that this leads to, the USB\n"
               "numbers of its maker, and its chip if it is one of those that lidars come with.\n"
               "A command without -p takes the port of the environment's TMINI_PORT, or else\n"
               "the only such adapter.\n\n"
               "--ask also shows which lidar is there. It opens the adapters with such a chip\n"
               "(others only if -p names one), not those that a program holds; listens first,\n"
               "and asks silent ones what they are. Nothing else is sent, and a lidar that scans\n"
               "goes on. All at once, in 3 s. With -p serial:END any command finds the lidar\n"
               "whose serial number ends in END in the same way.",
    .accepts = "pEq",
    .run = run,
};
