/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "device.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "faults.h"
#include "interrupt.h"
#include "message.h"

/* Longer than any command takes that the driver tries three times. */
#define COMMAND_MS 15000u

/* Without a scan for so long something is wrong. The driver has tried to restart the lidar by then. */
#define SCAN_MS 4000u

/* For the line to fall quiet when leaving. */
#define STOP_MS 1000u

/* No longer at once, so that Ctrl-C is noticed and time is kept. */
#define SLICE_MS 10

/* ------------------------------------------------------------------------------- opening, closing */

static const char *advice_for(tmini_posix_status_t status)
{
    switch (status) {
    case TMINI_POSIX_NO_DEVICE:
        return "there is no such device. Is the adapter plugged in? `ls /dev/tty*` shows the "
               "ports: "
               "USB adapters are\n/dev/ttyUSB0 or /dev/ttyACM0 on Linux, /dev/cu.usb… on macOS.";
    case TMINI_POSIX_PERMISSION:
        return "you may not open it. On Linux, join the group that owns it and log in again:\n"
               "sudo usermod -a -G dialout $USER";
    case TMINI_POSIX_BUSY:
        return "another program is using it. Close that program; `lsof` on the port shows which.";
    case TMINI_POSIX_NOT_A_TERMINAL:
        return "it is not a serial port. For a recording, use `tmini decode`, `plot FILE` or "
               "`view FILE`.";
    case TMINI_POSIX_BAUD_RATE:
        return "it cannot do 230400 baud, the lidar's only baud rate. Use an adapter that can.";
    default:
        return NULL;
    }
}

/* The driver's own, but for someone who waits at a keyboard, and for a computer that has other things
 * to do: bytes may reach this program late and in one go. */
static const tmini_timing_t *patience(void)
{
    static tmini_timing_t timing;
    timing = tmini_timing_default;
    timing.silence_ms = 250;
    timing.reply_ms = 1000;
    return &timing;
}

static int explain_opening(const char *path, tmini_posix_status_t status)
{
    const char *const advice = advice_for(status);
    return message_fail("cannot use %s: %s", path, advice != NULL ? advice : strerror(errno));
}

static volatile sig_atomic_t started_fd = -1;

/* The stop command (section 3), from a signal's handler: nobody waits for the line to fall quiet. */
static void stop_at_once(void)
{
    static const uint8_t stop[2] = {0xA5, 0x65};
    const int fd = started_fd;
    if (fd >= 0 && write(fd, stop, sizeof stop) < 0) {
        return; /* Nothing more can be done. */
    }
}

int device_open(device_t **opened, const options_t *options)
{
    static device_t device;
    if (options->port == NULL) {
        return message_usage("on which port is the lidar? For example: -p /dev/ttyUSB0");
    }
    const tmini_posix_status_t status = tmini_posix_open(&device.serial, options->port);
    if (status != TMINI_POSIX_OK) {
        return explain_opening(options->port, status);
    }
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &device.serial,
        .rx_buffer = device.rx,
        .rx_size = sizeof device.rx,
        .points = device.points,
        .max_points = SCAN_CAPACITY,
        .timing = patience(),
    };
    (void)tmini_init(&device.lidar, &config);
    tmini_posix_attach(&device.serial, &device.lidar);
    device.path = options->port;
    interrupt_watch();
    interrupt_last_words(stop_at_once);
    *opened = &device;
    return STATUS_OK;
}

void device_close(device_t *device)
{
    if (device->was_started) {
        device->ignores_interrupt = true;
        (void)tmini_stop(&device->lidar);
        tmini_event_t event = TMINI_EVENT_NONE;
        do {
            event = device_wait(device, STOP_MS);
        } while (event != TMINI_EVENT_NONE && event != TMINI_EVENT_STOPPED &&
                 event != TMINI_EVENT_FAILED);
    }
    started_fd = -1;
    tmini_posix_close(&device->serial);
}

/* --------------------------------------------------------------------------------------- events */

static uint32_t now_ms(const device_t *device)
{
    return tmini_posix_port.now_ms((void *)&device->serial);
}

bool device_is_usable(const device_t *device)
{
    return device->serial.state == TMINI_POSIX_OK &&
           (device->ignores_interrupt || !interrupt_has_come());
}

tmini_event_t device_wait(device_t *device, uint32_t timeout_ms)
{
    const uint32_t begun_ms = now_ms(device);
    do {
        const tmini_event_t event = tmini_poll(&device->lidar);
        if (event != TMINI_EVENT_NONE) {
            return event;
        }
        (void)tmini_posix_receive(&device->serial, SLICE_MS);
    } while (device_is_usable(device) && now_ms(device) - begun_ms < timeout_ms);
    return TMINI_EVENT_NONE;
}

int device_finish(device_t *device, tmini_status_t begun, tmini_event_t wanted)
{
    if (begun != TMINI_OK) {
        return message_fail("%s: %s", device->path, tmini_status_name(begun));
    }
    const uint32_t begun_ms = now_ms(device);
    while (device_is_usable(device) && now_ms(device) - begun_ms < COMMAND_MS) {
        const tmini_event_t event = device_wait(device, SLICE_MS);
        if (event == wanted) {
            return STATUS_OK;
        }
        if (event == TMINI_EVENT_FAILED) {
            break;
        }
    }
    return device_why(device);
}

int device_start(device_t *device)
{
    device->was_started = true;
    started_fd = device->serial.fd;
    return device_finish(device, tmini_start(&device->lidar), TMINI_EVENT_STARTED);
}

int device_stop(device_t *device)
{
    device->ignores_interrupt = true;
    const int status = device_finish(device, tmini_stop(&device->lidar), TMINI_EVENT_STOPPED);
    device->ignores_interrupt = false;
    device->was_started = status != STATUS_OK;
    return status;
}

static void tell_faults(const device_t *device)
{
    char text[FAULTS_TEXT_SIZE];
    message_note("the lidar is %s", faults_text(tmini_faults(&device->lidar), text));
}

const tmini_scan_t *device_next_scan(device_t *device)
{
    const uint32_t begun_ms = now_ms(device);
    while (device_is_usable(device) && now_ms(device) - begun_ms < SCAN_MS) {
        switch (device_wait(device, SLICE_MS)) {
        case TMINI_EVENT_SCAN:
            return tmini_scan(&device->lidar);
        case TMINI_EVENT_FAULT:
            tell_faults(device);
            break;
        case TMINI_EVENT_LOST:
            message_note("the lidar has fallen silent; starting it again");
            break;
        default:
            break;
        }
    }
    return NULL;
}

/* ----------------------------------------------------------------------------------- what is wrong */

static int explain_port(const device_t *device)
{
    if (device->serial.state == TMINI_POSIX_UNPLUGGED) {
        return message_fail(
            "%s has gone: the adapter was unplugged, or has lost its supply. Plug it "
            "in and try again;\nif it happens when the motor starts, give the lidar "
            "a supply of its own (5 V, up to 1 A).",
            device->path);
    }
    return message_fail("%s: %s", device->path, strerror(errno));
}

static int explain_silence(const device_t *device)
{
    return message_fail("no answer on %s: not one byte came. Check that\n"
                        "- this is the port that the lidar is on,\n"
                        "- the lidar has 5 V and GND,\n"
                        "- its TX goes to the adapter's RX, and its RX to the adapter's TX.",
                        device->path);
}

static int explain_noise(const device_t *device)
{
    return message_fail("%" PRIu64
                        " bytes came on %s, but nothing that a T-mini Plus says. Check that\n"
                        "- it is this lidar, and not another device,\n"
                        "- the adapter really runs at 230400 baud (wrong baud rate: try another "
                        "adapter),\n"
                        "- lidar and adapter share GND, and the wires are short.",
                        device->serial.received, device->path);
}

static int explain_deafness(const device_t *device)
{
    return message_fail(
        "the lidar on %s sends, but does not do what it is told. Check the wire from "
        "the adapter's TX\nto the lidar's RX, and that its level is 3.3 V.",
        device->path);
}

/* The lidar has been heard, and has obeyed: but something is not as it should be. */
static int explain_trouble(const device_t *device)
{
    const uint8_t faults = tmini_faults(&device->lidar);
    char text[FAULTS_TEXT_SIZE];
    if (faults != 0) {
        return message_fail("the lidar on %s is %s", device->path, faults_text(faults, text));
    }
    if (tmini_state(&device->lidar) == TMINI_STATE_SCANNING) {
        return message_fail(
            "the lidar on %s sends packets, but completes no revolution. Does it turn?",
            device->path);
    }
    if (tmini_state(&device->lidar) == TMINI_STATE_RECOVERING) {
        return message_fail("the lidar on %s has fallen silent and does not come back. Check its "
                            "supply (5 V, up to 1 A)\nand its plug.",
                            device->path);
    }
    return message_fail(
        "the lidar on %s has answered before, but now: %s. Try again; if that does not "
        "help, `tmini reboot`\nor cut its supply for a moment.",
        device->path, tmini_status_name(tmini_failure(&device->lidar)));
}

int device_why(const device_t *device)
{
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    if (device->serial.state != TMINI_POSIX_OK) {
        return explain_port(device);
    }
    if (interrupt_has_come()) {
        return STATUS_FAILED;
    }
    if (device->serial.received == 0) {
        return explain_silence(device);
    }
    if (counters.parser.packets == 0 && counters.parser.bytes_in_replies == 0) {
        return explain_noise(device);
    }
    if (counters.parser.bytes_in_replies == 0) {
        return explain_deafness(device);
    }
    return explain_trouble(device);
}
