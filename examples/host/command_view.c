/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini view: a picture in the terminal, of a live lidar or of a recording at its own speed. */

#define _POSIX_C_SOURCE 200809L

#include <poll.h>
#include <string.h>
#include <unistd.h>

#include "device.h"
#include "interrupt.h"
#include "output.h"
#include "points.h"
#include "recording.h"
#include "view.h"

#define SLICE_MS 10
#define SEEK_MS 5000u

/* On a terminal without cursor control pictures are printed below each other, at a low rate. */
#define PLAIN_MS 1000u

typedef struct {
    view_t view;
    screen_t screen;
    bool is_over; /* The user has quit, a signal has come, or there is no memory. */
    bool has_news;
    uint32_t shown_ms;
} viewer_t;

typedef struct {
    recording_t recording;
    uint32_t position_ms; /* The place in the recording */
    uint32_t since_ms;    /* at this time of the clock. */
    bool is_paused;
} player_t;

static uint32_t now_ms(void)
{
    return tmini_posix_port.now_ms(NULL);
}

static int open_viewer(viewer_t *viewer, const char *source, const stream_t *stream)
{
    *viewer = (viewer_t){.view = {.source = source, .state = "", .stream = stream},
                         .screen = screen_begin()};
    interrupt_watch(false);
    return terminal_take() ? STATUS_OK
                           : message_fail("view draws in a terminal, and there is none; try `tmini "
                                          "scan`, `decode` or `plot`");
}

static void show(viewer_t *viewer)
{
    const bool is_soon = !viewer->screen.has_cursor && viewer->shown_ms != 0 &&
                         now_ms() - viewer->shown_ms < PLAIN_MS;
    if (viewer->is_over || !viewer->has_news || is_soon) {
        return;
    }
    view_draw(&viewer->view, &viewer->screen);
    screen_show(&viewer->screen);
    viewer->has_news = false;
    viewer->shown_ms = now_ms();
}

/* Handles the keys that have the same effect in every view. */
static void heed(viewer_t *viewer, int key)
{
    switch (key) {
    case 'q':
    case 'Q':
    case KEY_ESCAPE:
        viewer->is_over = true;
        break;
    case '+':
    case '=':
    case '-':
        view_zoom(&viewer->view, key != '-');
        break;
    case 'a':
        viewer->view.zoom_mm = viewer->view.range_mm = 0;
        break;
    case KEY_SUSPEND:
        terminal_suspend();
        break;
    default:
        break;
    }
}

/* Call it every few milliseconds: handles a changed size and keys, and draws again if necessary.
 * Returns the key. */
static int attend(viewer_t *viewer)
{
    const int key = terminal_key();
    heed(viewer, key);
    viewer->has_news |= screen_fit(&viewer->screen) || key != KEY_NONE;
    viewer->is_over |= viewer->screen.rows == 0; /* There is no memory. */
    show(viewer);
    viewer->is_over |= interrupt_has_come();
    return key;
}

static void follow(device_t *device, viewer_t *viewer)
{
    const tmini_event_t event = device_wait(device, SLICE_MS);
    const unsigned faults = tmini_faults(&device->lidar);
    viewer->has_news |= event != TMINI_EVENT_NONE && event != TMINI_EVENT_PACKET;
    viewer->view.faults = faults != 0 ? faults : stream_faults(&device->stream);
    viewer->view.state = device->is_away ? "UNPLUGGED: waiting for it"
                         : tmini_state(&device->lidar) == TMINI_STATE_SCANNING
                             ? "scanning"
                             : "SILENT: starting it again";
}

static int watch(device_t *device, const options_t *options)
{
    static viewer_t viewer;
    (void)options;
    int status = device_start(device);
    if (status != STATUS_OK) {
        return status;
    }
    device->is_secretive = true; /* The picture shows it. */
    status = open_viewer(&viewer, device->path, &device->stream);
    viewer.view.keys = "q quit   + - zoom   a auto";
    while (status == STATUS_OK && !viewer.is_over && device_is_there(device)) {
        follow(device, &viewer);
        (void)attend(&viewer);
    }
    terminal_restore();
    screen_free(&viewer.screen);
    return status != STATUS_OK || viewer.is_over ? status : device_why(device);
}

static uint32_t position(const player_t *player)
{
    return player->position_ms + (player->is_paused ? 0 : now_ms() - player->since_ms);
}

static void set_position(player_t *player, uint32_t position_ms)
{
    player->position_ms = position_ms;
    player->since_ms = now_ms();
}

/* Takes packets up to `until_ms`, or to the next scan if `by_scan`. Returns whether a scan came. */
static bool play_to(player_t *player, uint32_t until_ms, bool by_scan)
{
    tape_t *const tape = &player->recording.tape;
    bool has_scan = false;
    tape->until_us = (uint64_t)until_ms * 1000;
    while (tape->time_us / 1000 <= until_ms && !(has_scan && by_scan) && !interrupt_has_come() &&
           recording_next(&player->recording)) {
        has_scan |= tape->stream.has_scan;
    }
    return has_scan;
}

/* Goes one scan forward, or one back: then plays again from the beginning. */
static void step(player_t *player, bool is_back)
{
    const tape_t *const tape = &player->recording.tape;
    const count_t number = tape->stream.number;
    player->is_paused = true;
    if (!is_back) {
        (void)play_to(player, UINT32_MAX, true);
    } else if (number > 1 && recording_rewind(&player->recording)) {
        do {
            (void)play_to(player, UINT32_MAX, true);
        } while (tape->stream.number + 1 < number && !player->recording.is_at_end &&
                 !interrupt_has_come());
    }
    set_position(player, (uint32_t)(tape->time_us / 1000));
}

static void seek(player_t *player, bool is_back)
{
    const uint32_t now = position(player);
    const uint32_t target = !is_back ? now + SEEK_MS : now > SEEK_MS ? now - SEEK_MS : 0;
    if (!is_back || recording_rewind(&player->recording)) {
        (void)play_to(player, target, false);
        const uint32_t reached = (uint32_t)(player->recording.tape.time_us / 1000);
        set_position(player, player->recording.is_at_end && reached < target ? reached : target);
    }
}

static void obey(player_t *player, int key)
{
    switch (key) {
    case ' ':
        set_position(player, position(player));
        player->is_paused = !player->is_paused;
        break;
    case '.':
    case ',':
        step(player, key == ',');
        break;
    case KEY_RIGHT:
    case KEY_LEFT:
    case '>':
    case '<':
        seek(player, key == KEY_LEFT || key == '<');
        break;
    default:
        break;
    }
}

static int play(const options_t *options, player_t *player)
{
    static viewer_t viewer;
    const recording_t *const recording = &player->recording;
    const char *const name = recording_base_name(options->operand);
    const int status = open_viewer(&viewer, name, &recording->tape.stream);
    viewer.view.keys = "q quit  +- zoom  a auto  space pause  ,. step  <> 5 s";
    player->recording.is_impatient = true;
    set_position(player, 0);
    while (status == STATUS_OK && !viewer.is_over) {
        const bool was_at_end = recording->is_at_end;
        viewer.has_news |= !player->is_paused && play_to(player, position(player), true);
        viewer.has_news |= recording->is_at_end != was_at_end;
        viewer.view.faults = stream_faults(&recording->tape.stream);
        viewer.view.state = recording->is_at_end ? "end of the recording"
                            : player->is_paused  ? "paused"
                                                 : "playing";
        const int key = attend(&viewer);
        obey(player, key);
        viewer.has_news |= key != KEY_NONE;
        (void)poll(NULL, 0, SLICE_MS);
    }
    terminal_restore();
    screen_free(&viewer.screen);
    return status;
}

static int view_recording(const options_t *options)
{
    static player_t player;
    int status = recording_open(&player.recording, options);
    if (status != STATUS_OK) {
        return status;
    }
    /* Before the screen is used, a file that is no recording is reported. */
    if (recording_next(&player.recording)) {
        status = play(options, &player);
    }
    if (status == STATUS_OK && player.recording.is_at_end) {
        status = recording_verdict(&player.recording);
    }
    recording_close(&player.recording);
    return status;
}

static int run(const options_t *options)
{
    if (options->operand != NULL && options->port != NULL) {
        return message_usage("view what? Usage: tmini view %s", command_view.usage);
    }
    return options->operand != NULL ? view_recording(options) : device_use(options, watch);
}

const command_t command_view = {
    .name = "view",
    .usage = "[-p PORT|FILE|-] [--wait] [--listen] [--front DEG] [--upside-down]\n"
             "           [--offset MM] [--mask FROM:TO]",
    .summary = "a picture in the terminal, of a lidar live or of a recording",
    .details = "Keys: + and - zoom, a chooses the range automatically, q or Esc ends, Ctrl-Z\n"
               "suspends. In a recording: space pauses, . and , go a scan further or back, the\n"
               "arrows (or < and >) five seconds. The marked point is the nearest obstacle; the\n"
               "numbers around the triangle are the nearest ones of each sector, in metres. A\n"
               "locale without UTF-8 gets characters instead of dots, NO_COLOR=1 no colours,\n"
               "and TERM=dumb one picture below the other.",
    .accepts = "pMWLFUOKq",
    .has_operand = true,
    .run = run,
};
