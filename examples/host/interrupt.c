/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <unistd.h>

/* Stopping a lidar that receives nothing takes up to 2 s. */
#define GRACE_S 5

static volatile sig_atomic_t has_come; /* The first signal's number. */

static void (*volatile last_words[2])(void);

/* The signal is blocked until this handler returns; then it has its default effect. */
static void leave(int signal_number)
{
    for (size_t i = 0; i < 2 && last_words[i] != NULL; i++) {
        last_words[i]();
    }
    (void)signal(signal_number, SIG_DFL);
    (void)raise(signal_number);
}

/* The program may be blocked by a pipe's reader that does not read, so an alarm ends it. */
static void note(int signal_number)
{
    if (has_come == 0) {
        has_come = signal_number;
        (void)alarm(GRACE_S);
    } else {
        leave(signal_number == SIGALRM ? has_come : signal_number);
    }
}

void interrupt_last_words(void (*speak)(void))
{
    const size_t at = last_words[0] == NULL || last_words[0] == speak ? 0 : 1;
    last_words[at] = speak;
}

/* All signals are blocked during a handler, so that the last words are complete. */
static void handle(int signal_number, void (*handler)(int), int flags)
{
    struct sigaction action = {.sa_handler = handler, .sa_flags = flags};
    (void)sigfillset(&action.sa_mask);
    (void)sigaction(signal_number, &action, NULL);
}

void interrupt_watch_pipes(void)
{
    handle(SIGPIPE, leave, 0);
    (void)signal(SIGXFSZ, SIG_IGN); /* Writing beyond a limit then fails, as on a full disk. */
}

/* A signal that is ignored remains ignored: `nohup`, background jobs of a script. */
void interrupt_watch(bool writes_whole)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        struct sigaction before;
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
            handle(signals[i], note, writes_whole ? SA_RESTART : 0);
        }
    }
}

bool interrupt_has_come(void)
{
    return has_come != 0;
}
