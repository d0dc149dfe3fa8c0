/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "device.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "interrupt.h"
#include "mount.h"
#include "output.h"
#include "points.h"
#include "tmini/tmini_names.h"
#include "users.h"

/* Longer than three attempts of any command. */
#define COMMAND_MS 15000u

/* A lidar that has just been plugged in boots for some seconds. */
#define START_MS 8000u
#define WAKE_MS 6000u

/* A program that looks at the port less often than this was kept from running. */
#define ABSENT_MS 50u

/* After this many bytes without a packet they are looked at more closely: a second. */
#define HOPELESS_BYTES 16384u

/* If no scan comes for this long, something is wrong: the driver has already tried to restart the
 * lidar. */
#define SCAN_MS 4000u

/* More bytes than an incomplete packet, or the reply to a restart. */
#define NOISE_BYTES 400u

/* The longest single wait, so that Ctrl-C and time-outs are noticed. */
#define SLICE_MS 10

/* A stop command may be lost while the line is quiet for another reason, for example in a USB hub.
 * A lidar that sends again within this time is stopped again, this many times at most. For the
 * first 500 ms the driver takes packets for the tail of the stop. */
#define STAYS_MS 600u
#define STOPS 3

/* The same without the driver: how long the line must be quiet, and how often this is tried. */
#define RAW_QUIET_MS 300u
#define RAW_TAILS 8u

/* The driver's default times, changed for a user who waits at a keyboard, and for a computer, where
 * bytes may come late and in large blocks. */
static tmini_timing_t patience;

static volatile sig_atomic_t started_fd = -1;

/* The stop command (section 3), from a signal's handler, without waiting for a quiet line. */
static void stop_at_once(void)
{
    static const uint8_t stop[2] = {TMINI_COMMAND_SYNC, TMINI_COMMAND_STOP};
    const int fd = started_fd;
    if (fd >= 0 && write(fd, stop, sizeof stop) < 0) {
        return; /* Nothing more can be done. */
    }
}

static bool is_socket(const char *path)
{
    return strncmp(path, "tcp:", 4) == 0;
}

/* A network may deliver bytes late, but none is lost there. */
static void be_patient(bool is_network)
{
    patience = tmini_timing_default;
    patience.frame_timeout_ms = is_network ? 1000 : 250;
    patience.max_pause_ms = is_network ? 0 : patience.max_pause_ms;
    patience.reply_timeout_ms = is_network ? 2000 : 1000;
    patience.quiet_line_ms = is_network ? 300 : 120;
}

/* The port's tap. */
static void take_bytes(void *context, const uint8_t *bytes, size_t count)
{
    device_t *const device = context;
    witness_take(&device->witness, bytes, count, tmini_posix_port.now_ms(&device->port));
    if (device->tap != NULL) {
        device->tap(device->tap_context, bytes, count);
    }
}

void device_tap(device_t *device, tmini_posix_tap_t tap, void *context)
{
    device->tap = tap;
    device->tap_context = context;
}

static void set_up_lidar(device_t *device)
{
    be_patient(is_socket(device->path));
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &device->port,
        .rx_buffer = device->rx,
        .rx_size = sizeof device->rx,
        .timing = &patience,
        .listen_only = device->listens,
    };
    if (tmini_init(&device->lidar, &config) != TMINI_OK) {
        abort(); /* Nothing in this configuration depends on the user. */
    }
}

static void set_up(device_t *device, const tmini_mount_t *mount)
{
    tmini_posix_init(&device->port, device->path);
    tmini_posix_reconnect(&device->port, device->waits);
    tmini_posix_tap(&device->port, take_bytes, device);
    witness_begin(&device->witness);
    set_up_lidar(device);
    stream_init(&device->stream, mount);
}

/* A timed stream only listens. With --wait it may come later. */
static void note_times(device_t *device)
{
    if (!device->listens && tmini_posix_is_timed(&device->port)) {
        device->listens = true;
        set_up_lidar(device);
        if (device->was_started) {
            (void)tmini_start(&device->lidar);
        }
    }
}

uint32_t device_ms(const device_t *device)
{
    return tmini_posix_port.now_ms(NULL) - device->begun_ms;
}

bool device_is_there(const device_t *device)
{
    return device->waits || device->port.state == TMINI_POSIX_OK;
}

bool device_is_usable(const device_t *device)
{
    return device_is_there(device) && (device->ignores_interrupt || !interrupt_has_come());
}

/* For a second Ctrl-C: the descriptor changes when the adapter comes back. */
static void note_line(const device_t *device)
{
    started_fd = device->was_started && !device->listens ? device->port.fd : -1;
}

/* Closes the port of a lidar that was not meant. */
static void leave_alone(device_t *device, const char *serial)
{
    message_note("%s is there, but with another lidar: serial %s, not %s. Waiting for that one",
                 device->path, serial, device->serial);
    tmini_posix_stop(&device->port);
    device->is_wrong = stat(device->path, &device->wrong_node) == 0;
    device->is_away = true;
}

/* Whether the same device is still there as when the port was closed. */
static bool is_still_wrong(const device_t *device)
{
    struct stat node;
    return stat(device->path, &node) == 0 && node.st_dev == device->wrong_node.st_dev &&
           node.st_ino == device->wrong_node.st_ino && node.st_rdev == device->wrong_node.st_rdev;
}

static void await_right_one(device_t *device)
{
    if (is_still_wrong(device)) {
        (void)poll(NULL, 0, SLICE_MS);
        return;
    }
    device->is_wrong = false;
    (void)tmini_posix_start(&device->port, &device->lidar); /* Or it is opened later. */
}

/* --wait: says that the adapter has gone, or is back. */
static void watch_adapter(device_t *device)
{
    const bool is_away = device->port.state != TMINI_POSIX_OK;
    if (is_away == device->is_away || !device->waits) {
        return;
    }
    device->is_away = is_away;
    note_line(device);
    if (!device->is_secretive) {
        message_note(is_away ? "%s is not there; waiting for it" : "%s is there", device->path);
    }
    device->must_compare = !is_away && !device->listens;
}

static void print_event(const device_t *device, tmini_event_t event)
{
    char text[FAULTS_TEXT_SIZE];
    if (device->is_secretive) {
        return;
    }
    if (event == TMINI_EVENT_FAULTS_CHANGED) {
        message_note("the lidar is %s", faults_text(tmini_faults(&device->lidar), text));
    } else if (event == TMINI_EVENT_LOST) {
        message_note("the lidar has fallen silent; starting it again");
    } else if (event == TMINI_EVENT_RECOVERED) {
        message_note("the lidar is back");
    } else if (event == TMINI_EVENT_UNWANTED_SCANNING) {
        message_note("the lidar scans although it was stopped; stopping it again");
    }
}

static tmini_event_t follow(device_t *device, tmini_event_t event)
{
    if (event == TMINI_EVENT_PACKET) {
        device->good_at = device->port.received;
        device->stream.is_late = is_socket(device->path) && !tmini_posix_is_timed(&device->port);
        const bool is_scan = stream_take(&device->stream, tmini_packet(&device->lidar),
                                         tmini_posix_port.now_ms(&device->port) - device->begun_ms);
        return is_scan ? TMINI_EVENT_SCAN : TMINI_EVENT_PACKET;
    }
    if (event == TMINI_EVENT_LOST) {
        const bool is_noise = device->port.received - device->good_at > NOISE_BYTES;
        stream_break(&device->stream);
        witness_break(&device->witness);
        *(is_noise ? &device->noises : &device->silences) += 1;
    }
    device->strays += event == TMINI_EVENT_UNWANTED_SCANNING ? 1 : 0;
    print_event(device, event);
    return event;
}

/* How long the port has been looked at. Time in which this program did not run does not count: the
 * bytes that came in it have not been seen. */
static void note_look(device_t *device)
{
    const uint32_t now_ms = tmini_posix_port.now_ms(NULL);
    const uint32_t passed_ms = now_ms - device->looked_at_ms;
    device->looked_at_ms = now_ms;
    device->looked_ms += passed_ms < ABSENT_MS ? passed_ms : ABSENT_MS;
    device->absent_ms = passed_ms > device->absent_ms ? passed_ms : device->absent_ms;
}

static tmini_event_t wait_for_event(device_t *device, uint32_t timeout_ms)
{
    const uint32_t begun_ms = device_ms(device);
    do {
        const tmini_event_t event = tmini_poll(&device->lidar);
        if (event != TMINI_EVENT_NONE && event != TMINI_EVENT_MORE) {
            return follow(device, event);
        }
        if (event == TMINI_EVENT_NONE) {
            if (device->is_wrong) {
                await_right_one(device);
            }
            (void)tmini_posix_wait(&device->port, SLICE_MS);
            note_times(device);
            note_look(device);
            watch_adapter(device);
        }
    } while (device_is_usable(device) && device_ms(device) - begun_ms < timeout_ms);
    return TMINI_EVENT_NONE;
}

/* A stop first ends the current command, for example a start. The event that reports this is not a
 * failure of the stop. */
static bool is_aborted(const device_t *device, tmini_event_t wanted)
{
    return wanted == TMINI_EVENT_STOPPED &&
           tmini_command_error(&device->lidar) == TMINI_ERROR_ABORTED;
}

/* A lidar that has lost its supply boots: three attempts of a query may be too few. */
#define INFO_TRIES 2u

/* Like device_await(), while the lidar is being compared. */
static bool settle(device_t *device, tmini_status_t begun, tmini_event_t wanted)
{
    const uint32_t begun_ms = device_ms(device);
    tmini_event_t event = TMINI_EVENT_NONE;
    while (begun == TMINI_OK && device_is_usable(device) && event != wanted &&
           (event != TMINI_EVENT_COMMAND_FAILED || is_aborted(device, wanted)) &&
           device_ms(device) - begun_ms < COMMAND_MS) {
        event = wait_for_event(device, SLICE_MS);
    }
    return event == wanted;
}

/* --wait: the name of a port does not show which lidar is there. The first one is the one that was
 * meant. One that does not answer is taken for it. */
static void compare_lidar(device_t *device)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    bool is_known = false;
    device->must_compare = false;
    if (settle(device, tmini_stop(&device->lidar), TMINI_EVENT_STOPPED)) {
        for (unsigned i = 0; i < INFO_TRIES && !is_known; i++) {
            is_known = settle(device, tmini_request_info(&device->lidar), TMINI_EVENT_INFO);
        }
    }
    if (is_known) {
        tmini_serial_text(tmini_info(&device->lidar), serial);
        if (device->serial[0] == '\0') {
            (void)snprintf(device->serial, sizeof device->serial, "%s", serial);
        }
        if (strcmp(device->serial, serial) != 0) {
            leave_alone(device, serial);
        }
    }
    if (device->was_started) {
        (void)tmini_start(&device->lidar);
    }
}

tmini_event_t device_wait(device_t *device, uint32_t timeout_ms)
{
    const tmini_event_t event = wait_for_event(device, timeout_ms);
    if (device->must_compare) {
        compare_lidar(device);
    }
    return event;
}

void device_facts(device_t *device, facts_t *facts)
{
    static char users[USERS_TEXT_SIZE];
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    users[0] = '\0';
    *facts = (facts_t){
        .path = device->path,
        .is_socket = is_socket(device->path),
        .listens = device->listens,
        .has_replied = counters.bytes_in_replies > 0,
        .users = is_socket(device->path) ? users : users_find(device->path, users),
    };
    witness_look(&device->witness, facts);
}

const cause_t *device_sign(device_t *device)
{
    facts_t facts;
    device_facts(device, &facts);
    const cause_t *const cause = cause_find(&facts);
    return cause != NULL && cause->is_sign ? cause : NULL;
}

/* Many bytes have come, none of them is in a packet, and it can be seen why: no use to wait. */
static bool is_hopeless(device_t *device)
{
    const witness_t *const witness = &device->witness;
    if (witness->tape.stream.packets > 0 || witness->bytes < HOPELESS_BYTES ||
        witness->received - device->judged_at < HOPELESS_BYTES) {
        return false;
    }
    device->judged_at = witness->received;
    return device_sign(device) != NULL;
}

bool device_await(device_t *device, tmini_status_t begun, tmini_event_t wanted)
{
    const uint32_t begun_ms = device_ms(device);
    while (begun == TMINI_OK && device_is_usable(device) &&
           device_ms(device) - begun_ms < COMMAND_MS && !is_hopeless(device)) {
        const tmini_event_t event = device_wait(device, SLICE_MS);
        if (event == wanted ||
            (event == TMINI_EVENT_COMMAND_FAILED && !is_aborted(device, wanted))) {
            return event == wanted;
        }
    }
    return false;
}

bool device_ask(device_t *device, device_begin_t begin, tmini_event_t wanted)
{
    const uint8_t attempts = patience.max_attempts;
    const uint32_t begun_ms = device->looked_ms;
    unsigned tries = 0;
    bool is_done = false;
    bool is_silent = true;
    do {
        if (tries++ == 1) {
            message_note("no answer yet; a lidar that has just got power is still booting: asking "
                         "for %u s …",
                         WAKE_MS / 1000);
        }
        is_silent = device->witness.received == 0;
        patience.max_attempts = is_silent ? 1 : attempts;
        is_done = device_await(device, begin(&device->lidar), wanted);
    } while (!is_done && is_silent && device_is_usable(device) &&
             device->looked_ms - begun_ms < WAKE_MS);
    patience.max_attempts = attempts;
    device->woken_ms = is_done && tries > 1 ? device_ms(device) : device->woken_ms;
    return is_done;
}

int device_finish(device_t *device, device_begin_t begin, tmini_event_t wanted)
{
    if (tmini_posix_is_timed(&device->port)) {
        return message_fail("%s sends what a lidar sends, with times, and takes no commands: give "
                            "them where the lidar is.",
                            device->path);
    }
    return device_ask(device, begin, wanted) ? STATUS_OK : device_why(device);
}

void device_begin(device_t *device)
{
    device->was_started = true;
    device->begun_ms = tmini_posix_port.now_ms(&device->port);
    witness_start(&device->witness);
    note_line(device);
}

static bool may_still_start(const device_t *device)
{
    return device_is_usable(device) && (device->waits || device_ms(device) < START_MS);
}

/* The driver keeps trying to start: a failed attempt is only reported. */
bool device_try_start(device_t *device)
{
    tmini_event_t event = TMINI_EVENT_NONE;
    bool is_reported = device->listens; /* With --listen this program starts nothing. */
    if (device->waits && !device->listens && device->port.state == TMINI_POSIX_OK) {
        compare_lidar(device);
    }
    device_begin(device);
    (void)tmini_start(&device->lidar);
    while (event != TMINI_EVENT_STARTED && may_still_start(device) && !is_hopeless(device)) {
        event = device_wait(device, SLICE_MS);
        if (event == TMINI_EVENT_COMMAND_FAILED && !is_reported && !device->is_away) {
            message_note("the lidar does not start: %s; trying again",
                         tmini_status_name(tmini_command_error(&device->lidar)));
            is_reported = true;
        }
    }
    return event == TMINI_EVENT_STARTED;
}

int device_start(device_t *device)
{
    return device_try_start(device) ? STATUS_OK : device_why(device);
}

static void send_raw(device_t *device, tmini_command_code_t code)
{
    const uint8_t command[2] = {TMINI_COMMAND_SYNC, (uint8_t)code};
    (void)tmini_posix_port.write(&device->port, command, sizeof command);
}

void device_start_raw(device_t *device)
{
    const bool sends = !device->listens;
    device->listens = true;
    set_up_lidar(device);
    (void)tmini_start(&device->lidar);
    if (sends) {
        device->is_raw = true;
        send_raw(device, TMINI_COMMAND_START);
    }
}

/* Until the line is quiet, but not for long: it may be deaf. */
static bool stop_raw(device_t *device)
{
    uint64_t before = 0;
    send_raw(device, TMINI_COMMAND_STOP);
    for (unsigned i = 0; i < RAW_TAILS && device->witness.received != before; i++) {
        before = device->witness.received;
        (void)device_wait(device, RAW_QUIET_MS);
    }
    device->was_started = false;
    return device->witness.received == before;
}

bool device_stop(device_t *device)
{
    if (device->is_raw) {
        return stop_raw(device);
    }
    tmini_status_t begun = tmini_stop(&device->lidar);
    bool is_stopped = false;
    bool stays = false;
    device->ignores_interrupt = true;
    for (int i = 0; i < STOPS && !stays; i++) {
        is_stopped = device_await(device, begun, TMINI_EVENT_STOPPED);
        stays = !is_stopped || device_wait(device, STAYS_MS) != TMINI_EVENT_UNWANTED_SCANNING;
        begun = TMINI_OK; /* The driver itself stops a lidar that streams unasked. */
    }
    device->ignores_interrupt = false;
    device->was_started = !(is_stopped && stays);
    return is_stopped && stays;
}

bool device_next_scan(device_t *device, void (*print)(const stream_t *stream))
{
    uint32_t waited_ms = 0;
    while (device_is_usable(device) && (device->waits || waited_ms < SCAN_MS)) {
        const uint32_t begun_ms = device_ms(device);
        const tmini_event_t event = device_wait(device, SLICE_MS);
        waited_ms += device_ms(device) - begun_ms; /* Without the time while a pipe's reader
                                                    * pauses. */
        if (print != NULL && (event == TMINI_EVENT_PACKET || event == TMINI_EVENT_SCAN)) {
            print(&device->stream);
        }
        if (event == TMINI_EVENT_SCAN) {
            return true;
        }
    }
    return false;
}

/* If the lidar answers this query, its wires are good. */
static bool answers_info(device_t *device)
{
    patience.max_attempts = 1;
    const bool is_stopped = device_stop(device);
    device->was_started = false; /* Not to be stopped again. */
    return is_stopped && device_await(device, tmini_request_info(&device->lidar), TMINI_EVENT_INFO);
}

static int explain_port(const device_t *device)
{
    if (device->port.state == TMINI_POSIX_UNPLUGGED && is_socket(device->path)) {
        return message_fail("%s has gone: the other end closed the connection. Does it still run, "
                            "and can it\nbe reached? Then try again.",
                            device->path);
    }
    if (device->port.state == TMINI_POSIX_UNPLUGGED) {
        return message_fail(
            "%s has gone: the adapter was unplugged, or has lost its supply. Plug it "
            "in and try again;\nif it happens when the motor starts, give the lidar "
            "a supply of its own (5 V, up to 1 A).",
            device->path);
    }
    return message_fail("%s: %s", device->path, strerror(errno));
}

/* The lidar sends and obeys, but scanning does not work. */
static int explain_scanning(const device_t *device)
{
    char text[FAULTS_TEXT_SIZE];
    const uint8_t faults = tmini_faults(&device->lidar);
    if (faults != 0) {
        return message_fail("the lidar on %s is %s", device->path, faults_text(faults, text));
    }
    return message_fail("the lidar on %s has fallen silent and does not come back. Check its "
                        "supply (5 V, up to 1 A)\nand its plug.",
                        device->path);
}

static int explain_cause(const device_t *device, const cause_t *cause, const facts_t *facts)
{
    char text[CAUSE_TEXT_SIZE];
    return message_fail("%s: %s%s%s", device->path, cause_text(cause, facts, text),
                        cause->advice != NULL ? ".\nWhat to do: " : "",
                        cause->advice != NULL ? cause->advice : "");
}

/* The lidar answers some commands. */
static int explain_command(device_t *device)
{
    const char *const reason = tmini_status_name(tmini_command_error(&device->lidar));
    if (!answers_info(device)) {
        return message_fail("the lidar on %s has answered before, but now: %s. Try again; if that "
                            "does not help,\n`tmini reboot` or cut its supply for a moment.",
                            device->path, reason);
    }
    return message_fail(
        "the lidar on %s answers `tmini info`, so its wires are good, but not this "
        "command: %s.\nTry again; if that does not help, `tmini reboot`. Its firmware "
        "may not know the command.",
        device->path, reason);
}

int device_why(device_t *device)
{
    if (device->port.state != TMINI_POSIX_OK) {
        return explain_port(device);
    }
    if (interrupt_has_come()) {
        return STATUS_FAILED;
    }
    const tmini_state_t state = tmini_state(&device->lidar);
    if (device_sign(device) == NULL &&
        (state == TMINI_STATE_SCANNING || state == TMINI_STATE_RECOVERING)) {
        return explain_scanning(device);
    }
    facts_t facts;
    device_facts(device, &facts);
    const cause_t *const cause = cause_find(&facts);
    if (facts.received == 0 && !device->listens && answers_info(device)) {
        return explain_command(device);
    }
    if (cause != NULL && cause->text != NULL) {
        return explain_cause(device, cause, &facts);
    }
    if (device->listens) {
        return message_fail("%s: the lidar sends packets, but completes no revolution. Does it "
                            "turn?",
                            device->path);
    }
    return explain_command(device);
}

static bool is_port_number(const char *text)
{
    char *end = NULL;
    const long number = strtol(text, &end, 10);
    return *end == '\0' && number >= 1 && number <= 65535;
}

/* Why a port cannot be opened, and what the user can do. */
static const char *advice_for(tmini_posix_status_t status, const char *path)
{
    static const char *const texts[] = {
        [-TMINI_POSIX_NO_DEVICE] = "there is no such device. Is the adapter plugged in? `tmini "
                                   "ports` shows which there are.",
        [-TMINI_POSIX_PERMISSION] =
            "you may not open it. On Linux, join the group that owns it and "
            "log in again:\nsudo usermod -a -G dialout $USER",
        [-TMINI_POSIX_BUSY] = "another program is using it. Close that program; `lsof` on the port "
                              "shows which.",
        [-TMINI_POSIX_NOT_A_TERMINAL] = "it is not a serial port. For a recording, use `tmini "
                                        "decode`, `plot FILE` or `view FILE`.",
        [-TMINI_POSIX_BAUD_RATE] = "it cannot do 230400 baud, the lidar's only baud rate. Use an "
                                   "adapter that can.",
        [-TMINI_POSIX_ADDRESS] = "a lidar on the network is tcp:HOST:PORT, for example "
                                 "tcp:192.168.4.1:3333.",
    };
    const char *const colon = strrchr(path, ':');
    if (status == TMINI_POSIX_ADDRESS && colon - path > 4 && colon[1] != '\0') {
        return is_port_number(colon + 1)
                   ? "there is no host of that name. Is it spelled right, and is this computer\non "
                     "the same network?"
                   : "what follows the host is the port, a number from 1 to 65535.";
    }
    if (is_socket(path) && errno == ECONNREFUSED) {
        return "Connection refused: the host is there, but nothing serves that port.";
    }
    const bool is_address = strchr(path, ':') != NULL && strchr(path, '/') == NULL;
    const size_t index = is_address && status == TMINI_POSIX_NO_DEVICE
                             ? (size_t)-TMINI_POSIX_ADDRESS
                             : (size_t)-status;
    const bool is_known = index < sizeof texts / sizeof texts[0] && texts[index] != NULL;
    return is_known ? texts[index] : strerror(errno);
}

int device_use(const options_t *options, int (*use)(device_t *device, const options_t *options))
{
    static device_t device;
    device.path = ports_choose(options);
    if (device.path == NULL) {
        return STATUS_USAGE;
    }
    device.waits = options->wait;
    device.listens = options->listen;
    device.path = device.waits ? ports_stable_name(device.path) : device.path;
    set_up(&device, mount_of(options));
    const tmini_posix_status_t opened = tmini_posix_start(&device.port, &device.lidar);
    if (opened != TMINI_POSIX_OK && !device.waits) {
        return message_fail("cannot use %s: %s", device.path, advice_for(opened, device.path));
    }
    device.begun_ms = tmini_posix_port.now_ms(&device.port);
    device.looked_at_ms = tmini_posix_port.now_ms(NULL);
    note_times(&device);
    interrupt_watch(true);
    interrupt_last_words(stop_at_once);
    const int status = use(&device, options);
    tmini_posix_reconnect(&device.port, false);
    device.waits = false;
    if (device.was_started) {
        (void)device_stop(&device);
    }
    started_fd = -1;
    tmini_posix_stop(&device.port);
    return status;
}
