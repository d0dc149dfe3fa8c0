/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs that tests run: the host tool, the simulated lidar, and pseudo-terminals that behave
 * unlike a lidar. TMINI and TMINI_SIM are the programs' paths, WORK_DIR a folder for files: the one
 * that the test goes to (build/test/host/NAME.work), so that no path in what is shown depends on
 * the machine. POSIX only. */

#ifndef PROGRAM_H
#define PROGRAM_H

#include "encoder.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <termios.h>

#define PROGRAM_WORDS_MAX 16

/* For a shell: the programs that follow get so many KB of memory; with a sanitizer, which reserves
 * far more than it uses, as much as they like. */
#if defined(__SANITIZE_ADDRESS__)
#define PROGRAM_LIMIT(kilobytes) ""
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PROGRAM_LIMIT(kilobytes) ""
#endif
#endif
#ifndef PROGRAM_LIMIT
#define PROGRAM_LIMIT(kilobytes) "ulimit -v " kilobytes " && "
#endif

/* What the tool printed when it was run last, each ending with a 0. */
extern const char *program_output;
extern const char *program_errors;

/* A file's path in the folder for files; valid until the fourth call after this one. */
const char *program_path(const char *name);

/* The whole file, with a 0 after it; the test fails if there is none. Valid until the next call
 * with the same slot, 0 to 3. */
const char *program_read_file(unsigned slot, const char *path, size_t *size);

void program_write_file(const char *path, const void *bytes, size_t size);

/* Runs the tool with these words, up to a NULL, and waits for its end. Returns its exit status. The
 * test fails if it has not ended after a minute. */
int program_tmini(const char *const words[]);

/* The same, with its standard input from a file. */
int program_tmini_from(const char *input, const char *const words[]);

/* Whether root gives up its rights in the programs that are run from now on. */
void program_give_up_rights(bool gives_up);

/* The exit status of a program that could not be started. */
#define PROGRAM_CANNOT_START 127

/* Waits until a file in the folder for files holds this text; the test fails if it does not after a
 * minute. Returns all that it holds, valid as long as from program_read_file() with slot 0. */
const char *program_wait_for(const char *name, const char *text);

/* Starts the tool; program_finish() waits for its end, after sending it a signal unless that is 0.
 * */
pid_t program_start_tmini(const char *const words[]);
int program_finish(pid_t tool, int signal_number);

/* What waits long may run beside other tests: what is started between these two is left alone by
 * program_clean_up(). program_start_as() starts the tool with output of its own;
 * program_finish_as() waits for its end, once. */
void program_begin_background(void);
void program_end_background(void);
pid_t program_start_as(const char *name, const char *const words[]);
int program_finish_as(const char *name, pid_t tool);

/* The same for another program. */
pid_t program_start(const char *path, const char *const words[]);

/* Starts the tool on a terminal of its own, of that size; the terminal's other end is returned in
 * `master`, and what the terminal's programs see of it in `line`. Both are the caller's to close.
 * In `before`: the terminal's settings before the tool began. */
pid_t program_start_on_terminal(unsigned columns, unsigned rows, const char *const words[],
                                int *master, int *line, struct termios *before);

/* The same for a shell's command line. */
pid_t program_start_shell_on_terminal(unsigned columns, unsigned rows, const char *script,
                                      int *master, int *line, struct termios *before);

/* Starts the simulated lidar on a pseudo-terminal, or on a socket if the options say so, with more
 * options up to a NULL. Returns the port as the tool wants it, which stays valid. */
const char *program_start_lidar(const char *const options[]);

/* One for programs that run already: their clock is its own. */
const char *program_start_lidar_again(const char *const options[]);

/* Lets the file "adapter" lead to this device, as the system's names of an adapter do to what is
 * plugged in; NULL: to none. */
void program_plug_in(const char *device);

/* Programs that are started from now on share a clock that skips the time in which nothing happens
 * (idle_clock.c); until the test ends. Each lidar begins such a clock by itself, for those started
 * after it; unless real time is to be used. */
void program_skip_idle_time(void);
void program_use_real_time(void);

/* As if its cable were pulled. */
void program_stop_lidar(void);

/* As if its supply failed: the port stays, but nothing comes any more. */
void program_freeze_lidar(void);

/* As if it had come back. */
void program_thaw_lidar(void);

/* Opens a pseudo-terminal and repeats these bytes on it without end, at about the lidar's speed;
 * sends nothing if `size` is 0. Returns the port, which stays valid. */
const char *program_start_talker(const uint8_t *bytes, size_t size);

/* The same, but sends these bytes once after each command A5 `code`, and nothing else. */
const char *program_start_answerer(uint8_t code, const uint8_t *bytes, size_t size);

/* How often the text has this part. */
unsigned program_count(const char *text, const char *part);

/* Runs a command of the tool that must fail with this status, and a message that gives this
 * reason. */
void program_expect_failure(int status, const char *reason, const char *const words[]);

/* A recording of this name: a turn at 6 Hz whose samples are at 0, 90, 180 and 270 degrees. Returns
 * its path. */
const char *program_write_turn(const char *name, const encode_sample_t samples[4]);

/* Ends all that runs. For tearDown(). */
void program_clean_up(void);

#endif
