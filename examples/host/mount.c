/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "mount.h"

#include <math.h>
#include <stdlib.h>

#include "output.h"

/* Reads a whole number of degrees that is followed by `end`. */
static const char *read_degrees(const char *text, char end, int16_t *degrees)
{
    char *after = NULL;
    const long value = strtol(text, &after, 10);
    *degrees = (int16_t)value;
    return after != text && *after == end && value >= -360 && value <= 360 ? after : NULL;
}

bool mount_read_front(options_t *options, const char *text)
{
    char *end = NULL;
    const double degrees = strtod(text, &end);
    if (end == text || *end != '\0' || !(fabs(degrees) <= 360)) {
        (void)message_usage("--front: \"%s\" is not an angle in degrees, -360 to 360", text);
        return false;
    }
    options->mount.front_q6 = (int16_t)lround(degrees * 64);
    return true;
}

bool mount_read_offset(options_t *options, const char *text)
{
    char *end = NULL;
    const long offset_mm = strtol(text, &end, 10);
    if (end == text || *end != '\0' || offset_mm < -1000 || offset_mm > 1000) {
        (void)message_usage("--offset: \"%s\" is not a number of mm, -1000 to 1000", text);
        return false;
    }
    options->mount.offset_mm = (int16_t)offset_mm;
    return true;
}

bool mount_read_mask(options_t *options, const char *text)
{
    tmini_arc_t *const arc = &options->masked[options->mount.masked_count];
    if (options->mount.masked_count == OPTIONS_MASKS) {
        (void)message_usage("--mask: no more than %u", OPTIONS_MASKS);
        return false;
    }
    const char *const colon = read_degrees(text, ':', &arc->from_deg);
    if (colon == NULL || read_degrees(colon + 1, '\0', &arc->to_deg) == NULL) {
        (void)message_usage("--mask: \"%s\" is not FROM:TO in whole degrees, as in 170:190", text);
        return false;
    }
    options->mount.masked_count++;
    return true;
}

const tmini_mount_t *mount_of(const options_t *options)
{
    const tmini_mount_t *const mount = &options->mount;
    const bool is_given = mount->front_q6 != 0 || mount->offset_mm != 0 || mount->upside_down ||
                          mount->masked_count > 0;
    return is_given ? mount : NULL;
}

bool mount_hides(const tmini_mount_t *mount, uint16_t angle_q6)
{
    const tmini_mount_t masks = {.masked = mount->masked, .masked_count = mount->masked_count};
    tmini_point_t probe = {.angle_q6 = angle_q6, .distance_mm = 1};
    tmini_mount_point(&masks, &probe);
    return probe.distance_mm == 0;
}
