# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Recordings with random damage: the package gives the scans that the tool gives, or says what is wrong."""

import random

import pytest
import tmini
from conftest import RECORDINGS
from lidar_bytes import damaged
from test_tmini import as_json, chunked, decode


def recording(seed):
    """A raw or a timed recording, cut and damaged; the beginning that marks a timed one stays."""
    draw = random.Random(seed)
    content = (RECORDINGS / "sim-6hz.bin").read_bytes()[:draw.randint(10, 9000)]
    content = draw.choice([content, chunked(content, 1), chunked(content, 2)])
    return content[:8] + damaged(content[8:], draw.randint(0, 20), seed)


@pytest.mark.filterwarnings("ignore:.* is damaged in:RuntimeWarning")
@pytest.mark.parametrize("seeds", [range(at, at + 20) for at in range(0, 300, 20)])
def test_a_damaged_recording_gives_what_the_tool_gives(tmp_path, seeds):
    path = tmp_path / "some"
    for seed in seeds:
        path.write_bytes(recording(seed))
        try:
            scans = [as_json(scan) for scan in tmini.read(path)]
        except ValueError as error:
            assert path.name in str(error), f"seed {seed}"
        else:
            assert scans == decode(path), f"seed {seed}"
