/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * tmini: a driver for the YDLIDAR T-mini Plus, a spinning 2D lidar.
 *
 * You state what you want. The driver brings the lidar to that state and keeps it there: at the
 * start, and after a lost connection, a reboot or a power failure. The receive interrupt only
 * stores bytes (tmini_feed_byte(), or tmini_feed() for blocks, or tmini_feed_dma() for circular
 * DMA). Everything else happens in tmini_poll(), which returns one event per call and never waits:
 *
 *     static const tmini_config_t config = {
 *         .port = &board_port, .rx_buffer = rx, .rx_size = sizeof rx,
 *         .points = points, .max_points = 800, .frequency_chz = 1000,
 *     };
 *
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_start(&lidar);                   holds until tmini_stop()
 *     for (;;) {                             300 ms: three turns
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: avoid_obstacles(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_FAULTS_CHANGED: signal_faults(tmini_faults(&lidar)); break;
 *         default: break;
 *         }
 *         if (tmini_scan_age_ms(&lidar) > 300 || tmini_faults(&lidar) != 0) { stop_robot(); }
 *     }
 *
 * Contexts. The functions tmini_feed…() belong to the one context that receives: an interrupt, a
 * DMA interrupt or a task. All other functions belong to one other context, the polling context,
 * which may be the same one.
 * Nothing is locked and no interrupt is disabled (but see tmini_atomic.h for 8-bit machines). A
 * program may have any number of lidars, each with its own tmini_t.
 *
 * Time. No function waits. tmini_poll() must be called often enough that the receive buffer does
 * not overflow: at least every 38 ms with 1024 bytes, or every 16 ms with DMA, which can use only
 * half of the buffer (docs/footprint.md, "How often to poll", lists other sizes). Call it until it
 * returns TMINI_EVENT_NONE: while events other than TMINI_EVENT_MORE are due, it does not look for
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
/* The types of a lidar's members. */
#include "parts/tmini_decoder.h"
#include "parts/tmini_reply.h"
#include "parts/tmini_ring.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The first number of the library's version. Versioning is semantic (CHANGELOG.md). */
#define TMINI_VERSION_MAJOR 1
/** The second number. */
#define TMINI_VERSION_MINOR 0
/** The third number. */
#define TMINI_VERSION_PATCH 0
/** The whole version as text, including a suffix such as "-rc.1". */
#define TMINI_VERSION_TEXT "1.0.0-rc.2"

/** The lowest scan frequency that may be set, in 0.01 Hz (section 1). */
#define TMINI_FREQUENCY_MIN_CHZ 600u
/** The highest scan frequency that may be set, in 0.01 Hz (section 1). */
#define TMINI_FREQUENCY_MAX_CHZ 1200u
/** Scan frequencies that may be set are multiples of this, in 0.01 Hz (section 3). */
#define TMINI_FREQUENCY_STEP_CHZ 10u

/* ------------------------------------------------------------------------------ configuration */

/** The driver's waiting times, in milliseconds. To change one, copy tmini_timing_default first. */
typedef struct {
    /** An incomplete packet is given up after this much silence. Raise it where a layer below
     * delays bytes: 250 for a computer. 0: at the first poll that finds no new byte although the
     * clock has advanced. */
    uint16_t frame_timeout_ms;
    /** A pause of the line ends a scan if it is longer than this and longer than half a turn (42 ms
     * at 12 Hz): a whole turn may be missing, and the angles would not show it. If bytes were held
     * back before they were fed, the time that they need on the line is subtracted. Raise the value
     * where a layer below delays bytes: 250 for a computer. 0: pauses are not looked for. Whatever
     * the value, a scan that took more than one and a half turns has a gap. */
    uint16_t max_pause_ms;
    /** After a stop, and between two commands, the line counts as quiet when it has been silent for
     * this long: below 600. If the value is above 50 and polls are more than 50 ms apart, it may be
     * at most 30000 / (time between polls). Bytes that a layer below holds for longer seem to come
     * after the next start. 0: at once. */
    uint16_t quiet_line_ms;
    /** How long to wait for a reply (section 9.11). 0: without limit. The question that begins a
     * start is repeated each 250 ms instead, for 7.5 s. */
    uint16_t reply_timeout_ms;
    /** The pause after a failed attempt to start begins with 500 ms and doubles up to this value.
     * 0: after a failed attempt there is no other until you call tmini_stop() and tmini_start(). */
    uint16_t back_off_max_ms;
    /** How often a question, a stop or a reboot is tried; with TMINI_RECOVERY_OFF also the start.
     * 0: once. */
    uint8_t max_attempts;
} tmini_timing_t;

/** The values used when the configuration gives none; they fit the real device. */
extern const tmini_timing_t tmini_timing_default;

/** Whether the driver keeps trying after a failed start, or when the lidar is lost. */
typedef enum {
    TMINI_RECOVERY_ON,  /**< It does, by stop and start. A lidar that answers and does not scan is
                         * rebooted before the fourth attempt and each later one. */
    TMINI_RECOVERY_OFF, /**< It does not: a failed start ends the wish; a loss is reported, and
                         * nothing is sent until the next start. */
} tmini_recovery_mode_t;

/** A step that changes a finished scan in place before it is delivered: tmini_mount_step(), or a
 * function of yours. Called from tmini_poll() with the configuration's `step_data`. It must keep
 * the order and number of the points, and must not call the wishes and queries below: do that when
 * the event has come. */
typedef void (*tmini_step_t)(const void *data, tmini_scan_t *scan);

/** What tmini_init() needs to know. Members that you leave out are 0. Required are port, rx_buffer
 * and rx_size, and max_points if there are points. C++ demands this order. */
typedef struct {
    const tmini_port_t *port; /**< Required. */
    void *port_context;       /**< Passed to the port's functions. */
    uint8_t *rx_buffer;       /**< Memory for received bytes. Required. */
    size_t rx_size;           /**< Its size. Required: a power of two, at least 256 (512 with DMA)
                               * for packets of 80 samples, at most TMINI_RING_SIZE_MAX. */
    bool rx_dma;           /**< The buffer is the target of circular DMA: use tmini_feed_dma(). */
    tmini_point_t *points; /**< Memory for one scan. NULL: no scans, but an event for each
                            * packet. */
    tmini_point_t *spare_points; /**< A second buffer of max_points. With it, a scan stays valid
                                  * until the next TMINI_EVENT_SCAN; with NULL, until the next
                                  * poll. */
    size_t max_points;           /**< Points in each buffer: 1 to 65535; 0 if points is NULL. */
    uint8_t max_samples;         /**< Packets with more samples are not valid; the lidar sends
                                  * up to 40. 0: the default, 80. */
    uint8_t filter;              /**< For scans: a combination of tmini_filter_t; 0: keep all. */
    uint16_t frequency_chz; /**< The wanted scan frequency, as for tmini_set_frequency(); 0: leave
                             * it as the lidar has it. */
    bool listen_only;       /**< Nothing is ever sent: for a lidar that something else controls, or
                             * whose RX wire is not connected. frequency_chz must be 0. Call
                             * tmini_start() even so: before it, no scan comes. An attempt to start
                             * fails when no packet comes for three seconds; the next ones
                             * fail after the pauses of back_off_max_ms. */
    tmini_recovery_mode_t recovery; /**< 0: on. */
    tmini_step_t step;              /**< Called for each scan; NULL: none. Needs points. */
    const void *step_data;          /**< Passed to the step; must outlive the lidar. Needs a
                                     * step. */
    const tmini_timing_t *timing;   /**< NULL: tmini_timing_default. It must outlive the lidar. */
} tmini_config_t;

/* ----------------------------------------------------------------------------- events, states */

/** The events of tmini_poll(). When several are due, they are returned in this order. */
typedef enum {
    TMINI_EVENT_NONE,           /**< Nothing is left to do. */
    TMINI_EVENT_STARTED,        /**< Scanning: the first packet has come. */
    TMINI_EVENT_STOPPED,        /**< The lidar is idle, and the line is quiet. With listen_only:
                                 * you have called tmini_stop(), and the lidar may still scan. */
    TMINI_EVENT_INFO,           /**< tmini_info() has been read. */
    TMINI_EVENT_HEALTH,         /**< tmini_health() has been read. */
    TMINI_EVENT_FREQUENCY,      /**< tmini_frequency_chz() has been read, or set and read back. It
                                 * is 0 if a reboot of the driver's own has followed at once. */
    TMINI_EVENT_REBOOTED,       /**< After a soft reboot the lidar answers again. */
    TMINI_EVENT_COMMAND_FAILED, /**< A command has failed; tmini_command_error() gives the reason.
                                 * If the state is TMINI_STATE_STARTING, it was an attempt to start
                                 * or a question before the start, and an attempt follows. If it is
                                 * TMINI_STATE_SCANNING, the wanted frequency could not be set. */
    TMINI_EVENT_UNWANTED_SCANNING, /**< A lidar that was stopped is scanning. The driver stops it
                                    * again, with the same events as tmini_stop(). */
    TMINI_EVENT_RECOVERED,         /**< The lidar scans again: a start packet has come, or for three
                                    * seconds only packets without ranges (a blocked rotor). */
    TMINI_EVENT_FAULTS_CHANGED,    /**< tmini_faults() has changed, to 0 as well. */
    TMINI_EVENT_PACKET, /**< A packet, if there is no scan buffer: tmini_packet() is valid until the
                         * next tmini_poll(). */
    TMINI_EVENT_SCAN,   /**< A scan: tmini_scan() is valid until the next tmini_poll(); with
                         * spare_points, until the next TMINI_EVENT_SCAN. */
    TMINI_EVENT_PAUSED, /**< The driver is about to stop a scanning lidar, to set its frequency.
                         * TMINI_EVENT_STARTED, or _COMMAND_FAILED, follows. */
    TMINI_EVENT_LOST, /**< Valid packets, or start packets, have stopped coming. The driver recovers
                       * the lidar unless configured not to. */
    TMINI_EVENT_MORE, /**< No event yet, but bytes are left, because the work of a poll is
                         * bounded. Poll again. */
} tmini_event_t;

/** What the lidar does, as far as the driver knows (docs/design.md has a diagram). The last three
 * states mean that you want it to scan. */
typedef enum {
    TMINI_STATE_UNKNOWN,    /**< The lidar may be scanning: after init, a reboot or a failure, or
                             * when bytes have come from an idle lidar. */
    TMINI_STATE_IDLE,       /**< Not scanning, and the line is quiet. */
    TMINI_STATE_BUSY,       /**< Carrying out a question, a frequency change or a reboot. */
    TMINI_STATE_STOPPING,   /**< Waiting for the line to fall quiet after a stop. */
    TMINI_STATE_STARTING,   /**< To be started: until the first packet, with any number of attempts,
                             * and with what has to be done before. */
    TMINI_STATE_SCANNING,   /**< Packets come. */
    TMINI_STATE_RECOVERING, /**< Lost while scanning: the driver recovers it or, if configured not
                             * to, waits. */
} tmini_state_t;

/** Running totals; each wraps to 0 at the end of its type's range. Every received byte is counted
 * in exactly one of the five members that begin with `bytes`. */
typedef struct {
    uint32_t packets;          /**< Valid packets. */
    uint32_t checksum_errors;  /**< Complete, plausible candidates whose checksum did not match. */
    uint32_t bytes_in_packets; /**< Bytes of valid packets. */
    uint32_t bytes_in_replies; /**< Bytes of awaited replies. */
    uint32_t bytes_skipped;    /**< Bytes of neither; they include LastCRC bytes. */
    uint32_t bytes_overrun;   /**< Bytes refused by a full buffer, or overwritten by DMA before they
                             * were read. */
    uint32_t bytes_pending;   /**< Bytes received and not yet judged. */
    uint32_t scans;           /**< Scans delivered as TMINI_EVENT_SCAN. */
    uint32_t late_scans;      /**< Of these and of those withheld, the ones that ended early or are
                          * incomplete only because of time, although no byte was lost there. If it
                          * grows and bytes_overrun does not, a layer below may delay bytes for
                          * longer than max_pause_ms. It also grows after each tmini_feed_gap() with
                          * DMA, and while a clock that was set back catches up. */
    uint32_t points_withheld; /**< Intact points in no scan, because the program was behind: see
                               * tmini_poll(). */
    uint16_t timeouts;   /**< Attempts at commands that waited in vain for a reply, a quiet line or
                          * the first packet; with listen_only none is counted. */
    uint16_t losses;     /**< TMINI_EVENT_LOST. */
    uint16_t recoveries; /**< TMINI_EVENT_RECOVERED. */
    uint16_t restarts;   /**< Attempts to recover by a start. */
    uint16_t reboots;    /**< Attempts to start or recover by a soft reboot. */
} tmini_counters_t;

/** One lidar: allocated by the caller, set up by tmini_init(). Its members are private. */
typedef struct tmini_lidar tmini_t;

/* ---------------------------------------------------------------------------------- life cycle */

/** Sets up a lidar. Sends nothing and never waits. Call it from the polling context, while nothing
 * is fed. Bytes that are fed before, to a tmini_t that is all zero, are refused. Port, port
 * context, timing, step data and buffers stay the caller's and must outlive the lidar; the
 * configuration is copied.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: a required member is missing, a member is out of
 * range, or members contradict each other. The lidar then refuses commands and reports
 * TMINI_EVENT_COMMAND_FAILED once. Check the result: most compilers warn if you do not. */
TMINI_MUST_CHECK
tmini_status_t tmini_init(tmini_t *lidar, const tmini_config_t *config);

/* -------------------------------------------------------- receiving: interrupt or task context */

/** Stores one received byte: the call for a UART's receive interrupt. No loop, no wait, a handful
 * of instructions. Once the buffer is full, bytes are refused and counted (bytes_overrun) until
 * polling has emptied it. Call this function and the next five from the receiving context only. */
TMINI_INLINE void tmini_feed_byte(tmini_t *lidar, uint8_t byte);

/** Stores a block of received bytes and returns how many it stored; the others are refused and
 * counted (bytes_overrun). Do not hold bytes back for longer than frame_timeout_ms, or their packet
 * is given up. If a layer below has collected bytes, feed all of them before the next poll; report
 * those that have to wait for room with tmini_feed_held(). No wait; at most two block copies. */
static inline size_t tmini_feed(tmini_t *lidar, const uint8_t *bytes, size_t count);

/** How many bytes tmini_feed() would store now, at least. For a receiver that has its own queue. No
 * loop, no wait. */
static inline size_t tmini_feed_room(const tmini_t *lidar);

/** Reports that `held` more bytes have arrived, that they wait in the port or below it, and that
 * none was lost. A receiver with a queue calls this each time after it has fed bytes, with 0 when
 * none are left. Then a pause of the program during which the queue collects bytes costs no scan.
 * Without this call the pause may cost scans, or hide that the line was silent. No loop, no wait.
 * Not with DMA. */
static inline void tmini_feed_held(tmini_t *lidar, size_t held);

/** Publishes how far circular DMA has written rx_buffer: `position` is the index it writes next
 * (rx_size less the channel's remaining count), and never goes back. Call it from the
 * half-transfer, transfer-complete and idle-line interrupts; all three are needed (tmini_ring.h
 * gives the reason). Do not hold bytes back for longer than frame_timeout_ms. No loop, no wait.
 * tmini_poll() notices overwritten bytes and counts them (bytes_overrun); they never become
 * points. Without rx_dma this does nothing. */
static inline void tmini_feed_dma(tmini_t *lidar, size_t position);

/** Reports that an unknown number of bytes was lost after those fed so far: a receiver's queue
 * overflowed, or DMA may have written a whole lap unseen (then call this before tmini_feed_dma()).
 * No scan continues across the gap. No loop, no wait.
 * Without DMA nothing more is stored until polling has emptied the buffer; tmini_feed_room() is 0
 * until then. With DMA one lap of the oldest bytes (rx_size) is dropped and counted as overrun; if
 * more than half a lap is left then, so is the excess. So no byte is delivered twice, even if DMA
 * had not written a whole lap. */
static inline void tmini_feed_gap(tmini_t *lidar);

/** Returns the receive buffer, for a port that hands it to circular DMA, and writes its size to
 * `size`. NULL and 0 unless the lidar has been set up with rx_dma. The buffer stays the caller's.
 * Any context, after tmini_init(); no loop, no wait. */
static inline uint8_t *tmini_rx_buffer(const tmini_t *lidar, size_t *size);

/** For a port that starts circular DMA again: how many bytes have been published since
 * tmini_init(). A gap counts as one lap, and the number wraps with size_t. Modulo rx_size it is the
 * index in the receive buffer where the next byte goes. 0: nothing has been published, or the lidar
 * is not set up. Without rx_dma the value has no meaning. Any context; no loop, no wait. */
static inline size_t tmini_feed_position(const tmini_t *lidar);

/* -------------------------------------------------------- everything else: the polling context */

/** Parses received bytes, checks time-outs and sends what is due. Returns the next event, or
 * TMINI_EVENT_NONE when nothing is left to do: call it until then. From the polling context, never
 * from a function that tmini_poll() itself calls. It never waits, and its work is bounded: it looks
 * at no more than TMINI_PARSER_EFFORT bytes and one packet (docs/footprint.md gives the worst
 * time), and sends at most two bytes. If bytes are left and there is no event, it returns
 * TMINI_EVENT_MORE: call it again when other work allows. For a null pointer it returns
 * TMINI_EVENT_NONE.
 * After the first start packet every intact point is in exactly one scan, except those of a turn
 * that a loss, a stop or a pause cuts off; and with one exception more: while the program is behind
 * (bytes have waited for 150 ms), a scan of at most two packets that ends because packets may be
 * missing is not delivered, nor an incomplete one while the port holds bytes. Their points count as
 * points_withheld. So the program catches up. */
tmini_event_t tmini_poll(tmini_t *lidar);

/** For how long tmini_poll() may be left out if no byte comes meanwhile, in milliseconds: for a
 * task that sleeps and is woken by its receiver. 0: poll now; also for a lidar that was not set up.
 * At most 65535, when nothing is due. Call it when tmini_poll() has returned TMINI_EVENT_NONE. No
 * waiting. */
uint32_t tmini_next_poll_ms(const tmini_t *lidar);

/** @name Wishes
 * A wish holds until you change it; tmini_poll() does the work. From the polling context. None of
 * these functions waits, and each sends at most two bytes. */
/** @{ */

/** The lidar is to scan until tmini_stop(). First the questions that wait are answered; then the
 * driver asks for the frequency until the lidar answers, sets the wanted one, and starts. So a
 * lidar that gets its power together with the controller is started once, as soon as it listens. It
 * is started again after it has lost its power or its cable.
 * TMINI_EVENT_STARTED comes with the first packet; after that TMINI_EVENT_SCAN comes for each
 * revolution (section 2). Each failed attempt is reported by one TMINI_EVENT_COMMAND_FAILED, and
 * the next attempt follows after a pause. A lidar that has never answered is started after 7.5 s
 * even so. With TMINI_RECOVERY_OFF the first failure ends the wish. If the lidar scans or starts
 * already, the call changes nothing.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a lidar that was not set up. */
tmini_status_t tmini_start(tmini_t *lidar);

/** The lidar is to stop, in any state [TMINI_EVENT_STOPPED]. An unfinished start or question, and
 * the questions that wait, end with one TMINI_EVENT_COMMAND_FAILED and TMINI_ERROR_ABORTED. If the
 * lidar scans later although it was stopped, it is stopped again: TMINI_EVENT_UNWANTED_SCANNING
 * (section 9.10). If it cannot be stopped, TMINI_EVENT_COMMAND_FAILED comes once per round of
 * attempts, at most twice per second.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a lidar that was not set up. */
tmini_status_t tmini_stop(tmini_t *lidar);

/** The lidar is to turn at this frequency, in 0.01 Hz: 600 to 1200, rounded to the nearest multiple
 * of 10. From now on the driver sets it before every start, also after a loss or a reboot, and
 * reads it back [TMINI_EVENT_FREQUENCY]; a value within 0.05 Hz of the wish is accepted.
 * A lidar that is not to scan is set as soon as it has carried out what is in progress. A lidar
 * that scans goes on until the wish has not changed for four start packets, so that the call may
 * follow a slider; then it is stopped, set and started again [TMINI_EVENT_PAUSED, then
 * TMINI_EVENT_STARTED]. This takes about 0.05 s per step of 1 or 0.1 Hz, and is cut short after 64
 * steps if the wish changes meanwhile.
 * Scanning matters more than the frequency: if it cannot be set, the lidar scans at the old one,
 * and TMINI_EVENT_COMMAND_FAILED comes with TMINI_EVENT_STARTED or TMINI_EVENT_RECOVERED. A lidar
 * that turns at another frequency for three seconds gets TMINI_FAULT_FREQUENCY, and the driver sets
 * the frequency again, as above. As long as it is not known to be set, this is repeated at growing
 * intervals. With TMINI_RECOVERY_OFF the fault is only reported. While the lidar is to scan, to
 * state the same wish again changes nothing.
 * Returns TMINI_OK; TMINI_ERROR_ARGUMENT: null pointer, a lidar that was not set up, or a frequency
 * out of range; TMINI_ERROR_LISTEN_ONLY: the configuration says that nothing is sent. After an
 * error the wish is unchanged. */
tmini_status_t tmini_set_frequency(tmini_t *lidar, uint16_t frequency_chz);

/** @} */

/** @name Questions
 * Each is answered once; the bracketed event, or TMINI_EVENT_COMMAND_FAILED, reports its end.
 * Several wait for each other, in the order below. In TMINI_STATE_UNKNOWN the driver first stops
 * the lidar and waits for a quiet line (section 9.10). All return
 *
 *     TMINI_OK                 begun, or waiting for what is in progress
 *     TMINI_ERROR_ARGUMENT     null pointer, or a lidar that was not set up
 *     TMINI_ERROR_STATE        the lidar scans, or is to: only stop may be sent. Ask before
 *                              tmini_start(), or after tmini_stop()
 *     TMINI_ERROR_LISTEN_ONLY  nothing is sent
 *
 * and change nothing unless they return TMINI_OK. If the event of the same question has not been
 * polled yet, it is dropped. From the polling context. None waits, and each sends at most two
 * bytes; tmini_poll() does the rest. If the port reports a failure, it is asked again at the first
 * poll at which the clock has advanced. So a program may repeat a failed question even in a loop
 * that polls until TMINI_EVENT_NONE. */
/** @{ */

/** Asks for the device information [INFO]: tmini_info() (section 4). */
tmini_status_t tmini_request_info(tmini_t *lidar);

/** Asks for the health status [HEALTH]: tmini_health() (section 4). */
tmini_status_t tmini_request_health(tmini_t *lidar);

/** Asks for the scan frequency that is set [FREQUENCY]: tmini_frequency_chz() (section 4). If a
 * frequency is wanted and the lidar has another, the wanted one is set. */
tmini_status_t tmini_request_frequency(tmini_t *lidar);

/** Reboots the lidar [REBOOTED, when it answers again, which takes some seconds] (section 9.11). */
tmini_status_t tmini_reboot(tmini_t *lidar);

/** @} */

/** @name Results
 * For a lidar that has been set up; from the polling context; no waiting. A returned pointer is
 * never NULL, and what it points to belongs to the lidar. */
/** @{ */

/** What the lidar does; TMINI_STATE_UNKNOWN for a null pointer. */
tmini_state_t tmini_state(const tmini_t *lidar);

/** The scan that TMINI_EVENT_SCAN announced (section 6). The event's description states how long it
 * is valid. */
static inline const tmini_scan_t *tmini_scan(const tmini_t *lidar);

/** The packet that TMINI_EVENT_PACKET announced, valid until the next tmini_poll() (section 5). */
static inline const tmini_packet_t *tmini_packet(const tmini_t *lidar);

/** True if the packet's bytes are still as they came. With DMA, ask after you have read the packet:
 * the hardware may have overwritten it meanwhile, and then nothing read from it may be used.
 * Without DMA it is always true. */
static inline bool tmini_packet_intact(const tmini_packet_t *packet);

/** The age of the newest complete scan, counted from its end, in milliseconds. At most 2147483647
 * (24 days): before the first complete scan, and for a lidar that was not set up. It grows whatever
 * the reason is: the lidar boots, is lost, sends damaged packets, or is being set to another
 * frequency. So a robot that stops when the age is above three turns (300 ms at 10 Hz) never drives
 * blind; a scan that is not complete may stop it, never release it. If the clock is set back by up
 * to a second, the age stands still until the clock has caught up; if by more, the age is at its
 * maximum until the next complete scan. Without `points` no scan comes. */
uint32_t tmini_scan_age_ms(const tmini_t *lidar);

/** The device information that TMINI_EVENT_INFO announced, valid until the next such event; all 0
 * before the first (section 4). */
static inline const tmini_info_t *tmini_info(const tmini_t *lidar);

/** The health status that TMINI_EVENT_HEALTH announced, valid until the next such event; all 0
 * before the first (section 4). */
static inline const tmini_health_t *tmini_health(const tmini_t *lidar);

/** The scan frequency that is set, in 0.01 Hz, as the lidar reported it last. 0: unknown, also
 * after a loss or a reboot. The measured frequency is in each scan. */
static inline uint16_t tmini_frequency_chz(const tmini_t *lidar);

/** The error of the command that failed last: TMINI_ERROR_TIMEOUT, _WRITE, _REPLY or _ABORTED;
 * _ARGUMENT if tmini_init() failed; TMINI_OK if nothing has failed. */
static inline tmini_status_t tmini_command_error(const tmini_t *lidar);

/** The lidar's faults while scanning, a combination of tmini_fault_t; 0: none is known. If the unit
 * sends CT information, its faults count when two revolutions in a row report them. A unit that
 * sends none gets TMINI_FAULT_DATA when two whole revolutions contain no valid range. Any unit gets
 * TMINI_FAULT_ENCODER when 12,000 samples (three seconds) come without a start packet (section 8),
 * and TMINI_FAULT_FREQUENCY when its frequency differs from the wanted one by more than 5 % for
 * three seconds. */
static inline uint8_t tmini_faults(const tmini_t *lidar);

/** Copies the CT information to `info`: versions, health and serial number as the unit sends them
 * while scanning. `info->known` shows which are known (section 7). After a loss none is: the unit
 * may have been exchanged. */
static inline void tmini_ct_info(const tmini_t *lidar, tmini_ct_info_t *info);

/** Copies the counters to `counters`. They count from tmini_init() on. */
void tmini_counters(const tmini_t *lidar, tmini_counters_t *counters);

/** @} */

/** @cond private */

/* ------------------------------------------------------------------------------------- private */

/* The members of a lidar, grouped by the file of lib/src that writes them. Small members come
 * first: Thumb code has short instructions for bytes at offsets 0 to 31 and half-words at 0 to
 * 62. */

/* tmini_command.c */
typedef struct {
    uint8_t operation;     /* The current or the last one, named by the event of its success; 0:
                            * none. */
    uint8_t phase;         /* A tmini_phase_t. */
    uint8_t code;          /* The command being sent. */
    uint8_t unsent;        /* TMINI_UNSENT until the port has taken both bytes, and two bits. */
    uint8_t attempts_left; /* After the current one. */
    bool is_repeated;      /* Not the first attempt: a late reply to an earlier one may come. */
    uint8_t steps;         /* Frequency steps sent. */
    uint8_t asks;          /* Questions sent that are repeated until the first answer; while
                            * scanning, late polls that found no packet. */
    uint16_t timeout_ms;   /* How long the phase may last; 0: without limit. */
    uint16_t frequency_chz;
    uint16_t wanted_chz; /* 0: any. */
    uint16_t timeouts;
    uint32_t since_ms; /* When the phase began. */
} tmini_command_t;

/* tmini_recovery.c */
typedef struct {
    uint8_t wishes;    /* A bit for each event that ends what is wanted: STARTED to REBOOTED. */
    uint8_t attempts;  /* Failed attempts since the last complete revolution, 1 to 3; 4: the first
                        * has not failed yet; 0: none has been made. */
    uint8_t contact;   /* Whether the lidar answers, and has the wanted frequency; three bits. */
    bool is_lost;      /* LOST has been raised, and RECOVERED has not. */
    uint16_t pause_ms; /* The pause after the latest failed attempt. */
    uint16_t losses;
    uint16_t recoveries;
    uint16_t restarts;
    uint16_t reboots;
} tmini_recovery_t;

/* tmini_monitor.c */
typedef struct {
    uint8_t faults;    /* As reported. */
    uint8_t observed;  /* Faults of the last revolution; reported when the next one has the same. */
    uint8_t ranges;    /* Packets with a valid range since the last start packet; at most 255. */
    uint8_t off_turns; /* Turns in a row at another frequency than wanted. */
    uint8_t off_times; /* How often that has lasted too long. */
    uint8_t turns_to_still; /* Start packets until a changed wish is carried out; 0: none has
                             * changed. */
    uint16_t samples;       /* Since the last start packet. */
} tmini_monitor_t;

/* tmini_line.c */
typedef struct {
    uint16_t busy_ms;   /* For how long not all that came has been handled, at most 255; 0: it has
                         * been. */
    uint16_t late_ms;   /* By how much the latest bytes may be late, if not in doubt. */
    uint16_t silent_ms; /* Observed silence; at most 65535. */
    uint16_t held;      /* Bytes that the port held when bytes came last. */
    uint32_t now_ms;    /* When the line was last looked at. It does not go back. */
    uint32_t heard_ms;  /* When bytes arrived last. */
    size_t received;    /* The place in the stream of the newest byte received. */
    size_t doubtful_to; /* Bytes may be missing somewhere before this place. It is never 0, because
                         * TMINI_RING_CLOSED is set, which changes no distance; 0: no doubt. */
} tmini_line_t;

/* tmini.c: copied from the configuration. */
typedef struct {
    const tmini_port_t *port;
    void *port_context;
    const tmini_timing_t *timing;
    tmini_step_t step;
    const void *step_data;
    tmini_point_t *spare_points; /* The buffer that holds no delivered scan; NULL: there is none. */
} tmini_link_t;

struct tmini_lidar {
    int8_t command_error;
    uint8_t idle_ms;  /* For this long after the last look at the line nothing is to be done, unless
                       * a frame may be complete. 0: the lidar is not settled. */
    uint16_t pending; /* A bit for each event not yet returned. */
    bool is_recovery_off;
    bool is_listen_only;
    tmini_recovery_t recovery;
    tmini_command_t command;
    tmini_line_t line;
    tmini_link_t link;
    uint32_t scans;
    uint32_t points_withheld;
    uint32_t complete_ms; /* When the newest complete scan ended; 0: there is none, or it ended half
                           * the clock's range ago. */
    size_t held_to; /* Written by the receiving context: up to where bytes wait in the port; 0:
                     * unknown. */
    tmini_ring_t ring;
    tmini_monitor_t monitor;
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

static inline const tmini_scan_t *tmini_scan(const tmini_t *lidar)
{
    return &lidar->scan;
}

static inline const tmini_packet_t *tmini_packet(const tmini_t *lidar)
{
    return &lidar->decoder.packet;
}

static inline bool tmini_packet_intact(const tmini_packet_t *packet)
{
    return tmini_frame_intact(packet->frame);
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
