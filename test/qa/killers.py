#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Finds the test functions that notice a mutant, and those that alone notice one. Use it before you remove a test.

    killers.py --build DIR --sample N [--seed S] [--jobs N] FILE [SOURCE …]

Appends a line to FILE for each mutant of mutation.py: the change, a tab, and the test functions that fail, as
"program:function", or as "program:*" for a program that crashes or does not end. At the end it prints, for each
function, how many mutants only this function noticed, and the programs without such a function. If FILE exists,
the run continues it.
"""

import argparse
import collections
import hashlib
import multiprocessing
import os
import re
import signal
import subprocess
import tempfile

import mutation


class Matrix(mutation.Bench):
    """Runs all tests of a mutant, also after one has failed."""

    def failures(self, test, shared):
        try:
            done = subprocess.run([test.program], cwd=test.work_folder() or self.work, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, errors="replace", check=False,
                                  env={**os.environ, "LD_LIBRARY_PATH": os.path.dirname(shared)},
                                  preexec_fn=lambda: signal.setitimer(signal.ITIMER_PROF, 0.25 + 4 * test.seconds),
                                  timeout=20 + 20 * test.seconds)
        except subprocess.TimeoutExpired:
            return [test.name + ":*"]
        failed = re.findall(r":(test_\w+):FAIL", done.stdout)
        return [f"{test.name}:{name}" for name in failed or (["*"] if done.returncode != 0 else [])]

    def killers(self, mutant):
        """The test functions that fail, or None if the mutant does not compile."""
        found, shared = [], {}
        with self.changed(mutant):
            for test in self.tests_of(mutant.path):
                if test.program is None:
                    self.link(test)
                if test.variant not in shared:
                    shared[test.variant] = self.compile_shared(test, self.changed_source(test), "changed")
                if shared[test.variant] is None:
                    return None
                found += self.failures(test, shared[test.variant])
        return found


def begin_worker(build, work):
    global matrix
    matrix = Matrix(build, tempfile.mkdtemp(dir=work))


def killers_of(mutant):
    return mutant, matrix.killers(mutant)


def read(path):
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return {key: names.split() for key, names in (line.rstrip("\n").split("\t") for line in file)}


def report(lines):
    alone = collections.Counter(names[0] for names in lines.values() if len(names) == 1)
    programs = {name.split(":")[0] for names in lines.values() for name in names}
    for name, count in sorted(alone.items()):
        print(f"{count:4} {name}")
    never = sorted(programs - {name.split(":")[0] for name in alone})
    print(f"{len(lines)} mutants, {sum(1 for names in lines.values() if names)} noticed; "
          f"{len(alone)} functions alone noticed some; never alone: {' '.join(never)}")


def main():
    parser = argparse.ArgumentParser(description="Names the test functions that notice mutants.")
    parser.add_argument("--build", required=True)
    parser.add_argument("--sample", type=int, default=1 << 30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("file", metavar="FILE")
    parser.add_argument("sources", nargs="*", metavar="SOURCE", default=[os.path.join(mutation.ROOT, "lib", "src")])
    arguments = parser.parse_args()
    lines = read(arguments.file)
    mutants = [mutant for path in mutation.files_among(arguments.sources) for mutant in mutation.mutants_of(path)]
    mutants.sort(key=lambda mutant: hashlib.sha256(f"{arguments.seed} {mutant.key}".encode()).digest())
    fresh = [mutant for mutant in mutants[:arguments.sample] if str(mutant) not in lines]
    with tempfile.TemporaryDirectory() as work, open(arguments.file, "a", encoding="utf-8") as file, \
            multiprocessing.Pool(arguments.jobs, begin_worker, (arguments.build, work)) as pool:
        for mutant, names in pool.imap(killers_of, fresh):
            if names is not None:
                lines[str(mutant)] = names
                print(mutant, " ".join(names), sep="\t", file=file, flush=True)
    report(lines)


if __name__ == "__main__":
    main()
