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

static volatile sig_atomic_t is_taken;
static bool has_keys;
static struct termios before;

/* Keys at once and unseen. Ctrl-C remains a signal; Ctrl-Z would leave the terminal as it is. */
static void take_keys(void)
{
    has_keys = tcgetattr(STDIN_FILENO, &before) == 0;
    if (!has_keys) {
        return;
    }
    struct termios settings = before;
    settings.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 0;
    settings.c_cc[VSUSP] = _POSIX_VDISABLE;
    (void)tcsetattr(STDIN_FILENO, TCSADRAIN, &settings);
}

static bool write_own_screen(void)
{
    const size_t size = sizeof OWN_SCREEN - 1;
    return write(STDOUT_FILENO, OWN_SCREEN, size) == (ssize_t)size;
}

/* Gives the terminal back without waiting for it: output may have been stopped (Ctrl-S), or nobody may
 * be there who reads it. May be called from a signal's handler. */
static void restore_at_once(void)
{
    if (is_taken == 0) {
        return;
    }
    is_taken = 0;
    struct termios unstopped = before;
    unstopped.c_iflag &= ~(tcflag_t)IXON; /* Lets stopped output go on. */
    if (has_keys) {
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &unstopped);
    }
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags | O_NONBLOCK);
    if (!write_own_screen()) {
        (void)tcflush(STDOUT_FILENO, TCOFLUSH);
        (void)write_own_screen();
    }
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags); /* Others write to it too. */
    if (has_keys) {
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &before);
    }
}

bool terminal_take(void)
{
    if (isatty(STDOUT_FILENO) == 0) {
        return false;
    }
    take_keys();
    is_taken = 1;
    (void)atexit(terminal_restore);
    interrupt_last_words(restore_at_once);
    (void)signal(SIGTSTP, SIG_IGN); /* Stopped, the program could not give the terminal back. */
    terminal_write(OTHER_SCREEN, strlen(OTHER_SCREEN));
    return true;
}

void terminal_restore(void)
{
    if (interrupt_has_come()) {
        restore_at_once();
    }
    if (is_taken == 0) {
        return;
    }
    is_taken = 0;
    (void)signal(SIGTSTP, SIG_DFL);
    terminal_write(OWN_SCREEN, strlen(OWN_SCREEN));
    if (has_keys) {
        (void)tcsetattr(STDIN_FILENO, TCSADRAIN, &before);
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

char terminal_key(void)
{
    struct pollfd keyboard = {.fd = STDIN_FILENO, .events = POLLIN};
    char key = 0;
    if (!has_keys || poll(&keyboard, 1, 0) <= 0 || read(STDIN_FILENO, &key, 1) != 1) {
        return 0;
    }
    return key;
}

void terminal_write(const char *text, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(STDOUT_FILENO, text, size);
        if (written < 0 && errno != EINTR && errno != EAGAIN) {
            return; /* The terminal has gone; a signal says so too. */
        }
        if (written < 0 && interrupt_has_come()) {
            return; /* Whether the terminal takes any more is not to keep the program from ending. */
        }
        if (written > 0) {
            text += written;
            size -= (size_t)written;
        }
    }
}
