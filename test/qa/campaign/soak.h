/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The campaign's mode of hours: see soak.c. */

#ifndef SOAK_H
#define SOAK_H

/* As main(): the arguments are "soak", the hours and the seed. */
int soak(int argc, char **argv);

#endif
