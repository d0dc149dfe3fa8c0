# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A real browser, controlled by Selenium, with what the tests of the viewer need."""

import base64
import pathlib
import shutil
import tempfile
import time

from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver import ActionChains
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

OPTIONS = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]


class Missing(Exception):
    """No browser is installed, or it does not start."""


def find_program(*names):
    path = next(filter(None, map(shutil.which, names)), None)
    if path is None:
        raise Missing(f"no {names[0]} (Debian: apt-get install chromium chromium-driver)")
    return path


class Page(webdriver.Chrome):
    """A browser with one page, and a folder that is deleted with it."""

    def __init__(self, width=1280, height=800):
        self.script = None
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tmini-web-"))
        self.downloads = self.folder / "downloads"
        options = webdriver.ChromeOptions()
        options.binary_location = find_program("chromium", "chromium-browser", "google-chrome")
        for option in OPTIONS + [f"--user-data-dir={self.folder / 'profile'}"]:
            options.add_argument(option)
        options.add_experimental_option("prefs", {"download.default_directory": str(self.downloads)})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        try:
            super().__init__(options=options, service=Service(find_program("chromedriver")))
        except WebDriverException as error:
            raise Missing(f"the browser does not start: {error}") from None
        self.resize(width, height)

    def close_all(self):
        self.quit()
        shutil.rmtree(self.folder, ignore_errors=True)

    def prepare(self, script):
        """Sets JavaScript that runs before each page's own from now on; replaces the one set before."""
        if self.script is not None:
            self.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=self.script)
        self.script = self.devtools("Page.addScriptToEvaluateOnNewDocument", source=script)["identifier"]

    def devtools(self, command, **parameters):
        """A command of Chromium's own protocol, for what WebDriver cannot do."""
        return self.execute_cdp_cmd(command, parameters)

    def resize(self, width, height, ratio=1):
        """Sets the page's size, which may be narrower than a window."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=ratio, mobile=False)

    def go(self, url):
        self.get(url)

    def run(self, script, *arguments):
        """Runs a function's body in the page; waits for a promise."""
        return self.execute_script(script, *arguments)

    def element(self, selector):
        return self.find_element(By.CSS_SELECTOR, selector)

    def click(self, selector):
        self.element(selector).click()

    def press(self, selector):
        """A click by script, not by the mouse: quick, and wherever the element is."""
        self.run("document.querySelector(arguments[0]).click()", selector)

    def press_key(self, key):
        ActionChains(self, duration=0).send_keys(key).perform()

    def type(self, selector, text):
        self.element(selector).send_keys(text)

    def clear(self, selector):
        self.element(selector).clear()

    def text(self, selector):
        """The element's text, visible or not."""
        return self.run("return document.querySelector(arguments[0]).textContent", selector)

    def is_shown(self, selector):
        return self.run("return document.querySelector(arguments[0]).checkVisibility()", selector)

    def screenshot(self, whole=False):
        """The page as PNG; `whole`: including the parts outside the window."""
        if whole:
            return base64.b64decode(self.devtools("Page.captureScreenshot", captureBeyondViewport=True)["data"])
        return self.get_screenshot_as_png()

    def log(self, kind):
        """Entries since the last call: "browser" is the console, "performance" the network."""
        return self.get_log(kind)

    def wait(self, what, condition, seconds=10):
        """Waits until the function `condition` returns a true value, and returns that."""
        end = time.monotonic() + seconds
        while not (value := condition()):
            if time.monotonic() > end:
                raise AssertionError(f"in vain waited {seconds} s for: {what}")
            time.sleep(0.02)
        return value

    def wait_text(self, selector, part, seconds=10):
        """Waits until the element's text contains `part`."""
        try:
            return self.wait(f"“{part}” in {selector}", lambda: part in self.text(selector), seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}; there is: {self.text(selector)!r}") from None
