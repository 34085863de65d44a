"""Every page that is written, in a real browser: on a phone and on a desk, in light and dark, without a network."""

import json
import shutil
import subprocess
from itertools import pairwise
from pathlib import Path

import pytest
from report_pages import PAGES, html_of

from hgma_compensation.report.markup import element
from hgma_compensation.report.page import page

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
PROBE = (Path(__file__).parent / "page_probe.js").read_text(encoding="utf-8")

LEAST_OF_TEXT = 4.5
"""Contrast of text, WCAG 2.2 AA."""

LEAST_OF_PICTURE = 3.0
"""Contrast of what a picture shows, WCAG 2.2 AA."""

SCREENS = {"phone": (360, 740), "desk": (1280, 900)}
ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)

pytestmark = pytest.mark.skipif(
    not (CHROMIUM and DRIVER), reason="needs chromium and chromedriver (Debian: apt install chromium chromium-driver)"
)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    for program in (CHROMIUM, DRIVER):  # where they are snaps, there may be a stub that cannot run
        if subprocess.run([program, "--version"], capture_output=True, timeout=60).returncode:
            pytest.skip(f"{program} does not run here")
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in (*ARGUMENTS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return what writes a page into a file and returns its path."""
    folder = tmp_path_factory.mktemp("pages")

    def write(name, html):
        path = folder / f"{name}.html"
        path.write_text(html, encoding="utf-8")
        return path

    return write


def look(browser, path, screen, dark):
    """Return what a page looks like, what the browser complained of, and what it asked for."""
    width, height = SCREENS[screen]
    browser.get("about:blank")
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": screen == "phone"},
    )
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    for log in ("browser", "performance"):
        browser.get_log(log)  # what other pages left there
    browser.get(path.as_uri())
    seen = browser.execute_script(PROBE, LEAST_OF_TEXT, LEAST_OF_PICTURE)
    events = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    asked = [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
    return seen, [entry["message"] for entry in browser.get_log("browser")], asked


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("name", PAGES)
def test_page_can_be_read(browser, files, name, screen, dark):
    path = files(name, html_of(name))
    seen, complaints, asked = look(browser, path, screen, dark)
    assert seen["dark"] == dark
    assert (seen["page"] < 0.05) == dark
    assert SCREENS[screen][0] - 20 < seen["width"] <= SCREENS[screen][0]  # a scroll bar may be there
    assert seen["scroll"] <= seen["width"]
    assert complaints == []
    assert asked == [path.as_uri()]
    assert seen["texts"] > 100
    assert seen["faint"] == []
    assert seen["pictures"] > 5
    assert seen["invisible"] == []
    levels = seen["headings"]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels)), levels
    assert seen["unnamed"] == 0


def test_a_page_that_cannot_be_read_is_found_out(browser, files):
    """The probe itself: each fault that it looks for, in one page."""
    nothing = '<svg viewBox="0 0 300 200"><path d="M0 0L9 9" stroke="#eee" fill="none"/></svg>'
    faults = (
        element("h1", "Title"),
        element("h3", "Skipped a level"),
        element("p", "pale", style="color: #999"),
        element("p", "half", style="opacity: .5"),
        element("div", "wide", style="width: 2000px"),
        element("img", src="http://127.0.0.1:9/none.png"),
    )
    html = page("Faults", *faults).replace("</main>", f"{nothing}</main>")
    seen, complaints, asked = look(browser, files("faults", html), "phone", False)
    assert [fault.split(":")[0] for fault in seen["faint"]] == ["pale", "half"]
    assert len(seen["invisible"]) == 2
    assert "shows nothing" in seen["invisible"][1]
    assert seen["scroll"] > seen["width"]
    assert seen["headings"] == [1, 3]
    assert complaints
    assert "http://127.0.0.1:9/none.png" in asked
