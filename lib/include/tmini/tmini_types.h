/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The library's types: statuses, points, scans, packets, a lidar's reports about itself, faults and
 * filters. Angles are in 1/64 degree (`_q6`), clockwise seen from above, 0 to 23039; distances in
 * millimetres (`_mm`), frequencies in 0.01 Hz (`_chz`). */

#ifndef TMINI_TYPES_H
#define TMINI_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------------------------------- status */

/** The result of a call. tmini_names.h turns it into text. */
typedef enum {
    TMINI_OK = 0,              /**< Success: done, or begun. */
    TMINI_ERROR_ARGUMENT = -1, /**< A null pointer, or a value outside its documented range. */
    TMINI_ERROR_STATE = -2,    /**< The lidar scans, or is to: only stop may be sent (section 2). */
    TMINI_ERROR_TIMEOUT = -3,  /**< The lidar did not answer, or did not become quiet, in time. */
    TMINI_ERROR_WRITE = -4,    /**< The port's write function failed, or took no byte for too
                                * long. */
    TMINI_ERROR_REPLY = -5,    /**< The lidar answered, but did not do what the command asked. */
    TMINI_ERROR_ABORTED = -6,  /**< A stop ended the command before it had finished. */
    TMINI_ERROR_LISTEN_ONLY = -7, /**< Nothing may be sent, because of listen_only. */
} tmini_status_t;

/* --------------------------------------------------------------------------------------- points */

/** A full circle in 1/64 degree. */
#define TMINI_FULL_CIRCLE_Q6 23040u

/** The angle from one direction clockwise to another; all in 1/64 degree, below a full circle. Any
 * context; no waiting. */
static inline uint16_t tmini_clockwise(uint16_t from_q6, uint16_t to_q6)
{
    return (uint16_t)(to_q6 + (to_q6 < from_q6 ? TMINI_FULL_CIRCLE_Q6 : 0) - from_q6);
}

/** What the lidar reports about a sample (section 5). Not trustworthy on every unit (section
 * 9.9). */
typedef enum {
    TMINI_FLAG_SPECULAR = 2, /**< Interference by specular reflection. */
    TMINI_FLAG_AMBIENT = 3,  /**< Interference by ambient light. */
} tmini_flag_t;

/** Which flagged points get the distance 0. They stay in the scan, with intensity and flag. Combine
 * with |. */
typedef enum {
    TMINI_FILTER_NONE = 0,                            /**< All points are kept as sent. */
    TMINI_FILTER_SPECULAR = 1 << TMINI_FLAG_SPECULAR, /**< Points with TMINI_FLAG_SPECULAR. */
    TMINI_FILTER_AMBIENT = 1 << TMINI_FLAG_AMBIENT,   /**< Points with TMINI_FLAG_AMBIENT. */
    TMINI_FILTER_BOTH = TMINI_FILTER_SPECULAR | TMINI_FILTER_AMBIENT, /**< Points with either. */
} tmini_filter_t;

/** One measurement; six bytes. */
typedef struct {
    uint16_t angle_q6;    /**< 1/64 degree, 0 to 23039, clockwise. */
    uint16_t distance_mm; /**< 1 to 16383; 0: no valid range, or filtered. */
    uint8_t intensity;    /**< 0 to 255. */
    uint8_t flag;         /**< 0 to 3, as sent; 2 and 3 are a tmini_flag_t. */
} tmini_point_t;

/** The shortest distance that the lidar is rated for, in millimetres (section 1). It may send
 * distances outside its rating, too. A distance of 0 means unknown, neither near nor free. */
#define TMINI_RANGE_MIN_MM 50u
/** The longest distance that the lidar is rated for, in millimetres (section 1). */
#define TMINI_RANGE_MAX_MM 12000u

/* ---------------------------------------------------------------------------------------- scans */

/** A buffer of this many points holds any revolution at 6 Hz and above (section 9.7). While the
 * motor comes up to speed a revolution may have more; points that do not fit are counted as
 * dropped. */
#define TMINI_SCAN_POINTS_TYPICAL 800u

/** One revolution, or the received part of it, and its quality. */
typedef struct {
    tmini_point_t *points;    /**< The points in order of arrival, in the caller's buffer. */
    uint16_t count;           /**< Points in the buffer, at least one. */
    uint16_t dropped;         /**< Points that did not fit in it. */
    uint16_t packets;         /**< Packets received of this revolution. */
    uint16_t gaps;            /**< Places where packets may be missing: bytes were lost, damaged or
                               * late. */
    uint16_t checksum_errors; /**< Checksum errors during the scan, modulo 2^16. */
    /** The measured frequency in 0.01 Hz, from the start packet that ends the scan; if that was
     * lost, from the last one received. 0: unknown. */
    uint16_t frequency_chz;
    uint32_t start_ms; /**< The port's clock when the scan's first sample came. */
    uint32_t end_ms;   /**< The port's clock when the packet that ended the scan came. */
    bool complete;     /**< A full circle from start packet to start packet, in the time of one
                        * turn, without a gap or dropped points. Four losses cannot be seen: up to
                        * 4 degrees at the end, if no LastCRC came; a whole turn, if polls are so
                        * rare that the clocks of lidar and host differ by a third of a turn in
                        * twice the time between polls (0.46 s at 12 Hz, if one is 3 % faster); a
                        * turn during which the clock is set back between two polls; and a turn that
                        * is hidden by delays, made on purpose or by a layer that holds bytes
                        * unreported (tmini_feed_held()). Damage that leaves the checksum right
                        * cannot be seen either: one in 15 pairs of flipped bits does. */
    bool upside_down;  /**< The angles decrease with time: tmini_mount_step() has turned the scan
                        * over. */
} tmini_scan_t;

/* -------------------------------------------------------------------------------------- packets */

/** The value of a gap that may be any number of bytes. */
#define TMINI_GAP_UNKNOWN UINT16_MAX

/** One valid packet, as a view of its frame. The members from the first to `gap` may be read. */
typedef struct {
    uint16_t first_angle_q6; /**< FSA, below 23040. */
    uint16_t last_angle_q6;  /**< LSA, below 23040. Meaningless if count is 1 (section 9.6). */
    uint8_t ct;              /**< As sent: bit 0 start packet, bits 1 to 7 CT information. */
    uint8_t count;           /**< Samples: 1 to 255. */
    uint16_t gap;            /**< Bytes skipped before it, or TMINI_GAP_UNKNOWN: any number of
                             * packets may be missing, because bytes were lost, the line paused, or
                             * the packet is late. Without scans, a damaged packet adds only those
                             * of its bytes that came, even if a whole turn is damaged. */
    uint32_t step;           /**< The angle between two samples, in 1/64 degree / 2^17, rounded
                             * up. */
    const struct tmini_frame *frame; /**< Where its bytes lie. */
} tmini_packet_t;

/** True for the packet that begins a revolution. The parsing context; no waiting. */
static inline bool tmini_packet_is_start(const tmini_packet_t *packet)
{
    return (packet->ct & 1u) != 0;
}

/** The frequency of the revolution before a start packet, in 0.01 Hz (sections 7 and 9.8); 0:
 * unknown. Only start packets carry it. The parsing context; no waiting. */
static inline uint16_t tmini_packet_frequency_chz(const tmini_packet_t *packet)
{
    return (uint16_t)((packet->ct >> 1) * 10);
}

/** Reads point `index` (from 0), unfiltered. Returns false if `index` is not below count, or if DMA
 * has overwritten the packet: then do not use the point. The parsing context; no waiting. */
bool tmini_packet_point(const tmini_packet_t *packet, size_t index, tmini_point_t *point);

/** Reads the packet's points, at most `max_points`, and applies `filter` (a combination of
 * tmini_filter_t). Returns how many were read. Use them only if tmini_packet_intact() is then true.
 * The parsing context; no waiting; about 12 instructions per point on a Cortex-M4. */
size_t tmini_packet_points(const tmini_packet_t *packet, unsigned filter, tmini_point_t *points,
                           size_t max_points);

/** True if any sample has a distance other than 0. The parsing context; a loop over the samples. */
bool tmini_packet_has_range(const tmini_packet_t *packet);

/* --------------------------------------------------------------- what a lidar reports of itself */

/** Digits of a serial number (section 4). */
#define TMINI_SERIAL_DIGITS 16u

/** The model number of the T-mini Pro, which speaks the same protocol (section 9.15). */
#define TMINI_MODEL_T_MINI_PRO 150u
/** The model number of the T-mini Plus (section 4). */
#define TMINI_MODEL_T_MINI_PLUS 151u

/** The lidar's report about itself, in the order in which it is sent (section 4). */
typedef struct {
    uint8_t model;                       /**< TMINI_MODEL_T_MINI_PLUS, … */
    uint8_t firmware_minor;              /**< In 1.2 this is 2. */
    uint8_t firmware_major;              /**< In 1.2 this is 1. */
    uint8_t hardware;                    /**< Hardware version. */
    uint8_t serial[TMINI_SERIAL_DIGITS]; /**< Digits as numbers 0 to 9, not characters. */
} tmini_info_t;

/** What may be wrong. Bits 0 to 5 are faulty modules, as in a health reply and in CT information
 * (sections 4 and 7). */
typedef enum {
    TMINI_FAULT_SENSOR = 1 << 0,         /**< The ranging sensor. */
    TMINI_FAULT_ENCODER = 1 << 1,        /**< Rotor blocked, opto-coupler or code disc. */
    TMINI_FAULT_WIRELESS_POWER = 1 << 2, /**< Wireless power; tested at power-up only, like the next
                                          * two. */
    TMINI_FAULT_PD = 1 << 3,             /**< Laser feedback voltage. */
    TMINI_FAULT_LD = 1 << 4,             /**< Laser drive current. */
    TMINI_FAULT_DATA = 1 << 5,           /**< No valid range in a revolution: perhaps the lidar is
                                          * covered. */
    TMINI_FAULT_FREQUENCY = 1 << 6,      /**< Found by the driver: not the wanted frequency. */
} tmini_fault_t;

/** The faults that a lidar itself can report; the two other bits of its status are reserved
 * (section 4). */
#define TMINI_FAULT_MASK 0x3Fu

/** The answer to a health request (section 4). */
typedef struct {
    uint8_t faults;      /**< A combination of tmini_fault_t; 0: healthy. */
    uint16_t error_code; /**< Details of the faulty module; undocumented. */
} tmini_health_t;

/** Which fields of tmini_ct_info_t are valid. A field's bit number is the index of the packet that
 * completes it. Fast scans have fewer than 14 packets, so the last fields may never arrive (section
 * 9.7). */
typedef enum {
    TMINI_KNOWN_USER_VERSION = 1 << 1, /**< Both of the protocol version's numbers. */
    TMINI_KNOWN_FAULTS = 1 << 3,   /**< Health. Not bit 4, although one sentence of the manual says
                                    * 4 (section 9.3). */
    TMINI_KNOWN_HARDWARE = 1 << 4, /**< The hardware version and the firmware's major number. */
    TMINI_KNOWN_FIRMWARE = 1 << 5, /**< Both of the firmware's numbers. */
    TMINI_KNOWN_YEAR = 1 << 9,     /**< The serial number's year. */
    TMINI_KNOWN_MONTH = 1 << 10,   /**< The serial number's month. */
    TMINI_KNOWN_DAY = 1 << 11,     /**< The serial number's day. */
    TMINI_KNOWN_SERIAL = 1 << 13,  /**< The whole serial number: date and number. */
} tmini_known_t;

/** The unit's report about itself while scanning. Fields that are not known are 0. */
typedef struct {
    uint16_t known;         /**< A combination of tmini_known_t. */
    uint8_t user_major;     /**< Protocol version, currently 1.0. */
    uint8_t user_minor;     /**< The second number of the protocol version. */
    uint8_t faults;         /**< A combination of tmini_fault_t; 0: healthy. */
    uint8_t hardware;       /**< Hardware version, 0 to 7. */
    uint8_t firmware_major; /**< 0 to 15. */
    uint8_t firmware_minor; /**< 0 to 127. */
    uint8_t month;          /**< The serial number's month, 0 to 15 as sent. */
    uint8_t day;            /**< The serial number's day, 0 to 31 as sent. */
    uint16_t year;          /**< The serial number's year, 2020 to 2051. */
    uint32_t number;        /**< The serial number's last eight digits, 0 to 2097151. */
} tmini_ct_info_t;

#ifdef __cplusplus
}
#endif

#endif
