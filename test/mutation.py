#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Changes the library in one small place at a time, and asks whether a unit test notices.

    mutation.py --build DIR [--sample N [--seed S]] [--results FILE] [--list] [FILE …]

DIR is a build folder with the unit tests in it, configured with CMAKE_EXPORT_COMPILE_COMMANDS=ON (as
test/run.sh does). FILE: sources below lib/src or port, all of lib/src unless given. A mutant is
compiled as its file is, linked with each test's own objects, and the tests run until one fails. One
whose machine code is that of the original is none. With --results a run can be broken off and goes on
where it was.

A mutant that no test notices is a finding, unless test/mutants.txt has it with the reason why nobody can.
"""

import argparse
import glob
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
KNOWN = os.path.join(ROOT, "test", "mutants.txt")
TIME_LIMIT_S = 20

# What is put in the place of what: C's operators and constants, as people confuse them.
REPLACEMENTS = [
    (r"(?<![<>=!-])<(?![<=])", ["<=", ">="]), (r"<=(?!=)", ["<", ">"]),
    (r"(?<![->])>(?![>=])", [">=", "<="]), (r"(?<!>)>=", [">", "<"]),
    (r"==", ["!="]), (r"!=", ["=="]),
    (r"&&", ["||"]), (r"\|\|", ["&&"]),
    (r"(?<![&])&(?![&=])(?= )", ["|"]), (r"(?<!\|)\|(?![|=])", ["&"]), (r"\^(?!=)", ["&"]),
    (r"<<(?!=)", [">>"]), (r"(?<!-)>>(?!=)", ["<<"]),
    (r"(?<= )\+(?= )", ["-"]), (r"(?<= )-(?= )", ["+"]), (r"(?<= )\*(?= )", ["/"]),
    (r"(?<= )/(?= )", ["*"]), (r"(?<= )%(?= )", ["*"]),
    (r"\+\+", ["--"]), (r"--(?!-)", ["++"]),
    (r"\+=", ["-=", "="]), (r"-=", ["+="]), (r"\|=", ["&=", "="]), (r"\^=", ["="]), (r"&=", ["|="]),
    (r"\btrue\b", ["false"]), (r"\bfalse\b", ["true"]),
    (r"(?<=[( ,+&|<>=-])!(?=[a-z(])", [""]),
    (r"\b(?:0x[0-9A-Fa-f]+|\d+)(?=[uU]?\b)", ["{0} + 1", "{0} - 1"]),
    (r"\bif \((?=.*\) \{$)", ["if (true || ", "if (false && "]),
    (r"\breturn (?=[a-z(!].*;$)", ["return !"]),
    (r"^ +(?!return|const|case|default|break|continue|static|uint|size_t|int|bool|unsigned|tmini_\w+_t |for|while)"
     r"[a-z(*][^=]*(?:=(?!=).*)?;$", [";"]),
]


def code_only(text):
    """Comments, strings and preprocessor lines as blanks, everything at its place."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    text = re.sub(r"/\*.*?\*/|//[^\n]*", blank, text, flags=re.DOTALL)
    text = re.sub(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, text)
    return re.sub(r"^#\s*(?!define\s+\w+ [-(]*\d)[^\n]*(?:\\\n[^\n]*)*", blank, text, flags=re.MULTILINE)


class Mutant:
    def __init__(self, path, line, begin, end, replacement, lines):
        self.path, self.line = path, line
        old = lines[line]
        self.before = old.strip()
        new = old[:begin] + replacement + old[end:]
        self.after = new.strip()
        self.text = "\n".join(lines[:line] + [new] + lines[line + 1:])
        self.key = f"{path} | {self.before} | {self.after}"

    def __str__(self):
        return f"{self.path}:{self.line + 1}: {self.before}  ->  {self.after}"


def mutants_of(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        text = file.read()
    lines = text.split("\n")
    found = []
    for number, line in enumerate(code_only(text).split("\n")):
        for pattern, replacements in REPLACEMENTS:
            for match in re.finditer(pattern, line):
                for replacement in replacements:
                    found.append(Mutant(path, number, match.start(), match.end(),
                                        replacement.format(match.group(0)), lines))
    return found


def arguments_of(entry):
    """The compiler's command line, without what is about warnings, dependencies and caches."""
    words = shlex.split(entry["command"])
    while os.path.basename(words[0]) in ("ccache", "sccache"):
        words.pop(0)
    kept = []
    skip = False
    for word in words:
        if skip:
            skip = False
        elif word in ("-MF", "-MT", "-o"):
            skip = True
        elif word not in ("-MD", "-c", "-Werror") and os.path.abspath(os.path.join(entry["directory"], word)) != \
                os.path.abspath(entry["file"]):
            kept.append(word)
    return kept + ["-w", "-g0", "-O1", "-iquote", os.path.dirname(entry["file"])]


def object_of(entry):
    words = shlex.split(entry["command"])
    return os.path.join(entry["directory"], words[words.index("-o") + 1])


class Bench:
    """Compiles a source as the build does, links it into tests, and runs those."""

    def __init__(self, build, work):
        self.build, self.work = build, work
        try:
            with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
                self.commands = json.load(file)
        except FileNotFoundError:
            print(f"SKIPPED: {build} was configured without CMAKE_EXPORT_COMPILE_COMMANDS")
            sys.exit(0)
        self.archives = sorted(glob.glob(os.path.join(build, "**", "*.a"), recursive=True))
        self.originals = {}

    def entries(self, path):
        source = os.path.join(ROOT, path)
        return [entry for entry in self.commands if os.path.realpath(entry["file"]) == os.path.realpath(source)]

    def folders_of_tests(self):
        """Where the unit tests' objects lie. Not through links, which may lead round in a circle."""
        return sorted(os.path.join(place, name)
                      for place, names, _ in os.walk(os.path.join(self.build, "test"))
                      for name in names if name.startswith("test_") and name.endswith(".dir"))

    def tests(self, path):
        """For each unit test: its name, its objects, and how the source is compiled for it."""
        entries = self.entries(path)
        library = [entry for entry in entries if "/test/" not in object_of(entry)[len(self.build):]]
        own = {os.path.dirname(object_of(entry)).split(".dir")[0]: entry for entry in entries if entry not in library}
        found = []
        for folder in self.folders_of_tests():
            name = os.path.basename(folder)[:-4]
            program = glob.glob(os.path.join(self.build, "test", "bin", name))
            entry = own.get(folder[:-4], library[0] if library and "/test/unit/" in folder else None)
            objects = glob.glob(os.path.join(folder, "**", "*.o"), recursive=True)
            if entry and program and objects:
                found.append((name, [obj for obj in objects if obj != object_of(entry)], entry))
        module = os.path.basename(path)[len("tmini_"):-2] if path != "lib/src/tmini.c" else "tmini"
        return sorted(found, key=lambda test: (module not in test[0], "honest" in test[0], test[0]))

    def compile(self, text, entry, name):
        source = os.path.join(self.work, "mutant.c")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        target = os.path.join(self.work, name)
        done = subprocess.run(arguments_of(entry) + ["-c", source, "-o", target], cwd=entry["directory"],
                              capture_output=True, check=False)
        return target if done.returncode == 0 else None

    def code(self, text, entry):
        target = self.compile(text, entry, "code.o")
        if target is None:
            return None
        with open(target, "rb") as file:
            return file.read()

    def passes(self, test, compiled):
        name, objects, _ = test
        program = os.path.join(self.work, name)
        done = subprocess.run(["cc", "-o", program, *objects, compiled, "-Wl,--start-group", *self.archives,
                               "-Wl,--end-group", "-lm", "-lpthread"], capture_output=True, check=False)
        if done.returncode != 0:
            return None
        try:
            return subprocess.run([program], capture_output=True, stdin=subprocess.DEVNULL, timeout=TIME_LIMIT_S,
                                  check=False).returncode == 0
        except subprocess.TimeoutExpired:
            return False
        finally:
            os.remove(program)

    def fate(self, mutant):
        """'killed by …', 'survived', 'the same code' or 'not C'."""
        tests = self.tests(mutant.path)
        if not tests:
            sys.exit(f"{self.build} has no test of {mutant.path}")
        if mutant.path not in self.originals:
            with open(os.path.join(ROOT, mutant.path), encoding="utf-8") as file:
                original = file.read()
            self.originals[mutant.path] = (original, self.code(original, tests[0][2]))
            for test in tests:
                if self.passes(test, self.compile(original, test[2], "original.o")) is False:
                    sys.exit(f"{test[0]} fails without any mutant")
        code = self.code(mutant.text, tests[0][2])
        if code is None:
            return "not C"
        if code == self.originals[mutant.path][1]:
            return "the same code"
        compiled = {}
        for test in tests:
            command = tuple(arguments_of(test[2]))
            if command not in compiled:
                compiled[command] = self.compile(mutant.text, test[2], f"mutant{len(compiled)}.o")
            if compiled[command] is None or self.passes(test, compiled[command]) is False:
                return "killed by " + test[0]
        return "survived"


def known_survivors():
    known = {}
    with open(KNOWN, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                key, reason = line.rstrip("\n").rsplit(" | ", 1)
                known[key] = reason
    return known


def main():
    parser = argparse.ArgumentParser(description="Mutates the library and runs its unit tests.")
    parser.add_argument("--build", required=True)
    parser.add_argument("--sample", type=int, help="only so many mutants, drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--results", help="a file to which each mutant's fate is appended, and read from")
    parser.add_argument("--list", action="store_true", help="only prints the mutants")
    parser.add_argument("files", nargs="*", metavar="FILE")
    arguments = parser.parse_args()
    files = arguments.files or sorted(os.path.relpath(path, ROOT)
                                      for path in glob.glob(os.path.join(glob.escape(ROOT), "lib/src/*.c")))
    mutants = list({mutant.key + str(mutant.line): mutant for path in files for mutant in mutants_of(path)}.values())
    if arguments.sample: # By hash, so that a change of one line does not draw all others anew.
        mutants.sort(key=lambda mutant: hashlib.sha256(f"{arguments.seed} {mutant.key}".encode()).digest())
    if arguments.list:
        print(*mutants, f"{len(mutants)} mutants", sep="\n")
        return
    fates = {}
    if arguments.results and os.path.exists(arguments.results):
        with open(arguments.results, encoding="utf-8") as file:
            fates = dict(line.rstrip("\n").rsplit("\t", 1) for line in file if "\t" in line)
    known = known_survivors()
    survivors, counts = [], {"killed": 0, "survived": 0, "equivalent": 0, "not": 0, "the": 0}
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(os.path.abspath(arguments.build), work)
        for mutant in mutants:
            fate = fates.get(str(mutant)) or bench.fate(mutant)
            if arguments.results and str(mutant) not in fates:
                with open(arguments.results, "a", encoding="utf-8") as file:
                    file.write(f"{mutant}\t{fate}\n")
            if fate == "survived" and mutant.key in known:
                fate = "equivalent"
            if fate == "survived":
                survivors.append(mutant)
                print(f"survived: {mutant}", flush=True)
            counts[fate.split()[0]] += 1
            if arguments.sample and sum(counts[kind] for kind in ("killed", "survived", "equivalent")) == \
                    arguments.sample:
                break
    print(f"{counts['killed'] + counts['survived'] + counts['equivalent']} mutants: {counts['killed']} killed, "
          f"{counts['equivalent']} known to be equivalent, {counts['survived']} survived; besides {counts['the']} "
          f"of the same machine code and {counts['not']} that do not compile")
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
