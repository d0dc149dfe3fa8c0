/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini: a driver for the YDLIDAR T-mini Plus, a spinning 2D lidar.
 *
 * The receive interrupt only stores bytes (tmini_feed_byte(), or tmini_feed() for blocks, or
 * tmini_feed_dma() for circular DMA). Everything else happens in tmini_poll(), which returns one
 * event a call and never waits:
 *
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN:  avoid_obstacles(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_FAULT: signal_fault(tmini_faults(&lidar)); break;
 *         default: break;
 *         }
 *     }
 *
 * Contexts. The three feed functions belong to the one context that receives: an interrupt, a
 * DMA interrupt or a task. All other functions belong to one other context, a main loop or a task.
 * Nothing is locked and no interrupt is disabled (but see tmini_atomic.h for 8-bit machines). Any
 * number of lidars, each with a tmini_t of its own.
 *
 * Time. No function waits. Commands only begin something; how it ends is an event. tmini_poll()
 * must be called often enough that the receive buffer does not overflow: the lidar sends about
 * 13,100 bytes a second, so 1024 bytes last 78 ms, or 39 ms with DMA, which can use half of them.
 * Call it until it returns TMINI_EVENT_NONE: only then does it look after time.
 *
 * "Section" in these headers means the section of docs/protocol.md. */

#ifndef TMINI_H
#define TMINI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_packet.h"
#include "tmini_parser.h"
#include "tmini_port.h"
#include "tmini_reply.h"
#include "tmini_ring.h"
#include "tmini_scan.h"
#include "tmini_status.h"
#include "tmini_turn.h"

#ifdef __cplusplus
extern "C" {
#endif

#define TMINI_VERSION_MAJOR 0
#define TMINI_VERSION_MINOR 1
#define TMINI_VERSION_PATCH 0

/* Scan frequencies that may be set, in 0.01 Hz (section 1). */
#define TMINI_FREQUENCY_MIN_CHZ 600u
#define TMINI_FREQUENCY_MAX_CHZ 1200u
#define TMINI_FREQUENCY_STEP_CHZ 10u

/* ------------------------------------------------------------------------------ configuration */

/* How long the driver waits for what, in milliseconds. Change a copy of tmini_timing_default: a
 * time of 0 is no time, or for stop, reply, spin-up, data, reboot and back-off no limit at all. */
typedef struct {
    uint16_t silence_ms;      /* A packet that stops coming is given up after this silence. */
    uint16_t quiet_ms;        /* A line silent this long after stop is quiet. */
    uint16_t stop_ms;         /* If it is not quiet by then, stop is sent again (section 9.10). */
    uint16_t reply_ms;        /* For a reply (section 9.11). */
    uint16_t write_ms;        /* For the port to take a command's two bytes. */
    uint16_t spin_up_ms;      /* From the start reply to the first packet. */
    uint16_t data_ms;         /* Without a valid packet for so long, the lidar is lost. */
    uint16_t turn_ms;         /* Packets without a range or a start packet: the rotor is blocked. */
    uint16_t reboot_ms;       /* For a soft reboot (section 9.11). */
    uint16_t back_off_ms;     /* First pause between attempts to recover; doubles each time, */
    uint16_t back_off_max_ms; /* up to this. */
    uint8_t attempts;         /* How often a command is tried, at least 1. */
} tmini_timing_t;

/* The values used when the configuration gives none; they fit the real device. */
extern const tmini_timing_t tmini_timing_default;

typedef struct {
    const tmini_port_t *port; /* Required. */
    void *port_context;       /* Passed to its functions. */
    uint8_t *rx_buffer;       /* Received bytes. Required. */
    size_t rx_size;           /* A power of two; 256 or more (512 with DMA) for 80 samples. */
    bool rx_dma;              /* The buffer is the target of circular DMA: use tmini_feed_dma(). */
    tmini_point_t *points;    /* One scan. NULL: streaming, an event for each packet instead. */
    size_t max_points;        /* 1 to 65535, or 0 when streaming. */
    uint8_t max_samples;      /* Packets with more are not valid; 0: the default, 80. */
    uint8_t filter;           /* Of scans: a combination of tmini_filter_t; 0: keep all. */
    bool no_recovery;         /* A lost lidar is reported, but not restarted. */
    const tmini_timing_t *timing; /* NULL: tmini_timing_default. */
} tmini_config_t;

/* ----------------------------------------------------------------------------- events, states */

typedef enum {
    TMINI_EVENT_NONE,
    TMINI_EVENT_STARTED,   /* Scanning: the first packet has come. */
    TMINI_EVENT_STOPPED,   /* Idle, and the line is quiet. */
    TMINI_EVENT_INFO,      /* tmini_info() has been read. */
    TMINI_EVENT_HEALTH,    /* tmini_health() has been read. */
    TMINI_EVENT_FREQUENCY, /* tmini_frequency_chz() has been read, or set and read back. */
    TMINI_EVENT_REBOOTED,  /* The soft reboot's time is over. */
    TMINI_EVENT_FAILED,    /* A command failed; tmini_failure() says why. */
    TMINI_EVENT_LOST, /* No valid packets any more; being recovered unless configured not to. */
    TMINI_EVENT_RECOVERED, /* Valid packets again. */
    TMINI_EVENT_FAULT,     /* tmini_faults() has changed, to 0 as well. */
    TMINI_EVENT_PACKET,    /* Streaming: tmini_packet() is valid until the next tmini_poll(). */
    TMINI_EVENT_SCAN,      /* tmini_scan() is valid until the next tmini_poll(). */
} tmini_event_t;

typedef enum {
    TMINI_STATE_UNKNOWN,  /* The lidar may be streaming: after init, reboot or a failure. */
    TMINI_STATE_IDLE,     /* Not scanning, and the line is quiet. */
    TMINI_STATE_BUSY,     /* Carrying out a query, a frequency change or a reboot. */
    TMINI_STATE_STOPPING, /* Waiting for the line to fall quiet after a stop. */
    TMINI_STATE_STARTING, /* Until the first packet. */
    TMINI_STATE_SCANNING,
    TMINI_STATE_RECOVERING, /* Lost while scanning; brought back, or waited for. */
} tmini_state_t;

/* Running totals, modulo the range of their type. */
typedef struct {
    tmini_parser_counters_t parser;
    uint32_t bytes_pending; /* Received and waiting for more. */
    uint32_t scans;         /* Delivered as TMINI_EVENT_SCAN. */
    uint16_t timeouts;      /* Waits that ended without what was waited for. */
    uint16_t losses;        /* TMINI_EVENT_LOST. */
    uint16_t recoveries;    /* TMINI_EVENT_RECOVERED. */
    uint16_t restarts;      /* Starts sent to recover. */
    uint16_t reboots;       /* Soft reboots sent to recover. */
} tmini_counters_t;

/* One lidar. The members are private; they are here so that it can be allocated statically. The
 * small ones come first: Thumb code reaches them with short instructions. */
typedef struct {
    uint8_t phase;     /* What goes on on the wire. */
    uint8_t goal;      /* The command that is being carried out. */
    uint8_t attempts;  /* Failed attempts at it. */
    uint8_t rung;      /* Failed attempts to recover. */
    uint8_t steps;     /* Frequency steps sent. */
    bool step_refused; /* The frequency did not change in answer to a step. */
    uint8_t sent;      /* The command code on its way, */
    uint8_t unsent;    /* and how many of its two bytes the port has not taken yet. */
    bool sign_sent;    /* The lidar has got the first byte of a command, and no second. */
    bool heard;        /* Bytes have come since the line was found quiet. */
    int8_t failure;    /* The status of the last failed command. */
    uint8_t faults;    /* As reported. */
    uint8_t observed;  /* As seen in the last revolution; reported when seen twice. */
    bool no_recovery;
    bool recovering;
    bool held;         /* The packet that closed the scan has not been added to the next. */
    bool range_seen;   /* A valid range since the last start packet. */
    bool whole;        /* Nothing has been lost since the last start packet. */
    uint16_t pending;  /* A bit for each event not yet returned. */
    uint16_t limit_ms; /* How long the phase may last; 0: as long as it likes. */
    uint16_t target_chz;
    uint16_t frequency_chz;
    uint16_t timeouts;
    uint16_t losses;
    uint16_t recoveries;
    uint16_t restarts;
    uint16_t reboots;
    uint32_t scans;
    uint32_t now_ms;      /* As of this poll. */
    uint32_t phase_ms;    /* When the phase began; while scanning, when the last packet came. */
    uint32_t received_ms; /* When bytes were last seen to have come. */
    uint32_t turning_ms;  /* When a start packet or a range last came. */
    size_t received;      /* The ring's head at received_ms. */
    const tmini_port_t *port;
    void *port_context;
    const tmini_timing_t *timing;

    tmini_ring_t ring;
    tmini_parser_t parser;
    tmini_turn_t turn;
    tmini_scan_builder_t builder; /* Without a capacity when streaming. */
    union {
        tmini_packet_t packet; /* While scanning. */
        tmini_info_t info;     /* The answers to commands, which are not sent while scanning. */
        tmini_health_t health;
    } latest;
} tmini_t;

/* ---------------------------------------------------------------------------------- life cycle */

/* Sets up a lidar; sends nothing. Nothing may be fed meanwhile; what is fed to an all-zero tmini_t
 * before is refused. Port, timing and buffers stay the caller's and must outlive the lidar; the
 * configuration itself may go.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: a required member missing or out of range; the lidar
 * then refuses commands and polls to nothing. */
tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config);

/* -------------------------------------------------------- receiving: interrupt or task context */

/* Stores one received byte: the call for a UART's receive interrupt. No loop, no wait, at most 16
 * instructions on a Cortex-M4. When the buffer is full the byte is refused and counted. */
static inline void tmini_feed_byte(tmini_t *lidar, uint8_t byte)
{
    tmini_ring_put(&lidar->ring, byte);
}

/* Stores a block of received bytes; those that do not fit are refused and counted. Bytes must not
 * be held back for longer than silence_ms, or their packet is given up. Two block copies. */
static inline void tmini_feed(tmini_t *lidar, const uint8_t *bytes, size_t count)
{
    tmini_ring_write(&lidar->ring, bytes, count);
}

/* Publishes how far circular DMA has written rx_buffer: `position` is the index it writes next
 * (rx_size less the channel's remaining count), and never goes back. Call it from the
 * half-transfer, transfer-complete and idle-line interrupts; all three are needed (tmini_ring.h
 * says why), and bytes must not be held back for longer than silence_ms. No loop, no wait.
 * Overwritten bytes are noticed when polling, counted, and never become points. */
static inline void tmini_feed_dma(tmini_t *lidar, size_t position)
{
    tmini_ring_publish(&lidar->ring, position);
}

/* -------------------------------------------------------- everything else: the polling context */

/* Parses what has been received, keeps time, sends what is due; returns the next event or
 * TMINI_EVENT_NONE when there is nothing left to do. Call it until then. Bounded by the bytes in
 * the receive buffer and two bytes sent. */
tmini_event_t tmini_poll(tmini_t *lidar);

/* Commands. Each only begins; the event in brackets or TMINI_EVENT_FAILED is its end. From an
 * unknown state each first stops the lidar and waits for a quiet line (section 9.10). All return
 *   TMINI_OK              begun
 *   TMINI_ERROR_ARGUMENT  null pointer, or a lidar that was not set up
 *   TMINI_ERROR_STATE     the lidar is scanning or being recovered: only stop is possible
 *   TMINI_ERROR_BUSY      another command is under way
 * and touch nothing unless they return TMINI_OK. If the event that ended the command before has not
 * been polled yet, it is dropped. */

/* Starts scanning [STARTED]. */
tmini_status_t tmini_start(tmini_t *lidar);

/* Stops scanning, and whatever else is under way [STOPPED]. In any state; an unfinished command
 * ends with TMINI_EVENT_FAILED, TMINI_ERROR_ABORTED. */
tmini_status_t tmini_stop(tmini_t *lidar);

/* Asks for the device information [INFO]. */
tmini_status_t tmini_request_info(tmini_t *lidar);

/* Asks for the health status [HEALTH]. */
tmini_status_t tmini_request_health(tmini_t *lidar);

/* Asks for the scan frequency that is set [FREQUENCY]. */
tmini_status_t tmini_request_frequency(tmini_t *lidar);

/* Sets the scan frequency, in steps of 1 and 0.1 Hz, and reads it back [FREQUENCY]. 600 to 1200, a
 * multiple of 10; TMINI_ERROR_ARGUMENT otherwise, and nothing is sent. Within 0.05 Hz is there. A
 * lidar that answers but does not get there ends with TMINI_EVENT_FAILED, TMINI_ERROR_REPLY. */
tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz);

/* Reboots the lidar [REBOOTED]. */
tmini_status_t tmini_reboot(tmini_t *lidar);

/* Results, of a lidar that has been set up. What information and health point to is valid from
 * their event to the next command; see the events for scan and packet. None returns NULL. */
tmini_state_t tmini_state(const tmini_t *lidar);
const tmini_scan_t *tmini_scan(const tmini_t *lidar);
const tmini_packet_t *tmini_packet(const tmini_t *lidar);
const tmini_info_t *tmini_info(const tmini_t *lidar);
const tmini_health_t *tmini_health(const tmini_t *lidar);
uint16_t tmini_frequency_chz(const tmini_t *lidar);

/* Why the last failed command failed: TMINI_ERROR_TIMEOUT, _WRITE, _REPLY or _ABORTED. */
tmini_status_t tmini_failure(const tmini_t *lidar);

/* What is wrong with the lidar while scanning, a combination of tmini_fault_t; 0: nothing known.
 * From CT information when the unit sends it, seen in two revolutions. A unit that sends none has
 * TMINI_FAULT_DATA when two whole revolutions bring no valid range. Either has TMINI_FAULT_ENCODER
 * when packets come without any range and without a revolution (section 8). */
uint8_t tmini_faults(const tmini_t *lidar);

/* CT information: version, health and serial number as sent while scanning, each if known. */
void tmini_turn(const tmini_t *lidar, tmini_turn_info_t *info);

/* Copies the counters. */
void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
