# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Archives that depend only on their contents: sorted, all files with the same date and permissions, and no owner.
Links to files that an archive does not contain lead to the project's address."""

import gzip
import io
import posixpath
import re
import tarfile
import time
import zipfile

# Parts of documents that do not apply in an archive.
REPOSITORY = re.compile(r"<!--repository-->.*?<!--/repository-->\n*", re.DOTALL)
FENCE = re.compile(r"^ *(```|~~~)")
LINK = re.compile(r'(\]\(|(?:src|href)=")([^()\s"#]+)(?=[)"\s#])')


def relinked(text, link):
    """The document with its links replaced by link(TARGET), except links in code."""
    lines, in_code = [], False
    for line in text.split("\n"):
        in_code ^= bool(FENCE.match(line))
        lines.append(line if in_code else LINK.sub(lambda m: m[1] + link(m[2]), line))
    return "\n".join(lines)


class Files:
    """The files of an archive: `contents` by name in the archive, and `places`: that name by the file's name in the
    project."""

    def __init__(self):
        self.contents, self.executable, self.places = {}, set(), {}

    def add(self, name, content, place=None, executable=False):
        self.contents[name] = content
        if place:
            self.places[place] = name
        if executable:
            self.executable.add(name)

    def link_outside(self, home, tag):
        """Replaces links to files that are not in this archive by links to the project's address."""
        for place, name in self.places.items():
            if name.endswith((".md", "PKG-INFO")):
                text = REPOSITORY.sub("", self.contents[name].decode())
                self.contents[name] = relinked(
                    text, lambda target, place=place: self._link(place, target, home, tag)).encode()

    def _link(self, place, target, home, tag):
        if re.match(r"[a-z]+:", target):
            return target
        goal = posixpath.normpath(posixpath.join(posixpath.dirname(place), target))
        if goal in self.places:
            return posixpath.relpath(self.places[goal], posixpath.dirname(self.places[place]) or ".")
        return f"{home}/{'raw' if goal.endswith(('.png', '.svg')) else 'blob'}/{tag}/{goal}"

    def tar_gz(self, path, date):
        memory = io.BytesIO()
        with tarfile.open(fileobj=memory, mode="w", format=tarfile.PAX_FORMAT) as tar:
            for name in sorted(self.contents):
                member = tarfile.TarInfo(name)
                member.size, member.mtime = len(self.contents[name]), date
                member.mode = 0o755 if name in self.executable else 0o644
                tar.addfile(member, io.BytesIO(self.contents[name]))
        with open(path, "wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=0) as packed:
            packed.write(memory.getvalue())

    def zip(self, path, date):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
            for name in sorted(self.contents):
                member = zipfile.ZipInfo(name, time.gmtime(date)[:6])
                member.compress_type, member.create_system = zipfile.ZIP_DEFLATED, 3
                member.external_attr = (0o100755 if name in self.executable else 0o100644) << 16
                packed.writestr(member, self.contents[name])
