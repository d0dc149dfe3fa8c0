/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What every port must do, however it receives. The tests in every_port.c run for each way of
 * receiving that a port's test describes here. */

#ifndef EVERY_PORT_H
#define EVERY_PORT_H

#include "known_packets.h"
#include "machine.h"
#include "scanning.h"

/* Tests split the manual's packet here. Only the port can notice a loss in between. */
#define PACKET_CUT 30u

/* What the port has counted; what it does not count is 0. */
typedef struct {
    uint32_t bytes;
    uint32_t lost;
    uint32_t overruns;
    uint32_t framing_errors;
    uint32_t breaks;
} port_counts_t;

typedef struct {
    const char *name;
    void (*choose)(void);          /* Changes the wiring; NULL: it is as at first. */
    void (*enlarge)(void);         /* Gives the layer below `holds` bytes. NULL: it has them. */
    bool always_wired;             /* No wiring is missing, and another start begins anew. */
    bool without_fifo;             /* A pause of 300 µs without interrupts overruns the UART. */
    uint32_t holds;                /* 0: there is no layer below. */
    uint32_t behind;               /* Most bytes not yet counted, while the lidar scans. */
    uint32_t old;                  /* Most bytes from before the start. */
    uint32_t packets_per_loss;     /* Packets that a loss of 20 ms costs at most. */
    void (*hold_up)(uint32_t us);  /* Keeps bytes from being received: the UART overruns. */
    void (*break_reception)(void); /* As other code could do. NULL: reception cannot break. */
    /* Errors of a byte, for machine_receive(). 0: unknown to the port. */
    uint32_t loss;
    uint32_t framing_error;
    uint32_t line_break;
} port_way_t;

/* Defined by a port's test. */
extern const port_way_t port_ways[];
extern const unsigned port_way_count;
extern scanning_t port_program;                  /* The port, and a program that uses it. */
void port_begin(const sim_observer_t *observer); /* Resets the model, the wiring and the port. */
int port_init(void);                             /* 0: it worked. */
int port_start(void);
void port_stop(void);
port_counts_t port_counted(void);
void port_assert_stopped(void); /* Nothing is left switched on, or taken. */

/* Also defined where sleeping.c runs: the polling task sleeps until the lidar must be polled, or a
 * byte comes. */
void port_sleep(uint32_t due_ms);
extern const uint32_t port_tick_us;

/* These functions and port_program, for a port with the usual names. */
#define PORT_UNDER_TEST(platform, wiring)               \
    int port_init(void)                                 \
    {                                                   \
        return tmini_##platform##_init(&port, wiring);  \
    }                                                   \
    int port_start(void)                                \
    {                                                   \
        return tmini_##platform##_start(&port, &lidar); \
    }                                                   \
    void port_stop(void)                                \
    {                                                   \
        (void)tmini_##platform##_stop(&port);           \
    }                                                   \
    scanning_t port_program = {.port = &tmini_##platform##_port, .context = &port, .wait = wait}

extern const port_way_t *port_way; /* NULL: no way has been chosen yet. */

/* Begins with the next way; returns false after the last one. */
bool next_way(void);
void begin_again(void);          /* With the same way. */
void begin_way(unsigned number); /* Of port_ways. */

/* Starts the port; the port and the lidar. */
void start_port(void);
void start(void);

/* The port has counted this many overruns, and no other errors of the line. */
void assert_counted(uint32_t losses);

/* Receives what waits; returns the number of packets since the start. */
uint32_t packets(void);

/* Sets up the program with a lidar whose receive buffer has this size. */
void init_lidar(size_t rx_size);

#endif
