/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _XOPEN_SOURCE 700

#include "users.h"

#include <ctype.h>
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_SIZE 600
#define LINE_SIZE 4096

typedef struct {
    char device[PATH_SIZE]; /* The real path. */
    struct stat node;
    const char *name; /* The part after the last slash. */
    char *text;
} port_t;

const char *users_root(void)
{
    const char *const folder = getenv("TMINI_ROOT");
    return folder != NULL ? folder : "";
}

static size_t read_file(const char *path, char *content, size_t size)
{
    FILE *const file = fopen(path, "r");
    const size_t count = file != NULL ? fread(content, 1, size - 1, file) : 0;
    content[count] = '\0';
    if (file != NULL) {
        (void)fclose(file);
    }
    return count;
}

/* Appends a user, as long as there is certainly room for its name and the port's. */
static void add(port_t *port, const char *user)
{
    const size_t length = strlen(port->text);
    if (length < USERS_TEXT_SIZE / 2) {
        (void)snprintf(port->text + length, USERS_TEXT_SIZE - length, "%s%s",
                       length == 0 ? "" : " and ", user);
    }
}

/* The name of the port as a whole word: a console is "ttyS0", a getty's argument "ttyS0" too. */
static bool has_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = strstr(text, word); at != NULL; at = strstr(at + 1, word)) {
        const char before = at > text ? at[-1] : ' ';
        if ((before == '/' || isspace((unsigned char)before) || strchr(",:=", before) != NULL) &&
            strchr(" \n\t,:;", at[length]) != NULL) {
            return true; /* The end of the text is among these. */
        }
    }
    return false;
}

static void look_for_console(port_t *port)
{
    char path[PATH_SIZE];
    char content[LINE_SIZE];
    (void)snprintf(path, sizeof path, "%s/sys/class/tty/console/active", users_root());
    if (read_file(path, content, sizeof content) > 0 && has_word(content, port->name)) {
        add(port, "the kernel's console");
    }
}

/* An argument names the port: as this word, or by any path that leads there. (For another program
 * /dev/fd/3 and /dev/stdin are other devices than for this one.) */
static bool names_port(const port_t *port, const char *argument)
{
    char real[PATH_SIZE] = "";
    if (strncmp(argument, "/dev/", 5) == 0 && strncmp(argument, "/dev/fd/", 8) != 0 &&
        strncmp(argument, "/dev/std", 8) != 0 && strlen(argument) < 300) {
        char path[PATH_SIZE];
        (void)snprintf(path, sizeof path, "%s%s", users_root(), argument);
        char *const found = realpath(path, NULL);
        (void)snprintf(real, sizeof real, "%s", found != NULL ? found : "");
        free(found);
    }
    return strcmp(real, port->device) == 0 || has_word(argument, port->name);
}

/* The arguments follow each other, each with a 0 at its end. */
static bool is_named_by(const port_t *port, const char *process)
{
    char path[PATH_SIZE];
    char line[LINE_SIZE];
    (void)snprintf(path, sizeof path, "%s/proc/%s/cmdline", users_root(), process);
    const size_t count = read_file(path, line, sizeof line);
    for (size_t at = 0; at < count; at += strlen(line + at) + 1) {
        if (names_port(port, line + at)) {
            return true;
        }
    }
    return false;
}

/* One of its descriptors is this device. (Of a pseudo-terminal it may also be an earlier one with
 * the same number.) */
static bool is_held_by(const port_t *port, const char *process)
{
    char path[PATH_SIZE];
    bool is_held = false;
    if (strncmp(port->name, "pts/", 4) == 0) {
        return false;
    }
    (void)snprintf(path, sizeof path, "%s/proc/%s/fd", users_root(), process);
    DIR *const folder = opendir(path);
    const struct dirent *entry = NULL;
    while (folder != NULL && !is_held && (entry = readdir(folder)) != NULL) {
        char link[PATH_SIZE + 300];
        struct stat held;
        (void)snprintf(link, sizeof link, "%s/%s", path, entry->d_name);
        is_held = stat(link, &held) == 0 && held.st_dev == port->node.st_dev &&
                  held.st_ino == port->node.st_ino;
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    return is_held;
}

/* The program's name and its parent: "812 (agetty) S 1 …". */
static long read_stat(const char *process, char name[40])
{
    char path[PATH_SIZE];
    char line[LINE_SIZE];
    long parent = 0;
    name[0] = '\0';
    (void)snprintf(path, sizeof path, "%s/proc/%s/stat", users_root(), process);
    (void)read_file(path, line, sizeof line);
    const char *const begin = strchr(line, '(');
    const char *const end = strrchr(line, ')');
    if (begin != NULL && end != NULL && end > begin) {
        (void)snprintf(name, 40, "%.*s", (int)(end - begin - 1), begin + 1);
        parent = strtol(end + 4 < line + sizeof line ? end + 4 : "", NULL, 10); /* After ") S ". */
    }
    return parent;
}

/* This program itself, and those that have started it: `sudo tmini -p …` names the port, too. */
static bool is_own(long process)
{
    char number[24];
    char name[40];
    for (long own = (long)getpid(); own > 1;) {
        if (own == process) {
            return true;
        }
        (void)snprintf(number, sizeof number, "%ld", own);
        own = read_stat(number, name);
    }
    return false;
}

static void look_at_process(port_t *port, const char *process)
{
    char name[40];
    char user[80];
    if ((!is_named_by(port, process) && !is_held_by(port, process)) ||
        is_own(strtol(process, NULL, 10))) {
        return;
    }
    (void)read_stat(process, name);
    (void)snprintf(user, sizeof user, "%s (process %.12s)", name, process);
    add(port, user);
}

const char *users_find(const char *path, char text[USERS_TEXT_SIZE])
{
    char folder_path[PATH_SIZE];
    char *const device = realpath(path, NULL);
    port_t port = {.text = text};
    const struct dirent *entry = NULL;
    text[0] = '\0';
    if (device == NULL || stat(device, &port.node) != 0) {
        free(device);
        return text;
    }
    (void)snprintf(port.device, sizeof port.device, "%s", device);
    free(device);
    port.name = strrchr(port.device, '/') + 1;
    if (strncmp(port.device, "/dev/pts/", 9) == 0) {
        port.name = port.device + 5; /* "3" alone is no name. */
    }
    look_for_console(&port);
    (void)snprintf(folder_path, sizeof folder_path, "%s/proc", users_root());
    DIR *const folder = opendir(folder_path);
    while (folder != NULL && (entry = readdir(folder)) != NULL) {
        if (isdigit((unsigned char)entry->d_name[0]) != 0) {
            look_at_process(&port, entry->d_name);
        }
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    if (text[0] != '\0') {
        (void)snprintf(text + strlen(text), USERS_TEXT_SIZE - strlen(text), " %s %s",
                       strstr(text, " and ") != NULL ? "use" : "uses", port.name);
    }
    return text;
}
