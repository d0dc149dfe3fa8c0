# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Random command lines, recordings and reports: no signal ever ends the tool or tmini-sim, and exit status and message
are the right ones. What a command accepts is read from its help, as a person does.

TMINI_FUZZ: how many command lines; SEED: of all that is random."""

import json
import os
import random
import re
import subprocess
from pathlib import Path

import pytest
from conftest import TMINI, TMINI_SIM
from lidar_bytes import damaged

LINES = int(os.environ.get("TMINI_FUZZ", 2000))
SEED = int(os.environ.get("SEED", 1))

# Values of options, by their names in the help: right ones and wrong ones.
VALUES = {
    "PORT": (["/dev/none", "tcp:127.0.0.1:1"], []),
    "N": (["1", "7", "80"], ["", "-1", "x", "1.5", "1e1", "0x7", "7 ", "99999999999999999999"]),
    "DEG": (["0", "90", "-90", "359.5"], ["", "x", "nan", "90x", "1e9"]),
    "MM": (["0", "12", "-12"], ["", "x", "1e9"]),
    "FROM:TO": (["10:20", "350:10"], ["", "10", "a:b", "10:20:30"]),
}

# The words with which a command is complete; it then fails, because neither device nor file exist.
COMPLETE = {
    "info": [], "health": [], "frequency": ["7.5"], "reboot": [], "scan": [], "check": [], "record": ["x.bin"],
    "decode": ["nowhere.bin"], "plot": ["nowhere.bin", "-o", "x.svg"], "view": ["nowhere.bin"],
}
TOGETHER = [{"csv", "json"}, {"all", "scan"}]  # Not both.
NEVER = {"help", "version", "wait", "output"}  # Would end well, never end, or come twice.


def call(program, words, **options):
    return subprocess.run([program, *words], stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=False,
                          **options)


def options_of(command):
    """Of a command: name, letter (or ""), and the name of the value (or "")."""
    text = call(TMINI, ["help", command]).stdout.decode()
    return [(name, letter, value or "") for letter, name, value in
            re.findall(r"^  (?:-(\w),|   ) --([a-z-]+)(?: ([A-Z:]+))? ", text, re.MULTILINE)]


@pytest.fixture(scope="module")
def known():
    return {command: options_of(command) for command in COMPLETE}


@pytest.fixture(scope="module")
def names():
    """Of all options: they may be shortened as long as they stay different."""
    commands = re.findall(r"^  tmini (\w+)", call(TMINI, ["help"]).stdout.decode(), re.MULTILINE)
    return sorted({option[0] for command in commands for option in options_of(command)})


def spelt(draw, option, value, names):
    """One of the ways to write an option."""
    name, letter, kind = option
    shortest = next(i for i in range(1, len(name) + 1)
                    if i == len(name) or sum(other.startswith(name[:i]) for other in names) == 1)
    long = "--" + name[:draw.randint(shortest, len(name))]
    if not kind:
        return draw.choice([[long], ["-" + letter]] if letter else [[long]])
    ways = [[long, value], [f"{long}={value}"]] + ([["-" + letter, value]] if letter else [])
    return draw.choice(ways + ([["-" + letter + value]] if letter and value else []))


def mixed(draw, groups):
    """The groups in any order; words of a group stay together."""
    draw.shuffle(groups)
    return [word for group in groups for word in group]


def right_line(draw, known, names):
    """A right line as groups of words, the command's name first."""
    command = draw.choice(list(COMPLETE))
    usable = [option for option in known[command] if option[0] not in NEVER and (not option[2] or option[2] in VALUES)]
    chosen = [option for option in draw.sample(usable, draw.randint(0, min(4, len(usable)))) if option[0] != "port"]
    for pair in TOGETHER:
        while len([option for option in chosen if option[0] in pair]) > 1:
            chosen.remove(next(option for option in chosen if option[0] in pair))
    groups = [spelt(draw, option, draw.choice(VALUES[option[2]][0]) if option[2] else "", names) for option in chosen]
    if any(option[0] == "port" for option in known[command]) and command not in ("plot", "view"):
        groups.append(["-p", "/dev/none"])
    operands = COMPLETE[command]
    groups += [operands[:1]] * bool(operands) + [operands[1:]] * (len(operands) > 1)
    return command, groups


# Each with its message.
def wrong_line(draw, known, names):
    command, groups = right_line(draw, known, names)
    valued = [option for option in known[command] if VALUES.get(option[2], ("", ""))[1]]
    foreign = [option for options in known.values() for option in options
               if option[0] not in {own[0] for own in known[command]} and (not option[2] or option[2] in VALUES)]
    kinds = ["option", "letter", "word"] + ["value", "missing"] * bool(valued) + ["foreign"] * bool(foreign)
    kind = draw.choice(kinds)
    if kind == "option":
        return [command, *mixed(draw, [*groups, ["--frobnicate"]])], "--frobnicate"
    if kind == "letter":
        return [command, *mixed(draw, [*groups, ["-Z"]])], "-Z"
    if kind == "word":
        return [command, *mixed(draw, groups), "one", "two"], "unexpected"
    if kind == "foreign":
        option = draw.choice(foreign)
        value = draw.choice(VALUES[option[2]][0]) if option[2] else ""
        return [command, *mixed(draw, [*groups, spelt(draw, option, value, names)])], f"no option --{option[0]}"
    option = draw.choice(valued)
    if kind == "missing":
        return [command, *mixed(draw, groups), "--" + option[0]], f"--{option[0]} needs a value"
    value = draw.choice(VALUES[option[2]][1])
    return [command, *mixed(draw, [*groups, [f"--{option[0]}={value}"]])], f"--{option[0]}"


PIECES = ["scan", "decode", "record", "plot", "help", "version", "-", "--", "-p", "/dev/none", "-n", "--csv", "--json",
          "--stats", "--", "=", "x.svg", "-o", "-q", "-qqq", "--quiet", "1", "-1", "recordings/sim-6hz.bin", "%n%s", "",
          "--mask", "1:2", "--front", "-V", "-h", "ports", "A" * 300, "\udcff\udcc3", "--max-samples", "ü", "\x1b[2J"]


def random_line(draw):
    words = ["".join(draw.choices(PIECES, k=draw.choice([1, 1, 1, 2]))) for _ in range(draw.randint(0, 7))]
    return [word for word in words if not word.startswith("--w")]  # To wait would not end.


def test_any_command_line_has_the_right_status_and_message(known, names, environment):
    draw = random.Random(SEED)
    settings = {name: value for name, value in environment().items() if name != "LD_PRELOAD"}
    for _ in range(LINES):
        kind = draw.choice(["right", "wrong", "random"])
        words, message = random_line(draw), "tmini: "
        if kind == "right":
            command, groups = right_line(draw, known, names)
            words, message = [command, *mixed(draw, groups)], ""
        elif kind == "wrong":
            words, message = wrong_line(draw, known, names)
        run = call(TMINI, words, env=settings)
        errors = run.stderr.decode(errors="replace")
        what = f"{words}: {run.returncode}, {errors}"
        assert run.returncode in {"right": (1,), "wrong": (2,), "random": (0, 1, 2)}[kind], what
        assert run.returncode == 0 or errors.startswith("tmini: ") and message in errors, what
        assert run.returncode != 2 or run.stdout == b"", what


# ---- Recordings


def test_any_recording_is_read_to_its_end(lidar, tmini, folder):
    port = lidar().port
    for name in ("two.tmini", "raw.bin"):
        assert tmini("record", "-p", port, name, "--seconds", "2", "-q").status == 0
    for seed in range(SEED, SEED + LINES // 40):
        draw = random.Random(seed)
        content = Path(draw.choice(["two.tmini", "raw.bin"])).read_bytes()
        kept = draw.choice([0, 0, 8])  # So that many still begin as a timed recording does.
        rest = content[kept:draw.randint(40, 9000)]
        (folder / "some").write_bytes(content[:kept] + damaged(rest, 1 + seed % 30, seed))
        table = call(TMINI, ["decode", "some", "--csv", "--stats", "stats"])
        assert table.returncode in (0, 1), f"seed {seed}: {table}"
        rows = [line.split(",") for line in table.stdout.decode("ascii").splitlines()[1:]]
        assert len(rows) == json.loads(Path("stats").read_text(encoding="ascii"))["points"], f"seed {seed}"
        assert all(0 <= float(row[3]) < 360 and int(row[4]) < 16384 for row in rows), f"seed {seed}"
        scans = call(TMINI, ["decode", "some", "--json", "-q"])
        assert scans.returncode in (0, 1) and all(map(json.loads, scans.stdout.splitlines())), f"seed {seed}: {scans}"
        for words in (["decode", "some"], ["plot", "some", "--all", "-o", "some.svg"]):
            assert call(TMINI, words).returncode in (0, 1), f"seed {seed}: {words}"


# ---- Reports


def test_any_report_is_played_or_refused(lidar, tmini, folder):
    port = lidar().port
    report = tmini("survey", "-p", port, "report.txt")
    text = Path("report.txt").read_text(encoding="utf-8") if Path("report.txt").exists() else report.out
    assert len(text) > 500
    for seed in range(SEED, SEED + LINES // 20):
        draw = random.Random(seed)
        words = re.split(r"(\s+)", text)
        for _ in range(draw.randint(1, 12)):
            odd = ["", "-1", "nan", "1e300", "65536", "x" * 200, "\0", "\n", "0"]
            words[draw.randrange(len(words))] = draw.choice(odd)
        (folder / "report").write_text("".join(words), encoding="utf-8")
        run = call(TMINI_SIM, ["--like", "report", "--write", "/dev/null", "--seconds", "0.3"])
        assert run.returncode in (0, 1, 2), f"seed {seed}: {run}"
        assert run.returncode == 0 or run.stderr.startswith(b"tmini-sim: "), f"seed {seed}: {run}"
