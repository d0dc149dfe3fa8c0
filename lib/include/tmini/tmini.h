/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * tmini: a driver for the YDLIDAR T-mini Plus, a spinning 2D lidar.
 *
 * You state what you want; the driver brings the lidar there and keeps it there, at the start,
 * after a lost connection, a reboot or a power failure. The receive interrupt only stores bytes
 * (tmini_feed_byte(), or tmini_feed() for blocks, or tmini_feed_dma() for circular DMA). Everything
 * else happens in tmini_poll(), which returns one event per call and never waits:
 *
 *     static const tmini_config_t config = {
 *         .port = &board_port, .rx_buffer = rx, .rx_size = sizeof rx,
 *         .points = points, .max_points = 800, .frequency_chz = 1000,
 *     };
 *
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_start(&lidar);                   stands until tmini_stop()
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: avoid_obstacles(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_LOST: stop_robot(); break;    until scans come again
 *         case TMINI_EVENT_FAULTS_CHANGED: signal_faults(tmini_faults(&lidar)); break;
 *         default: break;
 *         }
 *     }
 *
 * Contexts. The functions tmini_feed…() belong to the one context that receives: an interrupt, a
 * DMA interrupt or a task. All others belong to one context, another or the same.
 * Nothing is locked and no interrupt is disabled (but see tmini_atomic.h for 8-bit machines). Any
 * number of lidars, each with a tmini_t of its own.
 *
 * Time. No function waits. tmini_poll() must be called often enough that the receive buffer does
 * not overflow: at least every 38 ms with 1024 bytes, or every 16 ms with DMA, which can use half
 * of them (docs/footprint.md, "How often to poll", has other sizes). Call it until it returns
 * TMINI_EVENT_NONE: while events other than TMINI_EVENT_MORE are due, it does not look for
 * time-outs.
 *
 * "Section" in these headers means the section of docs/protocol.md. */

#ifndef TMINI_H
#define TMINI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_port.h"
#include "tmini_types.h"
/* For the structure's sake: what a lidar consists of. */
#include "parts/tmini_decoder.h"
#include "parts/tmini_reply.h"
#include "parts/tmini_ring.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The library's version, as in 1.2.3: the 1. Versioning is semantic (CHANGELOG.md). */
#define TMINI_VERSION_MAJOR 1
/** As in 1.2.3: the 2. */
#define TMINI_VERSION_MINOR 0
/** As in 1.2.3: the 3. */
#define TMINI_VERSION_PATCH 0
/** All of it, with what makes it a release candidate. */
#define TMINI_VERSION_TEXT "1.0.0-rc.1"

/** The lowest scan frequency that may be set, in 0.01 Hz (section 1). */
#define TMINI_FREQUENCY_MIN_CHZ 600u
/** The highest scan frequency that may be set, in 0.01 Hz (section 1). */
#define TMINI_FREQUENCY_MAX_CHZ 1200u
/** Scan frequencies that may be set are multiples of this, in 0.01 Hz (section 3). */
#define TMINI_FREQUENCY_STEP_CHZ 10u

/* ------------------------------------------------------------------------------ configuration */

/** How long the driver waits for what, in milliseconds. Change a copy of tmini_timing_default. */
typedef struct {
    /** A packet that stops coming is given up after this silence. 0: at the first poll before which
     * time has passed and nothing has come. */
    uint16_t frame_timeout_ms;
    /** What comes after a longer pause of the line does not continue a scan, if the pause is also
     * longer than half a turn (at 12 Hz 42 ms): the angles do not show a missing turn. Bytes that
     * were held back count by the time in which the line could have sent them. A layer below that
     * delays them needs more: 250 for a computer. Then a scan that took more than one and a half
     * turns still has a gap. 0: pauses are not looked for, only that. */
    uint16_t max_pause_ms;
    /** A line silent for this long after a stop is quiet. 0: at once. */
    uint16_t quiet_line_ms;
    /** For a reply (section 9.11). 0: for ever. */
    uint16_t reply_timeout_ms;
    /** The pause between attempts to start doubles from 500 ms up to this. 0: no next attempt. */
    uint16_t back_off_max_ms;
    /** How often a query, a stop or a reboot is tried. 0: once. */
    uint8_t max_attempts;
} tmini_timing_t;

/** The values used when the configuration gives none; they fit the real device. */
extern const tmini_timing_t tmini_timing_default;

/** Whether the driver goes on trying when a start has failed or the lidar is lost. */
typedef enum {
    TMINI_RECOVERY_ON,  /**< By stop and start, and every so often a soft reboot. */
    TMINI_RECOVERY_OFF, /**< A start fails once; a loss is reported, and nothing is sent. */
} tmini_recovery_mode_t;

/** A step that changes a finished scan in place before it is delivered: tmini_mount_step(), or a
 * function of yours. Called from tmini_poll() with the configuration's `step_data`. Points keep
 * their order and number. */
typedef void (*tmini_step_t)(const void *data, tmini_scan_t *scan);

/** What tmini_init() needs to know. Members that are not named may be 0; C++ wants the others in
 * this order. */
typedef struct {
    const tmini_port_t *port; /**< Required. */
    void *port_context;       /**< Passed to its functions. */
    uint8_t *rx_buffer;       /**< Received bytes. Required. */
    size_t rx_size;           /**< A power of two; 256 or more (512 with DMA) for 80 samples, up to
                       * TMINI_RING_SIZE_MAX. */
    bool rx_dma;           /**< The buffer is the target of circular DMA: use tmini_feed_dma(). */
    tmini_point_t *points; /**< One scan. NULL: an event for each packet instead. */
    tmini_point_t *spare_points; /**< A second buffer of max_points: then a scan stays valid until
                                    * the next TMINI_EVENT_SCAN. NULL: until the next poll. */
    size_t max_points;           /**< 1 to 65535, or 0 with no points. */
    uint8_t max_samples;         /**< Packets with more are not valid; 0: the default, 80. */
    uint8_t filter;              /**< Of scans: a combination of tmini_filter_t; 0: keep all. */
    uint16_t frequency_chz; /**< The scan frequency that is wanted, as for tmini_set_frequency(); 0:
                               * whatever the lidar has. */
    bool listen_only;       /**< Nothing is ever sent: for a lidar that something else controls, or
                               * whose RX wire is off. Without a frequency. */
    tmini_recovery_mode_t recovery; /**< 0: on. */
    tmini_step_t step;              /**< Applied to each scan, NULL: none. Needs points. */
    const void *step_data;          /**< Passed to it; must outlive the lidar. */
    const tmini_timing_t *timing;   /**< NULL: tmini_timing_default. It must outlive the lidar. */
} tmini_config_t;

/* ----------------------------------------------------------------------------- events, states */

/** When several are due, they are returned in this order. */
typedef enum {
    TMINI_EVENT_NONE,           /**< Nothing is left to do. */
    TMINI_EVENT_STARTED,        /**< Scanning: the first packet has come. */
    TMINI_EVENT_STOPPED,        /**< Idle, and the line is quiet. */
    TMINI_EVENT_INFO,           /**< tmini_info() has been read. */
    TMINI_EVENT_HEALTH,         /**< tmini_health() has been read. */
    TMINI_EVENT_FREQUENCY,      /**< tmini_frequency_chz() has been read, or set and read back. */
    TMINI_EVENT_REBOOTED,       /**< The soft reboot's time is over. */
    TMINI_EVENT_COMMAND_FAILED, /**< tmini_command_error() says why. In TMINI_STATE_STARTING an
                                   * attempt to start has failed, and the next follows; in
                                   * TMINI_STATE_SCANNING the wanted frequency could not be set. */
    TMINI_EVENT_UNWANTED_SCANNING, /**< A lidar that was stopped scans all the same; it is being
                                      * stopped again, which ends like tmini_stop(). */
    TMINI_EVENT_LOST, /**< No valid packets, or no start packets, any more; being recovered unless
                         * configured not to. */
    TMINI_EVENT_RECOVERED,      /**< Valid packets again. */
    TMINI_EVENT_FAULTS_CHANGED, /**< tmini_faults() has changed, to 0 as well. */
    TMINI_EVENT_PACKET, /**< Without points: tmini_packet() is valid until the next tmini_poll(). */
    TMINI_EVENT_SCAN,   /**< tmini_scan() is valid until the next tmini_poll(), or, with
                           * spare_points, until the next TMINI_EVENT_SCAN. */
    TMINI_EVENT_MORE,   /**< Nothing yet, but bytes wait: a poll's work is bounded. Poll again. */
} tmini_event_t;

/** What the lidar does, as far as the driver knows (docs/design.md has a diagram). In the last
 * three it is wanted to scan. */
typedef enum {
    TMINI_STATE_UNKNOWN,    /**< The lidar may be scanning: after init, reboot or a failure. */
    TMINI_STATE_IDLE,       /**< Not scanning, and the line is quiet. */
    TMINI_STATE_BUSY,       /**< Carrying out a query, a frequency change or a reboot. */
    TMINI_STATE_STOPPING,   /**< Waiting for the line to fall quiet after a stop. */
    TMINI_STATE_STARTING,   /**< Until the first packet, however many attempts it takes. */
    TMINI_STATE_SCANNING,   /**< Packets come. */
    TMINI_STATE_RECOVERING, /**< Lost while scanning; brought back, or waited for. */
} tmini_state_t;

/** Running totals, modulo the range of their type. Whatever arrives, every byte received is in
 * exactly one of the five that begin with `bytes`. */
typedef struct {
    uint32_t packets;          /**< Valid packets. */
    uint32_t checksum_errors;  /**< Complete, plausible candidates whose checksum did not match. */
    uint32_t bytes_in_packets; /**< Of valid packets. */
    uint32_t bytes_in_replies; /**< Of replies that were awaited. */
    uint32_t bytes_skipped;    /**< In no packet or reply; LastCRC bytes are among them. */
    uint32_t bytes_overrun; /**< Refused by a full ring, or overwritten by DMA before being read. */
    uint32_t bytes_pending; /**< Received and waiting for more. */
    uint32_t scans;         /**< Delivered as TMINI_EVENT_SCAN, */
    uint32_t late_scans; /**< and those ended, or made incomplete, by time alone: no byte was lost.
                               * A layer below may hold bytes back for more than max_pause_ms. */
    uint16_t timeouts;   /**< Attempts at commands that ended without the reply, the quiet line
                               * or the first packet that they waited for. */
    uint16_t losses;     /**< TMINI_EVENT_LOST. */
    uint16_t recoveries; /**< TMINI_EVENT_RECOVERED. */
    uint16_t restarts;   /**< Attempts to recover by a start. */
    uint16_t reboots;    /**< Attempts to start or recover by a soft reboot. */
} tmini_counters_t;

/** One lidar: allocated by the caller, set up by tmini_init(). Its members are private. */
typedef struct tmini tmini_t;

/* ---------------------------------------------------------------------------------- life cycle */

/** Sets up a lidar; sends nothing, waits for nothing. From the polling context. Nothing may be fed
 * meanwhile; what is fed to an all-zero tmini_t before is refused. Port, timing, step data and
 * buffers stay the caller's and must outlive the lidar; the configuration itself may go.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: a required member missing or out of range, or members
 * that do not go together; the lidar then refuses commands and reports TMINI_EVENT_COMMAND_FAILED
 * once. Check it: most compilers warn if you do not. */
TMINI_MUST_CHECK
tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config);

/* -------------------------------------------------------- receiving: interrupt or task context */

/** Stores one received byte: the call for a UART's receive interrupt. No loop, no wait, a handful
 * of instructions. Once the buffer is full, bytes are refused and counted (bytes_overrun) until
 * polling has emptied it. From the receiving context only, as the next five. */
TMINI_INLINE void tmini_feed_byte(tmini_t *lidar, uint8_t byte);

/** Stores a block of received bytes and returns how many it stored: those that do not fit are
 * refused and counted. Bytes must not be held back for longer than frame_timeout_ms, or their
 * packet is given up. What a layer below has held back is best handed over at once, before the next
 * poll; for what has to wait for room call tmini_feed_held(). No wait; two block copies. */
static inline size_t tmini_feed(tmini_t *lidar, const uint8_t *bytes, size_t count);

/** How many bytes tmini_feed() would store now, at least: for a receiver with a queue of its
 * own. */
static inline size_t tmini_feed_room(const tmini_t *lidar);

/** Reports that `held` more bytes have arrived and wait in the port, or below it, and that none was
 * lost: for a receiver with a queue, each time it has fed bytes, also when none are left (0). Then
 * a pause of the program that the queue bridges costs no scan. Without this call it may cost some,
 * or hide that the line was silent. No loop, no wait. Not with DMA. */
static inline void tmini_feed_held(tmini_t *lidar, size_t held);

/** Publishes how far circular DMA has written rx_buffer: `position` is the index it writes next
 * (rx_size less the channel's remaining count), and never goes back. Call it from the
 * half-transfer, transfer-complete and idle-line interrupts; all three are needed (tmini_ring.h
 * says why), and bytes must not be held back for longer than frame_timeout_ms. No loop, no wait.
 * Overwritten bytes are noticed when polling, counted (bytes_overrun), and never become points. */
static inline void tmini_feed_dma(tmini_t *lidar, size_t position);

/** Reports that an unknown number of bytes was lost after those fed so far: a receiver's queue
 * overflowed, or DMA may have gone a whole lap unseen (then call it before tmini_feed_dma()).
 * No scan continues across the gap. Without DMA nothing is stored until polling has emptied the
 * buffer: look at tmini_feed_room(). With DMA a lap of the oldest bytes (rx_size) is dropped and
 * counted as overrun, and what is then left beyond half a lap: so nothing is delivered twice, even
 * if there was no lap. */
static inline void tmini_feed_gap(tmini_t *lidar);

/** The receive buffer, for a port that hands it to circular DMA; its size goes to `size`. NULL, and
 * 0, unless the lidar has been set up with rx_dma. Any context, after tmini_init(). */
static inline uint8_t *tmini_rx_buffer(const tmini_t *lidar, size_t *size);

/** For a port that starts circular DMA anew: how far it was published, in bytes since tmini_init(),
 * a gap counting as a lap, modulo the range of size_t. Modulo rx_size it is the index in the
 * receive buffer where the next byte goes. 0: nothing has been published. Only for a lidar set up
 * with rx_dma, or not set up: 0. Any context; no loop, no wait. */
static inline size_t tmini_feed_position(const tmini_t *lidar);

/* -------------------------------------------------------- everything else: the polling context */

/** Parses what has been received, keeps time, sends what is due; returns the next event or
 * TMINI_EVENT_NONE when there is nothing left to do. Call it until then. From the polling context,
 * never from within itself. It never waits, and its work is bounded: it looks at no more than
 * TMINI_PARSER_EFFORT bytes and one packet (docs/footprint.md says what that costs at worst), and
 * sends at most two bytes. With more to look at and no event it returns TMINI_EVENT_MORE: call it
 * again when other work allows. */
tmini_event_t tmini_poll(tmini_t *lidar);

/** @name Wishes
 * They stand until they are changed; what they need is done by tmini_poll(). From the polling
 * context; none waits, and each sends two bytes at most. */
/** @{ */

/** The lidar is to scan, until tmini_stop(): at once, or when the command under way has ended; also
 * one that is powered later, restarts or is plugged in again. TMINI_EVENT_STARTED with the first
 * packet; after that each revolution is TMINI_EVENT_SCAN (section 2). Each attempt that fails is
 * one TMINI_EVENT_COMMAND_FAILED, and the next follows after a pause. With TMINI_RECOVERY_OFF the
 * first one ends the wish. Nothing happens if it scans, or starts, already.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a lidar that was not set up. */
tmini_status_t tmini_start(tmini_t *lidar);

/** The lidar is to stop, whatever is under way [TMINI_EVENT_STOPPED]. In any state; an unfinished
 * command or start ends with TMINI_EVENT_COMMAND_FAILED, TMINI_ERROR_ABORTED. A lidar that scans
 * later all the same is stopped again, TMINI_EVENT_UNWANTED_SCANNING (section 9.10). If it cannot
 * be stopped, TMINI_EVENT_COMMAND_FAILED comes once per round of attempts.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a lidar that was not set up. */
tmini_status_t tmini_stop(tmini_t *lidar);

/** The lidar is to turn at this frequency, in 0.01 Hz: 600 to 1200, a multiple of 10. It is set
 * before every start from now on, also after a loss or a reboot, and read back
 * [TMINI_EVENT_FREQUENCY]; within 0.05 Hz is there. Idle, it is set now. While the lidar scans, or
 * is to scan, a changed wish stops it, sets it and starts again [TMINI_EVENT_STARTED, or
 * TMINI_EVENT_RECOVERED while it is being recovered]. During a query it is kept for the next start
 * or query of the frequency. Scanning comes first: if the frequency cannot be set, the lidar scans
 * as it is, and TMINI_EVENT_COMMAND_FAILED comes with TMINI_EVENT_STARTED. One that turns otherwise
 * than wanted for three seconds has TMINI_FAULT_FREQUENCY, and the wish is brought about once more.
 * Returns TMINI_OK; TMINI_ERROR_ARGUMENT: null pointer, not set up, or another frequency;
 * TMINI_ERROR_LISTEN_ONLY. The wish is then unchanged. */
tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz);

/** @} */

/** @name Queries
 * Each call starts a command; the bracketed event, or TMINI_EVENT_COMMAND_FAILED, reports its end.
 * From an unknown state each first stops the lidar and waits for a quiet line (section 9.10). All
 * return
 *
 *     TMINI_OK                 begun
 *     TMINI_ERROR_ARGUMENT     null pointer, or a lidar that was not set up
 *     TMINI_ERROR_STATE        the lidar is scanning or being recovered: only stop may be sent
 *     TMINI_ERROR_BUSY         another command is under way
 *     TMINI_ERROR_LISTEN_ONLY  nothing is sent
 *
 * and touch nothing unless they return TMINI_OK. If the event that ended the command before has not
 * been polled yet, it is dropped. From the polling context. None waits, and each sends two bytes at
 * most; the rest of a command is done by tmini_poll(). If the port refuses, it is asked once more
 * when time has passed; a command may be begun anew whenever it has failed, even in a loop that
 * polls until TMINI_EVENT_NONE. */
/** @{ */

/** Asks for the device information [INFO]: tmini_info() (section 4). */
tmini_status_t tmini_request_info(tmini_t *lidar);

/** Asks for the health status [HEALTH]: tmini_health() (section 4). */
tmini_status_t tmini_request_health(tmini_t *lidar);

/** Asks for the scan frequency that is set [FREQUENCY]: tmini_frequency_chz() (section 4). One that
 * is not the wanted one is set. */
tmini_status_t tmini_request_frequency(tmini_t *lidar);

/** Reboots the lidar [REBOOTED], which takes five seconds (section 9.11). */
tmini_status_t tmini_reboot(tmini_t *lidar);

/** @} */

/** @name Results
 * Of a lidar that has been set up; from the polling context, without waiting. What is pointed to
 * belongs to the lidar and is never NULL. */
/** @{ */

/** What the lidar does. */
static inline tmini_state_t tmini_state(const tmini_t *lidar);

/** The scan that TMINI_EVENT_SCAN announced, valid as it says there (section 6). */
static inline const tmini_scan_t *tmini_scan(const tmini_t *lidar);

/** Without points: the packet that TMINI_EVENT_PACKET announced, valid until the next tmini_poll()
 * (section 5). */
static inline const tmini_packet_t *tmini_packet(const tmini_t *lidar);

/** The device information that TMINI_EVENT_INFO announced, valid until the next; all 0 before
 * (section 4). */
static inline const tmini_info_t *tmini_info(const tmini_t *lidar);

/** The health status that TMINI_EVENT_HEALTH announced, valid until the next; all 0 before (section
 * 4). */
static inline const tmini_health_t *tmini_health(const tmini_t *lidar);

/** The scan frequency that is set, in 0.01 Hz, as the lidar has reported it last; 0: not known,
 * also after a loss or a reboot. What is measured is in each scan. */
static inline uint16_t tmini_frequency_chz(const tmini_t *lidar);

/** Why the last failed command failed: TMINI_ERROR_TIMEOUT, _WRITE, _REPLY or _ABORTED; _ARGUMENT
 * if tmini_init() did. TMINI_OK if none has. */
static inline tmini_status_t tmini_command_error(const tmini_t *lidar);

/** What is wrong with the lidar while scanning, a combination of tmini_fault_t; 0: nothing known.
 * From CT information when the unit sends it, seen in two revolutions. A unit that sends none has
 * TMINI_FAULT_DATA when two whole revolutions bring no valid range. Either has TMINI_FAULT_ENCODER
 * when 12,000 samples, three seconds, come without a start packet (section 8);
 * TMINI_FAULT_FREQUENCY when it has turned otherwise than wanted, by more than 5 %, for three
 * seconds. */
static inline uint8_t tmini_faults(const tmini_t *lidar);

/** Copies CT information to `info`: version, health and serial number as sent while scanning, each
 * if known (section 7). */
static inline void tmini_ct_info(const tmini_t *lidar, tmini_ct_info_t *info);

/** Copies the counters to `counters`; they run from tmini_init(). */
void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters);

/** @} */

/** @cond private */

/* ------------------------------------------------------------------------------------- private */

/* What a lidar consists of, grouped by the file of lib/src that writes it. The small members come
 * first: Thumb code reaches bytes at 0 to 31 with short instructions, halves at 0 to 62. */

/* tmini_command.c */
typedef struct {
    uint8_t operation; /* Under way, or the last one: the event with which it ends well; 0: none. */
    uint8_t phase;     /* What goes on on the wire. */
    uint8_t code;      /* The command on its way, */
    uint8_t unsent;    /* and how many of its two bytes the port has not taken yet. */
    bool sync_sent;    /* The lidar has got the first byte of a command, and no second. */
    uint8_t attempts;  /* The number of this one, from 1, */
    uint8_t attempts_max;
    uint8_t steps;       /* Frequency steps sent. */
    uint16_t timeout_ms; /* How long the phase may last; 0: without limit. */
    uint16_t frequency_chz;
    uint16_t timeouts;
    uint32_t since_ms; /* When the phase began. */
} tmini_command_t;

/* tmini_recovery.c */
typedef struct {
    uint8_t attempts;  /* Failed ones, since the last complete revolution or a reboot; 0: none has
                          been made. */
    uint8_t doublings; /* Of the pause after a failed attempt. */
    uint16_t losses;
    uint16_t recoveries;
    uint16_t restarts;
    uint16_t reboots;
} tmini_recovery_t;

/* tmini_monitor.c */
typedef struct {
    uint8_t faults;    /* As reported. */
    uint8_t observed;  /* As seen in the last revolution; reported when seen twice. */
    bool is_complete;  /* Nothing has been lost since the last start packet. */
    uint8_t ranges;    /* Packets with a valid range since then; at most 255. */
    uint8_t off_turns; /* In a row, that took another time than wanted. */
    uint16_t samples;  /* Since the last start packet. */
} tmini_monitor_t;

/* tmini_line.c */
typedef struct {
    bool doubt;         /* Whether some bytes may be missing up to `doubtful_to`. */
    uint16_t late_ms;   /* How much earlier the latest bytes may have come, if not in doubt. */
    uint16_t silent_ms; /* Observed silence; at most 65535. */
    uint32_t now_ms;    /* When the line was last looked at. */
    uint32_t heard_ms;  /* When bytes came. */
    size_t received;    /* The place in the stream up to which bytes had come, */
    size_t arrived;     /* and up to which they had at least come into the port, at `heard_ms`. */
    size_t doubtful_to;
} tmini_line_t;

/* tmini.c: what the configuration says. */
typedef struct {
    const tmini_port_t *port;
    void *port_context;
    const tmini_timing_t *timing;
    tmini_step_t step;
    const void *step_data;
    tmini_point_t *spare_points; /* Not in use; NULL: there are none. */
} tmini_link_t;

struct tmini {
    uint8_t state; /* A tmini_state_t. */
    int8_t command_error;
    uint16_t pending;   /* A bit for each event not yet returned. */
    bool start_follows; /* The command under way is followed by a start. */
    bool is_settled;    /* Nothing to do until a frame may be complete or `wake_ms` has come. */
    bool is_recovery_off;
    bool is_listen_only;
    tmini_recovery_t recovery;
    uint16_t wanted_chz; /* 0: any. */
    tmini_command_t command;
    tmini_monitor_t monitor;
    uint32_t wake_ms;
    uint32_t scans;
    tmini_link_t link;
    tmini_line_t line;
    size_t held_to; /* The receiving context's: up to where bytes wait in the port; 0: unknown. */
    tmini_ring_t ring;
    tmini_decoder_t decoder;
    tmini_scan_t scan; /* The one delivered last. */
    tmini_info_t info;
    tmini_health_t health;
};

/** @endcond */

TMINI_INLINE void tmini_feed_byte(tmini_t *lidar, uint8_t byte)
{
    tmini_ring_put(&lidar->ring, byte);
}

static inline size_t tmini_feed(tmini_t *lidar, const uint8_t *bytes, size_t count)
{
    return tmini_ring_write(&lidar->ring, bytes, count);
}

static inline size_t tmini_feed_room(const tmini_t *lidar)
{
    return tmini_ring_room(&lidar->ring);
}

static inline void tmini_feed_held(tmini_t *lidar, size_t held)
{
    tmini_store(&lidar->held_to, lidar->ring.head + held);
}

static inline void tmini_feed_dma(tmini_t *lidar, size_t position)
{
    tmini_ring_publish(&lidar->ring, position);
}

static inline void tmini_feed_gap(tmini_t *lidar)
{
    tmini_ring_gap(&lidar->ring);
}

static inline uint8_t *tmini_rx_buffer(const tmini_t *lidar, size_t *size)
{
    const bool is_target = lidar->link.port != NULL && tmini_ring_is_dma(&lidar->ring);
    *size = is_target ? lidar->ring.size : 0;
    return is_target ? lidar->ring.memory : NULL;
}

static inline size_t tmini_feed_position(const tmini_t *lidar)
{
    return tmini_ring_head(&lidar->ring);
}

static inline tmini_state_t tmini_state(const tmini_t *lidar)
{
    return lidar != NULL ? (tmini_state_t)lidar->state : TMINI_STATE_UNKNOWN;
}

static inline const tmini_scan_t *tmini_scan(const tmini_t *lidar)
{
    return &lidar->scan;
}

static inline const tmini_packet_t *tmini_packet(const tmini_t *lidar)
{
    return &lidar->decoder.packet;
}

static inline const tmini_info_t *tmini_info(const tmini_t *lidar)
{
    return &lidar->info;
}

static inline const tmini_health_t *tmini_health(const tmini_t *lidar)
{
    return &lidar->health;
}

static inline uint16_t tmini_frequency_chz(const tmini_t *lidar)
{
    return lidar->command.frequency_chz;
}

static inline tmini_status_t tmini_command_error(const tmini_t *lidar)
{
    return (tmini_status_t)lidar->command_error;
}

static inline uint8_t tmini_faults(const tmini_t *lidar)
{
    return lidar->monitor.faults;
}

static inline void tmini_ct_info(const tmini_t *lidar, tmini_ct_info_t *info)
{
    tmini_ct_read(&lidar->decoder.ct, info);
}

#ifdef __cplusplus
}
#endif

#endif
