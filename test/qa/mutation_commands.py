# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Mutants outside the library: of programs, of the Python package, of the viewer. Their tests are commands of ctest,
which are told by their environment to use what has been made with the mutant."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

PYTHON_REPLACEMENTS = [
    (r"(?<![<>=!-])<(?![<=])", ["<=", ">="]), (r"<=", ["<", ">"]), (r"(?<![->])>(?![>=])", [">=", "<="]),
    (r"(?<!>)>=", [">", "<"]), (r"==", ["!="]), (r"!=", ["=="]), (r"\band\b", ["or"]), (r"\bor\b", ["and"]),
    (r"\bnot (?!in\b)", [""]), (r"\bnot in\b", ["in"]), (r"\bis not\b", ["is"]), (r"\bis (?!not\b)", ["is not "]),
    (r"\bTrue\b", ["False"]), (r"\bFalse\b", ["True"]), (r"(?<= )\+(?= )", ["-"]), (r"(?<= )-(?= )", ["+"]),
    (r"(?<= )\*(?= )", ["//"]), (r"(?<= )//?(?= )", ["*"]), (r"(?<= )%(?= )", ["+"]), (r"\+=", ["-="]), (r"-=", ["+="]),
    (r"(?<![\w.])\d+(?![\w.])", ["{0} + 1", "{0} - 1"]), (r"\breturn (?=[^N\n])", ["return not "]),
    (r"\bif (?=.*:$)", ["if not "]), (r"^ +(?:[a-z_][\w.\[\]]*\(.*\)|[\w.]+ [-+]?= .*)$", ["pass"]),
]

SCRIPT_REPLACEMENTS = [
    (r"(?<![<>=!-])<(?![<=])", ["<=", ">="]), (r"<=(?!=)", ["<", ">"]), (r"(?<![->=])>(?![>=])", [">=", "<="]),
    (r"(?<![>=])>=(?!=)", [">", "<"]), (r"===", ["!=="]), (r"!==", ["==="]), (r"&&", ["||"]), (r"\|\|", ["&&"]),
    (r"\?\?", ["&&"]), (r"(?<=[( =&|])!(?=[a-z(])", [""]), (r"\btrue\b", ["false"]), (r"\bfalse\b", ["true"]),
    (r"(?<= )\+(?= )", ["-"]), (r"(?<= )-(?= )", ["+"]), (r"(?<= )\*(?= )", ["/"]), (r"(?<= )/(?= )", ["*"]),
    (r"(?<= )%(?= )", ["*"]), (r"\+=", ["-="]), (r"-=", ["+="]), (r"\+\+", ["--"]),
    (r"(?<![\w.#])\d+(?![\w.])", ["{0} + 1", "{0} - 1"]), (r"\bif \((?=.*\) \{$)", ["if (true || ", "if (false && "]),
    (r"^ +(?:await )?[a-z][\w.#]*\(.*\);$", [";"]), (r"^ +(?:this\.)?[\w.#]+ = .*;$", [";"]),
]

REPLACEMENTS = {".py": PYTHON_REPLACEMENTS, ".js": SCRIPT_REPLACEMENTS}


def blanked(path, text):
    """The text with blanks instead of comments and strings."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    if path.endswith(".py"):
        return re.sub(r'[rbf]*""".*?"""|[rbf]*"(?:\\.|[^"\\\n])*"|[rbf]*\'(?:\\.|[^\'\\\n])*\'|#[^\n]*', blank, text,
                      flags=re.DOTALL)
    return re.sub(r"/\*.*?\*/|//[^\n]*|'(?:\\.|[^'\\\n])*'|\"(?:\\.|[^\"\\\n])*\"", blank, text, flags=re.DOTALL)


class Program:
    """A program in C. Its objects are linked anew, with the changed one in front of all libraries."""

    def __init__(self, target):
        self.target = target

    def make(self, bench, test, source, folder):
        target = Path(bench.work, folder, self.target)
        target.parent.mkdir(parents=True, exist_ok=True)
        if not bench.compile(test, source, f"{target}.o", "-O1", "-c"):
            return None
        _, words = bench.build.link_of(self.target)
        place, own = bench.build.folder, os.path.realpath(test.object)
        words = [word for word in words if os.path.realpath(os.path.join(place, word)) != own]
        at = words.index("-o")
        subprocess.run([*words[:at], f"{target}.o", "-o", target, *words[at + 2:]], cwd=place, check=True)
        return str(target)

    def use(self, build, product, words, settings):
        original, _ = build.link_of(self.target)
        return ([product if word == original else word for word in words],
                {name: product if value == original else value for name, value in settings.items()})


class Package:
    """The Python package, as test/python/run.sh has installed it, with one module changed."""

    @staticmethod
    def environment(build):
        return Path(build.folder, "test", "python", "venv")

    def make(self, bench, _test, source, folder):
        target = Path(bench.work, folder, "site", "tmini")
        installed = next(self.environment(bench.build).glob("lib/*/site-packages/tmini"), None)
        if installed is None:
            raise SystemExit("Run the test `python` first: it installs the package.")
        shutil.copytree(installed, target, dirs_exist_ok=True)
        shutil.copytree(ROOT / "port" / "python" / "tmini", target, dirs_exist_ok=True)
        shutil.copy(source, target)
        compiled = subprocess.run([sys.executable, "-B", "-c", f"compile(open({str(source)!r}).read(), '', 'exec')"],
                                  stderr=subprocess.DEVNULL, check=False)
        return str(target.parent) if compiled.returncode == 0 else None

    def use(self, build, product, _words, settings):
        words = [str(self.environment(build) / "bin" / "python"), "-m", "pytest", "-q", "-n", "4", "-p",
                 "no:cacheprovider", str(ROOT / "test" / "python")]
        programs = {"TMINI_TOOL": f"{build.folder}/bin/tmini", "TMINI_SIM": f"{build.folder}/bin/tmini-sim"}
        return words, {**settings, **programs, "PYTHONPATH": product, "PYTHONDONTWRITEBYTECODE": "1"}


class Viewer:
    """The page, put together with one module changed."""

    def make(self, bench, _test, source, folder):
        pages, web = Path(bench.work, folder, "page"), ROOT / "examples" / "web"
        shutil.copytree(web / "page", pages, dirs_exist_ok=True)
        shutil.copy(source, pages)
        library = Path(bench.build.folder, "examples", "web", "tmini.wasm")
        done = subprocess.run([sys.executable, "-B", web / "bundle.py", pages, library, "0", pages / "tmini.html"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        return str(pages / "tmini.html") if done.returncode == 0 else None

    def use(self, _build, product, words, settings):
        return words, {**settings, "TMINI_PAGE": product}


# Folders, what is made with a change there, and the tests that use that.
PLACES = [
    ("examples/host/", Program("tmini_tool"), r"^host\."),
    ("port/posix/", Program("tmini_tool"), r"^host\."),
    ("test/simulator/", Program("tmini-sim"), r"^host\."),
    ("examples/obstacle_stop/", Program("obstacle_stop"), r"^host\.obstacle_stop$"),
    ("port/python/tmini/", Package(), r"^python$"),
    ("examples/web/page/", Viewer(), r"^browser\."),
]


class Command:
    """A test of ctest that is no program of Unity."""

    def __init__(self, description, maker, entry, build):
        self.name, self.words = description["name"], description["command"]
        properties = {item["name"]: item["value"] for item in description["properties"]}
        self.settings = dict(word.split("=", 1) for word in properties.get("ENVIRONMENT", []))
        self.maker, self.build, self.entry = maker, build, entry
        self.object, self.compiler, self.flags = build.compiled(entry)
        self.variant, self.program = maker, None
        self.seconds, self.kills = 20.0, 0

    def promise(self, path):
        module = re.sub(r"^(?:command_|tmini_|_)|\.\w+$", "", os.path.basename(path))
        return (module not in self.name, -(self.kills + 1) / self.seconds, self.name)

    def run(self, product, work, *options):
        """Exit status and output; 1 if it takes much longer than with the original."""
        words, settings = self.maker.use(self.build, product, self.words, self.settings)
        words = [f"--basetemp={work}/{self.name}" if word.startswith("--basetemp") else word for word in words]
        words += options if "pytest" in words else []
        settings = {**os.environ, **settings, "TMINI_PATIENCE_S": "10"}
        with subprocess.Popen(words, cwd=work, env=settings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, preexec_fn=os.setpgrp) as process:
            try:
                output = process.communicate(timeout=20 + 10 * self.seconds)[0]
                return abs(process.returncode), output.decode(errors="replace")
            except subprocess.TimeoutExpired:
                return 1, ""
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)  # Also what it has started.


def commands_of(build, source):
    """The commands that test this source."""
    for place, maker, pattern in PLACES:
        if source.startswith(place):
            target = f"/{getattr(maker, 'target', '')}.dir/"
            entries = sorted(build.entries_of(source), key=lambda entry: target not in entry["command"])
            entry = (entries + [{"file": str(ROOT / source)}])[0]
            for description in build.ctests():
                if re.search(pattern, description["name"]):
                    yield Command(description, maker, entry, build)
