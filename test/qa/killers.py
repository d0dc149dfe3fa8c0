#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Finds the test functions that notice a mutant, and those that alone notice one. Use it before you remove a test.

    killers.py --build DIR [--sample N [--seed S]] [--jobs N] FILE [SOURCE …]

Appends a line to FILE for each mutant of mutation.py: the change, a tab, and the test functions that fail, as
"program:function", or as "program:*" for a program that crashes or does not end. At the end it prints, for each
function, how many mutants only this function noticed, and the programs without such a function. If FILE exists,
the run continues it.
"""

import argparse
import collections
import multiprocessing
import os
import re
import tempfile

import mutation


class Matrix(mutation.Bench):
    """Runs all tests of a mutant, also after one has failed."""

    def failures(self, test, shared):
        status, output = self.run(test, shared)
        failed = re.findall(r":(test_\w+):FAIL", output)
        return [f"{test.name}:{name}" for name in failed or (["*"] if status != 0 else [])]

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
    parser.add_argument("file", metavar="FILE")
    mutation.add_arguments(parser)
    arguments = parser.parse_args()
    lines = read(arguments.file)
    fresh = [mutant for mutant in mutation.mutants_for(arguments)[:arguments.sample] if str(mutant) not in lines]
    with tempfile.TemporaryDirectory() as work, open(arguments.file, "a", encoding="utf-8") as file, \
            multiprocessing.Pool(arguments.jobs, begin_worker, (arguments.build, work)) as pool:
        for mutant, names in pool.imap(killers_of, fresh):
            if names is not None:
                lines[str(mutant)] = names
                print(mutant, " ".join(names), sep="\t", file=file, flush=True)
    report(lines)


if __name__ == "__main__":
    main()
