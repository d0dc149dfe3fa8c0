/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "picture.h"

#include <errno.h>
#include <string.h>

#include "message.h"

static bool ends_with(const char *path, const char *ending)
{
    const size_t length = strlen(path);
    return length > strlen(ending) && strcmp(path + length - strlen(ending), ending) == 0;
}

bool picture_is_known(const char *path)
{
    return ends_with(path, ".svg") || ends_with(path, ".png");
}

int picture_write(const char *path, const figure_t *figure)
{
    const sheet_t sheet = ends_with(path, ".svg") ? svg_sheet(POLAR_WIDTH, POLAR_HEIGHT)
                                                  : png_sheet(POLAR_WIDTH, POLAR_HEIGHT);
    if (sheet.self == NULL) {
        return message_fail("not enough memory for a picture");
    }
    polar_draw(&sheet, figure);
    errno = 0;
    const bool saved = sheet.save(sheet.self, path);
    const int reason = errno;
    sheet.free(sheet.self);
    if (!saved) {
        return message_fail("cannot write %s: %s", path,
                            reason != 0 ? strerror(reason) : "not enough memory");
    }
    return STATUS_OK;
}
