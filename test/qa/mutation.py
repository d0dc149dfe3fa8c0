#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Changes the sources in one small place at a time, and checks that a test notices the change.

    mutation.py [--sample N [--seed S]] [--results FILE] [--killers] [--work DIR] [FILE …]

FILE is a source or a folder of sources: of the library (lib/src unless given), a port, an example, the simulated
lidar, the Python package, the viewer. PLACES says which tests must notice a change there.

The project is copied to DIR (build-mutation, unless given) and built there, once. For each mutant, its file is
replaced, Ninja builds the tests named like the source and ctest runs them, then all others. A mutant that no test
notices is not counted if its optimised machine code equals the original's. Otherwise it is an error, unless
test/qa/mutants.txt lists it with the reason why no test can. An entry there is an error if its mutant no longer exists
or, without --sample, if a test notices it.

With --results, a run that was stopped can be continued; FILE gets a line for each mutant: its fate, and the change.
With --killers, all tests run for each mutant, and its fate names the test functions that fail, as "program:function",
or "program:*" if the program crashes or does not end. At the end it prints how many mutants each function noticed
alone, and the programs without such a function: ask this before you remove a test.
"""

import argparse
import collections
import contextlib
import filecmp
import hashlib
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KNOWN = ROOT / "test" / "qa" / "mutants.txt"

# Where a change is, ctest's options for the tests that must notice it, and how often a test may be tried: some of these
# depend on the real time, and may fail once. {0} is what the first group of the pattern matches.
PLACES = [
    ("lib/", "-L ^unit$", 1),
    ("port/stm32/|examples/stm32_", "-R ^test_(port|example)_stm32", 1),
    ("port/esp32/|examples/esp32_idf/", "-R ^test_(port_esp32|bridge_web|example_esp32)", 1),
    ("port/arduino/|examples/esp32_arduino/", "-R ^test_arduino", 1),
    ("(?:port|examples)/(freertos|pico|zephyr|template)/", "-R ^test_(port|device|example)_{0}", 1),
    ("port/ros2/|examples/micro_ros/", "-R ^test_(laser|ros_.*|example_scan_node)$", 1),
    ("port/python/(?:tmini/|native.c)", "-R ^python$", 2),
    ("examples/mavlink/", "-R ^mavlink$", 1),
    ("examples/web/(?:page|wasm)/", "-L ^browser$", 2),
    ("examples/bridge/main/web", "-R ^test_bridge_web$", 1),
    ("examples/obstacle_stop/", "-R ^(test_obstacle|host.obstacle_stop)$", 2),
    ("port/posix/", "-R ^(test_port_posix|test_timed|host[.].*)$", 2),
    ("test/simulator/sim_judge", "-R ^(test_judge|test_programs|test_stamps)$", 1),
    ("test/simulator/", "-R ^(test_simulator|host[.].*)$", 2),
    ("examples/(host|common|decoder_only|bridge/(core|pc))/", "-L ^host$", 2),
]

# Patterns and their replacements: operators and constants that programmers often confuse.
COMMON = [
    (r"(?<![<>=!-])<(?![<=])", ["<=", ">="]), (r"<=(?!=)", ["<", ">"]),
    (r"(?<![->=])>(?![>=])", [">=", "<="]), (r"(?<![>=])>=(?!=)", [">", "<"]),
    (r"(?<= )\+(?= )", ["-"]), (r"(?<= )-(?= )", ["+"]), (r"-=", ["+="]), (r"\+=", ["-="]),
]

WITH_BRACES = COMMON + [
    (r"&&", ["||"]), (r"\|\|", ["&&"]), (r"\btrue\b", ["false"]), (r"\bfalse\b", ["true"]),
    (r"(?<= )\*(?= )", ["/"]), (r"(?<= )/(?= )", ["*"]), (r"(?<= )%(?= )", ["*"]), (r"\+\+", ["--"]),
    (r"\bif \((?=.*\) \{$)", ["if (true || ", "if (false && "]),
]

C_REPLACEMENTS = WITH_BRACES + [
    (r"==", ["!="]), (r"!=", ["=="]),
    (r"(?<![&])&(?![&=])(?= )", ["|"]), (r"(?<!\|)\|(?![|=])", ["&"]), (r"\^(?!=)", ["&"]),
    (r"<<(?!=)", [">>"]), (r"(?<!-)>>(?!=)", ["<<"]), (r"--(?!-)", ["++"]),
    (r"\+=", ["="]), (r"\|=", ["&=", "="]), (r"\^=", ["="]), (r"&=", ["|="]),
    # Types that may be too narrow for a counter or a time.
    (r"\b(?:size_t|uint32_t|unsigned)(?= \w+(?: = |;|,|\)))", ["uint16_t", "uint8_t"]),
    (r"\buint16_t(?= \w+(?: = |;|,|\)))", ["uint8_t"]),
    (r"(?<=[( ,+&|<>=-])!(?=[a-z(])", [""]),
    (r"\b(?:0x[0-9A-Fa-f]+|\d+)(?=[uU]?\b)", ["{0} + 1", "{0} - 1"]),
    (r"\breturn (?=[a-z(!].*;$)", ["return !"]),
    (r"^ +(?!return|const|case|default|break|continue|static|uint|size_t|int|bool|unsigned|tmini_\w+_t |for|while)"
     r"[a-z(*][^=]*(?:=(?!=).*)?;$", [";"]),
]

PYTHON_REPLACEMENTS = COMMON + [
    (r"==", ["!="]), (r"!=", ["=="]), (r"\band\b", ["or"]), (r"\bor\b", ["and"]),
    (r"\bnot (?!in\b)", [""]), (r"\bnot in\b", ["in"]), (r"\bis not\b", ["is"]), (r"\bis (?!not\b)", ["is not "]),
    (r"\bTrue\b", ["False"]), (r"\bFalse\b", ["True"]),
    (r"(?<= )\*(?= )", ["//"]), (r"(?<= )//?(?= )", ["*"]), (r"(?<= )%(?= )", ["+"]),
    (r"(?<![\w.])\d+(?![\w.])", ["{0} + 1", "{0} - 1"]), (r"\breturn (?=[^N\n])", ["return not "]),
    (r"\bif (?=.*:$)", ["if not "]), (r"^ +(?:[a-z_][\w.\[\]]*\(.*\)|[\w.]+ [-+]?= .*)$", ["pass"]),
]

SCRIPT_REPLACEMENTS = WITH_BRACES + [
    (r"===", ["!=="]), (r"!==", ["==="]), (r"\?\?", ["&&"]), (r"(?<=[( =&|])!(?=[a-z(])", [""]),
    (r"(?<![\w.#])\d+(?![\w.])", ["{0} + 1", "{0} - 1"]),
    (r"^ +(?:await )?[a-z][\w.#]*\(.*\);$", [";"]), (r"^ +(?:this\.)?[\w.#]+ = .*;$", [";"]),
]

REPLACEMENTS = {".py": PYTHON_REPLACEMENTS, ".js": SCRIPT_REPLACEMENTS}

# Comments and strings.
NO_CODE = {
    ".py": r'[rbf]*""".*?"""|[rbf]*"(?:\\.|[^"\\\n])*"|[rbf]*\'(?:\\.|[^\'\\\n])*\'|#[^\n]*',
    ".js": r"/\*.*?\*/|//[^\n]*|'(?:\\.|[^'\\\n])*'|\"(?:\\.|[^\"\\\n])*\"",
}
C_COMMENT = r"/\*.*?\*/|//[^\n]*"
C_STRING = r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
C_DIRECTIVE = r"(?m:^)#\s*(?!define\s+\w+ [-(]*\d)[^\n]*(?:\\\n[^\n]*)*"


# ---- Mutants ----

def code_only(kind, text):
    """Replaces comments, strings and preprocessor lines by blanks, so that all other code keeps its place."""
    for pattern in [NO_CODE[kind]] if kind in NO_CODE else [C_COMMENT, C_STRING, C_DIRECTIVE]:
        text = re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=re.DOTALL)
    return text


def function_at(lines, line):
    """The name of the function that contains a line; "-" outside of functions."""
    if lines[line].startswith("}"):
        return "-"
    for above in reversed(lines[:line + 1]):
        match = re.match(r"[A-Za-z_][^;=]*?\b(\w+)\(", above)
        if match:
            return match[1]
        if above.startswith("}"):
            break
    return "-"


def change_of(old, begin, end, replacement):
    """Describes the change with the operands around it, so that an entry in mutants.txt names one place."""
    if replacement in (";", "pass"):
        return f"{' '.join(old[begin:end].split('(')[0].split('=')[0].split())} removed"
    if narrower := re.fullmatch(r"uint(\d+)_t", replacement):
        variable = re.match(r" (\w+)", old[end:])
        return f"{variable[1]} in {narrower[1]} bits"
    words = [match.span() for match in re.finditer(r"\S+", old)]
    last = next(i for i, span in enumerate(words) if span[1] >= end)
    first = max(i for i, span in enumerate(words) if span[0] <= begin)
    is_word = lambda i: re.search(r"\w", old[slice(*words[i])])
    while first > 0 and not is_word(first := first - 1):
        pass
    while last + 1 < len(words) and not is_word(last := last + 1):
        pass
    left = re.sub(r"^.*\((?=[^()]*$)", "", old[words[first][0]:begin])
    right = re.sub(r"[;,){\s]*(?:/\*.*)?$", "", old[end:words[last][1]])
    return f"{left}{old[begin:end]}{right} -> {left}{replacement}{right}"


class Mutant:
    def __init__(self, path, line, begin, end, replacement, lines):
        self.path, self.line = path, line
        old = lines[line]
        self.before = old.strip()
        new = old[:begin] + replacement + old[end:]
        self.after = new.strip()
        self.text = "\n".join(lines[:line] + [new] + lines[line + 1:])
        self.key = f"{path} | {function_at(lines, line)} | {change_of(old, begin, end, replacement)}"
        self.id = hashlib.sha256(f"{path}\n{self.text}".encode()).hexdigest()[:16]

    def __str__(self):
        return f"{self.path}:{self.line + 1}: {self.before}  ->  {self.after}"


def mutants_of(path):
    text = (ROOT / path).read_text(encoding="utf-8")
    lines, kind, found = text.split("\n"), os.path.splitext(path)[1], {}
    for number, line in enumerate(code_only(kind, text).split("\n")):
        line = line.rstrip()  # The blanks of a comment after a statement.
        for pattern, replacements in REPLACEMENTS.get(kind, C_REPLACEMENTS):
            for match in re.finditer(pattern, line):
                for replacement in replacements:
                    begin = match.end() - len(match[0].lstrip())
                    mutant = Mutant(path, number, begin, match.end(), replacement.format(match[0]), lines)
                    found[mutant.id] = mutant
    return list(found.values())


def sources_among(names):
    """The named files, and those in the named folders that PLACES knows and that are neither tests nor only declare."""
    for name in names:
        path = Path(name).resolve()
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            relative = str(file.relative_to(ROOT))
            if file == path or file.suffix in (".c", ".cpp", ".h", ".py", ".js") and place_of(relative) and \
                    not file.name.startswith("test_") and \
                    (relative.startswith("lib/include/") or has_functions(file)):
                yield relative


def has_functions(path):
    return re.search(r"^\{|^\s*(?:async )?(?:def|function) ", path.read_text(encoding="utf-8"), re.MULTILINE)


def place_of(path):
    """ctest's options for the tests of a source, and how often one may be tried; or None."""
    for pattern, options, tries in PLACES:
        if match := re.match(pattern, path):
            return tuple(options.format(*match.groups()).split()), tries
    return None


# ---- Trying them ----

def run(*words, folder=None, seconds=1800, cpu_s=10):
    """Exit status and output. What it has started is ended with it, or after `seconds`; a process of it also after
    `cpu_s` of the processor's time: a loop may never end."""
    def limit():
        os.setpgrp()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))

    with subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", preexec_fn=limit) as process:
        try:
            return process.communicate(timeout=seconds)[0], process.returncode
        except subprocess.TimeoutExpired:
            return "", 1
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


class Copy:
    """A copy of the project, in which the sources are changed, with its build."""

    def __init__(self, folder, jobs, are_all_wanted):
        self.root, self.build, self.jobs = folder.resolve(), folder.resolve() / "build", str(jobs)
        self.are_all_wanted = are_all_wanted  # Or only the first program that fails.
        self.update()
        output, status = run("cmake", "-G", "Ninja", "-S", self.root, "-B", self.build, "-DTMINI_BUILD_TESTS=ON",
                             "-DTMINI_BUILD_EXAMPLES=ON", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
                             "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS_DEBUG=-O1", "-DCMAKE_CXX_FLAGS_DEBUG=-O1")
        if status != 0:
            sys.exit(output)
        self.targets = set(re.findall(r"^build ([\w.-]+): phony", (self.build / "build.ninja").read_text(), re.M))
        self.commands = json.loads((self.build / "compile_commands.json").read_text())
        self.tests_by_options, self.original_code = {}, {}

    def update(self):
        """Copies what differs, such as the last mutant of a run that was stopped."""
        for place, folders, files in os.walk(ROOT):
            folders[:] = [name for name in folders if not name.startswith(("build", ".git", "__pycache__"))]
            target = self.root / os.path.relpath(place, ROOT)
            target.mkdir(parents=True, exist_ok=True)
            for name in files:
                if not ((target / name).exists() and filecmp.cmp(Path(place, name), target / name, shallow=False)):
                    shutil.copy(Path(place, name), target / name)

    def tests_of(self, path):
        """The names of the tests of a source, and for each what Ninja must build. They pass without any mutant."""
        options, _ = place_of(path)
        if options not in self.tests_by_options:
            listed, _ = run("ctest", "--test-dir", self.build, "-C", "All", "--show-only=json-v1", *options)
            self.tests_by_options[options] = tests = {}
            for test in json.loads(listed[listed.index("{"):])["tests"]:
                label = next(entry["value"][0] for entry in test["properties"] if entry["name"] == "LABELS")
                name = test["name"]
                tests[name] = name if name in self.targets else "tests-" + label
            if not self.has_built(tests.values()) or self.failures(path, tests):
                sys.exit(f"without any mutant, there are failures among {' '.join(tests)}")
        return self.tests_by_options[options]

    def has_built(self, targets):
        return run("ninja", "-C", self.build, "-j", self.jobs, *set(targets))[1] == 0

    def failures(self, path, tests):
        """The test functions that fail, as "program:function"."""
        if not tests:
            return []
        _, tries = place_of(path)
        more = ["--repeat", f"until-pass:{tries}"] if tries > 1 else []
        more += [] if self.are_all_wanted else ["--stop-on-failure"]
        output, _ = run("ctest", "--test-dir", self.build, "-C", "All", "-j", self.jobs, "--output-on-failure",
                        "-R", f"^({'|'.join(map(re.escape, tests))})$", *more, cpu_s=30 if tries > 1 else 10)
        functions = collections.defaultdict(list)
        for name, text in re.findall(r"^ *\d+/\d+ Test +#\d+: (\S+) (.*?)(?=^ *\d+/\d+ Test|^\d+% tests)", output,
                                     re.DOTALL | re.MULTILINE):
            functions[name] = re.findall(r":(test_\w+):FAIL", text)
        failed = re.findall(r"^\s+\d+ - (\S+) \(", output, re.MULTILINE)
        return [f"{name}:{function}" for name in failed for function in functions[name] or ["*"]]

    def optimised(self, path):
        """The machine code of a source, or of all that may include a header. Empty: nothing here compiles it."""
        near = ("lib/src", "test/unit", os.path.dirname(path), "test/" + os.path.dirname(path))
        wanted = lambda file: file.startswith(near) if path.endswith(".h") else file == path
        found = []
        for entry in self.commands:
            file = os.path.relpath(os.path.realpath(entry["file"]), self.root)
            if wanted(file):
                words = shlex.split(entry["command"])
                made = self.build / "optimised.o"
                made.write_bytes(b"")
                run(*words[:words.index("-o")], "-O2", "-g0", "-w", "-c", entry["file"], "-o", made,
                    folder=entry["directory"])
                found.append(made.read_bytes())
        return found if path.endswith((".c", ".cpp", ".h")) else (self.root / path).read_bytes()

    def is_same_code(self, mutant, original):
        file = self.root / mutant.path
        if mutant.path not in self.original_code:
            file.write_text(original, encoding="utf-8")
            self.original_code[mutant.path] = self.optimised(mutant.path)
            file.write_text(mutant.text, encoding="utf-8")
        code = self.optimised(mutant.path)
        return bool(code) and code == self.original_code[mutant.path]

    def fate(self, mutant):
        """Returns 'killed by …', 'survived', 'the same code' or 'not C'."""
        tests, changed = self.tests_of(mutant.path), self.root / mutant.path
        stem = re.sub(r"^(?:command_|tmini_|_)|\.\w+$", "", changed.name)
        first = [] if self.are_all_wanted else [name for name in tests if stem in name]
        original = changed.read_text(encoding="utf-8")
        try:
            changed.write_text(mutant.text, encoding="utf-8")
            if not self.has_built([tests[name] for name in first] or tests.values()):
                return "not C"
            killers = self.failures(mutant.path, first)
            if not killers:
                if self.is_same_code(mutant, original):
                    return "the same code"
                self.has_built(tests.values())
                killers = self.failures(mutant.path, tests.keys() - set(first))
            return "killed by " + " ".join(killers if self.are_all_wanted else killers[:1]) if killers else "survived"
        finally:
            changed.write_text(original, encoding="utf-8")


class Results:
    """The fates of mutants, which are stored in a file if one is given."""

    def __init__(self, path):
        self.path, self.fates = path, {}
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.fates = {key: fate for key, fate, _ in (line.split("\t", 2) for line in file)}

    def of(self, mutant, copy):
        if mutant.id not in self.fates:
            self.fates[mutant.id] = copy.fate(mutant)
            if self.path:
                with open(self.path, "a", encoding="utf-8") as file:
                    file.write(f"{mutant.id}\t{self.fates[mutant.id]}\t{mutant}\n")
        return self.fates[mutant.id]


# ---- What is known, and what is reported ----

def known_survivors():
    known = {}
    for line in KNOWN.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            place, reason = line.rsplit(" | ", 1)
            path, first, second = place.split(" | ", 2)
            if first.endswith(" bits"):  # "8 or 16 bits": of each "function.variable"
                known.update((f"{path} | {word.replace('.', ' | ')} in {bits} bits", reason)
                             for word in second.split() for bits in re.findall(r"\d+", first))
                continue
            for entry in second.split(" ; "):
                code, *changes = entry.split(" -> ")
                keys = [f"{code} -> {change}" for change in changes] or [code]  # "code removed"
                known.update((f"{path} | {first} | {key}", reason) for key in keys)
    return known


def outdated(known):
    """The entries whose mutants no longer exist, because their lines have changed."""
    paths = {key.split(" | ")[0] for key in known}
    there = {mutant.key for path in paths if (ROOT / path).exists() for mutant in mutants_of(path)}
    return [key for key in known if key not in there]


def try_mutants(mutants, wanted, copy, results, known):
    """Tries mutants until there are `wanted` that tests could notice. Returns how many of these survived, and the
    entries of mutants.txt that were needed."""
    counts, needed = collections.Counter(), set()
    tried = lambda: counts["killed"] + counts["survived"] + counts["equivalent"]
    for mutant in mutants:
        if tried() >= wanted:
            break
        fate = results.of(mutant, copy)
        if mutant.key in known and fate in ("survived", "the same code"):
            needed.add(mutant.key)
        if fate == "survived" and mutant.key in known:
            fate = "equivalent"
        if fate == "survived":
            print(f"survived: {mutant}", flush=True)
        counts[fate.partition(" by ")[0]] += 1
    print(f"{tried()} mutants: {counts['killed']} killed, {counts['equivalent']} known to be equivalent, "
          f"{counts['survived']} survived; also {counts['the same code']} with the same machine code and "
          f"{counts['not C']} that cannot be built")
    return counts["survived"], needed


def report_killers(fates):
    killers = [fate.split()[2:] for fate in fates if fate.startswith("killed")]
    alone = collections.Counter(names[0] for names in killers if len(names) == 1)
    for name, count in sorted(alone.items()):
        print(f"{count:4} {name}")
    programs = {name.split(":")[0] for names in killers for name in names}
    never = sorted(programs - {name.split(":")[0] for name in alone})
    print(f"{len(alone)} functions alone noticed some; never alone: {' '.join(never)}")


def main():
    parser = argparse.ArgumentParser(description="Changes sources in small places, and runs their tests.")
    parser.add_argument("--sample", type=int, help="only this many mutants, drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--results", help="a file to which each mutant's fate is appended, and read from")
    parser.add_argument("--killers", action="store_true", help="runs all tests, and says which alone noticed mutants")
    parser.add_argument("--work", type=Path, default=ROOT / "build-mutation", help="the folder of the copy")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--known", action="store_true", help="only looks for what is no longer a mutant")
    parser.add_argument("files", nargs="*", metavar="FILE", default=[ROOT / "lib" / "src"])
    arguments = parser.parse_args()
    os.environ.setdefault("TMINI_PATIENCE_S", "10")  # Each test that hangs waits so long (test/host/conftest.py).
    known = known_survivors()
    stale = outdated(known)
    for key in stale:
        print(f"in {KNOWN}, but no longer a mutant: {key}")
    if arguments.known:
        sys.exit(1 if stale else 0)
    mutants = [mutant for path in sources_among(arguments.files) for mutant in mutants_of(path)]
    if not mutants:
        parser.error(f"nothing to change in {' '.join(map(str, arguments.files))}")
    if arguments.sample:  # By hash: a changed line does not change the rest of the sample.
        mutants.sort(key=lambda mutant: hashlib.sha256(f"{arguments.seed} {mutant.key}".encode()).digest())
    copy, results = Copy(arguments.work, arguments.jobs, arguments.killers), Results(arguments.results)
    survivors, needed = try_mutants(mutants, arguments.sample or len(mutants), copy, results, known)
    if arguments.killers:
        report_killers(results.fates.values())
    noticed = [] if arguments.sample else sorted({mutant.key for mutant in mutants} & known.keys() - needed)
    for key in noticed:
        print(f"in {KNOWN}, but a test notices it: {key}")
    sys.exit(1 if survivors or stale or noticed else 0)


if __name__ == "__main__":
    main()
