#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Prints what CHANGELOG.md says about its topmost version, for the release's page and its tag:

    notes.py            as Markdown, with links to the project's address
    notes.py --tag      as the tag's message:  .ci/notes.py --tag | git tag -a -F - v1.0.0
"""

import posixpath
import re
import sys

from archive import relinked
from version import address, read, version


def section():
    """The lines about the topmost version."""
    return re.search(r"^## [^\n]*\n\n(.*?)\n*(?=^## |\Z)", read("CHANGELOG.md"), re.MULTILINE | re.DOTALL)[1] + "\n"


def notes():
    return relinked(section(), lambda target: target if ":" in target else
                    f"{address()}/blob/v{version()}/{posixpath.normpath(target)}")


def tag_message():
    """For Git, lines that begin with # are comments, and the first line is the subject."""
    return f"tmini {version()}\n\n" + re.sub(r"^#+ (.*)$", r"\1:", section(), flags=re.MULTILINE)


if __name__ == "__main__":
    sys.stdout.write(tag_message() if sys.argv[1:] == ["--tag"] else notes())
