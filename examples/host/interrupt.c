/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t has_come;

static void (*volatile last_words[2])(void);

/* Returning lets the second signal, which is blocked meanwhile, do what it does by itself. */
static void note(int signal_number)
{
    if (has_come == 0) {
        has_come = 1;
        return;
    }
    for (size_t i = 0; i < 2 && last_words[i] != NULL; i++) {
        last_words[i]();
    }
    (void)signal(signal_number, SIG_DFL);
    (void)raise(signal_number);
}

void interrupt_last_words(void (*speak)(void))
{
    const size_t at = last_words[0] == NULL || last_words[0] == speak ? 0 : 1;
    last_words[at] = speak;
}

void interrupt_ignore_closed_pipes(void)
{
    (void)signal(SIGPIPE, SIG_IGN);
}

void interrupt_watch(void)
{
    struct sigaction action = {.sa_handler = note};
    (void)sigemptyset(&action.sa_mask);
    (void)sigaddset(&action.sa_mask,
                    SIGINT); /* One after another, so that the last words are whole. */
    (void)sigaddset(&action.sa_mask, SIGTERM);
    (void)sigaddset(&action.sa_mask, SIGHUP);
    (void)sigaddset(&action.sa_mask, SIGQUIT);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    (void)sigaction(SIGHUP, &action, NULL);
    (void)sigaction(SIGQUIT, &action, NULL);
}

bool interrupt_has_come(void)
{
    return has_come != 0;
}
