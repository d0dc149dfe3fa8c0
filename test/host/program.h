/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs that tests run: the host tool, the simulated lidar, and pseudo-terminals that do not
 * behave like a lidar. TMINI and TMINI_SIM are the programs' paths. WORK_DIR is the folder for
 * files in which the test runs (build/test/host/NAME.work), so that the output does not depend on
 * paths of the machine. POSIX only. */

#ifndef PROGRAM_H
#define PROGRAM_H

#include "encoder.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <termios.h>

#define PROGRAM_WORDS_MAX 16

/* For a shell: limits the memory of the following programs. No limit with a sanitizer, which
 * reserves far more memory than it uses. */
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

/* The output of the last run of the tool, each ending with a 0. */
extern const char *program_output;
extern const char *program_errors;

/* A file's path in WORK_DIR; valid until the fourth call after this one. */
const char *program_path(const char *name);

/* The whole file, with a 0 after it; the test fails if the file does not exist. Valid until the
 * next call with the same slot, 0 to 3. */
const char *program_read_file(unsigned slot, const char *path, size_t *size);

void program_write_file(const char *path, const void *bytes, size_t size);

/* Runs the tool with these arguments (up to a NULL), waits for its end, and returns its exit
 * status. The test fails if it has not ended after a minute. */
int program_tmini(const char *const words[]);

/* The same, with its standard input from a file. */
int program_tmini_from(const char *input, const char *const words[]);

/* Whether root gives up its rights in the programs that are run from now on. */
void program_give_up_rights(bool gives_up);

/* The exit status of a program that could not be started. */
#define PROGRAM_CANNOT_START 127

/* Waits until a file in WORK_DIR contains this text; the test fails after a minute. Returns the
 * file's content, valid as from program_read_file() with slot 0. */
const char *program_wait_for(const char *name, const char *text);

/* Starts the tool. program_finish() sends it a signal (0: none) and waits for its end. */
pid_t program_start_tmini(const char *const words[]);
int program_finish(pid_t tool, int signal_number);

/* Long-running programs may run during other tests: program_clean_up() does not end those started
 * between these two calls. program_start_as() starts the tool with separate output files;
 * program_finish_as() waits for its end; call it once. */
void program_begin_background(void);
void program_end_background(void);
pid_t program_start_as(const char *name, const char *const words[]);
int program_finish_as(const char *name, pid_t tool);

/* The same for another program. */
pid_t program_start(const char *path, const char *const words[]);

/* Starts the tool on its own terminal of this size. Returns the terminal's two ends, which the
 * caller closes (`line` is the one that the tool uses), and in `before` the terminal's settings
 * before the tool began. */
pid_t program_start_on_terminal(unsigned columns, unsigned rows, const char *const words[],
                                int *master, int *line, struct termios *before);

/* The same for a shell's command line. */
pid_t program_start_shell_on_terminal(unsigned columns, unsigned rows, const char *script,
                                      int *master, int *line, struct termios *before);

/* Starts the simulated lidar with these options (up to a NULL), by default on a pseudo-terminal.
 * Returns the port for the tool's option -p; it stays valid. */
const char *program_start_lidar(const char *const options[]);

/* The same, but sharing the clock of the programs that already run. */
const char *program_start_lidar_again(const char *const options[]);

/* Makes the file "adapter" a link to this device, as the system does when an adapter is plugged in;
 * NULL: removes it. */
void program_plug_in(const char *device);

/* Until the test ends, programs started from now on share a new clock that skips the time in which
 * nothing happens (idle_clock.c). Starting a lidar begins such a clock too, unless
 * program_use_real_time() was called. */
void program_skip_idle_time(void);
void program_use_real_time(void);

/* As if the cable were pulled. */
void program_stop_lidar(void);

/* As if the supply failed: the port stays, but no more bytes come. */
void program_freeze_lidar(void);

/* As if the supply had returned. */
void program_thaw_lidar(void);

/* Opens a pseudo-terminal and sends these bytes again and again, at about the lidar's speed;
 * nothing if `size` is 0. Returns the port, which stays valid. */
const char *program_start_talker(const uint8_t *bytes, size_t size);

/* The same, but sends these bytes once after each command A5 `code`, and nothing else. */
const char *program_start_answerer(uint8_t code, const uint8_t *bytes, size_t size);

/* How often the text contains this part. */
unsigned program_count(const char *text, const char *part);

/* Runs a command of the tool that must fail with this status and a message containing this
 * reason. */
void program_expect_failure(int status, const char *reason, const char *const words[]);

/* Writes a recording of a turn at 6 Hz with samples at 0, 90, 180 and 270 degrees; returns its
 * path. */
const char *program_write_turn(const char *name, const encode_sample_t samples[4]);

/* Ends all running programs. For tearDown(). */
void program_clean_up(void);

#endif
