# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`tmini check` names the true reason in its first two lines, for each fault of the simulated lidar, for other units,
bridges and terminals, and for ports without a lidar."""

import re
import signal
import subprocess

import pytest
from conftest import TMINI
from lidar_bytes import INFORMATION, NOISE


def flat(text):
    return " ".join(text.split())


@pytest.fixture
def check(tmini):
    """check(port, …): what it prints, in one line; each line fits into 80 columns."""
    def run(port, *words):
        result = tmini("check", "-p", port, *words)
        assert all(len(line) <= 80 for line in result.out.splitlines()), result.out
        result.flat = flat(result.out)
        result.first = flat(" ".join(result.out.splitlines()[:2]))
        return result
    return run


def test_a_good_lidar_is_good(lidar, check):
    run = check(lidar("--seed", "7").port)
    assert run.status == 0
    assert run.out.startswith("verdict: good\nok    port       /dev/pts/")
    for line in ("ok    answers    model 151, firmware 1.2, hardware 1, serial 2026031700012345\n",
                 "ok    health     healthy\n", "ok    supply     no restart; first packet after 0.",
                 "ok    line       0.0 % of ", "ok    frequency  6.0 Hz measured, 6.0 Hz set\n",
                 "ok    faults     healthy\n", " % valid; nearest 1."):
        assert line in run.out
    assert check(lidar("--tcp", "0").port).out.startswith("verdict: good\nok    port       tcp:127.0.0.1:")


@pytest.mark.parametrize("options", (["--no-ct"], ["--begin", "unmarked", "--firmware", "1.3"]))
def test_a_unit_that_behaves_like_real_ones_is_good(lidar, check, options):
    run = check(lidar(*options).port)
    assert run.out.startswith("verdict: good\n")
    assert ("not reported: this unit sends no information within the stream" in run.flat) == ("--no-ct" in options)


RATE = "packets come at 1"
OTHER = "all with wrong checksums; they fit "
PLAIN_LINE = "GND beside them"

# The simulated lidar's options; the verdict; what is said.
CASES = {
    "four bytes": ("--samples 4", "not good: model (four-byte samples, perhaps a T-mini Plus SH)",
                   [RATE, OTHER + "four-byte samples: perhaps a T-mini Plus SH (another YDLIDAR), which this version "
                    "does not read", "`tmini record FILE` keeps all bytes"]),
    "plus sh": ("--samples 4 --model 152", "not good: model (four-byte samples, perhaps a T-mini Plus SH)",
                ["look answers model 152,"]),
    "two bytes": ("--samples 2", "not good: model (two-byte samples, another YDLIDAR)",
                  [RATE, OTHER + "two-byte samples: another YDLIDAR, which this version does not read"]),
    "telnet": ("--bridge telnet", "not good: bridge, line (it doubles FF, as telnet does)",
               ["each byte FF comes twice: a bridge in telnet mode doubles it"]),
    "cr": ("--bridge crnl", "not good: terminal, line (0D comes as 0A)",
           ["0D comes as 0A: a terminal between the lidar and this program turns CR into NL"]),
    "xonxoff": ("--bridge xonxoff", "not good: terminal, line (XON/XOFF takes 11 and 13)",
                ["the bytes 11 and 13 are missing", "flow control (XON/XOFF)"]),
    "seven": ("--bridge seven", "not good: bits (seven bits instead of eight)",
              ["no byte is above 7F: something between the lidar and this program passes seven bits only"]),
    "third turn": ("--blind 3 --no-ct", "not good: ranges",
                   ["BAD ranges 19 of 58 turns saw nothing; 65 % of all points"]),
    "too fast": ("--motor 130", "not good: frequency",
                 ["BAD frequency 7.8 Hz measured, 6.0 Hz set: it turns too fast its speed control has failed; "
                  "no supply and no brake does that"]),
    "drop": ("--fault drop=1e-3", "not good: line", [" packets damaged, ", PLAIN_LINE]),
    "flip": ("--fault flip=1e-3", "not good: line", [" packets damaged, ", PLAIN_LINE]),
    "insert": ("--fault insert=1e-3", "not good: line", [" packets damaged, ", PLAIN_LINE]),
    "burst": ("--fault burst=4", "not good: line", [" packets damaged, ", PLAIN_LINE]),
    "cut": ("--fault cut=6", "not good: line", [" packets damaged, ", PLAIN_LINE]),
    "garble": ("--fault garble=2", "not good: line", ["bytes came that no lidar sends: a wrong baud rate for a while"]),
    "unplug": ("--fault unplug=0.3 --seed 6", "not good: supply", ["fell silent 1 time in 10 s", "5 V, up to 1 A"]),
    "blocked": ("--blocked", "not good: health",
                ["faulty: encoder (is the rotor blocked?)", "let the rotor turn freely"]),
    "covered": ("--covered", "not good: faults", ["uncover or clean the window"]),
    "covered no ct": ("--covered --no-ct", "not good: faults", ["uncover or clean the window"]),
    # The tool believes the lidar's own health report.
    "sensor": ("--health 0x01", "not good: health", ["faulty: sensor", "ask its maker"]),
    "all bits": ("--health 0x3E", "not good: health", [
        "faulty: encoder, wireless power, PD, LD, data (is the rotor blocked?) (is the window covered?)"]),
    "slow": ("--motor 70", "not good: frequency",
             ["BAD frequency 4.2 Hz measured, 6.0 Hz set: it turns too slowly", "brake the rotor"]),
    "brake": ("--motor 85", "usable, but look at: frequency",
              ["look frequency 5.1 Hz measured, 6.0 Hz set: it turns too slowly"]),
    "weak": ("--spin-up 8", "usable, but look at: supply", ["the motor took "]),
    "late": ("--bursts 400", "usable, but look at: pace",
             ["look pace bytes come in bursts, up to 4", " ms apart; late halves of ", " packets were dropped",
              "nothing is lost on the line", "ok line 0.0 % of "]),
}


@pytest.mark.parametrize("case", CASES)
def test_each_fault_is_named_with_a_remedy(lidar, check, case):
    options, verdict, said = CASES[case]
    needs_ten_seconds = re.search("line|ranges|supply|pace", verdict)
    run = check(lidar(*options.split()).port, "-s10" if needs_ten_seconds else "-s3")
    assert run.out.startswith(f"verdict: {verdict}\n"), run.out
    assert run.status == (1 if verdict.startswith("not good") else 0)
    for text in said:
        assert text in run.flat, run.out


@pytest.mark.parametrize("case", ("four bytes", "two bytes"))
def test_a_listener_hears_another_unit_too(lidar, check, case):
    device = lidar(*CASES[case][0].split())
    with device.left_scanning():
        run = check(device.port, "--listen")
    assert run.out.startswith(f"verdict: {CASES[case][1]}\n")
    assert device.log.count("command A5") == 1


def test_other_commands_name_another_unit_too(lidar, tmini):
    port = lidar("--samples", "4", "--model", "152").port
    assert "152 (T-mini Plus SH: four-byte samples, which this version does not read)" in tmini("info", "-p", port).out
    run = tmini("scan", "-p", port)
    assert run.status == 1
    assert OTHER + "four-byte samples" in run.err


def test_a_lidar_that_boots_is_waited_for(lidar, check, tmini):
    run = check(lidar("--boot", "2.5").port)
    assert run.status == 0
    assert "no answer yet; a lidar that has just got power is still booting: asking for 6 s" in run.err
    assert "; it answered after 3." in run.flat and "s: it was still booting" in run.flat
    assert tmini("health", "-p", lidar("--boot", "4").port).out == "healthy\n"


def test_time_in_which_the_program_does_not_run_is_no_silence(lidar, start, clock):
    run = start("health", "-p", lidar("--boot", "2.5").port)
    begun_ms = clock.now_ms()
    run.wait_for("no answer yet")
    assert 1000 <= clock.now_ms() - begun_ms < 1500
    clock.sleep(500)  # It has asked again.
    clock.stop(run.process.pid)
    clock.sleep(8000)
    run.process.send_signal(signal.SIGCONT)
    assert run.finish().out == "healthy\n"


def test_a_network_that_delivers_late_loses_nothing(lidar, check):
    run = check(lidar("--tcp", "0", "--bursts", "400").port)
    assert run.out.startswith("verdict: usable, but look at: pace\n")
    assert "ok line 0.0 % of" in run.flat and "dropped" not in run.flat
    assert "nothing is lost: the network or the bridge delivers late" in run.flat
    assert "wires" not in run.flat


def test_damage_before_a_network_is_not_blamed_on_wires_alone(lidar, check):
    run = check(lidar("--tcp", "0", "--fault", "drop=1e-3").port)
    assert "bytes are lost before the network: the bridge's UART" in run.flat


@pytest.mark.parametrize("content, verdict, said", (
    (b"", "wiring", "not one byte came. Check that - this is the port that the lidar is on, - the lidar has 5 V"),
    (NOISE, "baud", "the adapter really runs at 230400 baud"),
    (b"\r\nDebian GNU/Linux 12 pi ttyAMA0\r\n\r\npi login: ", "text (text comes, not a lidar's packets)",
     "\"Debian GNU/Linux 12 pi ttyAMA0\""),
), ids=("silent", "noisy", "console"))
def test_ports_without_a_lidar(talker, check, content, verdict, said):
    run = check(talker(content))
    assert run.status == 1
    assert run.out.startswith(f"verdict: not good: {verdict}\n")
    assert said in run.flat


def test_a_lidar_that_sends_but_does_not_hear(talker, check):
    with open("recordings/sim-6hz.bin", "rb") as file:
        run = check(talker(file.read()[7:]))
    assert run.out.startswith("verdict: not good: command\n")
    assert "the adapter's TX goes to the lidar's RX" in run.flat


def test_wires_that_touch(answerer, check):
    run = check(answerer(0x65, b"\xA5\x65"))
    assert run.out.startswith("verdict: not good: echo (own commands come back)\n")


def test_a_lidar_that_answers_but_does_not_scan(answerer, check):
    run = check(answerer(0x90, INFORMATION))
    assert run.out.startswith("verdict: not good: start\nBAD   start      it answers, but does not scan\n")
    assert "\nlook  health     not answered\n" in run.out
    assert "RX" not in run.out


# ------------------------------------------------------------------------------------------------- other programs

def test_a_getty_on_the_port_is_named(talker, check, played):
    port = talker(b"")
    played(agetty=f"/sbin/agetty -L 115200 {port[5:]} vt220", vi=f"vi {port[5:]}0", sh="sh -c true")
    run = check(port)
    assert run.out.startswith("verdict: not good: shared (another program uses the port)\n")
    assert f"agetty (process 800) uses {port[5:]}, too: bytes that it takes do not come here" in run.flat
    assert "vi (" not in run.out and "nvgetty, brltty and the kernel's console" in run.flat


def test_the_kernels_console_on_the_port_is_named(talker, check, played):
    port = talker(b"")
    played(brltty=f"brltty -d {port}")
    with open("root/sys/class/tty/console/active", "w", encoding="ascii") as file:
        file.write(f"tty0 {port[5:]}\n")
    assert f"the kernel's console and brltty (process 800) use {port[5:]}, too" in check(port).flat


@pytest.mark.parametrize("console, length, count", (("tty0", 33, 3), ("", 21, 2)), ids=("99 letters", "100 letters"))
def test_of_many_programs_those_are_named_for_which_there_is_room(talker, check, played, console, length, count):
    port = talker(b"")
    played(**{f"{number:x<{length}}": f"cat {port}" for number in range(5)})
    with open("root/sys/class/tty/console/active", "w", encoding="ascii") as file:
        file.write(console or port[5:])
    text = check(port).flat
    assert text.count("(process 80") == count and f") use {port[5:]}, too" in text


def test_another_program_does_not_spoil_a_good_verdict(lidar, check, played):
    port = lidar().port
    played(minicom=f"minicom -D {port}")
    assert check(port, "-s3").out.startswith("verdict: good\n")


def test_who_has_started_the_tool_is_no_other_program(talker, start, played):
    port = talker(b"")
    played(sudo=f"sudo tmini check -p {port}")
    script = f"mkdir root/proc/$$; echo \"$$ (tmini) S 800 1\" >root/proc/$$/stat; exec '{TMINI}' check -p {port}"
    run = start("-c", script, program="/bin/sh").finish()
    assert "sudo" not in run.out and run.out.startswith("verdict: not good: ")


def test_a_real_program_that_names_the_port_is_named(talker, check, environment, monkeypatch):
    port = talker(b"")
    monkeypatch.setenv("TMINI_ROOT", "")
    program = subprocess.Popen(["sh", "-c", "read it; :", port], stdin=subprocess.PIPE)
    try:
        assert f"sh (process {program.pid}) uses {port[5:]}, too" in check(port).flat
    finally:
        program.communicate()


# ---------------------------------------------------------------------------------------------------- no verdict

def test_an_interrupted_examination_has_no_verdict(lidar, start):
    run = start("check", "-p", lidar().port)
    run.wait_for("scanning for ")
    assert run.end(signal.SIGINT).status == 1
    assert "verdict" not in run.out and "no verdict" in run.err


def test_without_a_port_there_is_nothing_to_examine(check, tmini):
    run = check("/dev/nowhere")
    assert run.status == 1
    assert run.out == "verdict: none, because there is no port to look at\n"
    assert "no such device" in run.err
    assert tmini("check").status == 2
