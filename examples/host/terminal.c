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
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "interrupt.h"

#define OTHER_SCREEN "\033[?1049h\033[?25l\033[2J"
#define OWN_SCREEN "\033[0m\033[?25h\033[?1049l"

#define BRAILLE 0x2800u

/* The most bytes that a cell takes (a change of colour and a character), and the end of a row. */
#define CELL_SIZE 16u
#define ROW_SIZE 32u

/* How long the rest of an arrow key's sequence may take. */
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

static bool has_cursor(void)
{
    return variable("TERM")[0] != '\0' && strcmp(variable("TERM"), "dumb") != 0;
}

/* Reads the variables instead of calling setlocale(): over ssh they may name locales that are not
 * installed here. */
static bool has_unicode(void)
{
    static const char *const names[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    size_t i = 0;
    while (i < 2 && variable(names[i])[0] == '\0') {
        i++;
    }
    const char *const locale = variable(names[i]);
    return strstr(locale, "UTF") != NULL || strstr(locale, "utf") != NULL;
}

/* Keys come at once and are not echoed. Ctrl-C remains a signal. Ctrl-Z becomes a key, because the
 * terminal has to be restored first. */
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

/* Restores the terminal without waiting for it: output may have been stopped (Ctrl-S), or its
 * reader may have gone. May be called from a signal's handler. */
static void restore_at_once(void)
{
    if (is_taken == 0) {
        return;
    }
    is_taken = 0;
    struct termios unstopped = before;
    unstopped.c_iflag &= ~(tcflag_t)IXON; /* Lets stopped output continue. */
    if (keyboard >= 0) {
        (void)tcsetattr(keyboard, TCSANOW, &unstopped);
    }
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags | O_NONBLOCK);
    if (!write_own_screen()) {
        (void)tcflush(STDOUT_FILENO, TCOFLUSH);
        (void)write_own_screen();
    }
    (void)fcntl(STDOUT_FILENO, F_SETFL, flags); /* Other programs write to it, too. */
    if (keyboard >= 0) {
        (void)tcsetattr(keyboard, TCSANOW, &before);
    }
}

static void write_all(const char *text, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(STDOUT_FILENO, text, size);
        if (written < 0 && errno != EINTR && errno != EAGAIN) {
            return; /* The terminal has gone; a signal comes as well. */
        }
        if (written < 0 && interrupt_has_come()) {
            return; /* A terminal that accepts no output must not block the program. */
        }
        if (written < 0) {
            struct pollfd entry = {.fd = STDOUT_FILENO, .events = POLLOUT};
            (void)poll(&entry, 1, SEQUENCE_MS);
        } else {
            text += written;
            size -= (size_t)written;
        }
    }
}

bool terminal_take(void)
{
    if (isatty(STDOUT_FILENO) == 0) {
        return false;
    }
    own_screen_size = has_cursor() ? sizeof OWN_SCREEN - 1 : 0;
    take_keys();
    is_taken = 1;
    if (!is_at_exit) {
        is_at_exit = atexit(terminal_restore) == 0;
    }
    interrupt_last_words(restore_at_once);
    (void)signal(SIGTSTP, SIG_IGN); /* A stopped program could not restore the terminal. */
    write_all(OTHER_SCREEN, has_cursor() ? strlen(OTHER_SCREEN) : 0);
    return true;
}

void terminal_restore(void)
{
    if (is_taken != 0) {
        restore_at_once();
        (void)signal(SIGTSTP, SIG_DFL);
    }
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
    terminal_restore(); /* SIGTSTP has its default effect again. */
    (void)kill(0, SIGTSTP);
    (void)terminal_take();
}

/* ------------------------------------------------------------------------------------- screen */

screen_t screen_begin(void)
{
    return (screen_t){.has_cursor = has_cursor(),
                      .has_colours = has_cursor() && variable("NO_COLOR")[0] == '\0',
                      .has_unicode = has_unicode()};
}

void screen_free(screen_t *screen)
{
    free(screen->cells);
    free(screen->output);
    screen->cells = NULL;
    screen->output = NULL;
    screen->rows = 0;
}

void screen_clear(screen_t *screen)
{
    for (size_t i = 0; i < (size_t)screen->columns * screen->rows; i++) {
        screen->cells[i] = (cell_t){' ', COLOUR_PLAIN, LAYER_NONE};
    }
}

bool screen_fit(screen_t *screen)
{
    struct winsize size;
    const unsigned spare = screen->has_cursor ? 0 : 1; /* The cursor would be below the last row. */
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row <= spare) {
        size = (struct winsize){.ws_col = 80, .ws_row = 24};
    }
    if (size.ws_col == screen->columns && size.ws_row - spare == screen->rows) {
        return false;
    }
    screen_free(screen);
    screen->columns = size.ws_col;
    screen->rows = size.ws_row - spare;
    screen->cells = calloc((size_t)screen->columns * screen->rows, sizeof *screen->cells);
    screen->output =
        malloc((size_t)screen->rows * ((size_t)screen->columns * CELL_SIZE + ROW_SIZE) + ROW_SIZE);
    if (screen->cells == NULL || screen->output == NULL) {
        screen_free(screen);
    }
    screen_clear(screen);
    return true;
}

static cell_t *cell_at(const screen_t *screen, int column, int row)
{
    if (column < 0 || row < 0 || (unsigned)column >= screen->columns ||
        (unsigned)row >= screen->rows) {
        return NULL;
    }
    return &screen->cells[(size_t)row * screen->columns + (size_t)column];
}

void screen_put(screen_t *screen, int column, int row, uint16_t character, char plain,
                uint8_t colour)
{
    cell_t *const cell = cell_at(screen, column, row);
    if (cell != NULL) {
        const uint16_t put = screen->has_unicode ? character : (unsigned char)plain;
        *cell = (cell_t){put, colour, LAYER_TEXT};
    }
}

void screen_text(screen_t *screen, int column, int row, const char *text, uint8_t colour)
{
    for (; *text != '\0'; text++) {
        const unsigned char character = (unsigned char)*text;
        const char put = character >= ' ' && character < 127 ? *text : '?';
        screen_put(screen, column++, row, (uint16_t)put, put, colour);
    }
}

/* The bit of each dot in a braille character. The lowest row has the highest bits. */
static uint16_t braille_bit(int x, int y)
{
    static const uint8_t bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    return bits[y][x];
}

void screen_dot(screen_t *screen, int x, int y, layer_t layer, uint8_t colour)
{
    cell_t *const cell = x >= 0 && y >= 0 ? cell_at(screen, x / 2, y / 4) : NULL;
    if (cell == NULL || cell->layer > layer) {
        return;
    }
    if (cell->layer < layer) {
        *cell = (cell_t){BRAILLE, colour, (uint8_t)layer};
    }
    if (screen->has_unicode) {
        cell->character |= braille_bit(x % 2, y % 4);
    } else {
        cell->character = layer == LAYER_GRID ? '.' : '*';
    }
    cell->colour = colour;
}

static char *put_utf8(char *out, unsigned character)
{
    if (character < 0x80) {
        *out++ = (char)character;
    } else if (character < 0x800) {
        *out++ = (char)(0xC0u | character >> 6);
        *out++ = (char)(0x80u | (character & 0x3Fu));
    } else {
        *out++ = (char)(0xE0u | character >> 12);
        *out++ = (char)(0x80u | (character >> 6 & 0x3Fu));
        *out++ = (char)(0x80u | (character & 0x3Fu));
    }
    return out;
}

/* A row without a cursor ends with its last character. */
static unsigned width_of(const screen_t *screen, unsigned row)
{
    unsigned width = screen->columns;
    while (!screen->has_cursor && width > 0 &&
           cell_at(screen, (int)width - 1, (int)row)->character == ' ') {
        width--;
    }
    return width;
}

void screen_show(screen_t *screen)
{
    char *out = screen->output;
    int colour = -1;
    for (unsigned row = 0; row < screen->rows; row++) {
        out += screen->has_cursor ? sprintf(out, "\033[%u;1H", row + 1) : 0;
        const unsigned width = width_of(screen, row);
        for (unsigned column = 0; column < width; column++) {
            const cell_t *const cell = cell_at(screen, (int)column, (int)row);
            if (screen->has_colours && cell->character != ' ' && cell->colour != colour) {
                colour = cell->colour;
                out += sprintf(out, "\033[38;5;%dm", colour);
            }
            out = put_utf8(out, cell->character);
        }
        out += screen->has_cursor ? 0 : sprintf(out, "\n");
    }
    write_all(screen->output, (size_t)(out - screen->output));
}
