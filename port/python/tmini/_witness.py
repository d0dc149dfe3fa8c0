# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Why no scans come: the tool's own judgement, in its words."""

from __future__ import annotations

import time

from ._native import ffi, lib

_PAUSE_MS = 100  # Longer pauses are the lidar's, between two attempts to start it.


class Witness:
    def __init__(self) -> None:
        self._native = ffi.new("witness_t *")
        lib.witness_begin(self._native)
        self._ms = 0  # The time during which bytes came.
        self._taken_ms = 0

    def take(self, data: bytes) -> None:
        if data:
            now_ms = time.monotonic_ns() // 1_000_000
            self._ms += min(now_ms - self._taken_ms, _PAUSE_MS)
            self._taken_ms = now_ms
            lib.witness_take(self._native, data, len(data), self._ms)

    def judge(self, port: str, *, listens: bool, has_replied: bool) -> str:
        """The cause and what to do about it; "" if there is none that shows."""
        path, nobody = ffi.new("char[]", port.encode()), ffi.new("char[]", b"")
        facts = ffi.new("facts_t *", {"path": path, "is_socket": port.startswith("tcp:"),
                                      "listens": listens, "has_replied": has_replied,
                                      "users": nobody})
        lib.witness_look(self._native, facts)
        cause = lib.cause_find(facts)
        if cause == ffi.NULL or cause.text == ffi.NULL:
            return ""
        text = ffi.new("char[]", lib.CAUSE_TEXT_SIZE)
        words = [lib.cause_text(cause, facts, text)]
        words += [cause.advice] if cause.advice != ffi.NULL else []
        return "\n".join(ffi.string(word).decode() for word in words)
