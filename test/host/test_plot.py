# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures the pictures of `tmini plot`: every point must be in the right place. The points come from a plain reading
of the protocol, the scale from the tool's message and from the measured rings."""

import ctypes
import math
import re
import resource
import subprocess
from pathlib import Path

import pytest
from conftest import TMINI
from lidar_bytes import decode, points, turn

ROOM = "recordings/sim-6hz.bin"

# The layout of the picture, in pixels.
MIDDLE = (600, 690)
OUTERMOST = 500
POINT_WIDTH = 6.8


@pytest.fixture
def plot(tmini):
    """Draws picture.svg; returns it, and the tool's message."""
    def draw(*words):
        run = tmini("plot", *words, "-o", "picture.svg")
        assert run.status == 0, run.err
        return Path("picture.svg").read_text(encoding="utf-8"), run.err
    return draw


# ---- What should be drawn


def points_of(path, scan=None):
    """The points with a distance of one scan, or of all."""
    number = 0
    for content in decode(Path(path).read_bytes())[0]:
        number += content[2] & 1
        if number > 0 and scan in (None, number):
            yield from ((angle, distance) for angle, distance, *_ in points(content) if distance > 0)


def place_of(angle_q6, distance_mm, metres):
    """Angles go clockwise from straight up."""
    angle, pixels = math.radians(angle_q6 / 64), distance_mm / 1000 * OUTERMOST / metres
    return MIDDLE[0] + pixels * math.sin(angle), MIDDLE[1] - pixels * math.cos(angle)


# ---- What is drawn


def paths(svg):
    for path in re.findall(r"<path [^>]*>", svg):
        width = re.search(r'stroke-width[=:]"?([\d.]+)', path)
        yield float(width.group(1)) if width else 0, re.search(r' d="([^"]*)"', path).group(1)


def discs(svg, width=POINT_WIDTH):
    """The discs of this width: lines of length 0 with round ends."""
    for own_width, data in paths(svg):
        line = re.match(r"M (\S+) (\S+) L \1 \2(?:\s|$)", data)
        if line and abs(own_width - width) < 0.01:
            yield float(line.group(1)), float(line.group(2))


def rings(svg, x, y, radius):
    """How many rings there are of this radius around (x, y); their paths begin at the rightmost point."""
    found = (re.match(r"M (\S+) (\S+) C", data) for _, data in paths(svg))
    return sum(math.dist((float(at.group(1)), float(at.group(2))), (x + radius, y)) < 0.02 for at in found if at)


def assert_drawn(svg, said, expected, metres):
    """`metres`: the radius of the outermost ring, as the tool prints it."""
    assert f"; rings to {metres} m\n" in said
    assert rings(svg, *MIDDLE, OUTERMOST) == 1
    drawn, expected = list(discs(svg)), list(expected)
    assert len(drawn) == len(expected) > 0
    for place, point in zip(drawn, expected):
        assert place == pytest.approx(place_of(*point, metres), abs=0.02)


class Png:
    """A picture, read by the library that has drawn it."""

    def __init__(self, path):
        cairo = ctypes.CDLL("libcairo.so.2")
        cairo.cairo_image_surface_create_from_png.restype = ctypes.c_void_p
        cairo.cairo_image_surface_get_data.restype = ctypes.c_void_p
        surface = ctypes.c_void_p(cairo.cairo_image_surface_create_from_png(path.encode()))
        assert cairo.cairo_surface_status(surface) == 0
        self.size = cairo.cairo_image_surface_get_width(surface), cairo.cairo_image_surface_get_height(surface)
        self.stride = cairo.cairo_image_surface_get_stride(surface)
        self.bytes = ctypes.string_at(cairo.cairo_image_surface_get_data(surface), self.stride * self.size[1])
        cairo.cairo_surface_destroy(surface)

    def is_bright(self, x, y):
        """Points are; beams and background are dark."""
        at = int(y) * self.stride + 4 * int(x)
        return max(self.bytes[at:at + 3]) > 140


def png(tmini, *words):
    assert tmini("plot", *words, "-o", "picture.png").status == 0
    return Png("picture.png")


# ---- Tests


@pytest.mark.parametrize("name, words, scan, title", [
    ("sim-6hz.bin", [], 8, "picture.svg: Scan 8; 6.0 Hz · 669 points, 653 with a distance · sim-6hz.bin; "),
    ("sim-10hz-plain.bin", ["--scan", "3"], 3, ": Scan 3; "),
    ("sim-6hz.bin", ["--scan", "9"], 9, ": Scan 9 (incomplete); 6.0 Hz "),
    ("sim-12hz.bin", ["--all"], None, ": Scans 1 to "),
], ids=["the_last_complete_one", "a_chosen_one", "an_unfinished_one", "all"])
def test_a_scan_is_drawn_point_by_point(plot, name, words, scan, title):
    svg, said = plot("recordings/" + name, *words)
    assert_drawn(svg, said, points_of("recordings/" + name, scan), 6)
    assert title in said


def cross(flag_right=0, flag_back=0):
    """A recording of one scan with a point every 90 degrees: front, right, back, left."""
    Path("cross.bin").write_bytes(turn([(1000, 10, 0), (2000, 20, flag_right), (3000, 30, flag_back), (4000, 40, 0)]))
    return "cross.bin"


# The outermost ring is 4 m, 500 pixels.
def test_front_is_up_and_angles_go_clockwise(plot, folder):
    svg, said = plot(cross(), "--scan", "1")
    assert "; rings to 4 m\n" in said
    for place, expected in zip(discs(svg), [(600, 690 - 125), (600 + 250, 690), (600, 690 + 375), (600 - 500, 690)]):
        assert place == pytest.approx(expected, abs=0.02)
    assert 'y="147"' in svg and 'y="168"' in svg  # 0°, and below it its name.
    assert "M 600 190 L 600 181 " in svg  # Each ten degrees have a longer mark.
    assert "M 614 690 L 850 690 " in svg  # The free space to the right.


def test_interference_and_the_nearest_point_are_marked(plot, folder):
    svg, _ = plot(cross(2, 3), "--scan", "1")
    assert rings(svg, 600 + 250, 690, 7.4) == 1  # Flag 2: a ring.
    assert svg.count("M 594 1059 L 606 1071") == svg.count("M 594 1071 L 606 1059") == 1  # Flag 3: a cross, behind.
    assert len(re.findall(r'x="(?:4[89]|5\d|6[0-3])\d[.\d]*" y="1290"', svg)) == len("specular (1)")
    assert rings(svg, 600, 690 - 125, 12) == 1  # The nearest point.
    ring = re.search(r"M (\S+) 1284 C", svg)  # Its mark stands before its words as well, with a radius of 8.
    assert ring and rings(svg, float(ring[1]) - 8, 1284, 8) == 1


def test_a_unit_that_flags_every_sample_is_not_covered_with_marks(plot, folder):
    (folder / "flagged.bin").write_bytes(turn([(2000, 20, 2), (2000, 20, 2), (3000, 30, 3), (4000, 40, 3)]))
    svg, said = plot("flagged.bin", "--scan", "1")
    assert len(list(discs(svg))) == 4
    assert rings(svg, 600 + 250, 690, 7.4) == svg.count("M 594 1059") == 0
    assert "4 of 4 points flagged" in said


def test_a_covered_lidar_is_no_empty_disc(plot, tmini, folder):
    (folder / "covered.bin").write_bytes(turn(4 * [(0, 0, 0)]))
    said = plot("covered.bin", "--scan", "1")[1]
    assert "; rings to 6 m\n" in said  # The default scale.
    assert "no point has a distance: is the window covered?" in said
    picture = png(tmini, "covered.bin", "--scan", "1")  # It also says so, below the lidar.
    assert sum(picture.is_bright(x, 690 + 142) for x in range(200, 1000)) > 30


def test_the_png_shows_the_same_points_at_the_same_places(tmini):
    picture = png(tmini, ROOM)
    assert picture.size == (1200, 1360)
    assert all(picture.is_bright(*place_of(*point, 6)) for point in points_of(ROOM, 8))
    # Next to the axis to the right there is no point, neither inside nor outside the room.
    assert not any(picture.is_bright(*place) for place in ((600 + 42, 697), (600 + 333, 697), (5, 5)))


def test_a_point_in_the_png_is_a_dot_of_seven_pixels(tmini, folder):
    picture = png(tmini, cross(), "--scan", "1")
    # The point 2 m to the right: 250 pixels from the middle.
    assert [picture.is_bright(850, y) for y in (685, 687, 690, 692, 694)] == [False, True, True, True, False]


def test_a_plot_can_be_a_pdf(tmini):
    assert tmini("plot", ROOM, "-o", "picture.pdf").status == 0
    content = Path("picture.pdf").read_bytes()
    assert content.startswith(b"%PDF-") and len(content) > 10000


# At invalid UTF-8 cairo would stop drawing.
@pytest.mark.parametrize("name", ["Raum ü中😀.bin".encode(), b"not utf-8 \xFF\xC3.bin",
                                  3 * b"a_name_that_is_much_longer_than_the_picture_is_wide_" + b".bin"],
                         ids=["unicode", "not_utf_8", "long"])
def test_any_name_of_a_file_can_stand_below_the_title(plot, name):
    Path(name.decode(errors="surrogateescape")).write_bytes(Path(ROOM).read_bytes())
    svg, _ = plot(name.decode(errors="surrogateescape"))
    assert len(list(discs(svg))) == 653
    assert 'y="1332"' in svg  # The last text of the picture is there, too.


# 100 MB contain 30 million points: 180 MB in memory, and far more as SVG.
@pytest.mark.skipif(b"__asan_init" in Path(TMINI).read_bytes(), reason="a sanitizer reserves more than it uses")
def test_all_scans_of_a_long_recording_fit_in_bounded_memory(folder):
    content = Path(ROOM).read_bytes()
    with open("big.bin", "wb") as file:
        for _ in range(100000000 // len(content) + 1):
            file.write(content)
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (180000 * 1024, 180000 * 1024))
    run = subprocess.run([TMINI, "plot", "big.bin", "--all", "-o", "big.png"], stderr=subprocess.PIPE,
                         preexec_fn=limit, check=True)
    Path("big.bin").unlink()
    assert b" points with a distance, one in 512 " in run.stderr
    assert b"%" not in run.stderr  # Progress is for terminals.


def test_dashes_are_standard_input_and_standard_output(plot, tmini):
    with open(ROOM, "rb") as stdin:
        run = tmini("plot", "-", "-o", "picture.svg", stdin=stdin)
    assert run.status == 0 and "picture.svg: Scan 8; " in run.err and "standard input; " in run.err
    run = tmini("plot", ROOM, "-qo", "-")
    assert (run.status, run.err) == (0, "")
    assert run.out.startswith("<?xml") and "</svg>" in run.out


@pytest.mark.parametrize("name, reason, words", [
    ("sim-6hz.bin", "has no scan 10, only 1 to 9", ["-o", "x.svg", "--scan", "10"]),
    ("sim-6hz.bin", "cannot write /nowhere/x.svg", ["-o", "/nowhere/x.svg"]),
    ("sim-6hz.bin", "cannot write /nowhere/x.png", ["-o", "/nowhere/x.png"]),
    ("manual-packet.bin", "no start packet", ["-o", "x.svg"]),
])
def test_what_cannot_be_drawn_is_reported(fails, name, reason, words):
    fails(1, reason, "plot", "recordings/" + name, *words)
