# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Joins the sources of lib/src to one file, tmini_all.c."""

import re

INCLUDE = re.compile(r'^#include "(tmini_\w+\.h)"\n', re.MULTILINE)

HEAD = """\
/*
 * SPDX-License-Identifier: MIT
 * Copyright (c) 2026 The tmini authors
 *
 * tmini {}, all sources in one. Put this file and the folder tmini beside your program, compile
 * it with the rest, and #include "tmini/tmini.h".
 */
"""


def single(sources, version):
    """Returns the file. `sources`: the contents of lib/src by name. Each private header is inserted where it is first
    included."""
    included = set()

    def inline(match):
        name = match[1]
        if name in included:
            return ""
        included.add(name)
        return INCLUDE.sub(inline, sources[name])

    text = HEAD.format(version)
    for name in sorted(sources):
        if name.endswith(".c"):
            text += f"\n/* {'-' * 30} {name} {'-' * 30} */\n\n" + INCLUDE.sub(inline, sources[name])
    return text
