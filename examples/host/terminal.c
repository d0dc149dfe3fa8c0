/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE
#define _DARWIN_C_SOURCE

#include "terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "interrupt.h"

#define OTHER_SCREEN "\033[?1049h\033[?25l\033[2J"
#define OWN_SCREEN "\033[0m\033[?25h\033[?1049l"

/* How long the rest of an arrow's sequence may take. */
#define SEQUENCE_MS 50

static volatile sig_atomic_t is_taken;
static int keyboard = -1; /* -1: there is none. */
static struct termios before;
static bool is_at_exit;
static size_t own_screen_size; /* 0: there is only one screen. */

static const char *variable(const char *name)
{
    const char *const value = getenv(name);
    return value != NULL ? value : "";
}

bool terminal_has_cursor(void)
{
    return variable("TERM")[0] != '\0' && strcmp(variable("TERM"), "dumb") != 0;
}

bool terminal_has_colours(void)
{
    return variable("NO_COLOR")[0] == '\0' && terminal_has_cursor();
}

/* By the variables, not by setlocale(): over ssh they name locales that are not installed here. */
bool terminal_has_unicode(void)
{
    static const char *const names[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    size_t i = 0;
    while (i < 2 && variable(names[i])[0] == '\0') {
        i++;
    }
    const char *const locale = variable(names[i]);
    return strstr(locale, "UTF-8") != NULL || strstr(locale, "utf8") != NULL ||
           strstr(locale, "utf-8") != NULL || strstr(locale, "UTF8") != NULL;
}

/* Keys at once and unseen. Ctrl-C remains a signal; Ctrl-Z becomes a key, because the terminal has
 * to be given back first. */
static void take_keys(void)
{
    if (keyboard < 0) {
        keyboard = isatty(STDIN_FILENO) != 0 ? STDIN_FILENO : open("/dev/tty", O_RDONLY | O_NOCTTY);
    }
    if (keyboard < 0 || tcgetattr(keyboard, &before) != 0) {
        keyboard = -1;
        return;
    }
    struct termios settings = before;
    settings.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 0;
    settings.c_cc[VSUSP] = _POSIX_VDISABLE;
    (void)tcsetattr(keyboard, TCSADRAIN, &settings);
}

static bool write_own_screen(void)
{
    const size_t size = own_screen_size;
    return write(STDOUT_FILENO, OWN_SCREEN, size) == (ssize_t)size;
}

/* Gives the terminal back without waiting for it: output may have been stopped (Ctrl-S), or nobody
 * may be there who reads it. May be called from a signal's handler. */
static void restore_at_once(void)
{
    if (is_taken == 0) {
        return;
    }
    is_taken = 0;
    struct termios unstopped = before;
    unstopped.c_iflag &= ~(tcflag_t)IXON; /* Lets stopped output go on. */
    if (keyboard >= 0) {
        (void)tcsetattr(keyboard, TCSANOW, &unstopped);
    }
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags | O_NONBLOCK);
    if (!write_own_screen()) {
        (void)tcflush(STDOUT_FILENO, TCOFLUSH);
        (void)write_own_screen();
    }
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags); /* Others write to it too. */
    if (keyboard >= 0) {
        (void)tcsetattr(keyboard, TCSANOW, &before);
    }
}

bool terminal_take(void)
{
    if (isatty(STDOUT_FILENO) == 0) {
        return false;
    }
    own_screen_size = terminal_has_cursor() ? sizeof OWN_SCREEN - 1 : 0;
    take_keys();
    is_taken = 1;
    if (!is_at_exit) {
        is_at_exit = atexit(terminal_restore) == 0;
    }
    interrupt_last_words(restore_at_once);
    (void)signal(SIGTSTP, SIG_IGN); /* Stopped, the program could not give the terminal back. */
    terminal_write(OTHER_SCREEN, terminal_has_cursor() ? strlen(OTHER_SCREEN) : 0);
    return true;
}

void terminal_restore(void)
{
    if (is_taken != 0) {
        restore_at_once();
        (void)signal(SIGTSTP, SIG_DFL);
    }
}

bool terminal_size(unsigned *columns, unsigned *rows)
{
    struct winsize size;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
        return false;
    }
    *columns = size.ws_col;
    *rows = size.ws_row;
    return true;
}

/* The next byte from the keyboard, or 0 if none comes in time. */
static int next_byte(int timeout_ms)
{
    struct pollfd entry = {.fd = keyboard, .events = POLLIN};
    unsigned char byte = 0;
    if (keyboard < 0 || poll(&entry, 1, timeout_ms) <= 0 || read(keyboard, &byte, 1) != 1) {
        return 0;
    }
    return byte;
}

int terminal_key(void)
{
    const int key = next_byte(0);
    if (key != KEY_ESCAPE) {
        return key;
    }
    const int second = next_byte(SEQUENCE_MS);
    if (second != '[' && second != 'O') {
        return KEY_ESCAPE;
    }
    int last = 0;
    do {
        last = next_byte(SEQUENCE_MS);
    } while (last >= ' ' && last < '@');
    return last == 'C' ? KEY_RIGHT : last == 'D' ? KEY_LEFT : KEY_NONE;
}

void terminal_suspend(void)
{
    terminal_restore(); /* SIGTSTP does again what it does by itself. */
    (void)kill(0, SIGTSTP);
    (void)terminal_take();
}

void terminal_write(const char *text, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(STDOUT_FILENO, text, size);
        if (written < 0 && errno != EINTR && errno != EAGAIN) {
            return; /* The terminal has gone; a signal says so too. */
        }
        if (written < 0 && interrupt_has_come()) {
            return; /* What the terminal does not take is not to keep the program. */
        }
        if (written > 0) {
            text += written;
            size -= (size_t)written;
        }
    }
}
