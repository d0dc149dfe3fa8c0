# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A real browser, controlled by Selenium, with what the tests of the viewer need: the fixture `page`, opened anew for
each test. Without a browser they are skipped."""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import pytest
from selenium import webdriver
from selenium.common.exceptions import TimeoutException, WebDriverException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.wait import WebDriverWait

HERE = pathlib.Path(__file__).resolve().parent
RECORDINGS = HERE.parent / "recordings"
PAGE = pathlib.Path(os.environ["TMINI_PAGE"]).resolve()
TMINI = os.environ["TMINI_TOOL"]
sys.path.append(str(HERE.parent / "host"))  # lidar_bytes
OPTIONS = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]

# Makes the page's time run faster than real time, so that the tests take less time. The page is not
# painted more often. If the page is too slow, its time and the simulated lidar's time wait.
FASTER = """{
    const [now, timeout, interval] = [performance.now.bind(performance), setTimeout, setInterval];
    let [ms, last] = [0, now()];
    performance.now = () => {
        const time = now();
        ms += Math.min(SPEED * (time - last), 100);
        last = time;
        return ms;
    };
    window.setTimeout = (action, delay) => timeout(action, delay / SPEED);
    window.setInterval = (action, delay) => interval(action, delay / SPEED);
    window.requestAnimationFrame = (paint) => timeout(paint, 50);
}
"""

# A canvas draws nothing, and does not complain, at a place that is no number. What the latest painting consists of is
# kept: in `written` each text, x, y and width; in `lines` the places from and to; in `arcs` what arc() gets.
STRICT = """{
    let last = [];
    for (const [name, keep] of Object.entries({
        setTransform() { [window.written, window.lines, window.arcs] = [[], [], []]; }, // Begins a painting.
        fillText(...what) { written.push([...what, this.measureText(what[0]).width]); },
        moveTo(...place) { last = place; },
        lineTo(...place) { lines.push([...last, ...place]); last = place; },
        arc(...circle) { arcs.push(circle); },
    })) {
        const draw = CanvasRenderingContext2D.prototype[name];
        CanvasRenderingContext2D.prototype[name] = function (...what) {
            if (what.some((one) => typeof one !== 'string' && !Number.isFinite(one))) { console.error(name, ...what); }
            keep.apply(this, what);
            draw.apply(this, what);
        };
    }
}
"""

COLOURED = "Math.max(r, g, b) - Math.min(r, g, b) > 80"  # Neither black, white nor grey: points and marks.


class Page(webdriver.Chrome):
    """A browser with one page, and a folder for what it saves."""

    def __init__(self, folder):
        self.script, self.folder, self.downloads = None, folder, folder / "downloads"
        options = webdriver.ChromeOptions()
        options.binary_location = next(filter(None, map(shutil.which, (
            "chromium", "chromium-browser", "google-chrome"))))
        for option in OPTIONS + [f"--user-data-dir={folder / 'profile'}"]:
            options.add_argument(option)
        options.add_experimental_option("prefs", {"download.default_directory": str(self.downloads)})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        super().__init__(options=options, service=Service(shutil.which("chromedriver")))

    # ---- How it is opened

    def prepare(self, script):
        """Sets JavaScript that runs before each page's own from now on; replaces the one set before."""
        if self.script is not None:
            self.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": self.script})
        self.script = self.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})["identifier"]

    def resize(self, width, height, ratio=1):
        """Sets the page's size, which may be narrower than a window, and the screen's pixels for each of the page's."""
        self.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                             {"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": False})

    def prefer(self, scheme):
        """The system's colours: light or dark."""
        self.execute_cdp_cmd("Emulation.setEmulatedMedia",
                             {"features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def open(self, url=PAGE.as_uri()):
        self.get_log("browser")
        self.get_log("performance")
        self.get(url)

    # ---- What a person does; elements are named by their ids

    def run(self, script, *arguments):
        """Runs a function's body in the page; waits for a promise."""
        return self.execute_script(script, *arguments)

    def element(self, name):
        return self.find_element(By.ID, name)

    def click(self, name):
        self.element(name).click()

    def press(self, name):
        """A click by script, not by the mouse: quick, and wherever the element is."""
        self.run("document.getElementById(arguments[0]).click()", name)

    def type(self, name, text):
        """Replaces what is there, if it is text."""
        if name != "file":
            self.element(name).clear()
        self.element(name).send_keys(str(text))

    def set(self, name, value, event="input"):
        """Sets the value of a slider or a field, and dispatches this event."""
        self.run("""const field = document.getElementById(arguments[0]);
            field.value = arguments[1]; field.dispatchEvent(new Event(arguments[2]))""", name, value, event)

    def save(self, button):
        """Clicks; returns name and content of the file that was saved, once it is complete."""
        def finished():
            files = list(self.downloads.glob("tmini-*"))  # At first there is an empty one of the final name, too.
            return files if len(files) == 1 and files[0].suffix != ".crdownload" and files[0].stat().st_size else None
        self.click(button)
        (path,) = self.wait("a file", finished)
        content = path.read_bytes()
        path.unlink()
        return path.name, content

    # ---- What a person sees

    def text(self, name):
        """The element's text, visible or not."""
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def number(self, name):
        text = self.text(name)
        return 0 if text == "–" else int(text)

    def wait(self, what, condition, seconds=60):
        """Waits until the function `condition` returns a true value, and returns that."""
        return WebDriverWait(self, seconds, 0.02).until(lambda _: condition(), f"in vain waited for: {what}")

    def wait_text(self, name, part):
        """Waits until the element's text contains `part`."""
        try:
            self.wait(f"“{part}” in {name}", lambda: part in self.text(name))
        except TimeoutException as why:
            raise AssertionError(f"{why.msg}; there is: {self.text(name)!r}") from None

    def touch(self, *events):
        """Each event: kind, finger, x and y."""
        self.run("""const picture = document.querySelector('#picture');
            picture.setPointerCapture = () => {};
            const at = picture.getBoundingClientRect();
            for (const [kind, pointerId, x, y] of arguments[0]) {
                picture.dispatchEvent(new PointerEvent(`pointer${kind}`, { pointerId,
                    clientX: at.left + 1 + x, clientY: at.top + 1 + y }));
            }""", events)

    def place_at(self, x, y):
        """What the page shows for this pixel: (metres to the right of the lidar, metres ahead of it)."""
        self.touch(("move", 0, x, y))
        distance, angle = self.text("pointer").removesuffix("°").split(" m at ")
        angle = math.radians(float(angle))
        return float(distance) * math.sin(angle), float(distance) * math.cos(angle)

    def look(self, condition=COLOURED):
        """Finds pixels (r, g, b) of the picture that fulfil the condition. Returns their number and their middle
        in metres: to the right of the lidar, and ahead of it. Waits for painting; leaves out the legend."""
        count, x, y = self.run("""const fulfils = new Function('r', 'g', 'b', 'return ' + arguments[0]);
            return new Promise(requestAnimationFrame).then(() => {
                const canvas = document.querySelector('#picture');
                const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
                copy.drawImage(canvas, 0, 0);
                const { data, width } = copy.getImageData(0, 0, canvas.width, canvas.height - 80);
                let [count, x, y] = [0, 0, 0];
                for (let i = 0; i < data.length; i += 4) {
                    if (fulfils(data[i], data[i + 1], data[i + 2])) {
                        count++;
                        x += i / 4 % width;
                        y += Math.floor(i / 4 / width);
                    }
                }
                return [count, x / count, y / count];
            })""", condition)
        return count, *(self.place_at(x, y) if count else (0, 0))

    def drawn(self, what):
        """What is in the picture: `written`, `lines` or `arcs`, see STRICT."""
        return self.run("""document.querySelector('#range').dispatchEvent(new Event('change'));
            return new Promise(requestAnimationFrame).then(() => window[arguments[0]])""", what)

    # ---- Stories

    def play(self, story):
        """Does and sees what the story tells, one step after the other; between two steps is "; ". A word alone is the
        element that is clicked (switches, which may be out of sight, by script). What is awaited:

            element: text       contained in the element's text        element = text      all of it
            shown element       not shown element                      3 scans             that many more revolutions
            500 coloured        at least that many pixels of points    0 coloured          none

        `bench.…` and `return …` run in the page, and `type text into element` replaces the text of a field."""
        for step in re.split(r";\s+", story.strip()):
            name, _, rest = step.partition(" ")
            if step.startswith(("bench.", "return ")):
                self.run(step)
            elif match := re.fullmatch(r"type (.*) into (\S+)", step):
                self.type(match[2], match[1])
            elif name.endswith(":"):
                self.wait_text(name[:-1], rest)
            elif rest.startswith("= "):
                self.wait(f"{step}; there is: {self.text(name)!r}",
                          lambda at=name, whole=rest[2:]: self.text(at) == whole)
            elif name in ("shown", "not"):
                self.wait(step, lambda at=step.split()[-1], is_shown=name == "shown": self.run(
                    "return document.getElementById(arguments[0]).checkVisibility()", at) == is_shown)
            elif rest == "scans":
                self.wait(step, lambda least=self.number("scans") + int(name): self.number("scans") >= least)
            elif rest == "coloured":
                self.wait(step, lambda most=int(name): self.look()[0] > most if most else self.look()[0] == 0)
            else:
                (self.press if name.startswith(("sim", "light", "mount")) else self.click)(step)


def stories(told):
    """Each is a test, whose name is a claim."""
    return pytest.mark.parametrize("story", told.values(), ids=[name.replace(" ", "_") for name in told])


def decode(path):
    """The tool's rows and counters of a recording."""
    with tempfile.NamedTemporaryFile() as stats:
        rows = subprocess.run([TMINI, "decode", path, "--csv", "--stats", stats.name], check=True, capture_output=True,
                              text=True).stdout
        return rows, json.load(stats)


def requests(page):
    """The requested URLs, without those of the browser's own pages: its new tab may still be loading."""
    messages = [json.loads(entry["message"])["message"] for entry in page.get_log("performance")]
    sent = [message["params"] for message in messages if message["method"] == "Network.requestWillBeSent"]
    return {request["request"]["url"] for request in sent
            if not request["documentURL"].startswith("chrome:") and not request["request"]["url"].startswith("data:")}


@pytest.fixture(scope="session")
def browser():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="tmini-web-"))
    try:
        page = Page(folder)
    except WebDriverException as error:
        pytest.skip(f"the browser does not start: {error}")
    yield page
    page.quit()
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def settings():
    """How the page is opened; a class of tests may have its own."""
    return {}


@pytest.fixture
def page(browser, settings):
    """The page from its file, of 1000 by 600 pixels, in dark colours; ten times faster than real time. At the end it
    must have had no reason to complain."""
    browser.resize(*settings.get("size", (1000, 600)))
    browser.prefer(settings.get("colours", "dark"))
    browser.prepare(FASTER.replace("SPEED", str(settings.get("speed", 10))) + STRICT + settings.get("before", ""))
    if "url" not in settings:
        browser.open()
        browser.wait_text("state", "not connected")
    yield browser
    assert [entry for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")] == []


@pytest.fixture
def simulated(page):
    """With the simulated lidar, which scans."""
    page.play("simulate; state: scanning; 1 scans")
    return page
