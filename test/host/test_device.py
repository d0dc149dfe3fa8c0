# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The tool with a lidar: each command, and what it says if there is none, another device, or one that disappears."""

import json
import os
import re
import resource
import signal
import stat
import subprocess

import pytest

from conftest import HAS_RIGHTS, PATIENCE_S, TMINI, plug_in
from lidar_bytes import INFORMATION, NOISE


@pytest.fixture
def output(tmini):
    """output(*words): what a command that succeeds prints; it says nothing else."""
    def run(*words):
        result = tmini(*words)
        assert (result.status, result.err) == (0, "")
        return result.out
    return run


@pytest.fixture
def other(folder):
    """Options of a lidar with another serial number."""
    (folder / "other").write_text("serial = 2026031700054321\n")
    return "--like", "other"


@pytest.fixture
def real_lidar(folder):
    """The simulated lidar in real time: its port, and its process, which prints its log."""
    words = [os.environ["TMINI_SIM"], "--pty", "--log", "-"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        yield process.stdout.readline().strip(), process
        process.kill()


def lines(run, count):
    run.wait_until(lambda: run.out.count("\n") >= count)


@pytest.fixture
def scanning(lidar, start):
    """scanning(*words): a lidar, and `tmini scan`, which has printed two lines; plug(device) names another port."""
    def begin(*words, options=(), plug=lambda device: device):
        device = lidar(*options)
        run = start("scan", "-p", plug(device.port), *words)
        lines(run, 2)
        return device, run
    return begin


def adapter(device):
    plug_in(device)
    return "adapter"


def wait_for_size(run, path, size):
    for _ in range(6000):
        if os.path.exists(path) and os.path.getsize(path) >= size:
            return
        run.clock.sleep(10)
    assert False, f"{path} does not grow to {size} bytes"


# ------------------------------------------------------------------------------------------------------- commands

def test_info_names_model_versions_and_serial_number(lidar, output):
    port = lidar().port
    assert output("info", "-p", port) == ("model       151 (T-mini Plus)\nfirmware    1.2\nhardware    1\n"
                                          "serial      2026031700012345\n")
    assert output("info", "--json", "--port", port) == (
        '{"model":151,"firmware":"1.2","hardware":1,"serial":"2026031700012345"}\n')


def test_health(lidar, output, tmini):
    port = lidar().port
    assert output("health", "-p", port) == "healthy\n"
    assert output("health", "-p", port, "--json") == '{"healthy":true,"faults":0,"error_code":0}\n'
    port = lidar("--health", "0x18").port
    run = tmini("health", "-p", port)
    assert (run.status, run.out, run.err) == (1, "faulty: PD, LD; error code 24\n", "")
    assert tmini("health", "-p", port, "--json").out == '{"healthy":false,"faults":24,"error_code":24}\n'
    assert tmini("health", "-p", lidar("--blocked").port).out == (
        "faulty: encoder (is the rotor blocked?); error code 2\n")


def test_a_covered_window_is_a_failure_so_that_scan_and_drive_does_not_drive(lidar, tmini):
    run = tmini("scan", "-p", lidar("--covered").port, "-n", "5")
    assert run.status == 1
    for text in ("faulty: data (is the window covered?)", "; 0 with a distance; ", "no scan had a distance"):
        assert text in run.err


def test_the_frequency_is_read_set_and_kept(lidar, output):
    port = lidar().port
    assert output("frequency", "-p", port) == "6.00 Hz\n"
    assert output("frequency", "7.5", "-p", port) == "7.50 Hz\n"
    assert output("frequency", "-p", port, "--json") == '{"frequency_hz":7.50}\n'
    assert output("frequency", "12", "-p", port) == "12.00 Hz\n"
    assert output("frequency", "6.0", "-p", port) == "6.00 Hz\n"


def test_a_frequency_is_lost_in_a_reboot_which_ends_when_the_lidar_answers(lidar, output, tmini):
    port = lidar().port
    assert output("frequency", "9", "-p", port) == "9.00 Hz\n"
    run = tmini("reboot", "-p", port)
    assert run.status == 0 and "the lidar is back" in run.err
    assert output("frequency", "-p", port) == "6.00 Hz\n"


def test_scan_prints_a_line_for_each_scan_and_a_summary(lidar, tmini):
    port = lidar().port
    run = tmini("scan", "-p", port, "-n", "4")
    assert run.status == 0 and run.out.count("\n") == 4
    # The nearest point of the simulated room is the corner of a box, 1.0 m away.
    assert re.search(r"\nscan 4 +6.0 Hz +\d+/\d+ points  nearest \d\.\d+ m at \d+\.\d deg, ", run.out)
    assert run.err == "scans: 4 complete; 4 with a distance; 0.0 % of the packets damaged\n"
    assert tmini("scan", "-p", port, "-qn1").err == ""


def test_scan_as_json_and_csv_is_like_decode(lidar, output, tmini):
    port = lidar().port
    text = tmini("scan", "-p", port, "-n", "2", "--json").out
    assert text.startswith('{"scan":1,"time_ms":') and text.count("\n") == 2
    for part in (',"frequency_hz":', ',"complete":', ',"dropped":0,"checksum_errors":0,"faults":', ']]}\n{"scan":2,'):
        assert part in text
    text = tmini("scan", "-p", port, "-n", "2", "--csv").out
    assert text.startswith("scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n1,")
    assert text.count("\n2,") > 600 and "\n3," not in text


# -------------------------------------------------------------------------------------------------------- recordings

def test_a_recording_holds_every_packet(lidar, output, tmini):
    run = tmini("record", "-p", lidar().port, "long.tmini", "--seconds", "8")
    assert run.status == 0
    assert re.fullmatch(r"long\.tmini: (8|9|1\d)\.\d s, \d+ bytes; scans: \d+ complete; 0 wrong checksums\n", run.err)
    text = output("decode", "long.tmini")
    assert "0 stray bytes between packets" in text and " bytes before the first packet, 0 after the last" in text
    assert int(re.search(r"points +(\d+)", text)[1]) > 30000  # 4000 per second, after the start.


def shell(port, script):
    """In real time: programs at the other end of a pipe know nothing of the shared clock."""
    return subprocess.run(["sh", "-c", script], env={**os.environ, "TMINI_PORT": port, "TMINI": TMINI}, check=False,
                          capture_output=True, text=True, timeout=60)


def test_a_recording_can_go_through_a_pipe(real_lidar):
    run = shell(real_lidar[0], '"$TMINI" record - --seconds 1 -q | "$TMINI" decode -')
    assert "0 stray bytes between packets" in run.stdout and "bytes before the first packet, 0 after" in run.stdout


def test_an_existing_recording_is_overwritten_only_with_force(lidar, talker, fails, tmini):
    with open("gold.bin", "w", encoding="ascii") as file:
        file.write("gold")
    port = lidar().port
    fails(1, "gold.bin exists; --force overwrites it", "record", "-p", port, "gold.bin", "-s1")
    fails(1, "not one byte came", "record", "-p", talker(b""), "gold.bin", "--force")
    assert os.path.getsize("gold.bin") == 4
    assert tmini("record", "-p", port, "gold.bin", "-s1", "--force").status == 0
    assert os.path.getsize("gold.bin") > 10000


def test_a_lidar_that_sends_nothing_leaves_no_file(talker, fails):
    fails(1, "not one byte came", "record", "-p", talker(b""), "empty.bin")
    assert not os.path.exists("empty.bin")


def test_a_recording_of_a_few_bytes_counts_them_all(talker, tmini):
    run = tmini("record", "-p", talker(b"\xAA", 0x65), "few.bin", "-s1")  # One for each stop.
    assert f" s, {os.path.getsize('few.bin')} bytes; scans: " in run.err


def test_all_bytes_of_another_unit_are_recorded(folder, start, talker, tmini):
    start("--write", "four.bin", "--seconds", "2", "--samples", "4", program=os.environ["TMINI_SIM"]).finish()
    sent = (folder / "four.bin").read_bytes()
    run = tmini("record", "-p", talker(sent), "heard.bin", "-s3")
    assert run.status == 0
    assert "nothing of it can be decoded: packets come at " in run.err and "they fit four-byte samples" in run.err
    heard = (folder / "heard.bin").read_bytes()
    assert len(heard) > len(sent) and heard in sent * (len(heard) // len(sent) + 2)


def test_a_recording_of_another_unit_begins_with_the_opening_of_the_port_and_stops_the_lidar(lidar, folder, tmini):
    device = lidar("--samples", "4")
    assert tmini("record", "-p", device.port, "four.bin", "-s2").status == 0
    assert bytes.fromhex("A55A0500004081AA55") in (folder / "four.bin").read_bytes()[:40]
    device.wait_for_log("stopping -> idle")
    assert device.log.rstrip().endswith("stopping -> idle")
    assert "they fit four-byte samples" in tmini("decode", "four.bin").err


def test_a_recording_ends_with_ctrl_c_and_is_whole(lidar, start, output):
    run = start("record", "-p", lidar().port, "it.bin", "--quiet")
    wait_for_size(run, "it.bin", 8000)
    assert run.end().status == 0
    text = output("decode", "it.bin")
    assert "0 stray bytes between packets" in text and " bytes before the first packet, 0 after the last" in text


def test_what_came_is_soon_in_the_file_for_programs_that_read_it_meanwhile(lidar, start):
    device = lidar()
    run = start("record", "-p", device.port, "it.bin")
    wait_for_size(run, "it.bin", 8000)
    device.freeze()
    run.clock.sleep(250)
    size = os.path.getsize("it.bin")
    assert run.end().status == 0 and os.path.getsize("it.bin") == size


def test_a_recording_survives_a_pulled_cable(lidar, start, tmini):
    device = lidar()
    run = start("record", "-p", device.port, "pulled.bin", "-q")
    wait_for_size(run, "pulled.bin", 16000)
    device.unplug()
    assert run.finish().status == 1 and "has gone" in run.err
    assert " complete" in tmini("decode", "pulled.bin").out


def test_a_file_that_cannot_be_written_is_reported_first(lidar, fails, monkeypatch, start):
    device = lidar()
    fails(1, "cannot write /nowhere/x", "record", "-p", device.port, "/nowhere/x", "--seconds", "1")
    fails(1, "cannot write /nowhere/x", "survey", "-p", device.port, "/nowhere/x")
    assert "start" not in device.log
    monkeypatch.setenv("TMINI_PORT", device.port)
    run = start("-c", f"ulimit -S -f 8; exec '{TMINI}' record short.bin", program="/bin/sh")
    device.wait_for_log("scanning -> stopping")
    resource.prlimit(run.process.pid, resource.RLIMIT_FSIZE, (-1, -1))  # What follows can be written again.
    assert run.finish().status == 1 and "cannot write short.bin" in run.err
    device.wait_for_log("stopping -> idle")


def test_plot_of_a_lidar_draws_a_scan(lidar, tmini):
    run = tmini("plot", "-p", lidar().port, "-o", "live.svg")
    if "without cairo" in run.err:
        pytest.skip("the tool was built without cairo")
    assert run.status == 0 and "live.svg: Scan " in run.err and " with a distance" in run.err


# ------------------------------------------------------------------------------------- pipes, signals, descriptors

def test_a_closed_pipe_ends_a_scan_silently_and_stops_the_lidar(real_lidar):
    run = shell(real_lidar[0], '{ "$TMINI" scan 2>errors; echo $? >&2; } | head -n 2')
    assert (run.stdout.count("\n"), run.stderr) == (2, "141\n")
    with open("errors", encoding="utf-8") as errors:
        assert errors.read() == ""
    assert any("scanning -> stopping" in line for line in real_lidar[1].stdout)


def test_with_closed_output_nothing_goes_to_the_lidar(real_lidar):
    run = shell(real_lidar[0], 'exec "$TMINI" info <&- >&-')
    assert (run.returncode, run.stderr) == (1, "tmini: cannot write to standard output\n")
    assert shell(real_lidar[0], 'exec "$TMINI" health >&- 2>&-').returncode == 1
    real_lidar[1].terminate()
    log = real_lidar[1].communicate()[0]
    # A stop, because the lidar's state is unknown, and the query; both again if the computer is too busy for an answer.
    assert re.fullmatch("(6590)+(6592)+", "".join(re.findall("command A5 (..)", log))) and " 0 unknown," in log


@pytest.mark.parametrize("number", (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
def test_a_signal_stops_the_lidar_before_leaving(scanning, number):
    device, run = scanning()
    assert run.end(number).status == 0
    assert "tmini: " not in run.err
    device.wait_for_log("stopping -> idle")


@pytest.mark.parametrize("words, is_stopped", (((), True), (("--listen",), False)))
def test_a_signal_ends_a_scan_that_nobody_reads(lidar, start, clock, words, is_stopped):
    """After 5 s of real time, in which what is written may still be read."""
    device = lidar()
    with device.left_scanning():
        run = start("scan", "--csv", "-p", device.port, *words)
        clock.wait_for_block(run.process.pid)
        begun = device.log.count("scanning -> stopping")
        run.process.send_signal(signal.SIGINT)
        assert run.process.wait(PATIENCE_S) == -signal.SIGINT
        clock.sleep(1000)
        assert device.log.count("scanning -> stopping") == begun + is_stopped


def test_a_signal_that_is_ignored_stays_ignored(lidar, start, monkeypatch):
    monkeypatch.setenv("TMINI_PORT", lidar().port)
    run = start("-c", f"trap '' HUP; exec '{TMINI}' record -q it.bin --seconds 2", program="/bin/sh")
    wait_for_size(run, "it.bin", 1000)
    assert run.end(signal.SIGHUP).status == 0
    assert os.path.getsize("it.bin") > 19000


def test_a_lidar_that_is_still_streaming_is_stopped_first(lidar, output):
    device = lidar()
    with device.left_scanning():
        assert output("health", "-p", device.port) == "healthy\n"


@pytest.mark.parametrize("words, said", ((("scan", "-n1"), "scans although it was stopped; stopping it again"),
                                         (("check", "-s1"), "\nlook  stop       the lidar went on after")))
def test_a_lidar_that_scans_although_it_was_stopped_is_stopped_again(lidar, start, words, said):
    device = lidar()
    with open(device.port, "r+b", buffering=0) as line:
        run = start(*words, "-p", device.port)
        device.wait_for_log("stopping -> idle")
        line.write(b"\xA5\x60")
        assert run.finish().status == 0
    assert (said in run.out + run.err) and device.log.count("scanning -> stopping") == 2


# ------------------------------------------------------------------------------------------- losses, and --wait

@pytest.mark.parametrize("options, befalls, said", (
    pytest.param((), "unplug", ("has gone: the adapter was unplugged", "Plug it in"), id="a_pulled_cable"),
    pytest.param((), "freeze", ("has fallen silent; starting it again", "has fallen silent and does not come back"),
                 id="silence"),
    pytest.param(("--tcp", "0"), "unplug", (" has gone: the other end closed",), id="a_closed_socket")))
def test_what_ends_a_scan_is_reported(scanning, options, befalls, said):
    device, run = scanning(options=options)
    getattr(device, befalls)()
    assert run.finish().status == 1
    assert all(text in run.err for text in said), run.err


def test_a_lidar_that_comes_back_is_reported(scanning):
    device, run = scanning()
    device.freeze()
    run.wait_for("the lidar has fallen silent; starting it again\n")
    device.thaw()
    run.wait_for("the lidar is back\n")
    lines(run, run.out.count("\n") + 2)
    assert run.end().status == 0


def test_with_wait_a_scan_continues_after_a_pulled_cable(lidar, scanning):
    device, run = scanning("--wait", plug=adapter)
    device.unplug()
    plug_in(None)
    run.wait_for("adapter is not there; waiting for it\n")
    run.wait_for("fallen silent")
    count = run.out.count("\n")
    device = lidar()
    plug_in(device.port)
    lines(run, count + 2)
    assert run.end().status == 0
    assert "adapter is there\n" in run.err and "tmini: " not in run.err
    device.wait_for_log("stopping -> idle")


def test_a_recording_with_wait_goes_on_after_a_pulled_cable(lidar, start, tmini):
    device = lidar()
    plug_in(device.port)
    run = start("record", "-p", "adapter", "--wait", "waits.tmini")
    wait_for_size(run, "waits.tmini", 16000)
    device.unplug()
    run.wait_for("waiting for it\n")
    plug_in(lidar().port)
    wait_for_size(run, "waits.tmini", os.path.getsize("waits.tmini") + 30000)
    assert run.end().status == 0
    assert "damaged" not in tmini("decode", "waits.tmini").err


def test_with_wait_a_port_that_is_not_there_yet_is_waited_for(lidar, start):
    run = start("scan", "-p", "adapter", "--wait", "-n", "1")
    run.wait_for("adapter is not there; waiting for it\n")
    plug_in(lidar().port)
    assert run.finish().status == 0 and run.out.count("\n") == 1


def test_with_wait_another_lidar_on_the_port_is_not_taken(lidar, scanning, other):
    device, run = scanning("--wait", plug=adapter)
    device.unplug()
    plug_in(None)
    run.wait_for("waiting for it\n")
    count = run.out.count("\n")
    wrong = lidar(*other)
    plug_in(wrong.port)
    run.wait_for("adapter is there, but with another lidar: serial 2026031700054321, not 2026031700012345. "
                 "Waiting for that one\n")
    run.clock.sleep(5000)
    assert "start" not in wrong.log and run.out.count("\n") <= count
    plug_in(None)
    run.clock.sleep(1000)
    plug_in(lidar().port)
    lines(run, count + 2)
    assert run.end().status == 0


# ------------------------------------------------------------------------------- ports, over a played /dev and /sys

@pytest.fixture
def computer(played):
    """A played computer: computer(tty, device, …) adds a port."""
    def add(tty, device, maker="10c4:ea60", serial=None, by_id=None, by_path=None):
        plug_in(device, f"root/dev/{tty}")
        for kind, name in (("by-id", by_id), ("by-path", by_path)):
            if name:
                plug_in(f"../../{tty}", f"root/dev/serial/{kind}/{name}")
        usb = f"root/usb/{tty}"
        os.makedirs(f"{usb}/1-1:1.0", exist_ok=True)
        os.makedirs(f"root/sys/class/tty/{tty}", exist_ok=True)
        plug_in(f"../../../../usb/{tty}/1-1:1.0", f"root/sys/class/tty/{tty}/device")
        for name, content in zip(("idVendor", "idProduct", "serial"), (*maker.split(":"), serial)):
            if content:
                with open(f"{usb}/{name}", "w", encoding="ascii") as file:
                    file.write(content + "\n")
        return f"root/dev/{tty}"
    return add


def test_ports_lists_adapters_by_their_most_stable_names_and_the_boards_uarts(computer, talker, output):
    computer("ttyUSB0", talker(b""), by_id="usb-Lidar_7", serial="7", by_path="pci-1")
    computer("ttyUSB1", talker(b""), "dead:beef", by_id="usb-Printer")
    computer("ttyAMA0", talker(b""), ":")
    assert output("ports") == (
        "root/dev/serial/by-id/usb-Lidar_7  (root/dev/ttyUSB0, 10c4:ea60)  CP210x\n"
        "root/dev/serial/by-id/usb-Printer  (root/dev/ttyUSB1, dead:beef)\n"
        "root/dev/ttyAMA0  (root/dev/ttyAMA0, on the board)\n")


def test_two_equal_adapters_are_told_apart_by_their_places(computer, talker, output):
    computer("ttyUSB0", talker(b""), serial="0001", by_path="pci-1.1")
    computer("ttyUSB1", talker(b""), serial="0001", by_id="usb-CP2102_0001", by_path="pci-1.2")
    assert [line.split()[0] for line in output("ports").splitlines()] == [
        "root/dev/serial/by-path/pci-1.1", "root/dev/serial/by-path/pci-1.2"]


@pytest.mark.parametrize("name", ("serial/by-path/pci-1", "serial/by-id/usb-7", "ttyUSB0"))
def test_with_wait_the_name_that_was_given_is_kept(computer, scanning, name):
    def plug(device):
        computer("ttyUSB0", device, serial="7", by_id="usb-7", by_path="pci-1")
        return f"root/dev/{name}"
    device, run = scanning("--wait", plug=plug)
    device.unplug()
    run.wait_for(f"root/dev/{name} is not there; waiting for it\n")


def test_with_wait_the_name_of_a_device_becomes_that_of_its_adapter(computer, lidar, scanning):
    """The next adapter that is plugged in may get the name /dev/ttyUSB0."""
    def plug(device):
        computer("ttyUSB0", device, serial="7", by_id="usb-7", by_path="pci-1")
        return device
    device, run = scanning("--wait", plug=plug)
    device.unplug()
    run.wait_for("root/dev/serial/by-id/usb-7 is not there; waiting for it\n")
    computer("ttyUSB1", lidar().port, serial="7", by_id="usb-7")
    run.wait_for("usb-7 is there\n")


def test_the_only_adapter_that_may_be_a_lidars_is_taken(computer, lidar, talker, output, tmini, fails, monkeypatch):
    computer("ttyUSB0", lidar().port, "1a86:55d4", by_id="usb-1")
    computer("ttyUSB1", talker(b""), "dead:beef")
    computer("ttyAMA0", talker(b""), ":")
    run = tmini("health")
    assert (run.out, run.err) == ("healthy\n", "using root/dev/serial/by-id/usb-1\n")
    port = lidar().port
    computer("ttyUSB2", port, by_id="usb-2")
    fails(2, "there are:\nroot/dev/serial/by-id/usb-1", "health")
    monkeypatch.setenv("TMINI_PORT", port)
    assert output("health") == "healthy\n"


def test_ask_shows_which_lidar_is_where(computer, played, lidar, talker, other, output, clock):
    first, second, streaming = lidar(), lidar(*other), lidar()
    named = lidar()
    computer("ttyUSB0", first.port, by_path="pci-1")
    computer("ttyUSB1", second.port, by_path="pci-2")
    computer("ttyUSB2", talker(b""), "1a86:7523", by_path="pci-3")
    computer("ttyUSB3", streaming.port, "0403:6015")
    computer("ttyUSB4", named.port, "dead:beef")
    computer("ttyACM0", "/dev/null", "0483:5740")
    computer("ttyUSB6", talker(NOISE))
    computer("ttyUSB5", talker(b""), "067b:2303")
    played(screen="screen /dev/ttyUSB5")
    plug_in("../../dev/ttyUSB5", "root/dev/serial/by-path/pci-5")
    with streaming.left_scanning():
        begun = clock.now_ms()
        text = output("ports", "--ask")
        assert clock.now_ms() - begun <= 3200
    answers = dict(re.search(r"\(root/dev/(\w+), .*?\)[^:]*: (.*)", line).groups() for line in text.splitlines())
    assert answers["ttyUSB0"] == "model 151 (T-mini Plus), serial 2026031700012345"
    assert answers["ttyUSB1"] == "model 151 (T-mini Plus), serial 2026031700054321"
    assert answers["ttyUSB2"] == "asked, no answer"
    assert answers["ttyUSB3"] == "a lidar that scans, not asked; serial 2026031700012345"
    assert answers["ttyUSB4"] == "not asked"
    assert answers["ttyUSB5"] .startswith("not asked: screen (process 800) uses ")
    assert answers["ttyUSB6"] == "not asked: bytes come that no T-mini Plus sends"
    assert "not a serial device" in answers["ttyACM0"]
    assert [re.findall("command A5 (..)", device.log) for device in (first, second, named)] == [["90"], ["90"], []]
    assert streaming.log.count("command") == 1
    assert "model 151" in output("ports", "--ask", "-p", "root/dev/ttyUSB4")


def test_a_lidar_is_found_by_the_end_of_its_serial_number(computer, lidar, other, tmini, fails):
    computer("ttyUSB0", lidar().port, by_path="pci-1")
    computer("ttyUSB1", lidar(*other).port, by_path="pci-2")
    run = tmini("info", "-p", "serial:4321")
    assert "serial      2026031700054321\n" in run.out
    assert run.err == "using root/dev/serial/by-path/pci-2: serial 2026031700054321\n"
    text = fails(2, "no lidar with a serial number that ends in 9:", "info", "-p", "serial:9")
    assert text.count("model 151") == 2
    computer("ttyUSB2", lidar().port, by_path="pci-3")
    fails(2, "several lidars have serial numbers that end in 2345:", "info", "-p", "serial:2345")


# ---------------------------------------------------------------------------------------- mounting and listening

def test_a_lidar_that_is_mounted_turned_is_shown_as_the_robot_sees(lidar, tmini):
    """The nearest point of the simulated room is 1 m away at 143 degrees: 53 clockwise from a front at 90, or 53
    anti-clockwise if the lidar is upside down."""
    port = lidar().port
    text = tmini("scan", "-p", port, "-n1", "--front", "90", "-q", "--upside-down").out
    assert " at 30" in text and " deg, ahead left\n" in text
    assert "behind" not in tmini("scan", "-p", port, "-n1", "-q", "--mask", "90:-90").out
    text = tmini("check", "-p", port, "-s1", "--mask", "150:130").out
    assert re.search(r"ok ranges (9\d|100) % valid; nearest .* deg, behind right", " ".join(text.split()))


def test_listening_sends_nothing(lidar, tmini):
    device = lidar()
    with device.left_scanning():
        assert tmini("scan", "-p", device.port, "--listen", "-n", "2").status == 0
        assert "BAD" not in tmini("check", "-p", device.port, "--listen", "-s", "1").out
        assert tmini("record", "-p", device.port, "--listen", "heard.bin", "-s", "1").status == 0
    assert device.log.count("command ") == 1


# ---------------------------------------------------------------------------------------------------------- survey

def test_survey_writes_a_report_and_leaves_the_lidar_stopped_as_it_was(lidar, folder, output, tmini):
    port = lidar("--frequency", "7").port
    run = tmini("survey", "-p", port, "unit", "--with-serial", "-s10")
    assert run.status == 0
    assert "as expected 9.15  model " in run.out and "differs     1     frequency at first, Hz" in run.out
    report = (folder / "unit").read_text()
    assert "\nfrequency_hz = 7.00\n" in report and "\nserial = 2026031700012345\n" in report
    assert "not_understood" not in report
    assert tmini("decode", "unit.tmini").status == 0
    assert output("frequency", "-p", port) == "7.00 Hz\n"
    assert output("frequency", "-p", lidar("--like", "unit").port) == "7.00 Hz\n"


def test_an_interrupted_survey_gives_the_lidar_its_frequency_back(lidar, start, output):
    device = lidar()
    run = start("survey", "-p", device.port, "-s10")
    run.wait_for("scanning at 10 Hz")
    device.wait_for_log("0C")  # Faster by 1 Hz: on its way.
    assert run.end().status == 1 and "interrupted: no report" in run.err
    assert output("frequency", "-p", device.port) == "6.00 Hz\n"


def test_a_survey_of_another_unit_keeps_some_bytes_without_the_serial_number(lidar, folder, tmini):
    tmini("survey", "-p", lidar("--samples", "4").port, "unit")  # For so long that a checksum matches by chance.
    report = (folder / "unit").read_text()
    sample = re.search("\nnot_understood = (.*)\n", report)[1].split()
    assert sample[:7] == ["A5", "5A", "05", "00", "00", "40", "81"] and 250 < len(sample) <= 300
    assert "02 00 02 06 00 03 01 07" not in report and "2026031700012345" not in report


# --------------------------------------------------------------------------------------------- what can go wrong

@pytest.mark.parametrize("words, reason", (
    pytest.param("ports", "no USB serial adapter is plugged in", id="without_an_adapter_there_are_no_ports"),
    pytest.param("scan -p IDLE --listen", "has another program or controller started the lidar?", id="a_silent_lidar"),
    pytest.param("survey -p SILENT", "not one byte came", id="a_survey_of_nothing")))
def test_nothing_is_reported(lidar, talker, fails, words, reason):
    fails(1, reason, *words.replace("IDLE", lidar().port).replace("SILENT", talker(b"")).split())


@pytest.mark.parametrize("port, reason", (
    ("/dev/nowhere", "there is no such device"), ("127.0.0.1:4000", "tcp:HOST:PORT"),
    ("tcp:localhost", "tcp:HOST:PORT"),
    ("tcp:", "tcp:HOST:PORT"), ("tcp:no.such.host.invalid:1", "no host of that name"),
    ("tcp:127.0.0.1:lidar", "a number from 1 to 65535"), ("tcp:127.0.0.1:65536", "a number from 1 to 65535"),
    ("tcp:127.0.0.1:0", "a number from 1 to 65535"), ("/dev/nowhere/deep", "/dev/nowhere/deep"),
    ("/dev/null", "not a serial port"), ("/tmp", "not a serial port"), ("recordings/sim-6hz.bin", "not a serial port")))
def test_a_port_that_is_none(fails, port, reason):
    fails(1, reason, "info", "-p", port)


def test_a_socket_is_a_port_while_a_lidar_is_at_its_other_end(lidar, fails, output):
    device = lidar("--tcp", "0")
    assert output("health", "-p", device.port) == "healthy\n"
    device.unplug()
    fails(1, "Connection refused", "info", "-p", device.port)


def test_a_port_that_another_program_uses(scanning, fails):
    fails(1, "another program is using it", "info", "-p", scanning()[0].port)


@pytest.mark.skipif(not HAS_RIGHTS, reason="only root can give up rights")
def test_a_port_that_one_may_not_open(lidar, environment):
    port = lidar().port
    os.chmod(port, 0)
    run = subprocess.run([TMINI, "info", "-p", port], user=65534, group=65534, capture_output=True, text=True,
                         check=False, cwd="/")
    os.chmod(port, stat.S_IRUSR | stat.S_IWUSR)
    assert run.returncode == 1 and "you may not open it" in run.stderr and "dialout" in run.stderr


@pytest.mark.parametrize("command", ("info", "scan"))
@pytest.mark.parametrize("content, reasons", (
    (b"", ("not one byte came", "its TX goes to the adapter's RX")),
    (NOISE, ("wrong baud rate", "but nothing that a T-mini Plus sends"))), ids=("silent", "noisy"))
def test_a_port_without_a_lidar(talker, fails, command, content, reasons):
    for reason in reasons:
        fails(1, reason, command, "-p", talker(content))


def test_a_lidar_that_sends_but_does_not_hear(talker, fails):
    with open("recordings/sim-6hz.bin", "rb") as file:
        text = fails(1, "does not obey", "info", "-p", talker(file.read()[7:]))
    assert "--listen" in text and "the adapter's TX" in text


def test_a_lidar_that_answers_one_command_is_not_a_fault_of_the_wires(answerer, output, fails):
    assert output("info", "-p", answerer(0x90, INFORMATION)).startswith("model       151")
    fails(1, "answers `tmini info`, so its wires are good", "scan", "-p", answerer(0x90, INFORMATION))


def test_a_network_that_delivers_late_spoils_no_scan(lidar, tmini):
    run = tmini("scan", "-p", lidar("--tcp", "0", "--bursts", "500", "--frequency", "10").port, "-n", "60", "--json")
    scans = [json.loads(line) for line in run.out.splitlines()]
    assert [scan["complete"] for scan in scans] == 60 * [True]
    times_ms = [scan["time_ms"] for scan in scans]
    steps = [after - before for before, after in zip(times_ms[10:], times_ms[11:])]
    assert 40 <= min(steps) and max(steps) <= 130, steps


def test_after_a_silence_in_a_network_times_are_right_at_once(scanning, clock):
    device, run = scanning("--json", options=("--tcp", "0"))
    lines(run, 3)
    begun_ms = clock.now_ms()
    device.freeze()
    run.wait_for("the lidar has fallen silent")
    device.thaw()
    lines(run, 6)
    passed_ms = clock.now_ms() - begun_ms
    third, sixth = (json.loads(run.out.splitlines()[at])["time_ms"] for at in (2, 5))
    assert passed_ms > 1000 and abs(sixth - third - passed_ms) < 100
