#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Changes the sources in one small place at a time, and checks that a test notices the change.

    mutation.py --build DIR [--sample N [--seed S] [--tolerate N]] [--results FILE] [--jobs N] [--list] [FILE …]

DIR is a build folder with the tests, configured with CMAKE_EXPORT_COMPILE_COMMANDS=ON (as test/run.sh does).
FILE is a source in lib/src or port, a public header, or a folder of these; lib/src by default. Changes to the
library are tried with all of test/unit, changes to a port with that port's tests. It may also be a source of the tool,
of the simulated lidar, of the Python package or of the viewer: mutation_commands.py. With --results, a run that was
stopped can be continued.

A test is linked only once, with the source as a shared object: each mutant costs only one quick compilation. Tests
named like the source run first, then those that have killed the most mutants per time. A test that runs much longer
than with the original is stopped and counts as failed. A mutant that survives is not counted if its optimised machine
code equals the original's.

A mutant that no test notices is an error, unless test/qa/mutants.txt lists it with the reason why no test can, or
--tolerate allows that many in a sample.
An entry there is an error if its mutant no longer exists or, without --sample, if a test notices it.
"""

import argparse
import collections
import contextlib
import functools
import glob
import hashlib
import itertools
import json
import multiprocessing
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, ".ci"))
import single  # noqa: E402  The library as one source.
import mutation_commands as elsewhere  # noqa: E402

PUBLIC = os.path.join("lib", "include", "")
KNOWN = os.path.join(ROOT, "test", "qa", "mutants.txt")

# Patterns and their replacements: operators and constants that programmers often confuse.
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
    # Types that may be too narrow for a counter or a time.
    (r"\b(?:size_t|uint32_t|unsigned)(?= \w+(?: = |;|,|\)))", ["uint16_t", "uint8_t"]),
    (r"\buint16_t(?= \w+(?: = |;|,|\)))", ["uint8_t"]),
    (r"\btrue\b", ["false"]), (r"\bfalse\b", ["true"]),
    (r"(?<=[( ,+&|<>=-])!(?=[a-z(])", [""]),
    (r"\b(?:0x[0-9A-Fa-f]+|\d+)(?=[uU]?\b)", ["{0} + 1", "{0} - 1"]),
    (r"\bif \((?=.*\) \{$)", ["if (true || ", "if (false && "]),
    (r"\breturn (?=[a-z(!].*;$)", ["return !"]),
    (r"^ +(?!return|const|case|default|break|continue|static|uint|size_t|int|bool|unsigned|tmini_\w+_t |for|while)"
     r"[a-z(*][^=]*(?:=(?!=).*)?;$", [";"]),
]


def code_only(text):
    """Replaces comments, strings and preprocessor lines by blanks, so that all other code keeps its place."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    text = re.sub(r"/\*.*?\*/|//[^\n]*", blank, text, flags=re.DOTALL)
    text = re.sub(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, text)
    return re.sub(r"^#\s*(?!define\s+\w+ [-(]*\d)[^\n]*(?:\\\n[^\n]*)*", blank, text, flags=re.MULTILINE)


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def function_at(lines, line):
    """The name of the function that contains a line; "-" outside of functions."""
    if lines[line].startswith("}"):
        return "-"
    for above in reversed(lines[:line + 1]):
        match = re.match(r"[A-Za-z_][^;=]*?\b(\w+)\(", above)
        if match:
            return match.group(1)
        if above.startswith("}"):
            break
    return "-"


def change_of(old, begin, end, replacement):
    """Describes the change with the operands around it, so that an entry in mutants.txt names one place."""
    if replacement in (";", "pass"):
        return f"{' '.join(old[begin:end].split('(')[0].split('=')[0].split())} removed"
    words = [match.span() for match in re.finditer(r"\S+", old)]
    last = next(i for i, span in enumerate(words) if span[1] >= end)
    first = max(i for i, span in enumerate(words) if span[0] <= begin)
    is_word = lambda i: re.search(r"\w", old[slice(*words[i])])
    if not re.match(r"u?int|size_t|unsigned", old[begin:]):  # A type needs no word before it.
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
        self.function = function_at(lines, line)
        self.key = f"{path} | {self.function} | {change_of(old, begin, end, replacement)}"
        self.id = hashlib.sha256(f"{path}\n{self.text}".encode()).hexdigest()[:16]

    def __str__(self):
        return f"{self.path}:{self.line + 1}: {self.before}  ->  {self.after}"


def mutants_of(path):
    text = read(path)
    lines = text.split("\n")
    found = {}
    kind = os.path.splitext(path)[1]
    code = elsewhere.blanked(path, text) if kind in elsewhere.REPLACEMENTS else code_only(text)
    for number, line in enumerate(code.split("\n")):
        line = line.rstrip()  # The blanks of a comment after a statement.
        for pattern, replacements in elsewhere.REPLACEMENTS.get(kind, REPLACEMENTS):
            for match in re.finditer(pattern, line):
                for replacement in replacements:
                    begin = match.end() - len(match.group(0).lstrip())
                    mutant = Mutant(path, number, begin, match.end(), replacement.format(match.group(0)), lines)
                    found[mutant.id] = mutant
    return list(found.values())


def arguments_of(entry):
    """The compiler's command line, without source, object, and options for dependencies and caches."""
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
        elif word not in ("-MD", "-c", "-Werror") and \
                os.path.abspath(os.path.join(entry["directory"], word)) != os.path.abspath(entry["file"]):
            kept.append(word)
    return kept + ["-w", "-g0"]


def object_of(entry):
    words = shlex.split(entry["command"])
    return os.path.join(entry["directory"], words[words.index("-o") + 1])


def files_of(folder):
    return sorted(os.path.relpath(file, ROOT) for kind in ("c", "cpp", "h", "py", "js")
                  for file in glob.glob(os.path.join(glob.escape(os.path.join(ROOT, folder)), "*." + kind)))


def has_functions(path):
    return re.search(r"^\{|^\s*(?:async )?(?:def|function) ", read(path), re.MULTILINE)


def sources_with(path):
    """The file itself if it is a source, and the sources in its folder that include it."""
    found = {path}
    if not path.endswith((".c", ".cpp", ".h")):
        return [path]
    for _ in files_of(os.path.dirname(path)):  # One round for each file in a chain of inclusions.
        names = [f'#include "{os.path.basename(file)}"' for file in found]
        found |= {file for file in files_of(os.path.dirname(path)) if any(name in read(file) for name in names)}
    return sorted(file for file in found if not file.endswith(".h"))


class Unable(Exception):
    """An error that makes it impossible to test mutants."""


class Build:
    """The content of the build folder: command lines of the compiler, and object files of test programs."""

    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        with open(os.path.join(self.folder, "compile_commands.json"), encoding="utf-8") as file:
            self.entries = json.load(file)
        self.entry_of = {os.path.realpath(object_of(entry)): entry for entry in self.entries}
        self.archives, self.folders = [], []
        for place, folders, files in os.walk(self.folder):  # Does not follow links, which may form a circle.
            if "CMakeCache.txt" in files and place != self.folder:
                folders.clear()  # This is another build.
                continue
            self.archives += [os.path.join(place, file) for file in sorted(files) if file.endswith(".a") and
                              os.path.isdir(os.path.join(place, "CMakeFiles", file[3:-2] + ".dir"))]  # By this build.
            self.folders += [os.path.join(place, name) for name in sorted(folders) if re.match(r"test_.*\.dir$", name)]

    @functools.cache
    def objects_of(self, folder):
        """The object files of a program, whose folder in CMakeFiles this is. If it is compiled for interrupts at each
        access, the library that has them belongs to it, unless it compiles the library itself."""
        own = [path for path in self.entry_of if path.startswith(os.path.realpath(folder) + os.sep)]
        entries = [self.entry_of[path] for path in own]
        if any("interrupting_atomic.h" in entry["command"] for entry in entries) and \
                not any("/lib/src/" in entry["file"] for entry in entries):
            own += [path for path in self.entry_of if "/tmini_interrupted.dir/" in path]
        return own

    @functools.cache
    def link_of(self, target):
        """The program's name, and the command that links it in the build folder. Only Ninja tells it."""
        ninja = pathlib.Path(self.folder, "build.ninja")
        if not ninja.exists():
            raise Unable(f"{self.folder} was not configured for Ninja: {target} cannot be linked again")
        program = re.search(rf"^build (\S+): \w+_EXECUTABLE_LINKER__{target}_", ninja.read_text(), re.MULTILINE)[1]
        command = subprocess.run(["ninja", "-t", "commands", "-s", program], cwd=self.folder, check=True,
                                 capture_output=True, text=True).stdout
        return os.path.join(self.folder, program), shlex.split(command)[2:-2]  # ": && COMMAND && :"

    @staticmethod
    def compiled(entry):
        """Its object, and the compiler with the options; nothing of what is not compiled."""
        if "command" not in entry:
            return None, None, []
        compiler, *flags = arguments_of(entry)
        return object_of(entry), compiler, flags

    @functools.cache
    def ctests(self):
        listed = subprocess.run(["ctest", "--test-dir", self.folder, "-C", "All", "--show-only=json-v1"], check=True,
                                capture_output=True, text=True).stdout
        return json.loads(listed[listed.index("{"):])["tests"]

    def entries_of(self, source):
        path = os.path.realpath(os.path.join(ROOT, source))
        return [entry for entry in self.entries if os.path.realpath(entry["file"]) == path]

    def tests_of(self, source):
        """The tests of a source, each with the command line that compiles the source for it."""
        place = "unit" if source.startswith("lib/") else os.path.dirname(source).removeprefix("test/")
        place = place.removeprefix("examples/").replace("/", "[/_]")
        entries = self.entries_of(source)
        own = {os.path.realpath(object_of(entry)): entry for entry in entries}
        is_library = re.compile(r".*/tmini_simulator\.dir/" if source.startswith("test/") else
                                r"(?!.*/examples/|" + re.escape(os.path.join(self.folder, "test", "")) + ")")
        library = [entry for entry in entries if is_library.match(object_of(entry))]
        for folder in self.folders:
            linked = [own[obj] for obj in self.objects_of(folder) if obj in own]
            entry = (linked + library + [None])[0]
            name = os.path.basename(folder)[:-len(".dir")]
            if re.search(f"/test/.*{place}/", folder) and entry and \
                    os.path.exists(os.path.join(self.folder, "test", "bin", name)):
                yield Test(name, folder, entry)
        yield from elsewhere.commands_of(self, source)


class Test:
    def __init__(self, name, folder, entry):
        self.name, self.folder, self.entry = name, folder, entry
        self.compiler, *self.flags = arguments_of(entry)
        self.variant = hashlib.sha256(f"{entry['file']} {self.flags}".encode()).hexdigest()[:16]
        self.program = None  # Linked when first needed.
        self.seconds = 6.0  # Processor time with the original; an estimate until the test has run.
        self.kills = 0

    def work_folder(self):
        """The folder in which ctest runs the test, if it needs a folder of its own."""
        place = re.sub(r"CMakeFiles/(\w+)\.dir$", r"\1.work", self.folder)
        return place if os.path.isdir(place) else None

    def promise(self, path):
        module = re.sub(r"^tmini_|\.\w+$", "", os.path.basename(path))
        return (module not in self.name, -(self.kills + 1) / self.seconds, self.name)


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Bench:
    """Compiles mutants, and runs tests with them. Each process has one, with a separate work folder."""

    def __init__(self, build, work):
        self.build, self.work = Build(build), work
        self.tests, self.originals = {}, {}
        self.compiler, self.library, self.original_library = None, None, None  # Used for mutants of headers.

    def tests_of(self, path):
        if path not in self.tests:
            self.tests[path] = [test for source in sources_with(path) for test in self.build.tests_of(source)]
            if not self.tests[path]:
                raise Unable(f"{self.build.folder} has no test of {path}")
        return self.tests[path]

    @contextlib.contextmanager
    def changed(self, mutant):
        """Writes the mutant to a folder with links to the other files of its folder, which may include it."""
        folder = os.path.join(self.work, os.path.dirname(mutant.path))
        if not os.path.isdir(folder):
            os.makedirs(folder)
            for file in files_of(os.path.dirname(mutant.path)):
                os.symlink(os.path.join(ROOT, file), os.path.join(self.work, file))
        place = os.path.join(self.work, mutant.path)
        os.remove(place)
        with open(place, "w", encoding="utf-8") as file:
            file.write(mutant.text)
        yield
        os.remove(place)
        os.symlink(os.path.join(ROOT, mutant.path), place)

    def changed_source(self, test):
        return os.path.join(self.work, os.path.relpath(os.path.realpath(test.entry["file"]), os.path.realpath(ROOT)))

    def compile(self, test, source, target, *options):
        os.makedirs(os.path.dirname(target), exist_ok=True)
        return subprocess.run([test.compiler, *test.flags, *options, source, "-o", target],
                              cwd=test.entry["directory"], stderr=subprocess.DEVNULL, check=False).returncode == 0

    def compile_shared(self, test, source, folder):
        """Compiles without optimisation, which is fastest. Tests load mutant.so from any folder."""
        if isinstance(test, elsewhere.Command):
            return test.maker.make(self, test, source, folder)
        target = os.path.join(self.work, folder, test.variant, "mutant.so")
        is_compiled = self.compile(test, source, target, "-O0", "-fPIC", "-shared", "-Wl,-soname,mutant.so")
        return target if is_compiled else None

    def optimised(self, test, source):
        target = os.path.join(self.work, "optimised.o")
        if not test.compiler:
            return read(source)
        self.compile(test, source, target, "-O2", "-c")
        with open(target, "rb") as file:
            return file.read()

    def is_same_code(self, tests):
        """True if the optimised code is unchanged for all command lines that compile the source for the tests."""
        for variant, test in {test.variant: test for test in tests}.items():
            if variant not in self.originals:
                self.originals[variant] = self.optimised(test, test.entry["file"])
            if self.optimised(test, self.changed_source(test)) != self.originals[variant]:
                return False
        return True

    def link(self, test):
        """Links a test, checks that it passes with the original, and measures its time."""
        original = self.compile_shared(test, test.entry["file"], "original")
        if isinstance(test, elsewhere.Command):
            self.begin_command(test, original)
            return
        test.program = os.path.join(self.work, os.path.dirname(original), test.name)
        objects = [obj for obj in self.build.objects_of(test.folder) if obj != os.path.realpath(object_of(test.entry))]
        subprocess.run([test.compiler, "-o", test.program, *objects, "-Wl,--no-as-needed", original,
                        "-Wl,--start-group", *self.build.archives, "-Wl,--end-group", "-lm", "-lpthread"], check=True)
        self.measure(test, original)

    def begin_command(self, test, original):
        begun = time.monotonic()
        test.program = test.name
        status, output = test.run(original, self.work)
        if status != 0:
            raise Unable(f"{test.name} fails without any mutant:\n{output}")
        test.seconds = time.monotonic() - begun

    def run(self, test, shared):
        """Exit status and output. A signal ends a test that computes or waits much longer than usual."""
        if isinstance(test, elsewhere.Command):
            return test.run(shared, self.work, "-x")
        try:
            done = subprocess.run([test.program], cwd=test.work_folder() or self.work, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, errors="replace", check=False,
                                  env={**os.environ, "LD_LIBRARY_PATH": os.path.dirname(shared)},
                                  preexec_fn=lambda: signal.setitimer(signal.ITIMER_PROF, 0.25 + 4 * test.seconds),
                                  timeout=20 + 20 * test.seconds)
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return -signal.SIGKILL, ""

    def passes(self, test, shared):
        """True if the test passes. A test that fails is run again: some tests depend on the real time."""
        status = self.run(test, shared)[0]
        return status == 0 or status > 0 and self.run(test, shared)[0] == 0

    def measure(self, test, original):
        """The test must pass with the original; measures its time."""
        before = cpu_seconds()
        if not self.passes(test, original):
            raise Unable(f"{test.name} fails without any mutant")
        test.seconds = max(cpu_seconds() - before, 0.001)

    # A public header is part of the library and of the tests: all code that it changes is recompiled.

    def with_headers(self, entry):
        """The command line with the public headers from the folder of copies, one of which is changed."""
        folder = os.path.join(self.work, PUBLIC)
        original = os.path.realpath(os.path.join(ROOT, PUBLIC))
        return [f"-I{folder}" if word[:2] == "-I" and os.path.realpath(word[2:]) == original else word
                for word in arguments_of(entry)]

    def object_with(self, arguments, entry, option, folder):
        """Compiles an object file; returns None if it does not compile."""
        target = os.path.join(self.work, folder, option, hashlib.sha256(object_of(entry).encode()).hexdigest() + ".o")
        os.makedirs(os.path.dirname(target), exist_ok=True)
        done = subprocess.run([*arguments, option, "-fPIC", "-c", os.path.realpath(entry["file"]), "-o", target],
                              cwd=entry["directory"], stderr=subprocess.DEVNULL, check=False)
        return target if done.returncode == 0 else None

    def headers_of(self, entry):
        """The names of the public headers that a source includes, directly or indirectly."""
        rule = subprocess.run([*arguments_of(entry), "-MM", os.path.realpath(entry["file"])], check=True,
                              cwd=entry["directory"], capture_output=True, text=True).stdout
        return {os.path.basename(word) for word in rule.split() if PUBLIC in word}

    def recompiled(self, header, entry, option="-O0"):
        """The object with the changed header (None if it does not compile), and whether it has changed."""
        key = (object_of(entry), option)
        if key not in self.originals:
            original = self.object_with(arguments_of(entry), entry, option, "original")
            self.originals[key] = original, pathlib.Path(original).read_bytes(), self.headers_of(entry)
        original, code, headers = self.originals[key]
        if os.path.basename(header) not in headers:
            return original, False
        target = self.object_with(self.with_headers(entry), entry, option, "recompiled")
        return target, target is None or pathlib.Path(target).read_bytes() != code

    def relink(self, test, objects):
        """Links a test with the library as a shared object, which may be in any folder."""
        test.program = os.path.join(self.work, "relinked", test.name)
        os.makedirs(os.path.dirname(test.program), exist_ok=True)
        subprocess.run([test.compiler, "-o", test.program, *objects, "-Wl,--no-as-needed", self.original_library,
                        "-Wl,--start-group", *self.build.archives, "-Wl,--end-group", "-lm"], check=True)

    def recompiled_library(self, header, folder):
        """The library (None if it does not compile), and whether it has changed."""
        library = os.path.join(self.work, folder, "mutant.so")
        target, is_other = self.recompiled(header, self.library)
        os.makedirs(os.path.dirname(library), exist_ok=True)
        if target is not None:
            subprocess.run([self.compiler, "-shared", "-Wl,-soname,mutant.so", target, "-o", library], check=True)
        return library if target is not None else None, is_other

    def recompiled_objects(self, header, test):
        """The parts of a test without the library: command line, object, and whether it has changed."""
        own = [self.build.entry_of[obj] for obj in self.build.objects_of(test.folder)]
        own += [entry for entry in self.build.entries if entry["file"].endswith("/test/support/receiver.c")]
        return [(entry, *self.recompiled(header, entry)) for entry in own]

    def begin_headers(self, compiler):
        """Builds the library, as one source."""
        text = single.single({os.path.basename(path): read(path) for path in files_of("lib/src")}, "")
        source = pathlib.Path(self.work, "tmini_all.c")
        source.write_text(text, encoding="utf-8")
        shutil.copytree(os.path.join(ROOT, PUBLIC), os.path.join(self.work, PUBLIC))
        entry = self.build.entries_of("lib/src/tmini_ring.c")[0]
        self.library = {**entry, "file": str(source), "command": entry["command"].replace(entry["file"], str(source))}
        self.compiler = compiler
        self.original_library, _ = self.recompiled_library("", "")

    def preprocessed(self, header):
        """The header after preprocessing, for each set of macros with which it is included."""
        ways = {tuple(word for word in arguments_of(entry) if word.startswith("-D")) for entry in self.build.entries
                if "/test/unit/" in entry["directory"] + entry["file"]}
        return [subprocess.run([self.compiler, "-E", "-P", "-dD", "-I" + os.path.join(ROOT, "test", "support"), *way,
                                header], check=True, capture_output=True).stdout for way in sorted(ways)]

    def notice_recompiled(self, header, library, is_other):
        """The first test that notices a changed header, and what else than the library the header changes. None
        instead of the latter if something does not compile."""
        different = []
        for test in sorted(self.tests_of("lib/src/tmini_ring.c"), key=lambda test: test.promise(header)):
            made = self.recompiled_objects(header, test)
            if any(target is None for _, target, _ in made):
                return None, None
            others = [entry for entry, _, is_changed in made if is_changed]
            different += others
            if others or is_other:
                if test.program is None:
                    self.relink(test, [target for _, target, _ in self.recompiled_objects("", test)])
                    self.measure(test, self.original_library)
                self.relink(test, [target for _, target, _ in made])
                if not self.passes(test, library):
                    return test, different
        return None, different

    def fate_of_header(self, mutant):
        if not self.original_library:
            self.begin_headers(self.tests_of("lib/src/tmini_ring.c")[0].compiler)
        changed = os.path.join(self.work, mutant.path)
        pathlib.Path(changed).write_text(mutant.text, encoding="utf-8")
        try:
            if self.preprocessed(changed) == self.preprocessed(os.path.join(ROOT, mutant.path)):
                return "the same code"
            library, is_other = self.recompiled_library(mutant.path, "recompiled")
            if library is None:
                return "not C"
            test, different = self.notice_recompiled(mutant.path, library, is_other)
            if different is None:
                return "not C"
            if test is not None:
                test.kills += 1
                return "killed by " + test.name
            different += [self.library] if is_other else []
            is_other = any(self.recompiled(mutant.path, entry, "-O2")[1] for entry in different)
            return "survived" if is_other else "the same code"
        finally:
            shutil.copy(os.path.join(ROOT, mutant.path), changed)

    def fate(self, mutant):
        """Returns 'killed by …', 'survived', 'the same code' or 'not C'."""
        if mutant.path.startswith(PUBLIC):
            return self.fate_of_header(mutant)
        if mutant.path.endswith(".c") and not self.build.entries_of(mutant.path):
            return "not C"  # Here it is not compiled.
        tests = sorted(self.tests_of(mutant.path), key=lambda test: test.promise(mutant.path))
        is_other = False  # Checked only before the first test that takes long.
        with self.changed(mutant):
            shared = {}
            for test in tests:
                if test.program is None:
                    self.link(test)
                if not is_other and test.seconds > 0.5:
                    if self.is_same_code(tests):
                        return "the same code"
                    is_other = True
                if test.variant not in shared:
                    shared[test.variant] = self.compile_shared(test, self.changed_source(test), "changed")
                if shared[test.variant] is None:
                    return "not C"
                if not self.passes(test, shared[test.variant]):
                    test.kills += 1
                    return "killed by " + test.name
            return "survived" if is_other or not self.is_same_code(tests) else "the same code"


def open_to_all(folder):
    """A test runs the tool as another user, who must find it."""
    os.chmod(folder, 0o755)
    return folder


def begin_worker(build, work):
    global bench
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    bench = Bench(build, open_to_all(tempfile.mkdtemp(dir=work)))


def fate_of(mutant):
    return bench.fate(mutant)


class Results:
    """The fates of mutants, which are stored in a file if one is given."""

    def __init__(self, path):
        self.path, self.fates = path, {}
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.fates = {key: fate for key, fate, _ in (line.split("\t", 2) for line in file)}

    def note(self, mutant, fate):
        if self.path and mutant.id not in self.fates:
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(f"{mutant.id}\t{fate}\t{mutant}\n")

    def of(self, mutants, pool):
        """The mutants with their fates, in order; tries those whose fate is not stored."""
        fresh = pool.imap(fate_of, [mutant for mutant in mutants if mutant.id not in self.fates])
        for mutant in mutants:
            fate = self.fates.get(mutant.id) or next(fresh)
            self.note(mutant, fate)
            yield mutant, fate


def known_survivors():
    known = {}
    with open(KNOWN, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                place, reason = line.rstrip("\n").rsplit(" | ", 1)
                code, *changes = place.split(" -> ")
                known.update((f"{code} -> {change}", reason) for change in changes)
                if not changes:  # "code removed"
                    known[code] = reason
    return known


def outdated(known):
    """The entries whose mutants no longer exist, because their lines have changed."""
    paths = {key.split(" | ")[0] for key in known}
    there = {mutant.key for path in paths if os.path.exists(os.path.join(ROOT, path)) for mutant in mutants_of(path)}
    return [key for key in known if key not in there]


def files_among(names):
    """The named files; and of named folders the public headers and the files with functions, except headers
    that no source there includes."""
    for name in names:
        if os.path.isfile(name):
            yield os.path.relpath(os.path.abspath(name), ROOT)
        for place, folders, _ in os.walk(name):
            folders.sort()
            yield from (file for file in files_of(os.path.abspath(place))
                        if file.startswith(PUBLIC) or has_functions(file) and sources_with(file) and
                        not os.path.basename(file).startswith("test_"))


def try_mutants(mutants, wanted, pool, results, known):
    """Tries mutants until there are `wanted` that tests could notice. Returns how many of these survived, and the
    entries of mutants.txt that were needed."""
    counts, needed = collections.Counter(), set()
    tried = lambda: counts["killed"] + counts["survived"] + counts["equivalent"]
    remaining = iter(mutants)
    while batch := list(itertools.islice(remaining, wanted - tried())):
        for mutant, fate in results.of(batch, pool):
            if mutant.key in known and fate in ("survived", "the same code"):
                needed.add(mutant.key)
            if fate == "survived" and mutant.key in known:
                fate = "equivalent"
            if fate == "survived":
                print(f"survived: {mutant}", flush=True)
            counts[fate.partition(" by ")[0]] += 1
    print(f"{tried()} mutants: {counts['killed']} killed, {counts['equivalent']} known to be equivalent, "
          f"{counts['survived']} survived; also {counts['the same code']} with the same machine code and "
          f"{counts['not C']} that do not compile")
    return counts["survived"], needed


def add_arguments(parser):
    parser.add_argument("--build", required=True)
    parser.add_argument("--sample", type=int, help="only this many mutants, drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("files", nargs="*", metavar="SOURCE", default=[os.path.join(ROOT, "lib", "src")])


def mutants_for(arguments):
    mutants = [mutant for path in files_among(arguments.files) for mutant in mutants_of(path)]
    if arguments.sample:  # By hash: a changed line does not change the rest of the sample.
        mutants.sort(key=lambda mutant: hashlib.sha256(f"{arguments.seed} {mutant.key}".encode()).digest())
    return mutants


def main():
    parser = argparse.ArgumentParser(description="Mutates the library or ports and runs their unit tests.")
    add_arguments(parser)
    parser.add_argument("--tolerate", type=int, default=0, help="this many survivors are no error")
    parser.add_argument("--results", help="a file to which each mutant's fate is appended, and read from")
    parser.add_argument("--list", action="store_true", help="only prints the mutants")
    arguments = parser.parse_args()
    mutants = mutants_for(arguments)
    if not mutants:
        parser.error(f"nothing to change in {' '.join(arguments.files)}")
    if arguments.list:
        print(*mutants, f"{len(mutants)} mutants", sep="\n")
        return
    if not os.path.exists(os.path.join(arguments.build, "compile_commands.json")):
        print(f"SKIPPED: {arguments.build} was configured without CMAKE_EXPORT_COMPILE_COMMANDS")
        return
    known = known_survivors()
    stale = outdated(known)
    for key in stale:
        print(f"in {KNOWN}, but no longer a mutant: {key}")
    with tempfile.TemporaryDirectory() as work, \
            multiprocessing.Pool(arguments.jobs, begin_worker, (arguments.build, open_to_all(work))) as pool:
        survivors, needed = try_mutants(mutants, arguments.sample or len(mutants), pool, Results(arguments.results),
                                        known)
    noticed = [] if arguments.sample else sorted({mutant.key for mutant in mutants} & known.keys() - needed)
    for key in noticed:
        print(f"in {KNOWN}, but a test notices it: {key}")
    sys.exit(1 if survivors > arguments.tolerate or stale or noticed else 0)


if __name__ == "__main__":
    main()
