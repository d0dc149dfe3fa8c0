# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

from typing import Any

ffi: Any
lib: Any
