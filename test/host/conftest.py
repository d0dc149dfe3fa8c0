# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the tests of the tool are written with: they type commands and read what a person sees.

    def test_scan_ends_with_a_summary(lidar, tmini):
        port = lidar("--frequency", "9").port          # tmini-sim on a pseudo-terminal; ("--tcp", "0"): on a socket
        run = tmini("scan", "-p", port, "-n", "3")     # to its end: run.status, run.out, run.err
        assert run.err.startswith("scans: 3 ")

A test runs in an empty folder of its own, where `recordings` is test/recordings. `start` begins a program that goes on:
p.wait_for("text"), p.end(SIGINT). `terminal` does it in a terminal: t.wait_for("text"), t.press("q"), t.text.
`talker` and `answerer` are ports with something else than a lidar; `lidar()` has unplug(), freeze(), thaw(), log.

All of them share a clock (shared_clock.c). It stands while any of them works, also while the test does, and jumps when
all wait: nothing ever comes late, and a minute of silence costs nothing. So wait for a text, not for a time; where time
itself matters, clock.sleep(ms) and clock.now_ms(). Writing and reading must go through clock.wait(), as here.

CMakeLists.txt declares a file with tmini_add_pytest(); by hand: ctest --test-dir build -R host.NAME, or, for one test,
`sh build/test/host/pytest test/host/test_NAME.py -k WORDS`.
"""

import contextlib
import ctypes
import errno
import os
import signal
import subprocess
import sys
import tempfile
import termios
from pathlib import Path

import pexpect
import pyte
import pytest

HERE = Path(__file__).resolve().parent
TMINI = os.environ["TMINI_TOOL"]
TMINI_SIM = os.environ["TMINI_SIM"]
PATIENCE_S = int(os.environ.get("TMINI_PATIENCE_S", 60))  # Of real time.
HAS_RIGHTS = os.geteuid() == 0

sys.path.insert(0, str(HERE))
for _number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):  # Those that a background job, or nohup, ignores.
    if signal.getsignal(_number) == signal.SIG_IGN:
        signal.signal(_number, lambda *_: None)  # What is started does not inherit it.


class Poll(ctypes.Structure):
    _fields_ = [("fd", ctypes.c_int), ("events", ctypes.c_short), ("revents", ctypes.c_short)]


class Clock:
    """The clock that the programs of a test share with it."""

    def __init__(self, library, path):
        self.library = ctypes.CDLL(library, use_errno=True)
        self.library.shared_clock_now_ns.restype = ctypes.c_int64
        self.library.shared_clock_waits.restype = ctypes.c_bool
        self.patience = ctypes.c_int.in_dll(self.library, "shared_clock_patience_ms")
        self.path, self.preload = path, library

    def begin(self):
        Path(self.path).write_bytes(bytes(4096))
        self.library.shared_clock_open(os.fsencode(self.path))

    def end(self):
        self.library.shared_clock_open(None)

    def environment(self):
        return {"LD_PRELOAD": self.preload, "TMINI_SHARED_CLOCK": self.path,
                "ASAN_OPTIONS": "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")}

    def expect(self, pid):
        self.library.shared_clock_expect(pid)

    def stop(self, pid):
        """As SIGSTOP: never while the program holds what others need. SIGCONT ends it."""
        self.library.shared_clock_stop(pid)

    def now_ms(self):
        return self.library.shared_clock_now_ns() // 1000000

    def wait(self, fds, timeout_ms=-1, patience_s=PATIENCE_S):
        """The descriptors with input, waiting at most this long; fails when nothing happens in so much real time."""
        self.patience.value = int(1000 * patience_s)
        entries = (Poll * len(fds))(*[Poll(fd, 1, 0) for fd in fds])
        if self.library.poll(entries, len(fds), int(timeout_ms)) < 0:
            number = ctypes.get_errno()
            raise OSError(number, "nothing happens any more" if number == errno.ETIME else os.strerror(number))
        return [entry.fd for entry in entries if entry.revents]

    def sleep(self, milliseconds):
        until = self.now_ms() + milliseconds
        while self.now_ms() < until:
            self.wait([], until - self.now_ms())

    def wait_for_block(self, pid):
        """Until the program waits elsewhere than in poll(), for which the clock stands."""
        state, stands = "", False
        while not (stands and state == "S" and not self.library.shared_clock_waits(pid)):
            try:
                self.wait([], 1000, patience_s=0.1)
                stands = False
            except OSError:
                stands = True
            state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split(") ")[1][0]
            assert state != "Z", "the program has ended"


class Watched:
    """Something whose output the test waits for."""

    def __init__(self, clock):
        self.clock = clock

    def wait_until(self, condition):
        """Reads until condition() holds."""
        until_ms = self.clock.now_ms() + 120000
        while not condition():
            assert self.clock.now_ms() < until_ms and self.read_some(), f"this is all that came:\n{self.all_text()}"

    def wait_for(self, text):
        self.wait_until(lambda: text in self.all_text())


class Program(Watched):
    """A running program; `out` and `err` are what it has printed so far."""

    def __init__(self, clock, words, environment, stdin=subprocess.DEVNULL, expected=True, **options):
        super().__init__(clock)
        self.process = subprocess.Popen(words, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        env=environment, **options)
        if expected:
            clock.expect(self.process.pid)
        self.bytes = {self.process.stdout.fileno(): b"", self.process.stderr.fileno(): b""}
        self.open = set(self.bytes)
        self.status = None

    @property
    def raw_out(self):
        return self.bytes[self.process.stdout.fileno()]

    @property
    def out(self):
        return self.raw_out.decode(errors="replace")

    @property
    def err(self):
        return self.bytes[self.process.stderr.fileno()].decode(errors="replace")

    def all_text(self):
        return self.out + self.err

    def read_some(self, timeout_ms=-1):
        """Reads what there is; False once the program has closed its output."""
        for fd in self.clock.wait(sorted(self.open), timeout_ms) if self.open else []:
            more = os.read(fd, 1 << 16)
            self.bytes[fd] += more
            if not more:
                self.open.discard(fd)
        return bool(self.open)

    def finish(self):
        """Waits for its end."""
        while self.read_some():
            pass
        self.status = self.process.wait(PATIENCE_S)
        assert self.status >= 0, f"ended by signal {-self.status}"
        return self

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        return self.finish()

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


class Lidar(Program):
    """The simulated lidar."""

    def __init__(self, clock, options, environment, log):
        options = list(options)
        options = options if "--tcp" in options else ["--pty", *options]
        options = options if "--log" in options else [*options, "--log", log]
        super().__init__(clock, [TMINI_SIM, *options], environment)
        self.log_path = Path(log)
        self.wait_until(lambda: "\n" in self.out)
        line = self.out.split("\n")[0]
        self.port = line if line.startswith("/") else "tcp:" + line

    @property
    def log(self):
        return self.log_path.read_text()

    def wait_for_log(self, text):
        """The log is complete at each moment at which the clock stands."""
        for _ in range(1000):
            if text in self.log:
                return
            self.clock.sleep(10)
        assert text in self.log

    @contextlib.contextmanager
    def left_scanning(self):
        """As a program leaves it that has not stopped it."""
        line = os.open(self.port, os.O_RDWR | os.O_NOCTTY)
        os.write(line, b"\xA5\x60")
        self.wait_for_log("idle -> scanning")
        yield
        os.close(line)

    def unplug(self):
        self.kill()

    def freeze(self):
        """As if its supply failed: the port stays, and nothing comes."""
        self.clock.stop(self.process.pid)

    def thaw(self):
        self.process.send_signal(signal.SIGCONT)


class Screen(pyte.Screen):
    misunderstood = 0

    def debug(self, *_args, **_options):
        self.misunderstood += 1


class Terminal(Watched):
    """A program in a terminal: `text` is what a person sees, `raw` what the program has printed."""

    def __init__(self, clock, words, environment, columns, rows, expected=True):
        super().__init__(clock)
        self.screen = Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.raw = b""
        self.process = pexpect.spawn(words[0], list(words[1:]), env=environment,
                                     dimensions=(rows, columns), timeout=None)
        self.process.delaybeforesend = None
        self.is_open = True
        if expected:
            clock.expect(self.process.pid)

    @property
    def text(self):
        return "".join(line.rstrip() + "\n" for line in self.screen.display)

    def all_text(self):
        return self.text

    @property
    def is_other_screen(self):
        """Whether it draws on the screen that a terminal has for such programs."""
        return self.raw.rfind(b"\033[?1049h") > self.raw.rfind(b"\033[?1049l")

    def settings(self):
        return termios.tcgetattr(self.process.child_fd)

    def read_some(self, timeout_ms=-1):
        for fd in self.clock.wait([self.process.child_fd], timeout_ms):
            try:
                more = os.read(fd, 1 << 16)
            except OSError:  # How Linux reports that nothing is open any more.
                more = b""
            self.raw += more
            self.stream.feed(more)
            self.is_open = bool(more)
        return self.is_open

    def wait_for(self, text):
        super().wait_for(text)
        self.wait(1)  # Until the whole screen has been drawn: only then the clock moves.

    def wait(self, milliseconds):
        """Shows what comes in this time."""
        until = self.clock.now_ms() + milliseconds
        while self.is_open and self.clock.now_ms() < until:
            self.read_some(until - self.clock.now_ms())

    def press(self, keys):
        self.process.send(keys)

    def resize(self, columns, rows):
        self.screen.resize(rows, columns)
        self.process.setwinsize(rows, columns)

    def finish(self):
        """Waits for its end; the exit status, or the signal that ended it, below 0."""
        while self.is_open:
            self.read_some()
        self.process.wait()
        return -self.process.signalstatus if self.process.signalstatus else self.process.exitstatus

    def kill(self):
        if self.process.isalive():
            self.process.kill(signal.SIGKILL)
            self.process.wait()  # Else close() gives it a tenth of a second.
        self.process.ptyproc.delayafterclose = 0
        self.process.close(force=False)


def plug_in(device, name="adapter"):
    """As the system does: the name is a link to the device, or, with None, is gone."""
    os.makedirs(os.path.dirname(name) or ".", exist_ok=True)
    if os.path.lexists(name):
        os.unlink(name)
    if device:
        os.symlink(device, name)


@pytest.fixture(scope="session")
def shared_clock():
    # A path without spaces: in LD_PRELOAD they separate libraries.
    with tempfile.TemporaryDirectory(prefix="tmini-", dir="/tmp") as folder:
        library = os.path.join(folder, "clock.so")
        os.symlink(os.environ["TMINI_SHARED_CLOCK_LIBRARY"], library)
        os.chmod(folder, 0o755)
        yield Clock(library, os.path.join(folder, "clock"))


@pytest.fixture
def clock(shared_clock):
    shared_clock.begin()
    yield shared_clock
    shared_clock.end()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The test's own folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "recordings").symlink_to(HERE.parent / "recordings")
    return tmp_path


@pytest.fixture
def environment(clock, folder, monkeypatch):
    """What programs find in their environment: a test may change os.environ by monkeypatch."""
    for name in ("TMINI_PORT", "NO_COLOR", "POSIXLY_CORRECT"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TMINI_ROOT", "no_adapters")  # Those of this computer must not matter.
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    return lambda: {**os.environ, **clock.environment()}


@pytest.fixture
def played(monkeypatch, environment):
    """A played computer: played(name=arguments, …) adds processes to it, from number 800 on."""
    monkeypatch.setenv("TMINI_ROOT", "root")

    def add(**processes):
        os.makedirs("root/sys/class/tty/console", exist_ok=True)
        for number, (name, arguments) in enumerate(processes.items(), 800):
            os.makedirs(f"root/proc/{number}/fd")
            Path(f"root/proc/{number}/cmdline").write_bytes(b"\0".join(map(os.fsencode, arguments.split())) + b"\0")
            Path(f"root/proc/{number}/stat").write_text(f"{number} ({name}) S 1 800", encoding="ascii")
    return add


@pytest.fixture
def programs():
    """All that the test has started; ended with it."""
    started = []
    yield started
    for program in reversed(started):
        program.kill()


@pytest.fixture
def start(clock, environment, programs):
    """start(*words, program=TMINI, stdin=FILE): a program that goes on."""
    def begin(*words, program=TMINI, **options):
        programs.append(Program(clock, [program, *map(str, words)], environment(), **options))
        return programs[-1]
    return begin


@pytest.fixture
def tmini(start):
    """tmini(*words): the tool, to its end."""
    return lambda *words, **options: start(*words, **options).finish()


@pytest.fixture
def fails(tmini):
    """fails(status, reason, *words): the tool ends like this, and prints nothing else; what it says."""
    def check(status, reason, *words):
        run = tmini(*words)
        assert (run.status, run.out) == (status, "")
        assert "tmini: " in run.err and reason in run.err, run.err
        return run.err
    return check


@pytest.fixture
def lidar(clock, environment, programs):
    """lidar(*options): the simulated lidar."""
    def begin(*options):
        programs.append(Lidar(clock, options, environment(), f"lidar.{len(programs)}.log"))
        return programs[-1]
    return begin


@pytest.fixture
def terminal(clock, environment, programs):
    """terminal(*words, columns=80, rows=24): the tool in a terminal; shell="…": a command line there."""
    def begin(*words, columns=80, rows=24, shell=None):
        words = [TMINI, *words] if shell is None else ["/bin/sh", "-c", shell]
        programs.append(Terminal(clock, words, environment(), columns, rows, shell is None))
        return programs[-1]
    return begin


@pytest.fixture
def talker(clock, environment, programs):
    """talker(bytes): a port that sends these again and again, as fast as a lidar; b"": that is silent."""
    def begin(content, code=0):
        words = [sys.executable, "-S", "-E", str(HERE / "talker.py"), content.hex() or "-", str(code)]
        programs.append(Program(clock, words, environment()))
        programs[-1].wait_until(lambda: "\n" in programs[-1].out)
        return programs[-1].out.strip()
    return begin


@pytest.fixture
def answerer(talker):
    """answerer(code, bytes): a port that sends these once after each command A5 `code`, and nothing else."""
    return lambda code, content: talker(content, code)
