/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The words of a situation: a port and its lidar in one of the ways to receive, packets that come,
 * and polls. */

#ifndef STM32_SCENES_H
#define STM32_SCENES_H

#include "stm32_rig.h"

extern rig_way_t rig_way; /* next_way() has chosen it; 0: none yet. */

#define RIG_RX_SIZE 1024u
extern uint8_t rig_rx[RIG_RX_SIZE];

void set_up_lidar(rig_way_t way); /* With this buffer. */
void open_port(rig_way_t way);    /* Hardware, port and lidar. */
void start_port(rig_way_t way);   /* The same, started after a pause. */
bool next_way(unsigned ways);     /* start_port() with the next of these; false after the last. */

/* Packets of 13 bytes on the line; the first byte with errors. */
#define PACKET_SIZE 13u
void send_packets(unsigned count);
void send_packet_with(uint32_t errors);
void send_broken_byte(uint32_t errors);

/* Polls until there is no event. */
tmini_counters_t poll_all(void);
uint32_t packets(void);
uint32_t bytes_accounted_for(void);

/* Polls every millisecond, until all bytes have arrived and the line is idle. */
void run(void);
void receive(unsigned packets); /* Sends and runs. */
void pass_ms(unsigned ms);      /* Polls each millisecond. */

#endif
