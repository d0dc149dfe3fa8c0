/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The bridge on a computer: a lidar on a serial port, for `-p tcp:HOST:PORT` of the tool elsewhere.
 * The lidar scans while somebody listens. */

#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bridge.h"
#include "tcp.h"
#include "tmini/tmini_names.h"
#include "tmini_posix.h"

#define STOP_MS 1000u
#define SLICE_MS 5

static tmini_posix_t port;
static tmini_t lidar;
static tmini_timing_t timing;
static uint8_t rx[4096];
static bridge_t bridge;
static tcp_server_t tcp;
static uint32_t reconnections;
static volatile sig_atomic_t is_over;

static void end(int number)
{
    (void)number;
    is_over = 1;
}

static uint64_t now_us(void)
{
    return (uint64_t)tmini_posix_now_us(&port);
}

static void pass(void *context, const uint8_t *bytes, size_t count)
{
    bridge_pass(context, now_us(), bytes, count);
}

static void report(tmini_event_t event)
{
    if (event == TMINI_EVENT_COMMAND_FAILED) {
        (void)fprintf(stderr, "the lidar does not answer: %s\n",
                      tmini_status_name(tmini_command_error(&lidar)));
    } else if (event == TMINI_EVENT_STARTED || event == TMINI_EVENT_STOPPED ||
               event == TMINI_EVENT_LOST || event == TMINI_EVENT_RECOVERED) {
        (void)fprintf(stderr, "%s\n", tmini_event_name(event));
    }
}

/* Carries on for a moment. */
static void work(void)
{
    for (tmini_event_t event; (event = tmini_poll(&lidar)) != TMINI_EVENT_NONE;) {
        report(event);
    }
    (void)tmini_posix_wait(&port, SLICE_MS);
    if (port.reconnections != reconnections) {
        reconnections = port.reconnections;
        bridge_pass(&bridge, now_us(), NULL, 0);
    }
    tcp_server_serve(&tcp, now_us());
}

static void serve(void)
{
    bool is_wanted = false;
    while (is_over == 0) {
        work();
        if (bridge_is_wanted(&bridge, now_us()) != is_wanted) {
            is_wanted = !is_wanted;
            (void)(is_wanted ? tmini_start : tmini_stop)(&lidar);
        }
    }
}

static void stop(void)
{
    const uint32_t begun_ms = tmini_posix_port.now_ms(NULL);
    (void)tmini_stop(&lidar);
    while (tmini_state(&lidar) != TMINI_STATE_IDLE &&
           tmini_posix_port.now_ms(NULL) - begun_ms < STOP_MS) {
        work();
    }
}

static bool set_up(const char *path, uint16_t frequency_chz)
{
    timing = tmini_timing_default;
    timing.frame_timeout_ms = 250;
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .frequency_chz = frequency_chz,
        .timing = &timing,
    };
    tmini_posix_init(&port, path);
    tmini_posix_tap(&port, pass, &bridge);
    tmini_posix_reconnect(&port, true);
    tcp_server_init(&tcp, &bridge);
    return tmini_init(&lidar, &config) == TMINI_OK;
}

static void watch_signals(void)
{
    struct sigaction action = {.sa_handler = end};
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    (void)sigaction(SIGHUP, &action, NULL);
}

static int use(void)
{
    (void)fprintf(stderr,
                  "usage: tmini-bridge [--all] [-f HZ] PORT [TCP_PORT]\n"
                  "--all: listeners may be on other computers: everybody there sees the room\n"
                  "TCP_PORT: 8090 unless given; 0: any that is free\n");
    return 2;
}

int main(int count, char **words)
{
    bool is_open = false;
    double hz = 0;
    int at = 1;
    for (; at < count && words[at][0] == '-'; at++) {
        if (strcmp(words[at], "--all") == 0) {
            is_open = true;
        } else if (strcmp(words[at], "-f") == 0 && at + 1 < count) {
            hz = strtod(words[++at], NULL);
        } else {
            return use();
        }
    }
    const long number = at + 1 < count ? strtol(words[at + 1], NULL, 10) : 8090;
    if (at >= count || count > at + 2 || number < 0 || number > 65535 || !(hz >= 0 && hz <= 12) ||
        !set_up(words[at], (uint16_t)(hz * 100 + 0.5))) {
        return use();
    }
    const tmini_posix_status_t opened = tmini_posix_start(&port, &lidar);
    const unsigned listened = tcp_server_listen(&tcp, (unsigned)number, is_open);
    if (listened == 0) {
        perror("tmini-bridge: cannot listen");
        return 1;
    }
    if (opened != TMINI_POSIX_OK) {
        (void)fprintf(stderr, "%s: %s; waiting for it\n", words[at],
                      tmini_posix_status_name(opened));
    }
    (void)printf("tcp:%s:%u\n", is_open ? "0.0.0.0" : "127.0.0.1", listened);
    (void)fflush(stdout);
    watch_signals();
    serve();
    stop();
    tcp_server_close(&tcp, now_us());
    tmini_posix_stop(&port);
    return 0;
}
