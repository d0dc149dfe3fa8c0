# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The page from `python -m tmini serve`, on a phone, in real time: the lidar there, live."""

import os
import re
import shutil
import signal
import subprocess
import sys

import pytest
from conftest import PAGE, requests


@pytest.fixture
def settings():
    return {"size": (390, 844), "speed": 1, "url": "of the server"}


@pytest.fixture
def served(page):
    """The page; `serve` starts the server again, `server` and `sim` are processes."""
    python = os.environ.get("TMINI_PYTHON", sys.executable)
    if shutil.which(python) is None or subprocess.run([python, "-c", "import tmini, websockets"],
                                                      stderr=subprocess.DEVNULL, check=False).returncode != 0:
        pytest.skip(f"{python} has no tmini[serve] (the test `python` brings it)")
    with subprocess.Popen([os.environ["TMINI_SIM"], "--pty"], stdout=subprocess.PIPE, text=True) as page.sim:
        port = page.sim.stdout.readline().strip()

        def serve(number):
            page.server = subprocess.Popen(
                [python, "-m", "tmini", "serve", port, "--page", PAGE, "--tcp", str(number)],
                stdout=subprocess.PIPE, text=True)
            return page.server.stdout.readline().strip()
        page.serve, page.url = serve, serve(0)
        page.open(page.url)
        page.play("state: scanning; 1 scans")
        yield page
        page.get("about:blank")
        page.sim.send_signal(signal.SIGCONT)
        for process in (page.server, page.sim):
            process.terminate()
            process.communicate()


def test_the_room_is_seen_and_nothing_can_be_commanded(served):
    served.play("quality: complete; 5 scans; 300 coloured; checksums = 0; overrun = 0; losses = 0; "
                "not panel-lidar; not panel-unit")
    assert re.fullmatch(r"2\.(19|20)\d m", served.text("sector6"))
    assert requests(served) == {f"{served.url}/", f"{served.url}/live"}


def test_the_page_goes_on_when_the_server_is_back(served):
    served.server.terminate()
    served.server.communicate()
    served.play("problem: The connection to the lidar’s server is lost.; state: unplugged")
    served.serve(served.url.rpartition(":")[2])
    served.play("state: scanning; 3 scans; not problem")
    served.get_log("browser")  # The browser complains of refused connections.


def test_a_lidar_without_power_is_missed(served):
    served.sim.send_signal(signal.SIGSTOP)
    served.play("problem: Nothing comes from the lidar yet.; shown age")
    served.sim.send_signal(signal.SIGCONT)
    served.play("3 scans; not problem")


def test_who_has_left_can_watch_again(served):
    served.play("disconnect; state: not connected; watch; state: scanning; 1 scans")
