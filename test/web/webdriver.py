# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A real browser, controlled by the WebDriver protocol with only Python's standard library."""

import base64
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

# The key under which WebDriver wraps an element of the page.
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"

BROWSER_OPTIONS = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]


class Missing(Exception):
    """No browser is installed, or it does not start."""


class ScriptError(Exception):
    """The browser's error reply to a command."""


def find_program(variable, *names):
    """The program that the environment variable names, or the first installed one."""
    path = os.environ.get(variable) or next(filter(None, map(shutil.which, names)), None)
    if path is None:
        raise Missing(f"no {names[0]} (Debian: apt-get install chromium chromium-driver)")
    return path


class Driver:
    """A chromedriver process, on a port of its choice."""

    def __init__(self):
        self.browser = find_program("TMINI_CHROMIUM", "chromium", "chromium-browser", "google-chrome")
        program = find_program("TMINI_CHROMEDRIVER", "chromedriver")
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tmini-web-"))
        self.process = subprocess.Popen(  # pylint: disable=consider-using-with
            [program, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            start_new_session=True)
        self.url = f"http://127.0.0.1:{self._read_port()}"

    def _read_port(self):
        for line in self.process.stdout:
            found = re.search(r"started successfully on port (\d+)", line)
            if found:
                return int(found.group(1))
        raise Missing("chromedriver does not start")

    def close(self):
        """Ends the process and the browsers that it has started."""
        os.killpg(self.process.pid, signal.SIGTERM)
        self.process.wait(timeout=10)
        self.process.stdout.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def ask(self, method, path, body=None):
        """Sends a command of the protocol; returns the reply's value."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"},
                                         method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            value = json.load(error)["value"]
            raise ScriptError(f"{value['error']}: {value['message'].splitlines()[0]}") from None


class Page:
    """A separate browser with one page."""

    def __init__(self, driver, width=1280, height=800):
        self.driver = driver
        self.script = None
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=driver.folder))
        self.downloads = self.folder / "downloads"
        arguments = BROWSER_OPTIONS + [f"--user-data-dir={self.folder / 'profile'}"]
        session = self._open_session(arguments)
        self.path = f"/session/{session['sessionId']}"
        self.process_id = session["capabilities"].get("goog:processID")
        self.resize(width, height)

    def prepare(self, script):
        """Sets JavaScript that runs before each page's own from now on; replaces the one set before."""
        if self.script is not None:
            self.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=self.script)
        self.script = self.devtools("Page.addScriptToEvaluateOnNewDocument", source=script)["identifier"]

    def _open_session(self, arguments):
        options = {
            "binary": self.driver.browser,
            "args": arguments,
            "prefs": {"download.default_directory": str(self.downloads)},
        }
        capabilities = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        try:
            return self.driver.ask("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
        except ScriptError as error:
            raise Missing(f"the browser does not start: {error}") from None

    def close(self):
        self.ask("DELETE", "")

    def ask(self, method, path, body=None):
        return self.driver.ask(method, self.path + path, body)

    def devtools(self, command, **parameters):
        """A command of Chromium's own protocol, for what WebDriver cannot do."""
        return self.ask("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def resize(self, width, height, ratio=1):
        """Sets the page's size, which may be narrower than a window."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=ratio, mobile=False)

    def go(self, url):
        self.ask("POST", "/url", {"url": url})

    def run(self, script, *arguments):
        """Runs a function's body in the page; waits for a promise."""
        return self.ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def element(self, selector):
        return self.ask("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]

    def click(self, selector):
        self.ask("POST", f"/element/{self.element(selector)}/click", {})

    def press(self, selector):
        """A click by script, not by the mouse: quick, and wherever the element is."""
        self.run("document.querySelector(arguments[0]).click()", selector)

    def type(self, selector, text):
        self.ask("POST", f"/element/{self.element(selector)}/value", {"text": text})

    def clear(self, selector):
        self.ask("POST", f"/element/{self.element(selector)}/clear", {})

    def text(self, selector):
        """The element's text, visible or not."""
        return self.run("return document.querySelector(arguments[0]).textContent", selector)

    def is_shown(self, selector):
        return self.run("return document.querySelector(arguments[0]).checkVisibility()", selector)

    def screenshot(self, whole=False):
        """The page as PNG; `whole`: including the parts outside the window."""
        if whole:
            return base64.b64decode(self.devtools("Page.captureScreenshot", captureBeyondViewport=True)["data"])
        return base64.b64decode(self.ask("GET", "/screenshot"))

    def log(self, kind):
        """Entries since the last call: "browser" is the console, "performance" the network."""
        return self.ask("POST", "/se/log", {"type": kind})

    def wait(self, what, condition, seconds=10):
        """Waits until the function `condition` returns a true value, and returns that."""
        end = time.monotonic() + seconds
        while True:
            value = condition()
            if value:
                return value
            if time.monotonic() > end:
                raise AssertionError(f"in vain waited {seconds} s for: {what}")
            time.sleep(0.02)

    def wait_text(self, selector, part, seconds=10):
        """Waits until the element's text contains `part`."""
        try:
            return self.wait(f"“{part}” in {selector}", lambda: part in self.text(selector), seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}; there is: {self.text(selector)!r}") from None
