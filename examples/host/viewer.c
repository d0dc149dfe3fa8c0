/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "viewer.h"

#include <stdlib.h>
#include <string.h>

#include "interrupt.h"
#include "message.h"
#include "terminal.h"

bool viewer_open(viewer_t *viewer, const char *source)
{
    viewer->view = (view_t){.source = source, .state = ""};
    viewer->screen = (screen_t){.has_colours = getenv("NO_COLOR") == NULL};
    viewer->is_over = false;
    viewer->has_memory = true;
    interrupt_watch();
    if (!terminal_take()) {
        (void)message_fail(
            "view draws in a terminal, and there is none; try `tmini scan`, `decode` "
            "or `plot`");
        return false;
    }
    return true;
}

void viewer_close(viewer_t *viewer)
{
    terminal_restore();
    screen_free(&viewer->screen);
    if (!viewer->has_memory) {
        (void)message_fail("not enough memory for a screen of this size");
    }
}

void viewer_keep(viewer_t *viewer, const tmini_scan_t *scan)
{
    viewer->scan = *scan;
    memcpy(viewer->points, scan->points, scan->count * sizeof *scan->points);
    viewer->scan.points = viewer->points;
    viewer->view.scan = &viewer->scan;
}

/* Follows the terminal's size. Returns true if it has changed. */
static bool fit(viewer_t *viewer)
{
    unsigned columns = 80;
    unsigned rows = 24;
    (void)terminal_size(&columns, &rows);
    if (columns == viewer->screen.columns && rows == viewer->screen.rows) {
        return false;
    }
    viewer->has_memory = screen_resize(&viewer->screen, columns, rows);
    return viewer->has_memory;
}

/* Does what the keys say. Returns true if something has changed. */
static bool obey(viewer_t *viewer)
{
    switch (terminal_key()) {
    case 'q':
    case 'Q':
        viewer->is_over = true;
        return false;
    case '+':
    case '=':
        view_zoom(&viewer->view, true);
        return true;
    case '-':
        view_zoom(&viewer->view, false);
        return true;
    case 'a':
        viewer->view.zoom_mm = 0;
        viewer->view.range_mm = 0;
        return true;
    default:
        return false;
    }
}

static void show(viewer_t *viewer)
{
    const char *text = NULL;
    view_draw(&viewer->view, &viewer->screen);
    const size_t size = screen_render(&viewer->screen, &text);
    terminal_write(text, size);
}

void viewer_attend(viewer_t *viewer, bool is_news)
{
    const bool has_resized = fit(viewer);
    const bool has_obeyed = obey(viewer);
    if (viewer->has_memory && (is_news || has_resized || has_obeyed)) {
        show(viewer);
    }
    viewer->is_over = viewer->is_over || !viewer->has_memory || interrupt_has_come();
}
