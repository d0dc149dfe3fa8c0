/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini calibrate: asks one question at a time, and prints how the lidar is mounted. What is found
 * in the scans is in calibrate.c. */

#define _POSIX_C_SOURCE 200809L /* poll() */

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "calibrate.h"
#include "device.h"
#include "interrupt.h"
#include "output.h"

#define SETTLE_SCANS 3u /* Scans after an answer that may be older than it. */
#define TURN_SECONDS 20u

typedef struct {
    device_t *device;
    const options_t *options;
    tmini_mount_t mount; /* As found so far. */
    tmini_arc_t arcs[CALIBRATE_ARCS];
    char answer[80];
} dialogue_t;

typedef enum {
    STEP_DONE,
    STEP_SKIPPED,
    STEP_REFUSED, /* The reason has been printed. */
    STEP_ENDED,   /* No more answers. */
    STEP_FAILED,  /* No more scans. */
} step_t;

static sample_t sample;
static sample_t of_wall; /* The sample in which the front was found. */
static bool has_wall;
static turning_t turning;

/* ---------------------------------------------------------------------------------- the answers */

/* Takes what has been typed, without waiting. Returns '\n' at the end of the line, EOF at the end
 * of the input, 0 if nothing is there yet. */
static int take_typed(dialogue_t *dialogue)
{
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    char letter = 0;
    while (poll(&input, 1, 0) > 0) {
        const size_t length = strlen(dialogue->answer);
        if (read(STDIN_FILENO, &letter, 1) != 1) {
            return EOF;
        }
        if (letter == '\n') {
            return '\n';
        }
        if (length + 1 < sizeof dialogue->answer) {
            dialogue->answer[length] = letter;
            dialogue->answer[length + 1] = '\0';
        }
    }
    return 0;
}

/* Waits for a line, while scans come and are thrown away. */
static step_t ask(dialogue_t *dialogue, const char *question)
{
    int typed = 0;
    (void)fprintf(stderr, "\n%s\n> ", question);
    (void)fflush(stderr);
    dialogue->answer[0] = '\0';
    while ((typed = take_typed(dialogue)) == 0) {
        if (!device_next_scan(dialogue->device, NULL)) {
            return STEP_FAILED;
        }
    }
    if (typed == EOF) {
        return STEP_ENDED;
    }
    return strcmp(dialogue->answer, "s") == 0 ? STEP_SKIPPED : STEP_DONE;
}

static step_t refuse(const char *reason)
{
    (void)fprintf(stderr, "Not good: %s.\n", reason);
    return STEP_REFUSED;
}

/* ------------------------------------------------------------------------------------ the steps */

static bool skip_old_scans(dialogue_t *dialogue)
{
    for (unsigned i = 0; i < SETTLE_SCANS; i++) {
        if (!device_next_scan(dialogue->device, NULL)) {
            return false;
        }
    }
    return true;
}

static bool take_sample(dialogue_t *dialogue)
{
    calibrate_begin(&sample);
    if (!skip_old_scans(dialogue)) {
        return false;
    }
    while (sample.scans < CALIBRATE_SCANS) {
        if (!device_next_scan(dialogue->device, NULL)) {
            return false;
        }
        if (dialogue->device->stream.scan.complete) {
            calibrate_add(&sample, &dialogue->device->stream.scan);
        }
    }
    return true;
}

static const char *set_front(dialogue_t *dialogue)
{
    const options_t *const options = dialogue->options;
    const bool is_rough = strchr(options->given, 'F') != NULL;
    wall_t wall;
    const char *const reason =
        calibrate_wall(&of_wall, is_rough, options->mount.front_q6 / 64.0, &wall);
    if (reason == NULL) {
        dialogue->mount.front_q6 = (int16_t)lround(wall.degrees * 64);
        (void)fprintf(
            stderr,
            "The front is at %.2f degrees: a wall %.0f mm away, %.1f m long, %.0f mm rough.\n",
            wall.degrees, wall.away_mm, wall.long_mm / 1000, wall.rough_mm);
    }
    return reason;
}

static step_t find_front(dialogue_t *dialogue)
{
    if (!take_sample(dialogue)) {
        return STEP_FAILED;
    }
    of_wall = sample;
    calibrate_shift(&of_wall, dialogue->mount.offset_mm);
    const char *const reason = set_front(dialogue);
    has_wall = reason == NULL;
    return reason != NULL ? refuse(reason) : STEP_DONE;
}

/* Ranges that are all too long bend a wall, so the front is looked for once more. */
static const char *set_offset(dialogue_t *dialogue, double offset_mm)
{
    const double change_mm = offset_mm - dialogue->mount.offset_mm;
    dialogue->mount.offset_mm = (int16_t)lround(offset_mm);
    (void)fprintf(stderr, "Ranges are off by %d mm.\n", -dialogue->mount.offset_mm);
    if (!has_wall) {
        return NULL;
    }
    calibrate_shift(&of_wall, change_mm);
    return set_front(dialogue);
}

static step_t find_masks(dialogue_t *dialogue)
{
    const unsigned seconds =
        dialogue->options->seconds != 0 ? dialogue->options->seconds : TURN_SECONDS;
    if (!skip_old_scans(dialogue)) {
        return STEP_FAILED;
    }
    const uint32_t begun_ms = device_ms(dialogue->device);
    calibrate_begin_turning(&turning);
    while (device_ms(dialogue->device) - begun_ms < seconds * 1000) {
        if (!device_next_scan(dialogue->device, NULL)) {
            return STEP_FAILED;
        }
        calibrate_add_turning(&turning, &dialogue->mount, &dialogue->device->stream.scan);
    }
    const char *const reason =
        calibrate_masks(&turning, dialogue->arcs, &dialogue->mount.masked_count);
    if (reason != NULL) {
        dialogue->mount.masked_count = 0;
        return refuse(reason);
    }
    (void)fprintf(stderr, "Parts that turn with the robot: %zu.\n", dialogue->mount.masked_count);
    return STEP_DONE;
}

static step_t find_offset(dialogue_t *dialogue)
{
    char *end = NULL;
    double offset_mm = 0;
    const double true_mm = strtod(dialogue->answer, &end);
    if (end == dialogue->answer || *end != '\0' || !(true_mm >= 100 && true_mm <= 12000)) {
        return refuse("type the distance in mm, 100 to 12000");
    }
    if (!take_sample(dialogue)) {
        return STEP_FAILED;
    }
    const char *reason =
        calibrate_offset(&sample, dialogue->mount.front_q6 / 64.0, true_mm, &offset_mm);
    reason = reason == NULL ? set_offset(dialogue, offset_mm) : reason;
    return reason != NULL ? refuse(reason) : STEP_DONE;
}

static const struct {
    const char *question;
    step_t (*find)(dialogue_t *dialogue);
} steps[] = {
    {"1 of 3, the front. Put the robot with its front square to a straight wall, nearer to it "
     "than\n"
     "to any other wall, and press Enter; s skips.",
     find_front},
    {"2 of 3, the robot's own parts. Press Enter, then turn the robot slowly in its place, once\n"
     "around within 20 seconds (--seconds). What turns with it is the robot. s skips.",
     find_masks},
    {"3 of 3, the distance. Put something flat square before the robot, and type how far it is "
     "from\n"
     "the lidar's middle, in mm; s skips.",
     find_offset},
};

/* --------------------------------------------------------------------------------- the results */

static void print_arcs(const dialogue_t *dialogue, const char *between, const char *form)
{
    for (size_t i = 0; i < dialogue->mount.masked_count; i++) {
        (void)fputs(i > 0 ? between : "", stdout);
        (void)printf(form, dialogue->arcs[i].from_deg, dialogue->arcs[i].to_deg);
    }
}

static void print_c(const dialogue_t *dialogue)
{
    const tmini_mount_t *const mount = &dialogue->mount;
    if (mount->masked_count > 0) {
        (void)fputs("C:      static const tmini_arc_t masked[] = {", stdout);
        print_arcs(dialogue, ", ", "{%d, %d}");
        (void)puts("};");
    }
    (void)printf("%s static const tmini_mount_t mount = {.front_q6 = %d, .upside_down = %s, "
                 ".offset_mm = %d",
                 mount->masked_count > 0 ? "       " : "C:     ", mount->front_q6,
                 mount->upside_down ? "true" : "false", mount->offset_mm);
    if (mount->masked_count > 0) {
        (void)printf(", .masked = masked, .masked_count = %zu", mount->masked_count);
    }
    (void)puts("};");
}

/* In ROS the lidar's frame is turned in the robot's: counter-clockwise, and over if it hangs. */
static void print_results(const dialogue_t *dialogue)
{
    const tmini_mount_t *const mount = &dialogue->mount;
    const double front_deg = mount->front_q6 / 64.0;
    const double yaw = remainder(mount->upside_down ? -front_deg : front_deg, 360) *
                       (3.14159265358979323846 / 180);
    print_c(dialogue);
    (void)printf("Python: tmini.Lidar(PORT, front=%.8g, upside_down=%s, offset_mm=%d, mask=[",
                 front_deg, mount->upside_down ? "True" : "False", mount->offset_mm);
    print_arcs(dialogue, ", ", "(%d, %d)");
    (void)puts("])");
    (void)printf("ROS:    ros2 run tf2_ros static_transform_publisher --yaw %.5f --roll %s "
                 "--frame-id base_link --child-frame-id laser\n",
                 yaw, mount->upside_down ? "3.14159" : "0");
    (void)printf("tmini:  --front %.8g%s --offset %d ", front_deg,
                 mount->upside_down ? " --upside-down" : "", mount->offset_mm);
    print_arcs(dialogue, " ", "--mask %d:%d");
    (void)putchar('\n');
}

static step_t go_through(dialogue_t *dialogue)
{
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        step_t result = STEP_REFUSED;
        while (result == STEP_REFUSED) {
            result = ask(dialogue, steps[i].question);
            result = result == STEP_DONE ? steps[i].find(dialogue) : result;
        }
        if (result == STEP_ENDED || result == STEP_FAILED) {
            return result;
        }
    }
    return STEP_DONE;
}

static int calibrate(device_t *device, const options_t *options)
{
    dialogue_t dialogue = {.device = device, .options = options};
    const int status = device_start(device);
    if (status != STATUS_OK) {
        return status;
    }
    device->stream.mount = NULL; /* --front is where to look for the wall. */
    dialogue.mount.front_q6 = options->mount.front_q6;
    dialogue.mount.upside_down = options->mount.upside_down;
    dialogue.mount.offset_mm = options->mount.offset_mm;
    const step_t result = go_through(&dialogue);
    if (result == STEP_FAILED) {
        return device_why(device);
    }
    if (result == STEP_ENDED) {
        return message_fail("the questions were not answered: nothing is calibrated");
    }
    print_results(&dialogue);
    return STATUS_OK;
}

const command_t command_calibrate = {
    .name = "calibrate",
    .usage = "[-p PORT] [--seconds N] [--front DEG] [--upside-down]\n                [--offset MM]",
    .summary = "how the lidar is mounted: front, own parts, offset of ranges",
    .details = "Asks one question at a time, and prints the result for C, Python, ROS and this\n"
               "tool. What does not fit is refused with the reason, and asked again.\n"
               "--upside-down: the lidar hangs; --front: roughly where the front is, if two\n"
               "walls are equally near; --seconds: how long the robot is turned (20).",
    .accepts = "psFUOq",
    .use = calibrate,
};
