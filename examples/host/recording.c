/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "recording.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "message.h"

static const char *name_of(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

FILE *recording_open(const char *path)
{
    if (strcmp(path, "-") == 0) {
        return stdin;
    }
    FILE *const file = fopen(path, "rb");
    if (file == NULL) {
        (void)message_fail("cannot open %s: %s", path, strerror(errno));
    }
    return file;
}

void recording_close(FILE *file)
{
    if (file != stdin) {
        (void)fclose(file);
    }
}

int recording_verdict(const char *path, const decoder_t *decoder)
{
    const char *const name = name_of(path);
    if (ferror(decoder->file) != 0) {
        return message_fail("cannot read %s: %s", name, strerror(errno));
    }
    if (decoder->totals.bytes == 0) {
        return message_fail("%s is empty: nothing was recorded. Was the lidar scanning?", name);
    }
    if (decoder->totals.packets == 0) {
        return message_fail("%s holds no lidar packet in %" PRIu64 " bytes: it is not a recording "
                            "of a T-mini Plus,\nor was recorded with another baud rate than "
                            "230400, or before the lidar scanned.",
                            name, decoder->totals.bytes);
    }
    return STATUS_OK;
}

const char *recording_base_name(const char *path)
{
    const char *name = path;
    for (; *path != '\0'; path++) {
        if ((*path == '/' || *path == '\\') && path[1] != '\0') {
            name = path + 1;
        }
    }
    return name;
}
