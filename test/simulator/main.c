/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini-sim: the simulated lidar in real time for programs, in virtual time for emulators, or
 * recorded. */

#define _XOPEN_SOURCE 600

#include "host.h"
#include "link.h"
#include "options.h"
#include "report.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define EXIT_WRONG_USAGE 2

/* Bytes are collected this long before they are written, as a USB adapter does, so that many
 * simulated lidars can run on one computer. */
#define TICK_MS 8
#define LONGEST_SLEEP_MS 500 /* While nothing is sent. */

static sim_t device;
static sim_link_t wire;
static bridge_t bridge;
static host_t host;
static report_t report;
static volatile sig_atomic_t stop_requested;

static void request_stop(int signal_number)
{
    (void)signal_number;
    stop_requested = 1;
}

static void catch_signals(void)
{
    struct sigaction action = {.sa_handler = request_stop};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    action.sa_handler = SIG_IGN; /* a client that disconnects must not end this program */
    sigaction(SIGPIPE, &action, NULL);
}

/* Like sim_link_read(), after the bridge. */
static size_t read_bytes(uint64_t now_us, uint8_t *bytes, size_t max)
{
    const size_t count = sim_link_read(&wire, now_us, bytes, max);
    bridge_put(&bridge, bytes, count);
    return bridge_take(&bridge, now_us, bytes, max);
}

static double real_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static uint64_t end_us(const options_t *options)
{
    return options->seconds > 0.0 ? (uint64_t)(options->seconds * 1e6) : SIM_NEVER;
}

/* ---- In real time ---- */

/* Passes on the bytes of both directions up to now. */
static void exchange(const options_t *options, uint64_t now_us)
{
    uint8_t bytes[4096];
    size_t count = host_read(&host, bytes, sizeof bytes);
    if (options->boot_ms >= 0 && host.connected) {
        sim_power(&device, true, now_us); /* without effect if it has power */
    }
    if (count > 0) {
        sim_link_write(&wire, bytes, count, now_us);
    }
    do {
        count = read_bytes(now_us, bytes, sizeof bytes);
        host_write(&host, bytes, count);
    } while (count == sizeof bytes);
}

static int time_to_sleep_ms(uint64_t now_us, uint64_t until_us, double speed)
{
    uint64_t next_us = sim_link_next_us(&wire);
    next_us = next_us < until_us ? next_us : until_us;
    const double sleep_ms = (double)(next_us - now_us) / 1000.0 / speed + 1.0;
    if (next_us <= now_us || host.pending_count > 0u || sleep_ms < TICK_MS) {
        return TICK_MS;
    }
    return sleep_ms < LONGEST_SLEEP_MS ? (int)sleep_ms : LONGEST_SLEEP_MS;
}

static uint64_t serve(const options_t *options)
{
    const double origin = real_seconds();
    const uint64_t until_us = end_us(options);
    uint64_t now_us = 0;
    while (stop_requested == 0 && now_us < until_us) {
        now_us = (uint64_t)((real_seconds() - origin) * options->speed * 1e6);
        now_us = now_us < until_us ? now_us : until_us;
        exchange(options, now_us);
        host_wait(&host, time_to_sleep_ms(now_us, until_us, options->speed));
    }
    return now_us;
}

/* ---- In the caller's time ---- */

static size_t parse_hex(const char *text, uint8_t *bytes, size_t max)
{
    size_t count = 0;
    unsigned value = 0;
    while (count < max && sscanf(text, "%2x", &value) == 1) {
        bytes[count++] = (uint8_t)value;
        text += 2;
    }
    return count;
}

static void answer(uint64_t now_us)
{
    uint8_t bytes[4096];
    size_t count;
    do {
        count = read_bytes(now_us, bytes, sizeof bytes);
        for (size_t i = 0; i < count; i++) {
            printf("%02X", bytes[i]);
        }
    } while (count == sizeof bytes);
    printf("\n");
    fflush(stdout);
}

/* Runs until the input ends; returns the last time. */
static uint64_t serve_lines(void)
{
    char line[1024];
    uint64_t now_us = 0;
    while (stop_requested == 0 && fgets(line, sizeof line, stdin) != NULL) {
        uint8_t bytes[sizeof line / 2];
        char *rest = line;
        size_t count;
        now_us = strtoull(line, &rest, 10);
        rest += *rest == ' ' ? 1 : 0;
        count = parse_hex(rest, bytes, sizeof bytes);
        if (count > 0) {
            sim_link_write(&wire, bytes, count, now_us);
        }
        answer(now_us);
    }
    return now_us;
}

/* ---- In virtual time ---- */

/* Records the stream from the start command on, including its reply. */
static bool record(FILE *file, uint64_t until_us)
{
    static const uint8_t start[2] = {0xA5, SIM_COMMAND_START};
    const uint64_t step_us = 10000;
    uint8_t bytes[4096];
    uint64_t now_us = 0;
    sim_link_write(&wire, start, sizeof start, 0);
    while (now_us < until_us && stop_requested == 0) {
        size_t count;
        now_us = until_us - now_us < step_us ? until_us : now_us + step_us;
        count = read_bytes(now_us, bytes, sizeof bytes);
        if (fwrite(bytes, 1, count, file) != count) {
            return false;
        }
    }
    return true;
}

static bool write_recording(const options_t *options)
{
    FILE *file;
    if (!report_open_file(&file, options->write_path)) {
        return false;
    }
    const bool is_recorded = record(file, end_us(options));
    const bool is_written = report_close_file(file) && is_recorded;
    if (!is_written) {
        fprintf(stderr, "tmini-sim: cannot write %s: %s\n", options->write_path, strerror(errno));
    }
    return is_written;
}

static void set_up(const options_t *options)
{
    sim_init(&device, &options->device);
    bridge.config = options->bridge;
    if (options->boot_ms >= 0) {
        sim_power(&device, false, 0);
    }
    sim_set_health(&device, options->health);
    sim_block_rotor(&device, options->blocked);
    sim_cover_window(&device, options->covered);
    sim_link_init(&wire, &device, &options->link);
}

/* Runs until the end; false: something could not be written. */
static bool run(const options_t *options, uint64_t *now_us)
{
    if (options->write_path != NULL) {
        *now_us = end_us(options);
        return write_recording(options);
    }
    if (options->lines) {
        *now_us = serve_lines();
        return true;
    }
    printf("%s\n", host.address);
    fflush(stdout);
    *now_us = serve(options);
    host_close(&host);
    return true;
}

static bool open_host(const options_t *options)
{
    if ((!options->pty || host_open_pty(&host)) &&
        (options->tcp_port < 0 || host_open_tcp(&host, (uint16_t)options->tcp_port))) {
        return true;
    }
    fprintf(stderr, "tmini-sim: cannot serve anybody: %s\n", strerror(errno));
    return false;
}

int main(int argc, char **argv)
{
    options_t options;
    uint64_t now_us = 0;
    if (!options_parse(&options, argc, argv)) {
        return EXIT_WRONG_USAGE;
    }
    if (options.help || options.version) {
        (options.help ? options_print_help : options_print_version)();
        return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    catch_signals();
    set_up(&options);
    if (!open_host(&options) ||
        !report_open(&report, options.log_path, options.truth_path, &device, &wire)) {
        return EXIT_FAILURE;
    }
    const bool is_written = run(&options, &now_us);
    return report_close(&report, now_us, host.lost) && is_written ? EXIT_SUCCESS : EXIT_FAILURE;
}
