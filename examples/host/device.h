/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar on a port: opens the port, runs the driver, stops the lidar in the end, and explains
 * everything that can go wrong. The driver delivers packets; `stream` builds scans from them. */

#ifndef DEVICE_H
#define DEVICE_H

#include <sys/stat.h>

#include "options.h"
#include "causes.h"
#include "stream.h"
#include "tmini_posix.h"
#include "witness.h"

typedef struct device {
    tmini_t lidar;
    tmini_posix_t port;
    stream_t stream;
    witness_t witness;
    const char *path;
    uint32_t begun_ms;     /* When the port was opened; later, when the start command was given. */
    uint32_t silences;     /* How often the lidar was lost because nothing came. */
    uint32_t noises;       /* How often it was lost because no valid packets came. */
    uint32_t strays;       /* How often it scanned although it had been stopped. */
    uint64_t good_at;      /* Bytes received when the latest packet came. */
    uint32_t looked_at_ms; /* When the port was looked at last; */
    uint32_t looked_ms;    /* for how long, without the time that this program did not run; */
    uint32_t absent_ms;    /* and the longest such time. */
    uint32_t woken_ms;     /* How long a silent lidar took to answer; 0: it was not silent. */
    uint64_t judged_at;    /* Bytes at which is_hopeless() looked last. */
    tmini_posix_tap_t tap; /* device_tap() */
    void *tap_context;
    char serial[TMINI_SERIAL_DIGITS + 1]; /* --wait: of the lidar that was there first. */
    bool must_compare;                    /* An adapter is back: which lidar is there? */
    bool is_wrong;                        /* Another lidar is there: the port is closed, until */
    struct stat wrong_node;               /* this device has gone. */
    bool is_secretive;                    /* May be set: the caller reports what happens. */
    bool waits;                           /* --wait: continue when the adapter has disappeared. */
    bool is_away; /* The adapter has disappeared, and the program waits for it. */
    bool listens; /* --listen: nothing is sent. */
    bool is_raw;  /* device_start_raw() */
    bool was_started;
    bool ignores_interrupt; /* While stopping. */
    uint8_t rx[4096];
} device_t;

/* Opens the port that the options name, sets up a lidar, calls `use`, and stops the lidar. From
 * then on Ctrl-C is only noted. Returns the result of `use`; if the port cannot be opened, prints
 * the reason and returns the exit status. */
int device_use(const options_t *options, int (*use)(device_t *device, const options_t *options));

/* Milliseconds since the start command; before it, since the port was opened. */
uint32_t device_ms(const device_t *device);

/* The next event; TMINI_EVENT_SCAN instead of TMINI_EVENT_PACKET if it has completed a scan: see
 * `stream`. TMINI_EVENT_NONE if none came within `timeout_ms`, the port has failed, or Ctrl-C was
 * pressed: then check device_is_usable(). */
tmini_event_t device_wait(device_t *device, uint32_t timeout_ms);

/* False once Ctrl-C was pressed, or the port has failed and --wait was not given. */
bool device_is_usable(const device_t *device);

/* The same, but Ctrl-C does not count. */
bool device_is_there(const device_t *device);

/* Waits for the end of a command: `begun` is what the command's function returned, `wanted` the
 * event of its success. Returns whether it succeeded. */
bool device_await(device_t *device, tmini_status_t begun, tmini_event_t wanted);

/* A function that begins a query or command. */
typedef tmini_status_t (*device_begin_t)(tmini_t *lidar);

/* Begins it, and waits for its end. A lidar that has just got power does not answer yet: as long as
 * not one byte has come, it is asked again, for 6 s. Returns whether it succeeded. */
bool device_ask(device_t *device, device_begin_t begin, tmini_event_t wanted);

/* The same, but returns STATUS_OK; or prints what is wrong and what to try, and returns
 * STATUS_FAILED. */
int device_finish(device_t *device, device_begin_t begin, tmini_event_t wanted);

/* Call it before a start command: the time begins, and the lidar will be stopped in the end. */
void device_begin(device_t *device);

/* Begins to scan, and waits for the first packet. The lidar may still be booting, or the adapter be
 * plugged in later (--wait). Returns as device_finish() does. */
int device_start(device_t *device);

/* The same without a message: returns false if the lidar does not start. */
bool device_try_start(device_t *device);

/* Starts the lidar without the driver, which finds no packet in what it sends and would stop it
 * again and again. The bytes then only go to the tap. */
void device_start_raw(device_t *device);

/* Stops scanning, and waits until the line is quiet and stays quiet. Returns whether it does. */
bool device_stop(device_t *device);

/* Waits for the next scan; `print`, if not NULL, is called for each packet. Returns false if none
 * comes; device_why() then prints the reason. */
bool device_next_scan(device_t *device, void (*print)(const stream_t *stream));

/* Prints what is wrong with the lidar, and what to try; nothing after Ctrl-C. Returns
 * STATUS_FAILED. */
int device_why(device_t *device);

/* All received bytes also go to `tap`; NULL: no more. */
void device_tap(device_t *device, tmini_posix_tap_t tap, void *context);

/* What has been observed so far. Valid until the next call. */
void device_facts(device_t *device, facts_t *facts);

/* The cause that the bytes show by themselves, for example another unit; NULL: none. */
const cause_t *device_sign(device_t *device);

#endif
